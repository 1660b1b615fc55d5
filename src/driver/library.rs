//! Machine, tool, curve and mesh files on the disk, and the library that ships with the compiler.

use super::reading;
use base::source::{Origin, SourceFile};
use diagnostics::codes::files;
use diagnostics::{Diag, printable};
use job::files::shipped;
use job::{Fault, Files, MissingFile};
use std::cell::RefCell;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Largest machine or tool file that is read: some 40 000 tools. TOML takes up to 140 times its size in memory.
const MAX_LIBRARY: u64 = 4 << 20;

/// Largest curve file that is read.
const MAX_CURVES: u64 = 64 << 20;

/// Largest mesh file that is read: that of [`tool_stock::stock::stl::MAX_TRIANGLES`] in the binary form.
const MAX_MESH: u64 = 256 << 20;

/// Files of a job. The order of search is the library of the command line, the `_lib` folders from the folder of the
/// job upwards, and the library that ships with the compiler. The folder of the job is that of the job file itself,
/// with symbolic links resolved, so the result depends neither on the spelling of the path nor on the working folder.
#[derive(Debug)]
pub struct DiskFiles {
    /// The folder of the job as the user wrote it, for messages.
    shown: PathBuf,
    /// The folder of the job, with symbolic links resolved.
    folder: PathBuf,
    /// Another folder with curve and mesh files.
    curves: Option<PathBuf>,
    libraries: Vec<(PathBuf, Origin)>,
    /// Paths at which a file was looked for and not found.
    missing: RefCell<Vec<PathBuf>>,
}

/// The path of a folder with symbolic links resolved.
fn folder(flag: &str, path: &Path) -> Result<PathBuf, Diag> {
    let fault = |reason: &str| {
        Diag::error(files::CANNOT_READ, format!("`{flag} {}` cannot be read: {reason}", path.display()))
            .help(format!("give `{flag}` a folder that exists, or leave it out"))
    };
    match path.canonicalize().and_then(|folder| std::fs::metadata(&folder).map(|m| (folder, m.is_dir()))) {
        Ok((folder, true)) => Ok(folder),
        Ok((_, false)) => Err(fault("it is not a folder")),
        Err(e) if e.kind() == ErrorKind::NotFound => Err(fault("there is no such folder")),
        Err(e) => Err(fault(&reading::reason(&e))),
    }
}

impl DiskFiles {
    /// Files for a job at a path, with the folders of `--library` and `--curves`.
    ///
    /// # Errors
    /// A folder of the command line that does not exist, or a path that is no folder.
    pub fn new(job: &Path, library: Option<&Path>, curves: Option<&Path>) -> Result<Self, Diag> {
        let folder_of = |job: &Path| job.parent().map(Path::to_path_buf).unwrap_or_default();
        let itself = job.canonicalize().unwrap_or_else(|_| job.to_path_buf());
        let (shown, own) = (folder_of(job), folder_of(&itself));
        let library = library.map(|path| folder("--library", path)).transpose()?;
        let curves = curves.map(|path| folder("--curves", path)).transpose()?;
        let above = own.ancestors().map(|dir| dir.join("_lib")).filter(|dir| dir.is_dir());
        let above: Vec<_> = above.map(|dir| (dir, Origin::BesideJob)).collect();
        let libraries = library.into_iter().map(|dir| (dir, Origin::Library)).chain(above).collect();
        Ok(Self { shown, folder: own, curves, libraries, missing: RefCell::default() })
    }

    /// Paths at which a file was looked for and not found.
    pub(super) fn missing_files(&self) -> Vec<PathBuf> {
        self.missing.borrow().clone()
    }

    fn find(&self, kind: &str, name: &str, shipped: &[(&str, &str)]) -> Result<SourceFile, MissingFile> {
        // A name is not a path, so it never leads out of the library.
        let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'));
        if plain {
            let shown = format!("{kind}/{name}.toml");
            for (library, origin) in &self.libraries {
                let path = library.join(kind).join(format!("{name}.toml"));
                match std::fs::symlink_metadata(&path) {
                    // A file that exists and cannot be read is reported: a file of the same name in another folder
                    // would be another machine.
                    Ok(_) => return read(&path, &shown, MAX_LIBRARY, *origin),
                    Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                        self.missing.borrow_mut().push(path);
                    }
                    Err(e) => return Err(unreadable(reading::reason(&e))),
                }
            }
            if let Some((_, text)) = shipped.iter().find(|s| s.0 == name) {
                return Ok(SourceFile { origin: Origin::Shipped, ..SourceFile::text(shown, *text) });
            }
        }
        let mut known: Vec<String> = shipped.iter().map(|s| s.0.to_owned()).collect();
        for (library, _) in &self.libraries {
            let entries = std::fs::read_dir(library.join(kind)).into_iter().flatten().flatten();
            known.extend(entries.filter_map(|e| e.file_name().to_str()?.strip_suffix(".toml").map(str::to_owned)));
        }
        known.sort();
        known.dedup();
        let reason = match self.libraries.len() {
            0 => "there is no folder `_lib` beside or above the job; only the shipped library was searched".to_owned(),
            n => format!("searched {n} library folder(s) and the shipped library"),
        };
        Err(MissingFile { reason, known, ..MissingFile::default() })
    }

    /// The file of a path in the job, with symbolic links resolved, and the origin of its folder.
    fn named(&self, path: &str) -> Result<(PathBuf, Origin), MissingFile> {
        let mut fault = MissingFile { reason: "there is no such file".to_owned(), ..MissingFile::default() };
        for start in [Some(&self.folder), self.curves.as_ref()].into_iter().flatten() {
            match start.join(path).canonicalize() {
                Ok(file) if file.starts_with(&self.folder) => return Ok((file, Origin::BesideJob)),
                Ok(file) if self.curves.as_ref().is_some_and(|c| file.starts_with(c)) => {
                    return Ok((file, Origin::Curves));
                }
                Ok(_) => {
                    let reason = "it is outside the folder of the job".to_owned();
                    fault = MissingFile { fault: Fault::Outside, reason, ..MissingFile::default() };
                }
                Err(e) if e.kind() == ErrorKind::NotFound => self.missing.borrow_mut().push(start.join(path)),
                Err(e) => fault = unreadable(reading::reason(&e)),
            }
        }
        Err(fault)
    }

    /// Path of a file that the job names, seen from the working folder.
    fn shown_path(&self, path: &str, file: PathBuf) -> String {
        let as_written = self.shown.join(path);
        let same = as_written.canonicalize().is_ok_and(|f| f == file);
        let shown = if same { as_written } else { file };
        shown.display().to_string()
    }
}

