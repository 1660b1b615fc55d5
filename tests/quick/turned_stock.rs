//! The stock of one sector for all: chips that are taken from partners against the simulation of each sector, on a whole wheel and
//! with faults in one sector.

use crate::symmetry::{WHEEL, of_sector, posed};
use impellerc::base::progress::Progress;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Joints;
use impellerc::ir::{Motion, MoveKind};
use impellerc::verify::stock::{Settings, StockReport, simulate};
use nalgebra::{Rotation3, Vector3};

/// Cells, mm: the smallest tool has a radius of 3 mm.
const CELL: f64 = 0.4;

/// With the chips of partners, and each sector by itself.
fn both(motion: &Motion) -> [StockReport; 2] {
    [false, true].map(|each_sector| {
        let mut settings = Settings { cell: Some(CELL), each_sector, ..Settings::default() };
        simulate(&WHEEL.0, motion, &mut settings, &Progress::default(), &mut Sink::default()).unwrap()
    })
}

/// Volumes, times in air and loads are those of each sector, within what cells that lie otherwise change.
fn agree([partners, alone]: &[StockReport; 2]) {
    assert_eq!(alone.turned.get(), 0.0);
    for (a, b) in partners.operations.iter().zip(&alone.operations) {
        let near = |a: f64, b: f64, by: f64| assert!((a - b).abs() <= by, "{}: {a} {b}", alone.cell.get());
        near(a.removed.get(), b.removed.get(), 5e-3 * b.removed.get() + 1.0);
        near(a.rest.get(), b.rest.get(), 1e-3 * b.rest.get());
        near(a.air.get(), b.air.get(), 0.01 * b.time.get());
        let [x, y] = [a, b].map(|o| o.rate.map_or(0.0, |rate| rate.value.get()));
        near(x, y, 0.15 * y);
        let [x, y] = [a, b].map(|o| o.depth.map_or(0.0, |depth| depth.value.get()));
        near(x, y, 2.0 * CELL);
    }
}

#[test]
fn one_sector_stands_for_the_wheel() {
    let reports = both(&WHEEL.1);
    agree(&reports);
    println!("{:.3} of the steps are those of partners", reports[0].turned.get());
    assert!(reports[0].turned.get() > 0.4, "{:?}", reports[0].turned);
    assert!(reports.iter().all(|r| r.collisions().count() == 0 && r.missing.is_none()));
    // The same again: nothing depends on the order of threads.
    assert_eq!(both(&WHEEL.1)[0], reports[0]);
}

/// A rapid in the middle of a pass of one sector is found there, as deep as by the simulation of each sector.
#[test]
fn a_rapid_through_the_stock_of_one_sector_is_found() {
    for sector in [0, 4, 7] {
        let mut changed = WHEEL.1.clone();
        let operation = &mut changed.operations[0];
        let prefix = format!("sector {} ", sector + 1);
        let is_own = |k: &usize| operation.labels[operation.moves[*k].pass as usize].starts_with(&prefix);
        let cuts = |k: &usize| operation.moves[*k].kind == MoveKind::Cut;
        let own: Vec<usize> = (1..operation.moves.len()).filter(is_own).filter(cuts).collect();
        let block = own[own.len() / 2];
        operation.moves[block].kind = MoveKind::Rapid;
        operation.moves[block].feed = None;
        let reports = both(&changed);
        agree(&reports);
        let found = reports.each_ref().map(|report| {
            let deepest = report.collisions().max_by(|a, b| a.depth.get().total_cmp(&b.depth.get())).unwrap();
            assert!(report.collisions().all(|c| c.at.operation == 0 && c.at.index as usize == block));
            deepest.depth.get()
        });
        println!("sector {}: {found:?}", sector + 1);
        assert!((found[0] - found[1]).abs() < CELL && found[1] > 0.1, "{found:?}");
    }
}

/// Two sectors that are exchanged, and one that is turned by 0.01 deg, in all operations: the stock is that of each sector.
#[test]
fn exchanged_and_turned_sectors_have_their_stock() {
    let program = &WHEEL.0;
    let (mut exchanged, mut turned) = (WHEEL.1.clone(), WHEEL.1.clone());
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.01_f64.to_radians());
    for o in 0..WHEEL.1.operations.len() {
        let [second, sixth] = [1, 5].map(|sector| of_sector(&WHEEL.1.operations[o], sector));
        for (a, b) in second.iter().zip(&sixth) {
            exchanged.operations[o].moves.swap(*a, *b);
        }
        for block in of_sector(&WHEEL.1.operations[o], 4) {
            let moves = &mut turned.operations[o].moves;
            moves[block] = posed(program, &moves[block], &turn, Vector3::zeros());
        }
    }
    for (changed, what) in [(exchanged, "exchanged"), (turned, "turned")] {
        let reports = both(&changed);
        agree(&reports);
        println!("{what}: {:.3} of the steps are those of partners", reports[0].turned.get());
        let count = |report: &StockReport| report.collisions().count();
        assert_eq!(count(&reports[0]), count(&reports[1]), "{what}");
    }
}

/// Roughing that is left out in one sector is missing there, and finishing takes some of it.
#[test]
fn a_sector_that_is_not_roughed_is_found() {
    let (sector, vanes) = (4_u32, WHEEL.0.part.vane_count);
    let mut changed = WHEEL.1.clone();
    let operation = &mut changed.operations[0];
    let prefix = format!("sector {} ", sector + 1);
    // The tool stays over the part in these moves.
    let high: Joints = operation.moves[0].joints;
    for m in &mut operation.moves {
        if operation.labels[m.pass as usize].starts_with(&prefix) {
            m.joints = high;
        }
    }
    let clean = both(&WHEEL.1);
    let reports = both(&changed);
    agree(&reports);
    let removed = |report: &StockReport, o: usize| report.operations[o].removed.get();
    let missing = removed(&clean[1], 0) - removed(&reports[1], 0);
    assert!((missing - removed(&clean[1], 0) / f64::from(vanes)).abs() < 0.2 * missing, "{missing}");
    // What finishing takes instead is in both.
    let more = reports.each_ref().map(|report| removed(report, 1) - removed(&clean[1], 1));
    println!("not roughed {missing:.1} mm3; flank milling takes {more:?} mm3 more");
    assert!(more.iter().all(|more| *more > 0.01 * missing), "{more:?}");
}
