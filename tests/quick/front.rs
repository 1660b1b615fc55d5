//! The front end as an editor uses it: without a disk, with faults in the text, cancelled at any time.

use crate::support::sources;
use impellerc::base::progress::Progress;
use impellerc::base::source::SourceMap;
use impellerc::diagnostics::{Sink, codes};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::print;
use impellerc::job::{self, InMemory, PartialJob};
use impellerc::lower;
use impellerc::plan::passes::pipeline;
use impellerc::syntax::{self, ast::File};
use std::time::Duration;

const REDUCED: &str = include_str!("../../jobs/reduced/reduced.imp");

/// Its first tool.
const FLAT: &str =
    "tool t1 = flat { diameter 6 mm  flutes 4  flute 25 mm  reach 45 mm  max-depth 18 mm  holder \"er16-mini\" }";
const CURVES: &str = include_str!("../../jobs/reduced/vane_curves.csv");

fn files() -> InMemory {
    InMemory { curves: [("vane_curves.csv".to_owned(), CURVES.to_owned())].into(), ..InMemory::default() }
}

struct Understood {
    ast: File,
    job: PartialJob,
    sink: Sink,
}

fn understand(text: &str) -> Understood {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("job.imp", text);
    let ast = syntax::parse(text, source, &mut sink);
    let job = job::understand(&ast, &mut files(), &mut sources, &mut sink);
    Understood { ast, job, sink }
}

#[test]
fn texts_in_memory_give_what_files_give() {
    let mut sink = Sink::default();
    let job = understand(REDUCED).job.job().expect("a whole job");
    let program = lower::lower(&job, &mut sink).expect("a program");
    let mut outcome = Outcome::default();
    let options = Options { job: "jobs/reduced/reduced.imp".into(), ..Options::default() };
    let from_disk = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    assert_eq!(print::program(&program), print::program(&from_disk));
}

/// The order in which a job names the sectors of an operation does not matter.
#[test]
fn sectors_are_given_in_any_order() {
    let lowered = |sectors: &str| {
        let job = understand(&REDUCED.replace("sectors 1", sectors)).job.job().expect("a whole job");
        print::program(&lower::lower(&job, &mut Sink::default()).expect("a program"))
    };
    assert_eq!(lowered("sectors 3, 1"), lowered("sectors 1, 3"));
    assert_ne!(lowered("sectors 3, 1"), lowered("sectors 1"));
}

/// A limit that hardly forbids anything is a warning; one that a shop would write is none. The first of each pair is loose.
#[test]
fn loose_limits_are_told() {
    let doubts = |text: &str| {
        let found = understand(text);
        assert!(found.job.whole, "{:?}", found.sink.diags());
        let told = found.sink.diags().iter().filter(|d| d.code == codes::job::DOUBTFUL);
        told.map(|d| d.message.clone()).collect::<Vec<_>>()
    };
    assert_eq!(doubts(REDUCED), [""; 0]);
    for [loose, usual] in [
        ["excess <= 100 mm", "excess <= 0.2 mm"],
        ["rest <= 100 mm", "rest <= 1 mm"],
        ["contour-error <= 5 mm", "contour-error <= 5 um"],
        ["orientation-error <= 45 deg", "orientation-error <= 0.2 deg"],
        ["engagement <= 180 deg", "engagement <= 120 deg"],
        ["axis-speed <= 100 %", "axis-speed <= 80 %"],
        ["air <= 100 %", "air <= 30 %"],
        ["slot <= 100 %", "slot <= 50 %"],
        ["removal-rate <= 1000000 cm3/min", "removal-rate <= 20 cm3/min"],
        ["rest-volume <= 5000 cm3", "rest-volume <= 100 cm3"],
        ["time <= 9999 h", "time <= 2 h"],
        ["clearance holder >= 1 um", "clearance holder >= 1 mm"],
    ] {
        let with =
            |limit: &str| doubts(&REDUCED.replace("\npost siemens", &format!("\nrequire {limit}\npost siemens")));
        assert_eq!(with(loose).len(), 1, "{loose}: {:?}", with(loose));
        assert_eq!(with(usual), [""; 0], "{usual}");
    }
    for (limit, told) in [("12 mm", 0), ("18 mm", 0), ("18.1 mm", 1), ("100 mm", 1)] {
        let text = REDUCED.replacen("max-depth 18 mm", &format!("max-depth {limit}"), 1);
        assert_eq!(doubts(&text).len(), told, "{limit}");
    }
}

#[test]
fn a_file_that_is_not_there_is_a_fault_with_what_is_there() {
    let found = understand(&REDUCED.replace("vane_curves.csv", "vane_curve.csv"));
    let told = found.sink.diags().iter().find(|d| d.message.contains("vane_curve.csv")).expect("a fault");
    let text = format!("{told:?}");
    assert!(text.contains("vane_curves.csv"), "{text}");
}

