//! Codes IMP07xx.

crate::codes! {}
