//! Other machines and other jobs than those of the text.

use super::changes::Named;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::five_axis::Machine;
use impellerc::five_axis::control::Planning;
use impellerc::ir::Program;

/// The text is read for another machine.
pub const MACHINES: &[Named<fn(&mut Machine)>] = &[
    ("A opposite", |m| m.rotary[0].word_sign = -1.0),
    ("C opposite", |m| m.rotary[1].word_sign = -1.0),
    ("A iso", |m| m.rotary[0].word_sign = 1.0),
    ("C iso", |m| m.rotary[1].word_sign = 1.0),
    ("sense iso", |m| (m.rotary[0].word_sign, m.rotary[1].word_sign) = (1.0, 1.0)),
    ("tools are changed higher", |m| m.retract += 50.0),
    ("Z ends lower", |m| m.linear[2].max -= 50.0),
    ("X ends earlier", |m| (m.linear[0].min, m.linear[0].max) = (-1.0, 1.0)),
    ("A ends earlier", |m| (m.rotary[0].min, m.rotary[0].max) = (-0.1, 0.1)),
    ("C ends earlier", |m| (m.rotary[1].min, m.rotary[1].max) = (-0.1, 0.1)),
    ("part higher", |m| m.part_origin.z += 3.0),
    ("LinuxCNC", |m| m.planning = Planning::LinuxCnc),
];

/// The text is read for another job.
pub const JOBS: &[Named<fn(&mut Program)>] =
    &[("no operation", |p| p.operations = PrimaryMap::new()), ("finer tolerance", |p| p.tolerances.chord = Mm(1e-4))];
