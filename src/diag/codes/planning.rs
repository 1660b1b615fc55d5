//! Codes IMP04xx.

crate::codes! {}
