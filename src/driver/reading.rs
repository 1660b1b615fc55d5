//! Reads files of any kind and size with bounded memory, and gives the reason when a file cannot be read.

use diagnostics::Diag;
use diagnostics::codes::files;
use std::fs::File;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

/// The bytes of a file; `None` when the file has more than `most`. A file without a size, such as a device, is not read
/// further either.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn read(path: &Path, most: u64) -> Result<Option<Vec<u8>>, Error> {
    let file = File::open(path)?;
    if file.metadata()?.len() > most {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    let fits = u64::try_from(bytes.len()).is_ok_and(|n| n <= most);
    Ok(fits.then_some(bytes))
}

/// The reason why a file cannot be read, in words.
pub(super) fn reason(error: &Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::IsADirectory => "it is a folder".to_owned(),
        ErrorKind::PermissionDenied => "you may not read it".to_owned(),
        _ => error.to_string(),
    }
}

/// Why bytes are no text.
pub(super) fn no_text(error: &std::string::FromUtf8Error) -> String {
    let at = error.utf8_error().valid_up_to();
    match error.as_bytes() {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "it is a text in UTF-16: save it as UTF-8".to_owned(),
        bytes if bytes.starts_with(b"PK\x03\x04") => {
            "it is no text but an archive, such as a file of Excel or Word".to_owned()
        }
        _ => format!("it is not a text file: byte {at} is not UTF-8"),
    }
}

/// The diagnostic for a file that cannot be read; `due` says what the user should give.
pub(super) fn unreadable(path: &Path, error: &Error, due: &str) -> Diag {
    Diag::error(files::CANNOT_READ, format!("{} cannot be read: {}", path.display(), reason(error)))
        .help(format!("check the path: {due}"))
}
