//! Folders of public data sets. `IMPELLERC_BLADE_DATA` names the folder that has them; without it a test says that it skips.

use std::io::Write as _;
use std::path::PathBuf;

/// The folder of a data set.
pub fn folder(name: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("IMPELLERC_BLADE_DATA") else {
        let text = format!("skipped: IMPELLERC_BLADE_DATA does not name a folder with {name}\n");
        std::io::stderr().write_all(text.as_bytes()).unwrap();
        return None;
    };
    let folder = PathBuf::from(root).join(name);
    assert!(folder.is_dir(), "{} is no folder", folder.display());
    Some(folder)
}
