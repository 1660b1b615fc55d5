//! Command line of the compiler.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod import_arguments;

use clap::builder::PossibleValuesParser;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use impellerc::diag::junit::junit;
use impellerc::diag::sarif::sarif;
use impellerc::diag::{Code, Exit, render};
use impellerc::driver::{
    self, BEGINNINGS, Emit, Format, LibraryKind, NcCheck, NcDiff, Options, Outcome, PartForm, PartOptions, RunOptions,
    Stages,
};
use impellerc::export::step::StepProtocol;
use impellerc::job::vocabulary;
use impellerc::output::interrupt;
use import_arguments::ImportArguments;
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Exit codes, for the help.
const EXIT_CODES: &str = "Exit codes:
  0  no error: every contract holds; warnings and remarks do not count
  1  a contract fails, the motion has a fault such as a collision, or the certificate belongs to another NC text
  2  job, library, NC text, certificate or command line has a fault, or no program can be planned for the job
  3  a file cannot be read or written
If several apply, the largest is returned. A run writes all outputs or none. An output must not be an input of the run.";

/// Values of `--emit` that are written to the file of `-o`.
const PART_FORMS: [(&str, &str); 4] = [("emit", "step"), ("emit", "stl"), ("emit", "3mf"), ("emit", "sections")];

/// Exit codes of a check, for the help.
const CHECK_CODES: &str = "Exit codes:
  0  no error; warnings and remarks do not count
  1  the control cannot have this machine, or cannot do what the job asks for
  2  job, library or command line has a fault, or the facts show that no program can be planned
  3  a file cannot be read";

/// Exit codes of an import, for the help.
const IMPORT_CODES: &str = "Exit codes:
  0  the blades were read; warnings do not count
  2  a file or the command line has a fault, or leaves out what no option states
  3  a file cannot be read or written";

/// Exit codes of the commands that write or list texts, for the help.
const TEXT_CODES: &str = "Exit codes:
  0  done
  1  `--check`: a job is not in its usual form
  2  a text or the command line has a fault
  3  a file cannot be read or written";

/// Exit codes of a comparison, for the help.
const DIFF_CODES: &str = "Exit codes:
  0  for the machine both texts are the same
  1  an operation differs
  2  job, library, NC text or command line has a fault
  3  a file cannot be read";

/// Compiles the job of an impeller into a verified five-axis NC program
#[derive(Parser)]
#[command(version, about, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    /// Job file
    #[arg(required = true)]
    job: Option<PathBuf>,

    /// Write the NC text to this file; without this option the job is planned and verified, but no NC text is written
    #[arg(short, long, value_name = "FILE", required_if_eq_any = PART_FORMS)]
    output: Option<PathBuf>,

    /// Write the NC text with this post file of the library instead of the post of the job, such as linuxcnc
    #[arg(long, value_name = "NAME")]
    post: Option<String>,

    /// Print the result of this stage, and stop after it; forms of the part are written to the file of `-o`
    #[arg(long, value_enum, value_name = "STAGE")]
    emit: Option<EmitArgument>,

    /// Application protocol of the STEP file
    #[arg(long, value_enum, default_value = "ap242", value_name = "PROTOCOL")]
    step_protocol: ProtocolArgument,

    /// Largest chord error of the triangles of STL and 3MF, from 0.1 um to 1 mm, such as 10um
    #[arg(long, default_value = "10um", value_name = "LENGTH", value_parser = chord)]
    chord: f64,

    /// Number of sections of each blade, from 2 to 101
    #[arg(long, default_value = "11", value_name = "NUMBER", value_parser = sections)]
    sections: usize,

    /// Write the certificate to this file, with the hash of the NC text
    #[arg(long, value_name = "FILE.json")]
    certificate: Option<PathBuf>,

    /// Write a picture of the part and the paths to this file
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,

    /// Write the source map to this file: of each block the cutter location, pass, operation and line of the job
    #[arg(long, value_name = "FILE.json")]
    source_map: Option<PathBuf>,

    /// Write the setup sheet to this file: zero, tools, restart points, checks before the first run; HTML or Markdown
    #[arg(long, value_name = "FILE.html")]
    setup_sheet: Option<PathBuf>,

    #[command(flatten)]
    run: RunArguments,
}

