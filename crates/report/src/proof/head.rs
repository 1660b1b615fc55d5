//! What the head of an NC text says of its proof.

use super::contracts::{allowed_line, bound_and_found};
use super::summary::{not_checked, not_verified};
use super::surfaces::not_machined;
use verify::Certificate;

/// The lines on the proof at the head of the NC text: whether everything was verified, and what was verified.
pub fn lines(certificate: &Certificate) -> Vec<String> {
    let mut lines: Vec<String> = not_verified(certificate).collect();
    if lines.is_empty() {
        lines.push("verified from the first block to the last".to_owned());
    }
    let [made, sectors] = certificate.sectors();
    lines.push(format!("machined: {made} of {sectors} sectors"));
    lines.extend(not_machined(certificate));
    lines.extend(not_checked(certificate).map(str::to_owned));
    let solids: String = certificate.obstacles.iter().map(|c| format!(", {}", c.solid)).collect();
    lines.push(format!(
        "checked: whole tool against part, stock{solids}; travel and speed of all axes; contracts below"
    ));
    lines.push(format!(
        "at the start nothing is taken for known but that Z is not over {:.3}, the retract height",
        certificate.perimeter.retract.get()
    ));
    lines.push(
        "surfaces are those that the programmed motion leaves; from it the control departs by at most:".to_owned(),
    );
    for (o, run) in certificate.operations.iter().zip(&certificate.machine.runs) {
        lines.push(format!(
            "{}: {:.2} um, {:.3} deg",
            o.name,
            run.contour.value.get() * 1e3,
            run.orientation.value.get()
        ));
    }
    lines
}

/// Stands between what was found and what is required.
pub const REQUIRED: &str = ", required ";

/// A line for each contract and for each quantity that the job allows.
pub fn contracts(certificate: &Certificate) -> Vec<String> {
    let contract = certificate.contracts.iter().map(|c| {
        let [bound, found] = bound_and_found(c);
        format!("{} {found}{REQUIRED}{} {bound}", c.name(), c.relation.sign())
    });
    contract.chain(certificate.allowed.iter().map(|a| format!("allowed: {}", allowed_line(a)))).collect()
}
