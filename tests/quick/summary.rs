//! The certificate in short, as a run prints it.

use crate::support::golden::check;
use crate::support::pinned;
use impellerc::report::proof::contracts::{bound_and_found, computed};
use impellerc::report::proof::summary::{COLUMNS, Verdict, first_line, judgement, summary};
use impellerc::wheel::contract::ContractKind;

fn verdict(errors: usize) -> Verdict<'static> {
    let faults = Box::leak(Box::new(["a cutter goes 3 um deep into the rim (IMP0736)".to_owned()]));
    Verdict {
        errors,
        faults: if errors > 1 { faults } else { &[] },
        name: "reduced",
        machine: "5mc850-c (shipped)",
        post: "siemens-840d",
    }
}

#[test]
fn the_verdict_comes_first_and_lines_are_short() {
    let part = pinned::reduced("siemens-840d");
    let certificate = part.certificate();
    let text = summary(part.planned().0, certificate, verdict(0));
    check("reduced", "summary", &text);
    let held = certificate.contracts.len();
    assert!(text.starts_with(&format!("PASS reduced: {held} of {held} contracts, ")), "{text}");
    let wide: Vec<&str> = text.lines().filter(|line| line.chars().count() > COLUMNS).collect();
    assert_eq!(wide, [""; 0]);
    // Each figure of a proof says so, with what was found.
    for contract in certificate.contracts.iter().filter(|c| c.kind == ContractKind::Gouge) {
        let [_, found] = bound_and_found(contract);
        let due = format!("proved <= {found} (deepest found {})", computed(contract).unwrap());
        assert!(text.contains(&due), "{due}\n{text}");
    }
}

#[test]
fn a_failed_contract_comes_before_those_that_hold() {
    let mut certificate = pinned::reduced("siemens-840d").certificate().clone();
    let last = certificate.contracts.last_mut().unwrap();
    last.holds = false;
    let name = last.name();
    let all = certificate.contracts.len();
    let text = judgement(&certificate, verdict(1));
    assert!(text.starts_with(&format!("FAIL reduced: {} of {all} contracts hold, ", all - 1)), "{text}");
    let contracts: Vec<&str> =
        text.lines().skip_while(|line| !line.is_empty()).skip(1).filter(|line| !line.starts_with("      ")).collect();
    assert!(contracts[0].starts_with(&format!("! {name} ")) && contracts[0].contains("FAILS"), "{text}");
    assert_eq!(contracts.iter().filter(|line| line.contains("FAILS")).count(), 1);
    // An error without a contract is no success either.
    let held = first_line(pinned::reduced("siemens-840d").certificate(), verdict(2));
    assert!(held.starts_with("FAIL") && held.contains(" contracts hold, 2 other faults, "), "{held}");
    // What failed stands in the line below, with its code.
    let text = judgement(pinned::reduced("siemens-840d").certificate(), verdict(2));
    assert!(
        text.lines().nth(1).is_some_and(|line| line == "! a cutter goes 3 um deep into the rim (IMP0736)"),
        "{text}"
    );
}
