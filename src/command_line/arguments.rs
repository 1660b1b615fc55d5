//! Arguments of the command line: commands, options, their help.

use super::import_arguments::{BladeFileArguments, ImportArguments};
use super::quantities::{chord, price, with_unit};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use impellerc::driver::{
    BEGINNINGS, ChoiceEffort, ChoiceOptions, Emit, EmitForm, OUTPUTS, Options, Output, OutputFile, PartOptions,
    RunOptions,
};
use impellerc::report::step::StepProtocol;
use std::path::PathBuf;

/// Exit codes, for the help.
const EXIT_CODES: &str = "Exit codes:
  0  no error: every contract holds; warnings and remarks do not count
  1  a contract fails, the motion has a fault such as a collision, or the certificate belongs to another NC text
  2  job, library, NC text, certificate or command line has a fault, or no program can be planned for the job
  3  a file cannot be read or written
If several apply, the largest is returned. A run writes all outputs or none. An output must not be an input of the run.";

/// Values of `--emit` that are written to the file of `-o`.
fn part_forms() -> impl Iterator<Item = (&'static str, &'static str)> {
    Emit::all().filter_map(|(value, name, _)| matches!(value, Emit::Part(_)).then_some(("emit", name)))
}

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

/// Exit codes of the commands that write jobs, for the help.
const TEXT_CODES: &str = "Exit codes:
  0  done
  1  `--check`: a job is not in its usual form
  2  a text or the command line has a fault
  3  a file cannot be read or written";

/// Exit codes of the commands that list the library, for the help.
const LIST_CODES: &str = "Exit codes:
  0  done
  2  there is no such file in the library, or the command line has a fault
  3  a file or a folder cannot be read";

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
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Option<Command>,

    /// Job file
    #[arg(required_unless_present = "from")]
    pub(super) job: Option<PathBuf>,

    /// Go on from this stage file, which `--emit STAGE --format json` wrote, instead of a job
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["job", "post", "machine", "library", "curves", "watch"])]
    pub(super) from: Option<PathBuf>,

    /// Write the NC text to this file; without this option the job is planned and verified, but no NC text is written
    #[arg(short, long, value_name = "FILE", required_if_eq_any = part_forms())]
    pub(super) output: Option<PathBuf>,

    /// Write the NC text with this post file of the library instead of the post of the job, such as linuxcnc
    #[arg(long, value_name = "NAME")]
    pub(super) post: Option<String>,

    /// Print the result of this stage, and stop after it; forms of the part are written to the file of `-o`
    #[arg(long, value_name = "STAGE", value_parser = emits())]
    pub(super) emit: Option<Emit>,

    /// Write the stage value as text for people, or as a stage file that `--from` reads (of `ir`, `cc`, `cl` and `motion`),
    /// to the file of `-o` where it is given
    #[arg(long, value_enum, default_value = "text", value_name = "FORM", requires = "emit")]
    pub(super) format: FormArgument,

    /// Application protocol of the STEP file
    #[arg(long, value_enum, default_value = "ap242", value_name = "PROTOCOL")]
    pub(super) step_protocol: ProtocolArgument,

    /// Largest chord error of the triangles of STL and 3MF, from 0.1 um to 1 mm, such as 10um
    #[arg(long, default_value = "10um", value_name = "LENGTH", value_parser = chord)]
    pub(super) chord: f64,

    /// Number of sections of each blade, from 2 to 101
    #[arg(long, default_value = "11", value_name = "NUMBER", value_parser = sections)]
    pub(super) sections: usize,

    #[command(flatten)]
    pub(super) other_outputs: OutputArguments,

    /// Write a report for a browser to this file: deviations, paths, stock, plots, contracts; also if a contract fails
    #[arg(long, value_name = "FILE.html")]
    pub(super) report: Option<PathBuf>,

    /// Compile again whenever the job or a file that it reads changes, until Ctrl+C
    #[arg(long)]
    pub(super) watch: bool,

    #[command(flatten)]
    pub(super) run: RunArguments,
}

