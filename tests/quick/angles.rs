//! Blades by angles and thicknesses: the made surfaces against what the job states.

use crate::parts::enclosed;
use impellerc::base::source::SourceMap;
use impellerc::diagnostics::{Severity, Sink, render};
use impellerc::ir::Program;
use impellerc::job::{self, InMemory};
use impellerc::lower;
use impellerc::nurbs::proximity::Patch;
use impellerc::plan::passes::flank::strip;
use impellerc::syntax;
use impellerc::tool_stock::collide::Cutter;
use impellerc::wheel::part::{BladeId, Face, FaceId, Part, Surface};
use nalgebra::{Point3, Rotation3, Vector3};
use std::sync::LazyLock;

const JOB: &str = include_str!("../support/wheel_by_angles.imp");

/// The program of a text, or what was reported.
fn read(text: &str) -> Result<Program, String> {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("job.imp", text);
    let ast = syntax::parse(text, source, &mut sink);
    let job = job::resolve(&ast, &mut InMemory::default(), &mut sources, &mut sink);
    let program = job.and_then(|job| lower::lower(&job, &mut sink));
    let errors = sink.diags().iter().any(|d| d.severity == Severity::Error);
    program.ok().filter(|_| !errors).ok_or_else(|| render::human(&sink, &sources, false))
}

/// The job with changes, each of which must occur.
fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(JOB.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in\n{text}");
        text.replace(from, to)
    })
}

fn made(text: &str) -> Part {
    read(text).unwrap_or_else(|fault| panic!("{fault}")).part
}

static WHEEL: LazyLock<Part> = LazyLock::new(|| made(JOB));

const WHOLE: Patch = Patch { u: [0.0, 1.0], v: [0.0, 1.0] };

/// Twice the distance within which surfaces keep the stated form, mm: two surfaces of the same form differ by no more.
const FIT: f64 = 0.004;

fn off(face: &Face, p: &Point3<f64>) -> f64 {
    face.surface.closest(p, WHOLE).distance
}

fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=10).flat_map(|i| (0..=4).map(move |j| (f64::from(i) / 10.0, f64::from(j) / 4.0)))
}

fn faces(part: &Part, blade: usize) -> [&Face; 2] {
    BladeId::new(blade).faces().map(|id| part.face(id))
}

/// A splitter with the thickness of the main blade lies on the faces of the main blade, turned by its share of the pitch; and
/// only there.
#[test]
fn a_splitter_lies_on_the_turned_main_blade() {
    let same = [
        ("[(0 %, root) (50 %, 1.3 * root) (100 %, root)]", "root"),
        ("[(0 %, tip)  (50 %, 1.2 * tip)  (100 %, tip)]", "tip"),
    ];
    let half = made(&changed(&same));
    let third = made(&changed(&[&same[..], &[("angle 46 %", "angle 24 deg")]].concat()));
    for (part, angle) in [(&half, 0.46_f64 * 72.0), (&third, 24.0)] {
        let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -angle.to_radians());
        let mains = faces(part, 0);
        let mut worst = 0.0_f64;
        for (main, splitter) in mains.into_iter().zip(faces(part, 1)) {
            for (u, v) in grid() {
                worst = worst.max(off(main, &(back * splitter.surface.point(u, v))));
            }
        }
        println!("{angle} deg: {worst:.5} mm");
        assert!(worst < FIT, "{worst}");
        let elsewhere = off(mains[0], &faces(part, 1)[0].surface.point(0.5, 0.5));
        assert!(elsewhere > 3.0, "{elsewhere}");
    }
}

