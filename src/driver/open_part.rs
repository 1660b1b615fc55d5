//! A part from a job or from blade files, with what every job needs added where the text does not state it: what all choices of tools
//! and operations begin with.

use super::import::{self, Import};
use super::job_file::{read_job, take_names};
use super::{DiskFiles, Outcome, RunOptions, Stages, or_reported, shown_path};
use ::syntax::ast::{File, Item, ItemKind};
use base::source::{SourceFile, SourceId, SourceMap};
use choose::{Chosen, Effort, OpenText};
use diagnostics::{Aborted, Diag, Severity, Sink};
use ir::Program;
use job::{Files, MissingFile};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Machine, tools and post of a part that states none.
const MACHINE: &str = "generic-ac-table";
const TOOLS: &str = "five-axis";
const POST: &str = "siemens-840d";

/// Where a part comes from, and what is added to it.
#[derive(Clone, Debug, Default)]
pub struct PartInput {
    /// A job with a part; or blade files, as an import takes them.
    pub files: Import,
    /// Machine of a part that names none.
    pub machine: Option<String>,
    /// Material of the stock, for a part without stock.
    pub material: Option<String>,
    /// Folder with machines, tools and posts.
    pub library: Option<PathBuf>,
}

/// The text of a part, with the tables that it names.
pub(super) struct PartText<'s> {
    source: &'s PartInput,
    /// File of the text; for blade files that of the job, beside which the tables will lie.
    pub(super) file: PathBuf,
    text: String,
    /// Tables that are made, by the file that each is written to.
    pub(super) tables: Vec<(PathBuf, String)>,
    /// What an import says of it.
    pub(super) said: String,
    /// Library, curves, and machine and post in the place of those of the text.
    run: RunOptions,
}

impl<'s> PartText<'s> {
    /// A job as it stands, with the options of a run.
    pub(super) fn of_job(source: &'s PartInput, job: &Path, text: String, run: &RunOptions) -> Self {
        let (file, run) = (job.to_path_buf(), run.clone());
        Self { source, file, text, tables: Vec::new(), said: String::new(), run }
    }

    /// A job as it stands, or what an import makes of blade files.
    pub(super) fn read(
        source: &'s PartInput,
        file: &Path,
        stages: &mut Stages,
        outcome: &mut Outcome,
    ) -> Result<Self, Aborted> {
        let run = RunOptions { library: source.library.clone(), ..RunOptions::default() };
        if let [job] = &source.files.files[..]
            && job.extension().is_none_or(|ending| ending == "imp")
            && !job.is_dir()
        {
            let text = read_job(job, &mut outcome.sink)?;
            return Ok(Self::of_job(source, job, text, &run));
        }
        let import = Import { output: Some(file.to_path_buf()), ..source.files.clone() };
        let (made, said) = import::part(&import, stages, outcome)?;
        let Some(made) = made else { return Err(Aborted) };
        let tables: Vec<(PathBuf, String)> =
            import::tables(file, &made).into_iter().map(|(path, text)| (path, text.to_owned())).collect();
        Ok(Self { source, file: file.to_path_buf(), text: made.job, tables, said: said + "\n", run })
    }

    /// Its items; faults are those of the text.
    pub(super) fn parsed(&self, outcome: &mut Outcome) -> Result<File, Aborted> {
        let Outcome { sources, sink, .. } = outcome;
        let source = sources.add_file(SourceFile::text(shown_path(&self.file), self.text.clone()));
        let ast = ::syntax::parse(&self.text, source, sink);
        if sink.has_errors() { Err(Aborted) } else { Ok(ast) }
    }

    /// Its text with all that a job needs: machine, tools, stock and post, and with what is to be chosen.
    pub(super) fn with_all(&self, ast: &File) -> String {
        let open = if ast.is_open() { "" } else { "\noperations auto\n" };
        head(&self.text, ast, self.source) + open
    }

    /// Its text with a stock.
    pub(super) fn with_stock(&self, ast: &File) -> String {
        with_stock(&self.text, ast, self.source)
    }

    /// What a text of this part leaves open.
    pub(super) fn choose(
        &self,
        text: &str,
        effort: Effort<'_, '_>,
        stages: &mut Stages,
        outcome: &mut Outcome,
    ) -> Result<Chosen, Aborted> {
        let Outcome { sources, sink, .. } = outcome;
        // Places of faults are those in the text with what was added.
        *sources = SourceMap::default();
        let source = sources.add_file(SourceFile::text(shown_path(&self.file), text.to_owned()));
        let ast = ::syntax::parse(text, source, sink);
        let mut found = Sink::default();
        if !sink.has_errors() {
            self.understand(&ast, sources, &mut found)?;
        }
        if sink.has_errors() || found.has_errors() {
            found
                .diags()
                .iter()
                .filter(|diag| diag.severity == Severity::Error)
                .for_each(|diag| sink.push(diag.clone()));
            return Err(Aborted);
        }
        let library = self.tool_names(&ast, sink)?;
        // Behind an open place the texts that are tried have other places.
        let same = ast.items.iter().find(|item| item.is_open()).map_or(text.len(), |item| item.span.range().start);
        let mut found = Sink::default();
        let chosen = stages.watched("choose", |progress| {
            let mut front = |text: &str, sink: &mut Sink| self.program(text, sink);
            let open = OpenText { text, ast: &ast, library: &library };
            choose::choose(open, &mut front, effort, progress, &mut found)
        });
        found.change_all(|diag| placed_in(source, same, diag));
        // Warnings of a text that nobody wrote have no place in one that is shown.
        let shown = |diag: &&Diag| diag.severity == Severity::Error || !diag.labels.is_empty();
        found.diags().iter().filter(shown).for_each(|diag| sink.push(diag.clone()));
        let chosen = chosen?;
        stages.go_on()?;
        Ok(chosen)
    }

