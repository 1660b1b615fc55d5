//! Files of a run of the real program: no file of the user is lost or leaked, and all outputs are written or none. The
//! list of input files does not depend on the spelling of paths, and exit codes report how a run ended.

#![cfg(unix)]

use std::collections::BTreeMap;
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, symlink};
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// The small job without its finishing: these tests are about files.
static JOB: LazyLock<String> = LazyLock::new(|| {
    let text = include_str!("../../jobs/small/small.imp");
    let (rough, rest) = text.split_once("operation flank").unwrap();
    let (_, after) = rest.split_once("tolerance").unwrap();
    format!("{rough}tolerance{after}")
});
const CURVES: &str = include_str!("../../jobs/small/vane_curves.csv");
const MACHINE: &str = include_str!("../../jobs/_lib/machines/5mc850-c.toml");
const TOOLS: &str = include_str!("../../jobs/_lib/tools/carbide.toml");

const PROGRAM: &str = env!("CARGO_BIN_EXE_impellerc");

/// A folder with the small job, its curves and a library beside it.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.file("job.imp", &*JOB);
        place.file("vane_curves.csv", CURVES);
        place.file("_lib/machines/5mc850-c.toml", MACHINE);
        place.file("_lib/tools/carbide.toml", TOOLS);
        place
    }

    /// The same with the reduced job, which takes longer and writes more.
    fn with_the_reduced_job() -> Self {
        let place = Self::new();
        place.file("job.imp", include_str!("../../jobs/reduced/reduced.imp"));
        place.file("vane_curves.csv", include_str!("../../jobs/reduced/vane_curves.csv"));
        place
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn file(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.at(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Everything in the folder, by path: kind, rights, number, target of a link or bytes of a file.
    fn state(&self) -> BTreeMap<PathBuf, String> {
        let mut found = BTreeMap::new();
        let mut open = vec![self.folder.path().to_path_buf()];
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let metadata = path.symlink_metadata().unwrap();
                let kind = metadata.file_type();
                let held = if kind.is_symlink() {
                    path.read_link().unwrap().display().to_string()
                } else if kind.is_file() {
                    blake3::hash(&std::fs::read(&path).unwrap()).to_string()
                } else {
                    String::new()
                };
                if kind.is_dir() {
                    open.push(path.clone());
                }
                found.insert(path, format!("{kind:?} {:o} {} {held}", metadata.mode(), metadata.ino()));
            }
        }
        found
    }

    /// Runs in the folder.
    fn run(&self, arguments: &[&str]) -> Run {
        Run::new(Command::new(PROGRAM).args(arguments).current_dir(self.folder.path()).stdin(Stdio::null()).output())
    }

    /// Runs by a shell in the folder: `$0` is the program.
    fn shell(&self, script: &str) -> Run {
        let mut command = Command::new("bash");
        Run::new(command.args(["-c", script, PROGRAM]).current_dir(self.folder.path()).stdin(Stdio::null()).output())
    }
}

struct Run {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Run {
    fn new(output: std::io::Result<Output>) -> Self {
        let output = output.unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let run = Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) };
        assert!(!run.err.contains("panicked"), "{}", run.err);
        run
    }

    /// The words without frames and line ends.
    fn flat(&self) -> String {
        self.err.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ")
    }

    fn fails(self, code: i32, words: &[&str]) -> Self {
        let flat = self.flat();
        assert_eq!(self.code, Some(code), "{flat}");
        for word in words {
            assert!(flat.contains(word), "no `{word}` in {flat}");
        }
        assert!(flat.contains("help:"), "{flat}");
        self
    }

    fn holds(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self
    }
}

/// The job compiled once, with its certificate: `part.nc` and `part.json`.
static COMPILED: LazyLock<Place> = LazyLock::new(|| {
    let place = Place::new();
    place.run(&["job.imp", "-o", "part.nc", "--certificate", "part.json"]).holds();
    place
});

