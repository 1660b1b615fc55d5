//! Command line of the compiler.

#![forbid(unsafe_code)]

use clap::{Parser, Subcommand, ValueEnum};
use impellerc::diag::junit::junit;
use impellerc::diag::sarif::sarif;
use impellerc::diag::{Code, render};
use impellerc::driver::{self, Emit, NcCheck, Options, Outcome, Stages};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Compiles a job that declares an impeller into verified five-axis NC.
#[derive(Parser)]
#[command(version, about, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    /// Job file
    #[arg(required = true)]
    job: Option<PathBuf>,

    /// File to write the NC text to; without it everything is checked and nothing written
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Dialect to write instead of the job's
    #[arg(long, value_name = "NAME")]
    post: Option<String>,

    /// Folder with `machines` and `tools` that is searched first
    #[arg(long, value_name = "DIR")]
    library: Option<PathBuf>,

    /// Print a stage value instead of going on to the NC text
    #[arg(long, value_enum, value_name = "STAGE")]
    emit: Option<EmitArgument>,

    /// Write the certificate as JSON, with the hash of the NC text
    #[arg(long, value_name = "FILE.json")]
    certificate: Option<PathBuf>,

    /// Write a picture of the part and the paths
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,

    /// Edge of the cells of the stock simulation; the certificate says what was taken
    #[arg(long, value_name = "MM")]
    stock_cell: Option<f64>,

    /// Folder to write the stock after each operation to, as STL
    #[arg(long, value_name = "DIR")]
    stock: Option<PathBuf>,

    /// Write a report to look at in a browser: deviations, paths, plots, contracts; also when a contract fails
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,

    /// Print the time of each stage; not beside `sarif` and `junit`, which are one document
    #[arg(long)]
    timings: bool,

    /// How to report faults
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    error_format: ErrorFormat,
}

#[derive(Subcommand)]
enum Command {
    /// Explains a code such as IMP0206: what it means, why it matters, an example, the way out
    Explain {
        /// The code
        code: String,
    },
    /// Measures NC text of any origin against a job
    Verify {
        /// NC text
        nc: PathBuf,

        /// Job that the text must fulfil
        #[arg(long, value_name = "FILE")]
        job: Option<PathBuf>,

        /// Dialect of the text instead of the job's
        #[arg(long, value_name = "NAME")]
        post: Option<String>,

        /// Folder with `machines` and `tools` that is searched first
        #[arg(long, value_name = "DIR")]
        library: Option<PathBuf>,

        /// Certificate that the text must belong to
        #[arg(long, value_name = "FILE")]
        certificate: Option<PathBuf>,

        /// Edge of the cells of the stock simulation; the certificate says what was taken
        #[arg(long, value_name = "MM")]
        stock_cell: Option<f64>,

        /// Folder to write the stock after each operation to, as STL
        #[arg(long, value_name = "DIR")]
        stock: Option<PathBuf>,

        /// Write a report to look at in a browser, also when a contract fails
        #[arg(long, value_name = "FILE.html")]
        report: Option<PathBuf>,

        /// Print the time of each stage; not beside `sarif` and `junit`, which are one document
        #[arg(long)]
        timings: bool,

        /// How to report faults
        #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
        error_format: ErrorFormat,
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
    /// Syntax tree
    Ast,
    /// Job with every default
    Job,
    /// Lowered program
    Ir,
    /// Contact points
    Cc,
    /// Cutter locations
    Cl,
    /// Joint motion
    Motion,
    /// NC text
    Nc,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match arguments.command {
        Some(Command::Explain { code }) => explain(&code),
        Some(Command::Verify {
            nc,
            job,
            post,
            library,
            certificate,
            report,
            stock_cell,
            stock,
            timings,
            error_format,
        }) => {
            let check = NcCheck { nc, job, library, post, certificate, report, stock_cell, stock };
            finish(error_format, timings, |stages| driver::verify(&check, stages))
        }
        None => {
            let options = Options {
                job: arguments.job.unwrap_or_default(),
                output: arguments.output,
                library: arguments.library,
                post: arguments.post,
                picture: arguments.picture,
                certificate: arguments.certificate,
                report: arguments.report,
                stock_cell: arguments.stock_cell,
                stock: arguments.stock,
                emit: arguments.emit.map(|e| match e {
                    EmitArgument::Ast => Emit::Ast,
                    EmitArgument::Job => Emit::Job,
                    EmitArgument::Ir => Emit::Ir,
                    EmitArgument::Cc => Emit::Cc,
                    EmitArgument::Cl => Emit::Cl,
                    EmitArgument::Motion => Emit::Motion,
                    EmitArgument::Nc => Emit::Nc,
                }),
            };
            finish(arguments.error_format, arguments.timings, |stages| driver::compile(&options, stages))
        }
    }
}

/// Runs the work and reports what it found.
fn finish(format: ErrorFormat, timings: bool, work: impl FnOnce(&mut Stages) -> Outcome) -> ExitCode {
    let terminal = std::io::stderr().is_terminal();
    let human = format == ErrorFormat::Human;
    let mut stages = Stages::default();
    stages.progress = terminal && human;
    let outcome = work(&mut stages);
    let colour = terminal && std::env::var_os("NO_COLOR").is_none();
    let (sink, sources) = (&outcome.sink, &outcome.sources);
    say(&match format {
        ErrorFormat::Human => render::human(sink, sources, colour),
        ErrorFormat::Json => render::json(sink, sources),
        ErrorFormat::Sarif => sarif(sink, sources),
        ErrorFormat::Junit => junit(sink, sources, &outcome.held()),
    });
    if timings && matches!(format, ErrorFormat::Human | ErrorFormat::Json) {
        say(&stages.report());
    }
    let written = outcome.emitted.is_none_or(|text| print(&text));
    if outcome.sink.has_errors() || !written { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Prints the page of a code.
fn explain(code: &str) -> ExitCode {
    let Some(found) = Code::find(code) else {
        let codes: Vec<&str> = Code::all().map(Code::id).collect();
        say(&format!("no diagnostic has the code {code}; there are {}\n", codes.join(", ")));
        return ExitCode::FAILURE;
    };
    let text = format!("{}: {}\n\n{}\n", found.id(), found.0.title, found.0.page.trim_end());
    if print(&text) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Writes to standard output; false when it was closed, as by `head`.
fn print(text: &str) -> bool {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).is_ok()
}

/// Writes to standard error; there is nowhere to report a failure of that.
fn say(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}
