//! The tables of the report; they can be read without a script.

use super::Input;
use super::markup::{TableCell, escaped, table};
use super::places::{Places, figure, proved};
use diagnostics::Severity;
use verify::clearance::Clearance;
use verify::machine::AXIS_UNITS;
use verify::stock::Peak;
use wheel::contract::clock;

/// Sum of the times of all operations, s.
pub(super) fn total_time(input: &Input<'_>) -> f64 {
    input.certificate.operations.iter().flat_map(|o| o.time).sum()
}

/// Part, machine, dialect, inputs: one line per fact.
pub(super) fn header(input: &Input<'_>) -> String {
    let certificate = input.certificate;
    let vanes = input.program.part.vane_count;
    let lines = |text: &str| format!("{} lines", text.lines().count());
    let imported = certificate.imported.as_ref().map(|imported| ("imported part", imported.told(&certificate.form)));
    let facts = [
        ("machine", certificate.machine_name.clone()),
        ("NC dialect", input.post.to_owned()),
        ("NC program", input.nc_text.map_or_else(|| "none: a fault stopped it".to_owned(), lines)),
        ("machining time", format!("{} h:mm:ss", clock(total_time(input)))),
        ("vanes", vanes.to_string()),
        ("deviations proved over", format!("cells of {} mm and less", certificate.spacing)),
    ];
    let item = |(name, value): &(&str, String)| format!("<div><dt>{name}</dt><dd>{}</dd></div>\n", escaped(value));
    facts.iter().chain(&imported).map(item).collect()
}

/// Hash of the inputs, and the compiler.
pub(super) fn inputs(input: &Input<'_>) -> String {
    let compiler = format!("impellerc {}", env!("CARGO_PKG_VERSION"));
    format!("<p>Made by {compiler} from inputs with sha256 <code>{}</code>.</p>\n", escaped(input.hash))
}

/// The verdict: all contracts hold, or the number that does not. Returns its class and its text.
pub(super) fn verdict(input: &Input<'_>) -> (&'static str, String) {
    let errors = input.findings.iter().filter(|d| d.severity == Severity::Error).count();
    let contracts = &input.certificate.contracts;
    let failed = contracts.iter().filter(|c| !c.holds).count();
    let (class, text) = judged(contracts.len(), failed, errors);
    // How much of the part was judged.
    let [made, sectors] = input.certificate.sectors();
    (class, format!("{text}; {made} of {sectors} sectors"))
}

fn judged(contracts: usize, failed: usize, errors: usize) -> (&'static str, String) {
    match (failed, errors) {
        (0, 0) if contracts == 0 => ("good", "no fault found, no contract given".to_owned()),
        (0, 0) if contracts == 1 => ("good", "the contract holds".to_owned()),
        (0, 0) => ("good", format!("all {contracts} contracts hold")),
        (0, n) => ("bad", format!("{n} faults, no NC program")),
        (n, _) => ("bad", format!("{n} of {contracts} contracts fail")),
    }
}

/// Contracts and operations.
pub(super) fn contracts(input: &Input<'_>, places: &Places) -> String {
    let certificate = input.certificate;
    let rows: Vec<Vec<TableCell>> = certificate
        .contracts
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let (class, word) = if c.holds { ("good", "holds") } else { ("bad", "FAILS") };
            let [bound, found] = [0, 1].map(|k| figure(&c.figures[k]));
            let relation = if c.relation == ">=" { "at least" } else { "at most" };
            vec![
                TableCell::words(c.name()),
                TableCell::figure(format!("{relation} {bound}")),
                TableCell::figure(proved(c.kind, &found)).place(places.contracts.get(i).copied().flatten()),
                TableCell::words(word).class(class),
            ]
        })
        .collect();
    let mut out = if rows.is_empty() {
        "<p>The job has no <code>require</code>: nothing was required.</p>".to_owned()
    } else {
        table("Contracts", &["contract", "wanted", "found", "verdict"], &rows)
    };
    let allowed: Vec<Vec<TableCell>> = certificate
        .allowed
        .iter()
        .enumerate()
        .map(|(i, a)| {
            vec![
                TableCell::words(format!("{} {}", a.kind, a.scope)),
                TableCell::figure(figure(&a.figure)).place(places.allowed.get(i).copied().flatten()),
                TableCell::words(if a.excuses { a.reason.clone() } else { format!("{} (needless)", a.reason) }),
            ]
        })
        .collect();
    if !allowed.is_empty() {
        out.push_str(&table("Knowingly left", &["allowed", "found", "reason"], &allowed));
    }
    out
}

