//! The job language, from text to lowered program.

#![no_main]

use impellerc_fuzz::{SMALL, Texts, front};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = front(Texts { job: text, ..SMALL });
});
