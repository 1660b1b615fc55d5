//! `impellerc new --from`: a part without tools and operations becomes a job, or the reason is told.

use crate::support::part_alone::{folder as part, run, said};
use impellerc::diagnostics::Severity;
use impellerc::job::language;

/// What is chosen is a job without a fault: tools of the library, roughing and all that finishes the part, each with its reason.
/// The contracts that the part states stay as they are, the others are added.
#[test]
fn a_part_becomes_a_job() {
    let folder = part("require excess <= 0.2 mm\n");
    let made = run(folder.path(), &["new", "wheel", "--from", "part.imp", "--explain-choices"]);
    let text = said(&made);
    assert!(made.status.success(), "{text}");
    assert!(
        text.contains("tried fillet with ball-2x24, corridor: holds") && text.contains("wrote wheel.imp"),
        "{text}"
    );
    let job = std::fs::read_to_string(folder.path().join("wheel.imp")).unwrap();
    println!("{job}");
    let operations: Vec<&str> = job.lines().filter_map(|line| line.strip_prefix("operation ")).collect();
    let (roughing, finishing) = operations.split_at(operations.len() - 3);
    assert!(!roughing.is_empty() && roughing.iter().all(|operation| *operation == "rough {"), "{operations:?}");
    assert_eq!(finishing, ["point {", "fillet {", "channel {"]);
    // A reason for each operation; one line is the comment of the part.
    assert_eq!(job.matches("\n// ").count(), operations.len() + 1);
    assert_eq!((job.matches("require excess").count(), job.matches("require gouge").count()), (1, 1));
    assert!(job.contains("scallop 100 um"), "{job}");
    let checked = run(folder.path(), &["check", "wheel.imp"]);
    assert!(checked.status.success(), "{}", said(&checked));
    let again = run(folder.path(), &["new", "other.imp", "--from", "part.imp"]);
    assert!(again.status.success(), "{}", said(&again));
    assert_eq!(std::fs::read_to_string(folder.path().join("other.imp")).unwrap(), job);
}

/// A library of a single ball that is wider than the fillet: nothing is written, and the reason is told.
#[test]
fn a_library_without_a_tool_that_serves_is_told() {
    let folder = part("use tools \"large\"\n");
    let tools = folder.path().join("_lib").join("tools");
    std::fs::create_dir_all(&tools).unwrap();
    let ball = "about = \"one ball\"\n[tool.ball]\nkind = \"ball\"\ndiameter = \"6 mm\"\nflutes = 2\nflute = \"30 mm\"\nreach = \"40 mm\"\n";
    std::fs::write(tools.join("large.toml"), ball).unwrap();
    let refused = run(folder.path(), &["new", "wheel", "--from", "part.imp"]);
    let text = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "{text}");
    assert!(text.contains("IMP0452") && text.contains("no tool of the library finishes the fillets"), "{text}");
    assert!(text.contains("to 1.15 mm of radius"), "{text}");
    assert!(!folder.path().join("wheel.imp").exists());
}

/// A file that exists stays, and a job with operations of its own has nothing to choose.
#[test]
fn nothing_is_replaced() {
    let folder = part("");
    let exists = run(folder.path(), &["new", "part.imp", "--from", "part.imp"]);
    assert!(exists.status.code() == Some(3) && said(&exists).contains("exists already"), "{}", said(&exists));
    let whole = part("tool t1 = \"ball-2x24\"\n");
    let refused = run(whole.path(), &["new", "wheel", "--from", "part.imp"]);
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    assert!(said(&refused).contains("nothing is left to choose"), "{}", said(&refused));
    let missing = run(whole.path(), &["new", "wheel", "--from", "none.imp"]);
    assert_eq!(missing.status.code(), Some(3), "{}", said(&missing));
    assert_eq!(run(whole.path(), &["new", "wheel", "--machine", "5mc850-c"]).status.code(), Some(2));
}

