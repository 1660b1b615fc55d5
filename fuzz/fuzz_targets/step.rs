//! `.step` files: entities, units and faces.

#![no_main]

use impellerc_fuzz::blades::blades;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| blades(&["a.step"], 1, text));
