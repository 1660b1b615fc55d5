//! Codes IMP03xx.

crate::codes! {}
