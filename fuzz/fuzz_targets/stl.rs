//! STL files, as what is left of the blank in the small job.

#![no_main]

use impellerc::tool_stock::stock::{Field, stl};
use impellerc_fuzz::{SMALL, Texts, front};
use libfuzzer_sys::fuzz_target;

/// The small job from a file.
const JOB: &str = include_str!("../stl.imp");

fuzz_target!(|bytes: &[u8]| {
    let _ = front(Texts { job: JOB, mesh: bytes, ..SMALL });
    if let Ok(mesh) = stl::read(bytes) {
        let square = [[0.0, -20.0], [20.0, -20.0], [20.0, 20.0], [0.0, 20.0]];
        if let Ok(field) = Field::new(&square, Some(&mesh), 1.0) {
            assert!(field.volume() >= 0.0 && field.volume() <= 64_000.0);
        }
    }
});
