//! Thickness of cells: no point of a surface lies farther from the biquadratic through nine points of a cell than proved, and the
//! bound is not far above what dense samples find.

use crate::support::jobs;
use impellerc::nurbs::range::{CellThickness, Interval, Jet};

use impellerc::base::units::Mm;
use impellerc::verify::vane_allowance::Moved;
use impellerc::wheel::operation::VaneAllowance;
use impellerc::wheel::part::chart::{self, Chart, Shape};
use impellerc::wheel::part::{SurfaceKind, kept};
use nalgebra::{Point3, Vector3};

/// Samples along each side of a cell.
const SAMPLES: u32 = 12;

/// Largest distance of samples of a cell from the biquadratic through nine of its points, mm.
fn found(point: impl Fn(f64, f64) -> Point3<f64>, [x, y]: [[f64; 2]; 2]) -> f64 {
    let at = |range: [f64; 2], t: f64| range[0] + (range[1] - range[0]) * t;
    let weights = |t: f64| [(2.0 * t - 1.0) * (t - 1.0), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)];
    let net: Vec<Vector3<f64>> =
        (0..9).map(|k| point(at(x, f64::from(k / 3) / 2.0), at(y, f64::from(k % 3) / 2.0)).coords).collect();
    let mut most = 0.0_f64;
    for (i, j) in (0..=SAMPLES).flat_map(|i| (0..=SAMPLES).map(move |j| (i, j))) {
        let [s, t] = [i, j].map(|k| f64::from(k) / f64::from(SAMPLES));
        let (ws, wt) = (weights(s), weights(t));
        let middle: Vector3<f64> = (0..9).map(|k| net[k] * (ws[k / 3] * wt[k % 3])).sum();
        most = most.max((point(at(x, s), at(y, t)).coords - middle).norm());
    }
    most
}

/// Cells of a patch of a shape, and cells of other sizes.
fn cells(shape: &dyn Shape, spacing: f64) -> Vec<[[f64; 2]; 2]> {
    let patches = shape.patches(spacing);
    let every = patches.len().div_ceil(40);
    let cell = |patch: &chart::Patch, size: usize| {
        let [i, j] = [patch.columns, patch.rows].map(|n| n.saturating_sub(size) / 2);
        let ([x, y], [x1, y1]) =
            (patch.corner(i, j), patch.corner(i + size.min(patch.columns), j + size.min(patch.rows)));
        [[x, x1], [y, y1]]
    };
    patches.iter().step_by(every).flat_map(|patch| [cell(patch, 1), cell(patch, 2), cell(patch, 8)]).collect()
}

/// The sum of the logarithms of the ratios of bound and samples over the cells that are not flat, and their count.
fn compared(name: &str, shape: &dyn Shape) -> (f64, usize) {
    /// Rounding of points, mm.
    const ROUNDING: f64 = 1e-10;
    let (mut loose, mut count) = (0.0, 0);
    for cell in cells(shape, 0.25) {
        let thickness = shape.thickness(cell).most;
        let sampled = found(|x, y| shape.place(x, y).position, cell);
        assert!(sampled <= thickness + ROUNDING, "{name}: {sampled:e} of {thickness:e} mm at {cell:?}");
        if thickness > 1e-6 {
            loose += (thickness / sampled.max(ROUNDING)).ln();
            count += 1;
        }
    }
    (loose, count)
}

/// On every surface of wheels of all kinds, milled or kept.
#[test]
fn cells_of_all_surfaces_are_as_thick_as_proved() {
    let shipped = ["small", "wei2021", "splitter", "sections", "blisk"].map(|job| (job, jobs::program(job, None)));
    let varied = ("fillet 1.5 mm", "fillet [(0 %, 1.2 mm) (60 %, 2 mm) (100 %, 1.5 mm)]");
    let varied = ("varied fillets", jobs::program_with("jobs/splitter/splitter.imp", &[varied]));
    for (job, program) in shipped.into_iter().chain([varied]) {
        let part = &program.part;
        let (mut loose, mut count) = (0.0, 0);
        let mut compare = |name: String, shape: &dyn Shape| {
            let (own, cells) = compared(&format!("{job}, {name}"), shape);
            println!("{job}, {name}: {:.1} times, {cells} cells", (own / cells.max(1) as f64).exp());
            (loose, count) = (loose + own, count + cells);
        };
        for shape in &chart::charts(part) {
            compare(format!("{:?}", shape.kind), shape);
        }
        for shape in &kept::kept(part, &program.stock, kept::MilledTurned::default()) {
            compare(format!("kept {:?}", shape.kind), shape);
        }
        // A bound that is far above the surface would be of no use.
        let mean = (loose / f64::from(u32::try_from(count).unwrap())).exp();
        assert!(mean < 6.0, "{job}: bounds are {mean} times what samples find");
    }
}

