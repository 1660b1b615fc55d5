//! The report: one HTML file with the results of the proof. It needs no network access.
//!
//! Rust writes the tables and packs the geometry; the page draws the geometry with WebGL2 and canvas. The size of the
//! file is bounded: its end states what is thinned, and within which tolerance.

mod charts;
mod pack;
mod part;
mod paths;
mod places;
mod stock;
mod tables;

pub use stock::StockStage;

use crate::markup;
use diagnostics::Diag;
use five_axis::Carries;
use ir::{Motion, Program, Tool};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use verify::Certificate;
use verify::surface::{self, PatchCorners};
use wheel::part::{
    Sample, SurfaceId,
    chart::{Shape, charts},
    sample,
};

/// Share by which a value may exceed the round number above it.
const ROUND_NUMBER_EXCESS: f64 = 1e-9;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// In order: data, drawing, when it is drawn, places under the pointer, plots, NC text, mouse and keys, then what the reader chooses and the start.
const SCRIPTS: [&str; 9] = [
    include_str!("data.js"),
    include_str!("shaders.js"),
    include_str!("scene.js"),
    include_str!("frames.js"),
    include_str!("pick.js"),
    include_str!("plots.js"),
    include_str!("nc.js"),
    include_str!("pointer.js"),
    include_str!("page.js"),
];

/// Share of the reached samples that the colour scale covers where no contract gives its end.
const SCALE_SHARE: f64 = 0.99;

/// Deviations beyond this value are no matter of accuracy, mm: the surface was not finished, or there is a fault.
const SCALE_REACH: f64 = 0.1;

/// Content of the report.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The lowered job.
    pub program: &'a Program,
    /// All moves.
    pub motion: &'a Motion,
    /// Results of the proof.
    pub certificate: &'a Certificate,
    /// Points of sector 0 in rows, in the order of [`deviations`].
    pub samples: &'a [Sample],
    /// Deviation of each sample in each sector, sector by sector, mm; NaN on surfaces that are not milled.
    pub deviations: &'a [f64],
    /// Diagnostics for the reader.
    pub findings: &'a [Diag],
    /// Hash of the inputs.
    pub hash: &'a str,
    /// Name of the dialect.
    pub post: &'a str,
    /// NC text; `None` when none was made.
    pub nc_text: Option<&'a str>,
    /// Operation, move and line (from 1) of the NC text, in order.
    pub lines: &'a [(u32, u32, u32)],
    /// Operation, and a decision of its planning.
    pub notes: &'a [(String, String)],
    /// Stock after each operation; empty when it was not simulated.
    pub stock: &'a [StockStage],
}

/// Points of sector 0 in rows along x of their surface, and the deviation of each in all sectors, sector by sector, mm.
/// The deviations are those of the certificate at the corners of its cells, at most [`surface::CORNER_SLACK`] over the
/// true value; NaN on the turned surfaces. The points are corners of cells and not evenly spaced samples, so that
/// nothing is computed again for the picture: a second computation took longer than the proof.
pub fn deviations(program: &Program, certificate: &Certificate) -> (Vec<Sample>, Vec<f64>) {
    let part = &program.part;
    let found: BTreeMap<SurfaceId, &[PatchCorners]> =
        certificate.surfaces.iter().map(|s| (s.id, s.corners.as_slice())).collect();
    let of = |kind, sector| found.get(&SurfaceId { kind, sector }).copied().unwrap_or_default();
    let charts = charts(part);
    let mut samples = Vec::new();
    for chart in &charts {
        for (corners, i, j) in rows(of(chart.kind, 0)) {
            let [x, y] = corners.patch.corner(i, j);
            if !value(corners, i, j).is_nan() {
                let place = chart.place(x, y);
                let surface = SurfaceId { kind: chart.kind, sector: 0 };
                let (position, normal) = (place.position, place.normal);
                samples.push(Sample { surface, position, normal, parameters: [x, y], area: 0.0 });
            }
        }
    }
    let turned = sample::sample(part, certificate.spacing.get());
    samples.extend(turned.into_iter().filter(|s| s.surface.sector == 0 && !s.surface.milled()));
    let mut deviations = Vec::with_capacity(samples.len() * part.vane_count as usize);
    for sector in 0..part.vane_count {
        let start = deviations.len();
        for chart in &charts {
            let own = of(chart.kind, sector);
            // The cells are the same in all sectors: a corner off the part in one sector is off the part in all.
            deviations.extend(rows(own).map(|(c, i, j)| value(c, i, j)).filter(|g| !g.is_nan()));
        }
        deviations.resize(start + samples.len(), f64::NAN);
    }
    (samples, deviations)
}

