//! What the motion takes of the machine: axes, runs, active limits, and what the tools come near to.

use super::Text;
use crate::table::{Form, Table, figures, words};
use base::units::{Sec, Share, length};
use ir::{Motion, Program};
use std::collections::BTreeMap;
use verify::Certificate;
use verify::certificate::OperationReport;
use verify::dynamics::{ActiveLimit, MotionLimit, Run};
use verify::machine::{Axes, AxisRange, OtherRules};
use verify::obstacles::SEARCH_DISTANCE;
use verify::place::describe;
use wheel::contract::clock;

/// An axis with its positions in its unit.
struct AxisRow<'a> {
    axis: &'a str,
    unit: &'static str,
    used: [f64; 2],
    travel: Option<[f64; 2]>,
    speed: Share,
    acceleration: Share,
    jerk: Share,
}

impl<'a> AxisRow<'a> {
    fn new<Q: Copy + Into<f64>>(range: &'a AxisRange<Q>, unit: &'static str) -> Self {
        Self {
            axis: &range.axis,
            unit,
            used: range.used.map(Into::into),
            travel: range.travel.map(|travel| travel.map(Into::into)),
            speed: range.speed_share,
            acceleration: range.acceleration_share,
            jerk: range.jerk_share,
        }
    }
}

/// The share of travel, speed, acceleration and jerk that the motion takes of each axis.
pub(crate) fn axes(text: Text<'_>, certificate: &Certificate) -> Table {
    type Row<'a> = AxisRow<'a>;
    let machine = &certificate.machine;
    let Axes { linear, rotary } = &machine.axes;
    let rows = linear.iter().map(|axis| AxisRow::new(axis, "mm"));
    let rows = rows.chain(rotary.iter().map(|axis| AxisRow::new(axis, "deg")));
    let name = |r: &Row| r.axis.to_owned();
    let travel = |none: &'static str, span: fn([f64; 2]) -> String| {
        move |r: &Row| r.travel.map_or_else(|| none.to_owned(), span)
    };
    match text {
        Text::Page(_) => {
            let columns = vec![
                words("axis", 0, |r: &Row| format!("{}, {}", r.axis, r.unit)),
                figures("used", 0, Form::WHOLE, |r: &Row| format!("{:.3} .. {:.3}", r.used[0], r.used[1])),
                figures("travel", 0, Form::WHOLE, travel("no limits", |[low, high]| format!("{low:.1} .. {high:.1}"))),
                figures("largest speed, % of limit", 0, Form::PER_HUNDRED, |r: &Row| r.speed),
            ];
            let pole = Form::THOUSANDTHS.of(machine.pole_distance.get());
            Table::new(format!("Axes (least angle to the pole while cutting: {pole} deg)"), rows, columns)
        }
        Text::Sheet => {
            fn span([low, high]: [f64; 2]) -> String {
                format!("{} to {}", base::units::trim(low, 3), base::units::trim(high, 3))
            }
            let columns = vec![
                words("axis", 0, name),
                figures("used, mm or deg", 0, Form::WHOLE, |r: &Row| span(r.used)),
                figures("travel in the machine file", 0, Form::WHOLE, travel("no limit", span)),
                figures("largest speed, share of the limit", 0, Form::WHOLE_PERCENT, |r: &Row| r.speed),
            ];
            Table::new("", rows, columns)
        }
        Text::Summary | Text::Details => {
            let columns = vec![
                words("", 1, name),
                figures("", 10, Form::THOUSANDTHS, |r: &Row| r.used[0]),
                words("", 2, |_: &Row| "..".to_owned()),
                figures("", 10, Form::THOUSANDTHS, |r: &Row| r.used[1]),
                words("", 3, |r: &Row| r.unit.to_owned()),
                words("", 2, |_: &Row| "of".to_owned()).with_gap(),
                figures("", 20, Form::WHOLE, travel("no limits", |[low, high]| format!("{low:>8.1} .. {high:>8.1}"))),
                figures("", 7, Form::PERCENT, |r: &Row| r.speed).with_gap(),
                figures("", 7, Form::PERCENT, |r: &Row| r.acceleration).with_gap(),
                figures("", 7, Form::PERCENT, |r: &Row| r.jerk).with_gap(),
            ];
            let title = "axes: used, travel, of the limits: largest speed reached, acceleration asked for inside of blocks, jerk reached";
            let pole = Form::THOUSANDTHS.of(machine.pole_distance.get());
            Table::new(title, rows, columns).with([format!("least distance to the pole while cutting {pole} deg")])
        }
    }
}

