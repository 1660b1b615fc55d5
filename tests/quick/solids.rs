//! The part as a solid for other programs: closed shells of spline faces, and meshes within a chord error. OpenCASCADE reads the
//! files in `.ci/solid`.

use crate::support::jobs;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Severity;
use impellerc::diagnostics::codes::geometry::NO_SHELL;
use impellerc::driver::{self, Emit, Options, PartOptions, Stages};
use impellerc::report::step::StepProtocol;
use impellerc::tool_stock::stock::stl;
use impellerc::wheel::part::Stock;
use impellerc::wheel::part::shell::{EdgeCurve, Shell, ShellFault, ShellSurface, shell};
use impellerc::wheel::part::solid;
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;
use std::path::PathBuf;

/// Each edge is in two borders, once along and once against it, each border is closed, and the numbers are those of a ring with
/// one hole (Euler and Poincare).
fn assert_closed(shell: &Shell) {
    let mut uses = vec![[0, 0]; shell.edges.len()];
    for face in &shell.faces {
        for border in &face.borders {
            let end = |k: usize, last: bool| {
                let step = border[k % border.len()];
                shell.edges[step.edge].ends[usize::from(step.along == last)]
            };
            for (k, step) in border.iter().enumerate() {
                uses[step.edge][usize::from(step.along)] += 1;
                assert_eq!(end(k, true), end(k + 1, false), "{}", face.id);
            }
        }
    }
    assert!(uses.iter().all(|u| *u == [1, 1]));
    let borders: usize = shell.faces.iter().map(|face| face.borders.len()).sum();
    let [v, e, f] = [shell.vertices.len(), shell.edges.len(), shell.faces.len()].map(|n| n as i64);
    assert_eq!(v - e + f - (borders as i64 - f), 0);
}

/// Volume by the divergence theorem over the surfaces of a shell: splines by three Gauss points in each span, planes and cylinders
/// by their edges.
fn volume(shell: &Shell) -> f64 {
    const GAUSS: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
    let spans =
        |knots: &[f64]| -> Vec<[f64; 2]> { knots.windows(2).filter(|k| k[1] > k[0]).map(|k| [k[0], k[1]]).collect() };
    let mut sum = 0.0;
    for face in &shell.faces {
        let sign = if face.outward { 1.0 } else { -1.0 };
        match &face.surface {
            ShellSurface::Spline(surface) => {
                let [along, across] = surface.knots().each_ref().map(|k| spans(k));
                for [u0, u1] in &along {
                    for [v0, v1] in &across {
                        for (x, a) in GAUSS {
                            for (y, b) in GAUSS {
                                let u = 0.5 * (u0 + u1 + x * (u1 - u0));
                                let v = 0.5 * (v0 + v1 + y * (v1 - v0));
                                let d = surface.derivatives(u, v);
                                let weight = a * b * 0.25 * (u1 - u0) * (v1 - v0) / 3.0;
                                sum += sign * weight * d.point.coords.dot(&d.su.cross(&d.sv));
                            }
                        }
                    }
                }
            }
            // Nose, back face and rim ring are rings between circles: the area by the radii of their vertices.
            ShellSurface::Plane { z } => {
                let radius = |k: usize| {
                    face.borders.get(k).map_or(0.0, |border| {
                        let p = shell.vertices[shell.edges[border[0].edge].ends[0]];
                        p.x.hypot(p.y)
                    })
                };
                sum += sign * z * PI * (radius(0).powi(2) - radius(1).powi(2)) / 3.0;
            }
            // Half of a cylinder.
            ShellSurface::Cylinder { radius } => {
                let heights: Vec<f64> =
                    face.borders[0].iter().map(|s| shell.vertices[shell.edges[s.edge].ends[0]].z).collect();
                let height =
                    heights.iter().fold(f64::MIN, |a, b| a.max(*b)) - heights.iter().fold(f64::MAX, |a, b| a.min(*b));
                // Halves between vertices that do not lie half a turn apart count by their angle.
                let angle: f64 = face.borders[0]
                    .iter()
                    .filter(|s| matches!(shell.edges[s.edge].curve, EdgeCurve::Circle { z, .. } if z <= heights[0].min(heights[1])))
                    .map(|s| {
                        let [a, b] = shell.edges[s.edge].ends.map(|v| shell.vertices[v]);
                        (b.y.atan2(b.x) - a.y.atan2(a.x)).rem_euclid(2.0 * PI)
                    })
                    .sum();
                sum += sign * radius * radius * angle * height / 3.0;
            }
        }
    }
    sum
}