/// Deviation at a corner, mm.
fn value(corners: &PatchCorners, i: usize, j: usize) -> f64 {
    corners.values.get(i * (corners.patch.rows + 1) + j).map_or(f64::NAN, |g| f64::from(*g))
}

/// Corners of all patches of a surface as rows along x, each from y = 0 to 1: the patch, and the corner in it. A corner
/// that two patches share occurs once.
fn rows(patches: &[PatchCorners]) -> impl Iterator<Item = (&PatchCorners, usize, usize)> {
    let strips = patches.chunk_by(|a, b| a.patch.x == b.patch.x);
    let last = patches.last().map(|p| p.patch.x);
    strips.flat_map(move |strip| {
        let first = &strip[0].patch;
        let columns = first.columns + usize::from(last == Some(first.x));
        (0..columns).flat_map(move |i| {
            strip.iter().enumerate().flat_map(move |(k, p)| (usize::from(k > 0)..=p.patch.rows).map(move |j| (p, i, j)))
        })
    })
}

/// Half section of a tool for the page: (r, height) of cutter, shank and holder, mm.
#[derive(Serialize)]
struct ToolData {
    name: String,
    /// From the tip to the gauge line, mm.
    length: f64,
    cutter: Vec<[f64; 2]>,
    shank: Vec<[f64; 2]>,
    holder: Vec<[f64; 2]>,
}

/// Number of steps along the flutes in which the half section is drawn.
const SECTION_STEPS: u32 = 48;

impl ToolData {
    fn new(tool: &Tool) -> Self {
        let solid = &tool.solid;
        // Steps are short near the tip, where the section is round.
        let share = |k: u32| (f64::from(k) / f64::from(SECTION_STEPS)).powi(2) * solid.flute_length;
        let mut cutter: Vec<[f64; 2]> = vec![[0.0, 0.0]];
        cutter.extend((0..=SECTION_STEPS).map(|k| [solid.cutter.radius_at(share(k)), share(k)]));
        cutter.push([0.0, solid.flute_length]);
        let sections = |list: &[tool_stock::collide::Section]| {
            list.iter()
                .flat_map(|s| [[0.0, s.from], [s.radius_from, s.from], [s.radius_to, s.to], [0.0, s.to]])
                .collect()
        };
        let [shank, holder] = [&solid.shank, &solid.holder].map(|list| sections(list));
        Self { name: tool.name.clone(), length: tool.length(), cutter, shank, holder }
    }
}

/// Limits and transformation of the machine.
#[derive(Serialize)]
struct MachineData<'a> {
    /// Names of the axes.
    names: [&'a str; 5],
    /// Direction and a point of the rotary axes, the first next to the tool; true where the axis carries the part.
    rotary: [([f64; 3], [f64; 3], bool); 2],
    part_origin: [f64; 3],
    /// Directions of X, Y and Z of the part with all axes at zero, where they are not those of the machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    part_axes: Option<[[f64; 3]; 3]>,
    /// Largest speeds of X Y Z (mm/s) and the rotary axes (rad/s).
    speeds: [f64; 5],
}

/// All data that is no typed array.
#[derive(Serialize)]
struct Data<'a> {
    name: &'a str,
    /// Ends of the tolerance: gouge and excess, mm.
    scale: [f64; 2],
    /// Whether a contract requires them; otherwise they follow from the part.
    required: [bool; 2],
    /// Colours of the limits of the feed.
    limit_colours: Vec<&'static str>,
    part: &'a part::PartData,
    paths: &'a paths::PathData,
    machine: MachineData<'a>,
    tools: Vec<ToolData>,
    places: &'a [places::PlaceData],
    blank: Vec<[f64; 2]>,
    /// Edge of the cells of the stock simulation, mm.
    cell: Option<f64>,
    stock: &'a [stock::StockData],
}

