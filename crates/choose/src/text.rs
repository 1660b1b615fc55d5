//! What was chosen as items of a job, each with its reason.

use crate::candidates::Candidate;
use base::units::trim;
use std::collections::BTreeMap;
use std::fmt::Write;

/// An operation that was chosen.
#[derive(Clone, Debug, Default)]
pub(crate) struct ChosenOperation {
    /// Its kind.
    pub(crate) keyword: String,
    /// Its tool among the candidates.
    pub(crate) tool: usize,
    /// Speed of the spindle, rpm.
    pub(crate) speed: f64,
    /// Feed, and that of links, mm/min.
    pub(crate) feed: f64,
    /// Step down and distance of lines of roughing, mm.
    pub(crate) steps: Option<[f64; 2]>,
    /// Its other properties.
    pub(crate) properties: Vec<(&'static str, String)>,
    /// What the job fixes of it.
    pub(crate) fixed: Fixed,
    /// Why, in a line.
    pub(crate) why: String,
}

/// What a job fixes of an operation: that stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fixed {
    pub(crate) feed: bool,
    pub(crate) depth: bool,
    pub(crate) stepover: bool,
}

/// Names of tools in the job, by candidate.
pub(crate) type ToolNames = BTreeMap<usize, String>;

/// Names of the tools of operations, in the order in which they are needed: those that the job declares keep theirs. Declarations of
/// the others are the second value.
pub(crate) fn named<'a>(
    operations: impl IntoIterator<Item = &'a ChosenOperation>,
    all: &[Candidate],
    taken: &[&str],
) -> (ToolNames, String) {
    let (mut names, mut declarations) = (ToolNames::new(), String::new());
    let mut free = (1..).map(|n| format!("t{n}")).filter(|name| !taken.contains(&name.as_str()));
    for operation in operations {
        let Some(candidate) = all.get(operation.tool).filter(|_| !names.contains_key(&operation.tool)) else {
            continue;
        };
        if candidate.declared {
            names.insert(operation.tool, candidate.name.clone());
            continue;
        }
        let name = free.next().unwrap_or_default();
        let reach = trim(candidate.reach(), 1);
        let _ = writeln!(declarations, "tool {name} = \"{}\"  // sticks out by {reach} mm", candidate.name);
        names.insert(operation.tool, name);
    }
    (names, declarations)
}

/// The value of a property of operations that are one item: a value for each of its tools where it has a list of them.
pub(crate) fn value(property: &str, operations: &[ChosenOperation], names: &ToolNames) -> String {
    let each = |of: &dyn Fn(&ChosenOperation) -> String| operations.iter().map(of).collect::<Vec<_>>().join(", ");
    let step = |k: usize| each(&|o| format!("{} mm", trim(o.steps.map_or(0.0, |steps| steps[k]), 3)));
    match property {
        "tool" | "tools" => each(&|o| names.get(&o.tool).cloned().unwrap_or_default()),
        "speed" => each(&|o| format!("{} rpm", trim(o.speed, 2))),
        "feed" => each(&|o| format!("{} mm/min", trim(o.feed, 2))),
        "link-feed" => operations.first().map_or(String::new(), |o| format!("{} mm/min", trim(o.feed, 2))),
        "depth" => step(0),
        "stepover" => step(1),
        property => {
            let of_first = operations.first().and_then(|o| o.properties.iter().find(|(name, _)| *name == property));
            of_first.map_or(String::new(), |(_, value)| value.clone())
        }
    }
}

/// Operations as items of a job.
pub(crate) fn items(operations: &[ChosenOperation], names: &ToolNames) -> String {
    let mut text = String::new();
    for operation in operations {
        let one = std::slice::from_ref(operation);
        let word = if operation.keyword == "rough" { "tools" } else { "tool" };
        let value = |property: &str| format!("{property} {}", value(property, one, names));
        let first = [word, "speed", "feed", "link-feed"].map(value).join("  ");
        let steps =
            operation.steps.map_or(String::new(), |_| format!("  {}\n", ["depth", "stepover"].map(value).join("  ")));
        let rest: Vec<String> = operation.properties.iter().map(|(name, value)| format!("{name} {value}")).collect();
        let _ = writeln!(
            text,
            "\n// {}\noperation {} {{\n  {first}\n{steps}  {}\n}}",
            operation.why,
            operation.keyword,
            rest.join("  ")
        );
    }
    text
}