/// Splitters that are cut off begin where the cut of the main blade is: at shares of the lengths of hub and shroud from the leading
/// edge of the main blade on.
#[test]
fn the_splitter_begins_at_its_cut() {
    let text = changed(&[("elliptic 2", "cut-off"), ("from hub 45 %, shroud 36 %", "from hub 40 %, shroud 55 %")]);
    let part = made(&text);
    for (surface, from, share, v) in [(&part.hub, 3.0, 0.4, 0.0), (&part.shroud, 2.0, 0.55, 1.0)] {
        // Lengths along the meridian by chords.
        let at = |k: u32| surface.meridian(f64::from(k) / 20_000.0).point;
        let mut lengths = vec![0.0];
        for k in 0..20_000 {
            lengths.push(lengths[k as usize] + (at(k + 1) - at(k)).norm());
        }
        let due = from + share * (lengths[20_000] - from);
        let due = at(u32::try_from(lengths.partition_point(|l| *l < due)).unwrap());
        for face in faces(&part, 1) {
            let p = face.surface.point(0.0, v);
            let found = nalgebra::Vector2::new(libm::hypot(p.x, p.y), p.z);
            assert!((found - due).norm() < 0.005, "{found:?} {due:?}");
        }
    }
}

/// Points of the sections of a blade, given as closed loops, make the same blade.
#[test]
fn loops_of_its_points_make_the_same_blade() {
    let part = &*WHEEL;
    let mut loops = Vec::new();
    for k in 0..=8 {
        let v = f64::from(k) / 8.0;
        let [p, s] = faces(part, 0);
        let edge = part.face(part.edge(BladeId::MAIN, 0).unwrap());
        let at = |face: &Face, i: u32, n: u32| face.surface.point(f64::from(i) / f64::from(n), v);
        let mut points: Vec<Point3<f64>> = (0..120).map(|i| at(p, 120 - i, 120)).collect();
        points.extend((0..60).map(|i| at(edge, i, 60)));
        points.extend((0..=120).map(|i| at(s, i, 120)));
        let text: Vec<String> = points.iter().map(|p| format!("({:.7}, {:.7}, {:.7})", p.x, p.y, p.z)).collect();
        loops.push(format!("loop [{}] mm", text.join(" ")));
    }
    let [from, to] = ["  vane main {", "  splitter half {"].map(|word| JOB.find(word).unwrap());
    let end = to + JOB[to..].find("\n  }\n").unwrap() + 5;
    let vane = format!("  vane main {{\n    sections {}\n    fillet 1.5 mm\n  }}\n", loops.join(",\n"));
    let again = made(&format!("{}{vane}{}", &JOB[..from], &JOB[end..]));
    let mut worst = 0.0_f64;
    let edge = again.face(again.edge(BladeId::MAIN, 0).unwrap());
    for (one, other) in faces(part, 0).into_iter().zip(faces(&again, 0)) {
        for (u, v) in grid() {
            let p = one.surface.point(u, v);
            // Edges end where the curvature of the points says so: the end of one face may be the edge of the other.
            worst = worst.max(off(other, &p).min(off(edge, &p)));
        }
    }
    println!("{worst:.5} mm");
    assert!(worst < 0.003, "{worst}");
}

/// Distances across the passages at the hub and at the shroud, along the outlet half of the main blade: the balls of the job fit.
#[test]
fn the_passages_are_wide_enough_for_the_tools() {
    let part = &*WHEEL;
    let turned = |face: FaceId, angle: f64, u: f64, v: f64| {
        Rotation3::from_axis_angle(&Vector3::z_axis(), angle) * part.face(face).surface.point(u, v)
    };
    for passage in part.passages() {
        let [first, second] = passage.walls;
        let turn = part.pitch() * f64::from(passage.sectors);
        for v in [0.05, 0.5, 0.95] {
            let width = (0..=40)
                .flat_map(|i| (0..=40).map(move |j| (f64::from(i) / 40.0, f64::from(j) / 40.0)))
                .map(|(a, b)| (turned(first, 0.0, a, v) - turned(second, turn, b, v)).norm())
                .fold(f64::INFINITY, f64::min);
            println!("{first:?} to {second:?} at {v}: {width:.3} mm");
            assert!(width > 5.0, "{width}");
        }
    }
}