/// A fault of the part or of what is added to it has its place in the text with both.
#[test]
fn a_fault_has_its_place() {
    let folder = part("");
    let path = folder.path().join("part.imp");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("use machine \"5mc850-c\"\n", "")).unwrap();
    let refused = run(folder.path(), &["new", "wheel", "--from", "part.imp", "--machine", "nope"]);
    let text = said(&refused);
    assert!(!refused.status.success(), "{text}");
    let line = text.lines().position(|line| line.ends_with("use machine \"nope\"")).unwrap_or_else(|| panic!("{text}"));
    let mark = text.lines().nth(line + 1).unwrap_or_default();
    assert!(mark.contains("──"), "{text}");
    assert!(!folder.path().join("wheel.imp").exists());
}

/// Sections of a designer become a job with one command, with the tables of its points beside it. Where one of them exists nothing is
/// written.
#[test]
fn blade_files_become_a_job() {
    let folder = tempfile::tempdir().unwrap();
    let job = std::fs::canonicalize("jobs/curved/curved.imp").unwrap();
    let blades = folder.path().join("blades");
    std::fs::create_dir(&blades).unwrap();
    let made = run(&blades, &[job.to_str().unwrap(), "--emit", "sections", "-o", "blades.inf"]);
    assert!(blades.join("blades.inf").exists(), "{}", said(&made));

    std::fs::write(folder.path().join("wheel.curves.csv"), "mine").unwrap();
    let refused = run(folder.path(), &["new", "wheel", "--from", "blades", "--machine", "5mc850-c"]);
    assert!(
        !refused.status.success() && said(&refused).contains("wheel.curves.csv exists already"),
        "{}",
        said(&refused)
    );
    assert_eq!(std::fs::read_to_string(folder.path().join("wheel.curves.csv")).unwrap(), "mine");
    assert!(!folder.path().join("wheel.imp").exists());
    std::fs::remove_file(folder.path().join("wheel.curves.csv")).unwrap();

    // Sections state no fillets, and the corner of face and floor keeps the radius of every ball.
    let sharp = said(&run(folder.path(), &["new", "wheel", "--from", "blades", "--machine", "5mc850-c"]));
    let radius =
        sharp.split("--fillet ").nth(1).and_then(|rest| rest.split('`').next()).expect("a radius that a ball mills");
    assert!(sharp.contains("no tool mills a sharp foot") && !folder.path().join("wheel.imp").exists(), "{sharp}");

    let made = run(folder.path(), &["new", "wheel", "--from", "blades", "--machine", "5mc850-c", "--fillet", radius]);
    let text = said(&made);
    assert!(made.status.success() && text.contains("the number of main blades is 8"), "{text}");
    assert!(text.contains("wrote wheel.imp") && text.contains("wheel.curves.csv"), "{text}");
    let checked = run(folder.path(), &["check", "wheel.imp"]);
    assert!(checked.status.success(), "{}", said(&checked));

    let needless = run(folder.path(), &["new", "other", "--unit", "mm"]);
    assert!(!needless.status.success() && said(&needless).contains("--from FILE"), "{}", said(&needless));
}

/// Items behind the part: tools and an operation of the job, values left open, and the rest left open.
const OPEN: &str = r#"use tools "five-axis"
stock turned { over shroud 0 mm  bore 4 mm  back -18 mm }
tool mine = "ball-2x24"
tool big = ball { diameter 5 mm  flutes 3  flute 14 mm  reach 40 mm  holder "shrink-6-slim" }
operation rough { tools big, mine  speed auto  feed 500 mm/min  depth auto  allowance vane 0.2 mm, hub 0.2 mm }
operation point first { tool mine  speed auto  feed auto  scallop 0.1 mm  method auto  faces pressure }
operations auto
operation fillet { tool mine  speed 17000 rpm  feed 500 mm/min  scallop 0.1 mm }
require excess <= 0.2 mm on operation first
require removal-rate <= 50 cm3/min on channel
post siemens-840d
"#;

