//! From text to syntax tree; no other module uses the parser.
//!
//! The scanner cuts the text into items and checks the brackets. Then pest reads each item separately, so that a fault
//! in one item does not affect the others, and a run reports every independent fault.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod ast;
mod format;
mod parse;
pub mod print;
mod repair;
mod scan;

pub use format::{Unformatted, format};
pub use parse::parse;
