//! What the job needs from outside: the driver reads files, the job only asks for them.

use crate::source::SourceFile;

/// Answers requests for files. The driver reads the disk; tests answer from memory.
pub trait Files {
    /// Text of a machine file.
    ///
    /// # Errors
    /// [`Missing`] when there is none or it cannot be read.
    fn machine(&mut self, name: &str) -> Result<SourceFile, Missing>;

    /// Text of a tool library.
    ///
    /// # Errors
    /// [`Missing`] when there is none or it cannot be read.
    fn tools(&mut self, name: &str) -> Result<SourceFile, Missing>;

    /// Text of a curve file.
    ///
    /// # Errors
    /// [`Missing`] when there is none or it cannot be read.
    fn curves(&mut self, path: &str) -> Result<SourceFile, Missing>;
}

/// Why there is no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Fault {
    /// No such file.
    #[default]
    Absent,
    /// The file is there and cannot be read.
    Unreadable,
    /// The file lies where a job may not read.
    Outside,
}

/// Why a file is not there.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Missing {
    /// What kind of fault.
    pub fault: Fault,
    /// Reason in words: where it was looked for, or why it cannot be read.
    pub reason: String,
    /// Names that exist.
    pub known: Vec<String>,
}

/// The library that ships with the compiler.
pub mod shipped {
    /// Machine files by name.
    pub const MACHINES: &[(&str, &str)] = &[
        ("5mc850-c", include_str!("../../jobs/_lib/machines/5mc850-c.toml")),
        ("5mc850-c-linuxcnc", include_str!("../../jobs/_lib/machines/5mc850-c-linuxcnc.toml")),
        ("linuxcnc-xyzac-trt", include_str!("../../jobs/_lib/machines/linuxcnc-xyzac-trt.toml")),
    ];
    /// Tool libraries by name.
    pub const TOOLS: &[(&str, &str)] = &[("carbide", include_str!("../../jobs/_lib/tools/carbide.toml"))];
}
