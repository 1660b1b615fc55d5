//! What the cutters leave on the surfaces of the part: those that are milled, those that the lathe made, the rest of roughing.

use super::alike::{Alike, alike};
use super::{NOT_REACHED, Text, coordinates, reached};
use crate::table::{Figure, Form, Table, figures, words};
use base::units::{Mm, length};
use ir::{Motion, Program};
use verify::Certificate;
use verify::allowance::AllowanceReport;
use verify::kept::KeptReport;
use verify::place::describe;
use verify::rest::RestReport;
use verify::stated_points::{ImportedReport, StatedReport};
use verify::surface::{self, FAR, SurfaceReport};

/// Surfaces with the same figures, each figure with a surface on which it is worst.
struct SurfaceRow<'a> {
    /// Number of the surface, where the row is that of one surface.
    at: usize,
    name: String,
    /// The most deeply cut one.
    deepest: &'a SurfaceReport,
    /// The one with most material left.
    most: &'a SurfaceReport,
}

type Row<'a> = SurfaceRow<'a>;

/// A figure of a surface in mm as a text in um.
fn um(figure: Mm) -> String {
    match reached(figure) {
        Figure::Number(mm) => Form::UM.of(mm),
        Figure::Words(words) => words,
    }
}

/// Rows of surfaces with the same figures, the worst first.
fn rows<'a>(
    surfaces: &'a [SurfaceReport],
    same: impl Fn(&SurfaceReport) -> Option<String>,
    deepest: fn(&SurfaceReport) -> Mm,
    most: fn(&SurfaceReport) -> Mm,
) -> Vec<Row<'a>> {
    let worse = |s: &SurfaceReport| Mm(s.gouge_bound.get().max(s.excess_bound.get()));
    let size = |group: &Alike| group.worst(surfaces, worse).map_or(Mm(0.0), |(_, s)| worse(s));
    let mut groups = alike(surfaces, same);
    groups.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let row = |group: Alike| {
        let (at, deepest) = group.worst(surfaces, deepest)?;
        Some(SurfaceRow { at, deepest, most: group.worst(surfaces, most)?.1, name: group.name })
    };
    groups.into_iter().filter_map(row).collect()
}

/// The milled surfaces without what stands under them.
pub(crate) fn surfaces(text: Text<'_>, certificate: &Certificate) -> Table {
    let all = &certificate.surfaces;
    let name = |r: &Row| r.name.clone();
    let gouge = |r: &Row| reached(r.deepest.gouge.depth);
    let gouge_bound = |r: &Row| reached(r.deepest.gouge_bound);
    let excess = |r: &Row| reached(r.most.excess.value);
    let excess_bound = |r: &Row| reached(r.most.excess_bound);
    let below = |k: usize| move |r: &Row| reached(r.deepest.percentiles[k]);
    match text {
        Text::Summary => {
            let same = |s: &SurfaceReport| {
                let figures = [s.gouge_bound, s.gouge.depth, s.excess_bound, s.excess.value].map(um);
                s.is_machined().then(|| figures.concat())
            };
            let left = |r: &Row| match r.most.left_share() {
                0.0 => "-".to_owned(),
                share => Form::CLOSE_PERCENT.of(share),
            };
            let rows = rows(all, same, |s| s.gouge_bound, |s| s.excess_bound);
            if rows.is_empty() {
                return Table::default();
            }
            let columns = vec![
                words("surface, um", 30, name).cut(),
                figures("gouge <=", 9, Form::UM, gouge_bound),
                figures("found", 9, Form::UM, gouge),
                figures("excess <=", 12, Form::UM, excess_bound),
                figures("found", 12, Form::UM, excess),
                figures(format!("over {}", length(surface::NOT_REACHED)), 14, Form::WHOLE, left),
            ];
            Table::new("", rows, columns)
        }
        Text::Page(_) => {
            let rows =
                all.iter().enumerate().map(|(at, s)| SurfaceRow { at, name: s.surface.clone(), deepest: s, most: s });
            let columns = vec![
                words("surface", 0, name),
                figures("area, mm\u{b2}", 0, Form::WHOLE, |r: &Row| r.deepest.area),
                figures("deepest cut found, \u{b5}m", 0, Form::UM, gouge).place(|r: &Row| text.place(r.at, 0)),
                figures("proved: no deeper than", 0, Form::UM, gouge_bound),
                figures("most left found, \u{b5}m", 0, Form::UM, |r: &Row| {
                    reached(Mm(r.most.excess.value.get().max(0.0)))
                })
                .place(|r: &Row| text.place(r.at, 1)),
                figures("proved: no more than", 0, Form::UM, excess_bound),
                figures("5 % lie below, \u{b5}m", 0, Form::UM, below(0)),
                figures("50 % below", 0, Form::UM, below(1)),
                figures("95 % below", 0, Form::UM, below(2)),
            ];
            let title = "Surfaces: deviation of the swept cutters from the design (cut below zero, left above)";
            Table::new(title, rows, columns)
        }
        Text::Details | Text::Sheet => {
            let same = |s: &SurfaceReport| {
                let [p5, p50, p95] = s.percentiles;
                let figures = [s.gouge.depth, s.gouge_bound, s.excess.value, s.excess_bound, p5, p50, p95].map(um);
                Some(Form::TENTHS.of(s.area.get()) + &figures.concat())
            };
            let rows = rows(all, same, |s| s.gouge.depth, |s| s.excess.value);
            let columns = vec![
                words("surface", 27, name),
                figures("mm2", 7, Form::TENTHS, |r: &Row| r.deepest.area),
                figures("gouge", 8, Form::UM, gouge),
                figures("at most", 8, Form::UM, gouge_bound),
                words("at (mm)", 28, |r: &Row| coordinates(r.deepest.gouge.point)).with_gap(),
                figures("excess", 11, Form::UM, excess),
                figures("at most", 11, Form::UM, excess_bound),
                words("at (mm)", 28, |r: &Row| coordinates(r.most.excess.point)).with_gap(),
                figures("5 %", 7, Form::UM, below(0)),
                figures("50 %", 7, Form::UM, below(1)),
                figures("95 %", 7, Form::UM, below(2)),
            ];
            let title = format!(
                "surfaces: cutters of the whole program swept against the design, um; proved over cells of {} mm and less; worst first",
                certificate.spacing.get()
            );
            Table::new(title, rows, columns)
        }
    }
}

