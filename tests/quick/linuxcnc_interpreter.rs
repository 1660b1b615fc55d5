//! LinuxCNC itself on the output of the compiler: its interpreter accepts every program and gives the same poses as our
//! reader, and its kinematics module puts these poses where our machine does.
//!
//! The tools come from the package linuxcnc-uspace. `IMPELLERC_LINUXCNC` names the folder of the unpacked package, `/`
//! where it is installed; when the variable is set, the package must be there. Without the variable and the package the
//! tests report that they were skipped.

use impellerc::driver::{self, Emit, Options, Outcome, RunOptions, Stages};
use impellerc::ir::Program;
use impellerc::kin::Machine;
use impellerc::post::{self, Direction, NcMove};
use nalgebra::Point3;
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const MM_PER_INCH: f64 = 25.4;

/// Length of every tool, mm: the same for all, so that a wrong one is only found by its number.
const TOOL_LENGTH: f64 = 40.0;

/// The tools of LinuxCNC, and a folder of its own for each run: the interpreter keeps its tool table in HOME.
struct LinuxCnc {
    root: PathBuf,
    home: TempDir,
}

impl LinuxCnc {
    fn find() -> Option<Self> {
        let named = std::env::var_os("IMPELLERC_LINUXCNC");
        let root = named.clone().map_or_else(|| PathBuf::from("/"), PathBuf::from);
        let found = root.join("usr/bin/rs274").is_file();
        assert!(found || named.is_none(), "IMPELLERC_LINUXCNC names {}, but there is no usr/bin/rs274", root.display());
        if !found {
            std::io::stderr().write_all(b"skipped: LinuxCNC (package linuxcnc-uspace) is not installed\n").unwrap();
            return None;
        }
        let home = tempfile::tempdir().unwrap();
        let ours = ours();
        let ini = std::fs::read_to_string(ours.join("interpreter.ini")).unwrap();
        let remap = ours.join("remap");
        std::fs::write(
            home.path().join("interpreter.ini"),
            ini.replace("= REMAP\n", &format!("= {}\n", remap.display())),
        )
        .unwrap();
        Some(Self { root, home })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.home.path().join(name)
    }

