//! Goldens of whole parts, in short form.

use crate::support::certificates::comes_back;
use crate::support::golden::{GOLDENS, bytes, check, nc};
use crate::support::jobs::{Compiled, Planned, machine_of, program};
use impellerc::ir::print;
use impellerc::nc;
use impellerc::report::proof::details::details;

/// The longer jobs: their plan by its notes, the ends of their NC texts and what a hash says of the rest.
fn in_short(job: &str) {
    let own = Compiled::new(program(job, None));
    let c = &own;
    check(job, "ir", &print::program(&c.program));
    let mut plan = String::new();
    for (operation, motion) in c.plan.cl.operations.iter().zip(&c.plan.motion.operations) {
        let name = &c.program.operations[operation.operation].name;
        plan.push_str(&format!("{name}: {} passes, {} moves\n", operation.passes.len(), motion.moves.len()));
        for note in &operation.notes {
            plan.push_str(&format!("  {note}\n"));
        }
    }
    check(job, "plan", &plan);
    check(job, "certificate", &details(&c.program, &c.motion, &c.certificate));
    comes_back(&c.program, &c.motion, &c.certificate);
    let pinned = |post: &dyn nc::Post| GOLDENS.iter().any(|(name, of)| *name == job && of.contains(&post.name()));
    for post in nc::POSTS.iter().filter(|post| pinned(**post)) {
        // Of another machine only the text is pinned, and a text needs no proof.
        let other = machine_of(post.name()).map(|machine| Planned::new(program(job, Some(machine))));
        let planned = other.as_ref().map_or(c.planned(), |other| (&other.program, &other.plan.motion));
        let text = nc(planned, *post);
        let read = nc::read_back(*post, planned.0, planned.1, &text).expect("the motion");
        let lines: Vec<&str> = text.lines().collect();
        let short = format!(
            "{}{} moves read back\n\n{}\n...\n{}\n",
            bytes(post.name(), &text),
            read.moves,
            lines[..40].join("\n"),
            lines[lines.len() - 20..].join("\n")
        );
        check(job, post.name(), &short);
    }
}

#[test]
fn whole_job_in_short() {
    in_short("wei2021");
}

#[test]
fn point_milled_job_in_short() {
    in_short("point");
}
