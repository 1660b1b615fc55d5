//! Wheels that are exported as STEP files and read back into their jobs.

use super::jobs;
use impellerc::base::source::{SourceFile, SourceMap};
use impellerc::blade_files::faced_part;
use impellerc::blade_files::job_frame::Zero;
use impellerc::blade_files::outlines::outlines;
use impellerc::blade_files::part_source::PartSource;
use impellerc::blade_files::part_text::PartFiles;
use impellerc::blade_files::{self, Imported, Options};
use impellerc::driver::{self, Options as RunOptions, Outcome, Stages};
use impellerc::ir::Program;
use impellerc::nurbs::Revolution;
use impellerc::nurbs::proximity::Patch;
use impellerc::report::step::{StepFile, StepProtocol};
use impellerc::wheel::part::shell::shell;
use impellerc::wheel::part::{Part, Surface, solid};
use nalgebra::Vector2;

/// The STEP file of a part.
pub fn step_file(part: &Part, program: &Program) -> String {
    let made = shell(part, &program.stock).unwrap();
    StepFile { name: "wheel", description: &[], shell: &made, protocol: StepProtocol::Ap242 }.text()
}

/// What a STEP file holds.
pub fn imported(file: &str, options: &Options) -> Imported {
    let mut fetch = |name: &str, _: usize| Ok(SourceFile::text(name, file));
    blade_files::read(&["a.step".to_owned()], &mut fetch, options, &mut SourceMap::default())
        .unwrap_or_else(|diags| panic!("{diags:?}"))
}

/// The files of the job of an imported wheel.
pub fn part_files(imported: &Imported) -> PartFiles {
    let row = &imported.rows[0];
    let divided = outlines(row, imported.hub.as_deref(), &Options::default()).unwrap();
    let read = ["a.step".to_owned()];
    faced_part::write(&PartSource::new(imported, row, &divided, &read, "again", Zero::File))
}

/// The program of an imported wheel in the place of the part of a job.
pub fn compiled(imported: &Imported, job: &str) -> Program {
    let made = part_files(imported);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (_, part) = made.job.split_once("edition 2026\n").unwrap();
    let (head, rest) = job.split_once("\npart ").unwrap();
    let (_, rest) = rest.split_once("\n}\n").unwrap();
    std::fs::write(at("again.imp"), format!("{head}\n{part}{rest}")).unwrap();
    std::fs::write(at("again.curves.csv"), &made.curves).unwrap();
    for (blade, text) in &made.loops {
        std::fs::write(at(&format!("again.{blade}.csv")), text).unwrap();
    }
    let mut outcome = Outcome::default();
    let mut options = RunOptions { job: at("again.imp"), ..RunOptions::default() };
    options.run.library = Some("jobs/_lib".into());
    let run = driver::front(&options, &mut Stages::default(), &mut outcome);
    run.ok().flatten().unwrap_or_else(|| panic!("{:?}", outcome.sink))
}

/// The same file as another program may write it: without names, faces and edges in the other sense, borders that begin elsewhere.
pub fn foreign(file: &str) -> String {
    let line = |line: &str| {
        let turned = |line: &str| match line.rsplit_once(",.T.);") {
            Some((head, _)) => format!("{head},.F.);"),
            None => line.replace(",.F.);", ",.T.);"),
        };
        let Some((number, entity)) = line.split_once('=') else { return line.to_owned() };
        if let Some(rest) = entity.strip_prefix("ADVANCED_FACE('") {
            let (_, rest) = rest.split_once('\'').unwrap();
            return turned(&format!("{number}=ADVANCED_FACE(''{rest}"));
        }
        if let Some(rest) = entity.strip_prefix("EDGE_LOOP('',(") {
            let edges: Vec<&str> = rest.trim_end_matches("));").split(',').collect();
            let (last, first) = edges.split_last().unwrap();
            let moved: Vec<&str> = std::iter::once(last).chain(first).copied().collect();
            return format!("{number}=EDGE_LOOP('',({}));", moved.join(","));
        }
        if let Some(rest) = entity.strip_prefix("EDGE_CURVE('',") {
            let [from, to, curve, _] = rest.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
            return format!("{number}=EDGE_CURVE('',{to},{from},{curve},.F.);");
        }
        if entity.starts_with("ORIENTED_EDGE(") { turned(line) } else { line.to_owned() }
    };
    file.lines().map(|text| line(text) + "\n").collect()
}

/// The number of the first face with a name, as `--face` takes it.
pub fn number(file: &str, name: &str) -> String {
    let of = |line: &&str| line.contains(&format!("ADVANCED_FACE('{name}'"));
    let line = file.lines().find(of).unwrap_or_else(|| panic!("no face {name}"));
    line.split('=').next().unwrap().to_owned()
}

