//! Codes IMP02xx.

crate::codes! {
    MISSING_ITEM = "IMP0201", "missing item", include_str!("pages/IMP0201.md");
    GIVEN_TWICE = "IMP0202", "given twice", include_str!("pages/IMP0202.md");
    UNKNOWN_NAME = "IMP0203", "unknown name", include_str!("pages/IMP0203.md");
    UNKNOWN_PROPERTY = "IMP0204", "unknown property", include_str!("pages/IMP0204.md");
    MISSING_PROPERTY = "IMP0205", "missing property", include_str!("pages/IMP0205.md");
    NO_UNIT = "IMP0206", "number without a unit", include_str!("pages/IMP0206.md");
    WRONG_DIMENSION = "IMP0207", "wrong dimension", include_str!("pages/IMP0207.md");
    UNKNOWN_UNIT = "IMP0208", "unknown unit", include_str!("pages/IMP0208.md");
    OUT_OF_RANGE = "IMP0209", "value out of its range", include_str!("pages/IMP0209.md");
    WRONG_FORM = "IMP0210", "value of the wrong form", include_str!("pages/IMP0210.md");
    NOT_IN_LANGUAGE = "IMP0211", "not in the language", include_str!("pages/IMP0211.md");
    WRONG_TOOL = "IMP0212", "tool does not suit the operation", include_str!("pages/IMP0212.md");
    MACHINE_RANGE = "IMP0213", "beyond the machine's range", include_str!("pages/IMP0213.md");
    EDITION = "IMP0214", "unknown edition", include_str!("pages/IMP0214.md");
    ARITHMETIC = "IMP0215", "arithmetic without a result", include_str!("pages/IMP0215.md");
    RELATION = "IMP0216", "contract with the wrong relation", include_str!("pages/IMP0216.md");
    LIBRARY = "IMP0217", "fault in a library file", include_str!("pages/IMP0217.md");
    NO_ROTARY_AXIS = "IMP0218", "machine without the axes for five-axis work", include_str!("pages/IMP0218.md");
    UNUSED = "IMP0219", "unused name", include_str!("pages/IMP0219.md");
    CURVE_FILE = "IMP0220", "fault in a curve file", include_str!("pages/IMP0220.md");
    NOTHING_LEFT = "IMP0221", "contract without anything to check", include_str!("pages/IMP0221.md");
    STOCK_FILE = "IMP0223", "fault in the file of the stock", include_str!("pages/IMP0223.md");
    CHIP = "IMP0224", "the feed per tooth is larger than the tool permits", include_str!("pages/IMP0224.md");
    PLUNGE = "IMP0225", "a stroke along the axis would cut with the middle of the tool", include_str!("pages/IMP0225.md");
    NO_SPLINES = "IMP0227", "the control has no spline blocks", include_str!("pages/IMP0227.md");
    DOUBTFUL = "IMP0228", "valid, but hardly meant", include_str!("pages/IMP0228.md");
    NO_REST_BEFORE = "IMP0222", "rest machining without an operation before it", include_str!("pages/IMP0222.md");
}
