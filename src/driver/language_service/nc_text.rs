//! Answers about NC text, from the source map and the certificate that lie beside it.

use super::FileStamps;
use crate::driver::reading;
use report::certificate_file::{self, CertificateFile, sha256};
use report::source_map::{self, LaidMap, SourceMapFile};
use serde_json::Value;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Largest file beside the text that is read.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Most files beside the text that are examined.
const MAX_FILES: usize = 200;

/// Bytes at the beginning of a file in which its format stands.
const FORMAT_BYTES: usize = 200;

/// What is known of an NC text.
#[derive(Debug, Default)]
pub(super) struct FilesOfText {
    map: Option<LaidMap>,
    /// Why a source map beside the text cannot be read.
    refused: Option<String>,
    /// Figures of the certificate that belong to a move: operation, index, sentence.
    figures: Vec<(u64, u64, String)>,
    folder: PathBuf,
    /// The files that could belong to the text, as they were.
    json_files: FileStamps,
}

/// The JSON files beside a text.
fn json_files(path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "json"));
    let mut files: Vec<PathBuf> = files.take(MAX_FILES).collect();
    files.sort();
    files
}

/// The texts of those files that begin with a format.
fn of_format(files: &[PathBuf], format: &str) -> Vec<String> {
    let begins = |path: &&PathBuf| {
        let mut head = Vec::new();
        let read = File::open(path).and_then(|file| file.take(FORMAT_BYTES as u64).read_to_end(&mut head));
        read.is_ok() && head.windows(format.len()).any(|bytes| bytes == format.as_bytes())
    };
    let found = files.iter().filter(begins);
    found.filter_map(|path| String::from_utf8(reading::read(path, MAX_FILE_BYTES).ok()??).ok()).collect()
}

impl FilesOfText {
    /// Looks for the files that belong to a text: of several source maps, the one that knows the most lines.
    pub(super) fn new(path: &Path, text: &str) -> Self {
        let files = json_files(path);
        let stamps = FileStamps::new(files.iter().cloned());
        let (mut map, mut refused) = (None::<LaidMap>, None);
        for found in of_format(&files, source_map::FORMAT) {
            match SourceMapFile::read(&found).map(|found| LaidMap::new(found, text)) {
                Ok(laid) if laid.known()[1] > map.as_ref().map_or(0, |best| best.known()[1]) => map = Some(laid),
                Ok(_) => {}
                Err(reason) => refused = Some(reason),
            }
        }
        let body = sha256(certificate_file::body(text).1.as_bytes());
        let certificates = of_format(&files, certificate_file::FORMAT);
        let mut read = certificates.iter().filter_map(|text| CertificateFile::read(text).ok());
        let figures = read.find(|file| file.nc.body_sha256 == body).map(|file| figures(&file.measured));
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Self { map, refused, figures: figures.unwrap_or_default(), folder, json_files: stamps }
    }

    /// True while the files beside the text are as they were.
    pub(super) fn holds(&self, path: &Path) -> bool {
        self.json_files == FileStamps::new(json_files(path).into_iter())
    }

    /// What a line, from 0, is: Markdown.
    pub(super) fn meaning(&self, line: usize) -> Option<String> {
        let Some(map) = &self.map else {
            let reason = self.refused.as_ref().map_or_else(
                || "No source map lies beside this text".to_owned(),
                |reason| format!("The source map beside this text cannot be read, because {reason}"),
            );
            return Some(format!("{reason}: `--source-map part.map.json` of the compilation writes one."));
        };
        let said = map.says(line + 1)?;
        let Some((block, operation)) = map.block(line + 1) else { return Some(said) };
        let named = map.axes().iter().zip(block.positions).map(|(name, at)| format!("{name} {at:.4}"));
        let axes = named.collect::<Vec<_>>().join(", ");
        let mut text = format!(
            "**{}** with {}, {}\n\n{said}\n\naxes at its end, without tool centre point control: {axes}",
            operation.name, operation.tool, block.kind
        );
        let here = |(o, i, _): &&(u64, u64, String)| (*o, *i) == (u64::from(block.operation), u64::from(block.index));
        for (_, _, figure) in self.figures.iter().filter(here) {
            text.push_str(&format!("\n\n{figure}"));
        }
        Some(text)
    }

    /// The job and its line, from 0, for which a line, from 0, was written.
    pub(super) fn job_line(&self, line: usize) -> Option<(PathBuf, usize)> {
        let map = self.map.as_ref()?;
        let (_, operation) = map.block(line + 1)?;
        // Only the name: a map from elsewhere must not lead out of the folder.
        let job = self.folder.join(Path::new(map.job()).file_name()?);
        job.is_file().then(|| (job, operation.job_line.saturating_sub(1)))
    }
}

/// The worst figures of surfaces and contracts with the moves that make them.
fn figures(measured: &Value) -> Vec<(u64, u64, String)> {
    let at = |value: &Value| Some((value["operation"].as_u64()?, value["index"].as_u64()?));
    let list = |key: &str| measured[key].as_array().cloned().unwrap_or_default();
    let mut found = Vec::new();
    for contract in list("contracts") {
        let Some((operation, index)) = at(&contract["at"]) else { continue };
        let text = |key: &str| contract[key].as_str().unwrap_or_default().to_owned();
        let number = |key: &str| contract[key].as_f64().unwrap_or_default();
        let name = format!("{} {}", text("kind"), text("scope"));
        let unit = text("unit");
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        found.push((
            operation,
            index,
            format!(
                "here is the worst place of `{}`: {}{unit}, required {} {}{unit}",
                name.trim_end(),
                base::units::trim(number("found"), 6),
                text("relation"),
                base::units::trim(number("bound"), 6)
            ),
        ));
    }
    for surface in list("surfaces") {
        let name = surface["surface"].as_str().unwrap_or_default();
        for (key, what) in [("gouge", "deepest cut into"), ("excess", "most material left on")] {
            let Some((operation, index)) = at(&surface[key]["at"]) else { continue };
            let mm = surface[key][if key == "gouge" { "depth" } else { "value" }].as_f64().unwrap_or_default();
            found.push((operation, index, format!("here is the {what} {name}: {:.2} um", mm * 1e3)));
        }
    }
    found
}
