//! What `--emit` names: stage values and forms of the part.

use super::part_form::{PART_FORMS, PartForm};

/// Stage values that `--emit` prints, and forms of the part that it writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emit {
    /// Syntax tree.
    Ast,
    /// Job with every default.
    Job,
    /// Lowered program.
    Ir,
    /// Contact points.
    Cc,
    /// Cutter locations.
    Cl,
    /// Joint motion.
    Motion,
    /// NC text.
    Nc,
    /// The part as a file for other programs.
    Part(&'static PartForm),
}

impl Emit {
    /// The stage values, each with its name and what it is.
    const STAGES: [(Self, &str, &str); 7] = [
        (Self::Ast, "ast", "Syntax tree of the job"),
        (Self::Job, "job", "Job with all defaults"),
        (Self::Ir, "ir", "Geometry of part, stock, tools and operations"),
        (Self::Cc, "cc", "Cutter contacts"),
        (Self::Cl, "cl", "Cutter locations"),
        (Self::Motion, "motion", "Positions of the machine axes"),
        (Self::Nc, "nc", "NC text"),
    ];

    /// All values with their names and what they are: the stage values, then the forms of the part.
    pub fn all() -> impl Iterator<Item = (Self, &'static str, &'static str)> {
        Self::STAGES.into_iter().chain(PART_FORMS.iter().map(|form| (Self::Part(form), form.name, form.help)))
    }

    /// The value with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find_map(|(value, its, _)| (its == name).then_some(value))
    }
}

/// How a stage value is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmitForm {
    /// As text for people.
    #[default]
    Text,
    /// As a stage file, from which a run can go on.
    Json,
}
