//! `impellerc import`: blade files to a part in the language.

use super::file_form::Form;
use super::reading;
use super::{Outcome, Stages, or_reported, output_names, shown_path};
use crate::output::Outputs;
use base::source::{SourceFile, SourceMap, Span};
use blade::SectionForm;
use blade_files::faced_part;
use blade_files::job_frame::Zero;
use blade_files::outlines::{doubtful, outlines};
use blade_files::part_source::{PartSource, WITHIN};
use blade_files::part_text;
use blade_files::{Imported, ImportedRow, NoFile, Options, limits};
use diagnostics::codes::import as codes;
use diagnostics::{Aborted, Diag, printable};
use std::path::{Path, PathBuf};

/// An import.
#[derive(Clone, Debug, Default)]
pub struct Import {
    /// Blade files, or a folder with them.
    pub files: Vec<PathBuf>,
    /// File to write the part to. Tables of points are written beside it.
    pub output: Option<PathBuf>,
    /// Row of blades, where the files have several.
    pub row: Option<String>,
    /// Replace files that exist.
    pub force: bool,
    /// Faces ruled from the first to the last section are meant, however far the sections between them lie off the faces.
    pub ruled: bool,
    /// Largest distance of the part from the files, mm; `None` for the usual one.
    pub within: Option<f64>,
    /// Zero of the part that is written.
    pub zero: Zero,
    /// What the caller states of the files.
    pub options: Options,
}

/// Reads blade files, says what they hold, and writes a part.
pub fn import(options: &Import, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &Import, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let (files, mut said) = part(options, stages, outcome)?;
    let Outcome { sources, sink, emitted, .. } = outcome;
    match (&options.output, files) {
        (Some(path), Some(files)) => {
            let written = stages.run("write", || write(path, &files, options.force, sources));
            said.push_str(&or_reported(written, sink)?);
        }
        (_, None) => said.push_str("nothing written\n"),
        (None, Some(_)) => said.push_str("nothing written: no `-o FILE`\n"),
    }
    *emitted = Some(said);
    Ok(())
}

/// The part of blade files, and what is said of it; no part for files whose content is only listed.
pub(super) fn part(
    options: &Import,
    stages: &mut Stages,
    outcome: &mut Outcome,
) -> Result<(Option<part_text::PartFiles>, String), Aborted> {
    let Outcome { sources, sink, .. } = outcome;
    let names = or_reported(names(&options.files), sink)?;
    let read = stages.run("read", || blade_files::read(&names, &mut fetch, &options.options, sources));
    let mut imported = read.map_err(|diags| {
        diags.into_iter().for_each(|diag| sink.push(diag));
        Aborted
    })?;
    if let Some(stated) = options.options.fillet {
        imported.rows.iter_mut().flat_map(|row| &mut row.blades).for_each(|blade| blade.fillet = Some(stated));
    }
    if !imported.listing.is_empty() {
        or_reported(only_listed(&imported, options), sink)?;
        let lines: String = imported.listing.iter().map(|line| format!("{line}\n")).collect();
        return Ok((None, lines + &notes(&imported, sources)));
    }
    let row = or_reported(row(&imported, options.row.as_deref()), sink)?;
    if let Some(path) = &options.output {
        or_reported(output_names::check("-o", path, Form::Job), sink)?;
        or_reported(placed(row).and_then(|()| fits(&imported, row)), sink)?;
    }
    let divided = stages.run("divide", || outlines(row, imported.hub.as_deref(), &options.options));
    let divided = or_reported(divided, sink)?;
    for (blade, divided) in row.blades.iter().zip(&divided) {
        doubtful(blade, divided).into_iter().for_each(|diag| sink.push(diag));
    }
    let read: Vec<String> = names.iter().map(|name| own_name(name)).collect();
    let stem = options.output.as_ref().and_then(|path| path.file_stem()).map(|s| s.display().to_string());
    let name = printable(stem.as_deref().unwrap_or("part")).into_owned();
    let source = PartSource::new(&imported, row, &divided, &read, &name, options.zero);
    if options.output.is_some() && !options.ruled {
        or_reported(source.lies_within(options.within.unwrap_or(WITHIN)), sink)?;
    }
    let mut said: String = part_text::summary(&source).into_iter().map(|line| line + "\n").collect();
    said.push_str(&notes(&imported, sources));
    Ok((Some(faced_part::write(&source)), said))
}

