//! `.ibl` files, and the faces and edges of their sections.

#![no_main]

use impellerc_fuzz::blades::blades;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| blades(&["a.ibl"], 1, text));