#[test]
fn no_output_is_an_input() {
    let place = Place::new();
    std::fs::create_dir_all(place.at("sub/stock")).unwrap();
    symlink("../job.imp", place.at("sub/link")).unwrap();
    symlink("sub/link", place.at("link to a link")).unwrap();
    std::fs::hard_link(place.at("job.imp"), place.at("hard")).unwrap();
    symlink(place.folder.path(), place.at("sub/whole")).unwrap();
    std::fs::hard_link(place.at("vane_curves.csv"), place.at("sub/stock/01-groove.stl")).unwrap();
    let before = place.state();
    let absolute = place.at("job.imp");
    for arguments in [
        ["-o", "job.imp"],
        ["-o", "./job.imp"],
        ["-o", "sub/../job.imp"],
        ["-o", "sub/whole/job.imp"],
        ["-o", absolute.to_str().unwrap()],
        ["-o", "link to a link"],
        ["-o", "hard"],
        ["-o", "vane_curves.csv"],
        ["-o", "_lib/machines/5mc850-c.toml"],
        ["-o", "_lib/tools/carbide.toml"],
        ["--report", "job.imp"],
        ["--report", "sub/link"],
        ["--certificate", "job.imp"],
        ["--certificate", "vane_curves.csv"],
        ["--picture", "job.imp"],
        ["--stock", "sub/stock"],
    ] {
        let run = place.run(&[&["job.imp"], &arguments[..]].concat());
        let run = run.fails(2, &["IMP0904", "would replace an input", "nothing was written"]);
        assert!(run.out.is_empty(), "{arguments:?}: {}", run.out);
        assert_eq!(place.state(), before, "{arguments:?}");
    }
}

#[test]
fn no_output_is_another_one() {
    let place = Place::new();
    std::fs::create_dir(place.at("stock")).unwrap();
    symlink("new.nc", place.at("dangling")).unwrap();
    place.file("old", "old text");
    std::fs::hard_link(place.at("old"), place.at("also old")).unwrap();
    let before = place.state();
    for arguments in [
        ["-o", "x", "--report", "x"],
        ["-o", "x", "--certificate", "./stock/../x"],
        ["-o", "new.nc", "--picture", "dangling"],
        ["--certificate", "old", "--report", "also old"],
        ["--stock", "stock", "-o", "stock/01-groove.stl"],
    ] {
        place.run(&[&["job.imp"], &arguments[..]].concat()).fails(2, &["IMP0904", "are the same file"]);
        assert_eq!(place.state(), before, "{arguments:?}");
    }
    // A folder that would be made is gone again; and what is printed is an output too.
    place.run(&["job.imp", "--stock", "made/here", "-o", "made/here"]).fails(3, &["IMP0903", "it is a folder"]);
    assert_eq!(place.state(), before);
    place.run(&["job.imp", "-o", "/dev/stdout"]).fails(2, &["IMP0904", "standard output", "--emit nc"]);
    place.file("log", "");
    let run = place.shell("$0 job.imp -o part.nc --report log > log 2>&1");
    assert_eq!(run.code, Some(2));
    assert!(std::fs::read_to_string(place.at("log")).unwrap().contains("IMP0904"));
    let run = place.shell("$0 job.imp -o /dev/stdout > log");
    assert_eq!((run.code, run.flat().contains("already open")), (Some(3), true), "{}", run.err);
}

#[test]
fn no_output_is_named_like_a_file_of_another_form() {
    let place = Place::new();
    let before = place.state();
    for (arguments, right) in [
        (&["--setup-sheet", "sheet.pdf"][..], "--setup-sheet sheet.html"),
        (&["--report", "report.pdf"], "--report report.html"),
        (&["--certificate", "part.xml"], "--certificate part.json"),
        (&["--source-map", "map.csv"], "--source-map map.json"),
        (&["--picture", "part.jpg"], "--picture part.png"),
        (&["--emit", "stl", "-o", "part.nc"], "-o part.stl"),
        (&["--emit", "step", "-o", "part.stl"], "-o part.step"),
        (&["-o", "part.STL"], "--emit stl"),
        (&["-o", "part.json"], "--certificate PART.json"),
        (&["-o", "part.pdf"], "the ending that the control reads"),
    ] {
        place.run(&[&["job.imp"], arguments].concat()).fails(3, &["IMP0903", right]);
        assert_eq!(place.state(), before, "{arguments:?}");
    }
}

