//! Mistakes in files that are given whole, and on the command line, as a user makes them: one cause, one message, the way out in
//! it, the exit code of `--help`, and nothing is written. The ways out are tried.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// A mistake: what happened, the command, its exit code, and words of the one message, the way out among them.
type Mistake = (&'static str, &'static str, i32, &'static [&'static str]);

/// Words of the implementation that no message has.
const FOREIGN: [&str; 6] = ["expected struct", "invalid type", "panicked", "RUST_", "Some(", "jobs/"];

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// A table with the numbers from a column on divided by 1000: in metres what was in millimetres.
fn in_metres(table: &str, from: usize) -> String {
    let metres = |k: usize, field: &str| match field.parse::<f64>() {
        Ok(value) if k >= from => format!("{}", value / 1000.0),
        _ => field.to_owned(),
    };
    let line = |line: &str| line.split(',').enumerate().map(|(k, f)| metres(k, f)).collect::<Vec<_>>().join(",");
    table.lines().map(|l| if l.starts_with('#') { l.to_owned() } else { line(l) } + "\n").collect()
}

/// Points of the small job without words on their unit.
fn points() -> String {
    read("jobs/small/vane_curves.csv").replace(", mm.", ".")
}

fn utf_16(text: &str) -> Vec<u8> {
    [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
}

/// A folder with the small job, a job of sections, and the files of all mistakes.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &[u8]| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let small = read("jobs/small/small.imp");
    put("small.imp", small.as_bytes());
    put("vane_curves.csv", points().as_bytes());
    put("flow.csv", read("jobs/sections/flow.csv").as_bytes());
    let sections = read("jobs/sections/sections.csv").replace(", mm,", ",");
    put("sections.csv", in_metres(&sections, 2).as_bytes());
    put("sections.imp", read("jobs/sections/sections.imp").as_bytes());
    put(
        "sections_m.imp",
        read("jobs/sections/sections.imp").replace("sections.csv\" mm", "sections.csv\" m").as_bytes(),
    );
    let metres = in_metres(&points(), 2);
    let without_number = |l: &str| {
        let fields: Vec<&str> = l.split(',').collect();
        if l.starts_with('#') { l.to_owned() } else { [&fields[..1], &fields[2..]].concat().join(",") }
    };
    for (job, curves) in [
        ("metres", metres.clone().into_bytes()),
        ("head", metres.replace("x,y,z", "x [m],y [m],z [m]").into_bytes()),
        ("excel", points().replace(',', ";").replace('.', ",").into_bytes()),
        ("wide", utf_16(&points())),
        ("few", points().lines().map(|l| without_number(l) + "\n").collect::<String>().into_bytes()),
    ] {
        put(&format!("{job}.csv"), &curves);
        put(&format!("{job}.imp"), small.replace("vane_curves", job).as_bytes());
        put(
            &format!("{job}_m.imp"),
            small.replace("vane_curves", job).replace("sure mm", "sure m").replace("tion mm", "tion m").as_bytes(),
        );
    }
    put("lib/machines/5mc850-c.toml", b"{\"kind\": \"table-table\"}");
    let table = in_metres(&read("fuzz/corpus/tables/faces"), 3);
    put("blade.csv", table.as_bytes());
    put("titled.csv", table.replace("x,y,z", "x [m],y [m],z [m]").as_bytes());
    put("blade.ibl", read("fuzz/corpus/ibl/one").as_bytes());
    let set = read("fuzz/corpus/turbogrid/closed");
    put("alone.inf", set.split('\u{1}').next().unwrap().as_bytes());
    put("profile.curve", set.split('\u{1}').nth(3).unwrap().as_bytes());
    put("wheel.igs", b"1H,,1H;,4Hpart,6Hw.igs;\n");
    let wheel = read("fuzz/corpus/geomturbo/blade");
    put("cut.geomTurbo", &wheel.as_bytes()[..wheel.len() / 2]);
    put("wheel.geomTurbo", wheel.as_bytes());
    put("p.nc", b"%\nO1001\nN10 G0 X0 Y0\nM30\n%\n");
    folder
}

