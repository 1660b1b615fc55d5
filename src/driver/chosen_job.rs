//! `impellerc new FILE --from PART`: the tools and operations for a part that has none, as a job. The part is a job without
//! them, or blade files.

use super::before_planning::{check_frames, check_part_and_machine};
use super::front::read_job;
use super::import::{self, Import};
use super::new_job::{new_file, write_new};
use super::{DiskFiles, Outcome, Stages, or_reported, shown_path};
use ::syntax::ast::{File, Item, ItemKind};
use base::entity::EntityId;
use base::progress::Progress;
use base::source::{SourceFile, SourceId, SourceMap};
use choose::{Chosen, Judgement, Load, Tried};
use diagnostics::codes::job as codes;
use diagnostics::{Aborted, Diag, Sink};
use ir::program::DEFAULT_MEMORY;
use ir::{OperationId, Program};
use job::{Files, MissingFile};
use plan::facts;
use plan::passes::pipeline;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use verify::stock::{OperationStock, Settings};

/// Machine, tools and post of a part that states none.
const MACHINE: &str = "generic-ac-table";
const TOOLS: &str = "five-axis";
const POST: &str = "siemens-840d";

/// A job that is made for a part.
#[derive(Clone, Debug, Default)]
pub struct FromPart {
    /// File to write; it does not exist.
    pub file: PathBuf,
    /// A job with a part, and without tools and operations; or blade files, as an import takes them.
    pub part: Import,
    /// Machine of a part that names none.
    pub machine: Option<String>,
    /// Material of the stock, for a part without stock.
    pub material: Option<String>,
    /// Folder with machines, tools and posts.
    pub library: Option<PathBuf>,
    /// Print all that was tried.
    pub explain: bool,
    /// Plan and prove the whole job, and correct what loads a tool over its limits.
    pub whole: bool,
}

/// Chooses tools and operations for a part, and writes the job.
pub fn new_from(options: &FromPart, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &FromPart, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let sink = &mut outcome.sink;
    let file = or_reported(new_file(&options.file), sink)?;
    let part = Part::read(options, &file, stages, outcome)?;
    let Outcome { sources, sink, emitted, .. } = outcome;
    let text = &part.text;
    let source = sources.add_file(SourceFile::text(shown_path(&part.file), text.clone()));
    let ast = ::syntax::parse(text, source, sink);
    if sink.has_errors() {
        return Err(Aborted);
    }
    or_reported(open(&ast), sink)?;
    let head = head(text, &ast, options);
    let library = tool_names(&head, &part, options, sink)?;
    // Places of faults are those in the text with what was added.
    *sources = SourceMap::default();
    let source = sources.add_file(SourceFile::text(shown_path(&part.file), head.clone()));
    let mut found = Sink::default();
    let chosen = stages.watched("choose", |progress| {
        let mut front = |text: &str, sink: &mut Sink| program(text, &part, options, sink);
        let mut judge = |program: &Program, progress: &Progress| judged(program, progress);
        choose::choose(&head, &library, &mut front, options.whole.then_some(&mut judge), progress, &mut found)
    });
    found.change_all(|diag| placed_in(source, head.len(), diag));
    sink.append(found);
    let chosen = chosen?;
    stages.go_on()?;
    // A text that was read without a fault has a usual form.
    let usual = ::syntax::format(&chosen.job, SourceId::default(), &mut Sink::default());
    or_reported(write_new(&file, usual.as_deref().unwrap_or(&chosen.job), &part.tables), sink)?;
    *emitted = Some(part.said + &said(&file, &part.tables, &chosen, options.explain));
    Ok(())
}

/// What plan and proof of a whole job say, as a compile does, with as much memory as it needs.
fn judged(program: &Program, progress: &Progress) -> Judgement {
    let mut sink = Sink::default();
    let memory = program.memory.max(plan::budget::needed(program));
    let program = &Program { memory, ..program.clone() };
    let certificate = planned_and_proved(program, progress, &mut sink);
    let fault = (certificate.is_err() || sink.has_errors()).then(|| choose::first_error(&sink));
    let mut loads = vec![Load::default(); program.operations.len()];
    for (k, o) in certificate.iter().flatten() {
        let tool = &program.tools[program.operations[*k].tool];
        let share = |value: Option<f64>, limit: f64| value.map_or(0.0, |value| value / limit);
        loads[k.index()] = Load {
            depth: share(o.slot_depth.map(|load| load.value.get()), tool.max_depth.get()),
            chip: share(o.chip.map(|chip| chip.value.get()), tool.max_chip.get()),
        };
    }
    Judgement { fault, loads }
}

