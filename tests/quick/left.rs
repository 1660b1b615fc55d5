//! Jobs that start from what is left of the blank.

use crate::support::{jobs, pinned};
use impellerc::base::progress::Progress;
use impellerc::diagnostics::{Severity, Sink, codes};
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::{Motion, Program};
use impellerc::tool_stock::stock::{Field, Mesh, stl};
use impellerc::verify;
use impellerc::verify::left::Left;
use impellerc::verify::stock::{Settings, StockReport, simulate};
use nalgebra::Point3;
use std::path::Path;
use std::sync::{Arc, LazyLock};

/// Cells of these tests, mm.
const CELL: f64 = 0.5;

/// The stock after each operation of a motion, and its report.
fn simulated(program: &Program, motion: &Motion) -> (StockReport, Vec<Field>) {
    let mut fields = Vec::new();
    let mut keep = |_: usize, field: &Field| fields.push(field.clone());
    let mut settings = Settings { cell: Some(CELL), after: Some(&mut keep), ..Settings::default() };
    let report = simulate(program, motion, &mut settings, &Progress::default(), &mut Sink::default()).expect("a stock");
    (report, fields)
}

/// What the reduced job leaves after each operation.
static WHOLE: LazyLock<(StockReport, Vec<Field>)> = LazyLock::new(|| {
    let (program, motion) = pinned::reduced("siemens-840d").planned();
    simulated(program, motion)
});

/// The program that starts from a mesh, as the reader gives it.
fn started(program: &Program, mesh: &Mesh) -> Program {
    let mut program = program.clone();
    program.stock.left = Some(Arc::new(stl::read(&mesh.stl("left")).expect("a closed mesh")));
    program
}

/// Later operations find in the mesh after the first what they find in the simulated stock itself.
#[test]
fn operations_from_the_mesh_of_the_one_before() {
    let compiled = pinned::reduced("siemens-840d");
    let (program, motion) = compiled.planned();
    let (whole, fields) = &*WHOLE;
    let mesh = fields[0].mesh();
    let program = started(program, &mesh);
    let start = program.stock.field(CELL).unwrap();
    // The mesh rounds the edges of the stock within a cell, nothing else: a share of its volume that falls with the cell.
    let lost = whole.operations[0].rest.get() - start.volume();
    assert!(lost > 0.0 && lost < 0.02 * start.volume(), "{lost} of {}", start.volume());
    let later = Motion { operations: motion.operations[1..].to_vec() };
    let (report, after) = simulated(&program, &later);
    assert!((report.blank.get() - start.volume()).abs() < 1e-9);
    assert!(report.missing.is_none() && report.collisions().count() == whole.collisions().count());
    for (found, due) in report.operations.iter().zip(&whole.operations[1..]) {
        println!("{}: removed {:.1} instead of {:.1}", found.name, found.removed.get(), due.removed.get());
        assert!(
            (found.removed.get() - due.removed.get()).abs() < 0.03 * due.removed.get() + 10.0,
            "{}: {} {}",
            found.name,
            found.removed.get(),
            due.removed.get()
        );
    }
    // Ray by ray: what both have left differs at edges only, by no more than a cell.
    let (mut near, mut far) = (0.0, 0.0_f64);
    let (one, other) = (fields.last().unwrap(), after.last().unwrap());
    for axis in 0..3 {
        for i in 0..one.cells()[(axis + 1) % 3] {
            for j in 0..one.cells()[(axis + 2) % 3] {
                let (a, b) = (one.intervals(axis, i, j), other.intervals(axis, i, j));
                if a.len() != b.len() {
                    continue;
                }
                for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
                    near += f64::from(u8::from((x - y).abs() < 0.25 * CELL));
                    far += f64::from(u8::from((x - y).abs() >= 0.25 * CELL));
                }
            }
        }
    }
    println!("ends of rays: {near} within a quarter of a cell, {far} not");
    assert!(far < 0.05 * near, "{far} of {near}");
}

/// All operations again, from what they have left: almost nothing is cut.
#[test]
fn nothing_is_cut_twice() {
    let compiled = pinned::reduced("siemens-840d");
    let (program, motion) = compiled.planned();
    let (whole, fields) = &*WHOLE;
    let again = started(program, &fields.last().unwrap().mesh());
    let removed = |report: &StockReport| report.operations.iter().map(|o| o.removed.get()).sum::<f64>();
    let (report, _) = simulated(&again, motion);
    println!("removed again {:.1} of {:.1}", removed(&report), removed(whole));
    assert!(removed(&report) < 0.02 * removed(whole), "{} of {}", removed(&report), removed(whole));
}

