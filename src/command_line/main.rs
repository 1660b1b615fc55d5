//! Command line of the compiler.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arguments;
mod import_arguments;
mod quantities;
mod watch;

use arguments::{Arguments, Command, EffortArgument, ErrorFormat, LibraryArguments, ReadingArguments};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use impellerc::diagnostics::junit::junit;
use impellerc::diagnostics::sarif::sarif;
use impellerc::diagnostics::{Code, Exit, render};
use impellerc::driver::{
    self, BEGINNINGS, ChoiceOptions, ChooseOptions, Format, FromPart, LibraryKind, NcCheck, NcDiff, Options, Outcome,
    PartInput, QuoteOptions, RunOptions, Stages,
};
use impellerc::job::vocabulary;
use impellerc::output::interrupt;
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use watch::Watch;

fn main() -> ExitCode {
    if let Some(text) = no_command(&std::env::args_os().skip(1).take(2).collect::<Vec<_>>()) {
        say(&text);
        return ended(Exit::Text);
    }
    let mut arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(fault) => {
            let Some(word) = behind_a_job(&fault) else { fault.exit() };
            say(&format!("one run takes one job or one command, and `{word}` stands behind the job\n"));
            return ended(Exit::Text);
        }
    };
    if let Some(fault) = arguments.fault() {
        fault.exit();
    }
    match arguments.command.take() {
        Some(command) => commanded(command),
        None => {
            let (how, watch) = (Display::new(arguments.run.error_format, arguments.run.timings), arguments.watch);
            let options = arguments.options();
            let job = options.job.clone();
            repeated(how, watch.then_some(&job), |stages| driver::compile(&options, stages))
        }
    }
}

/// Runs a command.
fn commanded(command: Command) -> ExitCode {
    match command {
        Command::Explain { reference: true, .. } => printed(vocabulary::reference().as_bytes()),
        Command::Explain { words, .. } => explain(&words.join(" ")),
        Command::New {
            file,
            from: Some(part),
            machine,
            material,
            library,
            effort,
            explain_choices: explain,
            of_files,
            ..
        } => {
            let part = PartInput { files: of_files.import(vec![part]), machine, material, library };
            let whole = matches!(effort, EffortArgument::Whole);
            let options = FromPart { file, part, explain, whole };
            finish(Display::HUMAN, |stages| driver::new_from(&options, stages))
        }
        Command::Choose { job, output, machine, effort, explain_choices: explain, reading } => {
            let choice = ChoiceOptions { effort: effort.into(), explain };
            chosen(job, output, RunOptions { machine, choice, ..RunOptions::default() }, reading)
        }
        Command::Quote { part, machine, material, library, json, hour_price, kilogram_price, of_files } => {
            let part = PartInput { files: of_files.import(part), machine, material, library };
            let options = QuoteOptions { part, json, hour: hour_price, kilogram: kilogram_price };
            finish(Display::HUMAN, |stages| driver::quoted(&options, stages))
        }
        Command::New { file, kind, .. } => {
            let kind = BEGINNINGS.iter().find(|b| b.name == kind).unwrap_or(&BEGINNINGS[0]);
            finish(Display::HUMAN, |_| driver::new_job(&file, kind))
        }
        Command::Fmt { jobs, check, error_format } => {
            finish(Display::new(error_format, false), |_| driver::format(&Format { jobs, only_check: check }))
        }
        Command::Lsp { library } => language_server(library),
        Command::Machines(arguments) => listed(LibraryKind::Machines, &arguments),
        Command::Tools(arguments) => listed(LibraryKind::Tools, &arguments),
        Command::Posts(arguments) => listed(LibraryKind::Posts, &arguments),
        Command::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "impellerc", &mut text);
            printed(&text)
        }
        Command::Man => manual(),
        Command::Check { job, post, machine, memory, fits, watch, reading } => {
            let ReadingArguments { library, curves, timings, error_format } = reading;
            let run = RunOptions { library, curves, post, machine, memory, ..RunOptions::default() };
            let options = Options { job, run, fits, ..Options::default() };
            let watched = watch.then_some(&options.job);
            repeated(Display::new(error_format, timings), watched, |stages| driver::check(&options, stages))
        }
        Command::Report { job, output, post, watch, run } => {
            let how = Display::new(run.error_format, run.timings);
            let name = job.file_stem().map(PathBuf::from).unwrap_or_default();
            let report = output.unwrap_or_else(|| name.with_extension("html"));
            let options = Options { job, run: run.options(post, Some(report)), ..Options::default() };
            repeated(how, watch.then_some(&options.job), |stages| driver::compile(&options, stages))
        }
        Command::Verify { nc, job, post, certificate, source_map, report, run } => {
            let how = Display::new(run.error_format, run.timings);
            let check = NcCheck { nc, job, certificate, source_map, run: run.options(post, report) };
            finish(how, |stages| driver::verify(&check, stages))
        }
        Command::Import(arguments) => {
            let how = Display::new(arguments.error_format, false);
            let options = arguments.options();
            finish(how, |stages| driver::import(&options, stages))
        }
        Command::Diff { first, second, job, other_machine, machine, reading } => {
            let ReadingArguments { library, curves, timings, error_format } = reading;
            let run = RunOptions { library, machine, curves, ..RunOptions::default() };
            let options = NcDiff { nc: [first, second], job, other_machine, run };
            finish(Display::new(error_format, timings), |stages| driver::diff(&options, stages))
        }
    }
}

