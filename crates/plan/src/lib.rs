//! From program to motion. The planner knows nothing of the verifier.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod budget;
pub mod facts;
pub mod passes;
mod spacing;
pub mod tolerance_budget;
