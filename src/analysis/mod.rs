//! Facts about the part, found before planning: the width of the channel, the tools that reach its floor, the twist of
//! the faces, and data points that break the pattern of the others.

pub mod beside;
pub mod channel;
pub mod cost;
pub mod flank;
pub mod flat_edges;
pub mod machine_kind;
pub mod outliers;
pub mod reach;
mod retract;
mod stock_height;
pub mod throat;
pub mod tolerance_budget;
pub mod twist;

use crate::diag::codes::geometry as codes;
use crate::diag::{Diag, Sink};
use crate::ir::Program;

/// Reports the facts that matter to a programmer; facts that no plan can overcome are errors.
pub fn check(program: &Program, sink: &mut Sink) {
    let part = &program.part;
    let throats = throat::all(part, &program.data);
    let twists = part.faces().map(|side| (side, twist::measure(part, side)));
    for outlier in outliers::find(&program.data) {
        outlier.report(&program.data, sink);
    }
    for (passage, throat) in &throats {
        let narrow = &throat.narrowest;
        let blades = [passage.walls[0], passage.walls[1]].map(|wall| part.blade(wall.blade).name.as_str());
        let channel =
            if part.blades.len() == 1 { String::new() } else { format!(" from {} to {}", blades[0], blades[1]) };
        let remark =
            Diag::remark(codes::THROAT, format!("the throat of the channel{channel} is {:.2} mm", narrow.distance))
                .place(narrow.place(), narrow.point);
        sink.push(if part.blades.len() > 1 {
            remark
        } else {
            remark.note(format!(
                "formula 8 of Wei 2021 measures arcs between the data points and gives {:.2} mm",
                throat.formula_8
            ))
        });
    }
    for (side, twist) in twists {
        let of = if part.blades.len() == 1 { String::new() } else { format!("{} ", part.blade(side.blade).name) };
        sink.push(
            Diag::remark(
                codes::TWIST,
                format!(
                    "the twist of the {of}{} face is up to {:.1} deg, {:.1} deg on average",
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
    stock_height::check(program, sink);
    reach::check(program, &throats, sink);
    beside::check(program, sink);
}