fn said(folder: &Path, command: &str) -> (i32, String) {
    let run =
        Command::new(env!("CARGO_BIN_EXE_impellerc")).current_dir(folder).args(command.split(' ')).output().unwrap();
    let text = String::from_utf8(run.stderr).unwrap();
    // A line that was broken for the terminal reads as one.
    (run.status.code().unwrap(), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn names(folder: &Path) -> BTreeSet<String> {
    std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

const MISTAKES: &[Mistake] = &[
    ("points in metres", "check metres.imp", 2, &["look like metres", "write `m` in the place of `mm`"]),
    (
        "points in metres, as their head says",
        "check head.imp",
        2,
        &["are in m, and the job says mm", "write `m`", "the head of the file says so"],
    ),
    ("a German spreadsheet", "check excel.imp", 2, &["separated by `;`", "the decimal sign is a point"]),
    ("points in UTF-16", "check wide.imp", 3, &["UTF-16: save it as UTF-8"]),
    ("points without a number", "check few.imp", 2, &["they have 4 values", "curve,number,x,y,z"]),
    ("sections in metres", "check sections.imp", 2, &["look like metres", "write `m`"]),
    (
        "a machine in JSON",
        "check small.imp --library lib",
        2,
        &["JSON", "`impellerc machines 5mc850-c` prints a file that is right"],
    ),
    (
        "a table in metres as mm",
        "import blade.csv --unit mm --blades 12 --axis z --start leading -o w.imp",
        2,
        &["look like metres", "state `--unit m`"],
    ),
    (
        "the head says m, the option mm",
        "import titled.csv --unit mm --blades 12 --axis z --start leading",
        2,
        &["of the file is m", "leave out `--unit`"],
    ),
    (
        "--unit m for a file in mm",
        "import blade.ibl --unit m --axis z --blades 12 --start leading",
        2,
        &["look like millimetres", "state `--unit mm`"],
    ),
    ("a profile without its .inf", "import profile.curve", 2, &["give the `.inf` file"]),
    ("an .inf without its files", "import alone.inf", 3, &["`hub.curve` cannot be read", "lies beside it"]),
    ("IGES", "import wheel.igs", 2, &["export the part", "as a STEP file"]),
    ("a geomTurbo that was cut off", "import cut.geomTurbo", 2, &["the file was cut off"]),
    ("a part into a CSV", "import wheel.geomTurbo -o w.csv --start leading", 3, &["write `-o w.imp`"]),
    ("compile as a command", "compile small.imp", 2, &["no command `compile`", "`impellerc small.imp -o PART.nc`"]),
    (
        "build with an option",
        "build small.imp -o small.nc",
        2,
        &["no command `build`", "`impellerc small.imp -o PART.nc`"],
    ),
    (
        "a setup sheet as PDF",
        "small.imp --setup-sheet sheet.pdf",
        3,
        &["`--setup-sheet sheet.html`", "a browser prints it as PDF"],
    ),
    ("an STL named as NC text", "small.imp --emit stl -o part.nc", 3, &["write `-o part.stl`"]),
    ("a job without its ending", "check small", 3, &["there is a job `small.imp`"]),
    ("a post that is not there", "small.imp --post haas -o small.nc", 2, &["no post file `haas`", "fanuc"]),
    ("a folder that is not there", "small.imp -o nc/small.nc", 3, &["there is no such folder", "nothing was written"]),
    ("verify without a job", "verify p.nc", 2, &["add `--job job.imp`"]),
    ("diff without a job", "diff p.nc p.nc", 2, &["add the job", "`impellerc diff p.nc p.nc --job job.imp`"]),
    ("fmt of NC text", "fmt p.nc", 2, &["NC text of fanuc, not a job"]),
];

#[test]
fn mistakes_in_files_and_commands_are_told_once_with_a_way_out() {
    let folder = folder();
    let before = names(folder.path());
    for (name, command, exit, words) in MISTAKES {
        let (code, text) = said(folder.path(), command);
        assert_eq!(code, *exit, "{name}: {text}");
        for word in *words {
            assert!(text.contains(word), "{name}: `{word}` in {text}");
        }
        assert!(text.matches(" × ").count() <= 1, "{name}: {text}");
        assert!(!FOREIGN.iter().any(|word| text.contains(word)), "{name}: {text}");
    }
    assert_eq!(names(folder.path()), before, "nothing is written");
}

#[test]
fn the_ways_out_of_a_wrong_unit_work() {
    let folder = folder();
    for command in [
        "check metres_m.imp",
        "check head_m.imp",
        "check sections_m.imp",
        "import blade.csv --unit m --blades 12 --axis z --start leading",
        "import titled.csv --blades 12 --axis z --start leading",
        "import blade.ibl --unit mm --axis z --blades 12 --start leading --pressure greater",
    ] {
        let (code, text) = said(folder.path(), command);
        assert_eq!(code, 0, "{command}: {text}");
    }
    // In metres the part is the same as in millimetres.
    let facts = |job: &str| said(folder.path(), &format!("check {job}")).1;
    let narrow = |text: String| {
        text.split("the throat of the channel is ").nth(1).unwrap().split(' ').next().unwrap().to_owned()
    };
    assert_eq!(narrow(facts("metres_m.imp")), narrow(facts("small.imp")));
}
