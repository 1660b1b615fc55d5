//! Codes IMP02xx.

crate::codes! {}