/// The operations of a program with what they do to the stock.
fn planned_and_proved(
    program: &Program,
    progress: &Progress,
    sink: &mut Sink,
) -> Result<Vec<(OperationId, OperationStock)>, Aborted> {
    check_part_and_machine(program, sink)?;
    let post = check_frames(program, sink)?;
    facts::check(program, progress, sink);
    if sink.has_errors() {
        return Err(Aborted);
    }
    let plan = pipeline::run_with(program, progress, sink)?;
    let (judged, certificate) = verify::examine(program, plan.motion, &mut Settings::default(), progress, sink)?;
    let motion = match &judged {
        Ok(verified) => verified,
        Err(refused) => refused,
    };
    post.check(program, motion, sink);
    let of = |o: OperationStock| Some((motion.operations.get(o.operation as usize)?.operation, o));
    Ok(certificate.stock.into_iter().flat_map(|stock| stock.operations).filter_map(of).collect())
}

/// The text of a part, with the tables that it names.
struct Part {
    /// File of the text; for blade files that of the job, beside which the tables will lie.
    file: PathBuf,
    text: String,
    /// Tables that are made, by the file that each is written to.
    tables: Vec<(PathBuf, String)>,
    /// What an import says of it.
    said: String,
}

impl Part {
    /// A job as it stands, or what an import makes of blade files.
    fn read(options: &FromPart, file: &Path, stages: &mut Stages, outcome: &mut Outcome) -> Result<Self, Aborted> {
        if let [job] = &options.part.files[..]
            && job.extension().is_none_or(|ending| ending == "imp")
            && !job.is_dir()
        {
            let text = read_job(job, &mut outcome.sink)?;
            return Ok(Self { file: job.clone(), text, tables: Vec::new(), said: String::new() });
        }
        let import = Import { output: Some(file.to_path_buf()), ..options.part.clone() };
        let (made, said) = import::part(&import, stages, outcome)?;
        let Some(made) = made else { return Err(Aborted) };
        let tables: Vec<(PathBuf, String)> =
            import::tables(file, &made).into_iter().map(|(path, text)| (path, text.to_owned())).collect();
        // Before the choice takes its time.
        for (path, _) in &tables {
            or_reported(new_file(path), &mut outcome.sink)?;
        }
        Ok(Self { file: file.to_path_buf(), text: made.job, tables, said: said + "\n" })
    }

    /// Its tables, and the files beside it.
    fn files(&self, options: &FromPart) -> Result<FilesAndTables, Diag> {
        let disk = DiskFiles::new(&self.file, options.library.as_deref(), None)?;
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

/// Names of the tools in the libraries of a job.
fn tool_names(head: &str, part: &Part, options: &FromPart, sink: &mut Sink) -> Result<Vec<String>, Aborted> {
    let mut sources = SourceMap::default();
    let ast = ::syntax::parse(head, SourceId::default(), &mut Sink::default());
    let mut files = or_reported(part.files(options), sink)?;
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
fn program(text: &str, part: &Part, options: &FromPart, sink: &mut Sink) -> Result<Program, Aborted> {
    let mut sources = SourceMap::default();
    let source = sources.add_file(SourceFile::text(shown_path(&part.file), text.to_owned()));
    let ast = ::syntax::parse(text, source, sink);
    let mut files = or_reported(part.files(options), sink)?;
    let job = job::resolve(&ast, &mut files, &mut sources, sink)?;
    lower::lower(&job, sink)
}

/// What was chosen, for people.
fn said(file: &Path, tables: &[(PathBuf, String)], chosen: &Chosen, explain: bool) -> String {
    let job = shown_path(file);
    let beside: String = tables.iter().map(|(path, _)| format!(", {}", shown_path(path))).collect();
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
    let verdict = match chosen.judged.as_ref().map(|judged| &judged.fault) {
        None => "\nnot planned as a whole: `--effort whole` does, and corrects feeds and steps\n".to_owned(),
        Some(None) => "\nthe whole job holds: planned and verified in all of its sectors\n".to_owned(),
        Some(Some(fault)) => format!("\nthe whole job does not hold: {fault}\n"),
    };
    text + &verdict
        + &format!(
            "wrote {job}{beside}; {} trials, which `--explain-choices` lists\n\
         impellerc {job}{memory} -o {}    plans all of it, verifies it and writes the NC program\n",
            chosen.tried.len(),
            shown_path(&file.with_extension("nc")),
        )
}