/// The charts of faces, edges, fillets, hub and tips, with what the lathe makes, close the wheel: what is open is the size of the
/// cells at the cut ends of fillets.
#[test]
fn the_wheel_is_closed() {
    let [open, volume] = enclosed(&read(JOB).unwrap());
    println!("open {open:.3} mm2, volume {volume:.1} mm3");
    assert!(open.abs() < 7.0, "{open} mm2");
}

/// No cylinder fits the faces: the best motion of one as wide as the smaller ball of the job, in three strips, still leaves more than
/// the job allows.
#[test]
fn no_cylinder_fits_the_faces() {
    let around = strip::Surroundings::new(&WHEEL);
    for face in BladeId::MAIN.faces() {
        let found = strip::least_error(&around, face, 3, Cutter::ball(1.5), 1).expect("an error");
        println!("{}: {:.4} mm", face.name(), found.error);
        assert!(found.error > 0.02, "{}", found.error);
    }
}

/// The main blade with another entry for the angles at the hub.
fn with_hub_angles(angles: &str, beta_from: &str) -> Part {
    made(&changed(&[
        ("beta [(0 %, 32 deg) (40 %, 38 deg) (100 %, exit)]  start 0 deg", angles),
        ("beta [(0 %, 58 deg) (40 %, 52 deg) (100 %, exit)]  start 0 deg", "theta [(0 %, 0 deg) (100 %, 50 deg)]"),
        ("beta-from meridian", &format!("pressure clockwise  {beta_from}")),
        ("let exit  = 36 deg   // angle at the outlet, to the meridian\n", ""),
    ]))
}

/// Largest distance of the faces of one main blade to those of another.
fn apart(one: &Part, other: &Part) -> f64 {
    let pairs = faces(one, 0).into_iter().zip(faces(other, 0));
    pairs.flat_map(|(a, b)| grid().map(move |(u, v)| off(b, &a.surface.point(u, v)))).fold(0.0, f64::max)
}

/// Angles to the tangent are 90 deg less those to the meridian, and theta may be stated at either end.
#[test]
fn one_camber_line_in_several_words() {
    let meridian = with_hub_angles("beta [(0 %, 32 deg) (100 %, 40 deg)]  start 5 deg", "beta-from meridian");
    let tangent = with_hub_angles("beta [(0 %, 58 deg) (100 %, 50 deg)]  start 5 deg", "beta-from tangent");
    assert!(apart(&meridian, &tangent) < 1e-9);
    // Theta at the trailing edge, from a fine sum of tan(beta) / r along the hub.
    let hub = &meridian.hub;
    let at = |k: u32| hub.meridian(f64::from(k) / 40_000.0).point;
    let steps: Vec<[f64; 2]> =
        (0..40_000).map(|k| [(at(k + 1) - at(k)).norm(), 0.5 * (at(k).x + at(k + 1).x)]).collect();
    let whole = steps.iter().map(|s| s[0]).sum::<f64>() - 3.0;
    let (mut gone, mut theta) = (-3.0, 5.0_f64.to_radians());
    for [step, r] in steps {
        gone += step;
        if gone > 0.0 {
            let beta = (32.0 + 8.0 * (gone - 0.5 * step) / whole).to_radians();
            theta += beta.tan() * step / r;
        }
    }
    let end = format!("beta [(0 %, 32 deg) (100 %, 40 deg)]  end {:.7} deg", theta.to_degrees());
    let ended = with_hub_angles(&end, "beta-from meridian");
    println!("{end}: {:.5} mm", apart(&meridian, &ended));
    assert!(apart(&meridian, &ended) < FIT);
    // The trailing edge at the hub has this theta in its middle, on a turned cylinder by second order.
    let [p, s] = faces(&meridian, 0).map(|face| face.surface.point(1.0, 0.0));
    let middle = 0.5 * (p.y.atan2(p.x) + s.y.atan2(s.x));
    assert!((middle - theta).abs() < 2e-3, "{middle} {theta}");
}