/// Refuses to write a part from a file whose content is only listed.
fn only_listed(imported: &Imported, options: &Import) -> Result<(), Diag> {
    if options.output.is_none() {
        return Ok(());
    }
    let at = imported.notes.last().and_then(|note| note.span).unwrap_or_default();
    Err(Diag::error(codes::NOT_READ, format!("a part is not written from the format {}", imported.format))
        .label(at, "no face of this file is picked, or has a name of our own export")
        .help("leave out `-o` to list the faces, then pick them by number or name with `--face`; `impellerc import --help` names the roles"))
}

/// Refuses to write splitters of which it is not known where they stand: whether the angles of their sections hold the pitch
/// fraction.
fn placed(row: &ImportedRow) -> Result<(), Diag> {
    let Some(blade) = row.blades.iter().find(|blade| blade.pitch_share.is_some()) else { return Ok(()) };
    let at = blade.places.first().copied().unwrap_or_default();
    Err(Diag::error(codes::NOT_READ, "a part with splitters is not written from this format")
        .label(at, "it is not known whether these angles hold the pitch fraction of the splitter")
        .help("export the blades as points, such as `.inf` with its curve files: they show where the splitters stand"))
}

/// Refuses to write what a job cannot have.
fn fits(imported: &Imported, row: &ImportedRow) -> Result<(), Diag> {
    let too_many = |count: usize, most: usize, what: &str, at: Span| {
        Diag::error(codes::TOO_MUCH, format!("{count} {what}: a job has at most {most}"))
            .label(at, "this one exceeds it")
            .help("leave out `-o` to see what the file holds; export fewer points or sections to write a part")
    };
    let most = limits::POINTS_OF_JOB_CURVE;
    for blade in &row.blades {
        let place = |k: usize| blade.places.get(k).copied().unwrap_or_default();
        if blade.sections.len() > limits::SECTIONS_OF_JOB {
            let at = place(limits::SECTIONS_OF_JOB);
            return Err(too_many(blade.sections.len(), limits::SECTIONS_OF_JOB, "sections of a blade", at));
        }
        for (k, section) in blade.sections.iter().enumerate() {
            let count = match &section.form {
                SectionForm::Loop(points) | SectionForm::DividedLoop { points, .. } => points.len(),
                SectionForm::Faces(faces) => faces.iter().map(Vec::len).max().unwrap_or(0),
                SectionForm::MeanLine { points, .. } => points.len(),
            };
            if count > most {
                return Err(too_many(count, most, "points of a section", place(k)));
            }
        }
    }
    for (name, line) in [("hub", &imported.hub), ("shroud", &imported.shroud)] {
        let count = line.as_ref().map_or(0, Vec::len);
        if count > most {
            let at = row.blades.first().and_then(|blade| blade.places.first()).copied().unwrap_or_default();
            return Err(too_many(count, most, &format!("points of the {name}"), at));
        }
    }
    Ok(())
}

/// File name of a path.
fn own_name(name: &str) -> String {
    let name = Path::new(name).file_name().map_or_else(|| name.to_owned(), |n| n.display().to_string());
    printable(&name).into_owned()
}

/// What was found or taken for granted, with its place.
fn notes(imported: &Imported, sources: &SourceMap) -> String {
    let line = |note: &blade_files::Note| {
        let span = note.span?;
        let file = sources.get(span.source)?;
        Some(format!("  {}:{}: {}\n", own_name(&file.name), sources.line_column(span).0, note.text))
    };
    let lines: String = imported.notes.iter().filter_map(line).collect();
    format!("\nfound and taken for granted\n{lines}\n")
}

/// The row of a name, or the only one.
fn row<'a>(imported: &'a Imported, name: Option<&str>) -> Result<&'a ImportedRow, Diag> {
    let rows = &imported.rows;
    let known = || rows.iter().map(|row| format!("`{}`", printable(&row.name))).collect::<Vec<_>>().join(", ");
    match (name, rows.as_slice()) {
        (Some(name), _) => rows.iter().find(|row| row.name == name).ok_or_else(|| {
            Diag::error(codes::NOT_STATED, format!("there is no row `{}`", printable(name)))
                .help(format!("give `--row` one of {}", known()))
        }),
        (None, [row]) => Ok(row),
        (None, rows) => {
            Err(Diag::error(codes::NOT_STATED, format!("the files have {} rows of blades, not one", rows.len()))
                .help(format!("state `--row`: {}", known())))
        }
    }
}

