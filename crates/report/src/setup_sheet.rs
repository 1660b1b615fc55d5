//! The setup sheet: what a machinist needs at the machine before the first run, as Markdown or HTML for printing.
//!
//! Every figure comes from the program, the motion or the certificate. What the proof assumes stands on the sheet as a
//! check to be made at the machine.

use crate::markup::escaped;
use crate::proof::{self, Text, contracts::allowed_line};
use crate::table::{Form, Table, figures, words};
use base::units::trim;
use five_axis::{Carries, RotaryAxis};
use ir::{Program, Tool};
use tool_stock::collide::Kind;
use verify::Certificate;
use wheel::contract::clock;
use wheel::post_file::{Field, Frame, Template};

/// What the sheet is about.
#[derive(Clone, Copy)]
pub struct SheetInput<'a> {
    /// Job and machine.
    pub program: &'a Program,
    /// Figures.
    pub certificate: &'a Certificate,
    /// Dialect.
    pub post: &'a str,
    /// Files of the library that are not the shipped ones, a line each.
    pub library: &'a [String],
    /// What the proof assumes of the control.
    pub assumptions: &'a [String],
    /// File name of the NC text, its number of lines, and the short hash of its body.
    pub nc: (&'a str, usize, &'a str),
    /// First line of each operation in the NC text, where the program can be started again.
    pub restarts: &'a [usize],
}

/// A section of the sheet.
struct SheetSection {
    title: &'static str,
    /// Facts, a line each.
    facts: Vec<String>,
    table: Option<Table>,
    /// Steps to be done and ticked off in order.
    steps: Vec<String>,
}

impl SheetSection {
    fn new(title: &'static str) -> Self {
        Self { title, facts: Vec::new(), table: None, steps: Vec::new() }
    }
}

/// The sheet as Markdown.
pub fn markdown(input: SheetInput<'_>) -> String {
    let mut out = format!("# Setup sheet: {}\n", input.program.name);
    for section in sections(input) {
        out.push_str(&format!("\n## {}\n\n", section.title));
        for fact in &section.facts {
            out.push_str(&format!("- {fact}\n"));
        }
        if let Some(table) = &section.table {
            // Without an empty line the table would belong to the list.
            if !section.facts.is_empty() {
                out.push('\n');
            }
            out.push_str(&table.markdown());
        }
        for (n, step) in section.steps.iter().enumerate() {
            out.push_str(&format!("{}. [ ] {step}\n", n + 1));
        }
    }
    out
}

/// Style of the HTML form: black on white, tables with lines, for paper.
const STYLE: &str = "body{font:14px/1.4 sans-serif;max-width:60em;margin:1em auto;padding:0 1em;color:#000;background:#fff}\
table{border-collapse:collapse;width:100%}td,th{border:1px solid #888;padding:.2em .5em;text-align:left}\
h2{border-bottom:1px solid #000}ol{list-style:none;padding:0}li.step{margin:.4em 0}\
li.step::before{content:\"\\2610\\00a0\"}@media print{h2{break-after:avoid}tr,li{break-inside:avoid}}";

/// The sheet as one HTML file without scripts.
pub fn html(input: SheetInput<'_>) -> String {
    let title = escaped(&format!("Setup sheet: {}", input.program.name));
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n<style>{STYLE}</style>\
         </head>\n<body><h1>{title}</h1>\n"
    );
    for section in sections(input) {
        out.push_str(&format!("<h2>{}</h2>\n", escaped(section.title)));
        if !section.facts.is_empty() {
            let items: String = section.facts.iter().map(|f| format!("<li>{}</li>\n", escaped(f))).collect();
            out.push_str(&format!("<ul>\n{items}</ul>\n"));
        }
        out.extend(section.table.iter().map(Table::sheet));
        if !section.steps.is_empty() {
            let items: String =
                section.steps.iter().map(|step| format!("<li class=\"step\">{}</li>\n", escaped(step))).collect();
            out.push_str(&format!("<ol>\n{items}</ol>\n"));
        }
    }
    out.push_str("</body></html>\n");
    out
}

fn sections(input: SheetInput<'_>) -> Vec<SheetSection> {
    vec![
        program_section(input),
        zero_section(input),
        tools_section(input),
        operations_section(input),
        axes_section(input),
        contracts_section(input),
        first_run_section(input),
    ]
}

