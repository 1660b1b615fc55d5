//! Figures of a certificate, by name, and their comparison with those that are measured on the text.
//!
//! The text has fewer digits than the motion that the certificate was measured on, so figures differ a little where nothing was
//! edited. Each kind of figure has its largest difference below; measured on `small` in four dialects, on `point` and on
//! `reduced`, the differences are a quarter of it at most. Places are not compared: where two places are almost equally bad, the digits decide between them.

use diagnostics::printable;
use serde_json::Value;
use std::collections::BTreeMap;

/// Largest difference that the digits of a text explain: absolute, and as a share of the figure.
#[derive(Clone, Copy)]
struct Tolerance(f64, f64);

/// Lengths, mm, and shares.
const LENGTH: Tolerance = Tolerance(1e-3, 1e-3);
/// Shares of the limits of axes. Between two poses almost at the pole, an axis turns by what the digits say.
const OF_AXIS: Tolerance = Tolerance(0.02, 0.05);
/// Times, s. Rapids can be divided otherwise in the text.
const TIME: Tolerance = Tolerance(5.0, 0.05);
/// Volumes and rates, mm3 and mm3/s.
const VOLUME: Tolerance = Tolerance(0.5, 0.01);
/// Angles, deg.
const ANGLE: Tolerance = Tolerance(2.0, 0.01);

/// Figures that are compared: the place in the certificate, where `*` stands for each element of a list.
const FIGURES: [(&str, Tolerance); 49] = [
    ("/form/*/points", LENGTH),
    ("/form/*/distance", LENGTH),
    ("/surfaces/*/gouge/depth", LENGTH),
    ("/surfaces/*/gouge_bound", LENGTH),
    ("/surfaces/*/excess/value", LENGTH),
    ("/surfaces/*/excess_bound", LENGTH),
    ("/surfaces/*/area", LENGTH),
    ("/kept/surfaces/*/gouge/depth", LENGTH),
    ("/kept/surfaces/*/gouge_bound", LENGTH),
    ("/kept/allowed", LENGTH),
    ("/allowance/bound", LENGTH),
    ("/allowance/tolerance", LENGTH),
    ("/allowance/vanes/*/bound", LENGTH),
    ("/allowance/vanes/*/allowance/*", LENGTH),
    ("/clamping/distance", LENGTH),
    ("/clamping/below", LENGTH),
    ("/clamping/diameter", LENGTH),
    ("/carried/*/clearance/distance", LENGTH),
    ("/operations/*/shank/distance", LENGTH),
    ("/operations/*/holder/distance", LENGTH),
    ("/operations/*/rapid/distance", LENGTH),
    ("/rapid/distance", LENGTH),
    ("/perimeter/clearance", LENGTH),
    ("/perimeter/height", LENGTH),
    ("/perimeter/required", LENGTH),
    ("/perimeter/retract", LENGTH),
    ("/machine/axes/*/travel/*", LENGTH),
    ("/machine/axes/*/used/*", LENGTH),
    ("/machine/axes/*/speed_share", OF_AXIS),
    ("/machine/axes/*/acceleration_share", OF_AXIS),
    ("/machine/axes/*/jerk_share", OF_AXIS),
    ("/machine/pole_distance", LENGTH),
    ("/machine/runs/*/contour/value", LENGTH),
    ("/machine/runs/*/orientation/value", LENGTH),
    ("/operations/*/time/*", TIME),
    ("/stock/operations/*/time", TIME),
    ("/stock/operations/*/air", TIME),
    ("/stock/operations/*/feed/*", TIME),
    ("/rest/*/most", LENGTH),
    ("/rest/*/median", LENGTH),
    ("/rest/*/least", LENGTH),
    ("/stock/blank", VOLUME),
    ("/stock/operations/*/removed", VOLUME),
    ("/stock/operations/*/by_links", VOLUME),
    ("/stock/operations/*/rest", VOLUME),
    ("/stock/operations/*/rate/value", VOLUME),
    ("/stock/operations/*/depth/value", Tolerance(0.01, 0.01)),
    ("/stock/operations/*/slot_depth/value", Tolerance(0.01, 0.01)),
    ("/stock/operations/*/arc/value", ANGLE),
];

