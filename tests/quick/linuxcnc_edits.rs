//! Edits around words, modes and tool changes of programs for LinuxCNC: our reader accepts nothing that the interpreter
//! refuses, and means what it means. `tests/quick/linuxcnc_interpreter.rs` says where the interpreter comes from.

use super::linuxcnc_interpreter::{LinuxCnc, machine};
use impellerc::five_axis::Machine;
use impellerc::nc::{self, Direction, NcMove, NcPlace, NcRetract, NcSection};
use nalgebra::Vector3;
use serde_json::Value;
use std::collections::BTreeMap;

/// Two operations, as the shipped post file writes them, cut to some blocks.
const INLINE: &str = "\
(short)
(groove: a restart point)
M429
G21 G17 G90 G40 G49 G80 G94 G97 G8 G54
G92.1
G10 L2 P1 R0
G64 P0.0010 Q0
G53 G0 Z650.0000
T1 M6
S12000 M3
G53 G0 A-80.58562 C-46.10454
G53 G0 X3.8266 Y48.9625
G43 H1
M8
M428
G61.1 G93 G1 X16.3902 Y-10.4598 Z2.7917 A-80.58562 C-46.10454 F56.22555
G64 P0.0010 Q0
G94 G1 X12.5143 Y-6.7305 Z1.8999 A-80.58562 C-46.10454 F1000.000
G1 X12.0176 Y-7.3639 Z1.3266 A-77.90822 C-45.57179 F150.000
G1 X10.9701 Y-8.6968 Z0.2777 A-72.75841 C-43.42020
G61.1 G1 X9.1812 Y-11.0557 Z-2.3884 A-59.08819 C-43.12785 F149.999
G93 G1 X8.2945 Y-30.3212 Z7.2855 A-59.08819 C-43.12785 F40.5
G64 P0.0010 Q0
G94
M429
G49
G53 G0 Z650.0000
M9
M5
(flank: a restart point)
M429
G21 G17 G90 G40 G49 G80 G94 G97 G8 G54
G92.1
G10 L2 P1 R0
G64 P0.0010 Q0
G53 G0 Z650.0000
T2 M6
S11000 M3
G53 G0 A-68.78480 C-25.44009
G53 G0 X2.5356 Y44.0277
G43 H2
M8
M428
G1 X8.3018 Y-11.5493 Z2.6613 A-68.78480 C-25.44009 F1000.000
G1 X5.1368 Y-12.8637 Z0.2851 A-68.78480 C-25.44009 F250.000
G1 X-2.6929 Y-29.4677 Z-12.5290 A-4.61178 C160.63085
M429
G49
G53 G0 Z650.0000
M9
M5
M2
";