/// The report as HTML.
pub fn report(input: &Input<'_>) -> String {
    let program = input.program;
    let machine = &program.machine;
    let certificate = input.certificate;
    let scale = scale(input);
    let part =
        part::part(&program.part, input.samples, input.deviations, scale, certificate.spacing.get(), turned(program));
    let (stock, runs) = (certificate.stock.as_ref(), certificate.machine.runs.as_slice());
    let paths = paths::paths(program, input.motion, stock, runs, input.lines);
    let nc = nc_text(input);
    let places = places::places(input);
    let stock: Vec<stock::StockData> = input.stock.iter().map(|s| stock::stock(s, input.stock.len())).collect();
    let data = Data {
        name: &program.name,
        scale,
        required: ["gouge", "excess"].map(|kind| places::bound(input, kind).is_some_and(|b| b > 0.0)),
        limit_colours: paths.limits.iter().map(|l| charts::colour(l, machine.names()).0).collect(),
        part: &part,
        paths: &paths,
        machine: MachineData {
            names: machine.names(),
            rotary: machine.chain.axes().map(|axis| {
                (axis.direction.into_inner().into(), axis.point.coords.into(), axis.carries == Carries::Part)
            }),
            part_origin: machine.part_origin.into(),
            part_axes: (!machine.chain.holds_part_upright()).then(|| machine.part_directions().map(Into::into)),
            speeds: machine.speeds(),
        },
        tools: program.tools.iter().map(|(_, t)| ToolData::new(t)).collect(),
        places: &places.list,
        blank: program.stock.profile.to_vec(),
        cell: input.certificate.stock.as_ref().map(|s| s.cell.get()),
        stock: &stock,
    };
    // The part is not deflated: the page draws it before it has read the rest.
    let [mut part_arrays, mut arrays] = [const { String::new() }; 2];
    array(&mut part_arrays, "positions", &part.positions);
    array(&mut part_arrays, "normals", &part.normals);
    array(&mut part_arrays, "deviations", &part.deviations);
    let mut deflated = |name: &str, bytes: &pack::Bytes| array(&mut arrays, name, &bytes.deflated());
    deflated("joints", &paths.joints);
    deflated("kinds", &paths.kinds);
    deflated("indices", &paths.indices);
    deflated("removal", &paths.removal);
    deflated("arcs", &paths.arcs);
    deflated("limiting", &paths.limiting);
    for (i, s) in stock.iter().enumerate() {
        deflated(&format!("stock-positions-{i}"), &s.positions);
        deflated(&format!("stock-indices-{i}"), &s.indices);
    }
    array(&mut arrays, "nc-text", &nc);
    let (class, verdict) = tables::verdict(input);
    markup::filled(
        TEMPLATE,
        &[
            ("name", &markup::escaped(&program.name)),
            ("style", STYLE),
            ("verdict-class", class),
            ("verdict", &markup::escaped(&verdict)),
            ("facts", &tables::header(input)),
            ("contracts", &tables::contracts(input, &places)),
            ("operations", &tables::operations(input, &places)),
            ("limits", &charts::limits(input)),
            ("arcs", &charts::arcs(input)),
            ("findings", &tables::findings(input, &places)),
            ("details", &tables::details(input, &places)),
            ("inputs", &tables::inputs(input)),
            ("accuracy", &accuracy(input, &part, &paths, &stock, nc.len() > 0)),
            ("json", &markup::json(&data)),
            ("part-arrays", &part_arrays),
            ("arrays", &arrays),
            ("script", &SCRIPTS.concat()),
        ],
    )
}

/// Writes a typed array as an element of the page.
fn array(out: &mut String, name: &str, bytes: &pack::Bytes) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "<script type=\"text/plain\" id=\"{name}\">{}</script>", bytes.base64());
}

/// Most bytes of the deflated NC text on the page.
const MAX_TEXT_BYTES: usize = 12_000_000;

