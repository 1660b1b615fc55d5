//! From the moves of an operation to blocks.

use super::Siemens840d;
use crate::dialect::WriteBlock;
use crate::divided::{Divided, degrees, frame_degrees};
use crate::form::{ModuloForm, NumberForm, TextForm};
use crate::modulo;
use crate::words::{self, fixed};
use crate::write::{self, FeedWord};
use diagnostics::Sink;
use five_axis::TurnCurve;
use five_axis::control::ModuloWay;
use ir::repeats::MoveInterval;
use ir::{JointMove, Motion, MotionOperation, MoveKind, Program, SplineBlock};
use nalgebra::{SVector, Vector3};
use nurbs::bezier;
use std::ops::Range;
use wheel::control::Orientation;

/// Refuses a motion that the dialect cannot express.
pub(super) fn check(program: &Program, motion: &Motion, sink: &mut Sink) {
    words::check_vectors(program, motion, sink);
    modulo::check_way(program, motion, |axis| axis.modulo.is_some(), sink);
}

/// Text of the dialect.
pub(super) const FORM: TextForm = TextForm {
    comment: ["; ", ""],
    rotary: "=",
    // DC() goes the shorter way, whatever machine data say of plain words (programming manual, "Absolute dimension for
    // rotary axes (DC, ACP, ACN)").
    modulo: Ok(ModuloForm {
        ways: &[ModuloWay::Shortest, ModuloWay::Direct],
        about: ["DC(", ")"],
        assumed: "DC() takes values from 0 to 360 deg and goes the shorter way",
    }),
    numbers: NumberForm { prefix: "N", largest: u64::MAX, always: false, comments: false, without: &["%"] },
    continued: "",
    longest: 512,
};

/// Digits of coefficients behind the point: five coefficients are rounded by less than a thousandth of the step of a length.
const COEFFICIENT_DECIMALS: usize = 8;

/// Writes the blocks of the moves of an operation.
pub(super) fn moves(program: &Program, operation: &MotionOperation, write: &mut WriteBlock<'_>) {
    write_interval(program, operation, 1..operation.moves.len().saturating_sub(1), ParameterWords::Fixed, write);
}

/// R parameters that the rotary words of a repeated part count with: shift of axis 2, degrees, and sign of axis 1.
const PARAMETERS: [&str; 2] = ["R90", "R91"];

/// How blocks state the rotary axes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ParameterWords {
    /// Positions.
    Fixed,
    /// Positions that count with [`PARAMETERS`].
    OfParameters,
}

/// Writes the blocks of some moves.
fn write_interval(
    program: &Program,
    operation: &MotionOperation,
    range: Range<usize>,
    words: ParameterWords,
    write: &mut WriteBlock<'_>,
) {
    let post = &Siemens840d;
    let rotary = |m: &JointMove| match words {
        ParameterWords::Fixed => write::rotary(post, program, m.joints.rotary),
        ParameterWords::OfParameters => {
            let [first, second] = write::rotary_numbers(post, program, m.joints.rotary);
            let [.., a, b] = program.machine.names();
            format!("{a}={first}*{} {b}={second}+{}", PARAMETERS[1], PARAMETERS[0])
        }
    };
    let mut feed = FeedWord::new(fixed);
    let mut spline_before = false;
    for i in range {
        let m = &operation.moves[i];
        if let Some((at, spline)) = operation.spline(i) {
            if i > spline.first {
                continue;
            }
            let goes_on = spline_before && at > 0 && operation.splines[at - 1].last + 1 == i;
            if !goes_on {
                feed.forget();
            }
            let word = feed.word(program, m);
            if goes_on {
                write(format!("{}{word}", polynomials(program, spline)), Some(i));
            } else {
                // The second point begins where this block says, since blocks before have none. No axis moves.
                write("ORICURVE".to_owned(), None);
                write(format!("G1 {}{word}", start(program, spline)), None);
                write(format!("POLY {}", polynomials(program, spline)), Some(i));
            }
            spline_before = true;
            continue;
        }
        if std::mem::take(&mut spline_before) {
            write("G1 ORIAXES".to_owned(), None);
        }
        let tip = write::tip(post, program, &m.joints);
        let text = match m.kind {
            MoveKind::Rapid => {
                feed.forget();
                format!("G0 {tip} {}", rotary(m))
            }
            MoveKind::Link | MoveKind::Cut => {
                let direction = match program.post.control.orientation {
                    Orientation::Vectors => write::vector(post, program, &m.joints, ["A3=", "B3=", "C3="]),
                    Orientation::Angles => rotary(m),
                };
                format!("G1 {tip} {direction}{}", feed.word(program, m))
            }
        };
        write(text, Some(i));
    }
    if spline_before {
        write("G1 ORIAXES".to_owned(), None);
    }
}

