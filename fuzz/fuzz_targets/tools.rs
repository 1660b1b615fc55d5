//! Tool files, in a job that takes its tools from them.

#![no_main]

use impellerc_fuzz::{SMALL, Texts, front};
use libfuzzer_sys::fuzz_target;

/// Takes two tools of the library and a holder of it.
const JOB: &str = include_str!("../tools.imp");

fuzz_target!(|text: &str| {
    let _ = front(Texts { tools: Some(text), job: JOB, ..SMALL });
});
