//! Seeded faults in the text, or in the tools with which the text is run.

use super::blocks::{Dialect, Station, axis, is_rapid, set, stations, word};
use impellerc::base::entity::PrimaryMap;
use impellerc::ir::{Program, ToolId};
use impellerc::tool_stock::collide::{Cutter, ToolSolid};
use nalgebra::{Point3, Rotation3, Unit, Vector3};
use std::f64::consts::PI;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    ToolLength,
    ToolRadius,
    BlockMoved,
    AxisTurned,
    BlockDropped,
    WrongTurn,
    RapidThroughVane,
    HolderTooFat,
}

pub const KINDS: [Kind; 8] = [
    Kind::ToolLength,
    Kind::ToolRadius,
    Kind::BlockMoved,
    Kind::AxisTurned,
    Kind::BlockDropped,
    Kind::WrongTurn,
    Kind::RapidThroughVane,
    Kind::HolderTooFat,
];

/// Random numbers by splitmix64: the same on every machine.
pub struct Seeded(u64);

impl Seeded {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.share() * n as f64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Every decade as often.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }

    fn sign(&mut self, positive: f64) -> f64 {
        if self.share() < positive { 1.0 } else { -1.0 }
    }

    fn direction(&mut self) -> Vector3<f64> {
        let z = self.between(-1.0, 1.0);
        let angle = self.between(-PI, PI);
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * angle.cos(), r * angle.sin(), z)
    }
}

/// A fault, ready to be verified.
pub struct Fault {
    pub kind: Kind,
    pub what: String,
    pub lines: Vec<String>,
    pub program: Program,
}

/// The text as it was written.
pub struct Original {
    pub dialect: Dialect,
    pub lines: Vec<String>,
    pub stations: Vec<Station>,
    /// Indices of stations that cut, with cuts before and behind.
    cuts: Vec<usize>,
}

impl Original {
    pub fn new(dialect: Dialect, text: &str, program: &Program) -> Self {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let stations = stations(dialect, &lines);
        let feeds: Vec<f64> = program.operations.iter().map(|(_, o)| o.feed.get()).collect();
        let mut feed = 0.0;
        let cutting: Vec<bool> = stations
            .iter()
            .map(|s| {
                feed = word(&lines[s.line - 1], "F").unwrap_or(feed);
                !s.rapid && feed <= feeds[s.operation]
            })
            .collect();
        // A block that says a feed is left alone: without it the next ones would be links.
        let says = |s: &Station| word(&lines[s.line - 1], "F").is_some();
        let cuts = (1..stations.len().saturating_sub(1))
            .filter(|i| cutting[i - 1] && cutting[*i] && cutting[i + 1] && !says(&stations[*i]))
            .collect();
        Self { dialect, lines, stations, cuts }
    }

    fn set_tip(&self, line: &mut String, tip: &Point3<f64>) {
        for (address, value) in ["X", "Y", "Z"].into_iter().zip(tip.iter()) {
            set(line, address, *value, 4);
        }
    }

    fn set_rotary(&self, line: &mut String, a: f64, c: f64) {
        match self.dialect {
            Dialect::Siemens if is_rapid(line) => {
                set(line, "A=", a.to_degrees(), 5);
                set(line, "C=", c.to_degrees(), 5);
            }
            Dialect::Siemens => {
                for (address, value) in ["A3=", "B3=", "C3="].into_iter().zip(axis(a, c).iter()) {
                    set(line, address, *value, 8);
                }
            }
            Dialect::LinuxCnc => {
                set(line, "A", -a.to_degrees(), 5);
                set(line, "C", -c.to_degrees(), 5);
            }
        }
    }

    fn rapid_block(&self, tip: &Point3<f64>, a: f64, c: f64) -> String {
        let mut line = match self.dialect {
            Dialect::Siemens => "G0 X0 Y0 Z0 A=0 C=0".to_owned(),
            Dialect::LinuxCnc => "G0 X0 Y0 Z0 A0 C0".to_owned(),
        };
        self.set_tip(&mut line, tip);
        self.set_rotary(&mut line, a, c);
        line
    }