/// One operation with a subprogram, numbered blocks, between percent signs.
const CALLED: &str = "\
%
(short)
N10 M429
N20 G21 G17 G90 G40 G49 G80 G94 G97 G8 G54
N30 G92.1
N40 G10 L2 P1 R0
N50 G64 P0.0010 Q0
N60 G53 G0 Z650.0000
N70 T1 M6
N80 S12000 M3
N90 G53 G0 A-80.58562 C-46.10454
N100 G53 G0 X3.8266 Y48.9625
N110 G43 H1
N120 M8
N130 M428
N140 G1 X12.5143 Y-6.7305 Z1.8999 A-80.58562 C-46.10454 F1000.000
(o101: the same in 3 places)
o101 sub
N150 G1 X12.0176 Y-7.3639 Z1.3266 A[-77.90822*#2] C[-45.57179+#1] F150.000
N160 G1 X11.9 Y-7.2 Z1.3 A[-77.9*#2] C[-45.5+#1]
o101 endsub
o101 call [0] [1]
N170 G10 L2 P1 R45
o101 call [-45] [1]
N180 G10 L2 P1 R0
N190 G1 X8.2945 Y-30.3212 Z7.2855 A-8.93444 C-28.73749 F1000.000
N200 M429
N210 G49
N220 G53 G0 Z650.0000
N230 M9
N240 M5
N250 M30
%
";

/// Place of the part in the machine, mm: G54 of the interpreter.
const PART: [f64; 3] = [11.0, -7.0, 23.0];

/// Tools of the tool table, and their lengths, mm.
const TOOLS: [(u32, f64); 3] = [(1, 41.0), (2, 42.0), (3, 43.0)];

/// Texts that an edit inserts anywhere.
const PIECES: &[&str] = &[
    "(x)",
    "()",
    "( x )",
    "(",
    ")",
    "((",
    "))",
    "(x))",
    "(a(b)c)",
    ";",
    ";x",
    ";(",
    " ",
    "  ",
    "\t",
    "/",
    "//",
    "#1",
    "#",
    "##1",
    "#<x>",
    "#1=2",
    "[",
    "]",
    "[1]",
    "[#1]",
    "<",
    ">",
    "=",
    "@",
    "^",
    "$",
    "$0",
    "%",
    "*",
    "**",
    "+",
    "-",
    "--",
    "+-",
    ".",
    "..",
    ",",
    ":",
    "'",
    "\"",
    "_",
    "~",
    "&",
    "|",
    "\\",
    "!",
    "?",
    "`",
    "{",
    "}",
    "\u{e9}",
    "\u{a0}",
    "\u{2212}",
    "\u{feff}",
    "\u{b}",
    "\u{c}",
    "\r",
    "0",
    "1",
    "9",
    "00",
    "1e3",
    "e3",
    "E",
    "D1",
    "d0",
    "I1",
    "J1",
    "K1",
    "L1",
    "N5",
    "n5",
    "O5",
    "o5",
    "P1",
    "Q1",
    "R0",
    "U1",
    "V1",
    "W1",
    "B1",
    "H1",
    "T1",
    "S100",
    "F100",
    "G1",
    "M3",
    "X1",
    "abs",
    "sin[0]",
    "exists[#1]",
    "(msg,x)",
    "(MSG, x)",
    "(debug,x)",
    "(print,x)",
    "(log,x)",
    "(abort,x)",
    "(py,x)",
    ";py,x",
    "(probeopen x)",
    "(axis,show)",
    "(preview,hide)",
];

/// Words that an edit adds to a block, or writes as a block.
const WORDS: &[&str] = &[
    "G0",
    "G1",
    "G2",
    "G3",
    "G4",
    "G4 P0.1",
    "G4 P-1",
    "G5",
    "G7",
    "G8",
    "G10",
    "G10 L2 P1 R0",
    "G10 L2 P1",
    "G10 L2 P0 R0",
    "G10 L2 P1 X0",
    "G10 L20 P1 X0",
    "G10 L1 P1 Z9",
    "G17",
    "G17.1",
    "G18",
    "G19",
    "G20",
    "G21",
    "G28",
    "G28.1",
    "G30",
    "G33",
    "G38.2",
    "G40",
    "G41",
    "G41 D1",
    "G42",
    "G42.1 D1",
    "G43",
    "G43 H1",
    "G43 H2",
    "G43 H0",
    "G43 H99",
    "G43.1 Z5",
    "G43.2 H2",
    "G49",
    "G50",
    "G52 X1",
    "G53",
    "G53 G0",
    "G53 G0 Z650",
    "G53 G1 Z650 F100",
    "G54",
    "G55",
    "G59.3",
    "G54.1 P1",
    "G61",
    "G61.1",
    "G64",
    "G64 P0.001",
    "G64 P0.001 Q0",
    "G64 P0 Q0",
    "G64 P0.002 Q0.001",
    "G64 Q0",
    "G64 P-1",
    "G73",
    "G76",
    "G80",
    "G81",
    "G89",
    "G90",
    "G90.1",
    "G91",
    "G91.1",
    "G92",
    "G92 X0",
    "G92.1",
    "G92.2",
    "G92.3",
    "G93",
    "G94",
    "G95",
    "G96",
    "G96 S100",
    "G96 D100 S100",
    "G97",
    "G98",
    "G99",
    "G100",
    "G0.1",
    "G1.0",
    "G01",
    "G001",
    "G-1",
    "G+1",
    "G",
    "M0",
    "M1",
    "M2",
    "M3",
    "M03",
    "M3.0",
    "M4",
    "M5",
    "M6",
    "M7",
    "M8",
    "M9",
    "M19",
    "M30",
    "M48",
    "M49",
    "M50 P1",
    "M51",
    "M52",
    "M53",
    "M60",
    "M61 Q1",
    "M62 P0",
    "M64 P0",
    "M66 P0 L0",
    "M67 E0 Q1",
    "M68 E3 Q0",
    "M68 E3 Q1",
    "M70",
    "M72",
    "M73",
    "M98",
    "M98 P5",
    "M99",
    "M100",
    "M101 P1",
    "M110",
    "M199",
    "M200",
    "M428",
    "M429",
    "M428.0",
    "M0429",
    "M",
    "M-3",
    "T0",
    "T1",
    "T01",
    "T1.0",
    "T1.00001",
    "T2",
    "T3",
    "T99",
    "T-1",
    "T",
    "T1 M6",
    "M6 T2",
    "T0 M6",
    "H1",
    "H1.0",
    "H-1",
    "H99",
    "H",
    "D0",
    "D1",
    "S0",
    "S-1",
    "S1e3",
    "S",
    "S12000",
    "F0",
    "F-1",
    "F",
    "F100",
    "F1e9",
    "F.5",
    "X1",
    "X",
    "X--1",
    "X-+1",
    "X+-1",
    "X++1",
    "X+.5",
    "X-.5",
    "X5.",
    "X.",
    "X+",
    "X-",
    "X1.2.3",
    "X1-2",
    "X[1]",
    "X[1+1]",
    "X#1",
    "X#5220",
    "A0",
    "A-10",
    "A[-10*1]",
    "A[-10]",
    "B0",
    "C0",
    "C[0+#1]",
    "C400",
    "U0",
    "Z650",
    "Z0",
    "Y[0]",
    "P1",
    "Q1",
    "L2",
    "R0",
    "E1",
    "I0",
    "N1",
    "N",
    "#1=5",
    "#<x>=5",
    "#1",
    "o5 sub",
    "o5 endsub",
    "o5 call",
    "o5 if [1]",
    "o5 endif",
    "o5 return",
    "o101 call [0] [1]",
    "o101 call",
    "o0101 call [0] [1]",
    "o<101> call [0] [1]",
    "o<x> sub",
    "o<x> endsub",
    "o 101 call [0] [1]",
    "O101 CALL [+0] [1.]",
    "o101.0 call [0] [1]",
    "o101 call [0] [1] [2]",
    "o101 call [[0]] [1]",
    "o101 (x) call [0] [1]",
    "o(x)101 call [0] [1]",
    "o101 call (x) [0] [1]",
    "o101 call [0] [1] (x)",
    "o101 call [0] [1] ;x",
    "o101 call [0] [1] G1",
    "o",
    "o101",
    "%",
    "%%",
    " %",
    "% x",
    "%(x)",
    "(x)%",
    "/",
    "/M5",
    "/(x)",
];

/// What stands in the place of a number; `{}` is the number.
const NUMBERS: &[&str] = &[
    "+{}",
    "++{}",
    "-{}",
    "--{}",
    "+-{}",
    "-+{}",
    "{}.",
    ".{}",
    "0{}",
    "00{}",
    "{}0",
    "{}.0",
    "{}.0.0",
    "{}e0",
    "{}E3",
    "{}e",
    "[{}]",
    "[{}+0]",
    "[0+{}]",
    "[[{}]]",
    "[{}",
    "{}]",
    "#1",
    "#{}",
    "[#1]",
    "1e3",
    "",
    "-",
    "+",
    ".",
    "+.",
    "-.",
    "0x10",
    "1_000",
    "1,5",
    "{}-1",
    "{}+1",
    "- {}",
    "+ {}",
    "{} 0",
    " {}",
    "\t{}",
    "{}(x)",
    "(x){}",
    "abs[{}]",
    "inf",
    "nan",
    "{}00000000000000000000000000",
    "0.0000000000000000000000001",
    "1",
    "2",
    "3",
    "0",
    "-1",
    "99999999999",
    "{}001",
    ".5",
    "5.",
    "+.5",
    "-.5",
    "{}.00001",
    "{}.0001",
    "{}.001",
];

/// What stands before a block.
const BEGINNINGS: &[&str] = &[
    "N10 ",
    "N10",
    "n10 ",
    "N 1 0 ",
    "N010 ",
    "N10.5 ",
    "N10. ",
    "N.5 ",
    "N ",
    "N-5 ",
    "N+5 ",
    "N1 N2 ",
    "N99999 ",
    "N100000 ",
    "N99999999999 ",
    "N99999999999999999999999999 ",
    "(x)N10 ",
    "N10(x)",
    "N(x)10 ",
    "N1(x)0 ",
    "N#1 ",
    "N[5] ",
    "N10:",
    "N10,",
    "/",
    "/ ",
    " /",
    "//",
    "/N10 ",
    "N10/",
    "/0 ",
    "O5 ",
    ":5 ",
    "o5 ",
    "% ",
    "%",
    "\t",
    "  ",
    "(x)",
    "(x) ",
    ";",
    "; ",
    "\u{feff}",
    "\u{a0}",
    "G90 ",
    "M48 ",
    "G91.1 ",
    "G98 ",
];

/// Splits a block at its words.
fn words(line: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for c in line.chars() {
        match found.last_mut() {
            Some(word) if !c.is_ascii_alphabetic() => word.push(c),
            _ => found.push(c.to_string()),
        }
    }
    found
}

/// Random choices, the same in every run: SplitMix64 (Steele, Lea and Flood 2014).
struct Edits(u64);

impl Edits {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % count.max(1) as u64) as usize
    }

    fn of<'a>(&mut self, all: &[&'a str]) -> &'a str {
        all[self.below(all.len())]
    }

    /// A place between two characters.
    fn place(&mut self, text: &str) -> usize {
        let places: Vec<usize> = text.char_indices().map(|(at, _)| at).chain([text.len()]).collect();
        places[self.below(places.len())]
    }

    /// A text with one or two edits, and the name of the first.
    fn edited(&mut self, text: &str) -> (&'static str, String) {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let kind = self.edit(&mut lines);
        if self.below(4) == 0 {
            self.edit(&mut lines);
        }
        let end = if self.below(30) == 0 { "\r\n" } else { "\n" };
        let mut text = lines.join(end);
        if self.below(20) != 0 {
            text.push_str(end);
        }
        (kind, text)
    }

    fn edit(&mut self, lines: &mut Vec<String>) -> &'static str {
        let at = self.below(lines.len());
        let line = lines[at].clone();
        let mut parts = words(&line);
        let k = self.below(parts.len());
        match self.below(17) {
            0 | 1 => {
                let place = self.place(&line);
                lines[at].insert_str(place, self.of(PIECES));
                "piece in a line"
            }
            2 => {
                let place = self.place(&line);
                lines[at].insert_str(place, self.of(&["(x)", "( )", "()", "(x)(y)"]));
                "comment in a line"
            }
            3 => {
                lines[at] = match self.below(3) {
                    0 => line.to_lowercase(),
                    1 => line.chars().filter(|c| *c != ' ').collect(),
                    _ => line.chars().map(|c| format!("{c} ")).collect(),
                };
                "case and blanks"
            }
            4 if !parts.is_empty() => {
                let other = self.below(parts.len() + 1);
                parts.insert(other, parts[k].clone());
                lines[at] = parts.concat();
                "word twice"
            }
            5 | 6 => {
                let place = self.below(parts.len() + 1);
                parts.insert(place, format!(" {} ", self.of(WORDS)));
                lines[at] = parts.concat();
                "word in a block"
            }
            7 | 8 => {
                lines.insert(at, self.of(WORDS).to_owned());
                "block"
            }
            9 | 10 if !parts.is_empty() => {
                let number: String = parts[k][1..].trim().to_owned();
                let other = self.of(NUMBERS).replace("{}", &number);
                parts[k] = format!("{}{other} ", &parts[k].chars().next().unwrap());
                lines[at] = parts.concat();
                "number"
            }
            11 => {
                lines[at].insert_str(0, self.of(BEGINNINGS));
                "beginning of a block"
            }
            12 if !parts.is_empty() => {
                parts.remove(k);
                lines[at] = parts.concat();
                "word dropped"
            }
            13 => {
                let other = self.below(lines.len());
                match self.below(3) {
                    0 => _ = lines.remove(at),
                    1 => lines.insert(at, line),
                    _ => lines.swap(at, other),
                }
                "lines"
            }
            14 if at + 1 < lines.len() => {
                let next = lines.remove(at + 1);
                lines[at].push_str(&next);
                "lines joined"
            }
            15 => {
                let length = 248 + self.below(9);
                let fill = self.of(&[" ", "(", ";", "0", "\t"]);
                let rest = length.saturating_sub(line.len());
                lines[at] = match fill {
                    "(" => format!("{line}({})", "x".repeat(rest.saturating_sub(2))),
                    ";" => format!("{line};{}", "x".repeat(rest.saturating_sub(1))),
                    _ => format!("{line}{}", fill.repeat(rest)),
                };
                "long line"
            }
            16 if !parts.is_empty() => {
                let letter = (b'A' + self.below(26) as u8) as char;
                let rest: String = parts[k].chars().skip(1).collect();
                parts[k] = format!("{letter}{rest}");
                lines[at] = parts.concat();
                "another letter"
            }
            _ => {
                let place = self.place(&line);
                lines[at].truncate(place);
                "line cut"
            }
        }
    }
}

