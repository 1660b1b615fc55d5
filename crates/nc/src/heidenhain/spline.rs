//! The block SPL of the iTNC 530: a cubic for each axis, with a parameter that runs from 1 to 0.
//!
//! First the ends of all axes, then three coefficients for each of them in the same order, K3, K2, K1. A coefficient has at
//! most one digit before the point and eight behind it; larger ones have an exponent. The last words are F and M.

use super::straight::{self, PLACES, Places, decimal};
use crate::control::spline::SplineWords;
use crate::control::{MotionWord, NcBlock, shown};
use five_axis::Machine;

/// Digits of a coefficient before and behind the point.
const COEFFICIENT: Places = Places { before: 1, behind: 8 };

/// Largest exponent that is read: no machine is larger.
const MAX_EXPONENT: i32 = 5;

/// Reads the words after SPL. `m128`: the program switches tool centre point control by M128, as the iTNC 530 does.
pub(super) fn block(words: &[&str], m128: bool, machine: &Machine) -> Result<NcBlock, String> {
    if !m128 {
        return Err(
            "SPL with FUNCTION TCPM: the manual of the TNC 640 has no SPL, and the iTNC 530 has M128".to_owned()
        );
    }
    if let Some(axis) = machine.rotary.iter().find(|axis| axis.modulo.is_some()) {
        return Err(format!("SPL with axis {}, which is modulo 360 deg, is not read: write L", axis.name));
    }
    let names: Vec<&str> =
        ["X", "Y", "Z"].into_iter().chain(machine.rotary.iter().map(|axis| axis.name.as_str())).collect();
    let mut rest = words;
    let mut values = [[0.0; 4]; 5];
    for (name, value) in names.iter().zip(&mut values) {
        let word = next(&mut rest)?;
        let text = word.strip_prefix(name).ok_or_else(|| {
            format!("`{}` instead of the end of {name}: SPL needs {} in this order", shown(word, 40), names.join(" "))
        })?;
        value[0] = decimal(text, PLACES).map_err(|why| format!("`{}`: {why}", shown(word, 40)))?;
    }
    for (name, value) in names.iter().zip(&mut values) {
        for (place, power) in [3, 2, 1].into_iter().enumerate() {
            let word = next(&mut rest)?;
            let text = word.strip_prefix(&format!("K{power}{name}")).ok_or_else(|| {
                format!(
                    "`{}` instead of K{power}{name}: each axis needs K3, K2 and K1, also where they are 0",
                    shown(word, 40)
                )
            })?;
            value[place + 1] = coefficient(text, &mut rest).map_err(|why| format!("`{}`: {why}", shown(word, 40)))?;
        }
    }
    let [x, y, z, first, second] = values;
    let mut block = NcBlock { motion: Some(MotionWord::Feed), ..NcBlock::default() };
    let mut rotary = [first, second];
    for (axis, values) in machine.rotary.iter().zip(&mut rotary) {
        within(&axis.name, values, [axis.min, axis.max].map(|x| x.to_degrees() * axis.word_sign))?;
        *values = values.map(|degrees| degrees.to_radians() * axis.word_sign);
    }
    block.spline = Some(Box::new(SplineWords::Backward { tip: [x, y, z], rotary }));
    for word in rest {
        let text = word.strip_prefix('F').ok_or_else(|| format!("`{}` in SPL is not understood", shown(word, 40)))?;
        let value = straight::feed(text)?;
        if block.feed.is_some() {
            return Err("`F` occurs twice in one block".to_owned());
        }
        block.set_feed(value)?;
    }
    Ok(block)
}

fn next<'a>(rest: &mut &[&'a str]) -> Result<&'a str, String> {
    let (word, behind) = rest.split_first().ok_or("SPL ends before all its coefficients")?;
    *rest = behind;
    Ok(word)
}

/// Reports an end beyond the travel of a rotary axis, degrees as in the word.
fn within(name: &str, values: &[f64; 4], travel: [f64; 2]) -> Result<(), String> {
    let (least, most) = (travel[0].min(travel[1]), travel[0].max(travel[1]));
    if values[0] < least - 1e-4 || values[0] > most + 1e-4 {
        return Err(format!(
            "{name} = {} deg is out of range: the travel of the axis is {least} to {most} deg",
            values[0]
        ));
    }
    Ok(())
}

/// A coefficient; its exponent may stand behind a blank.
fn coefficient(text: &str, rest: &mut &[&str]) -> Result<f64, String> {
    let (mantissa, exponent) = match text.split_once('E') {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => match rest.split_first() {
            Some((word, behind)) if word.starts_with('E') => {
                *rest = behind;
                (text, Some(&word[1..]))
            }
            _ => (text, None),
        },
    };
    let mantissa = decimal(mantissa, COEFFICIENT)?;
    let Some(exponent) = exponent else { return Ok(mantissa) };
    let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    let plain = (1..=3).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    let value: i32 =
        if plain { exponent.parse().map_err(|_| "not an exponent")? } else { return Err("not an exponent".to_owned()) };
    if value.abs() > MAX_EXPONENT {
        return Err(format!("an exponent of {value}: at most {MAX_EXPONENT}"));
    }
    Ok(mantissa * 10f64.powi(value))
}