    /// Names of the tools in the libraries of a job.
    fn tool_names(&self, ast: &File, sink: &mut Sink) -> Result<Vec<String>, Aborted> {
        let mut sources = SourceMap::default();
        let mut files = or_reported(self.files(), sink)?;
        let used = ast.items.iter().filter_map(|item| match &item.kind {
            ItemKind::Use { kind, what } if kind.text == "tools" => Some(what.text.as_str()),
            _ => None,
        });
        // One that is missing is reported with its place where the job is resolved.
        let found: Vec<SourceId> =
            used.filter_map(|name| files.tools(name).ok()).map(|file| sources.add_file(file)).collect();
        Ok(job::library_tools(&found, &sources))
    }

    /// The program of a text.
    pub(super) fn program(&self, text: &str, sink: &mut Sink) -> Result<Program, Aborted> {
        let mut sources = SourceMap::default();
        let source = sources.add_file(SourceFile::text(shown_path(&self.file), text.to_owned()));
        let mut ast = ::syntax::parse(text, source, sink);
        let mut files = or_reported(self.files(), sink)?;
        take_names(&self.run, &mut ast, &mut files.disk, sink)?;
        let job = job::resolve(&ast, &mut files, &mut sources, sink)?;
        lower::lower(&job, sink)
    }

    /// The faults of what the job says itself.
    fn understand(&self, ast: &File, sources: &mut SourceMap, sink: &mut Sink) -> Result<(), Aborted> {
        let mut ast = ast.clone();
        let mut files = or_reported(self.files(), sink)?;
        take_names(&self.run, &mut ast, &mut files.disk, sink)?;
        job::understand(&ast, &mut files, sources, sink);
        Ok(())
    }

    /// Its tables, and the files beside it.
    fn files(&self) -> Result<FilesAndTables, Diag> {
        let disk = DiskFiles::new(&self.file, self.run.library.as_deref(), self.run.curves.as_deref())?;
        let name = |path: &Path| path.file_name().map(|name| name.display().to_string()).unwrap_or_default();
        let tables = self.tables.iter().map(|(path, text)| (name(path), text.clone())).collect();
        Ok(FilesAndTables { disk, tables })
    }
}

/// Files of a part: tables that are not written yet, and what lies beside it.
struct FilesAndTables {
    disk: DiskFiles,
    tables: BTreeMap<String, String>,
}

impl Files for FilesAndTables {
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.disk.machine(name)
    }

    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.disk.tools(name)
    }

    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.disk.post(name)
    }

    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        match self.tables.get(path) {
            Some(text) => Ok(SourceFile::text(path, text.clone())),
            None => self.disk.curves(path),
        }
    }

    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        self.disk.mesh(path)
    }
}

/// A diagnostic with those of its places that lie in a text; others are in what is chosen, or in files that it names.
fn placed_in(source: SourceId, length: usize, mut diag: Diag) -> Diag {
    diag.labels.retain(|label| label.span.source == source && label.span.range().end <= length);
    diag.fix = None;
    diag
}

/// The first tool or operation of a job.
pub(super) fn given(ast: &File) -> Option<&Item> {
    ast.items.iter().find(|item| matches!(item.kind, ItemKind::Tool { .. } | ItemKind::Operation { .. }))
}

/// The job of the part with what every job needs and this one does not state.
fn head(text: &str, ast: &File, source: &PartInput) -> String {
    let has = |is: &dyn Fn(&ItemKind) -> bool| ast.items.iter().any(|item| is(&item.kind));
    let used = |what: &str| has(&|kind| matches!(kind, ItemKind::Use { kind, .. } if kind.text == what));
    let edition = ast.items.iter().find(|item| matches!(item.kind, ItemKind::Edition(_)));
    // Behind the line of the edition, whose end may be part of the item.
    let at = edition.map_or(0, |item| text[..item.span.range().end].trim_end().len());
    let mut added = String::new();
    if !used("machine") {
        added += &format!("\nuse machine \"{}\"", source.machine.as_deref().unwrap_or(MACHINE));
    }
    if !used("tools") {
        added += &format!("\nuse tools \"{TOOLS}\"");
    }
    let mut head = with_stock(&format!("{}{added}{}", &text[..at], &text[at..]), ast, source);
    if !has(&|kind| matches!(kind, ItemKind::Post { .. })) {
        head += &format!("\npost {POST}\n");
    }
    head
}

/// A job with a stock, where it has none: one that is chosen.
fn with_stock(text: &str, ast: &File, source: &PartInput) -> String {
    if ast.items.iter().any(|item| matches!(item.kind, ItemKind::Stock { .. })) {
        return text.to_owned();
    }
    let material = source.material.as_ref().map_or(String::new(), |material| format!("  material {material}"));
    format!("{text}\n{}{material} }}\n", choose::STOCK)
}