/// What differs between a part and the one that was read back.
#[derive(Clone, Copy, Debug)]
pub struct Differences {
    /// Largest distance of places of the faces and edges of blades of the given part from the blades that were read back, and of these
    /// from the given ones, mm.
    pub blades: [f64; 2],
    /// The same of hub and shroud between the inlet and the outlet of the main blades.
    pub turned: f64,
    /// Volumes without fillets, mm3.
    pub volumes: [f64; 2],
}

/// Compares a part with the one that was read back.
pub fn differences(given: &Program, again: &Program) -> Differences {
    let meridians = [(&given.part.hub, &again.part.hub), (&given.part.shroud, &again.part.shroud)];
    let turned = meridians.into_iter().zip([0.0, 1.0]);
    let turned = turned.map(|((a, b), v)| off(&given.part, v, a, b).max(off(&again.part, v, b, a)));
    let sharp = [given, again].map(|program| program.part.without_fillets());
    let volumes = sharp.map(|part| solid::volume(&part, &given.stock, 1e-6).unwrap().value);
    Differences {
        blades: [apart(&given.part, &again.part), apart(&again.part, &given.part)],
        turned: turned.fold(0.0, f64::max),
        volumes,
    }
}

/// Largest distance of places of the blades of a part from those of another one.
fn apart(from: &Part, to: &Part) -> f64 {
    let mut most = 0.0_f64;
    for (blade, other) in from.blade_ids().zip(to.blade_ids()) {
        for side in from.sides(blade) {
            let surface = &from.face(side).surface;
            for i in 0..=16 {
                for j in 0..=8 {
                    // Both parts trim the faces at hub and shroud; their ends are not at the same parameters.
                    let p = surface.point(0.03 + 0.94 * f64::from(i) / 16.0, 0.03 + 0.94 * f64::from(j) / 8.0);
                    let all = to.sides(other).map(|side| &to.face(side).surface);
                    // Faces that end at a fillet go on below.
                    let patch = Patch { u: [-0.02, 1.02], v: [-0.5, 1.05] };
                    most = most.max(all.map(|s| s.closest(&p, patch).distance).fold(f64::INFINITY, f64::min));
                }
            }
        }
    }
    most
}

/// Largest distance of places of a meridian from another one, between the ends of the pressure face at a height (0 root, 1 tip).
fn off(part: &Part, height: f64, from: &Revolution, to: &Revolution) -> f64 {
    let face = &part.main().faces[0].surface;
    let [first, last] = [0.0, 1.0].map(|u| {
        let end = face.point(u, height);
        let end = Vector2::new(end.x.hypot(end.y), end.z);
        let far = |k: &u32| (from.meridian(f64::from(*k) / 1000.0).point - end).norm();
        f64::from((0..=1000).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()) / 1000.0
    });
    let places = (0..=50).map(|k| first + (last - first) * f64::from(k) / 50.0);
    places.map(|place| to.closest(from.meridian(place).point).1.abs()).fold(0.0, f64::max)
}

/// A job is exported, with fillets or without, and read back: the program, what was read, and the program of that.
pub fn round_trip(name: &str, fillets: bool) -> (Program, Imported, Program) {
    let job = std::fs::read_to_string(format!("jobs/{name}/{name}.imp")).unwrap();
    let program = jobs::program(name, None);
    let part = if fillets { program.part.clone() } else { program.part.without_fillets() };
    let read = imported(&step_file(&part, &program), &Options::default());
    let mut with_fillets = read.clone();
    for (given, blade) in program.part.blades.iter().zip(&mut with_fillets.rows[0].blades) {
        // What the file does not have is added, as the user of the job does.
        blade.fillet = blade.fillet.or_else(|| Some(given.fillet.as_ref()?.constant()?.get()));
    }
    let again = compiled(&with_fillets, &job);
    (program, read, again)
}

/// Asserts that a part that was read back is that of the job: its number of vanes, faces, edges, hub and shroud within 1 um, and its
/// volume.
#[track_caller]
pub fn assert_same_part(name: &str, program: &Program, again: &Program) {
    assert_eq!(again.part.vane_count, program.part.vane_count);
    let off = differences(program, again);
    println!("{name}: {off:?}");
    assert!(off.blades.iter().all(|far| *far < 1e-3) && off.turned < 1e-3, "{name}: {off:?}");
    assert!((off.volumes[0] / off.volumes[1] - 1.0).abs() < 5e-6, "{name}: {off:?}");
}
