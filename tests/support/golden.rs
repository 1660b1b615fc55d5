//! Goldens of the shipped jobs: the text form of every stage, the certificate, the NC text. `golden/errors` belongs to
//! `tests/quick/errors.rs`.

use impellerc::ir::{Motion, Program};
use impellerc::nc;
use std::path::Path;

/// Snapshots by folder.
pub const GOLDENS: &[(&str, &[&str])] = &[
    (
        "reduced",
        &[
            "ast",
            "job",
            "ir",
            "cc",
            "cl",
            "motion",
            "certificate",
            "summary",
            "siemens-840d",
            "linuxcnc",
            "heidenhain",
            "fanuc",
            "mitsubishi",
            "apt-cl",
            "bytes",
        ],
    ),
    ("splitter", &["job", "ir"]),
    ("blisk", &["job", "ir"]),
    ("import", &["IMP1001", "IMP1002", "IMP1003", "IMP1004", "IMP1005", "IMP1006", "IMP1007", "IMP1008", "IMP1009"]),
    ("point", &["ir", "plan", "certificate", "siemens-840d", "linuxcnc"]),
    // For LinuxCNC, `.ci/run` compiles the whole job, and the interpreter of LinuxCNC reads it.
    ("wei2021", &["ir", "plan", "certificate", "siemens-840d"]),
    // Quirks of controls.
    (
        "posts",
        &[
            "block-numbers.fanuc",
            "block-numbers.heidenhain",
            "block-numbers.mitsubishi",
            "c-across-180.siemens-840d",
            "cutters.apt-cl",
            "digits.fanuc",
            "feed-of-m128.heidenhain",
            "frame-at-switch.fanuc",
            "frame-of-switch.siemens-840d",
            "incremental.heidenhain",
            "inverse-time.linuxcnc",
            "length-order.fanuc",
            "line-length.apt-cl",
            "line-length.siemens-840d",
            "machine-frame.heidenhain",
            "missing-point.fanuc",
            "missing-point.mitsubishi",
            "movnrb.apt-cl",
            "negative-zero.heidenhain",
            "numbers.linuxcnc",
            "omitted-components.siemens-840d",
            "polynomials.siemens-840d",
            "program-name.heidenhain",
            "program-number.fanuc",
            "program-number.mitsubishi",
            "rapid-counts-once.apt-cl",
            "rapid-in-its-block.heidenhain",
            "rotary-tolerance.heidenhain",
            "sectors.linuxcnc",
            "sectors.siemens-840d",
            "settings-of-tcpm.heidenhain",
            "shorter-way.heidenhain",
            "sign.heidenhain",
            "speed-alone.heidenhain",
            "spl-chained-by-rounded-words.heidenhain",
            "splines.linuxcnc",
            "stations.apt-cl",
            "vector-components.heidenhain",
            "vector-components.fanuc",
        ],
    ),
];

/// Compares a text with its golden.
pub fn check(job: &str, name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(Path::new("../../golden").join(job));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// NC text without the header, which contains the hash of the inputs.
pub fn nc((program, motion): (&Program, &Motion), post: &dyn nc::Post) -> String {
    nc::emit(post, &super::with_post(post.name(), program), motion, &[]).text()
}

/// Properties that a text snapshot does not show.
pub fn bytes(name: &str, text: &str) -> String {
    assert!(text.is_ascii() && text.ends_with('\n') && !text.ends_with("\n\n") && !text.contains('\r'), "{name}");
    format!("{name}: {} bytes, {} lines, blake3 {}\n", text.len(), text.lines().count(), blake3::hash(text.as_bytes()))
}
