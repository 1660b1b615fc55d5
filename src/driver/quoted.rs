//! `impellerc quote`: what a part takes on the machine, before anything is planned.

use super::open_part::{PartInput, PartText, given};
use super::{Options, Outcome, RunOptions, Stages, front};
use base::units::trim;
use choose::Effort;
use diagnostics::{Aborted, Sink};
use ir::Program;
use quotation::{LowerBound, Quote};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use wheel::material::Material;

/// A part, and how its quote is written.
#[derive(Clone, Debug, Default)]
pub struct QuoteOptions {
    /// The part: blade files, a job with a part alone, or a whole job.
    pub part: PartInput,
    /// Write JSON instead of text for people.
    pub json: bool,
    /// Price of an hour of the machine.
    pub hour: Option<f64>,
    /// Price of a kilogram of stock.
    pub kilogram: Option<f64>,
}

/// Estimates what a part takes. Tools and operations that its job does not have are chosen by sizes alone.
pub fn quoted(options: &QuoteOptions, stages: &mut Stages) -> Outcome {
    let mut outcome = Outcome::default();
    // The reason is in the sink.
    let _ = run(options, stages, &mut outcome);
    outcome
}

fn run(options: &QuoteOptions, stages: &mut Stages, outcome: &mut Outcome) -> Result<(), Aborted> {
    let program = program(options, stages, outcome)?;
    let quote = stages.run("quote", || quotation::quote(&program));
    stages.go_on()?;
    outcome.emitted =
        Some(if options.json { as_json(&program, &quote, options) } else { text(&program, &quote, options) });
    Ok(())
}

/// The job of a part, with its own operations or with chosen ones.
fn program(options: &QuoteOptions, stages: &mut Stages, outcome: &mut Outcome) -> Result<Program, Aborted> {
    let name = options.part.files.files.first().and_then(|file| file.file_stem()).unwrap_or("part".as_ref());
    let part = PartText::read(&options.part, &Path::new(name).with_extension("imp"), stages, outcome)?;
    let ast = part.parsed(outcome)?;
    if given(&ast).is_none() || ast.is_open() {
        let chosen = part.choose(&part.with_all(&ast), Effort::Sizes, stages, outcome)?;
        // Remarks on a text that nobody wrote say nothing, and their places are in no text that is shown.
        let mut faults = Sink::default();
        return part.program(&chosen.job, &mut faults).inspect_err(|_| {
            faults.change_all(|mut diag| {
                diag.labels.clear();
                diag
            });
            outcome.sink.append(faults);
        });
    }
    *outcome = Outcome::default();
    let PartInput { library, machine, .. } = options.part.clone();
    let run = RunOptions { library, machine, ..RunOptions::default() };
    let options = Options { job: part.file.clone(), run, ..Options::default() };
    front(&options, stages, outcome)?.ok_or(Aborted)
}

/// Prices of the machining time, lowest, expected and highest, and of the stock.
struct Prices {
    time: Option<[f64; 3]>,
    stock: Option<f64>,
}

impl Prices {
    fn of(quote: &Quote, options: &QuoteOptions) -> Self {
        let times = [quote.lower.minutes, quote.expected, quote.upper];
        Self {
            time: options.hour.map(|price| times.map(|minutes| minutes / 60.0 * price)),
            stock: options.kilogram.map(|price| price * quote.stock.weight),
        }
    }
}

fn as_json(program: &Program, quote: &Quote, options: &QuoteOptions) -> String {
    let prices = Prices::of(quote, options);
    let mut all = json!({
        "part": program.name,
        "machine": program.machine.name,
        "material": material(program).name(),
        "quote": quote,
    });
    if let Value::Object(fields) = &mut all {
        fields.extend(prices.time.map(|prices| ("time-price".to_owned(), json!(prices))));
        fields.extend(prices.stock.map(|price| ("stock-price".to_owned(), json!(price))));
    }
    format!("{all:#}\n")
}

fn material(program: &Program) -> Material {
    program.stock.material.unwrap_or(Material::Aluminium)
}

/// Minutes as hours, minutes and seconds.
fn clock(minutes: f64) -> String {
    let seconds = (60.0 * minutes).round() as u64;
    format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

fn text(program: &Program, quote: &Quote, options: &QuoteOptions) -> String {
    let Quote { lower, expected, upper, stock, .. } = quote;
    let mut text = format!(
        "{}: {} blades, {} on {}\n\nmachining time   expected {}, at most about {}; no program with these tools and feeds is below {}\n",
        program.name,
        program.part.vane_count as usize * program.part.blades.len(),
        material(program).name(),
        program.machine.name,
        clock(*expected),
        clock(*upper),
        clock(lower.minutes),
    );
    text += &reason(lower);
    _ = writeln!(text, "\n  {:<12} {:<24} {:>7} {:>12} {:>9}", "operation", "tool", "lines", "length", "expected");
    for o in &quote.operations {
        let or_rest =
            |value: f64, unit: &str| if value > 0.0 { format!("{value:.0}{unit}") } else { "rest".to_owned() };
        let (lines, length) = (or_rest(o.lines, ""), or_rest(o.length, " mm"));
        _ = writeln!(
            text,
            "  {:<12} {:<24} {lines:>7} {length:>12} {:>9}",
            o.operation,
            o.tool,
            clock(o.seconds / 60.0)
        );
    }
    let cm3 = |volume: f64| format!("{} cm3", trim(volume / 1000.0, 1));
    let unknown = || "unknown: the surfaces of the part do not close".to_owned();
    _ = writeln!(
        text,
        "\nstock {} ({} kg), part {}, chips {}",
        cm3(stock.blank),
        trim(stock.weight, 3),
        stock.part.map_or_else(unknown, cm3),
        stock.chips.map_or_else(unknown, cm3),
    );
    let prices = Prices::of(quote, options);
    if let Some([least, expected, most]) = prices.time {
        _ = writeln!(text, "machining {expected:.2}, from {least:.2} to {most:.2}");
    }
    if let Some(price) = prices.stock {
        _ = writeln!(text, "stock {price:.2}");
    }
    text += "\nThe lower bound is proved from areas, volumes, feeds and limits of the tools. The other times are predicted by a model: of 13 wheels \
             the certificates were 0.75 to 1.3 times the expected time. No path was planned: whether the tools reach all of the part shows \
             `impellerc new --from`.\n";
    text
}

/// What sets the lower bound.
fn reason(lower: &LowerBound) -> String {
    let of = |minutes: f64| format!("{:.0} %", 100.0 * minutes / lower.minutes.max(f64::MIN_POSITIVE));
    let by = if lower.by_power { "the power of the spindle" } else { "the largest depth of its tool" };
    format!(
        "  {} of the bound are surfaces, which a ball finishes in strips; {} are chips, at most {} cm3/min by {by}\n",
        of(lower.surfaces),
        of(lower.removal),
        trim(lower.rate / 1000.0, 1),
    )
}