fn program_section(input: SheetInput<'_>) -> SheetSection {
    let SheetInput { program, certificate, .. } = input;
    let (file, lines, hash) = input.nc;
    let mut facts = vec![
        format!("NC text: {file}, {lines} lines, body sha256 {hash}..."),
        format!("Post: {}, dialect {}", program.post.name, input.post),
        format!("Machine: {}", program.machine.name),
        format!(
            "Machining time: {} (h:mm:ss), from a model of the control, without tool changes",
            clock(certificate.time().get())
        ),
    ];
    let [made, sectors] = certificate.sectors();
    let missing = proof::surfaces::not_machined(certificate).map_or_else(String::new, |missing| format!("; {missing}"));
    facts.push(format!("Machined: {made} of {sectors} sectors{missing}"));
    facts.extend(
        certificate
            .imported
            .iter()
            .map(|imported| proof::surfaces::imported(imported, &certificate.form).replacen('i', "I", 1)),
    );
    facts.extend(proof::summary::not_checked(certificate).map(|line| line.replacen("not", "Not", 1)));
    facts.extend(input.library.iter().cloned());
    facts.push(end_of_program(program));
    facts.extend(program.machine.assumed.iter().map(|a| format!("Nobody measured on this machine: {a}")));
    SheetSection { facts, ..SheetSection::new("Program") }
}

/// Where the machine stands at the end: where the frame of the end parks it, otherwise at the retract height.
fn end_of_program(program: &Program) -> String {
    let machine = &program.machine;
    let end = Frame::ALL.iter().position(|frame| *frame == Frame::End).unwrap_or_default();
    let fields: Vec<Field> = program.post.frames[end].iter().flat_map(Template::fields).collect();
    let parks = [("X", Field::HomeX, 0), ("Y", Field::HomeY, 1), ("Z", Field::HomeZ, 2)].into_iter().filter_map(
        |(name, field, k)| {
            let place = machine.home[k].or((k == 2).then_some(machine.retract))?;
            fields.contains(&field).then(|| format!("{name} {} mm", trim(place, 4)))
        },
    );
    let parks: Vec<String> = parks.collect();
    let others = "the other axes stay where the last operation leaves them";
    if !parks.is_empty() {
        return format!("At the end of the program the machine parks at {} of the machine; {others}", parks.join(", "));
    }
    let unused = if machine.home == [None; 3] {
        ""
    } else {
        "; the frames of the post do not go to the home of the machine file"
    };
    format!(
        "At the end of the program the gauge line is at the retract height, machine Z {} mm; {others}{unused}",
        trim(machine.retract, 4)
    )
}

/// How the part is turned on the machine, and what that means for the words of the text.
fn part_axes(program: &Program) -> Option<String> {
    let words = if program.words_in_part_frame() {
        "poses of the text are in the part frame"
    } else {
        "words X Y Z of the text count along the axes of the machine there, from the zero"
    };
    let turned = program.machine.part_turned()?;
    Some(format!("In the machine frame, all rotary axes at zero, {turned}; {words}"))
}

fn zero_section(input: SheetInput<'_>) -> SheetSection {
    let program = input.program;
    let [x, y, z] = [0, 1, 2].map(|k| trim(program.machine.part_origin[k], 4));
    let radius = program.stock.profile.iter().map(|p| p[0]).fold(0.0, f64::max);
    let heights = program.stock.profile.iter().map(|p| p[1]);
    let [top, bottom] = [heights.clone().fold(f64::NEG_INFINITY, f64::max), heights.fold(f64::INFINITY, f64::min)];
    let clamping = &program.stock.clamping;
    let extent = clamping
        .radius
        .map_or("at any radius".to_owned(), |r| format!("within a diameter of {} mm", trim(2.0 * r.get(), 3)));
    let mut facts = vec![
        format!("Zero (work offset): origin of the part frame; Z is the axis of rotation of the part"),
        format!("Its place in the machine frame, all rotary axes at zero: X {x}, Y {y}, Z {z} mm"),
        format!(
            "Blank: turned, diameter {} mm, from Z {} to Z {} mm, bore {} mm",
            trim(2.0 * radius, 3),
            trim(bottom, 3),
            trim(top, 3),
            trim(2.0 * program.stock.bore_radius.get(), 3)
        ),
        format!(
            "Clamping: nothing of chuck or fixture may stand above Z {} mm, {extent}",
            trim(clamping.below.get(), 3)
        ),
        format!("Tools are changed with the gauge line at machine Z {} mm", trim(program.machine.retract, 4)),
    ];
    if let Some(turned) = part_axes(program) {
        facts.insert(2, turned);
    }
    if let Some(material) = program.stock.material {
        facts.push(format!("Material: {}", material.name()));
    }
    facts.extend(program.machine.carried.iter().map(|c| {
        let radius = c.profile.iter().map(|p| p[0]).fold(0.0, f64::max);
        let high = c.profile.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
        format!(
            "The proof knows the {}: up to Z {} mm, diameter {} mm",
            c.kind.name(),
            trim(high, 3),
            trim(2.0 * radius, 3)
        )
    }));
    SheetSection { facts, ..SheetSection::new("Zero, blank and clamping") }
}

