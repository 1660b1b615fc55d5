//! A blade from closed sections: its surfaces against its points, and the closed surface of its part.

use crate::parts::enclosed;
use crate::support::bounded;
use impellerc::base::units::length;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::ir::Program;
use impellerc::nurbs::proximity::Patch;
use impellerc::report::proof::surfaces;
use impellerc::verify::stated_points;
use impellerc::wheel::part::chart::{self, Shape};
use impellerc::wheel::part::{BladeId, Surface, SurfaceKind, sample};
use nalgebra::Point3;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// A vane of our own: five sections with an elliptic leading edge and a trailing edge that is cut off at the outlet.
static FREE: LazyLock<Program> = LazyLock::new(|| {
    let options = Options { job: PathBuf::from("jobs/sections/sections.imp"), ..Options::default() };
    driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap()
});

fn points() -> Vec<Point3<f64>> {
    let text = std::fs::read_to_string("jobs/sections/sections.csv").unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let fields: Vec<f64> = line.split(',').skip(2).map(|f| f.parse().unwrap()).collect();
            Point3::new(fields[0], fields[1], fields[2])
        })
        .collect()
}

/// Every point of the file lies within the reported distance of a face or of the leading edge.
#[test]
fn surfaces_go_through_the_points() {
    let part = &FREE.part;
    let whole = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };
    let sides: Vec<_> = part.sides(BladeId::MAIN).collect();
    assert_eq!(sides.len(), 3, "two faces and the leading edge");
    let off = |p: &Point3<f64>| {
        sides.iter().map(|id| part.face(*id).surface.closest(p, whole).distance).fold(f64::INFINITY, f64::min)
    };
    let worst = points().iter().map(off).fold(0.0, f64::max);
    assert!(worst < 0.0034, "{worst}");
    assert!(worst > 1e-5, "the fit is no interpolation");
    // The certificate has this distance, or a little less at the trailing edge, which lies between the ends of the faces.
    let found = stated_points::check(&FREE);
    let [report] = &found[..] else { panic!("{found:?}") };
    assert_eq!((report.name.as_str(), report.points), ("main", points().len()));
    assert!(
        (off(&report.point) - report.distance.get()).abs() < 1e-6 && report.distance.get() <= worst + 1e-9,
        "{report:?} {worst}"
    );
    assert!(report.distance.get() > 1e-5, "{report:?}");
}

/// A part that was imported says so, with the figure of the import apart from the measured one, and their sum.
#[test]
fn an_imported_part_states_its_files_and_their_distance() {
    let job = std::fs::read_to_string("jobs/sections/sections.imp").unwrap();
    let folder = tempfile::tempdir().unwrap();
    for table in ["sections.csv", "flow.csv"] {
        std::fs::copy(Path::new("jobs/sections").join(table), folder.path().join(table)).unwrap();
    }
    let front = |line: &str| {
        let at = job.find("\n  vanes ").unwrap();
        let path = folder.path().join("sections.imp");
        std::fs::write(&path, format!("{}\n  {line}{}", &job[..at], &job[at..])).unwrap();
        let mut options = Options { job: path, ..Options::default() };
        options.run.library = Some(PathBuf::from("jobs/_lib"));
        let mut outcome = Outcome::default();
        let program = driver::front(&options, &mut Stages::default(), &mut outcome).ok().flatten();
        (program, format!("{:?}", outcome.sink))
    };
    assert!(FREE.imported.is_none() && stated_points::imported(&FREE).is_none());
    let program = front("imported \"wheel.step\", within 11.4 um").0.unwrap();
    let imported = stated_points::imported(&program).unwrap();
    assert!(imported.files == "wheel.step" && (imported.within.get() - 0.0114).abs() < 1e-15, "{imported:?}");
    let form = stated_points::check(&program);
    assert_eq!(form, stated_points::check(&FREE), "the line changes no surface");
    let told = surfaces::imported(&imported, &form);
    let within = imported.within.get();
    let [stated, sum] = [within, within + form[0].distance.get()].map(length);
    let stated = format!("at most {stated}, stated by the import and not verified");
    for words in ["wheel.step".to_owned(), stated, format!("measured; together at most {sum}")] {
        assert!(told.contains(&words), "{words} is not in {told}");
    }
    // A blade of angles has no points that could be measured.
    assert!(
        surfaces::imported(&imported, &[]).ends_with("nothing is measured: it states no points"),
        "{}",
        surfaces::imported(&imported, &[])
    );
    for wrong in [
        "imported wheel",
        "imported \"wheel.step\"",
        "imported \"wheel.step\" within 11.4 um",
        "imported \"wheel.step\", within 3 deg",
        "imported \"wheel.step\", within -1 um",
        "imported \"wheel.step\", about 3 um",
    ] {
        let (program, sink) = front(wrong);
        assert!(program.is_none() && sink.contains("imported"), "{wrong}: {sink}");
    }
}

