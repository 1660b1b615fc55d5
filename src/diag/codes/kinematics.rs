//! Codes IMP06xx.

crate::codes! {}
