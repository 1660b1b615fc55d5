//! What was chosen as items of a job, each with its reason.

use crate::candidates::Candidate;
use base::units::trim;
use std::fmt::Write;

/// An operation that was chosen.
#[derive(Clone, Debug)]
pub(crate) struct ChosenOperation {
    /// Its kind.
    pub(crate) keyword: &'static str,
    /// Name of its tool in the library.
    pub(crate) tool: String,
    /// Speed of the spindle, rpm.
    pub(crate) speed: f64,
    /// Feed, and that of links, mm/min.
    pub(crate) feed: f64,
    /// Step down and distance of lines of roughing, mm.
    pub(crate) steps: Option<[f64; 2]>,
    /// Its other properties, one after the other.
    pub(crate) properties: String,
    /// Why, in a line.
    pub(crate) why: String,
}

/// Items that declare all tools of the library, and an operation: the front end makes no program without one.
pub(crate) fn all_tools(names: &[String]) -> String {
    let mut text = String::new();
    for (k, name) in names.iter().enumerate() {
        let _ = writeln!(text, "tool t{} = \"{name}\"", k + 1);
    }
    text + "operation channel { tool t1  speed 1000 rpm  feed 1 mm/min  link-feed 1 mm/min  scallop 10 um }\n"
}

/// The tools of operations, each once, in the order in which they are needed.
fn tools(operations: &[ChosenOperation]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for name in operations.iter().map(|operation| &operation.tool) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// Tools and operations as items of a job.
pub(crate) fn items(operations: &[ChosenOperation], all: &[Candidate]) -> String {
    let tools = tools(operations);
    let number = |name: &String| tools.iter().position(|tool| tool == name).map_or(0, |k| k + 1);
    let mut text = String::new();
    for (k, name) in tools.iter().enumerate() {
        let reach = all.iter().find(|candidate| candidate.name == *name).map_or(0.0, Candidate::reach);
        let _ = writeln!(text, "tool t{} = \"{name}\"  // sticks out by {} mm", k + 1, trim(reach, 1));
    }
    for operation in operations {
        let word = if operation.keyword == "rough" { "tools" } else { "tool" };
        let [speed, feed] = [operation.speed, operation.feed].map(|value| trim(value, 2));
        let steps = operation
            .steps
            .map(|[depth, stepover]| format!("  depth {} mm  stepover {} mm\n", trim(depth, 3), trim(stepover, 3)));
        let _ = writeln!(
            text,
            "\n// {}\noperation {} {{\n  {word} t{}  speed {speed} rpm  feed {feed} mm/min  link-feed {feed} mm/min{}  {}\n}}",
            operation.why,
            operation.keyword,
            number(&operation.tool),
            steps.unwrap_or_default(),
            operation.properties
        );
    }
    text
}