#[test]
fn what_is_verified_is_no_output() {
    let place = &*COMPILED;
    let before = place.state();
    for (report, name) in [("part.nc", "part.nc"), ("part.json", "the certificate"), ("job.imp", "job.imp")] {
        let run =
            place.run(&["verify", "part.nc", "--job", "job.imp", "--certificate", "part.json", "--report", report]);
        run.fails(2, &["IMP0904", "would replace an input", name]);
        assert_eq!(place.state(), before, "{report}");
    }
}

/// One compilation: a link keeps pointing, rights, owner and the mask of the user count, another hard link keeps its text.
#[test]
fn files_keep_what_is_theirs() {
    let place = Place::new();
    for name in ["real/part.nc", "picture.png", "kept.png", "report.html"] {
        place.file(name, "old text");
    }
    symlink("real/part.nc", place.at("part.nc")).unwrap();
    symlink("real/new.json", place.at("part.json")).unwrap();
    std::fs::remove_file(place.at("kept.png")).unwrap();
    std::fs::hard_link(place.at("picture.png"), place.at("kept.png")).unwrap();
    let rights = |name: &str, mode: u32| {
        std::fs::set_permissions(place.at(name), std::fs::Permissions::from_mode(mode)).unwrap();
    };
    rights("real/part.nc", 0o640);
    rights("report.html", 0o606);
    // Only the administrator can give files away.
    let given = std::os::unix::fs::chown(place.at("real/part.nc"), Some(1234), Some(4321)).is_ok();
    let run = place
        .shell("umask 027; $0 job.imp -o part.nc --certificate part.json --picture picture.png --report report.html");
    let run = run.holds();
    for name in ["part.nc", "part.json", "picture.png", "report.html"] {
        assert!(run.out.contains(&format!("wrote {name}")), "{}", run.out);
        assert_ne!(std::fs::read(place.at(name)).unwrap(), b"old text", "{name}");
    }
    let metadata = |name: &str| place.at(name).symlink_metadata().unwrap();
    assert_eq!(place.at("part.nc").read_link().unwrap(), Path::new("real/part.nc"));
    assert_eq!(place.at("part.json").read_link().unwrap(), Path::new("real/new.json"));
    assert_eq!(metadata("real/part.nc").mode() & 0o7777, 0o640);
    assert_eq!(metadata("report.html").mode() & 0o7777, 0o606);
    assert_eq!(metadata("real/new.json").mode() & 0o7777, 0o640, "the mask of the user");
    if given {
        assert_eq!((metadata("real/part.nc").uid(), metadata("real/part.nc").gid()), (1234, 4321));
    }
    assert_eq!(std::fs::read(place.at("kept.png")).unwrap(), b"old text");
    assert_eq!(place.state().keys().filter(|p| p.display().to_string().contains(".impellerc-")).count(), 0);
}

#[test]
fn what_is_write_protected_is_not_replaced() {
    let place = Place::new();
    place.file("part.nc", "proved and released");
    std::fs::set_permissions(place.at("part.nc"), std::fs::Permissions::from_mode(0o444)).unwrap();
    symlink("part.nc", place.at("link")).unwrap();
    std::os::unix::net::UnixListener::bind(place.at("socket")).unwrap();
    let before = place.state();
    for (arguments, words) in [
        (["-o", "part.nc"], "it is read-only"),
        (["-o", "link"], "it is read-only"),
        (["--report", "part.nc"], "it is read-only"),
        (["-o", "socket"], "it is a socket"),
        (["-o", "_lib"], "it is a folder"),
        (["-o", "new/"], "the path is that of a folder"),
        (["--stock", "job.imp"], "a file has this path"),
    ] {
        place.run(&[&["job.imp"], &arguments[..]].concat()).fails(3, &["IMP0903", words]);
        assert_eq!(place.state(), before, "{arguments:?}");
    }
}