/// Names of the given files. Of a folder these are its files with an ending of a format; a file that names others is taken
/// alone.
fn names(given: &[PathBuf]) -> Result<Vec<String>, Diag> {
    let mut names = Vec::new();
    for path in given {
        if !path.is_dir() {
            names.push(path.display().to_string());
            continue;
        }
        let entries = std::fs::read_dir(path)
            .map_err(|e| reading::unreadable(path, &e, "a folder with blade files, or the files themselves"))?;
        let mut inside: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(|p| p.is_file()).collect();
        inside.sort();
        let ending = |p: &Path| p.extension().map(|e| e.display().to_string().to_ascii_lowercase()).unwrap_or_default();
        let mut of_formats: Vec<PathBuf> = Vec::new();
        for (_, endings) in blade_files::formats() {
            of_formats = inside.iter().filter(|p| endings.contains(&ending(p).as_str())).cloned().collect();
            if !of_formats.is_empty() {
                break;
            }
        }
        if of_formats.is_empty() {
            return Err(Diag::error(
                codes::UNKNOWN_FORMAT,
                format!("the folder {} has no blade files", path.display()),
            )
            .help("name the files; `impellerc explain IMP1001` lists their endings"));
        }
        names.extend(of_formats.iter().map(|p| p.display().to_string()));
    }
    Ok(names)
}

/// Reads a file.
fn fetch(name: &str, most: usize) -> Result<SourceFile, NoFile> {
    let path = Path::new(name);
    let regular = std::fs::metadata(path).map_err(|e| reading::reason(&e))?.is_file();
    if !regular {
        return Err("it is not a regular file".to_owned().into());
    }
    let most = u64::try_from(most).unwrap_or(u64::MAX);
    let bytes = reading::read(path, most).map_err(|e| reading::reason(&e))?;
    let bytes = bytes.ok_or(NoFile::TooLarge)?;
    let text = String::from_utf8(bytes).map_err(|e| reading::no_text(&e))?;
    Ok(SourceFile { disk: path.canonicalize().ok(), ..SourceFile::text(printable(name), text) })
}

/// The tables of a part beside the file of its job.
pub(super) fn tables<'a>(path: &Path, made: &'a part_text::PartFiles) -> Vec<(PathBuf, &'a str)> {
    let with_ending = |ending: &str| path.with_extension(ending);
    let mut tables: Vec<(PathBuf, &str)> =
        vec![(with_ending("curves.csv"), &made.curves), (with_ending("sections.csv"), &made.sections)];
    tables.extend(made.loops.iter().map(|(blade, text)| (with_ending(&format!("{blade}.csv")), text.as_str())));
    tables.extend(made.meridian.iter().map(|text| (with_ending("meridian.csv"), text.as_str())));
    tables
}

/// Writes the part and its tables, all or none.
fn write(path: &Path, made: &part_text::PartFiles, force: bool, sources: &SourceMap) -> Result<String, Diag> {
    let mut written: Vec<(PathBuf, &str)> = vec![(path.to_path_buf(), &made.job)];
    written.extend(tables(path, made));
    let exists = written.iter().find(|(path, _)| !force && std::fs::symlink_metadata(path).is_ok());
    if let Some((path, _)) = exists {
        return Err(Diag::error(codes::EXISTS, format!("{} exists already", path.display()))
            .note("nothing was written; no file was changed")
            .help("give another name, or state `--force` to replace the part and its tables"));
    }
    let mut outputs = Outputs::default();
    outputs.protect_sources(sources);
    for (path, _) in &written {
        outputs.announce("-o", path)?;
    }
    for (path, text) in &written {
        outputs.stage("-o", path, text.as_bytes())?;
    }
    outputs.commit()?;
    Ok(written.iter().map(|(path, _)| format!("wrote {}\n", shown_path(path))).collect())
}
