//! LinuxCNC itself on the output of the compiler: its interpreter accepts every program and gives the same poses as our
//! reader, and its kinematics module puts these poses where our machine does.
//!
//! The tools come from the package linuxcnc-uspace. `IMPELLERC_LINUXCNC` names the folder of the unpacked package, `/`
//! where it is installed; when the variable is set, the package must be there. Without the variable and the package the
//! tests report that they were skipped.

use crate::support;
use impellerc::driver::{self, Emit, Options, Outcome, RunOptions, Stages};
use impellerc::five_axis::Machine;
use impellerc::ir::Program;
use impellerc::nc::{self, Direction, NcMove, NcTool};
use impellerc::wheel::control::Sectors;
use nalgebra::{Point3, Rotation3, Vector3};
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
pub(super) struct LinuxCnc {
    root: PathBuf,
    home: TempDir,
}

impl LinuxCnc {
    pub(super) fn find() -> Option<Self> {
        let named = std::env::var_os("IMPELLERC_LINUXCNC");
        let root = named.clone().map_or_else(|| PathBuf::from("/"), PathBuf::from);
        let found = root.join("usr/bin/rs274").is_file();
        assert!(found || named.is_none(), "IMPELLERC_LINUXCNC names {}, but there is no usr/bin/rs274", root.display());
        if !found {
            std::io::stderr().write_all(b"skipped: LinuxCNC (package linuxcnc-uspace) is not installed\n").unwrap();
            return None;
        }
        Some(Self { root, home: tempfile::tempdir().unwrap() })
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

    /// Writes a program, the configuration for its machine, and its tool tables, in mm and in inches.
    fn prepare(&self, machine: &Machine, text: &str, tools: &[u32]) {
        let ini = std::fs::read_to_string(ours().join("interpreter.ini")).unwrap();
        let ini = ini
            .replace("= REMAP\n", &format!("= {}\n", ours().join("remap").display()))
            .replace("= AXES\n", &format!("= {}\n", machine.names().concat()));
        std::fs::write(self.path("interpreter.ini"), ini).unwrap();
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

    /// What the interpreter does with each of many texts: `refused` with a reason, or `events`. `tools` are numbers and
    /// lengths, mm, `part` is G54, mm.
    pub(super) fn edits(&self, machine: &Machine, texts: &[&str], tools: &[(u32, f64)], part: [f64; 3]) -> Vec<Value> {
        self.prepare(machine, "", &[]);
        let line = |(n, length): &(u32, f64)| format!("T{n} P{n} Z{length} D2\n");
        std::fs::write(self.path("mm.tbl"), tools.iter().map(line).collect::<String>()).unwrap();
        let mut child = self
            .command("/usr/bin/python3")
            .arg(ours().join("edits.py"))
            .args(["interpreter.ini", "mm.tbl"])
            .args(part.map(|x| x.to_string()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        let lines: String = texts.iter().map(|t| serde_json::to_string(t).unwrap() + "\n").collect();
        let writer = std::thread::spawn(move || input.write_all(lines.as_bytes()));
        let run = child.wait_with_output().unwrap();
        assert!(run.status.success());
        writer.join().unwrap().unwrap();
        String::from_utf8(run.stdout).unwrap().lines().map(|l| serde_json::from_str(l).unwrap()).collect()
    }

    /// Joints X Y Z (mm) and both tables (degrees), and tool axis in the part frame, of poses in the part frame (tip, mm,
    /// and both words, degrees), by the kinematics module that has the tables of the machine.
    fn joints(&self, machine: &Machine, poses: &[[f64; 5]]) -> Vec<[f64; 8]> {
        let hal = self.path("hal.so");
        let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&hal).arg(ours().join("hal.c")).output();
        let built = built.unwrap();
        assert!(built.status.success(), "{}", said(&built));
        // The rotation point lies on the C axis; from there the table that tilts lies off by the offsets.
        let [tilt, point] = machine.chain.axes().map(|axis| axis.point);
        let (module, across) = match machine.names()[3] {
            "A" => ("xyzac-trt-kins", ("y-offset", tilt.y - point.y)),
            "B" => ("xyzbc-trt-kins", ("x-offset", tilt.x - point.x)),
            other => panic!("no module for {other}"),
        };
        let pins = [
            ("x-rot-point", point.x),
            ("y-rot-point", point.y),
            ("z-rot-point", point.z),
            across,
            ("z-offset", tilt.z - point.z),
            ("tool-offset", TOOL_LENGTH),
        ];
        let mut child = self
            .command("/usr/bin/python3")
            .arg(ours().join("joints.py"))
            .arg(self.root.join(format!("usr/lib/linuxcnc/modules/{module}.so")))
            .arg(&hal)
            .args(pins.map(|(name, value)| format!("{name}={value:?}")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        // In the frame of the machine, as G54 puts them, with the tool length of G43.
        let shift = machine.part_origin + Vector3::z() * TOOL_LENGTH;
        let line = |[x, y, z, tilt, c]: &[f64; 5]| {
            format!("{:?} {:?} {:?} {tilt:?} {c:?}\n", x + shift.x, y + shift.y, z + shift.z)
        };
        let lines: String = poses.iter().map(line).collect();
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
    let library = match machine {
        // Travel of the shipped machines is too short for usual holders.
        "linuxcnc-xyzac-trt" | "linuxcnc-xyzbc-trt" => Some(ours().join("library")),
        "5mc850-bc-linuxcnc" => Some(ours().join("bc")),
        _ => None,
    };
    let run = RunOptions {
        // Nothing here looks at the stock; but coarse cells show more load than the tools of the reduced job take.
        stock_cell: (!job.contains("reduced")).then_some(1.0),
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
    /// X Y Z in mm, both tables in degrees.
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
fn meant(linuxcnc: &LinuxCnc, machine: &Machine) -> Result<Vec<Meant>, String> {
    // Among A, B and C.
    let tilt = "ABC".find(machine.names()[3]).unwrap();
    assert_eq!(machine.names()[4], "C");
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
    let (mut tool, mut length, mut turn) = (0, 0.0, 0.0_f64);
    let mut moves = Vec::new();
    for event in linuxcnc.events()? {
        let number = |i: usize| event[i].as_f64().unwrap();
        match event[1].as_str().unwrap() {
            kind @ ("G0" | "G1") => {
                assert_eq!(number(6 - tilt), 0.0, "the axis that the machine has not: {event}");
                moves.push(Meant {
                    line: usize::try_from(event[0].as_u64().unwrap()).unwrap(),
                    rapid: kind == "G0",
                    to: unturned([2, 3, 4, 5 + tilt, 7].map(number), turn),
                    feed: number(8),
                    transformed: *transformed.get(moves.len()).expect("as many moves as calls"),
                    tool,
                    length,
                });
            }
            "tool" => tool = event[2].as_i64().unwrap(),
            "length" => length = number(2),
            "offset" => assert!(event.as_array().unwrap()[3..].iter().all(|x| *x == 0.0), "{event}"),
            // The interpreter hands on what the words say; the controller turns it.
            "rotation" => turn = number(2),
            "shift" => assert!(event.as_array().unwrap()[2..].iter().all(|x| *x == 0.0), "{event}"),
            other => panic!("{other}: {event}"),
        }
    }
    assert_eq!(moves.len(), transformed.len());
    Ok(moves)
}

/// A place in the part frame from its place in a work frame that is turned about Z, degrees.
fn unturned([x, y, z, tilt, c]: [f64; 5], turn: f64) -> [f64; 5] {
    let (sine, cosine) = turn.to_radians().sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y, z, tilt, c]
}

/// Compares every move under the kinematics with our reader's, and its joints and its tool axis with those of our machine.
/// Gives their number.
fn compare(linuxcnc: &LinuxCnc, machine: &Machine, text: &str) -> Result<usize, String> {
    let sections = nc::find("linuxcnc").unwrap().read(text, machine).map_err(|faults| format!("{faults:?}"))?;
    let read: Vec<NcMove> = sections.into_iter().flat_map(|s| s.moves).collect();
    let all = meant(linuxcnc, machine)?;
    let meant: Vec<&Meant> = all.iter().filter(|m| m.transformed).collect();
    if meant.len() != read.len() {
        return Err(format!("{} moves where our reader finds {}", meant.len(), read.len()));
    }
    for (m, r) in meant.iter().zip(&read) {
        alike(m, r)?;
    }
    let poses: Vec<[f64; 5]> = meant.iter().map(|m| m.to).collect();
    for (joints, r) in linuxcnc.joints(machine, &poses).iter().zip(&read) {
        same_joints(machine, r, joints)?;
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

fn same_joints(machine: &Machine, read: &NcMove, module: &[f64; 8]) -> Result<(), String> {
    let Direction::Rotary(rotary) = read.direction else { return Err("a vector".to_owned()) };
    let joints = machine.joints(&read.tip, rotary);
    let (ours, axis) = (joints.xyz, machine.forward(&joints).axis);
    let [x, y, z, first, second, i, j, k] = *module;
    // The tool keeps its tip where ours has it: the joint of Z holds the length.
    let off = (ours + Vector3::z() * TOOL_LENGTH - Vector3::new(x, y, z)).amax();
    let words = [0, 1].map(|k| (rotary[k] * machine.rotary[k].word_sign).to_degrees());
    let turned = (words[0] - first).abs().max((words[1] - second).abs());
    let leant = (axis - Vector3::new(i, j, k)).amax();
    if off < 1e-8 && turned < 1e-9 && leant < 1e-9 {
        return Ok(());
    }
    Err(format!("line {}: joints and axis {module:?}; ours {ours:?}, {words:?}, {axis:?}", read.line))
}

/// Numbers of the tools of a program.
fn tools(program: &Program) -> Vec<u32> {
    program.tools.iter().map(|(_, t)| t.number).collect()
}

/// Runs all of it on one program.
fn accepted(linuxcnc: &LinuxCnc, program: &Program, text: &str) -> usize {
    linuxcnc.prepare(&program.machine, text, &tools(program));
    compare(linuxcnc, &program.machine, text).unwrap_or_else(|why| panic!("{why}"))
}

/// The machines that ship with LinuxCNC: A tilts, and B tilts.
const SIMULATIONS: [&str; 2] = ["linuxcnc-xyzac-trt", "linuxcnc-xyzbc-trt"];

#[test]
fn small_is_what_the_interpreter_and_the_kinematics_mean() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    for machine in SIMULATIONS {
        let (program, text) = compiled("jobs/small/small.imp", machine);
        assert!(accepted(&linuxcnc, &program, &text) > 2000, "{machine}");
        // What would be noticed: a program that the interpreter refuses, and one that means another pose.
        let prepare = |text: &str| linuxcnc.prepare(&program.machine, text, &tools(&program));
        prepare(&text.replacen("\nM2\n", "\n", 1));
        let refused = meant(&linuxcnc, &program.machine);
        assert!(refused.is_err_and(|why| why.contains("no percent sign or program end")));
        prepare(&text.replacen("\nG1 X", "\nG1 Y0.001 X", 1));
        assert!(meant(&linuxcnc, &program.machine).is_err_and(|why| why.contains("Multiple y words")));
        let other = text.replacen("\nG1 X1", "\nG1 X2", 1);
        assert_ne!(other, text);
        prepare(&other);
        let why = compare(&linuxcnc, &program.machine, &text).unwrap_err();
        assert!(why.contains("our reader"), "{why}");
    }
}

/// A sense or an offset that the machine file has wrong is noticed by the module.
#[test]
fn a_machine_file_with_another_sense_or_offset_is_noticed() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    for name in SIMULATIONS {
        let machine = machine(name);
        let pose = [[12.0, -7.0, 5.0, 31.0, 25.0]];
        let module = linuxcnc.joints(&machine, &pose)[0];
        let judge = |machine: &Machine| {
            let rotary = [0, 1].map(|k| pose[0][3 + k].to_radians() * machine.rotary[k].word_sign);
            same_joints(machine, &at(pose[0], rotary), &module)
        };
        judge(&machine).unwrap();
        for k in 0..2 {
            let mut other = machine.clone();
            other.rotary[k].word_sign = 1.0;
            assert!(judge(&other).is_err(), "{name}: axis {k}");
        }
        for by in [[0.01, 0.01, 0.0], [0.0, 0.0, 0.01]] {
            let moved = Machine { chain: support::shifted(&machine.chain, [by, [0.0; 3]]), ..machine.clone() };
            assert!(judge(&moved).is_err(), "{name}: {by:?}");
        }
    }
}

/// A part that is turned on the table: words count along the axes of the machine, as the kinematics module has it.
#[test]
fn a_turned_part_is_what_the_interpreter_and_the_kinematics_mean() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let mut program = support::program_for("linuxcnc", &support::flank_only(&[0]));
    program.machine.chain = program.machine.chain.with_part(Rotation3::from_euler_angles(0.05, -0.05, 0.7));
    let planned = support::jobs::Compiled::new(program);
    let post = nc::find("linuxcnc").unwrap();
    let text = nc::emit(post, &planned.program, &planned.motion, &[]).text();
    nc::read_back(post, &planned.program, &planned.motion, &text).unwrap();
    let machine = planned.program.machine.in_work_frame();
    linuxcnc.prepare(&machine, &text, &tools(&planned.program));
    assert!(compare(&linuxcnc, &machine, &text).unwrap() > 200);
    // The joints of the module put the tool where the motion has it on the part.
    let poses: Vec<[f64; 5]> =
        meant(&linuxcnc, &machine).unwrap().iter().filter(|m| m.transformed).map(|m| m.to).collect();
    let meant = planned.motion.operations.iter().flat_map(|o| &o.moves[1..o.moves.len() - 1]);
    let mut compared = 0;
    for (module, m) in linuxcnc.joints(&machine, &poses).iter().zip(meant) {
        let off = m.joints.xyz + Vector3::z() * TOOL_LENGTH - Vector3::new(module[0], module[1], module[2]);
        assert!(off.amax() < 1e-3, "{module:?} {m:?}");
        compared += 1;
    }
    assert_eq!(compared, poses.len());
}

/// Subprograms: the interpreter turns X and Y and counts with the values of calls as our reader does.
#[test]
fn sectors_as_subprograms_are_what_the_interpreter_means() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let mut program = support::program_for("linuxcnc", &support::flank_only(&[0, 1, 3, 5]));
    program.post.control.sectors = Sectors::Subprogram;
    let planned = support::jobs::Compiled::new(program);
    let [short, long] = [Sectors::Subprogram, Sectors::Inline].map(|sectors| {
        let mut program = planned.program.clone();
        program.post.control.sectors = sectors;
        nc::emit(nc::find("linuxcnc").unwrap(), &program, &planned.motion, &[]).text()
    });
    assert!(short.contains("R45\n") && short.contains("o101 call") && !long.contains("call"));
    let poses = [&short, &long].map(|text| {
        let moves = accepted(&linuxcnc, &planned.program, text);
        assert!(moves > 500, "{moves}");
        meant(&linuxcnc, &planned.program.machine).unwrap()
    });
    let [short, long] = &poses;
    assert_eq!(short.len(), long.len());
    for (a, b) in short.iter().zip(long) {
        let off = (0..3).map(|k| (a.to[k] - b.to[k]).abs()).fold(0.0, f64::max);
        let turned = (3..5).map(|k| (a.to[k] - b.to[k]).abs()).fold(0.0, f64::max);
        // Rounded words of two sectors, one of them turned.
        assert!(off <= 0.5e-4 * (1.0 + 2f64.sqrt()) + 1e-6 && turned <= 1.001e-5, "{:?} and {:?}", a.to, b.to);
        assert!((a.feed - b.feed).abs() <= 1e-3 * b.feed, "{} and {}", a.feed, b.feed);
    }
}

#[test]
fn reduced_is_what_the_interpreter_means() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let (program, text) = compiled("jobs/reduced/reduced.imp", "5mc850-c-linuxcnc");
    let whole = accepted(&linuxcnc, &program, &text);
    assert!(whole > 500);
    // A control that was just started takes the program from each restart point.
    let mut before = whole;
    for (at, _) in text.match_indices(": a restart point").skip(1) {
        let from = text[..at].rfind('\n').map_or(0, |end| end + 1);
        let rest = accepted(&linuxcnc, &program, &text[from..]);
        assert!(rest > 0 && rest < before, "{rest} of {before} moves");
        before = rest;
    }
    assert!(before < whole);
}

/// The programs of the main job in the folder that `IMPELLERC_PROGRAMS` names, each with the name of its machine.
#[test]
#[ignore = "takes programs that were compiled before"]
fn the_main_job_is_what_the_interpreter_means() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let folder = PathBuf::from(std::env::var_os("IMPELLERC_PROGRAMS").expect("IMPELLERC_PROGRAMS"));
    for machine in ["5mc850-c-linuxcnc", "5mc850-bc-linuxcnc"] {
        let text = std::fs::read_to_string(folder.join(machine).with_extension("ngc")).unwrap();
        let options = options("jobs/wei2021/wei2021.imp", machine);
        let program = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap();
        assert!(accepted(&linuxcnc, &program, &text) > 100_000, "{machine}");
    }
}

pub(super) fn machine(name: &str) -> Machine {
    let options = options("jobs/small/small.imp", name);
    driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap().machine
}

/// A move to a pose; what else it says matters to nobody here.
fn at([x, y, z, ..]: [f64; 5], rotary: [f64; 2]) -> NcMove {
    NcMove {
        line: 0,
        rapid: true,
        tip: Point3::new(x, y, z),
        direction: Direction::Rotary(rotary),
        feed: None,
        time: None,
        tool: NcTool::Number(1),
        speed: 0.0,
        smoothing: Some(0.0),
        turn: None,
        curve: None,
        frame_turned: false,
        interpolation: impellerc::five_axis::Interpolation::RotaryLinear,
    }
}

/// Poses anywhere, not only where impellers have them, for the machines that ship with LinuxCNC, and for ones with other
/// axes and with another zero of the part.
#[test]
fn our_kinematics_are_those_of_the_modules() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let any = (prop::array::uniform3(-150.0..150.0_f64), -180.0..180.0_f64, -720.0..720.0_f64);
    let mut pose = || {
        let ([x, y, z], tilt, c) = any.new_tree(&mut runner).unwrap().current();
        [x, y, z, tilt, c]
    };
    for name in SIMULATIONS {
        let shipped = machine(name);
        let chain = support::shifted(&shipped.chain, [[3.0, -8.0, 21.0], [-7.0, 4.0, 13.0]]);
        let other = Machine { chain, part_origin: Vector3::new(5.0, -11.0, 30.0), ..shipped.clone() };
        for machine in [shipped, other] {
            let poses: Vec<[f64; 5]> = (0..3000).map(|_| pose()).collect();
            for (pose, module) in poses.iter().zip(linuxcnc.joints(&machine, &poses)) {
                let rotary = [0, 1].map(|k| pose[3 + k].to_radians() * machine.rotary[k].word_sign);
                same_joints(&machine, &at(*pose, rotary), &module).unwrap_or_else(|why| panic!("{name}: {why}"));
            }
        }
    }
}
