//! Siemens SINUMERIK 840D sl and ONE.
//!
//! Tool centre point control is TRAORI. Cuts and links carry the tool direction as a vector (A3= B3= C3=, from the tip
//! to the holder), or the positions of the rotary axes (such as A= C=), as the post file says. Of a vector, all three components are always written: the control takes a missing component as 0. With ORIAXES
//! the rotary axes run linearly between blocks, as in the motion.
//!
//! Two rotary positions give the same vector. The rapid before every pass carries the rotary positions themselves (such
//! as A= C=), and thus selects one of them. [`Post::check`] makes sure that the nearest position is the right one in
//! every later block: within a pass rotary axis 1 keeps its branch, and rotary axis 2 turns less than 90 deg a block.
//! Rotary axis 2 is a limited axis here: no DC().
//!
//! Spline blocks are polynomials (POLY) of the tip and, with ORICURVE, of a second point of the tool axis (`PO[XH]`). Before the
//! first of them a block without motion states where this point begins; behind the last, ORIAXES is active again. Outside of
//! POLY the control runs straight to the ends of polynomials without a word about it.
//!
//! The head of the program resets what an aborted program can have left active. With the transformation off, axes move
//! in the machine frame (SUPA) without tool length (D0): Z alone to the retract height, there the rotary axes, then X
//! and Y. TRAORI and TRAFOOF cancel frames, so the work offset is written again after them.

mod reader;
mod repetition;
mod words;
mod writer;

use crate::dialect::{Dialect, Post, WriteBlock};
use crate::divided::Divided;
use crate::nc::ReadResult;
use diagnostics::Sink;
use five_axis::Machine;
use ir::{Motion, MotionOperation, Program};
use wheel::control::SplineForm;

static DIALECT: Dialect = Dialect {
    name: "siemens-840d",
    about: "SINUMERIK 840D sl and ONE: TRAORI, tool direction as A3= B3= C3=, CYCLE832",
    family: "siemens-840d",
    assumptions: &[
        "{transformation} is the transformation of the machine file: its points, its directions, its sense of the rotary axes",
        "ORIAXES and ORICURVE act as words (MD21104 ORI_IPO_WITH_G_CODE = 1)",
        "TRAORI takes the tool length of D1, which is that of the head; other lengths, wear and sum offset of D1 are 0",
        "{work-offset} is the part origin with the rotary axes at 0, and has no turns and no rotary offsets",
        "no other frame acts: base frames, external offset, DRF and system frames (CYCLE800, TCARR, TOROT, PAROT) are 0",
        "with SUPA and D0, X Y Z count from the machine datum of the machine file, Z at the gauge line",
        "G0 moves all axes together (RTLION), with ORIAXES as at feed",
        "CYCLE832 keeps its tolerances, also in G0 (MD20560 G0_TOLERANCE_FACTOR = 1); nothing else smooths",
        "F is the speed of the tip: no rotary axis is in FGROUP; feed override is 100 % at most, no dry run",
        "the first feed waits for the spindle (MD35500 SPIND_ON_SPEED_AT_IPO_START); M6 leaves Z at the retract height",
    ],
    form: writer::FORM,
    splines: Some(SplineForm::Poly),
    no_subprograms: None,
    offsets: Some(&reader::OFFSETS),
};

/// The dialect.
pub(super) struct Siemens840d;

impl Post for Siemens840d {
    fn dialect(&self) -> &'static Dialect {
        &DIALECT
    }

    fn check_motion(&self, program: &Program, motion: &Motion, sink: &mut Sink) {
        writer::check(program, motion, sink);
    }

    fn moves(&self, program: &Program, operation: &MotionOperation, _smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::moves(program, operation, write);
    }

    fn subprograms(&self, program: &Program, divided: &Divided<'_>, _smoothing: &str, write: &mut WriteBlock<'_>) {
        writer::subprograms(program, divided, write);
    }

    fn sections(&self, text: &str, machine: &Machine, offset: &str) -> ReadResult {
        reader::read(text, machine, offset)
    }

    fn recognises(&self, code: &str) -> bool {
        reader::recognises(code)
    }
}
