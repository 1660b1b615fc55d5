//! `impellerc new --from --effort whole`: what is chosen is planned and verified as a whole, and its compile agrees.

use crate::support::bounded;

/// The part of `jobs/small` alone, on the machine that it names: the choice says that the job holds, and the compile writes it.
#[test]
fn a_chosen_job_that_holds_is_compiled_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let job = std::fs::read_to_string("jobs/small/small.imp").unwrap();
    let part = job.split("\nstock ").next().unwrap().replace("use tools   \"carbide\"\n", "");
    std::fs::write(folder.path().join("part.imp"), part).unwrap();
    std::fs::copy("jobs/small/vane_curves.csv", folder.path().join("vane_curves.csv")).unwrap();
    let run = |words: &[&str]| {
        let run = bounded::program().current_dir(folder.path()).args(words).output().unwrap();
        (
            run.status.success(),
            String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr),
        )
    };
    let (made, text) = run(&["new", "wheel.imp", "--from", "part.imp", "--effort", "whole", "--explain-choices"]);
    println!("{text}");
    assert!(made && text.contains("tried the whole job, trial 1"), "{text}");
    assert!(text.contains("the whole job holds"), "{text}");
    let (holds, text) = run(&["wheel.imp", "-o", "wheel.nc"]);
    assert!(holds && text.contains("PASS"), "{text}");
}
