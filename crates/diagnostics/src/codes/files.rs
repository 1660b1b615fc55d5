//! Codes IMP09xx.

crate::codes! {
    CANNOT_READ = "IMP0901", "file cannot be read", include_str!("pages/IMP0901.md");
    NOT_IN_LIBRARY = "IMP0902", "not in the library", include_str!("pages/IMP0902.md");
    CANNOT_WRITE = "IMP0903", "output cannot be written", include_str!("pages/IMP0903.md");
    MEETS = "IMP0904", "an output would replace another file of the run", include_str!("pages/IMP0904.md");
    OUTSIDE = "IMP0905", "file outside the job's folder", include_str!("pages/IMP0905.md");
    STAGE_FILE = "IMP0906", "a stage file that cannot be used", include_str!("pages/IMP0906.md");
    NOT_SHOWN = "IMP0915", "more diagnostics than are shown", include_str!("pages/IMP0915.md");
    INTERNAL = "IMP0910", "fault of the compiler", include_str!("pages/IMP0910.md");
}
