//! Files of the library: machines, tools and posts, their keys, and what an editor shows of them.

mod check;
mod example;
mod form;
pub(crate) mod machine;
mod machine_keys;
pub(crate) mod post_file;
pub(crate) mod schema;
mod table;
pub(crate) mod tool_file;

pub use check::read_library_file;
pub use post_file::shipped as shipped_post;
pub use schema::{LibraryFile, library_schema};
pub use tool_file::library_tools;
