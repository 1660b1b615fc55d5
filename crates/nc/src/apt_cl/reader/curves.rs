//! Statements of curves, and the GOTO along them, as moves of the path.

use super::State;
use super::movnrb::Movnrb;
use crate::nc::{Direction, NcMove, NcPose};
use five_axis::CurveDirection;

impl State<'_> {
    /// A statement of two curves, or the end of them.
    pub(super) fn movnrb(&mut self, values: &[&str]) -> Result<(), String> {
        let line = self.line;
        let Some(mut curves) = self.curves.take() else {
            let mut curves = Movnrb::at(line);
            let begun = curves.judged(|curves| curves.begin(values));
            self.curves = Some(curves);
            self.needs_units();
            if !self.multax {
                self.fault_once("multax", "no statement before says that the tool tilts: write MULTAX/ON");
            }
            return begun;
        };
        let done = match values {
            ["OFF"] => return curves.judged(|curves| curves.end()),
            ["NEXT"] if !curves.follows() => {
                if self.path.as_ref().is_none_or(|path| path.start.is_none()) {
                    self.fault("MOVNRB, and nothing says where the tool stands before: write FROM and GOTO before");
                }
                // Behind a fault no moves are kept, so that the place is unknown.
                let stands = self.path.as_ref().filter(|_| self.faults.is_empty());
                let from = stands.map(|path| match path.moves.last() {
                    Some(NcMove { tip, direction: Direction::Axis(axis), .. }) => NcPose { tip: *tip, axis: *axis },
                    _ => path.from,
                });
                let feed = self.feed_of_move();
                curves.judged(|curves| curves.next(from)).map(|pieces| {
                    for piece in pieces {
                        if let (tip, CurveDirection::Axis(axis)) = piece.at(1.0) {
                            self.go(line, &NcPose { tip, axis }, Some(feed), Some(piece));
                        }
                    }
                })
            }
            _ => curves.judged(|curves| curves.take(values)),
        };
        self.curves = Some(curves);
        done
    }

    /// A GOTO along two curves: the same motion for post-processors that do not take curves.
    pub(super) fn along_curves(&mut self, values: &[&str], rapid: bool) -> Result<(), String> {
        let pose = self.pose("GOTO", values);
        let tolerance = self.tolerance.unwrap_or(0.0);
        let Some(curves) = &mut self.curves else { return Ok(()) };
        curves.judged(|curves| {
            if rapid {
                return Err("a GOTO at rapid between MOVNRB/NEXT and MOVNRB/OFF".to_owned());
            }
            curves.goto(&pose?, tolerance)
        })
    }
}