/// Operations with their times, paths and clearances.
pub(super) fn operations(input: &Input<'_>, places: &Places) -> String {
    let program = input.program;
    let search = verify::search(program);
    let mut rows: Vec<Vec<TableCell>> = Vec::new();
    let (mut moves, mut length, mut time) = (0, [0.0; 3], [0.0; 3]);
    for (i, (o, planned)) in input.certificate.operations.iter().zip(&input.motion.operations).enumerate() {
        let declared = &program.operations[planned.operation];
        let gap = |c: &Option<Clearance>| {
            c.as_ref().map_or_else(|| format!("over {search}"), |c| format!("{:.3}", c.distance))
        };
        let place = |k: usize| places.operations.get(i).and_then(|p| p[k]);
        rows.push(vec![
            TableCell::words(o.name.as_str()),
            TableCell::words(o.tool.as_str()),
            TableCell::figure(format!("{:.0}", declared.speed.get())),
            TableCell::figure(format!("{:.0}", declared.feed.get())),
            TableCell::figure(o.passes.to_string()),
            TableCell::figure(o.moves.to_string()),
            TableCell::figure(format!("{:.2}", o.length[0] * 1e-3)),
            TableCell::figure(clock(o.time[0])),
            TableCell::figure(clock(o.time[1])),
            TableCell::figure(clock(o.time[2])),
            TableCell::figure(gap(&o.shank)).place(place(0)),
            TableCell::figure(gap(&o.holder)).place(place(1)),
        ]);
        moves += o.moves;
        for k in 0..3 {
            length[k] += o.length[k];
            time[k] += o.time[k];
        }
    }
    let empty = || TableCell::figure("");
    rows.push(vec![
        TableCell::words("total"),
        TableCell::words(""),
        empty(),
        empty(),
        empty(),
        TableCell::figure(moves.to_string()),
        TableCell::figure(format!("{:.2}", length[0] * 1e-3)),
        TableCell::figure(clock(time[0])),
        TableCell::figure(clock(time[1])),
        TableCell::figure(clock(time[2])),
        empty(),
        empty(),
    ]);
    let headings = [
        "operation",
        "tool",
        "spindle, rpm",
        "feed, mm/min",
        "passes",
        "moves",
        "cut, m",
        "time cut",
        "time link",
        "time rapid",
        "shank to part, mm",
        "holder to part, mm",
    ];
    table("Operations (times in h:mm:ss)", &headings, &rows)
}

/// Surfaces, rest, axes, tools, findings, notes.
pub(super) fn details(input: &Input<'_>, places: &Places) -> String {
    let mut out = stock(input, places);
    out.push_str(&surfaces(input, places));
    out.push_str(&rest(input, places));
    out.push_str(&axes(input));
    out.push_str(&tools(input));
    if !input.notes.is_empty() {
        let rows: Vec<Vec<TableCell>> = input
            .notes
            .iter()
            .map(|(operation, note)| vec![TableCell::words(operation.as_str()), TableCell::words(note.as_str())])
            .collect();
        out.push_str(&table("How the operations were planned", &["operation", "decision"], &rows));
    }
    out
}

/// Volume that each operation removes, and the engagement of its tool.
fn stock(input: &Input<'_>, places: &Places) -> String {
    let Some(stock) = &input.certificate.stock else { return String::new() };
    let rows: Vec<Vec<TableCell>> = stock
        .operations
        .iter()
        .enumerate()
        .map(|(i, o)| {
            let peak = |k: usize, p: &Option<Peak>, scale: f64| {
                let text = p.as_ref().map_or_else(|| "-".to_owned(), |p| format!("{:.1}", p.value * scale));
                TableCell::figure(text).place(places.stock.get(i).and_then(|p| p[k]))
            };
            vec![
                TableCell::words(o.name.as_str()),
                TableCell::figure(format!("{:.2}", o.removed * 1e-3)),
                TableCell::figure(format!("{:.2}", o.rest * 1e-3)),
                TableCell::figure(clock(o.air)),
                TableCell::figure(format!("{:.1}", o.air_share() * 100.0)),
                peak(0, &o.depth, 1.0),
                peak(1, &o.width, 1.0),
                peak(2, &o.arc, 1.0),
                peak(3, &o.rate, 60.0),
                TableCell::figure(o.collisions.len().to_string()).class(if o.collisions.is_empty() {
                    "n"
                } else {
                    "n bad"
                }),
            ]
        })
        .collect();
    let headings = [
        "operation",
        "removed, cm\u{b3}",
        "stock after it, cm\u{b3}",
        "time in air",
        "air, %",
        "largest ap (along the axis), mm",
        "largest ae (across), mm",
        "largest arc, deg",
        "largest removal, mm\u{b3}/min",
        "collisions with stock",
    ];
    let caption = format!("Stock, in cells of {} mm: blank of {:.2} cm\u{b3}", stock.cell, stock.blank * 1e-3);
    table(&caption, &headings, &rows)
}

