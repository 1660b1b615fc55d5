//! `impellerc` compiles a short text job that declares an impeller into verified five-axis NC.
//!
//! ```text
//! text -> ast -> Job -> ir::Program -> CcPlan -> ClPlan -> Motion -> Verified<Motion> -> NcProgram -> text
//! ```
//!
//! Each arrow reads the value on its left and makes the value on its right; nothing flows back. See `ARCHITECTURE.md`.
//!
//! Without the feature `cli` the library uses no disk, clock or terminal and starts no threads of its own. Text and
//! files come through [`job::Files`]; [`base::progress::Progress`] shows the progress of a run, and cancels planning:
//!
//! ```
//! use impellerc::base::{progress::Progress, source::SourceMap};
//! use impellerc::{diagnostics::Sink, job, lower, nc, nc_text, plan::passes::pipeline, syntax, verify};
//!
//! let text = include_str!("../jobs/small/small.imp");
//! let curves = include_str!("../jobs/small/vane_curves.csv");
//! let mut files = job::InMemory::default();
//! files.curves.insert("vane_curves.csv".to_owned(), curves.to_owned());
//!
//! let (mut sources, mut sink, progress) = (SourceMap::default(), Sink::default(), Progress::default());
//! let source = sources.add("small.imp", text);
//! let ast = syntax::parse(text, source, &mut sink);
//! // With faults in the text this value holds the part that can be understood; the faults are in the sink.
//! let partial = job::understand(&ast, &mut files, &mut sources, &mut sink);
//! let job = partial.job().expect("a text without faults");
//! let program = lower::lower(&job, &mut sink).expect("surfaces");
//! let plan = pipeline::run_with(&program, &progress, &mut sink).expect("paths");
//! let (motion, certificate) = verify::verify(&program, plan.motion, &mut sink).expect("a motion that holds");
//! assert!(certificate.contracts.iter().all(|c| c.holds));
//! let nc = nc_text::write(nc::find("siemens-840d").expect("a post"), &program, &motion, &[]);
//! assert!(nc.text().contains("TRAORI"));
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking"))]

pub use {
    axes, base, blade, blade_files, diagnostics, five_axis, ir, job, lower, nc, nurbs, plan, quotation, report, syntax,
    tool_stock, verify, wheel,
};

#[cfg(feature = "cli")]
pub mod driver;
pub mod nc_text;
#[cfg(feature = "cli")]
pub mod output;
