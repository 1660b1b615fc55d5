//! What every stage has: quantities with units, source texts, typed ids, progress of a run.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod entity;
mod names;
pub mod progress;
pub mod source;
pub mod units;
