//! The job: quantities have types, names are resolved, every default is explicit, and libraries are merged.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod block;
mod contracts;
mod doubts;
pub mod files;
pub mod language;
mod library;
pub mod model;
mod operation;
mod part;
pub mod print;
mod property;
mod resolve;
pub mod vocabulary;

pub use files::{Fault, Files, InMemory, MissingFile};
pub use library::{LibraryFile, library_schema, library_tools, read_library_file, shipped_post};
pub use model::{Job, PartialJob};
pub use part::curve_file;
pub use property::quantity;
pub use resolve::{resolve, understand};