    /// Puts a fault in.
    pub fn fault(&self, kind: Kind, program: &Program, random: &mut Seeded) -> Fault {
        let mut fault = Fault { kind, what: String::new(), lines: self.lines.clone(), program: program.clone() };
        match kind {
            Kind::ToolLength => {
                let tool = self.any_tool(program, random);
                let longer = random.sign(0.9) * random.scale(1e-3, 1.0);
                for s in self.stations.iter().filter(|s| tool_of(program, s.operation) == tool) {
                    self.set_tip(&mut fault.lines[s.line - 1], &(s.tip - axis(s.a, s.c) * longer));
                }
                fault.what = format!("{} longer by {longer:.4} mm", program.tools[tool].name);
            }
            Kind::ToolRadius => {
                let tool = self.any_tool(program, random);
                let wider = random.sign(0.9) * random.scale(5e-4, 0.2);
                let change = |solid: &mut ToolSolid| {
                    let radius = solid.cutter.nominal_radius() + wider;
                    solid.cutter = match solid.cutter.keyword() {
                        "ball" => Cutter::ball(radius),
                        "flat" => Cutter::flat(radius),
                        _ => panic!("another cutter"),
                    };
                    for section in &mut solid.shank {
                        section.radius_from += wider;
                        section.radius_to += wider;
                    }
                };
                fault.program = with_tool(program, tool, change);
                fault.what = format!("radius of {} larger by {wider:.4} mm", program.tools[tool].name);
            }
            Kind::BlockMoved => {
                let s = self.any_cut(random);
                let by = random.direction() * random.scale(3e-3, 3.0);
                self.set_tip(&mut fault.lines[s.line - 1], &(s.tip + by));
                fault.what = format!("line {} moved by {:.4} mm", s.line, by.norm());
            }
            Kind::AxisTurned => {
                let from = self.cuts[random.below(self.cuts.len())];
                let count = 1 + random.below(5);
                let angle = random.scale(1e-3, 0.3);
                let way = random.direction();
                for s in self.cuts.iter().filter(|i| (from..from + count).contains(*i)).map(|i| &self.stations[*i]) {
                    let v = axis(s.a, s.c);
                    let about = Unit::new_normalize(v.cross(&way));
                    let turned = Rotation3::from_axis_angle(&about, angle) * v;
                    let (a, c) = near_position(&turned, s);
                    self.set_rotary(&mut fault.lines[s.line - 1], a, c);
                }
                let line = self.stations[from].line;
                fault.what = format!("axis turned by {:.4} deg from line {line}", angle.to_degrees());
            }
            Kind::BlockDropped => {
                let from = self.cuts[random.below(self.cuts.len())];
                let count = 2 + random.below(11);
                let dropped: Vec<usize> = self
                    .cuts
                    .iter()
                    .filter(|i| (from..from + count).contains(*i))
                    .map(|i| self.stations[*i].line)
                    .collect();
                for line in dropped.iter().rev() {
                    fault.lines.remove(line - 1);
                }
                fault.what = format!("{} blocks from line {} dropped", dropped.len(), dropped[0]);
            }
            Kind::WrongTurn => {
                // Either while cutting or in a rapid far off.
                // LinuxCNC's rapids say their time, in which no axis makes a turn more: that is a fault of speed.
                let cutting = random.share() < 0.7 || self.dialect == Dialect::LinuxCnc;
                let rapids: Vec<&Station> = self.stations.iter().filter(|s| s.rapid && !s.first).collect();
                let s = if cutting { self.any_cut(random) } else { *rapids[random.below(rapids.len())] };
                // A whole turn too far, or the other tilt that has the same direction.
                let (a, c, how) = if random.share() < 0.5 {
                    (s.a, s.c + 2.0 * PI * random.sign(0.5), "a whole turn")
                } else {
                    (-s.a, s.c - PI * s.c.signum(), "the other tilt")
                };
                let line = &mut fault.lines[s.line - 1];
                if self.dialect == Dialect::Siemens {
                    // A vector has no turns: the block says its rotary positions.
                    *line = self.rapid_block(&s.tip, a, c);
                } else {
                    self.set_rotary(line, a, c);
                }
                fault.what = format!("line {}: {how}", s.line);
            }
            Kind::RapidThroughVane => {
                let inside = |s: &&Station| {
                    s.operation > 0
                        && program.part.shroud.distance(&s.tip) < -1.0
                        && (8.0..22.0).contains(&s.tip.x.hypot(s.tip.y))
                };
                let finishing: Vec<&Station> = self.cuts.iter().map(|i| &self.stations[*i]).filter(inside).collect();
                let s = finishing[random.below(finishing.len())];
                let pitch = 2.0 * PI / f64::from(program.part.vane_count) * random.sign(0.5);
                let there = Rotation3::from_axis_angle(&Vector3::z_axis(), pitch * random.between(0.6, 1.0)) * s.tip;
                fault.lines.insert(s.line, self.rapid_block(&there, s.a, s.c));
                fault.what = format!("rapid behind line {} to {there:.3}", s.line);
            }
            Kind::HolderTooFat => {
                let tool = self.any_tool(program, random);
                let (wider, lower) = (random.scale(1.2, 5.0), random.between(6.0, 13.0));
                let change = |solid: &mut ToolSolid| {
                    for section in &mut solid.holder {
                        section.radius_from *= wider;
                        section.radius_to *= wider;
                        section.from -= lower;
                        section.to -= lower;
                    }
                    if let Some(last) = solid.shank.last_mut() {
                        last.to = (last.to - lower).max(last.from);
                    }
                };
                fault.program = with_tool(program, tool, change);
                fault.what =
                    format!("holder of {} {wider:.2} times as fat, {lower:.1} mm lower", program.tools[tool].name);
            }
        }
        fault
    }

    fn any_cut(&self, random: &mut Seeded) -> Station {
        self.stations[self.cuts[random.below(self.cuts.len())]]
    }

    /// The finishing tool four times as often.
    fn any_tool(&self, program: &Program, random: &mut Seeded) -> ToolId {
        tool_of(program, if random.share() < 0.8 { 1 } else { 0 })
    }
}

/// The program with a changed tool.
fn with_tool(program: &Program, tool: ToolId, change: impl Fn(&mut ToolSolid)) -> Program {
    let mut changed = program.clone();
    changed.tools = PrimaryMap::new();
    for (id, declared) in program.tools.iter() {
        let mut declared = declared.clone();
        if id == tool {
            change(&mut declared.solid);
        }
        changed.tools.push(declared);
    }
    changed
}

fn tool_of(program: &Program, operation: usize) -> ToolId {
    program.operations.iter().nth(operation).unwrap().1.tool
}

/// The rotary position of a direction that is nearest to that of a station.
fn near_position(v: &Vector3<f64>, s: &Station) -> (f64, f64) {
    let (tilt, turn) = (v.x.hypot(v.y).atan2(v.z), v.x.atan2(-v.y));
    let (a, c) = if s.a < 0.0 { (-tilt, turn + PI) } else { (tilt, turn) };
    (a, c + 2.0 * PI * ((s.c - c) / (2.0 * PI)).round())
}
