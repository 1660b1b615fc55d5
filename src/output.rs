//! Output files of a run. They are announced before the work: no output may be a file that the run reads, or another
//! output. They are written all together or not at all. Each is first written to a temporary file beside its place;
//! then all temporary files take their places. If one of them cannot, the files replaced before are restored.
//!
//! A symbolic link continues to point to its file, which gets the new text. The new file has the permissions of the old
//! one, and its owner where the system allows that; a file with a new name has the usual permissions. Other hard links
//! of the old file keep the old text, since no option names them. Extended attributes are lost. Character devices and
//! FIFOs are written to directly, last before the files take their places.

pub mod interrupt;
mod target;

use base::source::SourceMap;
use diagnostics::{Diag, codes::files};
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use target::{Identity, Kind, OutputTarget};

/// State of the files after a run that fails before its end.
const NOTHING: &str = "nothing was written; no file was changed";

/// Beginning of the names of temporary files.
const PREFIX: &str = ".impellerc-";

/// The outputs of a run.
#[derive(Debug, Default)]
pub struct Outputs {
    inputs: Vec<(String, Identity)>,
    announced: Vec<(String, OutputTarget)>,
    staged: Vec<Staged>,
    folders: Folders,
}

/// An output that waits until all outputs are written.
#[derive(Debug)]
enum Staged {
    File { shown: PathBuf, file: PathBuf, temporary: Temporary },
    Stream { shown: PathBuf, bytes: Vec<u8> },
}

/// A temporary file beside an output. It is removed when this value is dropped, or when a signal ends the program.
#[derive(Debug)]
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        interrupt::hold().remove(&self.0);
    }
}

/// Folders that were made for outputs. Empty ones are removed when this value is dropped.
#[derive(Debug, Default)]
struct Folders(Vec<PathBuf>);

impl Drop for Folders {
    fn drop(&mut self) {
        let mut unfinished = interrupt::hold();
        for folder in self.0.drain(..).rev() {
            unfinished.remove_folder(&folder);
        }
    }
}

impl Outputs {
    /// Adds a file that the run reads, with its name in messages ("the job").
    pub fn protect(&mut self, name: impl Into<String>, path: &Path) {
        if let Some(identity) = target::identity(path) {
            self.inputs.push((name.into(), identity));
        }
    }

    /// Adds the files of the disk that the sources of the run come from.
    pub fn protect_sources(&mut self, sources: &SourceMap) {
        for file in sources.files() {
            if let Some(path) = &file.disk {
                self.protect(format!("`{}`", file.name), path);
            }
        }
    }

    /// Adds an output that the run will write, by its flag. Checks the path without changing the existing file.
    ///
    /// # Errors
    /// A path that cannot be written, or that is an input or another output.
    pub fn announce(&mut self, flag: &str, path: &Path) -> Result<(), Diag> {
        let mut target = OutputTarget::of(path).map_err(|reason| failed(path, &reason).note(NOTHING))?;
        if matches!(target.kind, Kind::New | Kind::Regular) {
            // Tests whether the folder accepts a new file, and whether its names differ by case.
            let probe = temporary(&target).map_err(|e| failed(path, &target::reason(&e)).note(NOTHING))?.1;
            target.identity = target.identity.with_case(target::case_matters(&probe.0));
        }
        let named = format!("`{flag} {}`", path.display());
        self.meets(&named, &target)?;
        self.announced.push((named, target));
        Ok(())
    }

