//! STEP files: what is listed of them, and what is refused.

use super::{good, line};
use impellerc::blade_files::Options;

/// A made-up file in inches with one face.
pub fn example() -> Vec<(String, String)> {
    vec![("wheel.step".to_owned(), include_str!("../../../fuzz/corpus/step/inch").to_owned())]
}

#[test]
fn faces_are_listed() {
    let files = example();
    let files = [(files[0].0.as_str(), files[0].1.as_str())];
    let made = good(&files, 1, &Options::default());
    assert_eq!(made.listing[0], "unit of length: 25.4 mm");
    assert_eq!(made.listing.last().map(String::as_str), Some("  #22  PLANE  it's \u{fc}"));
    assert!(made.rows.is_empty());
}

/// Wherever a file is cut off, the fault is told with the line of its end.
#[test]
fn cut_files_are_told_with_their_last_line() {
    let (_, whole) = example().swap_remove(0);
    for end in (0..whole.trim_end().len()).filter(|end| whole.is_char_boundary(*end)) {
        let (code, _, at) = line(&[("wheel.step", &whole[..end])], 1, &Options::default());
        let last = whole[..end].trim_end().lines().count().max(1);
        // A word that is cut in two is no word.
        assert!(["IMP1002", "IMP1003"].contains(&code) && at == last, "{end}: {code} in line {at}, not {last}");
    }
}
