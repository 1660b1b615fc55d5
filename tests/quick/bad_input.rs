//! Hostile and faulty input to the real program: the result is a diagnostic with its code and exit code 2 or 3. Nothing
//! is written, and memory is bounded.

use crate::support::bounded;
use std::path::{Path, PathBuf};
use std::process::Command;

const JOB: &str = include_str!("../../jobs/wei2021/paper-strategies.imp");

struct Run {
    folder: tempfile::TempDir,
}

impl Run {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn file(self, name: &str, text: impl AsRef<[u8]>) -> Self {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
        self
    }

    /// Compiles `job.imp`, which must fail with a code; the old output file must stay as it was.
    fn fails_with(self, code: &str) {
        let output = self.path("part.nc");
        std::fs::write(&output, "old program").unwrap();
        let text = fails(&self.path("job.imp"), &output, code);
        assert_eq!(std::fs::read_to_string(&output).unwrap(), "old program", "{text}");
    }
}

fn fails(job: &Path, output: &Path, code: &str) -> String {
    let run = bounded::program().arg(job).arg("-o").arg(output).output().unwrap();
    let text = String::from_utf8_lossy(&run.stderr).into_owned();
    // What cannot be read or written, and what cannot be understood.
    let exit = if ["IMP0901", "IMP0903"].contains(&code) { 3 } else { 2 };
    assert_eq!(run.status.code(), Some(exit), "{text}");
    assert!(text.contains(code), "{code} is not in {text}");
    assert!(text.contains("help:"), "no way out in {text}");
    for word in ["panicked", "RUST_BACKTRACE", "overflow"] {
        assert!(!text.contains(word), "{text}");
    }
    assert!(run.stdout.is_empty(), "something was printed as if it were a result");
    text
}

fn job(from: &str, to: &str) -> Run {
    assert!(JOB.contains(from), "{from} is not in the job");
    Run::new().file("job.imp", JOB.replacen(from, to, 1))
}

#[test]
fn empty_file() {
    Run::new().file("job.imp", "").fails_with("IMP0102");
}

#[test]
fn blanks_only() {
    Run::new().file("job.imp", " \n\t\r\n// x").fails_with("IMP0102");
}

#[test]
fn binary_bytes() {
    let bytes: Vec<u8> = (0..4096_u32).map(|i| u8::try_from(i * 7919 % 256).unwrap()).collect();
    Run::new().file("job.imp", bytes).fails_with("IMP0101");
}

#[test]
fn control_characters() {
    Run::new().file("job.imp", "edition 2026\n\0\0\0\0").fails_with("IMP0101");
}

#[test]
fn a_megabyte_of_open_brackets() {
    for bracket in ["(", "[", "{", "tool t = ball {\n", "x {"] {
        let text = bracket.repeat((1 << 20) / bracket.len());
        let code = if bracket.contains('\n') { "IMP0103" } else { "IMP0105" };
        Run::new().file("job.imp", text).fails_with(code);
    }
}

#[test]
fn a_megabyte_of_closing_brackets() {
    Run::new().file("job.imp", "}".repeat(1 << 20)).fails_with("IMP0104");
}

#[test]
fn a_megabyte_of_quotes_minus_signs_and_garbage() {
    Run::new().file("job.imp", "\"\n".repeat(1 << 19)).fails_with("IMP0106");
    Run::new().file("job.imp", format!("let x = {}1", "-".repeat(1 << 20))).fails_with("IMP0107");
    Run::new().file("job.imp", "garbage\n".repeat(900)).fails_with("IMP0108");
    Run::new().file("job.imp", "garbage\n".repeat(1 << 17)).fails_with("IMP0110");
    Run::new().file("job.imp", format!("let x = 1{}", "+1".repeat(1 << 16))).fails_with("IMP0201");
    Run::new().file("job.imp", format!("let x = 1{}", "+1".repeat(1 << 20))).fails_with("IMP0110");
    Run::new().file("job.imp", format!("part p {{ {} }}", "= ;\n".repeat(1 << 18))).fails_with("IMP0107");
}

/// Signs of comments of other languages, units of others, and names of files without quotes: each is looked at once.
#[test]
fn a_megabyte_of_the_forms_of_other_languages() {
    let signs = [";", "%", "!", "; ", "} ; ", "-- ", " ;\t", "from x.csv ", "from \"x.csv\" "];
    let many = ["a;", "1 mm/", "1 sec ", "F1 "];
    for (forms, code) in [(&signs[..], "IMP010"), (&many, "IMP0110")] {
        for form in forms {
            for start in ["let x = ", "part p {\n x "] {
                let text = format!("{start}{}", form.repeat((1 << 20) / form.len()));
                Run::new().file("job.imp", text).fails_with(code);
            }
        }
    }
}

