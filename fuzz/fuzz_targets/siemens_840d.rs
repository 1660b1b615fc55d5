//! The reader of siemens-840d, and the motion of what it reads.

#![no_main]

use impellerc_fuzz::nc;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| nc("siemens-840d", "5mc850-c", text));