impl Arguments {
    /// The fault of options that do not go together.
    pub(super) fn fault(&self) -> Option<clap::Error> {
        let written = matches!(self.emit, None | Some(Emit::Ir | Emit::Cc | Emit::Cl | Emit::Motion));
        let message = "`--format json` writes the stages `ir`, `cc`, `cl` and `motion`\n";
        if self.format == FormArgument::Json && !written {
            return Some(Self::command().error(ErrorKind::ArgumentConflict, message));
        }
        match &self.command {
            Some(Command::New { from: None, of_files, .. }) if of_files.is_stated() => {
                let message = "options of blade files go with `--from FILE`\n";
                Some(Self::command().error(ErrorKind::MissingRequiredArgument, message))
            }
            _ => None,
        }
    }

    /// The options of a compilation, in the form of the driver.
    pub(super) fn options(self) -> Options {
        let part = PartOptions { protocol: self.step_protocol.into(), chord: self.chord, sections: self.sections };
        Options {
            job: self.job.unwrap_or_default(),
            from: self.from,
            output: self.output,
            other_outputs: self.other_outputs.0,
            emit: self.emit,
            form: self.format.into(),
            part,
            fits: false,
            run: self.run.options(self.post, self.report),
        }
    }
}

/// The outputs beside the NC text: an option for each row of their table.
pub(super) struct OutputArguments(Vec<OutputFile>);