impl Arguments {
    /// How the part is written.
    fn part_options(&self) -> PartOptions {
        let protocol = match self.step_protocol {
            ProtocolArgument::Ap242 => StepProtocol::Ap242,
            ProtocolArgument::Ap214 => StepProtocol::Ap214,
        };
        PartOptions { protocol, chord: self.chord, sections: self.sections }
    }
}

/// What both commands take.
#[derive(Args)]
struct RunArguments {
    /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,

    /// Use this machine of the library instead of the machine of the job
    #[arg(long, value_name = "NAME")]
    machine: Option<String>,

    /// Allow `spline from` to read curve files in this folder too, not only in the folder of the job
    #[arg(long, value_name = "DIR")]
    curves: Option<PathBuf>,

    /// Write a report for a browser to this file: deviations, paths, stock, plots, contracts; also if a contract fails
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,

    /// Cell size of the stock simulation, at most 1 mm (more for parts over 200 mm); default 1/8 of the radius of the
    /// smallest cutter, 1/20 where the job requires `engagement`
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    stock_cell: Option<f64>,

    /// Write the stock after each operation to this folder, as STL files
    #[arg(long, value_name = "DIR")]
    stock: Option<PathBuf>,

    /// Largest memory for planning or for the check of NC text, such as 4GB; default 2GB
    #[arg(long, value_name = "SIZE", value_parser = memory, allow_hyphen_values = true)]
    memory: Option<f64>,

    /// Print all figures of the proof: surfaces with places, stock, axes, active limits, how the operations were planned
    #[arg(long)]
    details: bool,

    /// Print the time of each stage; has no effect with the formats `sarif` and `junit`
    #[arg(long)]
    timings: bool,

    /// Format of errors, warnings and remarks
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    error_format: ErrorFormat,
}

impl RunArguments {
    /// The options in the form of the driver.
    fn options(self, post: Option<String>) -> RunOptions {
        let Self { library, curves, machine, report, stock_cell, stock, memory, details, .. } = self;
        RunOptions { library, curves, post, machine, report, stock_cell, stock, memory, details }
    }
}

/// What the commands take that read a job and plan nothing.
#[derive(Args)]
struct ReadingArguments {
    /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,

    /// Allow `spline from` to read curve files in this folder too, not only in the folder of the job
    #[arg(long, value_name = "DIR")]
    curves: Option<PathBuf>,

    /// Print the time of each stage; has no effect with the formats `sarif` and `junit`
    #[arg(long)]
    timings: bool,

    /// Format of errors, warnings and remarks
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    error_format: ErrorFormat,
}

/// What the commands take that list the library.
#[derive(Args)]
struct LibraryArguments {
    /// Name of the file to show, without `.toml`
    name: Option<String>,

    /// Search this folder first (subfolders `machines`, `tools` and `posts`)
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,
}

/// The words of the jobs to begin with.
fn beginnings() -> PossibleValuesParser {
    BEGINNINGS.map(|b| clap::builder::PossibleValue::new(b.name).help(b.about)).into()
}