/// The shells of wheels with ruled and with lofted vanes, with fillets and without, are closed and enclose the volume of the
/// design surfaces, which is found without splines.
#[test]
fn shells_are_closed() {
    for name in ["small", "curved"] {
        let program = jobs::program(name, None);
        for part in [program.part.clone(), program.part.with_fillet(None)] {
            let made = shell(&part, &program.stock).unwrap();
            assert_closed(&made);
            let due = solid::volume(&part, &program.stock, 1e-6).unwrap();
            let found = volume(&made);
            println!(
                "{name}: {found:.6} mm3, by triangles {:.6} within {:.1e}; near {:.1e} mm",
                due.value, due.error, made.error
            );
            assert!((found / due.value - 1.0).abs() < 1e-6, "{found} {}", due.value);
            assert!(made.error < if part.main().fillet.is_some() { 1.5e-3 } else { 2e-4 });
        }
    }
}

/// Wheels with rounded edges, with splitters, and with splitters whose flat edges lie inside of the part.
#[test]
fn shells_of_any_row() {
    for (path, faces) in [
        ("jobs/sections/sections.imp", 9 * 13 + 6),
        ("jobs/splitter/splitter.imp", 5 * 26 + 6),
        ("jobs/_errors/IMP0313-splitter.imp", 8 * 15 + 6),
    ] {
        let program = jobs::program_at(path);
        let part = program.part.without_fillets();
        let made = shell(&part, &program.stock).unwrap();
        assert_closed(&made);
        assert_eq!(made.faces.len(), faces, "{path}");
        let due = solid::volume(&part, &program.stock, 1e-6).unwrap();
        let off = volume(&made) / due.value - 1.0;
        println!("{path}: {:.6} mm3 within {:.1e}, shell {off:.1e}", due.value, due.error);
        assert!(off.abs() < 1e-6 && made.error < 2e-4, "{path}: {off}");
        // Between the fillets of flat edges inside of the part there is no room for the patches of the hub.
        if path.contains("_errors") {
            continue;
        }
        let found = solid::mesh_within(&program.part, &program.stock, 0.05).unwrap();
        assert!(found.error <= 0.05 && found.mesh.is_closed(), "{path}");
        // Fillets add to the sharp part; chords cut off less than their error all over its surface.
        assert!(found.mesh.volume() > due.value, "{path}: {}", found.mesh.volume());
    }
}

/// Curves of edges end at their vertices, and lie on the borders of their spline surfaces.
#[test]
fn edges_lie_on_their_faces() {
    let program = jobs::program("small", None);
    let made = shell(&program.part, &program.stock).unwrap();
    for face in &made.faces {
        let ShellSurface::Spline(surface) = &face.surface else { continue };
        for step in &face.borders[0] {
            let EdgeCurve::Spline(curve) = &made.edges[step.edge].curve else { panic!("{}", face.id) };
            let off = |p: Point3<f64>| {
                let sides = [surface.border(false), surface.border(true), surface.side(false), surface.side(true)];
                let gap = move |side: &impellerc::nurbs::NurbsCurve, u: f64| (side.point(u) - p).norm();
                move |u: f64| sides.iter().map(|s| gap(s, u).min(gap(s, 1.0 - u))).fold(f64::MAX, f64::min)
            };
            for k in 0..=20 {
                let u = f64::from(k) / 20.0;
                assert!(off(curve.point(u))(u) < 1e-11, "{} {u}", face.id);
            }
            let ends = made.edges[step.edge].ends.map(|v| made.vertices[v]);
            assert!((curve.point(0.0) - ends[0]).norm() < 1e-9 && (curve.point(1.0) - ends[1]).norm() < 1e-9);
        }
    }
}