/// Words of the start of a spline: tip and second point.
fn start(program: &Program, spline: &SplineBlock) -> String {
    let digits = program.post.control.decimals.length;
    let names = ["X", "Y", "Z", "XH=", "YH=", "ZH="];
    let places = both(spline)[0];
    names.iter().zip(&places).map(|(name, x)| format!("{name}{}", fixed(*x, digits))).collect::<Vec<_>>().join(" ")
}

/// Control points of tip and second point, six numbers each.
fn both(spline: &SplineBlock) -> Vec<SVector<f64, 6>> {
    let TurnCurve::Second(second) = spline.curve.turn() else { return Vec::new() };
    let six = |(p, h): (&Vector3<f64>, &Vector3<f64>)| SVector::from_column_slice(&[p.x, p.y, p.z, h.x, h.y, h.z]);
    spline.curve.tip().iter().zip(second).map(six).collect()
}

/// Words of the polynomials: the end and the coefficients from the second power on. The control takes the linear term from
/// start and end. Zeros at the end are left out.
fn polynomials(program: &Program, spline: &SplineBlock) -> String {
    let control = both(spline);
    let powers = bezier::powers(&control);
    let names = ["X", "Y", "Z", "XH", "YH", "ZH"];
    let words = names.iter().enumerate().map(|(k, name)| {
        let mut numbers: Vec<String> = powers.iter().skip(2).map(|a| fixed(a[k], COEFFICIENT_DECIMALS)).collect();
        while numbers.last().is_some_and(|n| n.bytes().all(|b| matches!(b, b'0' | b'.' | b'-'))) {
            numbers.pop();
        }
        numbers.insert(0, fixed(control[control.len() - 1][k], program.post.control.decimals.length));
        format!("PO[{name}]=({})", numbers.join(","))
    });
    words.collect::<Vec<_>>().join(" ")
}

/// Writes the blocks of an operation, and each subprogram once, between two labels. The other places repeat it.
///
/// With the transformation on, a turn of the work frame turns X, Y and, with ORIWKS, vectors of the tool. It turns no rotary
/// words: these count with R parameters, which the text sets before each place. So nothing of it acts after an abort: each
/// operation takes the frame back at its start.
pub(super) fn subprograms(program: &Program, divided: &Divided<'_>, write: &mut WriteBlock<'_>) {
    let operation = divided.operation;
    let mut frame = 0;
    let mut turn_frame = |pitches: u32, write: &mut WriteBlock<'_>| {
        if pitches != frame {
            let turn = if pitches == 0 { String::new() } else { format!(" Z{}", frame_degrees(program, pitches)) };
            write(format!("ROT{turn}"), None);
            frame = pitches;
        }
    };
    let mut parameters = String::new();
    let mut written = 0;
    for MoveInterval { moves, repeats } in &divided.division.intervals {
        let Some((subprogram, turned)) = repeats else {
            turn_frame(0, write);
            write_interval(program, operation, moves.clone(), ParameterWords::Fixed, write);
            continue;
        };
        turn_frame(turned.pitches, write);
        let turns = program.post.control.orientation == Orientation::Angles
            || operation.moves[moves.clone()].iter().any(|m| m.kind == MoveKind::Rapid);
        if turns {
            let shift = degrees(turned.second.to_degrees() * program.machine.rotary[1].word_sign);
            let set = format!("{}={shift} {}={}", PARAMETERS[0], PARAMETERS[1], degrees(turned.first));
            if set != parameters {
                write(set.clone(), None);
                parameters = set;
            }
        }
        let name = divided.number(*subprogram);
        if *subprogram == written {
            let places = divided.division.places(*subprogram).count();
            write(format!("; subprogram {name}: the same in {places} places"), None);
            write(format!("SUB_{name}_BEGIN:"), None);
            write_interval(program, operation, moves.clone(), ParameterWords::OfParameters, write);
            write(format!("SUB_{name}_END:"), None);
            written += 1;
        } else {
            write(format!("REPEAT SUB_{name}_BEGIN SUB_{name}_END P=1"), None);
        }
    }
    turn_frame(0, write);
}