/// A FIFO gets the text, a device too, and both stay what they are. The text is the one that a file gets.
#[test]
fn devices_are_written_to_and_stay() {
    let place = Place::new();
    let made = |arguments: &[&str]| {
        Command::new(arguments[0])
            .args(&arguments[1..])
            .current_dir(place.folder.path())
            .status()
            .is_ok_and(|s| s.success())
    };
    assert!(made(&["mkfifo", "fifo"]));
    // Only the administrator makes devices; a link to one is as good.
    if !made(&["mknod", "null", "c", "1", "3"]) {
        symlink("/dev/null", place.at("null")).unwrap();
    }
    let before = place.state();
    let reader = {
        let path = place.at("fifo");
        std::thread::spawn(move || std::fs::read(path).unwrap())
    };
    place.run(&["job.imp", "-o", "fifo", "--certificate", "null", "--report", "null"]).holds();
    assert!(reader.join().unwrap() == std::fs::read(COMPILED.at("part.nc")).unwrap());
    assert_eq!(place.state(), before);
    let null = std::fs::metadata("/dev/null").unwrap();
    assert!(!null.is_file() && null.rdev() == std::fs::metadata(place.at("null")).unwrap().rdev());
    // A device that takes nothing: the files beside it stay as they were.
    place.file("part.nc", "old text");
    let before = place.state();
    let run = place.run(&["job.imp", "-o", "part.nc", "--report", "/dev/full"]);
    let run = run.fails(3, &["IMP0903", "/dev/full cannot be written: the disk is full"]);
    assert!(!run.out.contains("wrote"), "{}", run.out);
    assert_eq!(place.state(), before);
}

/// NC text fits, the certificate does not, or the other way round: all stays as it was.
#[test]
fn a_full_disk_changes_nothing() {
    let place = Place::new();
    for name in ["part.nc", "part.json", "part.html"] {
        place.file(name, "old text");
    }
    let before = place.state();
    let outputs = "job.imp --stock-cell 1 -o part.nc --certificate part.json --report part.html";
    // The limit of the shell for one file, in 1024 bytes: the signal that it sends ends no run. The text has 8 kB, the
    // certificate 84 kB, the report 660 kB.
    let run = place.shell(&format!("ulimit -f 40; $0 {outputs}"));
    let run = run.fails(3, &["IMP0903", "cannot be written", "nothing was written"]);
    assert!(!run.out.contains("wrote"), "{}", run.out);
    assert_eq!(place.state(), before);
    // A disk of its own, which only the administrator can make.
    let disk = place.at("disk");
    std::fs::create_dir(&disk).unwrap();
    let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", "size=512k", "tmpfs"]).arg(&disk).status();
    if !mounted.is_ok_and(|s| s.success()) {
        eprintln!("skipped: no small disk can be made here");
        return;
    }
    struct Mounted(PathBuf);
    impl Drop for Mounted {
        fn drop(&mut self) {
            let _ = Command::new("umount").arg("-l").arg(&self.0).status();
        }
    }
    let _mounted = Mounted(disk);
    for name in ["disk/part.nc", "disk/part.json"] {
        place.file(name, "old text");
    }
    let before = place.state();
    let outputs = ["-o", "disk/part.nc", "--certificate", "disk/part.json", "--report", "disk/r.html"];
    let run = place.run(&[&["job.imp", "--stock-cell", "1"][..], &outputs].concat());
    run.fails(3, &["IMP0903", "disk/r.html cannot be written: the disk is full", "nothing was written"]);
    assert_eq!(place.state(), before);
}

/// Ended while temporary files are there: all of them go, nothing else changes, and the shell sees the signal. One that is
/// ignored, as under `nohup`, stays ignored.
#[test]
fn a_signal_leaves_nothing_behind() {
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        let place = Place::with_the_reduced_job();
        place.file("part.nc", "old text");
        let before = place.state();
        let trap = if signal == "HUP" { "trap '' INT" } else { "trap '' HUP" };
        // What started the tests may ignore the signal, as `nohup` does.
        let script = format!(
            "{trap}; exec env --default-signal={signal} $0 job.imp -o part.nc --certificate part.json --stock stock/meshes"
        );
        let mut child = Command::new("bash")
            .args(["-c", &script, PROGRAM])
            .current_dir(place.folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let start = Instant::now();
        let temporaries = || {
            let meshes = std::fs::read_dir(place.at("stock/meshes")).into_iter().flatten();
            meshes.filter(|e| e.as_ref().unwrap().file_name().to_str().unwrap().starts_with(".impellerc-")).count()
        };
        // The first mesh is written long before the end; probes before it are empty and gone at once.
        while start.elapsed() < Duration::from_secs(1) || temporaries() == 0 {
            assert!(child.try_wait().unwrap().is_none(), "it ended before the signal");
            std::thread::sleep(Duration::from_millis(5));
        }
        let send = |name: &str| {
            let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status();
            assert!(sent.unwrap().success());
        };
        send(if signal == "HUP" { "INT" } else { "HUP" });
        std::thread::sleep(Duration::from_millis(50));
        send(signal);
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.signal(), Some(number), "{said}");
        assert!(said.contains(&format!("ended by SIG{signal}: nothing was written")), "{said}");
        assert_eq!(place.state(), before);
    }
}