/// The machine with the part where G54 has it.
fn placed() -> Machine {
    Machine { part_origin: Vector3::from(PART), ..machine("5mc850-c-linuxcnc") }
}

/// What is wrong where the interpreter means another thing than our reader; `None` where it is the same.
fn difference(machine: &Machine, sections: &[NcSection], events: &[Value]) -> Option<String> {
    let mut meant = Meant::at_rest(machine, sections);
    for event in events {
        if let Err(why) = meant.take(event) {
            return Some(format!("{why}: {event}"));
        }
    }
    let all: usize = sections.iter().map(|s| s.moves.len()).sum();
    (meant.moves != all).then(|| format!("{} moves where our reader finds {all}", meant.moves))
}

/// The interpreter's machine while it executes.
struct Meant<'a> {
    machine: &'a Machine,
    sections: &'a [NcSection],
    section: usize,
    next: usize,
    moves: usize,
    on: bool,
    /// Machine X Y Z of the gauge line, mm, and both words, degrees, where the kinematics were switched on.
    start: Option<[f64; 5]>,
    at: [f64; 5],
    /// Target of the last call with the kinematics off.
    told: [f64; 5],
    offset: Vec<f64>,
    shifted: bool,
    turn: f64,
    length: f64,
    tool: i64,
    feed: f64,
    /// Moves of the line, whose modal state comes with the next line.
    pending: Vec<&'a NcMove>,
}