#[test]
fn a_text_with_faults_leaves_the_rest_of_the_job() {
    let whole = understand(REDUCED);
    assert!(whole.sink.diags().is_empty() && whole.job.whole);
    // A word, a unit, a name, and a bracket that is not closed.
    let text = REDUCED
        .replace("tolerance chord", "tolerance cord")
        .replace("operation flank {", "operation flank { spin 3  ")
        .replace("use tools   \"carbide\"", "use tools \"carbide\"\nlet wall = 3 km");
    assert_ne!(text, REDUCED);
    let found = understand(&text);
    assert!(found.sink.diags().len() >= 3, "{:?}", found.sink.diags());
    let (part, all) = (&found.job, &whole.job);
    assert!(!part.whole && part.machine.is_some() && part.stock.is_some() && part.post.is_some());
    let vanes = |job: &PartialJob| job.part.as_ref().map(|p| p.vanes.value);
    assert_eq!(vanes(part), vanes(all));
    let names = |job: &PartialJob| job.operations.iter().map(|o| o.name.clone()).collect::<Vec<_>>();
    assert!(names(part).contains(&"channel".to_owned()), "{:?}", names(part));
    assert_eq!(part.contracts.len(), all.contracts.len());
    assert!(found.job.job().is_none());
    // An item that is cut off in the middle.
    let cut = &REDUCED[..REDUCED.find("operation expand").unwrap() + 25];
    let found = understand(cut);
    assert!(found.ast.damaged || found.sink.has_errors());
    assert!(found.job.part.is_some() && names(&found.job).contains(&"groove".to_owned()));
}

#[test]
fn comments_stay_in_the_tree() {
    for name in ["jobs/wei2021/wei2021.imp", "jobs/small/small.imp", "jobs/small/point.imp", "jobs/reduced/reduced.imp"]
    {
        let text = std::fs::read_to_string(name).unwrap();
        let found = understand(&text).ast.comments;
        // In these jobs no quoted text holds `//`.
        let lines = text.lines().filter_map(|l| l.find("//").map(|at| l[at..].trim_end()));
        assert!(lines.clone().count() > 0, "{name} has no comments");
        assert!(found.iter().map(|span| &text[span.range()]).eq(lines), "{name}");
    }
    let text = "let a = 1 mm // one\r\nuse tools \"no//comment\" // two  \n// three";
    let found = understand(text).ast.comments;
    assert_eq!(found.iter().map(|s| &text[s.range()]).collect::<Vec<_>>(), ["// one", "// two", "// three"]);
}

#[test]
fn planning_ends_when_it_is_cancelled() {
    let mut sink = Sink::default();
    let job = understand(REDUCED).job.job().expect("a whole job");
    let program = lower::lower(&job, &mut sink).expect("a program");
    let cancelled = Progress::default();
    cancelled.cancel();
    assert!(pipeline::run_with(&program, &cancelled, &mut sink).is_err());
    assert!(cancelled.all().is_empty() && !sink.has_errors());
    // In the middle, as soon as some work is seen.
    let whole = Progress::default();
    assert!(pipeline::run_with(&program, &whole, &mut sink).is_ok());
    let works = whole.all().len();
    let mut cut_short = 0;
    for after in [1, works / 3, 2 * works / 3] {
        let progress = Progress::default();
        let ended = std::thread::scope(|scope| {
            let run = scope.spawn(|| pipeline::run_with(&program, &progress, &mut Sink::default()).is_err());
            while progress.all().len() < after && !run.is_finished() {
                std::thread::sleep(Duration::from_micros(200));
            }
            progress.cancel();
            run.join().unwrap()
        });
        // On a busy machine a run may end before it is cancelled, but then it has done all of its work.
        assert!(ended || progress.all().len() == works, "after {after} of {works}");
        cut_short += usize::from(progress.all().len() < works);
    }
    assert!(cut_short > 0, "no run ended early");
}

/// What only the command line may use. Other programs give the library texts, files and the wish to cancel.
const OUTSIDE: [&str; 11] = [
    "std::fs",
    "std::io",
    "std::env",
    "std::process",
    "std::thread",
    "std::time",
    "Instant::now",
    "SystemTime",
    "use std::{",
    "println!",
    "print!(",
];

#[test]
fn the_library_has_no_disk_clock_terminal_or_threads_of_its_own() {
    let all = sources::all_files();
    // `lib.rs` leaves these out without the feature `cli`.
    let command_line = ["src/command_line", "src/driver", "src/output"];
    let own = all.iter().filter(|p| !command_line.iter().any(|c| p.starts_with(c) || p.starts_with(format!("{c}.rs"))));
    let mut files = 0;
    for path in own {
        files += 1;
        let text = std::fs::read_to_string(path).unwrap();
        let code = text.split("#[cfg(test)]\nmod").next().unwrap_or_default();
        let found = OUTSIDE.iter().find(|name| code.contains(**name));
        assert_eq!(found, None, "{}", path.display());
    }
    assert!(files > 150, "{files}");
}

