//! What the job needs from outside: the driver reads files, the job only asks for them.

/// Answers requests for files. The driver reads the disk; tests answer from memory.
pub trait Files {
    /// Text of a machine file.
    ///
    /// # Errors
    /// [`Missing`] when there is none or it cannot be read.
    fn machine(&mut self, name: &str) -> Result<Found, Missing>;

    /// Text of a tool library.
    ///
    /// # Errors
    /// [`Missing`] when there is none or it cannot be read.
    fn tools(&mut self, name: &str) -> Result<Found, Missing>;

    /// Text of a curve file beside the job.
    ///
    /// # Errors
    /// [`Missing`] when there is none or it cannot be read.
    fn curves(&mut self, path: &str) -> Result<Found, Missing>;
}

/// A file that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Name to show.
    pub name: String,
    /// Its text.
    pub text: String,
    /// Where it lies, seen from the working folder, when the name does not say that.
    pub path: Option<String>,
}

/// Why a file is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
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
