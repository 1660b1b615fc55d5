//! Endings of the names of outputs: a file is never named like a form that is not written into it.

use super::file_form::Form;
use super::{Emit, EmitForm, Options, OutputFile, shown_path};
use diagnostics::{Diag, codes::files};
use std::path::Path;

/// Endings of the forms that are no NC text.
const NOT_NC: &[&str] = &[
    "imp", "json", "html", "htm", "md", "pdf", "png", "jpg", "jpeg", "svg", "step", "stp", "stl", "3mf", "inf", "csv",
    "toml", "iges", "igs", "doc", "docx", "xls", "xlsx", "zip",
];

/// A file that a run writes, with its option, and what is written into it.
pub(super) struct NamedFile<'a> {
    pub(super) flag: &'static str,
    pub(super) path: &'a Path,
    form: Form,
}

/// The form of the file that `-o` names.
fn of_output(options: &Options) -> Form {
    match options.emit {
        _ if options.form == EmitForm::Json => Form::Json,
        Some(Emit::Part(form)) => Form::Part(form),
        _ => Form::Nc,
    }
}

/// The outputs of a compilation but for the report.
pub(super) fn own(options: &Options) -> Vec<NamedFile<'_>> {
    let nc = options.output.as_ref().map(|path| NamedFile { flag: "-o", path, form: of_output(options) });
    let other_outputs = options.other_outputs.iter().map(|OutputFile { output, path }| NamedFile {
        flag: output.flag,
        path,
        form: output.form,
    });
    nc.into_iter().chain(other_outputs).collect()
}

/// What a refused program leaves unwritten, as a line of text; nothing where no file was requested.
pub(super) fn not_written(named: &[NamedFile<'_>]) -> String {
    if named.is_empty() {
        return String::new();
    }
    let paths: Vec<String> = named.iter().map(|file| shown_path(file.path)).collect();
    let older = named.iter().any(|file| file.path.is_file());
    let older_files =
        if older { "; files of an earlier run stay as they were, and do not belong to this job" } else { "" };
    format!("not written, since the program may not run: {}{older_files}\n", paths.join(", "))
}

/// Refuses outputs that are named like files of another form.
///
/// # Errors
/// The diagnostic for the first of them.
pub(super) fn check_all(named: &[NamedFile<'_>]) -> Result<(), Diag> {
    named.iter().try_for_each(|file| check(file.flag, file.path, file.form))
}

/// Refuses a name that ends like a file of another form. A name without an ending, and a device, may have any.
///
/// # Errors
/// The diagnostic, with a name that is right.
pub(super) fn check(flag: &str, path: &Path, form: Form) -> Result<(), Diag> {
    let Some(ending) = path.extension().and_then(|ending| ending.to_str()) else { return Ok(()) };
    let is = |known: &&str| ending.eq_ignore_ascii_case(known);
    let right = match form {
        Form::Nc => !NOT_NC.iter().any(is),
        _ => form.endings().iter().any(is),
    };
    let device = std::fs::metadata(path).is_ok_and(|of| !of.is_file() && !of.is_dir());
    if right || device {
        return Ok(());
    }
    let shown = path.display();
    let (due, help) = match form.endings() {
        [] => ("it is not a name of NC text".to_owned(), own_flag(ending)),
        endings => {
            let endings: Vec<String> = endings.iter().map(|known| format!("`.{known}`")).collect();
            let first = path.with_extension(form.endings()[0]);
            let pdf = if ending.eq_ignore_ascii_case("pdf") { "; a browser prints it as PDF" } else { "" };
            (
                format!("the names of such a file end in {}", endings.join(", ")),
                format!("write `{flag} {}`{pdf}", first.display()),
            )
        }
    };
    let message = format!("`{flag}` writes {}, and `{shown}` is named like another file", form.name());
    Err(Diag::error(files::CANNOT_WRITE, message).note(due).help(help))
}

/// The option that writes files with an ending.
fn own_flag(ending: &str) -> String {
    let option = match ending.to_ascii_lowercase().as_str() {
        "step" | "stp" => "`--emit step -o PART.step` writes the part as STEP",
        "stl" => "`--emit stl -o PART.stl` writes the part as STL, `--stock DIR` the stock after each operation",
        "3mf" => "`--emit 3mf -o PART.3mf` writes the part as 3MF",
        "inf" => "`--emit sections -o PART.inf` writes the sections of the blades",
        "json" => {
            "`--certificate PART.json` writes the certificate, `--emit motion --format json -o MOTION.json` a stage file"
        }
        "html" | "htm" => "`--report PART.html` writes the report, `--setup-sheet SHEET.html` the setup sheet",
        "md" => "`--setup-sheet SHEET.md` writes the setup sheet",
        "png" => "`--picture PART.png` writes the picture",
        _ => "give the NC text the ending that the control reads: `.mpf`, `.h`, `.nc`, `.ngc`",
    };
    option.to_owned()
}
