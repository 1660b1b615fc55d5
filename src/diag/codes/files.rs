//! Codes IMP09xx.

crate::codes! {}
