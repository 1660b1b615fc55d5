//! Codes IMP05xx.

crate::codes! {}
