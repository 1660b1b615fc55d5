//! Whole parts, and the fault campaign: minutes of work, which `.ci/run` does and `cargo test` leaves out.
//! `cargo test --test slow links` runs the tests of one module.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "figures of a run are shown with --nocapture")]
#![allow(unreachable_pub, reason = "modules of one test")]

#[path = "../support/mod.rs"]
mod support;

mod bounded_work;
mod campaign;
mod chosen_jobs;
mod flank;
mod golden;
mod kept_by_roughing;
mod left;
mod links;
mod orientation;
mod part_volume;
mod point;
mod quantities;
mod refused_roughing;
mod rough;
mod step_import;
mod stock;
mod symmetry;
mod tutorial;
mod wheels;
