//! The removal rate of a link is that of its fastest part, however long its way through air is.

use crate::plunge::{block, findings, of_one_operation};
use impellerc::diag::Severity;
use impellerc::ir::{JointMove, MoveKind};
use nalgebra::Point3;

/// Speed of links and of cuts, mm/s.
const LINK: f64 = 100.0;
const CUT: f64 = 20.0;

/// A flat tool of 4 mm runs 3 mm into a block on a link, 1 mm deep, after a way through air; then it cuts on.
#[test]
fn the_air_before_does_not_lower_it() {
    let program = block(2.0, 1.4);
    let at = |x: f64, z: f64| program.machine.joints(&Point3::new(x, 0.0, z), [0.0; 2]);
    let to = |kind, x: f64, z: f64, way: f64, speed: f64| JointMove {
        kind,
        joints: at(x, z),
        feed: Some(speed * 60.0),
        time: way / speed,
        pass: 0,
        stop: false,
    };
    let run = |air: f64, link: f64| {
        let moves = vec![
            to(MoveKind::Rapid, -8.0 - air, 10.0, 1.0, LINK),
            to(MoveKind::Link, -8.0 - air, -1.0, 11.0, link),
            to(MoveKind::Link, -5.0, -1.0, 3.0 + air, link),
            to(MoveKind::Cut, -1.0, -1.0, 4.0, CUT),
            to(MoveKind::Rapid, -1.0, 10.0, 11.0, LINK),
        ];
        findings(&program, &of_one_operation(&program, moves), 0.2)
    };
    for air in [0.5, 20.0, 200.0] {
        let (found, said) = run(air, LINK);
        let rate = found.link.expect("a link that cuts").value;
        println!("{air} mm of air: {rate:.1} mm3/s");
        // At the end of the link the tool is 3 mm deep in the block: a chord of nearly 4 mm, 1 mm deep.
        assert!(rate > 0.8 * 3.9 * LINK && rate < 1.05 * 4.0 * LINK, "{air}: {rate}");
        assert!(said.contains(&(Severity::Error, "IMP0735")), "{air}: {said:?}");
        // At the speed of the cuts it is none.
        let (found, said) = run(air, 0.9 * CUT);
        assert!(found.link.expect("a link that cuts").value < 4.0 * CUT);
        assert!(!said.contains(&(Severity::Error, "IMP0735")), "{air}: {said:?}");
    }
}
