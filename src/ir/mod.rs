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
//! | [`ClPlan`] | tip and axis at every station of the passes | ways between passes, machine | `orient-tool` to `rest-machining` | `--emit cl` |
//! | [`Motion`] | every move with its joint positions, branch and winding, feed and time | dialect | `link-moves` to `exact-stops` | `--emit motion` |
//!
//! [`validate`] asks what is said here under *invariants*: [`validate::program`], [`validate::cc`], [`validate::cl`], [`validate::motion`]. In debug
//! builds, and so in tests, the pipeline asks the validator of a value after every pass. A fault is one of the compiler
//! (IMP0910). The verifier does not rely on it: it checks the motion that it is given by itself.
//!
//! # Units and frames
//!
//! Lengths are in mm, angles in radians, times in seconds, feeds in mm/min, spindle speeds in rev/min. Points are in the
//! *part frame*: right handed, Z is the axis of rotation, the origin is the zero of the program. Sector 0 is the one that the
//! job gives; sector k is turned about Z by k pitches. Sectors and passes count from 0 here, from 1 in texts.
//!
//! # Program
//!
//! What is to be made, with what, on which machine, and what must hold. Nothing changes it after `lower`.
//!
//! - [`Program::part`] is the finished part ([`crate::part`]); [`Program::stock`] is what the lathe left.
//!   Everything between them is to be removed, but for what the job allows to stay.
//! - [`Program::operations`] are in machining order. An operation has one tool, and sectors that ascend without repetition.
//!   What it does is its [`OperationKind`], the same type as in the job.
//! - [`Program::contracts`] must hold for the whole program, or on the surfaces and operations that their scope names.
//!   A contract that the job does not give is there as a default.
//! - [`Program::machine`] is a chain of axes with the part mounted on its table. No other value knows how axes lie.
//! - Every entity has the place in the text that declared it, for diagnostics. Only texts read it.
//!
//! Invariants: operations name tools that are there; speeds and feeds are positive; sectors are those of the part; contracts
//! name operations that are there.
//!
//! # Contact plan
//!
//! Where each pass runs on what drives the tool, before the tool has an axis. All of it lies in sector 0: the part looks the
//! same from every sector, so that one is planned, and its cutter locations are copied to the others.
//!
//! - A [`CcOperation`] has the passes of one operation in a sector, in cutting order, and notes for people.
//! - A [`CcPass`] is a curve on its [`Drive`]. Its stations are as dense as the passes after it need; thinning comes later.
//!   The first and the last stations are on the leads, outside of the part.
//! - A [`CcPoint`] is a place on the drive: of the cutter contact on a face, a fillet, an edge or the hub, of the tip in
//!   a channel. Its normal points out of the material. Its parameters say where it is on the drive, so that later passes
//!   need not look for it.
//! - [`CcPass::path`] is there for flank passes that were found as a whole path of the axis.
//!
//! Invariants: the operations of the program, each once and in order; a pass lies on a drive that its
//! kind makes, and has at least two points; normals have the length one, but on
//! leads of a flank pass that was found as a whole: the cutter touches nothing there, and the normal is zero.
//!
//! # Location plan
//!
//! Where the tool is. It has two steps, see [`validate::ClStage`]:
//!
//! 1. *Oriented.* Each [`ClPass`] has a [`ClPoint`] a station: the tip, the axis from the tip to the holder, and the contact
//!    where there is one. `avoid-collision` and `smooth-axis` change axes, and with them tips, so that the cutter goes on
//!    touching its contact. `sample-to-tolerance` takes stations out.
//! 2. *In sectors.* `copy-sectors` copies the passes to every sector of their operation; `rest-machining` takes out what
//!    cuts nothing there.
//!
//! Invariants: axes have the length one; passes lie in sector 0, and from the second step on in sectors of their operation.
//!
//! # Motion
//!
//! What the axes do. It is the last value before the text, the only one that the verifier judges, and the value from which
//! each post writes.
//!
//! **What a move means.** Tool centre point control is on. Between two moves of one operation the tip, in the part frame,
//! runs on the straight line from its place before to its place after. Both rotary axes turn evenly with it: all of them are
//! at the same share of their way at the same share of the line. The linear joints follow from both. A move of
//! which the tip rests is a turn about the tip.
//!
//! A control departs from this motion by its own tolerance of blending and by its following error.
//! [`crate::kin::interpolation`] and the model of the control bound the blending, and the certificate says by how much.
//!
//! **Kinds.** [`MoveKind::Cut`] touches material or may touch it. [`MoveKind::Link`] is at the link feed: along the tool axis
//! into the channel and out of it, and from pass to pass. [`MoveKind::Rapid`] is in air, with all axes as fast as they
//! can together.
//!
//! **Begin and end.** The first move of an operation leads to a station at the retract height of the machine, where
//! the gauge line is as high as the machine file says, over the first place of the operation. From there the tool goes down
//! along Z. The last move goes up to such a station. Between operations, at that height, tool centre point control is off,
//! and X, Y and the rotary axes move from wherever they stand. So nothing in an operation depends on what was before it.
//!
//! **Branch and winding.** A direction of the tool has two pairs of angles, and each angle has turns of 360 deg.
//! `link-moves` chooses them. A pass with its approach and retract keeps one choice; it changes only on the way over the
//! clearance sphere. The joints are in the ISO sense of the axes; a post turns them into the sense of the words.
//!
//! **Feeds and times.** [`JointMove::feed`] is that of the tip along the part, rounded down as the text will have it. It is
//! never over the process feed, and no axis runs faster than it can at it, at any place of the move. [`JointMove::time`] is
//! the length by the feed; a rapid has the time of its slowest axis. What speeding up and slowing down adds is simulated by the
//! verifier and stands in the certificate.
//!
//! **Stops.** [`JointMove::stop`] says that the control comes to rest at the end of the move. Posts for controls that must be
//! told write it.
//!
//! Invariants: the operations of the program, each once and in order; every joint and time is finite; a move has a feed
//! exactly if it is no rapid; a move belongs to a pass or leads to it, and the passes are cut in their order; the first and the last move of an operation are rapids at retract height; every move has the
//! label of its pass.
//!
//! # Where other things are
//!
//! Motions that are read from NC text ([`crate::post`]) are values of the same type, with the same meaning, and may be malformed
//! in any way; the verifier refuses those that are. A [`crate::verify::Verified`] motion is one that the verifier accepted:
//! nothing else makes one, and posts take nothing else.

pub mod cc;
pub mod cl;
pub mod motion;
pub mod print;
pub mod program;
pub mod validate;

pub use cc::{CcOperation, CcPass, CcPlan, CcPoint, Drive};
pub use cl::{ClOperation, ClPass, ClPlan, ClPoint};
pub use motion::{JointMove, Motion, MotionOperation, MoveKind};
pub use program::{
    Allowed, Contract, ContractKind, DataCurve, DataPoint, Operation, OperationId, OperationKind, PostChoice, Program,
    Tolerances, Tool, ToolId,
};