/// The diagnostics, worst first.
pub(super) fn findings(input: &Input<'_>, places: &Places) -> String {
    let mut order: Vec<usize> = (0..input.findings.len()).collect();
    order.sort_by_key(|i| std::cmp::Reverse(input.findings[*i].severity));
    let rows: Vec<Vec<TableCell>> = order
        .into_iter()
        .map(|i| {
            let d = &input.findings[i];
            let (class, word) = match d.severity {
                Severity::Error => ("bad", "error"),
                Severity::Warning => ("warn", "warning"),
                Severity::Remark => ("", "remark"),
            };
            vec![
                TableCell::words(format!("{word} {}", d.code.id())).class(class),
                TableCell::words(d.message.as_str()),
                TableCell::words(d.place.as_ref().map_or_else(String::new, |p| p.what.clone()))
                    .place(places.findings.get(i).copied().flatten()),
                TableCell::words(d.help.clone().unwrap_or_default()),
            ]
        })
        .collect();
    if rows.is_empty() { String::new() } else { table("Findings", &["code", "what", "where", "remedy"], &rows) }
}

fn surfaces(input: &Input<'_>, places: &Places) -> String {
    let rows: Vec<Vec<TableCell>> = input
        .certificate
        .surfaces
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let place = |k: usize| places.surfaces.get(i).and_then(|p| p[k]);
            let um = |mm: f64| {
                if mm >= verify::surface::FAR { "not reached".to_owned() } else { format!("{:.2}", mm * 1e3) }
            };
            vec![
                TableCell::words(s.surface.as_str()),
                TableCell::figure(format!("{:.0}", s.area)),
                TableCell::figure(um(s.gouge.depth)).place(place(0)),
                TableCell::figure(um(s.gouge_bound)),
                TableCell::figure(um(s.excess.value.max(0.0))).place(place(1)),
                TableCell::figure(um(s.excess_bound)),
                TableCell::figure(um(s.percentiles[0])),
                TableCell::figure(um(s.percentiles[1])),
                TableCell::figure(um(s.percentiles[2])),
            ]
        })
        .collect();
    let headings = [
        "surface",
        "area, mm\u{b2}",
        "deepest cut found, \u{b5}m",
        "proved: no deeper than",
        "most left found, \u{b5}m",
        "proved: no more than",
        "5 % lie below, \u{b5}m",
        "50 % below",
        "95 % below",
    ];
    table("Surfaces: deviation of the swept cutters from the design (cut below zero, left above)", &headings, &rows)
}

fn rest(input: &Input<'_>, places: &Places) -> String {
    let rows: Vec<Vec<TableCell>> = input
        .certificate
        .rest
        .iter()
        .enumerate()
        .map(|(i, r)| {
            let name = input.certificate.operations.get(r.operation as usize).map_or("", |o| o.name.as_str());
            vec![
                TableCell::words(format!("after {name}")),
                TableCell::figure(format!("{:.3}", r.least)),
                TableCell::figure(format!("{:.3}", r.median)),
                TableCell::figure(format!("{:.3}", r.most)).place(places.rest.get(i).copied()),
                TableCell::figure(format!("{:.1}", r.cleared * 100.0)),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let headings = ["stock", "least, mm", "median, mm", "most, mm", "room cleared, %"];
    table("Stock on the surfaces after roughing", &headings, &rows)
}

fn axes(input: &Input<'_>) -> String {
    let machine = &input.certificate.machine;
    let rows: Vec<Vec<TableCell>> = machine
        .axes
        .iter()
        .zip(AXIS_UNITS)
        .map(|(a, unit)| {
            vec![
                TableCell::words(format!("{}, {unit}", a.axis)),
                TableCell::figure(format!("{:.3} .. {:.3}", a.used[0], a.used[1])),
                TableCell::figure(
                    a.travel.map_or("no limits".to_owned(), |[low, high]| format!("{low:.1} .. {high:.1}")),
                ),
                TableCell::figure(format!("{:.1}", a.speed_share * 100.0)),
            ]
        })
        .collect();
    let caption = format!("Axes (least angle to the pole while cutting: {:.3} deg)", machine.pole_distance);
    table(&caption, &["axis", "used", "travel", "largest speed, % of limit"], &rows)
}

fn tools(input: &Input<'_>) -> String {
    let rows: Vec<Vec<TableCell>> = input
        .program
        .tools
        .iter()
        .map(|(_, t)| {
            vec![
                TableCell::words(t.name.as_str()),
                TableCell::figure(t.number.to_string()),
                TableCell::words(t.solid.cutter.keyword()),
                TableCell::figure(format!("{:.3}", 2.0 * t.solid.radius())),
                TableCell::figure(t.flutes.to_string()),
                TableCell::figure(format!("{:.1}", t.solid.flute_length)),
                TableCell::figure(format!("{:.1}", t.solid.holder.first().map_or(t.solid.length(), |s| s.from))),
            ]
        })
        .collect();
    let headings = ["tool", "number", "cutter", "diameter, mm", "flutes", "flute length, mm", "reach to holder, mm"];
    table("Tools", &headings, &rows)
}
