//! `impellerc new --from --effort whole`: what is chosen is planned and verified as a whole, and its compile agrees.

use crate::support::part_alone::{folder, run, said};

/// The part of `jobs/small` alone, on the machine that it names: the choice says that the job holds, and the compile writes it.
#[test]
fn a_chosen_job_that_holds_is_compiled_at_once() {
    let folder = folder("");
    let run = |words: &[&str]| {
        let run = run(folder.path(), words);
        (run.status.success(), said(&run))
    };
    let (made, text) = run(&["new", "wheel.imp", "--from", "part.imp", "--effort", "whole", "--explain-choices"]);
    println!("{text}");
    assert!(made && text.contains("tried the whole job, trial 1"), "{text}");
    assert!(text.contains("the whole job holds"), "{text}");
    let (holds, text) = run(&["wheel.imp", "-o", "wheel.nc"]);
    assert!(holds && text.contains("PASS"), "{text}");
}

/// A job with `operations auto` compiles to the bytes that the written choice compiles to.
#[test]
fn an_open_job_and_its_choice_are_one_program() {
    let items = "operations auto\nrequire excess <= 0.2 mm\npost siemens-840d\n";
    let folder = folder(&format!("use tools \"five-axis\"\n{items}"));
    let below = folder.path().join("below");
    std::fs::create_dir(&below).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", below.join("vane_curves.csv")).unwrap();
    let held = run(folder.path(), &["part.imp", "-o", "part.nc", "--certificate", "part.json"]);
    assert!(held.status.success() && said(&held).contains("IMP0453"), "{}", said(&held));
    let chosen = run(folder.path(), &["choose", "part.imp", "-o", "below/part.imp"]);
    assert!(chosen.status.success(), "{}", said(&chosen));
    let held = run(&below, &["part.imp", "-o", "part.nc", "--certificate", "part.json"]);
    assert!(held.status.success() && !said(&held).contains("IMP0453"), "{}", said(&held));
    for file in ["part.nc", "part.json"] {
        let [open, whole] = [folder.path(), below.as_path()].map(|folder| std::fs::read(folder.join(file)).unwrap());
        assert!(open == whole, "{file}");
    }
}