/// A file of the library.
#[derive(Debug)]
pub(super) struct Listed {
    /// Its name in jobs.
    pub(super) name: String,
    /// What it says of itself.
    pub(super) about: String,
    /// Where it comes from.
    pub(super) origin: Origin,
    /// Its folder, where it is on the disk.
    pub(super) folder: Option<PathBuf>,
}

/// First sentence of the comment that a library file begins with, whether it is an own file or a copy.
pub(super) fn about(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    // A copy of a file begins with the line that says where it comes from.
    let comment = comment.skip_while(|line| line.starts_with("from: ")).take_while(|line| !line.is_empty());
    let words = comment.collect::<Vec<_>>().join(" ");
    // A stop before a small letter or a figure is that of an abbreviation.
    let ends = words.match_indices(". ").find(|(at, _)| words[at + 2..].starts_with(|c: char| c.is_ascii_uppercase()));
    ends.map_or(words.as_str(), |(at, _)| &words[..at]).trim_end_matches('.').to_owned()
}

impl DiskFiles {
    /// All files of a kind in the order of their names; of several files of one name, the one that a job gets.
    pub(super) fn list(&self, kind: &str) -> Vec<Listed> {
        let mut found: Vec<Listed> = Vec::new();
        for (library, origin) in &self.libraries {
            let folder = library.join(kind);
            let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
            for path in entries.map(|entry| entry.path()) {
                let name = path.file_name().and_then(|n| n.to_str()?.strip_suffix(".toml").map(str::to_owned));
                let Some(name) = name.filter(|name| found.iter().all(|file| file.name != *name)) else { continue };
                let about = match read(&path, &name, MAX_LIBRARY, *origin) {
                    Ok(file) => about(&file.text),
                    Err(missing) => format!("cannot be read: {}", missing.reason),
                };
                found.push(Listed { name, about, origin: *origin, folder: Some(folder.clone()) });
            }
        }
        let shipped = match kind {
            "machines" => shipped::MACHINES,
            "tools" => shipped::TOOLS,
            _ => shipped::POSTS,
        };
        for (name, text) in shipped {
            if found.iter().all(|file| file.name != *name) {
                found.push(Listed {
                    name: (*name).to_owned(),
                    about: about(text),
                    origin: Origin::Shipped,
                    folder: None,
                });
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        found
    }
}

fn unreadable(reason: String) -> MissingFile {
    MissingFile { fault: Fault::Unreadable, reason, ..MissingFile::default() }
}

/// Reads a regular file only; anything else, such as a device, could be endless.
fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, MissingFile> {
    let regular = std::fs::metadata(path).map_err(|e| unreadable(reading::reason(&e)))?;
    if !(regular.is_file() || regular.is_dir()) {
        return Err(unreadable("it is not a regular file".to_owned()));
    }
    let bytes = reading::read(path, most).map_err(|e| unreadable(reading::reason(&e)))?;
    bytes.ok_or_else(|| unreadable(format!("it is larger than {} MB, the limit", most >> 20)))
}

fn read(path: &Path, name: &str, most: u64, origin: Origin) -> Result<SourceFile, MissingFile> {
    let text = String::from_utf8(read_bytes(path, most)?).map_err(|e| unreadable(reading::no_text(&e)))?;
    Ok(SourceFile { origin, disk: Some(itself(path)), ..SourceFile::text(printable(name), text) })
}

/// The path with symbolic links resolved.
fn itself(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}

impl Files for DiskFiles {
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.find("machines", name, shipped::MACHINES)
    }

    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.find("tools", name, shipped::TOOLS)
    }

    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.find("posts", name, shipped::POSTS)
    }

    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        let (file, origin) = self.named(path)?;
        let found = read(&file, path, MAX_CURVES, origin)?;
        Ok(SourceFile { path: Some(self.shown_path(path, file)), ..found })
    }

    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        let (file, origin) = self.named(path)?;
        let (data, disk) = (read_bytes(&file, MAX_MESH)?, Some(itself(&file)));
        let name = printable(path).into_owned();
        Ok(SourceFile { name, data, origin, disk, path: Some(self.shown_path(path, file)), ..SourceFile::default() })
    }
}