/// Clearance of the tool to the stock at rapid.
pub(super) fn at_rapid(certificate: &Certificate) -> String {
    let distance = certificate.rapid.as_ref().map_or_else(|| "far".to_owned(), |c| length(c.distance.get()));
    format!("at rapid the tool stays {distance} outside of the stock")
}

/// Clearances of the tools: to the stock at rapid and between operations, to chuck, table and fixtures.
pub(super) fn surroundings(program: &Program, motion: &Motion, certificate: &Certificate) -> Vec<String> {
    let p = &certificate.perimeter;
    let [.., first, second] = program.machine.names();
    let head = program.machine.chain.has_head();
    let mut lines = vec![
        at_rapid(certificate),
        format!(
            "X, Y, {first} and {second} move without tool centre point control at Z {:.3} of the gauge line only, with every {} at least {}",
            p.retract.get(),
            if head { "point of a tool" } else { "tip" },
            length(p.clearance.get())
        ),
        format!(
            "over Z {:.3}, which the {} does not pass under any {first} and {second}; required {}",
            p.height.get(),
            p.highest,
            length(p.required.get())
        ),
    ];
    if head {
        lines.push("head and spindle above the gauge line are not checked against part and table".to_owned());
    }
    let clamping = &certificate.clamping;
    if let (Some(at), Some(distance)) = (clamping.at, clamping.distance) {
        let (space, part, distance) = (clamping.space(), &clamping.part, length(distance.get()));
        let place = describe(program, motion, Some(at));
        lines.push(format!("no tool enters the clamping ({space}): the {part} stays {distance} away: {place}"));
    }
    lines.extend(certificate.obstacles.iter().map(|c| match &c.clearance {
        Some(found) => {
            let (distance, place) = (length(found.distance.get()), describe(program, motion, Some(found.at)));
            format!("the {} comes within {distance} of the {}: {place}", c.part, c.solid)
        }
        None => format!("no tool comes within {SEARCH_DISTANCE} mm of the {}", c.solid),
    }));
    lines
}

/// The runs of the operations, and how far the control leaves the programmed motion.
pub(super) fn runs(program: &Program, certificate: &Certificate) -> Table {
    type Row<'a> = (&'a OperationReport, &'a Run, &'a OtherRules);
    let [.., first, second] = program.machine.names();
    let title = format!(
        "motion between blocks: tip straight, {first} and {second} linear, within accelerations and jerks of the axes. Slowest cutting block\n\
         as a share of its feed; time without bounds on jerks, which is no longer than any run takes, and without bounds on\n\
         accelerations; how far tip or flutes leave the motion, um: rounded corners, control cycle, both at one block, and the\n\
         axis in deg; and how far they would by great circles, and by linear joints without TCP"
    );
    let machine = &certificate.machine;
    let whole = |times: [Sec; 3]| times.into_iter().sum::<Sec>().get();
    let rows = certificate.operations.iter().zip(&machine.runs).zip(&machine.other_rules);
    let columns = vec![
        words("operation", 12, |r: &Row| r.0.name.clone()),
        figures("slowest", 9, Form::PERCENT, |r: &Row| r.1.slowest.value),
        figures("no jerk", 9, Form::WHOLE, |r: &Row| clock(whole(r.1.within_accelerations))),
        figures("unbound", 9, Form::WHOLE, |r: &Row| clock(whole(r.1.programmed))),
        figures("corners", 9, Form::UM, |r: &Row| r.1.corners.value),
        figures("cycle", 9, Form::UM, |r: &Row| r.1.cycle.value),
        figures("both", 9, Form::UM, |r: &Row| r.1.contour.value),
        figures("axis", 9, Form::FINE, |r: &Row| r.1.orientation.value),
        figures("circles", 9, Form::UM, |r: &Row| r.2.great_circle.value),
        figures("no TCP", 9, Form::UM, |r: &Row| r.2.joints_linear.value),
    ];
    Table::new(title, rows.map(|((o, run), other)| (o, run, other)), columns)
}

/// How far the control departs from the programmed motion at most, and in which operation.
pub(super) fn deviation(certificate: &Certificate, length: fn(f64) -> String, at_most: &str) -> Option<String> {
    let (most, name) = certificate.deviation()?;
    Some(format!(
        "of the programmed motion; the control departs from it by {at_most} {}, in {name}",
        length(most.get())
    ))
}

