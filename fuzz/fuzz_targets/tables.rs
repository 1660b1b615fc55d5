//! Tables of points, and the faces and edges of their sections.

#![no_main]

use impellerc_fuzz::blades::blades;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| blades(&["main_1.csv", "main_2.csv", "hub.csv", "shroud.csv"], 4, text));
