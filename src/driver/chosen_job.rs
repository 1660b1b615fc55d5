//! `impellerc new FILE --from PART`: the tools and operations for a part that has none, as a job.

use super::front::read_job;
use super::new_job::{new_file, write_new};
use super::{DiskFiles, Outcome, Stages, or_reported, shown_path};
use ::syntax::ast::{File, Item, ItemKind};
use base::source::{SourceFile, SourceId, SourceMap};
use choose::{Chosen, Tried};
use diagnostics::codes::job as codes;
use diagnostics::{Aborted, Diag, Sink};
use ir::Program;
use ir::program::DEFAULT_MEMORY;
use job::Files;
use std::path::{Path, PathBuf};

/// Machine, tools and post of a part that states none.
const MACHINE: &str = "generic-ac-table";
const TOOLS: &str = "five-axis";
const POST: &str = "siemens-840d";

/// A job that is made for a part.
#[derive(Clone, Debug, Default)]
pub struct FromPart {
    /// File to write; it does not exist.
    pub file: PathBuf,
    /// A job with a part, and without tools and operations.
    pub part: PathBuf,
    /// Machine of a part that names none.
    pub machine: Option<String>,
    /// Material of the stock, for a part without stock.
    pub material: Option<String>,
    /// Folder with machines, tools and posts.
    pub library: Option<PathBuf>,
    /// Print all that was tried.
    pub explain: bool,
}

/// Chooses tools and operations for a part, and writes the job.
pub fn new_from(options: &FromPart, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &FromPart, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let Outcome { sources, sink, emitted, .. } = outcome;
    let file = or_reported(new_file(&options.file), sink)?;
    let text = read_job(&options.part, sink)?;
    let source = sources.add_file(SourceFile::text(shown_path(&options.part), text.clone()));
    let ast = ::syntax::parse(&text, source, sink);
    if sink.has_errors() {
        return Err(Aborted);
    }
    or_reported(open(&ast), sink)?;
    let head = head(&text, &ast, options);
    let library = tool_names(&head, options, sink)?;
    // Places of faults are those in the text with what was added.
    *sources = SourceMap::default();
    let source = sources.add_file(SourceFile::text(shown_path(&options.part), head.clone()));
    let mut found = Sink::default();
    let chosen = stages.watched("choose", |progress| {
        let mut front = |text: &str, sink: &mut Sink| program(text, options, sink);
        choose::choose(&head, &library, &mut front, progress, &mut found)
    });
    found.change_all(|diag| placed_in(source, head.len(), diag));
    sink.append(found);
    let chosen = chosen?;
    stages.go_on()?;
    // A text that was read without a fault has a usual form.
    let usual = ::syntax::format(&chosen.job, SourceId::default(), &mut Sink::default());
    or_reported(write_new(&file, usual.as_deref().unwrap_or(&chosen.job)), sink)?;
    *emitted = Some(said(&file, &chosen, options.explain));
    Ok(())
}

/// A diagnostic with those of its places that lie in a text; others are in what is chosen, or in files that it names.
fn placed_in(source: SourceId, length: usize, mut diag: Diag) -> Diag {
    diag.labels.retain(|label| label.span.source == source && label.span.range().end <= length);
    diag.fix = None;
    diag
}

/// Refuses a job whose tools and operations are there.
fn open(ast: &File) -> Result<(), Diag> {
    let is_chosen = |item: &&Item| matches!(item.kind, ItemKind::Tool { .. } | ItemKind::Operation { .. });
    let Some(item) = ast.items.iter().find(is_chosen) else { return Ok(()) };
    Err(Diag::error(codes::GIVEN_TWICE, "the job of the part has tools or operations of its own")
        .label(item.span, "nothing is left to choose")
        .help("give a file with the part alone: remove its tools and operations, or compile it as it is"))
}

/// The job of the part with what every job needs and this one does not state.
fn head(text: &str, ast: &File, options: &FromPart) -> String {
    let has = |is: &dyn Fn(&ItemKind) -> bool| ast.items.iter().any(|item| is(&item.kind));
    let used = |what: &str| has(&|kind| matches!(kind, ItemKind::Use { kind, .. } if kind.text == what));
    let edition = ast.items.iter().find(|item| matches!(item.kind, ItemKind::Edition(_)));
    // Behind the line of the edition, whose end may be part of the item.
    let at = edition.map_or(0, |item| text[..item.span.range().end].trim_end().len());
    let mut added = String::new();
    if !used("machine") {
        added += &format!("\nuse machine \"{}\"", options.machine.as_deref().unwrap_or(MACHINE));
    }
    if !used("tools") {
        added += &format!("\nuse tools \"{TOOLS}\"");
    }
    let mut head = format!("{}{added}{}", &text[..at], &text[at..]);
    if !has(&|kind| matches!(kind, ItemKind::Stock { .. })) {
        let material = options.material.as_ref().map_or(String::new(), |material| format!("  material {material}"));
        head += &format!("\n{}{material} }}\n", choose::STOCK);
    }
    if !has(&|kind| matches!(kind, ItemKind::Post { .. })) {
        head += &format!("\npost {POST}\n");
    }
    head
}

/// Files of the job that is made: those beside the part.
fn disk(options: &FromPart) -> Result<DiskFiles, Diag> {
    DiskFiles::new(&options.part, options.library.as_deref(), None)
}

/// Names of the tools in the libraries of a job.
fn tool_names(head: &str, options: &FromPart, sink: &mut Sink) -> Result<Vec<String>, Aborted> {
    let mut sources = SourceMap::default();
    let ast = ::syntax::parse(head, SourceId::default(), &mut Sink::default());
    let mut disk = or_reported(disk(options), sink)?;
    let used = ast.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Use { kind, what } if kind.text == "tools" => Some(what.text.as_str()),
        _ => None,
    });
    // One that is missing is reported with its place where the job is resolved.
    let found: Vec<SourceId> =
        used.filter_map(|name| disk.tools(name).ok()).map(|file| sources.add_file(file)).collect();
    Ok(job::library_tools(&found, &sources))
}

/// The program of a text.
fn program(text: &str, options: &FromPart, sink: &mut Sink) -> Result<Program, Aborted> {
    let mut sources = SourceMap::default();
    let source = sources.add_file(SourceFile::text(shown_path(&options.part), text.to_owned()));
    let ast = ::syntax::parse(text, source, sink);
    let mut files = or_reported(disk(options), sink)?;
    let job = job::resolve(&ast, &mut files, &mut sources, sink)?;
    lower::lower(&job, sink)
}

/// What was chosen, for people.
fn said(file: &Path, chosen: &Chosen, explain: bool) -> String {
    let job = shown_path(file);
    let mut text = String::new();
    if explain {
        for Tried { what, fault } in &chosen.tried {
            text += &format!("tried {what}: {}\n", fault.as_deref().unwrap_or("holds"));
        }
        text.push('\n');
    }
    for line in &chosen.summary {
        text += &format!("{line}\n");
    }
    let gigabytes = (chosen.memory / 1e9).ceil();
    let memory = if chosen.memory > DEFAULT_MEMORY { format!(" --memory {gigabytes}GB") } else { String::new() };
    text + &format!(
        "\nwrote {job}; {} trials, which `--explain-choices` lists\n\
         impellerc {job}{memory} -o {}    plans all of it, verifies it and writes the NC program\n",
        chosen.tried.len(),
        shown_path(&file.with_extension("nc")),
    )
}