/// A lean that is the same at all spans turns the whole wheel; meridional edges given as straight curves are those given as places.
#[test]
fn lean_turns_and_straight_curves_are_places() {
    let turned = made(&changed(&[("[(0 %, 0 deg) (50 %, bow) (100 %, 0 deg)]", "bow")]));
    let straight = made(&changed(&[
        ("    lean [(0 %, 0 deg) (50 %, bow) (100 %, 0 deg)]\n", ""),
        ("let bow   = 4 deg    // turn of the middle of the blade\n", ""),
    ]));
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 4.0_f64.to_radians());
    let mut worst = 0.0_f64;
    for (a, b) in faces(&straight, 0).into_iter().zip(faces(&turned, 0)) {
        for (u, v) in grid() {
            worst = worst.max(off(b, &(turn * a.surface.point(u, v))));
        }
    }
    assert!(worst < FIT, "{worst}");
    let at = |surface: &impellerc::nurbs::Revolution, length: f64| {
        let (mut u, mut gone) = (0.0, 0.0);
        while gone < length {
            gone += (surface.meridian(u + 1e-5).point - surface.meridian(u).point).norm();
            u += 1e-5;
        }
        surface.meridian(u).point
    };
    let [hub, shroud] = [at(&WHEEL.hub, 3.0), at(&WHEEL.shroud, 2.0)];
    let spline = format!("from spline [({:.5}, 0, {:.5}) (0, {:.5}, {:.5})] mm", hub.x, hub.y, shroud.x, shroud.y);
    let curved = made(&changed(&[("from hub 3 mm, shroud 2 mm", &spline)]));
    assert!(apart(&WHEEL, &curved) < FIT, "{}", apart(&WHEEL, &curved));
}

#[test]
fn a_wheel_varies_by_let_and_spans_may_be_names() {
    let named = changed(&[("span 100 % {", "span 50 % + middle {"), ("let bow ", "let middle = 50 %\nlet bow ")]);
    assert!(apart(&made(&named), &WHEEL) < 1e-9);
    let thick = made(&changed(&[("let root  = 1.6 mm", "let root  = 2 mm")]));
    assert!((apart(&thick, &WHEEL) - 0.26).abs() < 0.03, "{}", apart(&thick, &WHEEL));
}

