//! Files that the job needs: the job requests them, the driver reads them.

use base::source::{Origin, SourceFile};
use std::collections::{BTreeMap, BTreeSet};

/// Answers requests for files. The driver reads the disk; tests answer from memory.
pub trait Files {
    /// Text of a machine file.
    ///
    /// # Errors
    /// [`MissingFile`] when the file does not exist or cannot be read.
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile>;

    /// Text of a tool library.
    ///
    /// # Errors
    /// [`MissingFile`] when the file does not exist or cannot be read.
    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile>;

    /// Text of a post file.
    ///
    /// # Errors
    /// [`MissingFile`] when the file does not exist or cannot be read.
    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile>;

    /// Text of a curve file.
    ///
    /// # Errors
    /// [`MissingFile`] when the file does not exist or cannot be read.
    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile>;

    /// Bytes of a file with the mesh of a solid.
    ///
    /// # Errors
    /// [`MissingFile`] when the file does not exist or cannot be read.
    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile>;
}

/// Why there is no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Fault {
    /// No such file.
    #[default]
    Absent,
    /// The file exists but cannot be read.
    Unreadable,
    /// The file is outside of the folders that a job may read.
    Outside,
}

/// Why a file is not available.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct MissingFile {
    /// Kind of fault.
    pub fault: Fault,
    /// Reason in words: where the file was looked for, or why it cannot be read.
    pub reason: String,
    /// Names that exist.
    pub known: Vec<String>,
}

/// Files as texts in memory, together with the library that ships with the compiler. Editors, tests and other programs
/// give them to the front end.
#[derive(Clone, Debug, Default)]
pub struct InMemory {
    /// Machine files by name.
    pub machines: BTreeMap<String, String>,
    /// Tool libraries by name.
    pub tools: BTreeMap<String, String>,
    /// Post files by name.
    pub posts: BTreeMap<String, String>,
    /// Curve files by the path in the job.
    pub curves: BTreeMap<String, String>,
    /// Mesh files by the path in the job.
    pub meshes: BTreeMap<String, Vec<u8>>,
}

/// A file that a job names by its path.
fn named<T>(
    path: &str,
    given: &BTreeMap<String, T>,
    file: impl Fn(&T) -> SourceFile,
) -> Result<SourceFile, MissingFile> {
    let found = given.get(path).ok_or_else(|| MissingFile {
        reason: "there is no such file".to_owned(),
        known: given.keys().cloned().collect(),
        ..MissingFile::default()
    })?;
    Ok(SourceFile { name: path.to_owned(), origin: Origin::BesideJob, ..file(found) })
}

/// A text of a map, or of the shipped library.
fn find(
    kind: &str,
    name: &str,
    given: &BTreeMap<String, String>,
    shipped: &[(&str, &str)],
) -> Result<SourceFile, MissingFile> {
    let shown = format!("{kind}/{name}.toml");
    if let Some(text) = given.get(name) {
        return Ok(SourceFile { origin: Origin::Library, ..SourceFile::text(shown, text) });
    }
    if let Some((_, text)) = shipped.iter().find(|s| s.0 == name) {
        return Ok(SourceFile { origin: Origin::Shipped, ..SourceFile::text(shown, *text) });
    }
    let known = given.keys().cloned().chain(shipped.iter().map(|s| s.0.to_owned()));
    let known: BTreeSet<String> = known.collect();
    let reason = "the given files and the shipped library were searched".to_owned();
    Err(MissingFile { reason, known: known.into_iter().collect(), ..MissingFile::default() })
}

impl Files for InMemory {
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find("machines", name, &self.machines, shipped::MACHINES)
    }

    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find("tools", name, &self.tools, shipped::TOOLS)
    }

    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find("posts", name, &self.posts, shipped::POSTS)
    }

    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        named(path, &self.curves, |text| SourceFile::text("", text))
    }

    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        named(path, &self.meshes, |bytes| SourceFile { data: bytes.clone(), ..SourceFile::default() })
    }
}

/// The library that ships with the compiler.
pub mod shipped {
    /// Machine files by name.
    pub const MACHINES: &[(&str, &str)] = &[
        ("5mc850-c", include_str!("../../../jobs/_lib/machines/5mc850-c.toml")),
        ("5mc850-c-linuxcnc", include_str!("../../../jobs/_lib/machines/5mc850-c-linuxcnc.toml")),
        ("generic-ab-head", include_str!("../../../jobs/_lib/machines/generic-ab-head.toml")),
        ("generic-ac-table", include_str!("../../../jobs/_lib/machines/generic-ac-table.toml")),
        ("generic-b-head-c-table", include_str!("../../../jobs/_lib/machines/generic-b-head-c-table.toml")),
        ("generic-bc-table", include_str!("../../../jobs/_lib/machines/generic-bc-table.toml")),
        ("generic-nutating-head", include_str!("../../../jobs/_lib/machines/generic-nutating-head.toml")),
        ("linuxcnc-xyzac-trt", include_str!("../../../jobs/_lib/machines/linuxcnc-xyzac-trt.toml")),
        ("linuxcnc-xyzbc-trt", include_str!("../../../jobs/_lib/machines/linuxcnc-xyzbc-trt.toml")),
    ];
    /// Tool libraries by name.
    pub const TOOLS: &[(&str, &str)] = &[
        ("carbide", include_str!("../../../jobs/_lib/tools/carbide.toml")),
        ("five-axis", include_str!("../../../jobs/_lib/tools/five-axis.toml")),
    ];
    /// Post files by name.
    pub const POSTS: &[(&str, &str)] = &[
        ("apt-cl", include_str!("../../../jobs/_lib/posts/apt-cl.toml")),
        ("fanuc", include_str!("../../../jobs/_lib/posts/fanuc.toml")),
        ("heidenhain", include_str!("../../../jobs/_lib/posts/heidenhain.toml")),
        ("heidenhain-itnc530", include_str!("../../../jobs/_lib/posts/heidenhain-itnc530.toml")),
        ("linuxcnc", include_str!("../../../jobs/_lib/posts/linuxcnc.toml")),
        ("makino", include_str!("../../../jobs/_lib/posts/makino.toml")),
        ("mitsubishi", include_str!("../../../jobs/_lib/posts/mitsubishi.toml")),
        ("siemens-840d", include_str!("../../../jobs/_lib/posts/siemens-840d.toml")),
    ];
}