/// Ended while a FIFO has a part of the certificate and its reader waits: the NC text, which follows it, stays the old one,
/// and what is said of the FIFO is true.
#[test]
fn a_signal_between_two_outputs_leaves_no_half() {
    let place = Place::new();
    place.file("part.nc", "old text");
    assert!(Command::new("mkfifo").arg(place.at("fifo")).status().unwrap().success());
    let before = place.state();
    let child = Command::new(PROGRAM)
        .args(["job.imp", "-o", "part.nc", "--certificate", "fifo"])
        .current_dir(place.folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut reader = std::fs::File::open(place.at("fifo")).unwrap();
    let mut start = [0; 10];
    std::io::Read::read_exact(&mut reader, &mut start).unwrap();
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.signal(), Some(15), "{said}");
    assert!(said.contains("no file was written; fifo may have received a part of its text"), "{said}");
    assert_eq!(place.state(), before);
}

/// `--timings` has a line for each stage, pass and check, with the times of clock and processor.
#[test]
fn timings_by_pass_and_check() {
    let place = Place::new();
    let run = place.run(&["job.imp", "-o", "timed.nc", "--timings"]);
    let lines: Vec<Vec<&str>> = run.err.lines().map(|l| l.split_whitespace().collect()).collect();
    assert!(lines.contains(&vec!["clock", "processor"]), "{}", run.err);
    for name in ["lower", "plan", "link-moves", "time-feeds", "verify", "surfaces", "clearance", "stock", "total"] {
        let line = lines.iter().find(|l| l.first() == Some(&name) && l.len() == 5 && l[2] == "s" && l[4] == "s");
        let line = line.unwrap_or_else(|| panic!("no times of {name}: {}", run.err));
        assert!(line[1].parse::<f64>().is_ok() && line[3].parse::<f64>().is_ok(), "{line:?}");
    }
}

#[test]
fn cells_of_the_stock_are_only_made_finer() {
    let place = Place::new();
    let before = place.state();
    for cell in ["30", "1.001", "1e300", "inf", "NaN", "0", "-1"] {
        let run = place.run(&["job.imp", "-o", "part.nc", "--stock-cell", cell, "--timings"]);
        let run = run.fails(2, &["IMP0733", "give `--stock-cell` at most 1 on this part"]);
        let planned = run.err.lines().any(|l| l.starts_with("plan "));
        assert!(run.err.contains("\nlower ") && !planned, "told before planning: {}", run.err);
        assert_eq!(place.state(), before);
    }
    COMPILED.run(&["verify", "part.nc", "--job", "job.imp", "--stock-cell", "30"]).fails(2, &["IMP0733"]);
}

/// The job with other curve files.
fn with_curves(place: &Place, path: &str) {
    place.file("job.imp", JOB.replace("\"vane_curves.csv\"", &format!("\"{path}\"")));
}