#[test]
fn too_large_a_file() {
    Run::new().file("job.imp", " ".repeat(17 << 20)).fails_with("IMP0109");
}

#[test]
fn not_a_number() {
    job("15.0578", "NaN").fails_with("IMP0210");
    job("fillet 3 mm", "fillet nan mm").fails_with("IMP0210");
}

#[test]
fn huge_numbers() {
    job("15.0578", "1e999").fails_with("IMP0215");
    job("15.0578", "1e300").fails_with("IMP0304");
    job("15.0578", "1e300 * 1e300").fails_with("IMP0215");
    job("fillet 3 mm", "fillet 1e300 mm").fails_with("IMP0209");
    job("strips auto", "strips 1e18").fails_with("IMP0209");
    job("scallop 12 um", "scallop 1e-300 mm").fails_with("IMP0209");
    job("depth 1.5 mm", "depth 1e-300 mm").fails_with("IMP0209");
}

#[test]
fn zero_vanes() {
    job("vanes 8", "vanes 0").fails_with("IMP0301");
    job("vanes 8", "vanes -8").fails_with("IMP0301");
    job("vanes 8", "vanes 7.5").fails_with("IMP0301");
}

#[test]
fn a_thousand_vanes() {
    job("vanes 8", "vanes 1000").fails_with("IMP0302");
}

#[test]
fn self_crossing_curve() {
    // Points 3 and 5 of the pressure tip change places.
    let text = JOB
        .replacen("( 4.9017, -41.9681,  -8.5921)", "POINT", 1)
        .replacen("(-2.3747, -47.3994, -18.7416)", "( 4.9017, -41.9681,  -8.5921)", 1)
        .replacen("POINT", "(-2.3747, -47.3994, -18.7416)", 1);
    assert_ne!(text, JOB);
    Run::new().file("job.imp", text).fails_with("IMP0305");
}

#[test]
fn coincident_points() {
    job("( 9.7506, -40.4552,  -3.9523)", "(15.0578, -38.5221,   0.0000)").fails_with("IMP0303");
}

#[test]
fn one_point_and_no_point() {
    let start = JOB.find("tip spline [").unwrap();
    let end = start + JOB[start..].find(']').unwrap();
    for points in ["tip spline [ ", "tip spline [ (1, 2, 3) "] {
        let mut text = JOB.to_owned();
        text.replace_range(start..end, points);
        Run::new().file("job.imp", text).fails_with("IMP0303");
    }
}

#[test]
fn missing_library_files() {
    job("\"5mc850-c\"", "\"no-such-machine\"").fails_with("IMP0902");
    job("\"carbide\"", "\"../../etc/passwd\"").fails_with("IMP0902");
}

#[test]
fn faulty_library_files() {
    job("\"5mc850-c\"", "\"mine\"").file("_lib/machines/mine.toml", "kind = [").fails_with("IMP0217");
    job("\"5mc850-c\"", "\"mine\"").file("_lib/machines/mine.toml", [0xff, 0xfe, 0x00]).fails_with("IMP0901");
    job("\"carbide\"", "\"mine\"").file("_lib/tools/mine.toml", "").fails_with("IMP0203");
}

#[test]
fn machine_without_a_rotary_axis() {
    let machine = include_str!("../../jobs/_errors/_lib/machines/three-axes.toml");
    job("\"5mc850-c\"", "\"mill\"").file("_lib/machines/mill.toml", machine).fails_with("IMP0218");
}

#[test]
fn missing_curve_file() {
    let text = include_str!("../../jobs/reduced/reduced.imp");
    Run::new().file("job.imp", text).fails_with("IMP0901");
}

#[test]
fn missing_job() {
    let run = Run::new();
    let output = run.path("part.nc");
    fails(&run.path("nothing.imp"), &output, "IMP0901");
    assert!(!output.exists());
}

#[test]
fn unwritable_output() {
    let run = Run::new().file("job.imp", JOB);
    let job = run.path("job.imp");
    fails(&job, &run.path("no/such/folder/part.nc"), "IMP0903");
    fails(&job, run.folder.path(), "IMP0903");
    fails(&job, Path::new("/proc/part.nc"), "IMP0903");
    assert_eq!(std::fs::read_dir(run.folder.path()).unwrap().count(), 1, "only the job is there");
}

