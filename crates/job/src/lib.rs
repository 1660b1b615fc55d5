//! The job: quantities have types, names are resolved, every default is explicit, and libraries are merged.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod angles;
mod blade_model;
mod channel;
mod context;
mod contracts;
pub mod curve_file;
mod curves;
mod distributions;
mod doubts;
mod eval;
pub mod files;
mod finishing;
pub mod language;
mod library;
mod library_check;
mod library_example;
mod library_form;
mod library_schema;
mod library_table;
mod limits;
mod machine_keys;
pub mod model;
mod operations;
mod other_names;
mod part;
mod plunge;
mod post_file;
pub mod print;
mod properties;
mod property;
pub mod quantity;
mod resolve;
mod rough;
mod stock_file;
mod tool_file;
mod tool_model;
mod tools;
pub mod vocabulary;

pub use files::{Fault, Files, InMemory, MissingFile};
pub use library_check::read_library_file;
pub use library_schema::{LibraryFile, library_schema};
pub use model::{Job, PartialJob};
pub use post_file::shipped as shipped_post;
pub use resolve::{resolve, understand};