/// What stands under the milled surfaces: the worst of all with its place in the program, and what is not reached.
pub(super) fn worst(program: &Program, motion: &Motion, certificate: &Certificate) -> Vec<String> {
    let all = &certificate.surfaces;
    let most = |f: fn(&SurfaceReport) -> Mm| all.iter().max_by(|a, b| f(a).total_cmp(&f(b)));
    let bound = |f: fn(&SurfaceReport) -> Mm| Mm(all.iter().map(|s| f(s).get()).fold(0.0, f64::max));
    let figure = |Mm(mm): Mm| if mm >= FAR { NOT_REACHED.to_owned() } else { length(mm) };
    let mut lines = Vec::new();
    if let Some(s) = most(|s| s.gouge.depth) {
        let (found, place) = (figure(s.gouge.depth), describe(program, motion, s.gouge.at));
        let loose = |s: &SurfaceReport| s.gouge_bound.get() > s.gouge.depth.get() + 2.0 * surface::SLACK;
        if all.iter().any(loose) {
            let broken = length(surface::UNPROVED_GOUGE);
            lines.push(format!("deepest gouge found {found} on {}: {place}", s.surface));
            lines.push(format!(
                "a cut over {broken} deeper than its contract has no closer bound than the radius of the cutter"
            ));
        } else {
            let bound = figure(bound(|s| s.gouge_bound));
            lines.push(format!("no gouge over {bound} anywhere, deepest found {found} on {}: {place}", s.surface));
        }
    }
    if let Some(s) = most(|s| s.excess.value) {
        let (found, place) = (figure(s.excess.value), describe(program, motion, s.excess.at));
        lines.push(match figure(bound(|s| s.excess_bound)) {
            bound if found == NOT_REACHED => format!("{bound}: {}", s.surface),
            bound => format!("nowhere more than {bound} left, most found {found} on {}: {place}", s.surface),
        });
    }
    lines.extend(missing(certificate));
    lines
}

/// Areas that are not reached, with their causes, the largest first.
fn missing(certificate: &Certificate) -> impl Iterator<Item = String> {
    let all = &certificate.surfaces;
    let missed = |s: &SurfaceReport| {
        let causes: Vec<String> = s.nearest_there.iter().map(|(o, area)| cause(certificate, *o, area.get())).collect();
        (s.not_reached.get() > 0.0).then(|| causes.join(", "))
    };
    let limit = length(surface::NOT_REACHED);
    let mut groups: Vec<(f64, String)> = Vec::new();
    for group in alike(all, missed) {
        let Some((_, s)) = group.worst(all, |s| s.not_reached) else { continue };
        let each = if group.members.len() > 1 { ", each" } else { "" };
        let (area, causes) = (s.not_reached.get(), missed(s).unwrap_or_default());
        // As written: areas that differ by rounding alone keep the order of their surfaces.
        let order = (100.0 * area).round();
        groups.push((order, format!("over {limit} left on {area:.2} mm2 of {}{each}: {causes}", group.name)));
    }
    groups.sort_by(|a, b| b.0.total_cmp(&a.0));
    groups.into_iter().map(|(_, line)| line)
}

/// Reason why an area is not reached.
fn cause(certificate: &Certificate, operation: Option<u32>, area: f64) -> String {
    match operation.and_then(|o| certificate.operations.get(o as usize)) {
        Some(o) => format!("{area:.2} mm2 where {} comes nearest", o.name),
        None => format!("{area:.2} mm2 where no operation comes near"),
    }
}

