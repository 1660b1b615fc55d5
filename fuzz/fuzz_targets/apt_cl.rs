//! The reader of apt-cl, and the motion of what it reads.

#![no_main]

use impellerc_fuzz::nc;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| nc("apt-cl", "5mc850-c", text));
