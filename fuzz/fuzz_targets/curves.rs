//! Curve files, in the small job.

#![no_main]

use impellerc_fuzz::{SMALL, Texts, front};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = front(Texts { curves: text, ..SMALL });
});