    /// Adds a folder for outputs; a missing folder is made.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn folder(&mut self, flag: &str, path: &Path) -> Result<(), Diag> {
        let cannot = |reason: &str| {
            Diag::error(files::CANNOT_WRITE, format!("the folder {} cannot be created: {reason}", path.display()))
                .help(format!("give `{flag}` a folder, or a path where a folder can be created"))
        };
        let missing: Vec<&Path> =
            path.ancestors().take_while(|p| !p.as_os_str().is_empty() && std::fs::metadata(p).is_err()).collect();
        for folder in missing.into_iter().rev() {
            let mut unfinished = interrupt::hold();
            // `a/..` exists only when `a` exists.
            if !folder.is_dir() {
                std::fs::create_dir(folder).map_err(|e| cannot(&target::reason(&e)))?;
                let made = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
                unfinished.folder(&made);
                self.folders.0.push(made);
            }
        }
        if path.is_dir() { Ok(()) } else { Err(cannot("a file has this path")) }
    }

    /// Refuses a target that is an input, an output announced before, or the file that standard output or standard
    /// error goes to.
    fn meets(&self, named: &str, target: &OutputTarget) -> Result<(), Diag> {
        let meets =
            |message: String| Diag::error(files::MEETS, message).note(NOTHING).help("give each output its own file");
        let is = |(_, other): &&(String, Identity)| target.identity.is(other);
        if let Some((name, _)) = self.inputs.iter().find(is) {
            return Err(meets(format!("{named} would replace an input: it is {name}")));
        }
        if let Some((name, _)) = target::standard().iter().find(|(_, other)| target.identity.is(other)) {
            let diag = meets(format!("{named} is the file of {name}: both texts would mix"));
            return Err(diag.help("use `--emit nc` to print only the NC text, or give the output its own file"));
        }
        let device = target.kind == Kind::Device;
        let other = self.announced.iter().find(|(_, other)| !device && target.identity.is(&other.identity));
        other.map_or(Ok(()), |(name, _)| Err(meets(format!("{name} and {named} are the same file"))))
    }

    /// Writes an output to a temporary file beside its place. An output that was not announced is checked here.
    ///
    /// # Errors
    /// A path that cannot be written, or that became an input or another output since it was announced.
    pub fn stage(&mut self, flag: &str, path: &Path, bytes: &[u8]) -> Result<(), Diag> {
        let named = format!("`{flag} {}`", path.display());
        if self.announced.iter().all(|(name, _)| *name != named) {
            self.announce(flag, path)?;
        }
        let target = OutputTarget::of(path).map_err(|reason| failed(path, &reason).note(NOTHING))?;
        let shown = path.to_path_buf();
        let staged = match target.kind {
            Kind::Device | Kind::Fifo => Staged::Stream { shown, bytes: bytes.to_vec() },
            Kind::New | Kind::Regular => {
                let written = temporary(&target).and_then(|(mut file, temporary)| {
                    file.write_all(bytes)?;
                    alike(&target, &file)?;
                    file.sync_all()?;
                    Ok(temporary)
                });
                let temporary = written.map_err(|e| failed(path, &target::reason(&e)).note(NOTHING))?;
                Staged::File { shown, file: target.file, temporary }
            }
        };
        self.staged.push(staged);
        Ok(())
    }

    /// Moves all outputs to their places.
    ///
    /// # Errors
    /// A path that cannot be written. Then no file is changed, and the message names the devices that already got their
    /// text.
    pub fn commit(mut self) -> Result<(), Diag> {
        let mut got = Vec::new();
        for staged in &self.staged {
            let Staged::Stream { shown, bytes } = staged else { continue };
            interrupt::hold().stream(shown.display().to_string());
            stream(shown, bytes).map_err(|e| {
                let part = format!("{} may have received a part of its text", shown.display());
                with_outcome(failed(shown, &target::reason(&e)), &got, &[part])
            })?;
            interrupt::hold().streamed();
            got.push(shown.display().to_string());
        }
        // From here on signals are held until all is done.
        let mut unfinished = interrupt::hold();
        let mut placed: Vec<(&Path, Option<PathBuf>)> = Vec::new();
        let mut fault = None;
        for staged in &self.staged {
            let Staged::File { shown, file, temporary } = staged else { continue };
            match place(file, &temporary.0) {
                Ok(old) => placed.push((file, old)),
                Err(reason) => {
                    fault = Some(failed(shown, &reason));
                    break;
                }
            }
        }
        if let Some(diag) = fault {
            let undone = placed.into_iter().rev().map(|(file, old)| put_back(file, old.as_deref()));
            let left: Vec<String> = undone.filter_map(Result::err).collect();
            drop(unfinished);
            return Err(with_outcome(diag, &got, &left));
        }
        for (file, old) in placed {
            if let Some(old) = old {
                let _ = std::fs::remove_file(old);
            }
            // The new name is on the disk only after the folder is synchronised; a system that cannot do that loses
            // nothing else.
            let _ = File::open(target::folder(file)).and_then(|folder| folder.sync_all());
        }
        for staged in &self.staged {
            if let Staged::File { shown, temporary, .. } = staged {
                unfinished.forget(&temporary.0);
                unfinished.done(shown.display().to_string());
            }
        }
        for folder in self.folders.0.drain(..) {
            unfinished.forget(&folder);
        }
        drop(unfinished);
        Ok(())
    }
}

