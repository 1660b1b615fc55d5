//! The unit of length that the head of a table of points states: `x [m]`, `y (mm)`, `# unit: m`, `# points in metres`.

use super::frame::LengthUnit;
use std::ops::Range;

/// Lines of a head that are searched. Heads of tables have fewer.
const LINES: usize = 30;

/// The unit of the head of a table and the place of the line that states it; `None` where it states none, or two.
pub fn stated(text: &str) -> Option<(LengthUnit, Range<usize>)> {
    let mut found: Option<(LengthUnit, Range<usize>)> = None;
    let mut start = 0;
    for raw in text.split_inclusive('\n').take(LINES) {
        let range = start..start + raw.trim_end().len();
        start += raw.len();
        let line = raw.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        let comment = line.starts_with(['#', '!']);
        if !comment && line.split([',', ';', '\t', ' ']).any(|field| field.parse::<f64>().is_ok()) {
            break;
        }
        for unit in bracketed(line).chain(comment.then(|| worded(line)).flatten()) {
            match &found {
                Some((known, _)) if *known != unit => return None,
                Some(_) => {}
                None => found = Some((unit, range.clone())),
            }
        }
    }
    found
}

/// A word of a column without its unit in brackets, and the unit: `x [m]`.
pub(crate) fn column(word: &str) -> (&str, Option<LengthUnit>) {
    let unit = bracketed(word).next();
    let name = if unit.is_some() { word.split(['[', '(']).next().unwrap_or(word) } else { word };
    (name.trim(), unit)
}

/// Units of length in brackets.
fn bracketed(line: &str) -> impl Iterator<Item = LengthUnit> {
    line.split(['[', '(']).skip(1).filter_map(|rest| LengthUnit::named(rest.split([']', ')']).next()?.trim()))
}

/// The unit that a comment names in words: a unit of several letters, or a word behind `in`, `unit` or `units`. A lone `m` may be
/// something else.
fn worded(line: &str) -> Option<LengthUnit> {
    let words: Vec<&str> = line.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let alone = words.len() == 1;
    words.iter().enumerate().find_map(|(k, word)| {
        let announced = k > 0 && ["in", "unit", "units"].iter().any(|w| words[k - 1].eq_ignore_ascii_case(w));
        let plain = word.len() > 1 && !["in", "ft", "foot", "feet"].contains(&word.to_ascii_lowercase().as_str());
        LengthUnit::named(word).filter(|_| alone || announced || plain)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_state_units_in_brackets_and_words() {
        let unit = |text: &str| stated(text).map(|(unit, _)| unit);
        assert_eq!(unit("# made up\n# curve,number,x [m],y [m],z [m]\na,1,0,0,0\n"), Some(LengthUnit::Metre));
        assert_eq!(unit("section,x (mm),y (mm)\n1,2,3\n"), Some(LengthUnit::Millimetre));
        assert_eq!(unit("# m\n1,2,3\n"), Some(LengthUnit::Metre));
        assert_eq!(unit("# all points in inches\n1,2,3\n"), Some(LengthUnit::Inch));
        assert_eq!(unit("# unit: m\n1,2,3\n"), Some(LengthUnit::Metre));
        assert_eq!(
            unit("# Wei et al., tables 1 and 2, mm. Z is the axis of rotation\n1,2,3\n"),
            Some(LengthUnit::Millimetre)
        );
        assert_eq!(unit("# coordinates m and theta; points run in order\n1,2,3\n"), None);
        assert_eq!(unit("# x [m], thickness [mm]\n1,2,3\n"), None);
        assert_eq!(unit("1,2,3\n# in metres\n"), None);
    }

    #[test]
    fn columns_lose_their_unit() {
        assert_eq!(column("x [m]"), ("x", Some(LengthUnit::Metre)));
        assert_eq!(column("theta (deg)"), ("theta (deg)", None));
        assert_eq!(column("R*THETA"), ("R*THETA", None));
    }
}