/// Each fault is told with its code; none makes a part.
#[test]
fn faults_of_blades_by_angles() {
    for (from, to, code, words) in [
        ("beta-from meridian", "", "IMP0205", "from where beta is measured"),
        ("start 0 deg  thickness [(0 %, root)", "thickness [(0 %, root)", "IMP0210", "beta needs theta at one end"),
        (
            "start 0 deg  thickness [(0 %, root)",
            "start 0 deg  end 3 deg  thickness [(0 %, root)",
            "IMP0210",
            "one of them",
        ),
        ("beta [(0 %, 32 deg)", "theta 3 deg  beta [(0 %, 32 deg)", "IMP0210", "both theta and beta"),
        ("(40 %, 38 deg)", "(40 %, 38 mm)", "IMP0207", "angle"),
        ("(40 %, 38 deg)", "(40 %, 38)", "IMP0206", "needs a unit"),
        ("(40 %, 38 deg)", "(40 mm, 38 deg)", "IMP0207", "plain number"),
        ("(40 %, 38 deg)", "(40 %, 38 deg, 1)", "IMP0210", "a share and a value"),
        ("(40 %, 38 deg)", "(140 %, 38 deg)", "IMP0321", "0 % to 100 %"),
        ("[(0 %, 32 deg) (40 %, 38 deg) (100 %, exit)]", "[(0 %, 32 deg)]", "IMP0321", "2 to 200 values"),
        ("[(0 %, 32 deg) (40 %, 38 deg) (100 %, exit)]", "[(5 %, 32 deg) (100 %, exit)]", "IMP0321", "0 % is expected"),
        ("[(0 %, 32 deg) (40 %, 38 deg) (100 %, exit)]", "\"a\"", "IMP0210", "a value or a list"),
        ("fillet 1.5 mm", "fillet [(0 %, 1 mm) (90 %, 2 mm)]", "IMP0321", "100 % is expected"),
        ("fillet 1.5 mm", "fillet [(0 %, 1 mm) (100 %, 2 deg)]", "IMP0207", "length"),
        ("fillet 1.5 mm", "fillet [(0 %, 0 mm) (100 %, 2 mm)]", "IMP0209", "from 0.01 mm to 1000 mm everywhere"),
        (
            "fillet 1.5 mm",
            "fillet [(0 %, 1 mm) (49 %, 0.1 mm) (50 %, 3 mm) (51 %, 0.1 mm) (100 %, 1 mm)]",
            "IMP0209",
            "runs smoothly",
        ),
        ("span 0 %   { beta", "span 101 %   { beta", "IMP0322", "0 % to 100 %"),
        ("span 0 %   { beta", "span 2 mm   { beta", "IMP0207", "plain number"),
        ("span 0 %   { beta", "span { beta", "IMP0210", "share of the span and a block"),
        ("thickness root }", "thickness -root }", "IMP0324", "cannot have"),
        (
            "leading-edge elliptic 2  trailing-edge cut-off\n    fillet",
            "leading-edge elliptic 2\n    fillet",
            "IMP0205",
            "trailing-edge",
        ),
        ("elliptic 2", "elliptic 0.1", "IMP0209", "from 0.5 to 10"),
        ("elliptic 2", "pointed", "IMP0210", "`round`, `cut-off`"),
        ("of main ", "of half ", "IMP0203", "main blade only"),
        ("from hub 3 mm, shroud 2 mm", "from hub 300 mm, shroud 2 mm", "IMP0326", "beyond the hub"),
        ("from hub 3 mm, shroud 2 mm", "from hub 3 mm", "IMP0210", "at hub and shroud"),
        ("from hub 3 mm, shroud 2 mm", "from 60 %  to 50 %", "IMP0326", "ends before it begins"),
        ("from hub 45 %, shroud 36 %", "from hub 45 mm, shroud 36 %", "IMP0207", "plain number"),
        ("angle 46 %", "angle 146 %", "IMP0207", "not a share"),
        ("bow   = 4 deg", "bow   = 4 mm", "IMP0207", "angle"),
    ] {
        let found = read(&changed(&[(from, to)]));
        let text = found.err().unwrap_or_else(|| panic!("{to} makes a part"));
        assert!(text.contains(code) && text.contains(words), "{to}: {code}, {words}\n{text}");
    }
}

/// A job with one part of these entries.
fn with_part(entries: &str) -> String {
    let [part, stock] = ["part splitter {", "stock turned {"].map(|word| JOB.find(word).unwrap());
    format!("{}part wheel {{\n{entries}\n}}\n{}", &JOB[..part], &JOB[stock..].replace("back -28 mm", "back -60 mm"))
}

const MERIDIANS: &str = "hub revolve spline [(8, 0, 0) (8.5, 0, -6) (10.4, 0, -12) (14.2, 0, -17) (19.5, 0, -20) (25, 0, -21.5) (30, 0, -22)] mm
    shroud revolve spline [(17, 0, 0) (17.3, 0, -4) (18.4, 0, -8) (20.8, 0, -11.6) (24, 0, -13.8) (27, 0, -14.7) (30, 0, -15)] mm";

