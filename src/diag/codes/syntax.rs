//! Codes IMP01xx.

crate::codes! {}