#[test]
fn the_mesh_of_the_blank_stays_near_it() {
    let program = jobs::program("rough", None);
    for cell in [1.0, 0.7, 0.5] {
        let blank = program.stock.field(cell).unwrap();
        let again = started(&program, &blank.mesh());
        let out = again.stock.farthest_out(1e-3).map_or(0.0, |(_, out)| out);
        println!("cells of {cell} mm: {out:.3} mm out");
        assert!(out < 0.5 * cell, "{out} with cells of {cell}");
        assert!(again.stock.farthest_out(0.5).is_none());
        let volume = again.stock.field(cell).unwrap().volume();
        assert!(
            volume <= blank.volume() && volume > (1.0 - 0.06 * cell) * blank.volume(),
            "{volume} {}",
            blank.volume()
        );
    }
}

/// Distances to the turned blank and places out of it, against samples of its outline.
#[test]
fn what_stands_out_of_the_blank_is_found() {
    let program = jobs::program("rough", None);
    let stock = &program.stock;
    let profile = &stock.profile;
    let outline: Vec<[f64; 2]> = (0..profile.len())
        .flat_map(|i| {
            let (a, b) = (profile[i], profile[(i + 1) % profile.len()]);
            (0..400).map(move |k| [0, 1].map(|n: usize| a[n] + (b[n] - a[n]) * f64::from(k) / 400.0))
        })
        .collect();
    for k in 0..500_u32 {
        let (r, z, t) = (f64::from(k % 29), f64::from(k % 37) - 26.0, f64::from(k) * 0.7);
        let near = outline.iter().map(|p| (p[0] - r).hypot(p[1] - z)).fold(f64::INFINITY, f64::min);
        let found = stock.distance(&Point3::new(r * t.cos(), r * t.sin(), z));
        assert!((found.abs() - near).abs() < 0.05, "{r} {z}: {found} {near}");
    }
    // All corners on the blank, between them a face in front of the shroud.
    let [inlet, outlet] = [3, profile.len() - 3].map(|i| Point3::new(profile[i][0], 0.0, profile[i][1]));
    let hollow = Mesh {
        vertices: vec![inlet, outlet, Point3::new(4.0, 1.0, -14.0), Point3::new(4.0, -1.0, -14.0)],
        triangles: vec![[0, 1, 2], [1, 0, 3], [0, 2, 3], [2, 1, 3]],
    };
    assert!(hollow.vertices.iter().all(|p| stock.distance(p) < 0.5), "a corner is out of the blank");
    let mut started = program.stock.clone();
    started.left = Some(Arc::new(hollow));
    let (at, out) = started.farthest_out(0.5).expect("a face stands out");
    assert!(out > 0.5 && (stock.distance(&at) - out).abs() < 1e-9, "{out} at {at}");
}

#[test]
fn depth_in_a_box() {
    let corner = |n: usize| Point3::from([0, 1, 2].map(|k: usize| if n >> k & 1 == 0 { -3.0 } else { 5.0 }));
    let quads: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let mesh = Mesh { vertices: (0..8).map(corner).collect(), triangles };
    let left = Left::new(&mesh);
    for k in 0..1000_u32 {
        let p = Point3::from([0, 1, 2].map(|n| f64::from(k * (13 + 7 * n) % 101) / 10.0 - 4.0));
        let beyond = p.map(|x| (-3.0 - x).max(x - 5.0));
        let due =
            if beyond.coords.max() <= 0.0 { -beyond.coords.max() } else { -beyond.coords.map(|x| x.max(0.0)).norm() };
        let found = left.depth(&p);
        assert!((found.abs() - due.abs()).abs() < 0.125, "{p}: {found} instead of {due}");
        assert!(due.abs() < 0.2 || found.signum() == due.signum(), "{p}: {found} instead of {due}");
    }
}

/// A prism over a kite with an edge of 21 deg. Points of the grid lie over vertices and edges, and beside the sharp
/// edge, where the nearest sample may face away from a point outside.
#[test]
fn the_side_of_a_point_is_that_of_half_spaces() {
    let outline = [[0.0, 0.0], [11.0, -2.0], [12.0, 0.0], [11.0, 2.0]];
    let at = |[x, y]: [f64; 2], z: f64| Point3::new(x, y, z);
    let vertices = outline.map(|p| at(p, -1.0)).into_iter().chain(outline.map(|p| at(p, 3.0))).collect();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for i in 0..4_u32 {
        let j = (i + 1) % 4;
        triangles.extend([[i, j, j + 4], [i, j + 4, i + 4]]);
    }
    let mesh = Mesh { vertices, triangles };
    assert!(mesh.is_closed() && mesh.volume() > 0.0);
    let left = Left::new(&mesh);
    let mut counts = [0; 2];
    for (i, j, k) in (-8..60).flat_map(|i| (-16..=16).flat_map(move |j| (-8..=16).map(move |k| (i, j, k)))) {
        let p = Point3::new(0.25 * f64::from(i), 0.25 * f64::from(j), 0.25 * f64::from(k));
        let sides = (0..4).map(|i| {
            let ([ax, ay], [bx, by]) = (outline[i], outline[(i + 1) % 4]);
            ((bx - ax) * (p.y - ay) - (by - ay) * (p.x - ax)) / libm::hypot(bx - ax, by - ay)
        });
        let deep = sides.fold((p.z + 1.0).min(3.0 - p.z), f64::min);
        if deep.abs() > 1e-9 {
            assert_eq!(left.depth(&p) > 0.0, deep > 0.0, "{p} {deep}");
            counts[usize::from(deep > 0.0)] += 1;
        }
    }
    assert!(counts[0] > 10_000 && counts[1] > 2000, "{counts:?}");
}