#[test]
fn unknown_post() {
    job("post siemens-840d", "post okuma").fails_with("IMP0902");
}

#[test]
fn a_folder_as_job() {
    let run = Run::new();
    fails(run.folder.path(), &run.path("part.nc"), "IMP0901");
}

#[test]
fn explain_prints_pages_and_refuses_unknown_codes() {
    let explain = |code: &str| Command::new(env!("CARGO_BIN_EXE_impellerc")).args(["explain", code]).output().unwrap();
    let page = explain("imp0206");
    assert_eq!(page.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&page.stdout).contains("Remedy:"));
    assert_eq!(explain("IMP9999").status.code(), Some(2));
}

/// Far more names, items, points and terms than any job has: refused or told in bounded memory.
#[test]
fn texts_that_only_a_program_writes() {
    let lines = |count: usize, line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<Vec<_>>().join("\n");
    let run = |text: String, code: &str| Run::new().file("job.imp", text).fails_with(code);
    run(lines(20_000, &|i| format!("let a{i} = {i}")), "IMP0110");
    run(lines(20_000, &|_| "operation groove { tool t1 }".to_owned()), "IMP0110");
    run(lines(100_000, &|i| format!("tool t{i} = ball {{ diameter 6 mm }}")), "IMP0110");
    run(format!("tool t = ball {{ {} }}", lines(100_000, &|i| format!("d{i} 1 mm"))), "IMP0110");
    run(lines(900, &|_| "operation groove { tool t1 }".to_owned()), "IMP0205");
    run(
        lines(900, &|i| format!("let a{i} = {}", lines(100, &|j| format!("z{i}q{j} +")).replace('\n', " ") + " 1")),
        "IMP0203",
    );
    let points = |count: usize| lines(count, &|i| format!("({}, -38.5, 0)", 15.0 + 1e-4 * i as f64));
    let first = "(15.0578, -38.5221,   0.0000)";
    job(first, &points(2500)).fails_with("IMP0303");
    job(first, &points(500_000)).fails_with("IMP0110");
}

#[test]
fn quantities_that_no_machine_has() {
    for (from, to) in [
        ("feed 250 mm/min", "feed 1e-300 mm/min"),
        ("feed 250 mm/min", "feed 1e-300 mm/tooth"),
        ("speed 8000 rpm", "speed 1e-300 rpm"),
        ("diameter 6 mm", "diameter 10 um"),
        ("fillet 3 mm", "fillet 1e-300 mm"),
        ("strips auto", "strips 100"),
    ] {
        let code = if from.starts_with("speed") { "IMP0213" } else { "IMP0209" };
        job(from, to).fails_with(code);
    }
}

#[test]
fn plans_that_would_run_away() {
    for (from, to) in
        [("scallop 12 um", "scallop 0.1 um"), ("residual 0.4 mm", "residual 1 um"), ("depth 1.5 mm", "depth 10 um")]
    {
        job(from, to).fails_with("IMP0420");
    }
}

#[test]
fn library_files_that_only_a_program_writes() {
    for text in ["a.".repeat(500_000) + "a = 1", format!("a = {}", "[".repeat(500_000))] {
        job("\"carbide\"", "\"mine\"").file("_lib/tools/mine.toml", text).fails_with("IMP0217");
    }
    let tools = |count: usize| -> String {
        let tool = "kind = \"ball\"\ndiameter = \"6 mm\"\nflutes = 2\nflute = \"12 mm\"\nreach = \"30 mm\"";
        (0..count).map(|i| format!("[tool.x{i}]\n{tool}\n")).collect()
    };
    job("\"carbide\"", "\"mine\"").file("_lib/tools/mine.toml", tools(40_000)).fails_with("IMP0203");
    // Refused by its size, before it is read.
    job("\"carbide\"", "\"mine\"").file("_lib/tools/mine.toml", tools(100_000)).fails_with("IMP0901");
    let machine = format!("{}#{}", include_str!("../../jobs/_lib/machines/5mc850-c.toml"), " ".repeat(4 << 20));
    job("\"5mc850-c\"", "\"mine\"").file("_lib/machines/mine.toml", machine).fails_with("IMP0901");
    // Of what may be read, the shortest keys take most memory.
    let keys: String = (0..300_000).map(|i| format!("a.{i:x}.b=0\n")).collect();
    job("\"carbide\"", "\"mine\"").file("_lib/tools/mine.toml", keys).fails_with("IMP0217");
}