/// A tool of one kind with one size replaced, as the text of a job and as that of a library.
fn tool(kind: &str, property: &str, value: &str) -> [String; 2] {
    let own: &[(&str, &str)] = match kind {
        "bull" => &[("flute", "30 mm"), ("corner", "1 mm")],
        "tapered-ball" => &[("flute", "30 mm"), ("angle", "3 deg")],
        "barrel" => &[("flute", "30 mm"), ("barrel", "85 mm"), ("tip", "1 mm")],
        "lollipop" => &[("neck", "4 mm"), ("neck-end", "30 mm")],
        _ => &[("flute", "30 mm")],
    };
    let all = [("diameter", "8 mm"), ("shank", "8 mm"), ("reach", "40 mm")];
    let sizes = all.iter().chain(own).map(|(name, size)| (*name, if *name == property { value } else { *size }));
    let (mut block, mut table) = (String::new(), format!("[tool.x]\nkind = \"{kind}\"\nflutes = 4\n"));
    for (name, size) in sizes {
        block.push_str(&format!("  {name} {size}\n"));
        table.push_str(&format!("{name} = \"{size}\"\n"));
    }
    let job = REDUCED.replace(FLAT, &format!("tool t1 = {kind} {{\n  flutes 4\n{block}}}"));
    [job, table]
}

#[test]
fn tools_of_a_job_and_of_a_library_have_the_same_ranges() {
    let sizes = ["0 mm", "0.009 mm", "0.01 mm", "0.09 mm", "0.1 mm", "3 mm", "249 mm", "251 mm", "501 mm", "1001 mm"];
    let (mut taken, mut refused) = (0, 0);
    for (kind, properties) in [
        ("flat", &["diameter", "shank", "reach", "flute"][..]),
        ("bull", &["corner"]),
        ("barrel", &["barrel", "tip"]),
        ("lollipop", &["neck", "neck-end"]),
        ("tapered-ball", &["angle"]),
    ] {
        let angles = ["0 deg", "0.09 deg", "0.11 deg", "20 deg", "44.9 deg", "45.1 deg"];
        for property in properties {
            for value in if *property == "angle" { &angles[..] } else { &sizes[..] } {
                let [own, table] = tool(kind, property, value);
                let library = REDUCED
                    .replace("use tools   \"carbide\"", "use tools \"carbide\"\nuse tools \"own\"")
                    .replace(FLAT, "tool t1 = \"x\"");
                let has_tool = |text: &str, files: &mut InMemory| {
                    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
                    let source = sources.add("job.imp", text);
                    let ast = syntax::parse(text, source, &mut sink);
                    let job = job::understand(&ast, files, &mut sources, &mut sink);
                    let of_size = [codes::job::OUT_OF_RANGE, codes::job::LIBRARY];
                    job.tools.iter().flatten().any(|t| t.name == "t1")
                        && !sink.diags().iter().any(|d| of_size.contains(&d.code))
                };
                let mut with_library = files();
                with_library.tools.insert("own".to_owned(), table);
                let found = [has_tool(&own, &mut files()), has_tool(&library, &mut with_library)];
                assert_eq!(found[0], found[1], "{kind} with {property} {value}: job, library");
                if found[0] { taken += 1 } else { refused += 1 }
            }
        }
    }
    assert!(taken > 20 && refused > 20, "{taken} taken, {refused} refused");
}

#[test]
fn what_the_parser_found_faulty_is_no_whole_job() {
    // An entry and a bracket that only the parser complains about, into a sink of its own.
    for (from, to) in [("fillet 3 mm\n", "fillet 3 mm ]\n"), ("tolerance chord", "tolerance } chord")] {
        let text = REDUCED.replacen(from, to, 1);
        assert_ne!(text, REDUCED);
        let (mut sources, mut of_parser, mut sink) = (SourceMap::default(), Sink::default(), Sink::default());
        let source = sources.add("job.imp", &*text);
        let ast = syntax::parse(&text, source, &mut of_parser);
        let job = job::understand(&ast, &mut files(), &mut sources, &mut sink);
        assert!(of_parser.has_errors() && !job.whole && job.job().is_none(), "{to}");
    }
}

#[test]
fn operations_keep_their_tools_beside_a_faulty_one() {
    let faulty = REDUCED.replace(FLAT, "tool t1 = \"flat-6x\"");
    let (found, whole) = (understand(&faulty).job, understand(REDUCED).job);
    assert!(found.tools[0].is_none() && found.tools[1].is_some());
    let tool = |job: &PartialJob, name: &str| {
        let operation = job.operations.iter().find(|o| o.name == name).unwrap();
        job.tools[operation.tool].as_ref().map(|t| t.name.clone())
    };
    assert_eq!(tool(&found, "channel"), tool(&whole, "channel"));
}