/// The NC text, deflated; empty when there is none, or when it is too long.
fn nc_text(input: &Input<'_>) -> pack::Bytes {
    let text = input.nc_text.map(|t| pack::Bytes::of_text(t).deflated());
    text.filter(|t| t.len() <= MAX_TEXT_BYTES).unwrap_or_default()
}

/// Ends of the tolerance, mm: the bounds of the contracts, or else the deviation that [`SCALE_SHARE`] of the samples keep.
fn scale(input: &Input<'_>) -> [f64; 2] {
    let bound = |kind: &str| places::bound(input, kind);
    let within = |sign: f64| {
        let mut sizes: Vec<f64> =
            input.deviations.iter().map(|g| g * sign).filter(|g| *g > 0.0 && *g < SCALE_REACH).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(((sizes.len().saturating_sub(1)) as f64 * SCALE_SHARE) as usize).copied().unwrap_or(0.0)
    };
    // A scale below a micrometre would show rounding.
    let end =
        |kind: &str, sign: f64| bound(kind).filter(|b| *b > 0.0).unwrap_or_else(|| round_up(within(sign).max(1e-3)));
    [end("gouge", -1.0), end("excess", 1.0)]
}

/// The next larger number of the series 1, 2, 5, 10, ... times a power of ten.
fn round_up(x: f64) -> f64 {
    let power = libm::pow(10f64, libm::log10(x).floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|v| *v >= x * (1.0 - ROUND_NUMBER_EXCESS)).unwrap_or(x)
}

/// Lines (r, z) of surfaces that the lathe made and that are not milled: bore and front, outlet and back.
fn turned(program: &Program) -> Vec<Vec<[f64; 2]>> {
    let (inlet, outlet) = (program.part.hub.meridian(0.0).point, program.part.hub.meridian(1.0).point);
    let (bore, back) = (program.stock.bore_radius.get(), program.stock.back.get());
    vec![vec![[outlet.x, outlet.y], [outlet.x, back], [bore, back], [bore, inlet.y], [inlet.x, inlet.y]]]
}

/// List of what was rounded, thinned or left out.
fn accuracy(
    input: &Input<'_>,
    part: &part::PartData,
    paths: &paths::PathData,
    stock: &[stock::StockData],
    has_text: bool,
) -> String {
    let cells: usize = input.certificate.surfaces.iter().map(|s| s.samples).sum();
    let mut lines = vec![
        format!(
            "Figures in tables and lists are those of the certificate. Positions in the picture of the part are rounded \
             by up to {:.2} \u{b5}m, deviations there by 0.03 %; they are at most {} \u{b5}m over the true ones.",
            part.frame.rounding() * 1e3,
            surface::CORNER_SLACK * 1e3
        ),
        if part.stride == 1 {
            format!("The part is drawn from the corners of all {} cells of the certificate.", cells)
        } else {
            format!(
                "The part is drawn from the corners of the cells of the certificate, every {0}. row and every {0}. of a \
                 row; each shows the worst of those around it.",
                part.stride
            )
        },
        if paths.tolerance > 0.0 {
            format!(
                "Of {} moves {} are drawn and plotted; the others lie within {} mm of the chords between them. Speeds \
                 are means between them.",
                paths.moves, paths.kept, paths.tolerance
            )
        } else {
            format!("All {} moves are drawn and plotted.", paths.moves)
        },
    ];
    if input.nc_text.is_some() && !has_text {
        lines.push("The NC text is too long for this page.".to_owned());
    }
    if paths.nameless {
        lines.push("Names of passes were left out: there are too many.".to_owned());
    }
    if stock.is_empty() {
        lines.push("The stock after each operation and the engagement were not simulated.".to_owned());
    }
    for (s, stage) in stock.iter().zip(input.stock) {
        if s.cell > 0.0 {
            lines.push(format!(
                "Stock {}: {} triangles drawn of {}, vertices joined in cells of {:.2} mm.",
                stage.name,
                s.triangles,
                stage.triangles.len(),
                s.cell
            ));
        }
    }
    let item = |line: &String| format!("<li>{}</li>\n", markup::escaped(line));
    format!("<ul>\n{}</ul>\n", lines.iter().map(item).collect::<String>())
}
