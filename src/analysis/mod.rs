//! Facts about the part, found before planning: the width of the channel, the tools that reach its floor, the twist of
//! the faces, and data points that break the pattern of the others.

pub mod beside;
pub mod channel;
pub mod cost;
pub mod ends;
pub mod flank;
pub mod machine_kind;
pub mod outliers;
pub mod part_kind;
pub mod reach;
mod retract;
pub mod throat;
pub mod tolerance_budget;
pub mod twist;

use crate::diag::codes::geometry as codes;
use crate::diag::{Diag, Sink};
use crate::ir::Program;
use crate::part::BladeId;

/// What is known about the part.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Width of the channel between neighbouring vanes.
    pub throat: throat::Throat,
    /// Twist of the pressure and the suction face.
    pub twists: [twist::Twist; 2],
    /// Distances of the ends of the faces from hub and shroud.
    pub ends: Vec<ends::EndGap>,
    /// Data points that break the pattern of the others.
    pub outliers: Vec<outliers::Outlier>,
    /// Reach of the tool of each operation that goes down to the floor.
    pub reaches: Vec<reach::Reach>,
    /// Free space for the tool of each operation that point mills faces or fillets.
    pub beside: Vec<beside::Beside>,
}

/// Finds the facts. Reports important ones; facts that no plan can overcome are errors.
pub fn check(program: &Program, sink: &mut Sink) -> Facts {
    let part = &program.part;
    let throat = throat::measure(part, &program.data);
    let twists = BladeId::MAIN.faces().map(|side| twist::measure(part, side));
    let ends = ends::measure(part);
    let outliers = outliers::find(&program.data);
    for outlier in &outliers {
        outlier.report(&program.data, sink);
    }
    let narrow = &throat.narrowest;
    sink.push(
        Diag::remark(codes::THROAT, format!("the throat of the channel is {:.2} mm", narrow.distance))
            .place(narrow.place(), narrow.point)
            .note(format!(
                "formula 8 of Wei 2021 measures arcs between the data points and gives {:.2} mm",
                throat.formula_8
            )),
    );
    for twist in &twists {
        sink.push(
            Diag::remark(
                codes::TWIST,
                format!(
                    "the twist of the {} face is up to {:.1} deg, {:.1} deg on average",
                    twist.side.name(),
                    twist.largest.to_degrees(),
                    twist.mean.to_degrees()
                ),
            )
            .note(format!("the rulings are {:.1} to {:.1} mm long", twist.ruling[0], twist.ruling[1])),
        );
    }
    flank::report(program, sink);
    retract::check(program, sink);
    let reaches = reach::check(program, &throat, sink);
    let beside = beside::check(program, sink);
    Facts { throat, twists, ends, outliers, reaches, beside }
}
