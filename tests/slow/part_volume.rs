//! The finished part as a closed mesh: exact solids first, then the paper's part against the stock simulation.

use crate::support;
use impellerc::base::progress::Progress;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::nurbs::{NurbsCurve, interpolate};
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::stock::Mesh;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::stock::{Settings, simulate};
use impellerc::wheel::part::{Guides, Part, Stock, sample, solid};
use nalgebra::Point3;
use std::f64::consts::{PI, TAU};

/// A turned profile of (r, z) points, by Pappus.
fn pappus(profile: &[[f64; 2]]) -> f64 {
    let edges = profile.iter().zip(profile.iter().cycle().skip(1));
    // The integral of r^2 / 2 dz around the profile, exact for straight edges.
    let sum: f64 = edges.map(|(a, b)| (b[1] - a[1]) * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]) / 6.0).sum();
    TAU * sum.abs()
}

#[test]
fn volumes_of_exact_solids() {
    let corner = |x: f64, y: f64, z: f64| Point3::new(x + 100.0, y - 50.0, z + 7.0);
    let vertices = vec![corner(0.0, 0.0, 0.0), corner(2.0, 0.0, 0.0), corner(0.0, 3.0, 0.0), corner(0.0, 0.0, 4.0)];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut solid = Mesh { vertices, triangles };
    assert!(solid.is_closed() && (solid.volume() - 4.0).abs() < 1e-12);
    solid.triangles.pop();
    assert!(!solid.is_closed());
}

/// Straight radial vanes of even thickness on a cylinder: everything has a closed form.
///
/// A vane lies between the planes y = +-w, the hub is the cylinder of radius R1, the shroud that of R2; inlet and
/// outlet are planes across the axis. Behind such an axial outlet the part has the radius of the hub.
#[test]
fn radial_vanes_have_their_closed_form() {
    let (inner, outer, w, length, bore, back) = (20.0_f64, 45.0_f64, 2.0_f64, 30.0, 6.0, -38.0);
    let at = |r: f64, y: f64, z: f64| Point3::new((r * r - y * y).sqrt(), y, z);
    let line = |r: f64, y: f64| -> NurbsCurve {
        let points: Vec<Point3<f64>> = (0..5).map(|i| at(r, y, -length * f64::from(i) / 4.0)).collect();
        interpolate(&points, 3).unwrap()
    };
    let guides = |y: f64| Guides { root: line(inner, y), tip: line(outer, y) };
    let part = Part::new(7, guides(w), guides(-w), line(inner, w), line(outer, w), None);
    let stock = Stock::turned(&part, Mm(0.0), Mm(bore), Mm(back));
    // Half of the room between the planes under a circle.
    let under = |r: f64| w * (r * r - w * w).sqrt() + r * r * (w / r).asin();
    let vanes = 7.0 * (under(outer) - under(inner)) * length;
    let turned = PI * (inner * inner - bore * bore) * -back;
    let mesh = solid::mesh(&part, &stock, [6, 6, 24, 6]).unwrap();
    assert!(mesh.is_closed());
    let found = solid::volume(&part, &stock, 1e-6).unwrap();
    println!("radial vanes: {found:?}, closed form {}", vanes + turned);
    assert!((found.value - vanes - turned).abs() < 1e-3 && found.error < 1e-2, "{found:?} {}", vanes + turned);
    // Everything between hub and shroud is vane or room.
    assert!(pappus(&stock.profile) > found.value);
}

/// The paper's part, all channels roughed and finished: what the stock simulation has left of the blank is the part by
/// its mesh and what the surface verifier finds left on it, each found in its own way.
#[test]
fn the_stock_that_stays_is_the_part_and_what_finishing_leaves() {
    let program = support::wei_program(&[0, 1, 2, 3, 4, 5, 6, 7]);
    let part = solid::volume(&program.part, &program.stock, 1e-6).unwrap();
    let mesh = solid::mesh(&program.part, &program.stock, [24, 12, 12, 4]).unwrap();
    assert!(mesh.is_closed() && part.error < 0.5, "{part:?}");
    let motion = pipeline::run(&program, &mut Sink::default()).expect("a plan").motion;
    let sweeps: Vec<Sweep<'_>> =
        (0..motion.operations.len()).filter_map(|o| Sweep::new(&program, &motion, o)).collect();
    let samples = sample::sample(&program.part, 0.5);
    let left = |s: &sample::Sample| sweeps.iter().fold(2.0, |d, w| w.nearest(&s.position, d).map_or(d, |n| n.distance));
    let left: f64 = samples.iter().filter(|s| s.surface.milled()).map(|s| left(s) * s.area).sum();
    let blank = pappus(&program.stock.profile);
    let corners = |t: &[u32; 3]| t.map(|i| mesh.vertices[i as usize]);
    let area: f64 = mesh.triangles.iter().map(corners).map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum();
    // A cell of 2 mm is as wide as a vane is thick: there the error hangs on where the rays happen to fall.
    for cell in [1.0, 0.5] {
        let mut settings = Settings { cell: Some(cell), ..Settings::default() };
        let stock =
            simulate(&program, &motion, &mut settings, &Progress::default(), &mut Sink::default()).expect("a stock");
        let removed: f64 = stock.operations.iter().map(|o| o.removed.get()).sum();
        let gap = stock.rest().get() - part.value - left;
        println!(
            "cell {:.3}: blank {blank:.1} (rays {:.1}), removed {removed:.1}, rest {:.1}, part {:.1} +- {:.3}, left {left:.1}, gap {gap:.1}, area {area:.0}",
            stock.cell.get(),
            stock.blank.get(),
            stock.rest().get(),
            part.value,
            part.error
        );
        assert!((stock.blank.get() - removed - stock.rest().get()).abs() < 1e-6 * blank);
        // Rays know nothing between each other: over the surface their errors are shares of a cell that cancel out.
        let bound = 0.02 * stock.cell.get() * area;
        assert!(gap.abs() < bound && (stock.blank.get() - blank).abs() < bound, "{gap} {bound}");
    }
}
