//! Statements of curves, and the GOTO along them, as moves of the path.

use super::State;
use super::movnrb::Movnrb;
use crate::nc::NcPose;
use five_axis::CurveDirection;

impl State<'_> {
    /// A statement of two curves, or the end of them.
    pub(super) fn movnrb(&mut self, values: &[&str]) -> Result<(), String> {
        let Some(mut curves) = self.curves.take() else {
            let mut curves = Movnrb::at(self.program.line);
            let begun = curves.judged(|curves| curves.begin(values));
            self.curves = Some(curves);
            self.needs_units();
            self.needs_multax();
            return begun;
        };
        let done = match values {
            ["OFF"] => return curves.judged(|curves| curves.end()),
            ["NEXT"] if !curves.follows() => {
                if self.path.as_ref().is_none_or(|path| !path.begun) {
                    self.program
                        .fault("MOVNRB, and nothing says where the tool stands before: write FROM and GOTO before");
                }
                // Behind a fault no moves are kept, so that the place is unknown.
                let from = self.path.as_ref().filter(|_| self.program.faults.is_empty()).map(|path| path.at);
                let feed = self.feed_of_move();
                curves.judged(|curves| curves.next(from)).map(|pieces| {
                    for piece in pieces {
                        if let (tip, CurveDirection::Axis(axis)) = piece.at(1.0) {
                            self.go(&NcPose { tip, axis }, Some(feed), Some(piece));
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
        let tolerance = self.tolerance();
        let Some(curves) = &mut self.curves else { return Ok(()) };
        curves.judged(|curves| {
            if rapid {
                return Err("a GOTO at rapid between MOVNRB/NEXT and MOVNRB/OFF".to_owned());
            }
            curves.goto(&pose?, tolerance)
        })
    }
}
