//! Meaning of a path: the file after its symbolic links, and whether two paths are the same file.

use std::ffi::OsString;
use std::fs::Metadata;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Most symbolic links in a row, as on Linux.
const MAX_SYMBOLIC_LINKS: usize = 40;

/// An existing file or folder, independent of the spelling of its path.
#[derive(Clone, Debug, PartialEq, Eq)]
enum FileNode {
    /// Number of the device, and of the file on it.
    #[cfg(unix)]
    Number(u64, u64),
    /// Path with symbolic links resolved.
    #[cfg(not(unix))]
    Path(PathBuf),
}

impl FileNode {
    #[cfg(unix)]
    fn new(_path: &Path, metadata: &Metadata) -> Option<Self> {
        use std::os::unix::fs::MetadataExt as _;
        Some(Self::Number(metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn new(path: &Path, _metadata: &Metadata) -> Option<Self> {
        path.canonicalize().ok().map(Self::Path)
    }

    fn of(path: &Path) -> Option<Self> {
        Self::new(path, &std::fs::metadata(path).ok()?)
    }
}

/// A file, existing or not.
#[derive(Clone, Debug)]
pub(super) struct Identity {
    existing: Option<FileNode>,
    folder: Option<FileNode>,
    name: OsString,
    /// Whether names in its folder are distinguished by case.
    case_matters: bool,
}

impl Identity {
    /// Whether both are the same file, or would be.
    pub(super) fn is(&self, other: &Self) -> bool {
        if self.existing.is_some() && self.existing == other.existing {
            return true;
        }
        let lower = |name: &OsString| name.to_string_lossy().to_lowercase();
        self.folder.is_some()
            && self.folder == other.folder
            && (self.name == other.name || (!self.case_matters && lower(&self.name) == lower(&other.name)))
    }
}

/// Kind of an output path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing yet.
    New,
    /// A file, which is replaced.
    Regular,
    /// A character device: the text is written to it; several outputs may share it.
    Device,
    /// A FIFO: the text is written to it.
    Fifo,
}

/// The place of an output.
#[derive(Clone, Debug)]
pub(super) struct OutputTarget {
    /// Path with the symbolic link at its end resolved: the file that gets the text.
    pub(super) file: PathBuf,
    pub(super) kind: Kind,
    pub(super) identity: Identity,
}

/// The folder of a path.
pub(super) fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The path after all symbolic links at its end.
fn followed(path: &Path) -> Result<PathBuf, String> {
    let mut at = path.to_path_buf();
    for _ in 0..MAX_SYMBOLIC_LINKS {
        let Ok(to) = std::fs::read_link(&at) else { return Ok(at) };
        // Such a link is an open file of a process, for example `/dev/stdout` and `/dev/fd/3`. The process continues
        // with the open file, not with a file that takes its place.
        if folder(&at).canonicalize().is_ok_and(|f| f.starts_with("/proc")) {
            return Err("the file is already open".to_owned());
        }
        at = folder(&at).join(to);
    }
    Err("its symbolic links form a loop".to_owned())
}

/// Whether names in a folder are distinguished by case: tests whether the name in capitals leads to the same file.
pub(super) fn case_matters(file: &Path) -> bool {
    let Some(name) = file.file_name().and_then(|n| n.to_str()) else { return true };
    let other = file.with_file_name(name.to_uppercase());
    other == file || FileNode::of(&other).is_none_or(|node| Some(node) != FileNode::of(file))
}

impl OutputTarget {
    /// Examines a path without changing the existing file.
    ///
    /// # Errors
    /// The reason why the path cannot be written.
    pub(super) fn of(path: &Path) -> Result<Self, String> {
        if path.as_os_str().is_empty() {
            return Err("the path is empty".to_owned());
        }
        let (file, kind) = match std::fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => return Err("it is a folder".to_owned()),
            Ok(metadata) if metadata.is_file() => (followed(path)?, Kind::Regular),
            Ok(metadata) => (path.to_path_buf(), special(&metadata)?),
            Err(e) if e.kind() == ErrorKind::NotFound => (followed(path)?, Kind::New),
            Err(e) => return Err(reason(&e)),
        };
        let ends_open =
            path.as_os_str().as_encoded_bytes().last().is_some_and(|b| std::path::is_separator(char::from(*b)));
        let Some(name) = file.file_name().filter(|_| !ends_open).map(OsString::from) else {
            return Err("the path is that of a folder".to_owned());
        };
        let identity =
            Identity { existing: FileNode::of(path), folder: FileNode::of(folder(&file)), name, case_matters: true };
        if identity.folder.is_none() {
            return Err("there is no such folder".to_owned());
        }
        if kind == Kind::Regular {
            writable(&file)?;
        }
        Ok(Self { file, kind, identity })
    }
}

/// Identity of an existing file or folder; `None` when it does not exist.
pub(super) fn identity(path: &Path) -> Option<Identity> {
    let path = path.canonicalize().ok()?;
    let name = path.file_name().map(OsString::from).unwrap_or_default();
    Some(Identity { existing: FileNode::of(&path), folder: FileNode::of(folder(&path)), name, case_matters: true })
}

/// Whether a file may be replaced. Its permissions decide, also for an administrator.
fn writable(file: &Path) -> Result<(), String> {
    let metadata = std::fs::metadata(file).map_err(|e| reason(&e))?;
    if metadata.permissions().readonly() {
        return Err("it is read-only".to_owned());
    }
    // Opened without truncation, the file is not changed.
    std::fs::OpenOptions::new().write(true).open(file).map(drop).map_err(|e| match e.kind() {
        ErrorKind::PermissionDenied => "you may not write to it".to_owned(),
        _ => reason(&e),
    })
}

/// The reason why a path cannot be written, in words.
pub(super) fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such folder".to_owned(),
        ErrorKind::PermissionDenied => "you may not write to this folder".to_owned(),
        ErrorKind::StorageFull => "the disk is full".to_owned(),
        ErrorKind::FileTooLarge => "it is larger than the largest file of this disk".to_owned(),
        ErrorKind::QuotaExceeded => "your quota of the disk is full".to_owned(),
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only".to_owned(),
        kind => kind.to_string(),
    }
}