impl<'a> Meant<'a> {
    fn at_rest(machine: &'a Machine, sections: &'a [NcSection]) -> Self {
        Self {
            machine,
            sections,
            section: 0,
            next: 0,
            moves: 0,
            on: false,
            start: None,
            at: [f64::NAN; 5],
            told: [f64::NAN; 5],
            offset: Vec::new(),
            shifted: false,
            turn: 0.0,
            length: 0.0,
            tool: 0,
            feed: 0.0,
            pending: Vec::new(),
        }
    }

    fn take(&mut self, event: &Value) -> Result<(), String> {
        let number = |i: usize| event[i].as_f64().unwrap();
        match event[1].as_str().unwrap() {
            "state" => {
                let line = usize::try_from(event[0].as_u64().unwrap()).unwrap();
                self.judge_state(line, &(2..13).map(number).collect::<Vec<_>>())?;
            }
            "kinematics" => {
                self.on = number(2) == 1.0;
                if self.on {
                    self.start = Some(self.at);
                }
            }
            "offset" => self.offset = (2..9).map(number).collect(),
            "shift" => self.shifted = (2..8).any(|i| number(i) != 0.0),
            "rotation" => self.turn = number(2),
            "length" => self.length = number(2),
            "tool" => self.tool = event[2].as_i64().unwrap(),
            "dwell" => {}
            kind @ ("G0" | "G1") => {
                self.feed = number(8);
                let line = usize::try_from(event[0].as_u64().unwrap()).unwrap();
                self.moved(line, kind == "G0", [2, 3, 4, 5, 7].map(number))?;
            }
            other => return Err(format!("a call that our reader knows nothing of, {other}")),
        }
        Ok(())
    }