/// An empty file beside an output. With a new name it has the usual permissions; otherwise it is private until it gets
/// those of the old file.
fn temporary(target: &OutputTarget) -> std::io::Result<(File, Temporary)> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX);
    #[cfg(unix)]
    if target.kind == Kind::New {
        use std::os::unix::fs::PermissionsExt as _;
        // The system applies the mask of the user (umask).
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut unfinished = interrupt::hold();
    let (file, path) = builder.tempfile_in(target::folder(&target.file))?.keep().map_err(|e| e.error)?;
    unfinished.file(&path);
    Ok((file, Temporary(path)))
}

/// Gives a temporary file the owner and the permissions of the file that it will replace.
#[cfg(unix)]
fn alike(target: &OutputTarget, file: &File) -> std::io::Result<()> {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    if target.kind == Kind::New {
        return Ok(());
    }
    let old = std::fs::metadata(&target.file)?;
    let new = file.metadata()?;
    let mut mode = old.mode() & 0o7777;
    // Only an administrator can change the owner of a file; a user can change the group to one of their groups.
    let given = (old.uid() == new.uid() && old.gid() == new.gid())
        || fchown(file, Some(old.uid()), Some(old.gid())).is_ok()
        || (old.uid() == new.uid() && fchown(file, None, Some(old.gid())).is_ok());
    if !given {
        let group = fchown(file, None, Some(old.gid())).is_ok() || old.gid() == new.gid();
        // Permissions of the old group must not pass to another group, and the file must not run as another user.
        mode &= if group { 0o777 } else { 0o707 };
    }
    file.set_permissions(std::fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn alike(_target: &OutputTarget, _file: &File) -> std::io::Result<()> {
    Ok(())
}

/// Writes to a device or FIFO; never makes a file, and never empties a file that took the place of the device.
fn stream(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = std::fs::OpenOptions::new().write(true).open(path)?;
    if file.metadata()?.is_file() {
        return Err(std::io::Error::other("it became a file during the run"));
    }
    file.write_all(bytes).and_then(|()| file.flush())
}

/// Moves a temporary file to its place. An old file gets another name beside the place, which is returned.
fn place(file: &Path, temporary: &Path) -> Result<Option<PathBuf>, String> {
    // A folder or a device that appeared here since the announcement must not be moved away.
    let old = match OutputTarget::of(file)?.kind {
        Kind::New => None,
        Kind::Regular => Some(aside(file).map_err(|e| target::reason(&e))?),
        Kind::Device | Kind::Fifo => return Err("it became a device during the run".to_owned()),
    };
    match std::fs::rename(temporary, file) {
        Ok(()) => Ok(old),
        Err(error) => {
            if let Some(old) = old {
                // After a hard link the old file is still in place, and only the second name is removed; after a move
                // the old file goes back.
                let _ = if std::fs::symlink_metadata(file).is_ok() {
                    std::fs::remove_file(old)
                } else {
                    std::fs::rename(old, file)
                };
            }
            Err(target::reason(&error))
        }
    }
}

/// Gives a file a second name. Where the system has no hard links, this is its only name for a moment.
fn aside(file: &Path) -> std::io::Result<PathBuf> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX);
    let linked = builder.make_in(target::folder(file), |name| std::fs::hard_link(file, name));
    let (_, path) = match linked {
        Ok(linked) => linked.keep().map_err(|e| e.error)?,
        Err(_) => {
            builder.make_in(target::folder(file), |name| std::fs::rename(file, name))?.keep().map_err(|e| e.error)?
        }
    };
    Ok(path)
}

