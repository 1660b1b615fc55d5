//! The impeller and what is required of it: the part with its row, passages and solid, the stock, operations, contracts,
//! material, methods, and the post file.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod contract;
pub mod control;
pub mod material;
pub mod method;
pub mod operation;
pub mod part;
pub mod post_file;
