//! Facts about the part, found before planning: the width of the channel, the tools that reach its floor, twist, straightness and
//! concave radii of the faces, what flank milling would leave, and data points that break the pattern of the others.

pub mod channel;
pub mod concave;
pub mod flank;
pub mod flat_edges;
pub mod free_space;
pub mod machine_kind;
pub mod outliers;
pub mod reach;
mod requirements;
mod retract;
mod stock_height;
pub mod throat;
pub mod twist;

use base::progress::Progress;
use base::units::length;
use concave::Concave;
use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use ir::Program;
use rayon::prelude::*;
use wheel::part::{FaceId, Part};

/// Bulge below which lines count as straight, mm: rounding of fitted data.
const STRAIGHT_BULGE_MM: f64 = 1e-4;

/// Reports the facts that matter to a programmer; facts that no plan can overcome are errors.
pub fn check(program: &Program, _: &Progress, sink: &mut Sink) {
    report(program, None, sink);
}

/// [`check`], and what flank milling would leave: fits of the tools to all faces take most of the time. A run that is cancelled
/// ends soon, and leaves out facts.
pub fn check_with_fits(program: &Program, progress: &Progress, sink: &mut Sink) {
    report(program, Some(progress), sink);
}

fn report(program: &Program, fits: Option<&Progress>, sink: &mut Sink) {
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
        let widths = throat.levels.iter().map(|level| format!("{:.2}", level.distance)).collect::<Vec<_>>();
        let remark = remark.note(format!(
            "narrowest at the hub, at a quarter, half and three quarters of the height, and at the tip: {} mm",
            widths.join(", ")
        ));
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
            .note(format!("the rulings are {:.1} to {:.1} mm long", twist.ruling[0], twist.ruling[1]))
            .note(if twist.bulge > STRAIGHT_BULGE_MM {
                format!(
                    "the face is not ruled: its lines from root to tip leave their chords by up to {}",
                    length(twist.bulge)
                )
            } else {
                "the face is ruled: its lines from root to tip are straight".to_owned()
            }),
        );
    }
    let sides: Vec<FaceId> = part.blade_ids().flat_map(|blade| part.sides(blade)).collect();
    let measured: Vec<_> = sides.into_par_iter().map(|side| concave::measure(part, side)).collect();
    for concave in measured.into_iter().flatten() {
        sink.push(smallest_radius(part, &concave));
    }
    if let Some(progress) = fits {
        flank::report(program, progress, sink);
    }
    requirements::check(program, sink);
    retract::check(program, sink);
    stock_height::check(program, sink);
    let before = sink.errors();
    reach::check(program, &throats, sink);
    // Where the fillets fill the channel, they are the reported cause, and not each ball.
    if sink.errors() == before || !reach::fillets_fill(program, &throats) {
        free_space::check(program, sink);
    }
}

/// The smallest concave radius of a face.
fn smallest_radius(part: &Part, concave: &Concave) -> Diag {
    let of = if part.blades.len() == 1 { String::new() } else { format!("{} ", part.blade(concave.side.blade).name) };
    let name = if concave.side.edge_end().is_some() { "" } else { " face" };
    let name = format!("{of}{}{name}", concave.side.name());
    let [u, v] = concave.at;
    let message = format!("the smallest concave radius of the {name} is {}", length(concave.radius));
    Diag::remark(codes::CONCAVE, message).place(format!("{name} at u = {u:.3}, v = {v:.3}"), concave.point)
}