/// What is missing of the part before the first operation is told; a hole is an error, rounded edges are none.
#[test]
fn a_stock_without_the_part_is_refused() {
    let compiled = pinned::flank();
    let (program, motion) = compiled.planned();
    let blank = program.stock.field(1.0).unwrap().mesh();
    let told = |mesh: &Mesh| {
        let mut sink = Sink::default();
        let mut settings = Settings { cell: Some(1.0), ..Settings::default() };
        let progress = Progress::default();
        verify::certify_with(&started(program, mesh), motion, &mut settings, &progress, &mut sink)
            .expect("a certificate");
        sink.diags().iter().find(|d| d.code == codes::verification::LEFT_LACKS).map(|d| d.severity)
    };
    assert!(told(&blank).is_none_or(|severity| severity == Severity::Remark));
    let mut thin = blank.clone();
    thin.vertices.iter_mut().for_each(|p| p.z = p.z.min(-5.0));
    assert_eq!(told(&thin), Some(Severity::Error), "the nose is missing");
}

/// What the stages before planning say of a job, with `--stock FOLDER`.
fn told(job: &Path, stock: Option<&Path>) -> Outcome {
    let mut options = Options { job: job.to_path_buf(), ..Options::default() };
    options.run.stock = stock.map(Path::to_path_buf);
    let mut outcome = Outcome::default();
    match stock {
        // The outputs are refused before planning.
        Some(_) => driver::compile(&options, &mut Stages::default()),
        None => {
            let _ = driver::front(&options, &mut Stages::default(), &mut outcome);
            outcome
        }
    }
}

/// The file is an input of the run: it has a hash, and no output may replace it. With it the first operation may find a
/// rest.
#[test]
fn the_file_is_an_input_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::copy("jobs/small/vane_curves.csv", path("vane_curves.csv")).unwrap();
    let text = std::fs::read_to_string("jobs/small/rough.imp").unwrap();
    let text = text
        .replace("back -16 mm }", "back -16 mm  from \"01-rough.stl\" }")
        .replace("tools t1, t2 ", "tools t2  rest over 0.2 mm ");
    std::fs::write(path("rough.imp"), text.replace("tool t1", "tool t0")).unwrap();
    let missing = told(&path("rough.imp"), None);
    assert!(missing.sink.diags().iter().any(|d| d.code == codes::files::CANNOT_READ));
    let mesh = jobs::program("rough", None).stock.field(1.0).unwrap().mesh();
    std::fs::write(path("01-rough.stl"), mesh.stl("left")).unwrap();
    let good = told(&path("rough.imp"), None);
    assert!(!good.sink.has_errors(), "{:?}", good.sink.diags());
    let file = good.sources.files().iter().find(|f| f.name == "01-rough.stl").expect("an input");
    assert_eq!(file.bytes(), mesh.stl("left"));
    assert!(file.disk.as_ref().is_some_and(|d| d.ends_with("01-rough.stl")));
    let meets = told(&path("rough.imp"), Some(folder.path()));
    assert!(meets.sink.diags().iter().any(|d| d.code == codes::files::MEETS), "{:?}", meets.sink.diags());
    assert_eq!(std::fs::read(path("01-rough.stl")).unwrap(), mesh.stl("left"));
    let text = std::fs::read_to_string(path("rough.imp")).unwrap();
    std::fs::create_dir(path("below")).unwrap();
    std::fs::copy(path("vane_curves.csv"), path("below/vane_curves.csv")).unwrap();
    std::fs::write(path("below/rough.imp"), text.replace("01-rough.stl", "../01-rough.stl")).unwrap();
    let outside = told(&path("below/rough.imp"), None);
    assert!(outside.sink.diags().iter().any(|d| d.code == codes::files::OUTSIDE));
}