/// A back face above the foot of the outlet does not close the part.
#[test]
fn a_blank_that_does_not_close() {
    let program = jobs::program("small", None);
    let stock = Stock { back: Mm(-1.0), ..program.stock.clone() };
    assert_eq!(shell(&program.part, &stock).unwrap_err(), ShellFault::NotClosedByStock);
}

/// Meshes keep their chord error, are closed, and are read back from STL as the same solid.
#[test]
fn meshes_within_a_chord_error() {
    let program = jobs::program("small", None);
    let due = solid::volume(&program.part, &program.stock, 1e-6).unwrap().value;
    let mut before = f64::INFINITY;
    for chord in [0.05, 0.01] {
        let found = solid::mesh_within(&program.part, &program.stock, chord).unwrap();
        let off = (found.mesh.volume() / due - 1.0).abs();
        println!(
            "{chord} mm: {} triangles, error {:.2e} mm, volume {off:.1e}",
            found.mesh.triangles.len(),
            found.error
        );
        assert!(found.error <= chord && found.mesh.is_closed());
        assert!(off < before);
        before = off;
        let read = stl::read(&found.mesh.stl("small")).unwrap();
        assert_eq!(read.triangles.len(), found.mesh.triangles.len());
        assert!((read.volume() / found.mesh.volume() - 1.0).abs() < 1e-6);
        let area: Vector3<f64> = found.mesh.triangles.iter().fold(Vector3::zeros(), |sum, t| {
            let [a, b, c] = t.map(|i| found.mesh.vertices[i as usize]);
            sum + (b - a).cross(&(c - a))
        });
        assert!(area.norm() < 1e-8);
    }
    assert!(before < 1e-3);
}

/// The command writes the same bytes twice, with the protocol that was asked for, and refuses a part whose surfaces do not close.
#[test]
fn files_of_the_part() {
    let folder = tempfile::tempdir().unwrap();
    let emit = |job: &str, form: &str, protocol: StepProtocol, name: &str| {
        let output = folder.path().join(name);
        let part = PartOptions { protocol, ..PartOptions::default() };
        let options = Options {
            job: PathBuf::from(job),
            output: Some(output.clone()),
            emit: Emit::named(form),
            part,
            ..Options::default()
        };
        let outcome = driver::compile(&options, &mut Stages::default());
        (outcome, std::fs::read(output).ok())
    };
    let job = "jobs/small/small.imp";
    let (said, first) = emit(job, "step", StepProtocol::Ap242, "a.step");
    assert!(said.emitted.unwrap().contains("54 faces"));
    assert_eq!(first, emit(job, "step", StepProtocol::Ap242, "b.step").1);
    let automotive = String::from_utf8(emit(job, "step", StepProtocol::Ap214, "c.step").1.unwrap()).unwrap();
    assert!(automotive.contains("FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'))"));
    assert!(String::from_utf8(first.unwrap()).unwrap().contains("AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF"));
    assert!(emit(job, "3mf", StepProtocol::Ap242, "d.3mf").1.unwrap().starts_with(b"PK"));
    let (said, none) = emit("jobs/_errors/IMP0313-splitter.imp", "stl", StepProtocol::Ap242, "e.stl");
    assert!(none.is_none());
    let codes: Vec<_> = said.sink.diags().iter().filter(|d| d.severity == Severity::Error).map(|d| d.code).collect();
    assert_eq!(codes, [NO_SHELL]);
}
