//! Milling cutters and holders as solids of revolution, their distances to surfaces, the space that they sweep, and
//! the stock that they leave.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod collide;
pub mod stock;