#[test]
fn curves_come_from_the_folder_of_the_job() {
    let place = Place::new();
    let secret = "TOKEN=do-not-show-this";
    let outside = tempfile::tempdir().unwrap();
    std::fs::write(outside.path().join("curves.csv"), CURVES).unwrap();
    std::fs::write(outside.path().join("secret"), secret).unwrap();
    symlink(outside.path().join("secret"), place.at("inside.csv")).unwrap();
    symlink(outside.path(), place.at("folder")).unwrap();
    let absolute = outside.path().join("curves.csv").display().to_string();
    for path in ["/proc/self/environ", "inside.csv", "folder/secret", &absolute, "folder/curves.csv"] {
        with_curves(&place, path);
        let run = Command::new(PROGRAM).arg(place.at("job.imp")).env("SECRET", secret).output();
        let run = Run::new(run).fails(3, &["IMP0905", "outside the folder of the job", "--curves"]);
        assert!(!run.err.contains("do-not-show"), "{}", run.err);
    }
    // Named on the command line it may be read, with any path that leads there; nothing else may.
    let named = outside.path().to_str().unwrap();
    for path in ["curves.csv", "folder/curves.csv", &absolute] {
        with_curves(&place, path);
        place.run(&["job.imp", "--curves", named, "--emit", "job"]).holds();
    }
    with_curves(&place, "/proc/self/environ");
    place.run(&["job.imp", "--curves", named]).fails(3, &["IMP0905"]);
    place.run(&["job.imp", "--curves", "no such folder"]).fails(3, &["IMP0901", "there is no such folder"]);
    // No regular file: a FIFO without a writer would be waited for, a device has no end.
    assert!(Command::new("mkfifo").arg(place.at("fifo")).status().unwrap().success());
    with_curves(&place, "fifo");
    place.run(&["job.imp"]).fails(3, &["IMP0901", "it is not a regular file"]);
}

/// A file that is no table is not quoted, wherever it lies; a table with a fault is, without what steers a terminal.
#[test]
fn messages_quote_no_file_that_is_no_table() {
    let place = Place::new();
    for text in [
        "user:do-not-show-this:0:0",
        "a,b,c,d,do-not-show-this\n",
        "do-not-show-this,1,2,3\n",
        "a,1,1,1,1\nb\u{1b}[2J,1,1,1,1\ndo-not-show-this\n",
    ] {
        place.file("vane_curves.csv", text);
        let run = place.run(&["job.imp"]).fails(2, &["IMP0220", "is not a table of points"]);
        assert!(!run.err.contains("do-not-show") && !run.err.contains('\u{1b}'), "{}", run.err);
    }
    place.file("vane_curves.csv", CURVES.replacen(",1,", ",1O,", 1));
    place.run(&["job.imp"]).fails(2, &["IMP0220", "1O"]);
}

#[test]
fn control_characters_reach_no_terminal() {
    let place = Place::new();
    place.file("a\u{1b}[31m\u{202e}.imp", "edition 2026\nedition 2027");
    place.file("bad.imp", &*JOB);
    let steers = |text: &str| text.contains('\u{1b}') || text.contains('\u{202e}') || text.contains('\u{7}');
    for arguments in [
        vec!["no\u{1b}[2J.imp"],
        vec!["job.imp", "-o", "no\u{1b}/part.nc"],
        vec!["job.imp", "--library", "\u{202e}"],
        vec!["verify", "\u{7}", "--job", "job.imp"],
    ] {
        let run = place.run(&arguments).fails(3, &["IMP09"]);
        assert!(!steers(&run.err) && !steers(&run.out), "{:?}", run.err);
    }
    // A path that is printed when all went well.
    let run = place.run(&["job.imp", "-o", "part\u{1b}[2J.nc"]).holds();
    assert!(run.out.contains("wrote part<U+001B>[2J.nc") && !steers(&run.out), "{}", run.out);
}

fn pair(place: &Place) -> (Vec<u8>, Vec<u8>) {
    (std::fs::read(place.at("part.nc")).unwrap(), std::fs::read(place.at("part.json")).unwrap())
}