/// Beginning of the places of figures that depend on the cells of the stock.
const OF_STOCK: &str = "/stock/";

/// Names of an element of a list.
const NAMES: [&str; 4] = ["surface", "axis", "name", "solid"];

/// What is compared of a certificate.
pub(super) const COMPARED: &str = "of the certificate, contracts, surfaces, clearances, axes, times, stock, dialect and conditions \
                                   were compared; not compared: places, and what limits the speed of each move\n";

/// What is compared where the certificate was made with other cells of the stock.
pub(super) const OTHER_CELLS: &str = "of the certificate, contracts, surfaces, clearances, axes, times, dialect and conditions were \
                                      compared; not compared: stock, which has other cells there, places, and what limits the \
                                      speed of each move\n";

/// Edge of the cells in which the stock of a certificate was simulated, mm.
pub(super) fn cell(says: &Value) -> Option<f64> {
    says.pointer("/stock/cell").and_then(Value::as_f64)
}

/// Whether the stock of both was simulated in cells of one size, or one of them has none at all.
pub(super) fn same_cells(says: &Value, found: &Value) -> bool {
    match [says, found].map(cell) {
        [Some(said), Some(found)] => said == found,
        _ => true,
    }
}

/// The first figure that differs from the measured one in a sentence, and the number of the others; `None` where all agree.
pub(super) fn difference(says: &Value, measured: &Value) -> Option<(String, usize)> {
    let with_stock = same_cells(says, measured);
    if let Some(text) = other_import(says, measured) {
        return Some((text, 0));
    }
    let (says, found) = (figures(says, with_stock), figures(measured, with_stock));
    let same = |(what, (value, tolerance)): &(&String, &(f64, Tolerance))| {
        says.get(*what).is_some_and(|(said, _)| (said - value).abs() <= tolerance.0 + tolerance.1 * value.abs())
    };
    let mut differ = found.iter().filter(|figure| !same(figure));
    if let Some((what, (value, _))) = differ.next() {
        let said = says.get(what).map_or("nothing".to_owned(), |(said, _)| said.to_string());
        return Some((format!("states {said} for {what}; measured on the text: {value}"), differ.count()));
    }
    let mut more = says.keys().filter(|what| !found.contains_key(*what));
    more.next().map(|what| (format!("has a figure for {what}, which is not measured on the text"), more.count()))
}

/// Files and distance of an import: the job states them, so no digit explains a difference.
fn other_import(says: &Value, measured: &Value) -> Option<String> {
    /// Share by which numbers differ that were written and read.
    const WRITTEN: f64 = 1e-12;
    let of = |all: &Value| {
        let imported = all.get("imported")?;
        let files = imported.get("files").and_then(Value::as_str).map(str::to_owned);
        Some((files, imported.get("within").and_then(Value::as_f64)))
    };
    let same = |[a, b]: [Option<f64>; 2]| a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= WRITTEN * b.abs());
    let words = |(files, within): (Option<String>, Option<f64>)| {
        let files = files.map_or_else(|| "no files".to_owned(), |files| printable(&files).into_owned());
        within.map_or_else(|| files.clone(), |within| format!("{files} within {within} mm"))
    };
    match (of(says), of(measured)) {
        (None, None) => None,
        (Some(says), Some(job)) if says.0 == job.0 && same([says.1, job.1]) => None,
        (Some(says), None) => Some(format!("states an import of {}; the job states none", words(says))),
        (None, Some(job)) => Some(format!("states no import; the job states {}", words(job))),
        (Some(says), Some(job)) => Some(format!("states an import of {}; the job states {}", words(says), words(job))),
    }
}