    /// A program of the package, or of Debian, with the libraries of the package.
    fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command
            .current_dir(self.home.path())
            .env("HOME", self.home.path())
            .env("LD_LIBRARY_PATH", self.root.join("usr/lib"))
            .env("PYTHONPATH", self.root.join("usr/lib/python3/dist-packages"))
            .stdin(Stdio::null());
        command
    }

    /// Writes a program and its tool tables, in mm and in inches.
    fn prepare(&self, text: &str, tools: &[u32]) {
        std::fs::write(self.path("program.ngc"), text).unwrap();
        for (name, unit) in [("mm.tbl", 1.0), ("inch.tbl", MM_PER_INCH)] {
            let line = |n: &u32| format!("T{n} P{n} Z{} D{}\n", TOOL_LENGTH / unit, 2.0 / unit);
            std::fs::write(self.path(name), tools.iter().map(line).collect::<String>()).unwrap();
        }
    }

    /// `rs274` over the program: its canonical calls, or what it complains of.
    fn calls(&self) -> Result<String, String> {
        let run = self
            .command(self.root.join("usr/bin/rs274"))
            // Never /dev/null for the parameters: it would be replaced. The table of this program is in inches.
            .args(["-g", "-i", "interpreter.ini", "-t", "inch.tbl", "-v", "rs274.var", "program.ngc", "calls"])
            .output()
            .unwrap();
        if !run.status.success() {
            return Err(said(&run));
        }
        Ok(std::fs::read_to_string(self.path("calls")).unwrap())
    }

    /// The module `gcode` over the program: what it calls back, with source lines and full doubles.
    fn events(&self) -> Result<Vec<Value>, String> {
        let run = self
            .command("/usr/bin/python3")
            .arg(ours().join("poses.py"))
            .args(["program.ngc", "interpreter.ini", "mm.tbl"])
            .output()
            .unwrap();
        if !run.status.success() {
            return Err(said(&run));
        }
        let text = String::from_utf8(run.stdout).unwrap();
        Ok(text.lines().map(|l| serde_json::from_str(l).unwrap()).collect())
    }

    /// Joints X Y Z (mm) A C (degrees) of poses, by the kinematics module with the pins of the machine.
    fn joints(&self, machine: &Machine, poses: &[[f64; 5]]) -> Vec<[f64; 5]> {
        let hal = self.path("hal.so");
        let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&hal).arg(ours().join("hal.c")).output();
        let built = built.unwrap();
        assert!(built.status.success(), "{}", said(&built));
        // The zero of the part is the rotation point; from there the A axis lies off by the offsets.
        let [tilt, point] = machine.chain.axes().map(|axis| axis.point);
        assert_eq!(machine.part_origin, point.coords);
        let pins = [
            ("x-rot-point", point.x),
            ("y-rot-point", point.y),
            ("z-rot-point", point.z),
            ("y-offset", tilt.y - point.y),
            ("z-offset", tilt.z - point.z),
            ("tool-offset", TOOL_LENGTH),
        ];
        let mut child = self
            .command("/usr/bin/python3")
            .arg(ours().join("joints.py"))
            .arg(self.root.join("usr/lib/linuxcnc/modules/xyzac-trt-kins.so"))
            .arg(&hal)
            .args(pins.map(|(name, value)| format!("{name}={value:?}")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        let lines: String = poses.iter().map(|[x, y, z, a, c]| format!("{x:?} {y:?} {z:?} {a:?} {c:?}\n")).collect();
        let writer = std::thread::spawn(move || input.write_all(lines.as_bytes()));
        let run = child.wait_with_output().unwrap();
        assert!(run.status.success(), "{}", said(&run));
        writer.join().unwrap().unwrap();
        let numbers = |l: &str| -> Vec<f64> { l.split(' ').map(|n| n.parse().unwrap()).collect() };
        let text = String::from_utf8(run.stdout).unwrap();
        text.lines().map(|l| numbers(l).try_into().unwrap()).collect()
    }
}

fn ours() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/linuxcnc")
}

fn said(run: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&run.stderr), String::from_utf8_lossy(&run.stdout))
}

fn options(job: &str, machine: &str) -> Options {
    // Travel of the shipped machine is too short for usual holders.
    let library = (machine == "linuxcnc-xyzac-trt").then(|| ours().join("library"));
    let run = RunOptions {
        post: Some("linuxcnc".to_owned()),
        machine: Some(machine.to_owned()),
        library,
        ..RunOptions::default()
    };
    Options { job: PathBuf::from(job), emit: Some(Emit::Nc), run, ..Options::default() }
}

/// The text of a job and its program.
fn compiled(job: &str, machine: &str) -> (Program, String) {
    let options = options(job, machine);
    let mut outcome = Outcome::default();
    let program = driver::front(&options, &mut Stages::default(), &mut outcome).unwrap().unwrap();
    let outcome = driver::compile(&options, &mut Stages::default());
    let text = outcome.emitted.unwrap_or_else(|| panic!("{:?}", outcome.sink.diags()));
    (program, text)
}

/// A move as the controller's interpreter means it.
struct Meant {
    line: usize,
    rapid: bool,
    /// X Y Z in mm, A and C in degrees.
    to: [f64; 5],
    /// mm/min.
    feed: f64,
    /// Whether the kinematics are on.
    transformed: bool,
    tool: i64,
    /// Length that acts, mm.
    length: f64,
}

