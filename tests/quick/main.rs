//! Tests that find faults quickly, a module for each subject. `cargo test` runs all of them;
//! `cargo test --test quick errors` runs the tests of one module. They are one program, so that the library is linked
//! only once after an edit.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "figures of a run are shown with --nocapture")]
#![allow(unreachable_pub, reason = "modules of one test")]

#[path = "../support/mod.rs"]
mod support;

mod angles;
mod bad_cl;
mod bad_input;
mod bad_nc;
mod bull_noses;
mod carried;
mod certificate;
mod channel_floor;
mod chosen_jobs;
mod circles;
mod command_line;
mod contracts;
mod cost;
mod curves_and_calls;
mod documents;
mod engagement;
mod envelope;
mod error_formats;
mod errors;
mod facts;
mod faults;
mod feeds;
mod finite;
mod front;
mod geom_oracles;
mod golden;
mod import;
mod job_format;
mod kept;
mod language;
mod language_service;
mod larger_balls;
mod layering;
mod leads;
mod left;
mod levels;
mod library_schema;
mod link_rate;
mod linuxcnc_edits;
mod linuxcnc_impeller;
mod linuxcnc_interpreter;
mod machine_motion;
mod machines;
mod messages;
mod milling;
mod mistaken_commands;
mod mutations;
mod nc_diff;
mod orientation_engines;
mod outputs;
mod part_axis;
mod parts;
mod perimeter;
mod planning;
mod platform;
mod plunge;
mod post_files;
mod posts;
mod printed_jobs;
mod progress;
mod quirks;
mod quotes;
mod ramp;
mod refused_roughing;
mod removal;
mod report;
mod report_page;
mod rest_machining;
mod rough;
mod section_files;
mod sections;
mod sector_subprograms;
mod solids;
mod splines;
mod stage_files;
mod stl;
mod stock_links;
mod stock_program;
mod summary;
mod surface_truths;
mod symmetry;
mod thickness;
mod trochoid;
mod turned_stock;
mod validators;
mod varied_fillets;
mod verify_command;
mod vocabulary;
