//! Exit codes of the program, from the codes of its diagnostics.

use super::code::Code;
use super::codes::{files, post, syntax, verification};
use super::{Severity, Sink};

/// Result of a run. Of several results the last in this order is reported: a file that cannot be read or written comes
/// before a fault in a text, and a fault in a text comes before a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Exit {
    /// 0: no error.
    #[default]
    Holds,
    /// 1: a contract that fails, or a finding: NC text that does something forbidden, or a certificate that does not
    /// belong to the text.
    Finding,
    /// 2: job, library, NC text, certificate or command line cannot be understood, or no program can be made of the job.
    Text,
    /// 3: a file cannot be read or written.
    File,
}

/// Codes of the stages of verification and posts that are not findings.
const NO_FINDINGS: &[Code] = &[
    verification::MALFORMED_MOTION,
    verification::STOCK_CELL,
    post::NAME,
    post::TOOL_NUMBER,
    post::AMBIGUOUS_VECTOR,
    post::STANDSTILL,
    post::NOT_UNDERSTOOD,
    post::TEXT_DIFFERS,
    post::UNKNOWN_POST,
    post::SENSE,
    post::NC_FILE,
    post::NC_BLOCK,
    post::CERTIFICATE_FORM,
    post::USAGE,
];

/// Codes of the stage of the text that are findings.
const FINDINGS: &[Code] = &[syntax::NOT_FORMATTED];

/// Codes of the stage of files where the remedy is a change of a text.
const NO_FILES: &[Code] = &[files::NOT_IN_LIBRARY, files::MEETS, files::STAGE_FILE, files::INTERNAL];

impl Exit {
    /// The class of an error with this code.
    pub fn of(code: Code) -> Self {
        match code.id().get(3..5) {
            _ if FINDINGS.contains(&code) => Self::Finding,
            Some("07" | "08") if !NO_FINDINGS.contains(&code) => Self::Finding,
            Some("09") if !NO_FILES.contains(&code) => Self::File,
            _ => Self::Text,
        }
    }

    /// The class of a run: the class of its gravest error.
    pub fn of_run(sink: &Sink) -> Self {
        let errors = sink.diags().iter().filter(|d| d.severity == Severity::Error);
        errors.map(|d| Self::of(d.code)).max().unwrap_or_default()
    }

    /// The number for the shell.
    pub fn number(self) -> u8 {
        self as u8
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Diag, codes};
    use super::*;

    #[test]
    fn the_gravest_error_decides_and_warnings_do_not() {
        let mut sink = Sink::default();
        sink.push(Diag::warning(files::CANNOT_READ, "w"));
        assert_eq!(Exit::of_run(&sink), Exit::Holds);
        for (code, exit) in [
            (verification::GOUGE, 1),
            (post::CERTIFICATE_OTHER, 1),
            (codes::job::NO_UNIT, 2),
            (verification::GOUGE, 2),
            (files::CANNOT_WRITE, 3),
            (codes::syntax::EMPTY, 3),
        ] {
            sink.push(Diag::error(code, format!("{code} {exit}")));
            assert_eq!(Exit::of_run(&sink).number(), exit);
        }
    }

    #[test]
    fn stages_before_verification_are_about_the_text() {
        let early = [codes::syntax::ALL, codes::job::ALL, codes::geometry::ALL, codes::planning::ALL].concat();
        let late = [codes::orientation::ALL, codes::kinematics::ALL].concat();
        let about_text = |code: &Code| !FINDINGS.contains(code);
        assert!(early.into_iter().filter(about_text).chain(late).all(|c| Exit::of(c) == Exit::Text));
        assert!(FINDINGS.iter().all(|code| Exit::of(*code) == Exit::Finding));
    }
}