/// Shape of a cutter in words.
fn cutter(tool: &Tool) -> String {
    let cutter = &tool.solid.cutter;
    let arcs = cutter.arcs();
    let [radius, upper] = [arcs.first(), arcs.last()].map(|arc| arc.map_or(0.0, |a| a.radius));
    let size = match cutter.kind() {
        Kind::Bull => format!(", corner {} mm", trim(radius, 3)),
        Kind::TaperedBall => {
            let half_angle = cutter.first().to;
            format!(", ball radius {} mm, {} deg to the axis", trim(radius, 3), trim(half_angle.to_degrees(), 3))
        }
        Kind::Barrel => {
            format!(", barrel radius {} mm, tip radius {} mm", trim(upper, 3), trim(radius, 3))
        }
        Kind::Flat | Kind::Ball | Kind::Lollipop | Kind::Turned => String::new(),
    };
    format!("{} {} mm{size}", cutter.keyword(), trim(2.0 * tool.solid.radius(), 3))
}

fn tools_section(input: SheetInput<'_>) -> SheetSection {
    let program = input.program;
    let used = |id| program.operations.iter().any(|(_, o)| o.tool == id);
    type Row<'a> = &'a Tool;
    let tools = program.tools.iter().filter(|(id, _)| used(*id)).map(|(_, tool)| tool);
    let stick_out = |t: &Row| t.solid.holder.first().map_or("-".to_owned(), |h| trim(h.from, 3));
    let widest = |t: &Row| t.solid.holder.iter().map(|h| h.radius_from.max(h.radius_to)).fold(0.0, f64::max);
    let columns = vec![
        figures("number", 0, Form::WHOLE, |t: &Row| t.number.to_string()),
        words("name", 0, |t: &Row| t.name.clone()),
        words("cutter", 0, |t: &Row| cutter(t)),
        figures("flutes", 0, Form::WHOLE, |t: &Row| t.flutes.to_string()),
        figures("flute length mm", 0, Form::WHOLE, |t: &Row| trim(t.solid.flute_length, 3)),
        figures("stick-out mm", 0, Form::WHOLE, stick_out),
        figures("widest holder diameter mm", 0, Form::WHOLE, |t: &Row| trim(2.0 * widest(t), 3)),
        figures("length tip to gauge line mm", 0, Form::WHOLE, |t: &Row| trim(t.length(), 4)),
    ];
    SheetSection { table: Some(Table::new("", tools, columns)), ..SheetSection::new("Tools") }
}

fn operations_section(input: SheetInput<'_>) -> SheetSection {
    let fact = "The program can be started at each restart point: the operation says all that it needs";
    let table = proof::operations::operations(Text::Sheet, input.program, input.certificate, input.restarts);
    SheetSection { facts: vec![fact.to_owned()], table: Some(table), ..SheetSection::new("Operations") }
}

fn axes_section(input: SheetInput<'_>) -> SheetSection {
    SheetSection { table: Some(proof::machine::axes(Text::Sheet, input.certificate)), ..SheetSection::new("Axes") }
}

fn contracts_section(input: SheetInput<'_>) -> SheetSection {
    let table = proof::contracts::contracts(Text::Sheet, input.certificate);
    let facts = input.certificate.allowed.iter().map(|a| format!("Allowed: {}", allowed_line(a))).collect();
    SheetSection { facts, table: Some(table), ..SheetSection::new("Contracts") }
}

/// How to check the sense of a rotary axis by hand.
fn sense(axis: &RotaryAxis, carries: Carries) -> String {
    let what = if carries == Carries::Part { "table" } else { "head" };
    // A positive word in the ISO sense turns the tool right-handed relative to the part: a table the other way.
    let clockwise = (axis.word_sign > 0.0) == (carries == Carries::Tool);
    let way = if clockwise { "clockwise" } else { "counter-clockwise" };
    format!(
        "Turn {} from 0 to 5 deg by hand, and look along the positive direction of its axis: the {what} must turn {way}",
        axis.name
    )
}

fn first_run_section(input: SheetInput<'_>) -> SheetSection {
    let machine = &input.program.machine;
    let mut steps = vec![
        "Compare the hash of the NC text on the control with this sheet: `impellerc verify` with the certificate"
            .to_owned(),
        "Measure each tool: its length must be that of the table above, its diameter and corner as well".to_owned(),
        "Measure stick-out and holder: a holder that is wider or sits lower is not proved".to_owned(),
        "Touch the zero: the part must run true about Z, and the work offset must be the origin above".to_owned(),
    ];
    steps.extend(machine.rotary.iter().zip(machine.chain.axes()).map(|(axis, line)| sense(axis, line.carries)));
    if machine.chain.has_head() {
        steps.push(
            "The proof does not know the body of the head: drive to the largest tilt at the lowest Z without a part"
                .to_owned(),
        );
    }
    steps.extend(input.assumptions.iter().map(|what| format!("The proof assumes, and you check: {what}")));
    steps.extend([
        "Run the program once in the air: work offset raised by more than the height of the blank, single block through \
         the first approach, rapid override low"
            .to_owned(),
        "Run the first operation with the feed override at 50 %, and with a hand at the stop".to_owned(),
    ]);
    SheetSection { steps, ..SheetSection::new("Checks before the first run") }
}