/// What a job fixes is kept, and what it leaves open is chosen for what is missing: the suction face and the floor, with a tool that
/// the job declares, and no roughing or fillet beside its own.
#[test]
fn what_a_job_leaves_open_is_chosen() {
    let folder = part(OPEN);
    let made = run(folder.path(), &["choose", "part.imp", "-o", "whole.imp", "--explain-choices"]);
    let text = said(&made);
    assert!(made.status.success() && text.contains("tried point with mine, corridor: holds"), "{text}");
    let job = std::fs::read_to_string(folder.path().join("whole.imp")).unwrap();
    println!("{job}");
    let has = |lines: &[&str]| lines.iter().for_each(|line| assert!(job.contains(line), "{line}"));
    has(&[
        "operation rough { tools big, mine  speed 18000 rpm, 18000 rpm  feed 500 mm/min  depth 1.6 mm, 0.66 mm  allowance",
        "operation point first { tool mine  speed 18000 rpm  feed 540 mm/min  scallop 0.1 mm  method corridor  faces pressure }",
        "faces suction  scallop 100 um  method corridor",
        "operation fillet { tool mine  speed 17000 rpm  feed 500 mm/min  scallop 0.1 mm }",
        "require excess <= 0.2 mm on operation first",
    ]);
    let count = |what: &str| job.matches(what).count();
    let operations = ["rough", "point", "fillet", "channel"].map(|kind| count(&format!("operation {kind} ")));
    assert_eq!((operations, count("\ntool ")), ([1, 2, 1, 1], 2));
    // The check of the open job says what it takes, by facts alone.
    let checked = run(folder.path(), &["check", "part.imp"]);
    assert!(checked.status.success() && said(&checked).contains("IMP0453"), "{}", said(&checked));
    let checked = run(folder.path(), &["check", "whole.imp"]);
    assert!(checked.status.success() && !said(&checked).contains("IMP0453"), "{}", said(&checked));
    // An editor shows no fault in an open job, and that of a word that is not in the language.
    let text = std::fs::read_to_string(folder.path().join("part.imp")).unwrap();
    let mut files = impellerc::driver::DiskFiles::new(&folder.path().join("part.imp"), None, None).unwrap();
    let understood = language::understand("part.imp", &text, &mut files);
    assert!(understood.diags.iter().all(|diag| diag.severity != Severity::Error), "{:?}", understood.diags);
    let wrong = text.replace("operations auto", "operations automatic");
    let understood = language::understand("part.imp", &wrong, &mut files);
    assert!(understood.diags.iter().any(|diag| diag.message.contains("operations automatic")));
}

#[test]
fn what_cannot_be_chosen_is_told() {
    for (items, due) in [
        ("operation flank { tool auto  speed 9000 rpm  feed 250 mm/min }", "`tool auto` of `flank` is not chosen"),
        ("operation rough { tool auto  speed 9000 rpm  feed 250 mm/min }", "has no property `tool`"),
        (
            "tool t1 = \"ball-2x24\"\noperation rough { speed 9000 rpm  feed 250 mm/min  allowance vane 0.2 mm, hub 0.2 mm }\noperations auto",
            "takes all tools of the job",
        ),
        (
            "operation point { tool auto  speed 9000 rpm  feed 250 mm/min  scallop 10 um  sectors auto }",
            "no name is called `auto`",
        ),
        (
            "tool t1 = \"ball-2x24\"\noperation point { tool t1  speed 9000 rpm  feed 250 mm/min  scallop 10 um }",
            "leaves nothing open",
        ),
    ] {
        let folder = part(&format!(
            "use tools \"five-axis\"\nstock turned {{ over shroud 0 mm  bore 4 mm  back -18 mm }}\n{items}\npost siemens-840d\n"
        ));
        let refused = run(folder.path(), &["choose", "part.imp", "-o", "whole.imp"]);
        let text = said(&refused);
        assert!(refused.status.code() == Some(2) && text.contains(due), "{items}: {text}");
        assert!(!folder.path().join("whole.imp").exists());
    }
}