/// A point that the job states off the surfaces shows in the certificate with its distance: off a face, and off the middle of the
/// edge that is cut off.
#[test]
fn a_stated_point_off_the_surfaces_is_found() {
    let face = FREE.part.face(BladeId::MAIN.faces()[0]);
    let on = |u: f64, v: f64| BladeId::MAIN.faces().map(|id| FREE.part.face(id).surface.point(u, v));
    let between = |u: f64, v: f64| nalgebra::center(&on(u, v)[0], &on(u, v)[1]);
    // Normal of the surface between the ends of the faces, away from the blade.
    let middle = between(1.0, 0.5);
    let normal = (on(1.0, 0.5)[1] - on(1.0, 0.5)[0]).cross(&(between(1.0, 0.6) - between(1.0, 0.4))).normalize();
    let outward = normal * normal.dot(&(middle - between(0.8, 0.5))).signum();
    for (off, tolerance) in [(0.05, 1e-6), (0.5, 1e-3)] {
        for (point, tolerance) in [
            (face.surface.point(0.4, 0.5) + face.normal(0.4, 0.5) * off, tolerance),
            (middle + outward * off, 0.1 * off),
        ] {
            let mut program = FREE.clone();
            program.stated[0].points.push(point);
            let found = &stated_points::check(&program)[0];
            assert!((found.distance.get() - off).abs() < tolerance && found.point == point, "{off}: {found:?}");
        }
    }
}

/// Where a face and the leading edge meet they have one point and one normal, from hub to shroud.
#[test]
fn the_nose_has_no_corner() {
    let part = &FREE.part;
    let edge = part.face(part.edge(BladeId::MAIN, 0).unwrap());
    assert!(part.edge(BladeId::MAIN, 1).is_none());
    for i in 0..=20 {
        let v = f64::from(i) / 20.0;
        for (face, u) in BladeId::MAIN.faces().into_iter().zip([0.0, 1.0]) {
            let face = part.face(face);
            assert!((face.surface.point(0.0, v) - edge.surface.point(u, v)).norm() < 1e-9);
            assert!(face.normal(0.0, v).dot(&edge.normal(u, v)) > 1.0 - 1e-9);
        }
    }
}

/// The fillet goes round the nose: it touches the edge and the hub, and its ends are those of the fillets of the faces.
#[test]
fn the_fillet_goes_round_the_nose() {
    let part = &FREE.part;
    let edge = part.edge(BladeId::MAIN, 0).unwrap();
    let charts = chart::charts(part);
    let fillet = |id| charts.iter().find(|c| c.kind == SurfaceKind::Fillet(id)).unwrap();
    let nose = fillet(edge);
    let whole = Patch { u: [0.0, 1.0], v: [-0.2, 1.2] };
    for i in 0..=40 {
        let x = f64::from(i) / 40.0;
        let above = nose.place(x, 0.0).position;
        assert!(part.face(edge).surface.closest(&above, whole).distance < 1e-6);
        assert!(part.hub.distance(&nose.place(x, 1.0).position).abs() < 1e-6);
    }
    for (face, end) in BladeId::MAIN.faces().into_iter().zip([0.0, 1.0]) {
        for j in 0..=10 {
            let y = f64::from(j) / 10.0;
            let gap = (nose.place(end, y).position - fillet(face).place(0.0, y).position).norm();
            assert!(gap < 1e-6, "{gap}");
        }
    }
}

