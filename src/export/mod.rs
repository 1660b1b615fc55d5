//! Outputs beside the NC text: pictures and the report for people, the certificate as a file.

pub mod certificate_file;
pub mod picture;
pub mod report;
