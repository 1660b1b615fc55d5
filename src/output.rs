//! Output files: written whole or not at all.

use crate::diag::{Diag, codes::files};
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Tells whether a path can be written, without touching what is there.
///
/// # Errors
/// A path that cannot be written, with the reason of the system.
pub fn check(path: &Path) -> Result<(), Diag> {
    temporary(path).map(drop)
}

/// Writes a file in one step: to a temporary file in the same folder, which then takes the place of the old one. On
/// any failure an existing file stays as it was.
///
/// # Errors
/// A path that cannot be written, with the reason of the system.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Diag> {
    let mut file = temporary(path)?;
    file.write_all(bytes)
        .and_then(|()| file.as_file().sync_all())
        .and_then(|()| readable(path, file.as_file()))
        .map_err(|e| failed(path, &e.to_string()))?;
    file.persist(path).map_err(|e| failed(path, &e.error.to_string()))?;
    Ok(())
}

/// An empty file beside the output; it goes away when it is dropped.
fn temporary(path: &Path) -> Result<tempfile::NamedTempFile, Diag> {
    if path.is_dir() {
        return Err(failed(path, "it is a folder"));
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    tempfile::Builder::new().prefix(".impellerc-").tempfile_in(folder).map_err(|e| {
        // The words of the system would name the temporary file.
        let reason = match e.kind() {
            ErrorKind::NotFound => "there is no such folder".to_owned(),
            ErrorKind::PermissionDenied => "the folder may not be written to".to_owned(),
            kind => kind.to_string(),
        };
        failed(path, &reason)
    })
}

fn failed(path: &Path, reason: &str) -> Diag {
    Diag::error(files::CANNOT_WRITE, format!("{} cannot be written: {reason}", path.display()))
        .note("nothing was written; an existing file is as it was")
        .help("give a file in a folder that exists and that you may write to")
}

/// Temporary files are private; the output gets the rights of the file that it replaces, or the usual ones.
#[cfg(unix)]
fn readable(path: &Path, file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    let mode = std::fs::metadata(path).map_or(0o644, |m| m.permissions().mode() & 0o777);
    file.set_permissions(std::fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn readable(_path: &Path, _file: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_whole_and_leaves_nothing_behind_on_failure() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.nc");
        write_whole(&path, b"first\n").unwrap();
        write_whole(&path, b"second\n").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second\n");
        assert!(write_whole(folder.path(), b"x").is_err());
        assert!(write_whole(&folder.path().join("no/such/part.nc"), b"x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