/// The surfaces that no operation machines, in words; `None` where there are none.
pub(crate) fn not_machined(certificate: &Certificate) -> Option<String> {
    let untouched = alike(&certificate.surfaces, |s| (!s.is_machined()).then(String::new));
    let names: Vec<&str> = untouched.iter().map(|g| g.name.as_str()).collect();
    (!names.is_empty()).then(|| format!("not machined: {}", names.join(", ")))
}

/// Surfaces that the lathe made, the form of the part against its points, and roughing against the finished part.
pub(super) fn kept(certificate: &Certificate) -> Table {
    let kept = &certificate.kept;
    let place = |s: &&KeptReport| if s.gouge.depth.get() > 0.0 { coordinates(s.gouge.point) } else { "-".to_owned() };
    let columns = vec![
        words("surface", 27, |s: &&KeptReport| s.surface.clone()),
        figures("gouge", 8, Form::UM, |s: &&KeptReport| s.gouge.depth),
        figures("at most", 8, Form::UM, |s: &&KeptReport| s.gouge_bound),
        words("at (mm)", 0, place).with_gap(),
    ];
    let title = format!(
        "kept surfaces: what milling leaves as the lathe made it, um; {} are allowed, the strictest gouge of the whole part",
        length(kept.allowed.get())
    );
    Table::new(title, &kept.surfaces, columns)
        .with(certificate.form.iter().map(form))
        .with(certificate.imported.iter().map(|from| imported(from, &certificate.form)))
        .with(certificate.allowance.iter().flat_map(allowance))
}

/// How far the surfaces of a vane lie from its stated points.
fn form(r: &StatedReport) -> String {
    let at = r.point.coords.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(" ");
    format!(
        "form of {}: its {} stated points lie within {} of the surfaces that are cut; farthest at ({at})",
        r.name,
        r.points,
        length(r.distance.get())
    )
}

/// Both ways from the imported files to the surfaces that are cut, each with the kind of its figure. `form` has the second one,
/// which a part of angles does not have.
pub fn imported(from: &ImportedReport, form: &[StatedReport]) -> String {
    let measured = form.iter().map(|r| r.distance.get()).reduce(f64::max);
    let measured = measured.map_or_else(
        || "from the job to the surfaces that are cut nothing is measured: it states no points".to_owned(),
        |distance| {
            format!(
                "from the points of the job to the surfaces that are cut {}, measured; together at most {}",
                length(distance),
                length(from.within.get() + distance)
            )
        },
    );
    format!(
        "imported from {}: from its points to the job at most {}, stated by the import and not verified; {measured}",
        from.files,
        length(from.within.get())
    )
}

/// Roughing against the finished part.
fn allowance(found: &AllowanceReport) -> Vec<String> {
    let tolerance = length(found.tolerance.get());
    let first = match &found.nearest {
        None => format!("roughing stays over {tolerance} outside of the finished part, which its control may add"),
        Some(n) => format!(
            "roughing comes within {} of {}, where its control may add {tolerance}",
            length(n.place.value.get()),
            n.surface
        ),
    };
    let vanes = found.vanes.iter().map(|r| {
        let (found, bound) = (length(r.worst.as_ref().map_or(0.0, |w| -w.place.value.get())), length(r.bound.get()));
        format!("{} leaves {} on the vanes; missing at most {found}, proved {bound}", r.name, r.leaves())
    });
    std::iter::once(first).chain(vanes).collect()
}

/// Stock that each roughing operation leaves.
pub(crate) fn rest(text: Text<'_>, certificate: &Certificate) -> Table {
    let after = |r: &RestReport| certificate.operations.get(r.operation as usize).map_or("", |o| o.name.as_str());
    let Text::Page(_) = text else {
        let line = |r: &RestReport| {
            let on = r.surface.as_ref().map_or_else(|| "inside a channel at".to_owned(), |s| format!("on {s} at"));
            let [x, y, z] = r.point;
            format!(
                "{:<12} least {:>6.3}  median {:>6.3}  most {:>6.3} {on} ({x:.2}, {y:.2}, {z:.2}), {:.1} % of the room cleared",
                after(r),
                r.least.get(),
                r.median.get(),
                r.most.get(),
                r.cleared.get() * 100.0
            )
        };
        return Table::lines("stock after roughing, mm", certificate.rest.iter().map(line).collect());
    };
    type Row<'a> = (usize, &'a RestReport);
    let columns = vec![
        words("stock", 0, |r: &Row| format!("after {}", after(r.1))),
        figures("least, mm", 0, Form::THOUSANDTHS, |r: &Row| r.1.least),
        figures("median, mm", 0, Form::THOUSANDTHS, |r: &Row| r.1.median),
        figures("most, mm", 0, Form::THOUSANDTHS, |r: &Row| r.1.most).place(|r: &Row| text.place(r.0, 0)),
        figures("room cleared, %", 0, Form::PER_HUNDRED, |r: &Row| r.1.cleared),
    ];
    Table::new("Stock on the surfaces after roughing", certificate.rest.iter().enumerate(), columns)
}