/// All figures by name. A value that is no number is left out, and so differs from every measured value.
fn figures(measured: &Value, with_stock: bool) -> BTreeMap<String, (f64, Tolerance)> {
    let mut all = BTreeMap::new();
    for (place, tolerance) in FIGURES.iter().filter(|(place, _)| with_stock || !place.starts_with(OF_STOCK)) {
        let steps: Vec<&str> = place.split('/').skip(1).collect();
        let quantity = steps.iter().filter(|step| **step != "*").map(|step| step.replace('_', " "));
        let quantity = quantity.collect::<Vec<_>>().join(" ");
        collect(measured, &steps, quantity, &mut |name, value| {
            all.insert(name, (value, *tolerance));
        });
    }
    all
}

/// Gives each number below some steps with the name of its quantity and of the elements that it belongs to.
fn collect(value: &Value, steps: &[&str], name: String, give: &mut impl FnMut(String, f64)) {
    let Some((step, rest)) = steps.split_first() else {
        if let Some(number) = value.as_f64() {
            give(name, number);
        }
        return;
    };
    if *step != "*" {
        if let Some(below) = value.get(step) {
            collect(below, rest, name, give);
        }
        return;
    }
    for (k, element) in value.as_array().into_iter().flatten().enumerate() {
        let own = NAMES.iter().find_map(|key| element.get(key).and_then(Value::as_str));
        // Two elements can have one name: the surfaces of two operations, for example.
        let element_name = own.map_or_else(|| format!("{}", k + 1), |own| format!("{own} ({})", k + 1));
        collect(element, rest, format!("{name}, {element_name}"), give);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A certificate with one figure, two steps deep in lists.
    fn with(place: &str, value: f64) -> Value {
        place.split('/').skip(1).collect::<Vec<_>>().iter().rev().fold(json!(value), |below, step| match *step {
            "*" => json!([below]),
            step => json!({ step: below }),
        })
    }

    #[test]
    fn each_figure_is_compared() {
        for (place, _) in FIGURES {
            assert_eq!(difference(&with(place, 100.0), &with(place, 100.01)), None, "{place}");
            for said in [with(place, 80.0), with(place, 130.0), json!({})] {
                let (text, others) = difference(&said, &with(place, 100.0)).unwrap_or_else(|| panic!("{place}"));
                assert!(text.contains("measured on the text: 100") && others == 0, "{text}");
            }
            let (text, _) = difference(&with(place, 100.0), &json!({})).unwrap_or_else(|| panic!("{place}"));
            assert!(text.contains("which is not measured on the text"), "{text}");
        }
    }

    #[test]
    fn an_import_is_compared() {
        let import = |files: &str, within: f64| json!({ "imported": { "files": files, "within": within } });
        let due = import("wheel.step", 0.0114);
        assert_eq!(difference(&import("wheel.step", 0.0114), &due), None);
        for said in
            [import("wheel.step", 0.0113), import("wheel.stp", 0.0114), json!({}), json!({ "imported": "wheel.step" })]
        {
            let (text, _) = difference(&said, &due).unwrap_or_else(|| panic!("{said}"));
            assert!(text.contains("the job states wheel.step within 0.0114 mm"), "{text}");
        }
        let (text, _) = difference(&due, &json!({})).expect("the job states none");
        assert!(text.contains("the job states none"), "{text}");
    }

    #[test]
    fn stock_of_other_cells_is_not_compared() {
        let stock = |cell: f64, blank: f64| json!({ "stock": { "cell": cell, "blank": blank } });
        assert!(difference(&stock(0.5, 100.0), &stock(0.5, 200.0)).is_some());
        assert_eq!(difference(&stock(0.25, 100.0), &stock(0.5, 200.0)), None);
        let (text, _) = difference(&json!({ "stock": null }), &stock(0.5, 200.0)).unwrap();
        assert!(text.contains("states nothing for stock blank"), "{text}");
    }
}
