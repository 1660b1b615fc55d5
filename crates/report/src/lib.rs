//! Outputs beside the NC text: pictures and the report for people, the certificate and the source map as files, the part for
//! other programs.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod certificate_file;
mod markup;
pub mod picture;
pub mod proof;
pub mod report;
pub mod setup_sheet;
pub mod source_map;
pub mod step;
mod table;
pub mod three_mf;
pub mod turbogrid;