/// Chooses what a job leaves open.
fn chosen(job: PathBuf, output: Option<PathBuf>, run: RunOptions, reading: ReadingArguments) -> ExitCode {
    let ReadingArguments { library, curves, timings, error_format } = reading;
    let options = ChooseOptions { job, output, run: RunOptions { library, curves, ..run } };
    finish(Display::new(error_format, timings), |stages| driver::choose_job(&options, stages))
}

/// Serves an editor until it ends the service.
fn language_server(library: Option<PathBuf>) -> ExitCode {
    let (connection, threads) = lsp_server::Connection::stdio();
    let served = driver::serve(&connection, library);
    // The threads end when both ends of the connection are gone.
    drop(connection);
    let ended_well = served.and_then(|()| threads.join().map_err(|e| e.to_string()));
    match ended_well {
        Ok(()) => ended(Exit::Holds),
        Err(reason) => {
            say(&format!("the language service ended: {reason}\n"));
            ended(Exit::File)
        }
    }
}

/// Lists the library, or shows a file of it.
fn listed(kind: LibraryKind, arguments: &LibraryArguments) -> ExitCode {
    let LibraryArguments { name, library, schema } = arguments;
    if *schema {
        return printed(driver::library_schema(kind).as_bytes());
    }
    finish(Display::HUMAN, |_| driver::list_library(kind, name.as_deref(), library.as_deref()))
}

/// Prints the manual page: that of the command, and behind it those of its commands.
fn manual() -> ExitCode {
    let mut command = Arguments::command();
    command.build();
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = clap_mangen::Man::new(command.clone()).render(&mut text);
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        let name = format!("impellerc {}", sub.get_name());
        let _ = clap_mangen::Man::new(sub.clone().display_name(name)).render(&mut text);
    }
    printed(&text)
}

/// Writes to standard output, with the exit code for the shell.
fn printed(text: &[u8]) -> ExitCode {
    ended(if print(text) { Exit::Holds } else { Exit::File })
}

/// Most letters by which a word differs from the command that was meant.
const MISSPELT: usize = 2;

/// Words of other compilers for what `impellerc` does with a job without a command.
const COMPILES: &[&str] = &["compile", "build", "run", "make", "plan", "post", "generate", "emit", "nc", "mill", "cam"];

