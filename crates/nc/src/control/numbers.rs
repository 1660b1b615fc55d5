//! Numbers of words, exactly as they are written, and texts as messages show them.

/// Longest number, in characters.
pub(crate) const LONGEST_NUMBER: usize = 24;

/// Longest text of a number that [`short`] reads: sixteen digits, or fifteen and a point.
const LONGEST_SHORT: usize = 16;

/// Largest whole number up to which all whole numbers are `f64`.
const LARGEST_WHOLE: u64 = 1 << 53;

/// The powers of ten of as many decimals as a short number can have, all exact.
const POWERS: [f64; LONGEST_SHORT + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16];

/// A plain decimal number.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    short(text.as_bytes()).map_or_else(|| long(text), Ok)
}

/// A number of few digits; `None` for all other texts. Its digits as a whole number and the power of ten are both exact, so
/// that the quotient is rounded once: it is the `f64` nearest to the decimal number, which `str::parse` gives as well.
fn short(text: &[u8]) -> Option<f64> {
    let (negative, digits) = match text {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.len() > LONGEST_SHORT {
        return None;
    }
    let (mut whole, mut behind) = (0_u64, None);
    for (at, byte) in digits.iter().enumerate() {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            whole = 10 * whole + u64::from(digit);
        } else if *byte == b'.' && behind.is_none() {
            behind = Some(digits.len() - at - 1);
        } else {
            return None;
        }
    }
    if digits.len() == usize::from(behind.is_some()) || whole > LARGEST_WHOLE {
        return None;
    }
    let value = whole as f64 / POWERS[behind.unwrap_or(0)];
    Some(if negative { -value } else { value })
}

/// A number of any length that a word can have, or what is wrong with it.
fn long(text: &str) -> Result<f64, String> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let plain = digits.bytes().all(|b| b.is_ascii_digit() || b == b'.')
        && digits.bytes().any(|b| b.is_ascii_digit())
        && digits.bytes().filter(|b| *b == b'.').count() <= 1
        && text.len() <= LONGEST_NUMBER;
    let value = if plain { text.parse().ok() } else { None };
    value.filter(|x: &f64| x.is_finite()).ok_or_else(|| match text {
        "" => "a number is missing".to_owned(),
        _ => format!("`{}` is not a number", shown(text, LONGEST_NUMBER)),
    })
}

/// The first characters of a text as a message shows them. Characters that look like another one, or are invisible, are
/// shown by their number.
pub(crate) fn shown(text: &str, most: usize) -> String {
    let plain =
        |c: char| if c.is_ascii_graphic() || c == ' ' { c.to_string() } else { format!("<U+{:04X}>", u32::from(c)) };
    text.chars().take(most).map(plain).collect()
}

/// A figure in a message, without trailing zeros.
pub(crate) fn figure(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Bit for bit, with signs of zeros.
        #[test]
        fn a_number_is_that_of_the_standard_library(text in "[-+]?[0-9]{0,17}(\\.[0-9]{0,17})?") {
            let due = long(&text).map(f64::to_bits);
            prop_assert_eq!(number(&text).map(f64::to_bits), due);
        }

        #[test]
        fn a_text_that_is_no_number_is_refused_as_before(text in "[-+0-9.,E ]{0,6}") {
            prop_assert_eq!(number(&text), long(&text));
        }
    }

    #[test]
    fn the_borders_of_short_numbers() {
        for text in [
            "9007199254740992",
            "9007199254740993",
            "9999999999999999",
            ".1234567890123456",
            "-0",
            "-0.000",
            "1.",
            ".5",
        ] {
            assert_eq!(number(text).map(f64::to_bits), long(text).map(f64::to_bits), "{text}");
        }
        for text in ["", ".", "-", "+.", "1.2.3", "1e5", "١"] {
            assert!(short(text.as_bytes()).is_none() && number(text).is_err(), "{text}");
        }
    }
}
