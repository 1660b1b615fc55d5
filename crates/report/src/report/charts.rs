//! Pictures that need no script: bars of the active limits, and histograms of the arc of engagement.

use super::Input;
use crate::markup::escaped;
use crate::proof::machine::{LimitRow, limit_rows};
use crate::table::{Figure, Form, Table, figures, words};
use base::units::Mm;
use std::fmt::Write as _;
use verify::stock::ArcTimes;
use verify::stock::arcs::CLASS_WIDTH;
use wheel::contract::{ContractKind, clock};

/// Share of a bar in percent from which a part has its name in it.
const MIN_NAMED_PERCENT: f64 = 12.0;

/// Width and height of the area of a histogram, and its margins: left, top, bottom; pixels.
const AREA: [f64; 2] = [260.0, 110.0];
const MARGIN: [f64; 3] = [54.0, 20.0, 34.0];

/// Gap between the bar of air and the classes of arcs, pixels.
const AIR_BAR_GAP: f64 = 12.0;

/// A bar for the cuts, links and rapids of each operation and for the whole program, and the same in figures.
pub(super) fn limits(input: &Input<'_>) -> String {
    let names = input.program.machine.names();
    let rows = limit_rows(input.certificate);
    let mut columns: Vec<&str> = Vec::new();
    for (limit, _) in rows.iter().flat_map(|r| &r.limits) {
        if !columns.contains(&limit.as_str()) {
            columns.push(limit);
        }
    }
    columns.sort_by_key(|limit| order(limit, names));
    let mut out = String::from("<div class=bars>\n");
    for row in &rows {
        // Writing to a string cannot fail.
        let _ = write_bar(&mut out, row, names);
    }
    out.push_str("</div>\n<ul class=legend>");
    for limit in &columns {
        let _ = write!(out, "<li><i style=\"background:{}\"></i>{}</li>", colour(limit, names).0, escaped(limit));
    }
    out.push_str("</ul>\n");
    type Row<'a> = &'a LimitRow<'a>;
    let mut shown = vec![
        words("operation", 0, |row: &Row| row.operation.to_owned()),
        words("moves", 0, |row: &Row| row.moves.to_owned()),
        figures("time", 0, Form::WHOLE, |row: &Row| clock(row.time)),
    ];
    shown.extend(columns.iter().map(|limit| {
        let share = |row: &Row| row.limits.iter().find(|l| l.0 == *limit).map(|l| l.1 / row.time);
        figures((*limit).to_owned(), 0, Form::PER_HUNDRED, move |row: &Row| Figure::or(share(row), ""))
    }));
    out.push_str(&Table::new("Active limits, % of the time", &rows, shown).page());
    out
}

/// What belongs to no axis first, then the axes.
fn order(limit: &str, names: [&str; 5]) -> (usize, usize) {
    const FIXED: [&str; 7] = ["process feed", "link feed", "rapid speed", "removal", "block feed", "rest", "corners"];
    if let Some(place) = FIXED.iter().position(|f| *f == limit) {
        return (0, place);
    }
    let (axis, of) = limit.split_once(' ').unwrap_or((limit, ""));
    let place = |list: &[&str], word: &str| list.iter().position(|l| *l == word).unwrap_or_default();
    (1 + place(&names, axis), place(&TONES, of))
}

fn write_bar(out: &mut String, row: &LimitRow, names: [&str; 5]) -> std::fmt::Result {
    let (name, time) = (escaped(row.operation), clock(row.time));
    write!(out, "<span>{name}</span><span>{}</span><span class=n>{time}</span><div class=bar>", row.moves)?;
    for (limit, share) in row.shares() {
        let text = escaped(&format!("{limit} {share:.1} %"));
        let shown = if share >= MIN_NAMED_PERCENT { text.as_str() } else { "" };
        let (colour, ink) = colour(&limit, names);
        write!(out, "<span style=\"flex:{share:.2};background:{colour};color:{ink}\" title=\"{text}\">{shown}</span>")?;
    }
    out.push_str("</div>\n");
    Ok(())
}

/// What limits the motion of an axis, in the order of [`AXIS_COLOURS`].
const TONES: [&str; 3] = ["speed", "acceleration", "jerk"];

/// Colours of the axes, as in the plots over time, dark, medium and light: speed, acceleration, jerk.
const AXIS_COLOURS: [[&str; 3]; 5] = [
    ["#8f2f0a", "#d9480f", "#f5a07c"],
    ["#1c5a26", "#2b8a3e", "#8ccf9a"],
    ["#104a80", "#1971c2", "#85bdf0"],
    ["#861a40", "#c2255c", "#eb94b1"],
    ["#4a30a0", "#7048e8", "#b9a5f7"],
];

/// Colours of a limit and of the text on it.
pub(super) fn colour(limit: &str, names: [&str; 5]) -> (&'static str, &'static str) {
    let (axis, of) = limit.split_once(' ').unwrap_or((limit, ""));
    let tone = TONES.iter().position(|t| *t == of);
    match (names.iter().position(|n| *n == axis), tone) {
        (Some(axis), Some(tone)) => (AXIS_COLOURS[axis][tone], if tone == 2 { "#111" } else { "#fff" }),
        _ => match limit {
            "corners" => ("#495057", "#fff"),
            "removal" => ("#5c3d1e", "#fff"),
            "block feed" => ("#868e96", "#fff"),
            "rest" | "others" => ("#ced4da", "#111"),
            "link feed" => ("#f1dca7", "#111"),
            "rapid speed" => ("#f6ebcf", "#111"),
            _ => ("#e9c46a", "#111"),
        },
    }
}

