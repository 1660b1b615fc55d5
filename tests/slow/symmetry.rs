//! The proof of one sector beside that of each sector, on whole wheels: the figures of docs/benchmarks.md.

use crate::support::jobs;
use impellerc::base::progress::Progress;
use impellerc::diagnostics::Sink;
use impellerc::ir::{Motion, Program};
use impellerc::plan::passes::pipeline;
use impellerc::verify::kept;
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::surface::{self, SurfaceReport};
use impellerc::verify::{SPACING, limits};

/// Largest difference of what was found in the same place of two sectors, mm: the rounding of the arithmetic moves the corners
/// of a grid, and with them what is found between two places that are equally bad.
const FOUND: f64 = 1e-6;

/// The shipped jobs with blades in every sector, those that machine one of them in all.
fn wheels() -> [(&'static str, Program); 5] {
    let all = |job: &str, roughed: &str| {
        let changes = [(roughed, "\n"), ("  sectors 1\n", "\n")];
        jobs::program_with(&format!("jobs/{job}/{job}.imp"), &changes)
    };
    [
        ("wei2021", jobs::program("wei2021", None)),
        ("turbo20", jobs::program("turbo20", None)),
        ("pump", jobs::program("pump", None)),
        ("splitter", all("splitter", "  sectors 1, 5\n")),
        ("blisk", all("blisk", "  sectors 1, 2, 13\n")),
    ]
}

fn proved(program: &Program, motion: &Motion, alone: bool) -> (Vec<SurfaceReport>, kept::KeptSurfaces) {
    let sweeps = (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o));
    let sweeps: Vec<Sweep<'_>> = sweeps.map(|sweep| if alone { sweep.in_each_sector() } else { sweep }).collect();
    let (progress, bounds) = (Progress::default(), limits(program));
    let surfaces = surface::certify(&program.part, program.milled_turned(), &sweeps, SPACING, &bounds, &progress);
    (surfaces, kept::check(program, &sweeps, 0.0, &progress))
}

#[test]
#[ignore = "minutes; by hand after changes of verify/symmetry.rs"]
fn one_sector_proves_what_each_sector_does_on_five_wheels() {
    for (name, program) in wheels() {
        let motion =
            pipeline::run(&program, &mut Sink::default()).unwrap_or_else(|_| panic!("no plan of {name}")).motion;
        let [partners, alone] = [false, true].map(|alone| proved(&program, &motion, alone));
        let (mut found, mut bounds) = (0.0_f64, 0.0_f64);
        assert_eq!(partners.0.len(), alone.0.len());
        for (a, b) in partners.0.iter().zip(&alone.0) {
            let what = format!("{name}: {}", a.surface);
            found = found.max((a.gouge.value.get() - b.gouge.value.get()).abs());
            // What one proof bounds, the other does not find beyond.
            assert!(a.gouge_bound.get() >= -b.gouge.value.get() - FOUND, "{what}");
            assert!(a.excess_bound.get() >= b.excess.value.get() - FOUND, "{what}");
            let off = (a.gouge_bound.get() - b.gouge_bound.get()).abs();
            assert!(off <= 2.0 * surface::SLACK, "{what}: {off}");
            bounds = bounds.max(off);
        }
        for (a, b) in partners.1.surfaces.iter().zip(&alone.1.surfaces) {
            assert!((a.gouge_bound.get() - b.gouge_bound.get()).abs() <= 2.0 * surface::SLACK, "{name}: {}", a.surface);
        }
        let own = |reports: &[SurfaceReport]| reports.iter().filter(|s| s.follows.is_none()).count();
        let points = |reports: &[SurfaceReport]| reports.iter().map(|s| s.points).sum::<usize>();
        println!(
            "{name}: {} sectors, {} of {} surfaces proved, {} and {} points and cells; gouge found within {:.1e} mm, bounds within \
             {:.1e} mm",
            program.part.vane_count,
            own(&partners.0),
            alone.0.len(),
            points(&partners.0),
            points(&alone.0),
            found,
            bounds,
        );
    }
}
