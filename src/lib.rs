//! `impellerc` compiles a short text job that declares an impeller into verified five-axis NC.
//!
//! ```text
//! text -> ast -> Job -> ir::Program -> CcPlan -> ClPlan -> Motion -> Verified<Motion> -> NcProgram -> text
//! ```
//!
//! Each arrow reads the value on its left and makes the one on its right; nothing flows back. Files are read only at
//! the edge. See `ARCHITECTURE.md`.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub mod analysis;
pub mod collide;
pub mod contract;
pub mod diag;
pub mod driver;
pub mod entity;
pub mod envelope;
pub mod export;
pub mod geom;
pub mod ir;
pub mod job;
pub mod kin;
pub mod lower;
pub mod method;
pub mod operation;
pub mod orient;
pub mod output;
pub mod part;
pub mod passes;
pub mod post;
pub mod progress;
pub mod source;
pub mod stock;
pub mod syntax;
pub mod units;
pub mod verify;