/// The charts of faces, edges, fillets, hub and tips, with what the lathe makes, close the part: what is open is the size of
/// the cells at the cut ends of fillets, as for the wheel of jobs/small, which has 4.4 mm2. The leading edges have 45 mm2, their
/// fillets 17.
#[test]
fn the_part_is_closed() {
    let [open, _] = enclosed(&FREE);
    assert!(open.abs() < 7.0, "{open} mm2");
}

/// Samples lie on the surfaces: the samples of the leading edge and its fillet are among them.
#[test]
fn the_edge_is_sampled() {
    let samples = sample(&FREE.part, 0.5);
    let edge = FREE.part.edge(BladeId::MAIN, 0).unwrap();
    for kind in
        [SurfaceKind::InletEdge(BladeId::MAIN), SurfaceKind::Fillet(edge), SurfaceKind::OutletEdge(BladeId::MAIN)]
    {
        assert!(samples.iter().filter(|s| s.surface.kind == kind && s.surface.sector == 0).count() > 10, "{kind:?}");
    }
}

/// The job of [`FREE`] whose points have words for edges, printed with all defaults.
fn with_edges(word: impl Fn(usize, usize) -> &'static str) -> (bool, String) {
    let folder = tempfile::tempdir().unwrap();
    for file in ["sections.imp", "flow.csv"] {
        std::fs::copy(Path::new("jobs/sections").join(file), folder.path().join(file)).unwrap();
    }
    let text = std::fs::read_to_string("jobs/sections/sections.csv").unwrap();
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    let name = |line: &str| line.split(',').next().unwrap().to_owned();
    let numbered = |line: &&str| {
        let count = lines.iter().filter(|other| name(other) == name(line)).count();
        let number: usize = line.split(',').nth(1).unwrap().parse().unwrap();
        format!("{line}{}\n", word(number, count))
    };
    std::fs::write(folder.path().join("sections.csv"), lines.iter().map(numbered).collect::<String>()).unwrap();
    let library = Path::new("jobs/_lib").canonicalize().unwrap();
    let mut command = bounded::program();
    command.current_dir(folder.path()).args(["sections.imp", "--emit", "job", "--library"]).arg(library);
    let run = command.output().unwrap();
    (run.status.success(), String::from_utf8(if run.status.success() { run.stdout } else { run.stderr }).unwrap())
}

/// A file of sections may tell the points of the edges; edges that are no edges are refused with their line.
#[test]
fn a_file_may_state_the_edges() {
    let (good, job) = with_edges(|number, count| match number {
        1..=3 => ",leading-edge",
        k if k == count => ",leading-edge",
        k if (count / 2..count / 2 + 2).contains(&k) => ",trailing-edge",
        _ => "",
    });
    assert!(good && job.contains("trailing-edge points ") && job.contains(": leading-edge points "), "{job}");
    let refused = [
        (with_edges(|number, _| if number < 4 { ",leading-edge" } else { "" }), "`trailing-edge` of"),
        (with_edges(|number, _| if number % 9 < 3 { ",leading-edge" } else { ",trailing-edge" }), "`leading-edge` of"),
        (with_edges(|number, _| if number < 4 { ",nose" } else { "" }), "the sixth value is `leading-edge`"),
        (with_edges(|_, _| ",leading-edge,1"), "have another form"),
    ];
    for ((good, said), due) in refused {
        assert!(!good && said.contains("IMP0220") && said.contains(due), "{said}");
    }
}