/// The moves of the program that was prepared, from both faces of the interpreter: the module knows lines and digits,
/// `rs274` what the remapped words do.
fn meant(linuxcnc: &LinuxCnc) -> Result<Vec<Meant>, String> {
    let calls = linuxcnc.calls()?;
    // Kinematics at each move.
    let mut on = false;
    let mut transformed = Vec::new();
    for call in calls.lines() {
        if call.contains("SET_AUX_OUTPUT_VALUE(3,") {
            on = call.contains("(3,1.000000)");
        }
        if call.contains(" STRAIGHT_FEED(") || call.contains(" STRAIGHT_TRAVERSE(") {
            transformed.push(on);
        }
        assert!(!call.contains("ARC_FEED") && !call.contains("NURBS"), "{call}");
    }
    assert!(!on && calls.contains("PROGRAM_END"), "the program ends with the kinematics on");
    let (mut tool, mut length) = (0, 0.0);
    let mut moves = Vec::new();
    for event in linuxcnc.events()? {
        let number = |i: usize| event[i].as_f64().unwrap();
        match event[1].as_str().unwrap() {
            kind @ ("G0" | "G1") => moves.push(Meant {
                line: usize::try_from(event[0].as_u64().unwrap()).unwrap(),
                rapid: kind == "G0",
                to: [2, 3, 4, 5, 7].map(number),
                feed: number(8),
                transformed: *transformed.get(moves.len()).expect("as many moves as calls"),
                tool,
                length,
            }),
            "tool" => tool = event[2].as_i64().unwrap(),
            "length" => length = number(2),
            "offset" => assert!(event.as_array().unwrap()[3..].iter().all(|x| *x == 0.0), "{event}"),
            "shift" | "rotation" => assert!(event.as_array().unwrap()[2..].iter().all(|x| *x == 0.0), "{event}"),
            other => panic!("{other}: {event}"),
        }
    }
    assert_eq!(moves.len(), transformed.len());
    Ok(moves)
}

/// Compares every move under the kinematics with our reader's, and its joints with our machine's where the module has the
/// machine. Gives their number.
fn compare(linuxcnc: &LinuxCnc, machine: &Machine, text: &str, kinematics: bool) -> Result<usize, String> {
    let sections = post::find("linuxcnc").unwrap().read(text, machine).map_err(|faults| format!("{faults:?}"))?;
    let read: Vec<NcMove> = sections.into_iter().flat_map(|s| s.moves).collect();
    let all = meant(linuxcnc)?;
    let meant: Vec<&Meant> = all.iter().filter(|m| m.transformed).collect();
    if meant.len() != read.len() {
        return Err(format!("{} moves where our reader finds {}", meant.len(), read.len()));
    }
    for (m, r) in meant.iter().zip(&read) {
        alike(m, r)?;
    }
    if kinematics {
        let poses: Vec<[f64; 5]> =
            meant.iter().map(|m| [m.to[0], m.to[1], m.to[2] + TOOL_LENGTH, m.to[3], m.to[4]]).collect();
        for (joints, r) in linuxcnc.joints(machine, &poses).iter().zip(&read) {
            same_joints(machine, r, joints)?;
        }
    }
    Ok(read.len())
}

fn alike(meant: &Meant, read: &NcMove) -> Result<(), String> {
    let tip = (read.tip - Point3::new(meant.to[0], meant.to[1], meant.to[2])).norm();
    let same = meant.line == read.line
        // A way at rapid may be written at a feed that the joints keep.
        && (!meant.rapid || read.rapid)
        && tip < 1e-9
        && meant.tool.to_string() == read.tool.to_string()
        && (meant.length - TOOL_LENGTH).abs() < 1e-9
        && read.feed.is_none_or(|f| (f - meant.feed).abs() < 1e-6);
    if same {
        return Ok(());
    }
    Err(format!("line {}: {:?} at {} mm/min, T{}; our reader: {read:?}", meant.line, meant.to, meant.feed, meant.tool))
}

fn same_joints(machine: &Machine, read: &NcMove, joints: &[f64; 5]) -> Result<(), String> {
    let Direction::Rotary([a, c]) = read.direction else { return Err("a vector".to_owned()) };
    let ours = machine.joints(&read.tip, [a, c]).xyz;
    // The tool keeps its tip where ours has it: the joint of Z holds the length.
    let off = (ours.x - joints[0]).abs().max((ours.y - joints[1]).abs()).max((ours.z + TOOL_LENGTH - joints[2]).abs());
    let words = [a * machine.rotary[0].word_sign, c * machine.rotary[1].word_sign].map(f64::to_degrees);
    let turned = (words[0] - joints[3]).abs().max((words[1] - joints[4]).abs());
    if off < 1e-8 && turned < 1e-9 {
        return Ok(());
    }
    Err(format!("line {}: joints {joints:?}; ours {ours:?}, A {}, C {}", read.line, words[0], words[1]))
}