#[cfg(unix)]
fn special(metadata: &Metadata) -> Result<Kind, String> {
    use std::os::unix::fs::FileTypeExt as _;
    let kind = metadata.file_type();
    if kind.is_char_device() {
        Ok(Kind::Device)
    } else if kind.is_fifo() {
        Ok(Kind::Fifo)
    } else if kind.is_block_device() {
        Err("it is a disk".to_owned())
    } else {
        Err("it is a socket".to_owned())
    }
}

#[cfg(not(unix))]
fn special(_metadata: &Metadata) -> Result<Kind, String> {
    Err("it is not a regular file".to_owned())
}

/// The files of standard output and standard error, with their names. Devices other than a terminal are left out: two
/// outputs to `/dev/null` do not mix.
#[cfg(unix)]
pub(super) fn standard() -> Vec<(&'static str, Identity)> {
    use std::io::IsTerminal as _;
    use std::os::fd::AsFd as _;
    use std::os::unix::fs::FileTypeExt as _;
    let (out, err) = (std::io::stdout(), std::io::stderr());
    let mut found = Vec::new();
    for (name, fd, terminal) in
        [("standard output", out.as_fd(), out.is_terminal()), ("standard error", err.as_fd(), err.is_terminal())]
    {
        let metadata = fd.try_clone_to_owned().and_then(|fd| std::fs::File::from(fd).metadata());
        let Ok(metadata) = metadata else { continue };
        if terminal || !metadata.file_type().is_char_device() {
            let existing = FileNode::new(Path::new(""), &metadata);
            found.push((name, Identity { existing, folder: None, name: OsString::new(), case_matters: true }));
        }
    }
    found
}

#[cfg(not(unix))]
pub(super) fn standard() -> Vec<(&'static str, Identity)> {
    Vec::new()
}

impl Identity {
    /// Sets whether names in the folder are distinguished by case.
    pub(super) fn with_case(self, case_matters: bool) -> Self {
        Self { case_matters, ..self }
    }
}