/// The machine beside the job is another than the shipped one, so that a lookup that misses it makes other bytes.
#[test]
fn spelling_of_the_path_changes_nothing() {
    let machine = format!("{MACHINE}\n# of this shop\n");
    let place = Place::new();
    place.file("_lib/machines/5mc850-c.toml", &machine);
    std::fs::create_dir_all(place.at("deep/er")).unwrap();
    place.file("deep/er/job.imp", &*JOB);
    place.file("deep/er/vane_curves.csv", CURVES);
    std::fs::remove_file(place.at("job.imp")).unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    symlink(place.at("deep/er/job.imp"), elsewhere.path().join("other.imp")).unwrap();
    let absolute = place.at("deep/er/job.imp");
    let (nc, json) = (place.at("part.nc"), place.at("part.json"));
    let mut all = Vec::new();
    for (folder, path) in [
        (place.at("deep/er"), "job.imp"),
        (place.at("deep/er"), "../../deep/er/job.imp"),
        (PathBuf::from("/"), absolute.to_str().unwrap()),
        (elsewhere.path().to_path_buf(), "other.imp"),
    ] {
        let mut run = Command::new(PROGRAM);
        run.arg(path).arg("-o").arg(&nc).arg("--certificate").arg(&json).current_dir(folder);
        Run::new(run.output()).holds();
        all.push(pair(&place));
    }
    assert!(all.iter().all(|pair| *pair == all[0]));
    // What took part stands in both.
    let text = String::from_utf8(all[0].0.clone()).unwrap();
    let certificate: serde_json::Value = serde_json::from_slice(&all[0].1).unwrap();
    let files = certificate["inputs"]["files"].as_array().unwrap();
    let origins: Vec<[&str; 2]> =
        files.iter().map(|f| [f["name"].as_str().unwrap(), f["origin"].as_str().unwrap()]).collect();
    assert_eq!(
        origins,
        [
            ["job.imp", "given"],
            ["machines/5mc850-c.toml", "beside job"],
            ["tools/carbide.toml", "beside job"],
            ["vane_curves.csv", "beside job"],
            ["posts/siemens-840d.toml", "shipped"]
        ]
    );
    for file in files {
        let [name, origin, hash] = ["name", "origin", "sha256"].map(|key| file[key].as_str().unwrap());
        let first = text.lines().position(|l| l.contains(&format!("file sha256 {hash}, {origin}"))).unwrap();
        assert!(text.lines().nth(first + 1).unwrap().contains(&format!("named {name}")), "{name}");
    }
    assert_eq!(files[1]["bytes"].as_u64().unwrap() as usize, machine.len());
}

#[test]
fn a_library_is_there_and_is_named() {
    let place = Place::new();
    place.file("shop/machines/5mc850-c.toml", MACHINE);
    std::fs::remove_dir_all(place.at("_lib")).unwrap();
    for (library, words) in [("no such", "there is no such folder"), ("job.imp", "it is not a folder")] {
        for more in [vec!["job.imp"], vec!["verify", "job.imp", "--job", "job.imp"]] {
            place.run(&[&more[..], &["--library", library]].concat()).fails(3, &["IMP0901", "--library", words]);
        }
    }
    // A file that is there and cannot be read is told, and not passed over for the shipped one.
    place.file("shop/tools/carbide.toml", [0xff, 0xfe]);
    place.run(&["job.imp", "--library", "shop"]).fails(3, &["IMP0901", "it is a text in UTF-16: save it as UTF-8"]);
    std::fs::remove_file(place.at("shop/tools/carbide.toml")).unwrap();
    place.run(&["job.imp", "--library", "shop", "-o", "part.nc"]).holds();
    let text = std::fs::read_to_string(place.at("part.nc")).unwrap();
    let named = |name: &str| {
        let at = text.lines().position(|l| l.contains(&format!("named {name}"))).unwrap();
        text.lines().nth(at - 1).unwrap().to_owned()
    };
    assert!(named("machines/5mc850-c.toml").contains(", library"), "{text:.2000}");
    assert!(named("tools/carbide.toml").contains(", shipped"), "{text:.2000}");
}

/// Any line of the head, edited, dropped, added or moved: the certificate does not belong to the text any more.
#[test]
fn the_head_is_covered_by_the_certificate() {
    let text = std::fs::read_to_string(COMPILED.at("part.nc")).unwrap();
    let place = Place::new();
    let certificate = COMPILED.at("part.json").display().to_string();
    let check = |text: &str| {
        place.file("part.nc", text);
        place.run(&["verify", "part.nc", "--certificate", &certificate])
    };
    check(&text).holds();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let head = lines.iter().take_while(|l| l.starts_with([';', '('])).count();
    assert!(head > 12 && lines[..head].concat().contains("tool"), "{}", lines[..head].concat());
    for at in 0..head {
        let mut dropped = lines.clone();
        dropped.remove(at);
        let mut changed: Vec<String> = lines.iter().map(|l| (*l).to_owned()).collect();
        let middle = changed[at].len() / 2;
        let other = if changed[at].as_bytes()[middle] == b'7' { "8" } else { "7" };
        changed[at].replace_range(middle..=middle, other);
        for edited in [dropped.concat(), changed.concat()] {
            check(&edited).fails(1, &["IMP0827"]);
        }
    }
    let zero = lines.iter().position(|l| l.contains("zero at")).unwrap();
    let moved = text.replacen("origin of the part frame", "origin of the chuck", 1);
    check(&moved).fails(1, &[&format!("line {} differs", zero + 1)]);
    let mut more = lines.clone();
    more.insert(head, "; tool t9 number 1\n");
    check(&more.concat()).fails(1, &[&format!("line {} differs", head + 1)]);
    let mut swapped = lines;
    swapped.swap(head - 1, head - 2);
    check(&swapped.concat()).fails(1, &["IMP0827"]);
}

