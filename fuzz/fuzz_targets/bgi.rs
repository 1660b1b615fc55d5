//! `.bgi` files: models by angles and thicknesses, and the sections that are made of them.

#![no_main]

use impellerc_fuzz::blades::blades;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| blades(&["a.bgi"], 1, text));