/// Undoes [`place`]; on failure the message says where the old text is.
fn put_back(file: &Path, old: Option<&Path>) -> Result<(), String> {
    let done = match old {
        Some(old) => std::fs::rename(old, file),
        None => std::fs::remove_file(file),
    };
    done.map_err(|e| match old {
        Some(old) => format!("{} has the new text ({e}); the old text is {}", file.display(), old.display()),
        None => format!("{} has the new text: {e}", file.display()),
    })
}

fn failed(path: &Path, reason: &str) -> Diag {
    Diag::error(files::CANNOT_WRITE, format!("{} cannot be written: {reason}", path.display()))
        .help("name a file in an existing folder in which you may write")
}

/// Adds notes about what was written in spite of the failure: devices that got their text, and files that could not be
/// restored.
fn with_outcome(diag: Diag, got: &[String], left: &[String]) -> Diag {
    let diag = if left.is_empty() && got.is_empty() { diag.note(NOTHING) } else { diag };
    let diag = got.iter().fold(diag, |diag, name| diag.note(format!("{name} received its whole text")));
    left.iter().fold(diag, |diag, left| diag.note(left.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(texts: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in texts {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    fn texts(folder: &Path) -> Vec<(String, String)> {
        let mut found: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap())
            .filter(|entry| entry.path().is_file())
            .map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read_to_string(entry.path()).unwrap()))
            .collect();
        found.sort();
        found
    }

    #[test]
    fn replaces_whole_and_leaves_nothing_behind_on_failure() {
        let folder = folder(&[("part.nc", "old")]);
        let path = folder.path().join("part.nc");
        for text in ["first\n", "second\n"] {
            let mut outputs = Outputs::default();
            outputs.stage("-o", &path, text.as_bytes()).unwrap();
            outputs.commit().unwrap();
        }
        let mut outputs = Outputs::default();
        assert!(outputs.announce("-o", folder.path()).is_err());
        assert!(outputs.announce("-o", &folder.path().join("no/such/part.nc")).is_err());
        outputs.stage("-o", &path, b"third").unwrap();
        drop(outputs);
        assert_eq!(texts(folder.path()), [("part.nc".to_owned(), "second\n".to_owned())]);
    }

    /// The last of three outputs cannot take its place, since a folder is there by then: the others are restored.
    #[test]
    fn all_outputs_or_none() {
        let folder = folder(&[("a", "old a")]);
        let at = |name: &str| folder.path().join(name);
        let mut outputs = Outputs::default();
        for name in ["a", "b", "c"] {
            outputs.stage("-o", &at(name), b"new").unwrap();
        }
        std::fs::create_dir(at("c")).unwrap();
        std::fs::write(at("c").join("inside"), "").unwrap();
        let diag = outputs.commit().unwrap_err();
        assert!(diag.message.contains("cannot be written"), "{diag:?}");
        assert_eq!(texts(folder.path()), [("a".to_owned(), "old a".to_owned())]);
        std::fs::remove_dir_all(at("c")).unwrap();
        let mut outputs = Outputs::default();
        for name in ["a", "b", "c"] {
            outputs.stage("-o", &at(name), name.as_bytes()).unwrap();
        }
        outputs.commit().unwrap();
        assert_eq!(texts(folder.path()), ["a", "b", "c"].map(|n| (n.to_owned(), n.to_owned())));
    }

    #[test]
    fn folders_that_were_made_go_unless_something_was_written() {
        let folder = folder(&[]);
        let stock = folder.path().join("new/stock");
        let mut outputs = Outputs::default();
        outputs.folder("--stock", &stock).unwrap();
        assert!(stock.is_dir());
        drop(outputs);
        assert!(!folder.path().join("new").exists());
        let mut outputs = Outputs::default();
        outputs.folder("--stock", &stock).unwrap();
        outputs.stage("--stock", &stock.join("01.stl"), b"mesh").unwrap();
        outputs.commit().unwrap();
        assert_eq!(texts(&stock).len(), 1);
    }
}