/// Words of other programs, and the command that does this here.
const OTHER_COMMANDS: &[(&str, &str)] = &[
    ("validate", "check"),
    ("lint", "check"),
    ("test", "check"),
    ("analyse", "check"),
    ("analyze", "check"),
    ("prove", "verify"),
    ("simulate", "verify"),
    ("judge", "verify"),
    ("compare", "diff"),
    ("expand-auto", "choose"),
    ("auto", "choose"),
    ("init", "new"),
    ("create", "new"),
    ("start", "new"),
    ("template", "new"),
    ("format", "fmt"),
    ("show", "report"),
    ("view", "report"),
    ("convert", "import"),
    ("read", "import"),
    ("load", "import"),
    ("docs", "explain"),
    ("doc", "explain"),
    ("serve", "lsp"),
    ("server", "lsp"),
    ("list", "machines"),
    ("ls", "machines"),
    ("library", "machines"),
    ("manual", "man"),
    ("holders", "tools"),
    ("controls", "posts"),
    ("dialects", "posts"),
];

/// What to say of a first word that is neither a file nor a command, or of a second word behind a job.
fn no_command(words: &[OsString]) -> Option<String> {
    let (first, second) = (words.first()?.to_str()?, words.get(1).and_then(|word| word.to_str()));
    let names: Vec<String> = Arguments::command().get_subcommands().map(|c| c.get_name().to_owned()).collect();
    if first.starts_with('-') || first == "help" || names.iter().any(|name| name == first) {
        return None;
    }
    let second = second.filter(|word| !word.starts_with('-') && !word.is_empty());
    if Path::new(first).exists() {
        let second = second?;
        return Some(if names.iter().any(|name| name == second) {
            format!("the command stands before the job: `impellerc {second} {first}`\n")
        } else {
            format!(
                "one run takes one job, and `{second}` stands behind `{first}`: compile each job by itself; `-o {second}` \
                 names the NC file\n"
            )
        });
    }
    if first.contains(['.', '/', '\\']) && second.is_none() {
        // A job that does not exist.
        return None;
    }
    let word = first.to_lowercase();
    let job = second.unwrap_or("JOB.imp");
    let close = format!("there is no command `{first}`, and no file of this name");
    // `complie`, but not `new` for `nc`.
    let slip = |known: &&str| known.len() > MISSPELT + 2 && strsim::osa_distance(known, &word) <= MISSPELT;
    if COMPILES.contains(&word.as_str()) || COMPILES.iter().any(slip) {
        return Some(format!(
            "{close}: a job is compiled without a command. Write `impellerc {job} -o PART.nc`; `impellerc check {job}` only \
             judges it\n"
        ));
    }
    let other = OTHER_COMMANDS.iter().find(|(other, _)| *other == word).map(|(_, command)| (*command).to_owned());
    let near = names.iter().map(|name| (strsim::osa_distance(name, &word), name));
    let near = near.filter(|(letters, _)| *letters <= MISSPELT).min().map(|(_, name)| name.clone());
    match other.or(near) {
        Some(name) => {
            Some(format!("{close}; did you mean the command `{name}`? `impellerc --help` lists all commands\n"))
        }
        None => second.map(|_| format!("{close}; the commands are {}\n", names.join(", "))),
    }
}

/// The word behind a job that can be neither an option nor a command.
fn behind_a_job(fault: &clap::Error) -> Option<String> {
    match (fault.kind(), fault.get(ContextKind::InvalidSubcommand)?) {
        (ErrorKind::ArgumentConflict, ContextValue::String(word)) => Some(word.clone()),
        _ => None,
    }
}

/// How a run is shown.
#[derive(Clone, Copy)]
struct Display {
    format: ErrorFormat,
    timings: bool,
}

impl Display {
    /// For people, without times.
    const HUMAN: Self = Self { format: ErrorFormat::Human, timings: false };

    fn new(format: ErrorFormat, timings: bool) -> Self {
        Self { format, timings }
    }