impl Args for OutputArguments {
    fn augment_args(command: clap::Command) -> clap::Command {
        command.args(OUTPUTS.iter().map(|output| {
            let option = clap::Arg::new(output.flag).long(output.flag.trim_start_matches('-'));
            option.value_name(output.value).help(output.help).value_parser(clap::value_parser!(PathBuf))
        }))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for OutputArguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let file = |output: &Output| OutputFile::new(output.flag, matches.get_one::<PathBuf>(output.flag)?);
        Ok(Self(OUTPUTS.iter().filter_map(file).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// What both commands take.
#[derive(Args)]
pub(super) struct RunArguments {
    /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
    #[arg(long, value_name = "DIR")]
    pub(super) library: Option<PathBuf>,

    /// Use this machine of the library instead of the machine of the job
    #[arg(long, value_name = "NAME")]
    pub(super) machine: Option<String>,

    /// Allow `spline from` to read curve files in this folder too, not only in the folder of the job
    #[arg(long, value_name = "DIR")]
    pub(super) curves: Option<PathBuf>,

    /// Cell size of the stock simulation, at most 1 mm (more for parts over 200 mm); default 1/8 of the radius of the
    /// smallest cutter, 1/20 where the job requires `engagement`
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) stock_cell: Option<f64>,

    /// Write the stock after each operation to this folder, as STL files
    #[arg(long, value_name = "DIR")]
    pub(super) stock: Option<PathBuf>,

    /// Largest memory for planning or for the check of NC text, such as 4GB; default 2GB
    #[arg(long, value_name = "SIZE", value_parser = memory, allow_hyphen_values = true)]
    pub(super) memory: Option<f64>,

    /// What is tried before what the job leaves open (`operations auto`) is chosen
    #[arg(long, value_enum, value_name = "EFFORT", default_value = "axes")]
    pub(super) effort: EffortArgument,

    /// Tell all that was tried for what the job leaves open, with what was in the way
    #[arg(long)]
    pub(super) explain_choices: bool,

    /// Print all figures of the proof: surfaces with places, stock, axes, active limits, how the operations were planned
    #[arg(long)]
    pub(super) details: bool,

    /// Print the times of each stage and of its parts; has no effect with the formats `sarif` and `junit`
    #[arg(long)]
    pub(super) timings: bool,

    /// Format of errors, warnings and remarks
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    pub(super) error_format: ErrorFormat,
}

impl RunArguments {
    /// The options in the form of the driver.
    pub(super) fn options(self, post: Option<String>, report: Option<PathBuf>) -> RunOptions {
        let Self { library, curves, machine, stock_cell, stock, memory, details, effort, explain_choices, .. } = self;
        let choice = ChoiceOptions { effort: effort.into(), explain: explain_choices };
        RunOptions { library, curves, post, machine, report, stock_cell, stock, memory, details, choice }
    }
}

/// What the commands take that read a job and plan nothing.
#[derive(Args)]
pub(super) struct ReadingArguments {
    /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
    #[arg(long, value_name = "DIR")]
    pub(super) library: Option<PathBuf>,

    /// Allow `spline from` to read curve files in this folder too, not only in the folder of the job
    #[arg(long, value_name = "DIR")]
    pub(super) curves: Option<PathBuf>,

    /// Print the times of each stage and of its parts; has no effect with the formats `sarif` and `junit`
    #[arg(long)]
    pub(super) timings: bool,

    /// Format of errors, warnings and remarks
    #[arg(long, value_enum, default_value = "human", value_name = "FORMAT")]
    pub(super) error_format: ErrorFormat,
}

/// What the commands take that list the library.
#[derive(Args)]
pub(super) struct LibraryArguments {
    /// Name of the file to show, without `.toml`
    pub(super) name: Option<String>,

    /// Print the JSON schema of these files, with which editors complete and check them
    #[arg(long, conflicts_with = "name")]
    pub(super) schema: bool,

    /// Search this folder first (subfolders `machines`, `tools` and `posts`)
    #[arg(long, value_name = "DIR")]
    pub(super) library: Option<PathBuf>,
}

/// The words of the jobs to begin with.
fn beginnings() -> PossibleValuesParser {
    BEGINNINGS.map(|b| clap::builder::PossibleValue::new(b.name).help(b.about)).into()
}

#[derive(Subcommand)]
pub(super) enum Command {
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

        /// Choose tools, methods and operations for the part of this job, which has none, or for the part of blade files (a file, or
        /// a folder with them); machine, tools, stock, contracts and post that it does not state are added
        #[arg(long, value_name = "FILE", conflicts_with = "kind")]
        from: Option<PathBuf>,

        /// Machine of the library for a part that names none
        #[arg(long, value_name = "NAME", requires = "from")]
        machine: Option<String>,

        /// Material of the stock for a part without stock: aluminium, steel, stainless, titanium or nickel
        #[arg(long, value_name = "NAME", requires = "from")]
        material: Option<String>,

        /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
        #[arg(long, value_name = "DIR", requires = "from")]
        library: Option<PathBuf>,

        /// What is tried before the job is written
        #[arg(long, value_enum, value_name = "EFFORT", default_value = "axes", requires = "from")]
        effort: EffortArgument,

        /// Print all that was tried, with what was in the way
        #[arg(long, requires = "from")]
        explain_choices: bool,

        #[command(flatten, next_help_heading = "Blade files of `--from`")]
        of_files: Box<BladeFileArguments>,
    },
    /// Chooses what a job leaves open (`operations auto`, `tool auto`, `depth auto`), and writes the job with what was chosen, each with
    /// its reason
    #[command(after_help = TEXT_CODES)]
    Choose {
        /// Job file
        job: PathBuf,

        /// File to write; it must not exist. Without this option the job is printed
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,

        /// Use this machine of the library instead of the machine of the job
        #[arg(long, value_name = "NAME")]
        machine: Option<String>,

        /// What is tried before the job is written
        #[arg(long, value_enum, value_name = "EFFORT", default_value = "axes")]
        effort: EffortArgument,

        /// Print all that was tried, with what was in the way
        #[arg(long)]
        explain_choices: bool,

        #[command(flatten)]
        reading: ReadingArguments,
    },
    /// Estimates what a part takes on the machine, in seconds and without planning it: time, stock, chips, tools
    #[command(after_help = IMPORT_CODES)]
    Quote {
        /// Blade files, a folder with them, a job with a part alone, or a whole job
        #[arg(required = true)]
        part: Vec<PathBuf>,

        /// Machine of the library for a part that names none
        #[arg(long, value_name = "NAME")]
        machine: Option<String>,

        /// Material of the stock for a part without stock: aluminium, steel, stainless, titanium or nickel
        #[arg(long, value_name = "NAME")]
        material: Option<String>,

        /// Search this folder first for machine, tool and post files (subfolders `machines`, `tools` and `posts`)
        #[arg(long, value_name = "DIR")]
        library: Option<PathBuf>,

        /// Print JSON with all numbers in place of text for people
        #[arg(long)]
        json: bool,

        /// Price of an hour of the machine
        #[arg(long, value_name = "NUMBER", value_parser = price)]
        hour_price: Option<f64>,

        /// Price of a kilogram of stock
        #[arg(long, value_name = "NUMBER", value_parser = price)]
        kilogram_price: Option<f64>,

        #[command(flatten, next_help_heading = "Blade files")]
        of_files: Box<BladeFileArguments>,
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
    #[command(after_help = LIST_CODES)]
    Machines(LibraryArguments),
    /// Lists the tool libraries that jobs can use, with where they come from, or shows the file of one
    #[command(after_help = LIST_CODES)]
    Tools(LibraryArguments),
    /// Lists the post files that jobs can use, with where they come from, or shows the file of one
    #[command(after_help = LIST_CODES)]
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

        /// Tell also how well the sides of the tools fit the faces: what flank milling would leave in one, two and three
        /// strips (some seconds)
        #[arg(long)]
        fits: bool,

        /// Check again whenever the job or a file that it reads changes, until Ctrl+C
        #[arg(long)]
        watch: bool,

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

        /// Write a report for a browser to this file: deviations, paths, stock, plots, contracts; also if a contract fails
        #[arg(long, value_name = "FILE.html")]
        report: Option<PathBuf>,

        #[command(flatten)]
        run: Box<RunArguments>,
    },
    /// Plans and verifies a job and writes its report for a browser, also if a contract fails; no NC text is written
    #[command(after_help = EXIT_CODES)]
    Report {
        /// Job file
        job: PathBuf,

        /// File to write; default: the name of the job with the ending `.html`, in the current folder
        #[arg(short, long, value_name = "FILE.html")]
        output: Option<PathBuf>,

        /// Post file of the library instead of the post of the job
        #[arg(long, value_name = "NAME")]
        post: Option<String>,

        /// Write the report again whenever the job or a file that it reads changes, until Ctrl+C
        #[arg(long)]
        watch: bool,

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

        /// Job of both texts; it is needed
        #[arg(long, value_name = "FILE")]
        job: Option<PathBuf>,

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
pub(super) enum ErrorFormat {
    /// Text for people, with the lines of the job
    Human,
    /// One JSON object on each line
    Json,
    /// SARIF 2.1.0, for code reviews
    Sarif,
    /// JUnit XML, for build servers
    Junit,
}

/// Values of `--emit`.
fn emits() -> impl TypedValueParser<Value = Emit> {
    let values: Vec<_> =
        Emit::all().map(|(_, name, help)| clap::builder::PossibleValue::new(name).help(help)).collect();
    PossibleValuesParser::new(values).try_map(|name| Emit::named(&name).ok_or("no such stage"))
}

/// What a choice tries.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum EffortArgument {
    /// Contacts and tool axes of each operation in one sector: some seconds
    Axes,
    /// Then the whole job as well, planned and verified: minutes. Feeds and steps that load a tool over its limits are lowered
    Whole,
}

impl From<EffortArgument> for ChoiceEffort {
    fn from(effort: EffortArgument) -> Self {
        match effort {
            EffortArgument::Axes => Self::Axes,
            EffortArgument::Whole => Self::Whole,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum FormArgument {
    /// Text for people
    Text,
    /// A stage file
    Json,
}

impl From<FormArgument> for EmitForm {
    fn from(form: FormArgument) -> Self {
        match form {
            FormArgument::Text => Self::Text,
            FormArgument::Json => Self::Json,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum ProtocolArgument {
    /// ISO 10303-242
    Ap242,
    /// ISO 10303-214
    Ap214,
}

impl From<ProtocolArgument> for StepProtocol {
    fn from(protocol: ProtocolArgument) -> Self {
        match protocol {
            ProtocolArgument::Ap242 => Self::Ap242,
            ProtocolArgument::Ap214 => Self::Ap214,
        }
    }
}

/// Number of sections of a blade.
fn sections(text: &str) -> Result<usize, String> {
    let number = text.trim().parse().ok().filter(|n| (2..=101).contains(n));
    number.ok_or_else(|| "a blade has from 2 to 101 sections".to_owned())
}

/// Number of bytes of a size such as `4GB` or `500 MB`.
fn memory(text: &str) -> Result<f64, String> {
    let within = with_unit(text, &[("GB", 1e9), ("MB", 1e6)]).filter(|b| (1e8..=1e13).contains(b));
    within.ok_or_else(|| "the size must be from 100MB to 10000GB, such as 4GB".to_owned())
}
