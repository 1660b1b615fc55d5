//! Codes IMP01xx.

crate::codes! {
    NOT_TEXT = "IMP0101", "not a text file", include_str!("pages/IMP0101.md");
    EMPTY = "IMP0102", "empty job", include_str!("pages/IMP0102.md");
    BRACKET_OPEN = "IMP0103", "bracket not closed", include_str!("pages/IMP0103.md");
    BRACKET_MISMATCH = "IMP0104", "closing bracket without its opening one", include_str!("pages/IMP0104.md");
    NESTING = "IMP0105", "brackets nested too deep", include_str!("pages/IMP0105.md");
    TEXT_NOT_CLOSED = "IMP0106", "quoted text not closed", include_str!("pages/IMP0106.md");
    UNEXPECTED = "IMP0107", "unexpected text", include_str!("pages/IMP0107.md");
    UNKNOWN_ITEM = "IMP0108", "unknown item", include_str!("pages/IMP0108.md");
    TOO_LARGE = "IMP0109", "job too large", include_str!("pages/IMP0109.md");
    TOO_MANY = "IMP0110", "too many items, numbers or names", include_str!("pages/IMP0110.md");
    NOT_FORMATTED = "IMP0111", "a job that is not in its usual form", include_str!("pages/IMP0111.md");
    MISWRITTEN = "IMP0112", "a sign or form of another language", include_str!("pages/IMP0112.md");
}