/// On the outside of an allowance that is even, and of one that grows towards the root. The growth is bounded by its slope alone.
#[test]
fn moved_surfaces_are_as_thick_as_proved() {
    /// Largest thickness of cells of 0.25 mm of faces and of fillets, mm, for a growth of 0.2 mm over a vane of some millimetres. It
    /// halves with the cell. Along the fillet of an edge the normal turns by half a turn within a millimetre.
    const MOST: [f64; 2] = [0.015, 0.15];
    for job in ["small", "splitter", "blisk"] {
        let program = jobs::program(job, None);
        let part = &program.part;
        let of_vane = |chart: &Chart<'_>| matches!(chart.kind, SurfaceKind::Face(_) | SurfaceKind::Fillet(_));
        for (tip, root) in [(0.3, 0.3), (0.2, 0.4)] {
            for chart in chart::charts(part).into_iter().filter(of_vane) {
                let is_face = matches!(chart.kind, SurfaceKind::Face(_));
                let name = format!("{job}, {:?} at {tip} to {root} mm", chart.kind);
                let shape = Moved { chart, part, vane: VaneAllowance::growing(Mm(tip), Mm(root)).unwrap() };
                compared(&name, &shape);
                let every = cells(&shape, 0.25).into_iter().step_by(3);
                let thickest = every.map(|cell| shape.thickness(cell).most).fold(0.0, f64::max);
                println!("{name}: {:.2} um", 1e3 * thickest);
                assert!(thickest < MOST[usize::from(!is_face)], "{name}: {thickest} mm");
            }
        }
    }
}

/// An allowance belongs to the part where the surface below it does. At the rim of this pump the normal of the fillet leans out of
/// the part or into it, so that the outside of the allowance ends elsewhere.
#[test]
fn an_allowance_ends_where_its_surface_ends() {
    let program = jobs::program("pump", None);
    let part = &program.part;
    let mut others = 0;
    for chart in chart::charts(part) {
        let SurfaceKind::Fillet(side) = chart.kind else { continue };
        let extent = part.extent(side.blade);
        let shape = Moved { chart, part, vane: VaneAllowance::growing(Mm(0.3), Mm(0.3)).unwrap() };
        for (i, j) in (0..=200).flat_map(|i| (0..=12).map(move |j| (f64::from(i) / 200.0, f64::from(j) / 12.0))) {
            let [below, above] = [shape.chart.place(i, j).position, shape.place(i, j).position];
            assert_eq!(shape.is_milled([i, j], &above), extent.holds(&below), "{:?} {i} {j}", shape.chart.kind);
            others += usize::from(extent.holds(&below) != extent.holds(&above));
        }
    }
    assert!(others > 20, "{others}");
}

/// The constants of the bound are the largest deviations of functions whose derivative jumps anywhere.
#[test]
fn constants_of_the_bound_are_sharp() {
    // The worst function of each order: the third derivative is constant; the others jump where the kernel changes its sign.
    let deviation = |f: &dyn Fn(f64) -> f64| found(|x, _| Point3::new(f(2.0 * x - 1.0), 0.0, 0.0), [[0.0, 1.0]; 2]);
    let bound = |order: usize, smooth: i32| {
        let orders = std::array::from_fn(|k| if k == order { Interval::new([-1.0, 1.0]) } else { Interval::ALL });
        let flat = Jet::constant(Interval::ZERO);
        CellThickness::of(&[Jet { orders, smooth }, flat, flat], 1.0).most
    };
    let mut most = [0.0_f64; 3];
    for a in (0..=100).map(|k| f64::from(k) / 50.0 - 1.0) {
        for b in (0..=100).map(|k| f64::from(k) / 50.0 - 1.0).filter(|b| *b >= a) {
            // First derivative 1, -1, 1 with jumps at a and b; the same for the second derivative.
            let once = |x: f64| {
                if x < a {
                    x
                } else if x < b {
                    2.0 * a - x
                } else {
                    2.0 * (a - b) + x
                }
            };
            let twice = |x: f64| {
                let beyond = |at: f64| if x > at { (x - at) * (x - at) } else { 0.0 };
                0.5 * x * x - beyond(a) + beyond(b)
            };
            most[1] = most[1].max(deviation(&once));
            most[2] = most[2].max(deviation(&twice));
        }
    }
    most[0] = deviation(&|x| x * x * x / 6.0);
    for (k, (order, smooth)) in [(3, 2), (1, 0), (2, 1)].into_iter().enumerate() {
        let bound = bound(order, smooth);
        assert!(most[k] <= bound && most[k] > 0.97 * bound, "order {order}: {} of {bound}", most[k]);
    }
}