#[derive(Subcommand)]
enum Command {
    /// Explains the code of a message, such as IMP0206, or a word of the language: item, operation, tool, property, unit
    Explain {
        /// Code such as IMP0206 or 206, or word such as `flank`, `scallop`, `mm/min`; without it, all codes are listed
        words: Vec<String>,

        /// Print the reference of the language: all items, operations, tools, properties, quantities and units
        #[arg(long, conflicts_with = "words")]
        reference: bool,
    },
    /// Writes a commented job that compiles, to begin with
    #[command(after_help = TEXT_CODES)]
    New {
        /// File to write; it must not exist. Its name becomes the name of the part
        file: PathBuf,

        /// What the job makes: `vanes`, eight ruled vanes from curves of points, all operations; `pump`, a wheel with five long
        /// vanes, roughed with three tools; `turbo`, a compressor wheel with splitters, written by angles and thicknesses
        #[arg(long, value_name = "KIND", default_value = BEGINNINGS[0].name, value_parser = beginnings())]
        kind: String,
    },
    /// Writes jobs in their usual form: indentation and blanks; words, numbers and comments stay as they are
    #[command(after_help = TEXT_CODES)]
    Fmt {
        /// Job files; `-` formats standard input to standard output
        #[arg(required = true)]
        jobs: Vec<PathBuf>,

        /// Write nothing; tell which jobs are not in their usual form
        #[arg(long)]
        check: bool,

        /// Format of errors, warnings and remarks
        #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
        error_format: ErrorFormat,
    },
    /// Serves editors over standard input and output, by the language server protocol
    Lsp {
        /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
        #[arg(long, value_name = "DIR")]
        library: Option<PathBuf>,
    },
    /// Lists the machines that jobs can use, with where they come from, or shows the file of one
    #[command(after_help = TEXT_CODES)]
    Machines(LibraryArguments),
    /// Lists the tool libraries that jobs can use, with where they come from, or shows the file of one
    #[command(after_help = TEXT_CODES)]
    Tools(LibraryArguments),
    /// Lists the post files that jobs can use, with where they come from, or shows the file of one
    #[command(after_help = TEXT_CODES)]
    Posts(LibraryArguments),
    /// Prints the completions of a shell: `impellerc completions bash > impellerc.bash`
    Completions {
        /// Shell
        shell: Shell,
    },
    /// Prints the manual page in the format of `man`, with all commands
    Man,
    /// Judges a job without planning it: text, machine, post, memory, and facts about the part
    #[command(after_help = CHECK_CODES)]
    Check {
        /// Job file
        job: PathBuf,

        /// Post file of the library instead of the post of the job
        #[arg(long, value_name = "NAME")]
        post: Option<String>,

        /// Use this machine of the library instead of the machine of the job
        #[arg(long, value_name = "NAME")]
        machine: Option<String>,

        /// Largest memory that planning may need, such as 4GB; default 2GB
        #[arg(long, value_name = "SIZE", value_parser = memory, allow_hyphen_values = true)]
        memory: Option<f64>,

        #[command(flatten)]
        reading: ReadingArguments,
    },
    /// Verifies NC text from any source against a job, a certificate or both
    #[command(after_help = EXIT_CODES)]
    Verify {
        /// NC file
        nc: PathBuf,

        /// Job with the part, the tools and the contracts
        #[arg(long, value_name = "FILE")]
        job: Option<PathBuf>,

        /// Dialect of the NC text; default: the dialect of the job, unless the words of the text show another one
        #[arg(long, value_name = "NAME")]
        post: Option<String>,

        /// Certificate that must belong to the NC text
        #[arg(long, value_name = "FILE.json")]
        certificate: Option<PathBuf>,

        /// Source map of the NC text: findings say for which pass and line of the job a block was written. The text may
        /// have been edited since
        #[arg(long, value_name = "FILE.json")]
        source_map: Option<PathBuf>,

        #[command(flatten)]
        run: Box<RunArguments>,
    },
    /// Reads blades from files of designers, says what they hold, and writes a part in the job language
    #[command(after_help = IMPORT_CODES)]
    Import(Box<ImportArguments>),
    /// Tells what differs for the machine between two NC texts of one job: poses, speeds, times, ranges of the axes.
    /// The texts may be in two dialects
    #[command(after_help = DIFF_CODES)]
    Diff {
        /// First NC file
        first: PathBuf,

        /// Second NC file
        second: PathBuf,

        /// Job of both texts
        #[arg(long, value_name = "FILE")]
        job: PathBuf,

        /// Machine of the second text, where it is another one than that of the first
        #[arg(long, value_name = "NAME")]
        other_machine: Option<String>,

        /// Machine of both texts instead of the machine of the job
        #[arg(long, value_name = "NAME")]
        machine: Option<String>,

        #[command(flatten)]
        reading: ReadingArguments,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ErrorFormat {
    /// Text for people, with the lines of the job
    Human,
    /// One JSON object on each line
    Json,
    /// SARIF 2.1.0, for code reviews
    Sarif,
    /// JUnit XML, for build servers
    Junit,
}

#[derive(Clone, Copy, ValueEnum)]
enum EmitArgument {
    /// Syntax tree of the job
    Ast,
    /// Job with all defaults
    Job,
    /// Geometry of part, stock, tools and operations
    Ir,
    /// Cutter contacts
    Cc,
    /// Cutter locations
    Cl,
    /// Positions of the machine axes
    Motion,
    /// NC text
    Nc,
    /// The part as a solid in a STEP file, which `-o` names
    Step,
    /// The part as triangles in an STL file, which `-o` names
    Stl,
    /// The part as triangles in a 3MF file, which `-o` names
    #[value(name = "3mf")]
    ThreeMf,
    /// Sections of the blades for TurboGrid: the `.inf` file that `-o` names, with files of hub, shroud and profiles beside it
    Sections,
}

#[derive(Clone, Copy, ValueEnum)]
enum ProtocolArgument {
    /// ISO 10303-242
    Ap242,
    /// ISO 10303-214
    Ap214,
}

fn main() -> ExitCode {
    if let Some(text) = misspelt_command(std::env::args_os().nth(1)) {
        say(&text);
        return ended(Exit::Text);
    }
    let arguments = Arguments::parse();
    let part = arguments.part_options();
    let Arguments { command, job, output, post, emit, certificate, picture, source_map, setup_sheet, run, .. } =
        arguments;
    match command {
        Some(Command::Explain { reference: true, .. }) => printed(vocabulary::reference().as_bytes()),
        Some(Command::Explain { words, .. }) => explain(&words.join(" ")),
        Some(Command::New { file, kind }) => {
            let kind = BEGINNINGS.iter().find(|b| b.name == kind).unwrap_or(&BEGINNINGS[0]);
            finish(ErrorFormat::Human, false, |_| driver::new_job(&file, kind))
        }
        Some(Command::Fmt { jobs, check, error_format }) => {
            finish(error_format, false, |_| driver::format(&Format { jobs, only_check: check }))
        }
        Some(Command::Lsp { library }) => language_server(library),
        Some(Command::Machines(arguments)) => listed(LibraryKind::Machines, &arguments),
        Some(Command::Tools(arguments)) => listed(LibraryKind::Tools, &arguments),
        Some(Command::Posts(arguments)) => listed(LibraryKind::Posts, &arguments),
        Some(Command::Completions { shell }) => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "impellerc", &mut text);
            printed(&text)
        }
        Some(Command::Man) => manual(),
        Some(Command::Check { job, post, machine, memory, reading }) => {
            let ReadingArguments { library, curves, timings, error_format } = reading;
            let run = RunOptions { library, curves, post, machine, memory, ..RunOptions::default() };
            let options = Options { job, run, ..Options::default() };
            finish(error_format, timings, |stages| driver::check(&options, stages))
        }
        Some(Command::Verify { nc, job, post, certificate, source_map, run }) => {
            let (format, timings) = (run.error_format, run.timings);
            let check = NcCheck { nc, job, certificate, source_map, run: run.options(post) };
            finish(format, timings, |stages| driver::verify(&check, stages))
        }
        Some(Command::Import(arguments)) => {
            let format = arguments.error_format;
            let options = arguments.options();
            finish(format, false, |stages| driver::import(&options, stages))
        }
        Some(Command::Diff { first, second, job, other_machine, machine, reading }) => {
            let ReadingArguments { library, curves, timings, error_format } = reading;
            let run = RunOptions { library, machine, curves, ..RunOptions::default() };
            let options = NcDiff { nc: [first, second], job, other_machine, run };
            finish(error_format, timings, |stages| driver::diff(&options, stages))
        }
        None => {
            let (format, timings) = (run.error_format, run.timings);
            let options = Options {
                job: job.unwrap_or_default(),
                output,
                picture,
                source_map,
                setup_sheet,
                certificate,
                emit: emit.map(|e| match e {
                    EmitArgument::Ast => Emit::Ast,
                    EmitArgument::Job => Emit::Job,
                    EmitArgument::Ir => Emit::Ir,
                    EmitArgument::Cc => Emit::Cc,
                    EmitArgument::Cl => Emit::Cl,
                    EmitArgument::Motion => Emit::Motion,
                    EmitArgument::Nc => Emit::Nc,
                    EmitArgument::Step => Emit::Part(PartForm::Step),
                    EmitArgument::Stl => Emit::Part(PartForm::Stl),
                    EmitArgument::ThreeMf => Emit::Part(PartForm::ThreeMf),
                    EmitArgument::Sections => Emit::Part(PartForm::Sections),
                }),
                part,
                run: run.options(post),
            };
            finish(format, timings, |stages| driver::compile(&options, stages))
        }
    }
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
    let LibraryArguments { name, library } = arguments;
    finish(ErrorFormat::Human, false, |_| driver::list_library(kind, name.as_deref(), library.as_deref()))
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

/// What to say of a first word that is no file and nearly a command.
fn misspelt_command(word: Option<OsString>) -> Option<String> {
    let word = word?.into_string().ok().filter(|word| !word.starts_with('-') && !Path::new(word).exists())?;
    let names: Vec<String> = Arguments::command().get_subcommands().map(|c| c.get_name().to_owned()).collect();
    if names.contains(&word) || word == "help" {
        return None;
    }
    let near = names.iter().map(|name| (strsim::osa_distance(name, &word.to_lowercase()), name));
    let (_, name) = near.filter(|(letters, _)| *letters <= MISSPELT).min()?;
    Some(format!(
        "there is no file `{word}`; did you mean the command `{name}`? `impellerc --help` lists all commands\n"
    ))
}

/// Millimetres of a chord error such as `10um` or `0.01 mm`.
fn chord(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let units = [("um", 1e-3), ("mm", 1.0)];
    let split = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)));
    let length = split.and_then(|(number, size)| Some(number.trim().parse::<f64>().ok()? * size));
    let within = length.filter(|mm| (0.999e-4..=1.0).contains(mm));
    within.ok_or_else(|| "the chord error must be from 0.1um to 1mm, such as 10um".to_owned())
}