    fn moved(&mut self, line: usize, rapid: bool, to: [f64; 5]) -> Result<(), String> {
        let &[_, x, y, z, ..] = self.offset.as_slice() else { return Err("no work offset".to_owned()) };
        if self.on && ([x, y, z] != PART || self.shifted) {
            return Err("the work offset is another one".to_owned());
        }
        if !self.on {
            let shift = [x, y, z + self.length, 0.0, 0.0];
            for k in 0..5 {
                // Without a machine the interpreter does not count a new tool length where it waits.
                if to[k] != self.told[k] {
                    self.at[k] = to[k] + shift[k];
                }
            }
            self.told = to;
            let close = self.sections[..self.section].iter().find_map(|s| s.retract.filter(|(at, _)| *at == line));
            return match close {
                Some((_, NcRetract::Height(z))) if (z - self.at[2]).abs() > 1e-9 => {
                    Err("another retract height".to_owned())
                }
                _ if !rapid => Err("a move at feed without the kinematics".to_owned()),
                _ => Ok(()),
            };
        }
        if let Some(start) = self.start.take() {
            self.next = 0;
            self.section += 1;
            self.judge_start(start)?;
        }
        let read = self.section.checked_sub(1).and_then(|k| self.sections.get(k)?.moves.get(self.next));
        let read = read.ok_or("a move that our reader does not find")?;
        (self.next, self.moves) = (self.next + 1, self.moves + 1);
        let (sine, cosine) = self.turn.to_radians().sin_cos();
        let tip = Vector3::new(cosine * to[0] - sine * to[1], sine * to[0] + cosine * to[1], to[2]);
        let length = TOOLS.iter().find(|(n, _)| i64::from(*n) == self.tool).map_or(f64::NAN, |(_, length)| *length);
        let Direction::Rotary(rotary) = read.direction else { return Err("a vector".to_owned()) };
        let words = [0, 1].map(|k| (rotary[k] * self.machine.rotary[k].word_sign).to_degrees());
        let same = [
            ("line", line == read.line),
            ("rapid", rapid == read.rapid),
            ("tip", (read.tip.coords - tip).amax() < 1e-9),
            ("rotary axes", (words[0] - to[3]).abs().max((words[1] - to[4]).abs()) < 1e-9),
            ("tool", self.tool.to_string() == read.tool.to_string()),
            ("tool length", (self.length - length).abs() < 1e-9),
            ("feed", rapid || read.feed.is_none_or(|f| (f - self.feed).abs() < 1e-6)),
        ];
        self.pending.push(read);
        match same.iter().find(|(_, same)| !same) {
            Some((what, _)) => Err(format!("another {what}: our reader {read:?}")),
            None => Ok(()),
        }
    }