/// A histogram for each operation; empty where the stock was not simulated.
pub(super) fn arcs(input: &Input<'_>) -> String {
    let Some(stock) = &input.certificate.stock else { return String::new() };
    let mut out = String::from("<h2>Arc of engagement</h2>\n<div class=histograms>\n");
    for o in &stock.operations {
        // Writing to a string cannot fail.
        let _ = write_histogram(&mut out, &o.name, &o.arcs, bound(input, o.operation as usize));
    }
    out.push_str("</div>\n");
    out
}

/// The least bound of the engagement in an operation, degrees.
fn bound(input: &Input<'_>, operation: usize) -> Option<f64> {
    let id = input.motion.operations.get(operation)?.operation;
    let covers = |scope: &wheel::contract::Scope<_>| scope.operations.is_empty() || scope.operations.contains(&id);
    let program = input.program;
    let limits = |kind| matches!(kind, ContractKind::Engagement(_));
    if program.allowed.iter().any(|a| limits(a.kind) && covers(&a.scope)) {
        return None;
    }
    let contracts = program.contracts.iter().filter(|c| limits(c.kind) && covers(&c.scope));
    contracts.map(|c| c.bound.value()).min_by(f64::total_cmp)
}

fn write_histogram(out: &mut String, name: &str, arcs: &ArcTimes, bound: Option<f64>) -> std::fmt::Result {
    let [width, height] = AREA;
    let [left, top, bottom] = MARGIN;
    let (floor, column) = (top + height, width / 180.0 * CLASS_WIDTH);
    let start = left + column + AIR_BAR_GAP;
    let x = |arc: f64| start + arc / CLASS_WIDTH * column;
    let (cutting, air) = (arcs.cutting().get(), arcs.air.time.get());
    let most = arcs.time.iter().map(|time| time.get()).fold(air, f64::max).max(f64::MIN_POSITIVE);
    let (whole, size) = (cutting + air, [x(180.0) + 22.0, floor + bottom]);
    write!(
        out,
        "<figure><figcaption>{}: cutting {}, air {}</figcaption><svg viewBox=\"0 0 {} {}\" width=\"{}\" role=img \
         aria-label=\"time at feed over the arc of engagement\">",
        escaped(name),
        clock(cutting),
        clock(air),
        size[0],
        size[1],
        size[0]
    )?;
    let mut bar = |at: f64, time: f64, path: Mm, class: &str, what: &str| {
        let high = height * time / most;
        let share = if whole > 0.0 { 100.0 * time / whole } else { 0.0 };
        write!(
            out,
            "<rect class={class} x=\"{at:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{high:.1}\"><title>{what}: {}, {share:.1} %, \
             {:.0} mm</title></rect>",
            floor - high,
            column - 1.0,
            clock(time),
            path.get()
        )
    };
    bar(left, air, arcs.air.path, "air", "air")?;
    for (k, (time, path)) in arcs.time.iter().zip(arcs.path).enumerate() {
        let (from, to) = (k as f64 * CLASS_WIDTH, (k + 1) as f64 * CLASS_WIDTH);
        // A class that begins at the bound lies beyond it.
        let class = if bound.is_some_and(|b| from >= b) { "beyond" } else { "arc" };
        bar(x(from), time.get(), path, class, &format!("{from:.0} to {to:.0} deg"))?;
    }
    write!(out, "<path d=\"M{left} {floor}H{:.1}\"/>", x(180.0))?;
    write!(out, "<text x=\"{:.1}\" y=\"{}\" text-anchor=middle>air</text>", left + 0.5 * column, floor + 14.0)?;
    for arc in [0.0, 45.0, 90.0, 135.0, 180.0] {
        write!(out, "<text x=\"{:.1}\" y=\"{}\" text-anchor=middle>{arc:.0}</text>", x(arc), floor + 14.0)?;
    }
    write!(out, "<text x=\"{:.1}\" y=\"{}\" text-anchor=middle>arc, deg</text>", x(90.0), floor + 29.0)?;
    write!(out, "<text x=\"{}\" y=\"{}\" text-anchor=end>{}</text>", left - 6.0, top + 9.0, clock(most))?;
    write!(out, "<text x=\"{}\" y=\"{}\" text-anchor=end>0</text>", left - 6.0, floor)?;
    if let Some(bound) = bound {
        write!(out, "<path class=bound d=\"M{0:.1} {1}V{floor}\"/>", x(bound), top - 4.0)?;
        write!(
            out,
            "<text class=bound x=\"{:.1}\" y=\"{}\" text-anchor=middle>at most {bound:.0}</text>",
            x(bound),
            top - 8.0
        )?;
    }
    out.push_str("</svg></figure>\n");
    Ok(())
}