/// Number of sections of a blade.
fn sections(text: &str) -> Result<usize, String> {
    let number = text.trim().parse().ok().filter(|n| (2..=101).contains(n));
    number.ok_or_else(|| "a blade has from 2 to 101 sections".to_owned())
}

/// Number of bytes of a size such as `4GB` or `500 MB`.
fn memory(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let units = [("GB", 1e9), ("MB", 1e6)];
    let split = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)));
    let bytes = split.and_then(|(number, size)| Some(number.trim().parse::<f64>().ok()? * size));
    let within = bytes.filter(|b| (1e8..=1e13).contains(b));
    within.ok_or_else(|| "the size must be from 100MB to 10000GB, such as 4GB".to_owned())
}

/// Runs the work and reports its diagnostics.
fn finish(format: ErrorFormat, timings: bool, work: impl FnOnce(&mut Stages) -> Outcome) -> ExitCode {
    let terminal = std::io::stderr().is_terminal();
    let human = format == ErrorFormat::Human;
    let mut stages = Stages::default();
    stages.progress = terminal && human;
    interrupt::watch(human);
    let outcome = work(&mut stages);
    let colour = terminal && std::env::var_os("NO_COLOR").is_none();
    let (sink, sources) = (&outcome.sink, &outcome.sources);
    say(&match format {
        ErrorFormat::Human => render::human(sink, sources, colour),
        ErrorFormat::Json => render::json(sink, sources),
        ErrorFormat::Sarif => sarif(sink, sources),
        ErrorFormat::Junit => junit(sink, sources, &outcome.judged()),
    });
    if timings && matches!(format, ErrorFormat::Human | ErrorFormat::Json) {
        say(&stages.report());
    }
    let written = outcome.emitted.is_none_or(|text| print(text.as_bytes()));
    let exit = Exit::of_run(sink);
    ended(if written { exit } else { exit.max(Exit::File) })
}

/// Prints the page of a code or of a word of the language, or the list of all codes.
fn explain(asked: &str) -> ExitCode {
    let text = match asked {
        "" => {
            let mut codes: Vec<Code> = Code::all().collect();
            codes.sort_by_key(|c| c.id());
            codes.iter().map(|c| format!("{}  {}\n", c.id(), c.0.title)).collect()
        }
        asked => {
            let code = Code::find(asked).or_else(|| Code::find(&format!("IMP{asked:0>4}")));
            let page = code.map(|found| format!("{}: {}\n\n{}\n", found.id(), found.0.title, found.0.page.trim_end()));
            let Some(page) = page.or_else(|| vocabulary::explain(asked)) else {
                let near = vocabulary::words().into_iter().map(|word| (strsim::osa_distance(word, asked), word));
                let near = near.filter(|(letters, _)| *letters <= MISSPELT).min();
                let meant = near.map_or_else(String::new, |(_, word)| format!("; did you mean `{word}`?"));
                say(&format!(
                    "no message has the code {asked}, and the language has no such word{meant}\n\
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