/// A fan between cylinders: both edges are surfaces, and its middle section has the stated thickness in the developed plane.
#[test]
fn a_fan_between_cylinders() {
    let part = made(&with_part(
        "vanes 13
        hub revolve spline [(20, 0, 0) (20, 0, -50)] mm
        shroud revolve spline [(40, 0, 0) (40, 0, -50)] mm
        vane main {
          beta-from meridian
          span 0 %   { beta [(0 %, -50 deg) (100 %, -20 deg)]  start 0 deg  thickness [(0 %, 1 mm) (40 %, 4 mm) (100 %, 0.8 mm)] }
          span 50 %  { beta -40 deg  start 0 deg }
          span 100 % { beta [(0 %, -65 deg) (100 %, -60 deg)]  start 0 deg  thickness 1 mm }
          from 20 %  to 80 %  leading-edge elliptic 3  trailing-edge round  pressure counter-clockwise  fillet 2 mm
        }",
    ));
    assert!((0..2).all(|end| part.edge(BladeId::MAIN, end).is_some()));
    // At half of the span a helix on the cylinder of 30 mm, whose thickness is the mean of hub and shroud.
    let plane = |p: &Point3<f64>| [-p.z - 10.0, 30.0 * p.y.atan2(p.x)];
    let mut seen = 0;
    for face in faces(&part, 0) {
        for i in 5..=95 {
            let u = f64::from(i) / 100.0;
            // The place of the face at this radius.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let v = 0.5 * (low + high);
                let p = face.surface.point(u, v);
                if p.x.hypot(p.y) < 30.0 { low = v } else { high = v }
            }
            let [m, arc] = plane(&face.surface.point(u, low));
            let (sin, cos) = (-40.0_f64).to_radians().sin_cos();
            let beside = arc * cos - m * sin;
            let way = (m * cos + arc * sin) * cos / 30.0;
            // The parabola through 1, 4 and 0.8 mm, and 1 mm.
            let hub = 1.0 + way * (7.5 + (way - 0.4) * ((0.8 - 4.0) / 0.6 - 7.5));
            let half = 0.25 * (hub + 1.0);
            if (0.1..=0.95).contains(&way) {
                assert!((beside.abs() - half).abs() < 0.003, "{way}: {beside} {half}");
                seen += 1;
            }
        }
    }
    assert!(seen > 120, "{seen}");
}

/// A swept leading edge, and two splitters: a part of the main blade that ends before the outlet, and one with angles of its own.
#[test]
fn a_swept_edge_and_two_splitters() {
    let part = made(&with_part(&format!(
        "vanes 6
        {MERIDIANS}
        vane main {{
          span 0 % {{ theta [(0 %, 0 deg) (100 %, -60 deg)]  thickness 1.6 mm }}
          from spline [(8.1, 0, -2) (10, 2, -4) (14, 0, -4) (17.05, 0, -1.5)] mm
          leading-edge round  trailing-edge cut-off  pressure counter-clockwise
        }}
        splitter a {{
          of main  angle 33 %  from 30 %  to 95 %  thickness 1 mm  leading-edge round  trailing-edge round
        }}
        splitter b {{
          angle 66 %
          span 0 % {{ theta [(0 %, -36 deg) (100 %, -60 deg)]  thickness 1 mm }}
          from 60 %  leading-edge round  trailing-edge cut-off
        }}"
    )));
    let edges = |blade: usize| [0, 1].map(|end| part.edge(BladeId::new(blade), end).is_some());
    assert_eq!([0, 1, 2].map(edges), [[true, false], [true, true], [true, false]]);
    // The nose goes through the points of the curve.
    let edge = part.face(part.edge(BladeId::MAIN, 0).unwrap());
    for due in [[10.0_f64.hypot(2.0), -4.0], [14.0, -4.0]] {
        let off = (0..=400)
            .flat_map(|i| (0..=40).map(move |j| (f64::from(i) / 400.0, f64::from(j - 20) / 400.0 + 0.5)))
            .map(|(v, u)| edge.surface.point(u, v))
            .map(|p| (p.x.hypot(p.y) - due[0]).hypot(p.z - due[1]))
            .fold(f64::INFINITY, f64::min);
        assert!(off < 0.03, "{due:?}: {off}");
    }
}