#[test]
fn a_certificate_says_everything_once() {
    let text = std::fs::read_to_string(COMPILED.at("part.json")).unwrap();
    let nc = COMPILED.at("part.nc").display().to_string();
    let place = Place::new();
    for (from, to, words) in [
        ("\"version\": 2", "\"version\": 2, \"version\": 2", "the key `version` stands twice"),
        ("\"holds\": true", "\"holds\": false, \"holds\": true", "the key `holds` stands twice"),
        ("\"holds\": true", "\"holds\": false", "does not hold"),
        ("\"found\": ", "\"found\": null, \"said\": ", "have no figures"),
        ("\"spacing\": ", "\"spacing\": 1e999, \"said\": ", "not JSON"),
        ("\"spacing\": ", "\"spacing\": NaN, \"said\": ", "not JSON"),
        ("\"version\": 2", "\"version\": 1", "version 1"),
    ] {
        assert!(text.contains(from), "{from}");
        let mut edited = text.clone();
        // The contracts stand behind everything else that has these words.
        let at =
            edited.rfind("\"contracts\"").filter(|_| from != "\"version\": 2" && from != "\"spacing\": ").unwrap_or(0);
        let at = at + edited[at..].find(from).unwrap();
        edited.replace_range(at..at + from.len(), to);
        place.file("part.json", &edited);
        place.run(&["verify", &nc, "--certificate", "part.json"]).fails(2, &["IMP0826", words]);
    }
}

#[test]
fn exit_codes_say_how_a_run_ended() {
    let place = Place::new();
    let broken = JOB.replacen("require clearance", "require excess <= 1 um\nrequire clearance", 1);
    assert_ne!(broken, *JOB);
    place.file("broken.imp", broken);
    place.file("syntax.imp", "edition 2026\npart {");
    // 1: a contract; the report is written, the NC text is not.
    let run = place.run(&["broken.imp", "-o", "part.nc", "--report", "part.html"]).fails(1, &["IMP0703"]);
    assert!(run.out.contains("wrote part.html; no NC text"), "{}", run.out);
    assert!(place.at("part.html").exists() && !place.at("part.nc").exists());
    // 2: the text, the command line.
    place.run(&["syntax.imp"]).fails(2, &["IMP0"]);
    place.run(&["verify", "part.html", "--job", "job.imp"]).fails(2, &["IMP0821"]);
    place.run(&["verify", "part.html"]).fails(2, &["IMP0828"]);
    assert_eq!(place.run(&["--no-such-flag"]).code, Some(2));
    assert_eq!(place.run(&["explain", "IMP9999"]).code, Some(2));
    // 3: a file; it counts more than the text and the contract.
    place.run(&["missing.imp"]).fails(3, &["IMP0901"]);
    place.run(&["broken.imp", "--report", "/dev/full"]).fails(3, &["IMP0703", "IMP0903"]);
    // What is printed and read by nobody is a file that cannot be written, and no panic.
    let run = place.shell("$0 job.imp --emit job | head -c 1; exit ${PIPESTATUS[0]}");
    assert!(matches!(run.code, Some(0 | 3)), "{:?} {}", run.code, run.err);
    let run = place.shell("$0 job.imp --emit job >&-");
    assert!(!run.err.contains("panicked"), "{}", run.err);
    for arguments in [&["--help"][..], &["verify", "--help"]] {
        let help = place.run(arguments).holds().out;
        assert!(help.contains("Exit codes:") && help.contains("cannot be read or written"), "{help}");
    }
}
