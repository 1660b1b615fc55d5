//! Stage values of the compilation, from the [`Program`] that the job was lowered to up to the machine [`Motion`].
//!
//! *Lower between types, improve within a type*: each stage reads the value before it and the immutable
//! [`Program`] and makes the next. Lengths are in mm, angles in radians, points in the part frame: right handed,
//! Z is the axis of rotation, the origin is the program zero.
//!
//! | value | holds | does not hold yet |
//! |---|---|---|
//! | [`Program`] | geometry, tools, stock, operations in order, contracts, machine | paths |
//! | [`CcPlan`] | contact or drive points of each pass | tool axis |
//! | [`ClPlan`] | tip and axis of every move, links, feeds | machine |
//! | [`Motion`] | joint positions, branch and winding chosen, feeds and times | dialect |

pub mod cc;
pub mod cl;
pub mod motion;
pub mod print;
pub mod program;

pub use cc::{CcOperation, CcPass, CcPlan, CcPoint, Drive};
pub use cl::{ClMove, ClOperation, ClPass, ClPlan, ClPoint, MoveKind};
pub use motion::{JointMove, Motion, MotionOperation};
pub use program::{
    Allowed, Contract, ContractKind, DataCurve, DataPoint, Operation, OperationId, OperationKind, PostChoice, Program,
    Tolerances, Tool, ToolId,
};
