//! Tool axes: the envelope of a cutter along a face, and smooth axes between constraints.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod envelope;
pub mod orient;
mod quadratic;
