//! Text to syntax tree; nothing else knows the parser.
//!
//! The text is cut into items first, with the brackets checked on the way, and pest reads each item alone. So a fault
//! in one item leaves the others alone, and a run reports every independent fault.

pub mod ast;
mod parse;
pub mod print;
mod scan;

pub use parse::parse;
