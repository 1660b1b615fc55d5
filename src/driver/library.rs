//! Machine, tool and curve files on the disk, with the shipped library behind them.

use super::reading;
use crate::job::files::shipped;
use crate::job::{Files, Found, Missing};
use std::path::{Path, PathBuf};

/// Largest library or curve file that is read.
const MAX_BYTES: u64 = 64 << 20;

/// Files beside a job: the library given on the command line, then the `_lib` folders from the job's folder upward,
/// then what ships with the compiler.
#[derive(Debug)]
pub struct DiskFiles {
    folder: PathBuf,
    libraries: Vec<PathBuf>,
}

impl DiskFiles {
    /// Files for a job at a path.
    pub fn new(job: &Path, library: Option<PathBuf>) -> Self {
        let folder = job.parent().map(Path::to_path_buf).unwrap_or_default();
        let mut libraries: Vec<PathBuf> = library.into_iter().collect();
        let absolute = std::path::absolute(&folder).unwrap_or_else(|_| folder.clone());
        libraries.extend(absolute.ancestors().map(|dir| dir.join("_lib")).filter(|dir| dir.is_dir()));
        Self { folder, libraries }
    }

    fn find(&self, kind: &str, name: &str, shipped: &[(&str, &str)]) -> Result<Found, Missing> {
        // A name is no path: it never leads out of the library.
        let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'));
        if plain {
            for library in &self.libraries {
                let path = library.join(kind).join(format!("{name}.toml"));
                if path.is_file() {
                    return read(&path, &format!("{kind}/{name}.toml"))
                        .map_err(|reason| Missing { reason, known: Vec::new() });
                }
            }
            if let Some((_, text)) = shipped.iter().find(|s| s.0 == name) {
                return Ok(Found {
                    name: format!("{kind}/{name}.toml (shipped)"),
                    text: (*text).to_owned(),
                    path: None,
                });
            }
        }
        let mut known: Vec<String> = shipped.iter().map(|s| s.0.to_owned()).collect();
        for library in &self.libraries {
            let entries = std::fs::read_dir(library.join(kind)).into_iter().flatten().flatten();
            known.extend(entries.filter_map(|e| e.file_name().to_str()?.strip_suffix(".toml").map(str::to_owned)));
        }
        known.sort();
        known.dedup();
        let reason = match self.libraries.len() {
            0 => "no `_lib` folder lies beside or above the job; only the shipped library was searched".to_owned(),
            n => format!("searched {n} `_lib` folder(s) and the shipped library"),
        };
        Err(Missing { reason, known })
    }
}

fn read(path: &Path, name: &str) -> Result<Found, String> {
    let bytes = reading::read(path, MAX_BYTES).map_err(|e| reading::reason(&e))?;
    let bytes = bytes.ok_or_else(|| format!("it has more than the {} MB that are read", MAX_BYTES >> 20))?;
    let text = String::from_utf8(bytes)
        .map_err(|e| format!("it is not a text file: byte {} is not UTF-8", e.utf8_error().valid_up_to()))?;
    Ok(Found { name: name.to_owned(), text, path: None })
}

impl Files for DiskFiles {
    fn machine(&mut self, name: &str) -> Result<Found, Missing> {
        self.find("machines", name, shipped::MACHINES)
    }

    fn tools(&mut self, name: &str) -> Result<Found, Missing> {
        self.find("tools", name, shipped::TOOLS)
    }

    fn curves(&mut self, path: &str) -> Result<Found, Missing> {
        let whole = self.folder.join(path);
        let found = read(&whole, path).map_err(|reason| Missing { reason, known: Vec::new() })?;
        Ok(Found { path: Some(whole.display().to_string()), ..found })
    }
}