/// Kinds of moves, in the order of times.
const KINDS: [&str; 3] = ["cut", "link", "rapid"];

/// Times of an operation in one kind of moves, or of the whole program, by active limit.
pub(crate) struct LimitRow<'a> {
    /// Operation; `total` for the whole program.
    pub(crate) operation: &'a str,
    /// Kind of moves; `all` for the whole program.
    pub(crate) moves: &'static str,
    /// Whole time, s.
    pub(crate) time: f64,
    /// Limits in words with their times, s, the longest first.
    pub(crate) limits: Vec<(String, f64)>,
}

/// A limit in words, for a kind of moves: cuts, links, rapids.
pub(crate) fn limit_words(limit: &ActiveLimit, kind: usize) -> String {
    match (limit.limit, &limit.axis) {
        (MotionLimit::Feed, _) => ["process feed", "link feed", "rapid speed"][kind].to_owned(),
        (MotionLimit::Speed, Some(axis)) => format!("{axis} speed"),
        (MotionLimit::Acceleration, Some(axis)) => format!("{axis} acceleration"),
        (MotionLimit::Jerk, Some(axis)) => format!("{axis} jerk"),
        (MotionLimit::Corner, _) => "corners".to_owned(),
        (MotionLimit::Removal, _) => "removal".to_owned(),
        (MotionLimit::BlockFeed, _) => "block feed".to_owned(),
        _ => "rest".to_owned(),
    }
}

/// Rows of each operation and kind of moves that takes time, then that of the whole program.
pub(crate) fn limit_rows(certificate: &Certificate) -> Vec<LimitRow<'_>> {
    let mut rows = Vec::new();
    let mut total: BTreeMap<String, f64> = BTreeMap::new();
    let mut whole = 0.0;
    for (o, run) in certificate.operations.iter().zip(&certificate.machine.runs) {
        for (kind, moves) in KINDS.into_iter().enumerate().filter(|(kind, _)| run.time[*kind].get() > 0.0) {
            let time = run.time[kind].get();
            let own = run.limits.iter().filter(|l| l.time[kind].get() > 0.0);
            let limits: Vec<(String, f64)> = own.map(|l| (limit_words(l, kind), l.time[kind].get())).collect();
            for (limit, part) in &limits {
                *total.entry(limit.clone()).or_default() += part;
            }
            whole += time;
            rows.push(LimitRow { operation: &o.name, moves, time, limits: longest_first(limits) });
        }
    }
    let limits = longest_first(total.into_iter().collect());
    rows.push(LimitRow { operation: "total", moves: "all", time: whole, limits });
    rows
}

/// A stable sort: equal times keep their order.
fn longest_first(mut limits: Vec<(String, f64)>) -> Vec<(String, f64)> {
    limits.sort_by(|a, b| b.1.total_cmp(&a.1));
    limits
}

impl LimitRow<'_> {
    /// Shares of the time in percent, in words; limits with less than 1 % come together as others.
    pub(crate) fn shares(&self) -> Vec<(String, f64)> {
        let percent = |time: f64| 100.0 * time / self.time;
        let count = self.limits.partition_point(|l| percent(l.1) >= 1.0);
        let mut shares: Vec<(String, f64)> = self.limits[..count].iter().map(|l| (l.0.clone(), percent(l.1))).collect();
        if count < self.limits.len() {
            shares.push(("others".to_owned(), percent(self.limits[count..].iter().map(|l| l.1).sum())));
        }
        shares
    }
}

/// For each operation and for the whole program the active limits in shares of the time.
pub(super) fn limits(certificate: &Certificate) -> Table {
    let rows = limit_rows(certificate);
    let mut before = "";
    let named = rows.iter().map(|row| {
        (
            if row.operation == before {
                ""
            } else {
                before = row.operation;
                before
            },
            row,
        )
    });
    type Row<'a> = (&'a str, &'a LimitRow<'a>);
    let shares = |r: &Row| {
        let shares: Vec<String> = r.1.shares().iter().map(|(limit, share)| format!("{limit} {share:.1} %")).collect();
        shares.join(", ")
    };
    let columns = vec![
        words("", 12, |r: &Row| r.0.to_owned()),
        words("", 5, |r: &Row| r.1.moves.to_owned()),
        figures("", 8, Form::WHOLE, |r: &Row| clock(r.1.time)),
        words("", 0, shares).with_gap(),
    ];
    Table::new("active limits: what bounds the motion, in shares of the time of each kind of moves", named, columns)
}