    fn judge_start(&self, at: [f64; 5]) -> Result<(), String> {
        let Some(section) = self.sections.get(self.section - 1) else { return Err("a section too many".to_owned()) };
        let NcPlace::Axes { xyz, rotary, .. } = section.start.place else { return Err("no axes".to_owned()) };
        let words = [0, 1].map(|k| (rotary[k] * self.machine.rotary[k].word_sign).to_degrees());
        let ours = [xyz.x, xyz.y, xyz.z, words[0], words[1]];
        let same = ours.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-9);
        if same { Ok(()) } else { Err(format!("the section starts at {at:?}, our reader says {ours:?}")) }
    }

    /// Modal state behind the moves of a line.
    fn judge_state(&mut self, line: usize, state: &[f64]) -> Result<(), String> {
        let &[plane, side, units, distance, feed_mode, origin, path, spindle, mist, flood, speed] = state else {
            return Err("no state".to_owned());
        };
        // Lines between may set modes without a call.
        for read in std::mem::take(&mut self.pending).into_iter().filter(|read| read.line + 1 == line) {
            let at_feed = !read.rapid;
            let exact = read.smoothing == Some(0.0);
            let same = [
                ("plane", plane == 170.0),
                ("compensation", side == 400.0),
                ("unit", units == 210.0),
                ("distance mode", distance == 900.0),
                ("feed mode", !at_feed || (feed_mode == 930.0) == read.time.is_some() && feed_mode != 950.0),
                ("work offset", origin == 540.0),
                ("path mode", !at_feed || exact == (path == 610.0 || path == 611.0)),
                ("spindle", !at_feed || spindle == 3.0),
                ("coolant", !at_feed || mist == 7.0 || flood == 8.0),
                ("spindle speed", speed == read.speed),
            ];
            if let Some((what, _)) = same.iter().find(|(_, same)| !same) {
                return Err(format!("another {what} in {read:?}"));
            }
        }
        Ok(())
    }
}