/// Runs all of it on one program.
fn accepted(linuxcnc: &LinuxCnc, program: &Program, text: &str, kinematics: bool) -> usize {
    let tools: Vec<u32> = program.tools.iter().map(|(_, t)| t.number).collect();
    linuxcnc.prepare(text, &tools);
    compare(linuxcnc, &program.machine, text, kinematics).unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn small_is_what_the_interpreter_and_the_kinematics_mean() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let (program, text) = compiled("jobs/small/small.imp", "linuxcnc-xyzac-trt");
    assert!(accepted(&linuxcnc, &program, &text, true) > 2000);
    // What would be noticed: a program that the interpreter refuses, and one that means another pose.
    let tools: Vec<u32> = program.tools.iter().map(|(_, t)| t.number).collect();
    linuxcnc.prepare(&text.replacen("\nM2\n", "\n", 1), &tools);
    assert!(meant(&linuxcnc).is_err_and(|why| why.contains("no percent sign or program end")));
    let moved = text.replacen("\nG1 X", "\nG1 Y0.001 X", 1);
    linuxcnc.prepare(&moved, &tools);
    assert!(meant(&linuxcnc).is_err_and(|why| why.contains("Multiple y words")));
    let other = text.replacen("\nG1 X1", "\nG1 X2", 1);
    assert_ne!(other, text);
    linuxcnc.prepare(&other, &tools);
    let why = compare(&linuxcnc, &program.machine, &text, false).unwrap_err();
    assert!(why.contains("our reader"), "{why}");
}

#[test]
fn reduced_is_what_the_interpreter_means() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let (program, text) = compiled("jobs/reduced/reduced.imp", "5mc850-c-linuxcnc");
    assert!(accepted(&linuxcnc, &program, &text, false) > 500);
}

/// The program that `IMPELLERC_PROGRAM` names, of the main job for the machine 5mc850-c-linuxcnc.
#[test]
#[ignore = "takes a program that was compiled before"]
fn the_main_job_is_what_the_interpreter_means() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let text = std::fs::read_to_string(std::env::var_os("IMPELLERC_PROGRAM").expect("IMPELLERC_PROGRAM")).unwrap();
    let options = options("jobs/wei2021/wei2021.imp", "5mc850-c-linuxcnc");
    let program = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap();
    assert!(accepted(&linuxcnc, &program, &text, false) > 100_000);
}

/// Poses anywhere, not only where impellers have them, for the machine that ships with LinuxCNC.
#[test]
fn our_kinematics_are_those_of_the_module() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let options = options("jobs/small/small.imp", "linuxcnc-xyzac-trt");
    let machine = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap().machine;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let any = (prop::array::uniform3(-150.0..150.0_f64), -180.0..180.0_f64, -720.0..720.0_f64);
    let words: Vec<([f64; 3], f64, f64)> = (0..5000).map(|_| any.new_tree(&mut runner).unwrap().current()).collect();
    let poses: Vec<[f64; 5]> = words.iter().map(|([x, y, z], a, c)| [*x, *y, z + TOOL_LENGTH, *a, *c]).collect();
    for ((tip, a, c), joints) in words.iter().zip(linuxcnc.joints(&machine, &poses)) {
        let [a, c] = [a.to_radians() * machine.rotary[0].word_sign, c.to_radians() * machine.rotary[1].word_sign];
        let ours = machine.joints(&Point3::from(*tip), [a, c]);
        let off = [ours.xyz.x - joints[0], ours.xyz.y - joints[1], ours.xyz.z + TOOL_LENGTH - joints[2]];
        assert!(off.iter().all(|d| d.abs() < 1e-9), "{tip:?} {a} {c}: {off:?}");
        let back = machine.forward(&ours);
        assert!((back.tip - Point3::from(*tip)).norm() < 1e-9);
    }
}
