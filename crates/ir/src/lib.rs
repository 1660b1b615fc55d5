//! Stage values of the compilation, from the [`Program`] that the job was lowered to up to the machine [`Motion`].
//!
//! *Lower between types, improve within a type*: each stage reads the value before it and the immutable [`Program`] and
//! makes the next. A value refers to another by an id or an index, never by a reference, so that it can be printed,
//! compared and kept.
//!
//! | value | holds | does not hold yet | made by | text form |
//! |---|---|---|---|---|
//! | [`Program`] | geometry, tools, stock, operations in order, contracts, machine | paths | `lower` | `--emit ir` |
//! | [`CcPlan`] | contact or drive points of each pass | tool axis | `plan-*` | `--emit cc` |
//! | [`ClPlan`] | tip and axis at every station | links, machine | `orient-tool` to `rest-machining` | `--emit cl` |
//! | [`Motion`] | moves: joints, branch, winding, feed, time | dialect | `link-moves` to `exact-stops` | `--emit motion` |
//!
//! [`validate`] checks the statements under *invariants*: [`validate::program`], [`validate::cc`], [`validate::cl`],
//! [`validate::motion`]. In debug builds, and so in tests, the pipeline runs the validator of a value after every pass.
//! A failed check is a fault of the compiler (IMP0910). The verifier does not rely on the validators: it checks the
//! motion by itself.
//!
//! # Units and frames
//!
//! Lengths are in mm, angles in radians, times in seconds, feeds in mm/min, spindle speeds in rev/min; the text form
//! ([`mod@print`]) has angles in degrees. Points are in
//! the *part frame*: right handed, Z is the axis of rotation, the origin is the zero of the program. The job gives
//! sector 0; sector k is turned about Z by k pitches. Sectors and passes count from 0 here, from 1 in texts.
//!
//! # Program
//!
//! What is to be made, with what, on which machine, and what must hold. Nothing changes it after `lower`.
//!
//! - [`Program::part`] is the finished part ([`wheel::part`]); [`Program::stock`] is the blank that the lathe made.
//!   Everything between them is removed, except what the job allows to stay.
//! - [`Program::operations`] are in machining order. An operation has one tool, and sectors in ascending order without
//!   repetition. Its [`OperationKind`] says what it does; this is the same type as in the job.
//! - [`Program::contracts`] must hold for the whole program, or on the surfaces and operations that their scope names.
//!   A contract that the job does not give is present as a default.
//! - [`Program::machine`] is a chain of axes with the part mounted on its table. No other value holds the positions of
//!   axes.
//! - Every entity has its place in the text of the job, for diagnostics. Only messages use it.
//!
//! Invariants: operations name tools that exist; speeds and feeds are positive; sectors are those of the part;
//! contracts name operations that exist.
//!
//! # Contact plan
//!
//! The course of each pass on the surface that drives the tool, before the tool has an axis. All passes lie in sector
//! 0: the part is the same in every sector, so one sector is planned, and its cutter locations are copied to the
//! others.
//!
//! - A [`CcOperation`] has the passes of one operation in a sector, in cutting order, and notes for people.
//! - A [`CcPass`] is a curve on its [`Drive`]. Its stations are as dense as the later passes of the pipeline need;
//!   stations are removed later. The first and the last stations are on the leads, outside of the part.
//! - A [`CcPoint`] is a place on the drive: the cutter contact on a face, a fillet, an edge or the hub, or the tip in a
//!   channel. Its normal points out of the material. Its parameters give its position on the drive, so that later
//!   passes of the pipeline need not search for it.
//! - [`CcPass::path`] exists for flank passes that were computed as a whole path of the axis.
//!
//! Invariants: the operations of the program, each once and in order; a pass lies on a drive of a kind that its
//! operation makes, and has at least two points; normals have length one. Exceptions are the leads of a flank pass that
//! was computed as a whole path: the cutter touches nothing there, and the normal is zero.
//!
//! # Location plan
//!
//! The positions of the tool. The plan has two steps, see [`validate::ClStage`]:
//!
//! 1. *Oriented.* Each [`ClPass`] has a [`ClPoint`] per station: the tip, the axis from the tip to the holder, and the
//!    contact where one exists. `avoid-collision` and `smooth-axis` change axes; they move the tips too, so that the
//!    cutter keeps touching its contact. `sample-to-tolerance` removes stations.
//! 2. *In sectors.* `copy-sectors` copies the passes to every sector of their operation; `rest-machining` removes the
//!    parts that cut nothing there.
//!
//! Invariants: axes have length one; passes lie in sector 0, and from the second step on in sectors of their operation.
//!
//! # Motion
//!
//! The motion of the axes. It is the last value before the text. The verifier judges only this value, and each post
//! writes from it.
//!
//! **Meaning of a move.** Tool centre point control is on. Between two moves of one operation the tip, in the part
//! frame, runs on the straight line from its start to its end. Both rotary axes turn evenly with it: when the tip has
//! covered a share of the line, each rotary axis has covered the same share of its turn. The linear joints follow from
//! both. A move in which the tip rests is a turn about the tip.
//!
//! A control departs from this motion by its tolerance of blending and by its following error.
//! [`five_axis::interpolation`] and the model of the control bound the blending, and the certificate states the bound.
//!
//! **Spline blocks.** A [`SplineBlock`] is what the control interpolates as polynomials: the tip, and the direction by both
//! rotary axes or by a second point of the tool axis. Its moves are chords, so that all that counts with moves counts with
//! them; no point of the tool up to the upper end of its flutes leaves its chord by more than 0.1 um. The verifier measures
//! this by itself and adds it to what it finds. Posts write the polynomials.
//!
//! **Kinds.** [`MoveKind::Cut`] touches material or may touch it. [`MoveKind::Link`] is at the link feed: along the
//! tool axis into the channel and out of it, and from pass to pass. [`MoveKind::Rapid`] is in air, as fast as all axes
//! together allow.
//!
//! **Begin and end.** The first move of an operation leads to a station at the retract height of the machine, above the
//! first place of the operation; the machine file gives this height of the gauge line. From there the tool goes down
//! along Z. The last move goes up to such a station. Between operations tool centre point control is off, and at that
//! height X, Y and the rotary axes move from their present positions. So nothing in an operation depends on what came
//! before.
//!
//! **Branch and winding.** A direction of the tool has two pairs of angles, and each angle has turns of 360 deg.
//! `link-moves` chooses them. A pass with its approach and retract keeps one choice; the choice changes only on the
//! link over the clearance surface. The joints are in the ISO sense of the axes; a post converts them to the sense of
//! the words.
//!
//! **Feeds and times.** [`JointMove::feed`] is the feed of the tip along the part, rounded down as in the text. It is
//! never above the process feed, and at this feed no axis exceeds its speed at any place of the move.
//! [`JointMove::time`] is the length divided by the feed; the time of a rapid is that of its slowest axis. The verifier
//! simulates the time that acceleration and deceleration add, and the certificate states it.
//!
//! **Stops.** [`JointMove::stop`] says that the control comes to rest at the end of the move. Posts write it for
//! controls that need such a command.
//!
//! Invariants: the operations of the program, each once and in order; every joint and time is finite; a move has a feed
//! exactly if it is no rapid; a move belongs to a pass or leads to it, and the passes are cut in their order; the first
//! and the last move of an operation are rapids at retract height; every move has the label of its pass.
//!
//! # Where other things are
//!
//! A motion that is read from NC text (`nc`) is a value of the same type with the same meaning, but can be
//! malformed in any way; the verifier refuses malformed motions. A `verify::Verified` motion is a motion that
//! the verifier has accepted: only the verifier makes one, and posts accept no other.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

mod asked;
pub mod cc;
pub mod cl;
pub mod motion;
pub mod print;
pub mod program;
pub mod repeats;
pub mod stage_file;
pub mod validate;

pub use cc::{CcOperation, CcPass, CcPlan, CcPoint, Drive};
pub use cl::{ClOperation, ClPass, ClPlan, ClPoint};
pub use motion::{JointMove, Motion, MotionOperation, MoveKind, SplineBlock};
pub use program::{
    Allowances, Allowed, Contract, ContractKind, DataCurve, DataPoint, Operation, OperationId, OperationKind, Program,
    RoughingStrategy, StatedPoints, Tolerances, Tool, ToolId,
};
