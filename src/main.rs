//! Command line of the compiler.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

use clap::{Args, Parser, Subcommand, ValueEnum};
use impellerc::diag::junit::junit;
use impellerc::diag::sarif::sarif;
use impellerc::diag::{Code, Exit, render};
use impellerc::driver::{self, Emit, NcCheck, Options, Outcome, RunOptions, Stages};
use impellerc::output::interrupt;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit codes, for the help.
const EXIT_CODES: &str = "Exit codes:
  0  all holds
  1  a contract fails, or there is a finding: NC text that does what it must not, a certificate that does not belong to it
  2  job, library, NC text, certificate or command line cannot be understood, or no program can be made of the job
  3  a file cannot be read or written
Of several the largest counts. Outputs are written together or not at all; none may be a file that the run reads.";

/// Compiles a job that declares an impeller into verified five-axis NC.
#[derive(Parser)]
#[command(version, about, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    /// Job file
    #[arg(required = true)]
    job: Option<PathBuf>,

    /// File to write the NC text to; without this option everything is checked and no NC text is written
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Dialect to write instead of the job's
    #[arg(long, value_name = "NAME")]
    post: Option<String>,

    /// Print a stage of the compilation and stop there
    #[arg(long, value_enum, value_name = "STAGE")]
    emit: Option<EmitArgument>,

    /// File to write the certificate to, with the hash of the NC text
    #[arg(long, value_name = "FILE.json")]
    certificate: Option<PathBuf>,

    /// File to write a picture of the part and the paths to
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,

    #[command(flatten)]
    run: RunArguments,
}

/// What both commands take.
#[derive(Args)]
struct RunArguments {
    /// Folder with `machines` and `tools` that is searched first
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,

    /// Machine file to take instead of the job's, by its name in the library
    #[arg(long, value_name = "NAME")]
    machine: Option<String>,

    /// Folder with curve files that `spline from` may read, beside those below the job's folder
    #[arg(long, value_name = "DIR")]
    curves: Option<PathBuf>,

    /// File to write a report for a browser to: deviations, paths, stock, plots, contracts; also when a contract fails
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,

    /// Edge of the cells of the stock simulation, to make it finer; usually 1 mm, more for parts over 200 mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    stock_cell: Option<f64>,

    /// Folder to write the stock after each operation to, as STL
    #[arg(long, value_name = "DIR")]
    stock: Option<PathBuf>,

    /// Memory that planning may take, such as 4GB; usually 2GB
    #[arg(long, value_name = "SIZE", value_parser = memory, allow_hyphen_values = true)]
    memory: Option<f64>,

    /// Print the time of each stage; not beside `sarif` and `junit`, which are one document
    #[arg(long)]
    timings: bool,

    /// How to report faults
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    error_format: ErrorFormat,
}

impl RunArguments {
    /// The options in the form of the driver.
    fn options(self, post: Option<String>) -> RunOptions {
        let Self { library, curves, machine, report, stock_cell, stock, memory, .. } = self;
        RunOptions { library, curves, post, machine, report, stock_cell, stock, memory }
    }
}

#[derive(Subcommand)]
enum Command {
    /// Explains a code such as IMP0206: what it means, why it matters, an example, the remedy
    Explain {
        /// The code, or its digits; without it all codes are listed
        code: Option<String>,
    },
    /// Measures NC text of any origin against a job
    #[command(after_help = EXIT_CODES)]
    Verify {
        /// NC text
        nc: PathBuf,

        /// Job that the text must fulfil
        #[arg(long, value_name = "FILE")]
        job: Option<PathBuf>,

        /// Dialect of the text; by default that of the job, or the dialect that the words of the text clearly show
        #[arg(long, value_name = "NAME")]
        post: Option<String>,

        /// Certificate that the text must belong to
        #[arg(long, value_name = "FILE.json")]
        certificate: Option<PathBuf>,

        #[command(flatten)]
        run: Box<RunArguments>,
    },
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ErrorFormat {
    /// Marked text for people
    Human,
    /// One JSON object a line
    Json,
    /// SARIF 2.1.0, for comments of a review
    Sarif,
    /// JUnit XML, for build servers
    Junit,
}

#[derive(Clone, Copy, ValueEnum)]
enum EmitArgument {
    /// Syntax tree of the job text
    Ast,
    /// Job with every default
    Job,
    /// Part, stock, tools and operations as geometry
    Ir,
    /// Contact points of the cutter
    Cc,
    /// Cutter locations
    Cl,
    /// Axis positions of the machine
    Motion,
    /// NC text
    Nc,
}

fn main() -> ExitCode {
    let Arguments { command, job, output, post, emit, certificate, picture, run } = Arguments::parse();
    match command {
        Some(Command::Explain { code }) => explain(code.as_deref()),
        Some(Command::Verify { nc, job, post, certificate, run }) => {
            let (format, timings) = (run.error_format, run.timings);
            let check = NcCheck { nc, job, certificate, run: run.options(post) };
            finish(format, timings, |stages| driver::verify(&check, stages))
        }
        None => {
            let (format, timings) = (run.error_format, run.timings);
            let options = Options {
                job: job.unwrap_or_default(),
                output,
                picture,
                certificate,
                emit: emit.map(|e| match e {
                    EmitArgument::Ast => Emit::Ast,
                    EmitArgument::Job => Emit::Job,
                    EmitArgument::Ir => Emit::Ir,
                    EmitArgument::Cc => Emit::Cc,
                    EmitArgument::Cl => Emit::Cl,
                    EmitArgument::Motion => Emit::Motion,
                    EmitArgument::Nc => Emit::Nc,
                }),
                run: run.options(post),
            };
            finish(format, timings, |stages| driver::compile(&options, stages))
        }
    }
}

/// Number of bytes of a size such as `4GB` or `500 MB`.
fn memory(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let units = [("GB", 1e9), ("MB", 1e6)];
    let split = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)));
    let bytes = split.and_then(|(number, size)| Some(number.trim().parse::<f64>().ok()? * size));
    let within = bytes.filter(|b| (1e8..=1e13).contains(b));
    within.ok_or_else(|| "a size from 100MB to 10000GB is due, such as 4GB".to_owned())
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
    let written = outcome.emitted.is_none_or(|text| print(&text));
    let exit = Exit::of_run(sink);
    ended(if written { exit } else { exit.max(Exit::File) })
}

/// Prints the page of a code, or the list of all.
fn explain(code: Option<&str>) -> ExitCode {
    let text = match code {
        None => {
            let mut codes: Vec<Code> = Code::all().collect();
            codes.sort_by_key(|c| c.id());
            codes.iter().map(|c| format!("{}  {}\n", c.id(), c.0.title)).collect()
        }
        Some(code) => {
            let Some(found) = Code::find(code).or_else(|| Code::find(&format!("IMP{code:0>4}"))) else {
                say(&format!("no diagnostic has the code {code}; `impellerc explain` lists them all\n"));
                return ended(Exit::Text);
            };
            format!("{}: {}\n\n{}\n", found.id(), found.0.title, found.0.page.trim_end())
        }
    };
    ended(if print(&text) { Exit::Holds } else { Exit::File })
}

/// The exit code for the shell.
fn ended(exit: Exit) -> ExitCode {
    ExitCode::from(exit.number())
}

/// Writes to standard output; false when the output was closed, as by `head`.
fn print(text: &str) -> bool {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).is_ok()
}

/// Writes to standard error; a failure cannot be reported anywhere.
fn say(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}
