//! NC text for the campaign: lines and their tool poses, read here without the readers of the compiler.

use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    Siemens,
    LinuxCnc,
}

impl Dialect {
    pub fn name(self) -> &'static str {
        match self {
            Self::Siemens => "siemens-840d",
            Self::LinuxCnc => "linuxcnc",
        }
    }

    /// Word that switches tool centre point control on.
    fn on(self) -> &'static str {
        match self {
            Self::Siemens => "TRAORI",
            Self::LinuxCnc => "M428",
        }
    }
}

/// A pose that a line leads to. Angles in radians, ISO sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// From 1.
    pub line: usize,
    pub operation: usize,
    pub rapid: bool,
    pub tip: Point3<f64>,
    pub a: f64,
    pub c: f64,
    /// First of its operation: no way leads to it.
    pub first: bool,
}

/// Tool axis: the table turns by C about Z, then tilts by A about X.
pub fn axis(a: f64, c: f64) -> Vector3<f64> {
    Vector3::new(a.sin() * c.sin(), -a.sin() * c.cos(), a.cos())
}

/// A number behind an address such as ` X` or ` A3=`.
pub fn word(line: &str, address: &str) -> Option<f64> {
    let at = line.find(&format!(" {address}"))? + 1 + address.len();
    let rest = &line[at..];
    let end = rest.find(' ').unwrap_or(rest.len());
    rest[..end].parse().ok()
}

/// Replaces the number behind an address.
pub fn set(line: &mut String, address: &str, value: f64, decimals: usize) {
    let at = line.find(&format!(" {address}")).unwrap_or_else(|| panic!("{address} in {line}")) + 1 + address.len();
    let end = line[at..].find(' ').map_or(line.len(), |n| at + n);
    line.replace_range(at..end, &format!("{value:.decimals$}"));
}

pub fn is_move(line: &str) -> bool {
    line.contains(" X") && line.contains(" Z")
}

pub fn is_rapid(line: &str) -> bool {
    line.contains("G0 X") && is_move(line)
}

/// All stations of a text.
pub fn stations(dialect: Dialect, lines: &[String]) -> Vec<Station> {
    let mut found: Vec<Station> = Vec::new();
    let mut operation = 0;
    let mut first = false;
    let mut parked = (0.0, 0.0);
    // Ways at rapid of LinuxCNC.
    let mut inverse = false;
    let angles = |line: &str| match dialect {
        Dialect::Siemens => Some((word(line, "A=")?.to_radians(), word(line, "C=")?.to_radians())),
        // The words have the opposite of the ISO sense.
        Dialect::LinuxCnc => Some((-word(line, "A")?.to_radians(), -word(line, "C")?.to_radians())),
    };
    for (i, line) in lines.iter().enumerate() {
        inverse = line.contains("G93 ") || inverse && !line.contains("G94");
        if line.ends_with(dialect.on()) {
            operation += 1;
            first = true;
        } else if !is_move(line) {
            parked = angles(line).unwrap_or(parked);
        } else {
            let before = found.last().filter(|_| !first).map_or(parked, |s| (s.a, s.c));
            let (a, c) = angles(line).unwrap_or_else(|| {
                let [x, y, z] = ["A3=", "B3=", "C3="].map(|w| word(line, w).unwrap());
                nearest(x, y, z, before)
            });
            let [x, y, z] = ["X", "Y", "Z"].map(|w| word(line, w).unwrap());
            let tip = Point3::new(x, y, z);
            let rapid = inverse || is_rapid(line);
            found.push(Station { line: i + 1, operation: operation - 1, rapid, tip, a, c, first });
            first = false;
        }
    }
    found
}

/// The rotary position of a direction that is nearest to the last one: a tilt to either side, C with any whole turns.
fn nearest(x: f64, y: f64, z: f64, before: (f64, f64)) -> (f64, f64) {
    let tilt = x.hypot(y).atan2(z);
    let turn = x.atan2(-y);
    let candidates = (-2..=2).flat_map(|k| {
        let whole = TAU * f64::from(k);
        [(tilt, turn + whole), (-tilt, turn + PI + whole)]
    });
    let way = |p: &(f64, f64)| (p.0 - before.0).hypot(p.1 - before.1);
    candidates.min_by(|p, q| way(p).total_cmp(&way(q))).unwrap()
}