/// Edits of both texts, each with its name, the same in every run.
fn edits(count: usize) -> Vec<(&'static str, String)> {
    let mut edits = Edits(2026);
    let mut all = vec![("none", INLINE.to_owned()), ("none", CALLED.to_owned())];
    all.extend((0..count).map(|i| edits.edited(if i % 3 == 2 { CALLED } else { INLINE })));
    all
}

/// Runs edits, tells counts by kind of edit, and gives the rows that may not be.
fn campaign(linuxcnc: &LinuxCnc, count: usize) -> Vec<String> {
    let (machine, all) = (placed(), edits(count));
    let texts: Vec<&str> = all.iter().map(|(_, text)| text.as_str()).collect();
    let answers = linuxcnc.edits(&machine, &texts, &TOOLS, PART);
    assert_eq!(answers.len(), all.len());
    let reader = nc::find("linuxcnc").unwrap();
    let mut counts: BTreeMap<&str, [usize; 4]> = BTreeMap::new();
    let mut wrong = Vec::new();
    for text in [INLINE, CALLED] {
        reader.read(text, &machine).unwrap_or_else(|faults| panic!("{faults:#?}"));
    }
    for ((kind, text), answer) in all.iter().zip(&answers) {
        let ours = reader.read(text, &machine);
        let refused = answer["refused"].as_str();
        let row = &mut counts.entry(kind).or_default()[usize::from(ours.is_ok()) * 2 + usize::from(refused.is_none())];
        *row += 1;
        let why = match (&ours, refused) {
            (Ok(_), Some(why)) => Some(format!("the interpreter refuses it: {why}")),
            (Ok(sections), None) => difference(&machine, sections, answer["events"].as_array().unwrap()),
            (Err(_), _) => None,
        };
        if let Some(why) = why {
            let base = if text.contains("o101") { CALLED } else { INLINE };
            let changed: Vec<&str> = text.lines().filter(|line| !base.lines().any(|l| l == *line)).collect();
            wrong.push(format!("{kind}: {changed:?}: {why}"));
        }
    }
    println!("{:24} {:>8} {:>8} {:>8} {:>8}", "edit", "neither", "it only", "we only", "both");
    for (kind, [neither, it, we, both]) in &counts {
        println!("{kind:24} {neither:8} {it:8} {we:8} {both:8}");
    }
    let sums = (0..4).map(|k| counts.values().map(|c| c[k]).sum::<usize>()).collect::<Vec<_>>();
    println!(
        "{} edits, of which neither takes {}, it only {}, we only {}, both {}",
        all.len(),
        sums[0],
        sums[1],
        sums[2],
        sums[3]
    );
    assert!(sums[3] > count / 10 && sums[0] > count / 10, "edits that say something");
    wrong
}

#[test]
fn nothing_is_accepted_that_the_interpreter_refuses_or_means_in_another_way() {
    let Some(linuxcnc) = LinuxCnc::find() else { return };
    let wrong = campaign(&linuxcnc, count());
    assert!(wrong.is_empty(), "{} rows:\n{}", wrong.len(), wrong.join("\n"));
}

/// Number of edits: thousands where the interpreter must be there.
fn count() -> usize {
    let usual = if std::env::var_os("IMPELLERC_LINUXCNC").is_some() { 6000 } else { 600 };
    std::env::var("IMPELLERC_EDITS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}
