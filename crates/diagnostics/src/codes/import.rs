//! Codes IMP10xx: readers of blade files.

crate::codes! {
    UNKNOWN_FORMAT = "IMP1001", "no reader for a blade file", include_str!("pages/IMP1001.md");
    MALFORMED = "IMP1002", "a line of a blade file is not of its format", include_str!("pages/IMP1002.md");
    ENDS_EARLY = "IMP1003", "a blade file is not complete", include_str!("pages/IMP1003.md");
    NOT_STATED = "IMP1004", "a fact that the blade file does not state", include_str!("pages/IMP1004.md");
    CONTRADICTS = "IMP1005", "a blade file contradicts itself or an option", include_str!("pages/IMP1005.md");
    TOO_MUCH = "IMP1006", "a blade file exceeds a limit", include_str!("pages/IMP1006.md");
    NOT_READ = "IMP1007", "a part of a format that is not read", include_str!("pages/IMP1007.md");
    SECTION = "IMP1008", "a section that has no faces and edges", include_str!("pages/IMP1008.md");
    SECTION_FACTS = "IMP1009", "a section with doubtful points", include_str!("pages/IMP1009.md");
    EXISTS = "IMP1010", "a written file exists already", include_str!("pages/IMP1010.md");
    LEFT_OUT = "IMP1011", "the part lies beside its files", include_str!("pages/IMP1011.md");
}
