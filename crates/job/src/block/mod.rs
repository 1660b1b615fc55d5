//! Entries of blocks as values: each known, given once, and with the right form, unit and range.

pub(crate) mod context;
pub(crate) mod eval;
pub(crate) mod properties;
