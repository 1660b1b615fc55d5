//! Codes IMP08xx.

crate::codes! {}
