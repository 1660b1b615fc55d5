//! What leaves beside the NC text: pictures for people, the certificate as a file.

pub mod certificate_file;
pub mod picture;