    /// Stages of a run, which show their progress on a terminal.
    fn stages(self) -> Stages {
        let mut stages = Stages::default();
        stages.progress = self.format == ErrorFormat::Human && std::io::stderr().is_terminal();
        stages
    }

    /// Prints what a run found.
    fn print(self, outcome: &Outcome, stages: &Stages) -> Exit {
        let colour = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
        let (sink, sources) = (&outcome.sink, &outcome.sources);
        say(&match self.format {
            ErrorFormat::Human => render::human(sink, sources, colour),
            ErrorFormat::Json => render::json(sink, sources),
            ErrorFormat::Sarif => sarif(sink, sources),
            ErrorFormat::Junit => junit(sink, sources, &outcome.judged()),
        });
        if self.timings && matches!(self.format, ErrorFormat::Human | ErrorFormat::Json) {
            say(&stages.report());
        }
        let written = outcome.emitted.as_ref().is_none_or(|text| print(text.as_bytes()));
        let exit = Exit::of_run(sink);
        if written { exit } else { exit.max(Exit::File) }
    }
}

/// Runs the work once and reports its diagnostics.
fn finish(how: Display, work: impl FnOnce(&mut Stages) -> Outcome) -> ExitCode {
    interrupt::watch(how.format == ErrorFormat::Human);
    let mut stages = how.stages();
    let outcome = work(&mut stages);
    ended(how.print(&outcome, &stages))
}

/// Runs the work once; with a job to watch, again after each change, until a signal ends the program.
fn repeated(how: Display, watched: Option<&PathBuf>, work: impl Fn(&mut Stages) -> Outcome) -> ExitCode {
    let Some(job) = watched else { return finish(how, work) };
    interrupt::watch(how.format == ErrorFormat::Human);
    let mut watch = Watch::new(job);
    loop {
        interrupt::begin();
        let mut stages = how.stages();
        let outcome = watch.cancelled_by_changes(&stages.state(), || work(&mut stages));
        if !stages.state().is_cancelled() {
            how.print(&outcome, &stages);
            watch.take_files(&outcome);
            if how.format == ErrorFormat::Human {
                say(&watch.waits_for());
            }
        }
        watch.wait();
    }
}

/// Prints the page of a code or of a word of the language, or the list of all codes.
fn explain(topic: &str) -> ExitCode {
    let text = match topic {
        "" => {
            let mut codes: Vec<Code> = Code::all().collect();
            codes.sort_by_key(|c| c.id());
            codes.iter().map(|c| format!("{}  {}\n", c.id(), c.0.title)).collect()
        }
        topic => {
            let code = Code::find(topic).or_else(|| Code::find(&format!("IMP{topic:0>4}")));
            let page = code.map(|found| format!("{}: {}\n\n{}\n", found.id(), found.0.title, found.0.page.trim_end()));
            let Some(page) = page.or_else(|| vocabulary::explain(topic)) else {
                let near = vocabulary::words().into_iter().map(|word| (strsim::osa_distance(word, topic), word));
                let near = near.filter(|(letters, _)| *letters <= MISSPELT).min();
                let meant = near.map_or_else(String::new, |(_, word)| format!("; did you mean `{word}`?"));
                say(&format!(
                    "no message has the code {topic}, and the language has no such word{meant}\n\
                     `impellerc explain` lists all codes, `impellerc explain --reference` all words\n"
                ));
                return ended(Exit::Text);
            };
            page
        }
    };
    printed(text.as_bytes())
}

/// The exit code for the shell.
fn ended(exit: Exit) -> ExitCode {
    ExitCode::from(exit.number())
}

/// Writes to standard output; false when the output was closed, as by `head`.
fn print(text: &[u8]) -> bool {
    let mut out = std::io::stdout().lock();
    out.write_all(text).and_then(|()| out.flush()).is_ok()
}

/// Writes to standard error; a failure cannot be reported anywhere.
fn say(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}
