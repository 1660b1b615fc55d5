//! Moves, lengths, times and clearances of the operations.

use super::{Text, clearance};
use crate::table::{Figure, Form, Table, figures, words};
use base::units::{Mm, Sec, trim};
use ir::{Operation, Program};
use verify::Certificate;
use verify::certificate::OperationReport;
use wheel::contract::clock;

/// An operation, or all of them together.
struct OperationRow<'a> {
    /// Its number.
    at: usize,
    report: &'a OperationReport,
    /// What the job says of it; `None` for all together.
    declared: Option<&'a Operation>,
}

impl OperationRow<'_> {
    /// A figure that the row of all operations does not have.
    fn own(&self, figure: impl Into<Figure>) -> Figure {
        if self.declared.is_some() { figure.into() } else { Figure::Words(String::new()) }
    }

    fn declared(&self, figure: impl Fn(&Operation) -> String) -> Figure {
        Figure::Words(self.declared.map_or_else(String::new, figure))
    }
}

/// All operations together.
fn total(operations: &[OperationReport]) -> OperationReport {
    let mut total = OperationReport {
        name: "total".to_owned(),
        tool: String::new(),
        passes: 0,
        moves: 0,
        length: [Mm(0.0); 3],
        time: [Sec(0.0); 3],
        splines: None,
        shank: None,
        holder: None,
        rapid: None,
    };
    for o in operations {
        total.moves += o.moves;
        for k in 0..3 {
            total.length[k] += o.length[k];
            total.time[k] += o.time[k];
        }
    }
    total
}

/// The rows of a text: Details and page have one of all operations.
fn rows<'a>(
    text: Text<'_>,
    program: &'a Program,
    certificate: &'a Certificate,
    total: &'a OperationReport,
) -> Vec<OperationRow<'a>> {
    let all = certificate.operations.iter().zip(program.operations.iter()).enumerate();
    let mut rows: Vec<OperationRow<'_>> =
        all.map(|(at, (report, (_, declared)))| OperationRow { at, report, declared: Some(declared) }).collect();
    if matches!(text, Text::Details | Text::Page(_)) {
        rows.push(OperationRow { at: rows.len(), report: total, declared: None });
    }
    rows
}

/// The operations. `restarts`: first line of each in the NC text, for the setup sheet.
pub(crate) fn operations(text: Text<'_>, program: &Program, certificate: &Certificate, restarts: &[usize]) -> Table {
    let total = total(&certificate.operations);
    let rows = rows(text, program, certificate, &total);
    type Row<'a> = OperationRow<'a>;
    let name = |r: &Row| r.report.name.clone();
    let tool = |r: &Row| r.report.tool.clone();
    let passes = |r: &Row| r.own(r.report.passes);
    let moves = |r: &Row| r.report.moves;
    let length = |k: usize| move |r: &Row| r.report.length[k];
    let time = |k: usize| move |r: &Row| clock(r.report.time[k].get());
    let far =
        if matches!(text, Text::Page(_)) { format!("over {}", verify::search(program)) } else { "far".to_owned() };
    let shank = |r: &Row| r.own(clearance(r.report.shank.as_ref(), &far));
    let holder = |r: &Row| r.own(clearance(r.report.holder.as_ref(), &far));
    match text {
        Text::Summary | Text::Details => {
            let counts = [figures("passes", 6, Form::WHOLE, passes), figures("moves", 7, Form::WHOLE, moves)];
            let to_part =
                [figures("shank", 8, Form::THOUSANDTHS, shank), figures("holder", 8, Form::THOUSANDTHS, holder)];
            let in_short = matches!(text, Text::Summary);
            let (names, of_moves) = if in_short {
                let of_moves = vec![
                    figures("cutting", 10, Form::MM, length(0)),
                    figures("time", 8, Form::WHOLE, time(0)),
                    figures("links", 8, Form::WHOLE, time(1)),
                    figures("rapids", 8, Form::WHOLE, time(2)),
                ];
                ([words("operation", 14, name).cut(), words("tool", 10, tool).cut()], of_moves)
            } else {
                let of_moves = vec![
                    figures("cut", 9, Form::WHOLE, length(0)),
                    figures("link", 9, Form::WHOLE, length(1)),
                    figures("rapid", 9, Form::WHOLE, length(2)),
                    figures("t cut", 8, Form::WHOLE, time(0)),
                    figures("t link", 8, Form::WHOLE, time(1)),
                    figures("t rapid", 8, Form::WHOLE, time(2)),
                ];
                ([words("operation", 12, name), words("tool", 8, tool)], of_moves)
            };
            let columns = names.into_iter().chain(counts).chain(of_moves).chain(to_part).collect();
            if in_short {
                let notes = ["shank, holder: least distance to the part, mm".to_owned()];
                return Table::new("", rows, columns).with(notes);
            }
            let title = "operations: lengths in mm, times in h:mm:ss, distances of shank and holder to the part in mm";
            Table::new(title, rows, columns).with(splines(&certificate.operations))
        }
        Text::Page(_) => {
            let columns = vec![
                words("operation", 0, name),
                words("tool", 0, tool),
                figures("spindle, rpm", 0, Form::WHOLE, |r: &Row| r.declared(|o| Form::WHOLE.of(o.speed.get()))),
                figures("feed, mm/min", 0, Form::WHOLE, |r: &Row| r.declared(|o| Form::WHOLE.of(o.feed.get()))),
                figures("passes", 0, Form::WHOLE, passes),
                figures("moves", 0, Form::WHOLE, moves),
                figures("cut, m", 0, Form::THOUSANDS, length(0)),
                figures("time cut", 0, Form::WHOLE, time(0)),
                figures("time link", 0, Form::WHOLE, time(1)),
                figures("time rapid", 0, Form::WHOLE, time(2)),
                figures("shank to part, mm", 0, Form::THOUSANDTHS, shank).place(|r: &Row| text.place(r.at, 0)),
                figures("holder to part, mm", 0, Form::THOUSANDTHS, holder).place(|r: &Row| text.place(r.at, 1)),
            ];
            Table::new("Operations (times in h:mm:ss)", rows, columns)
        }
        Text::Sheet => {
            let restart = |r: &Row| restarts.get(r.at).map_or("-".to_owned(), ToString::to_string);
            let columns = vec![
                words("operation", 0, name),
                words("tool", 0, tool),
                figures("speed rpm", 0, Form::WHOLE, |r: &Row| r.declared(|o| trim(o.speed.get(), 1))),
                figures("feed mm/min", 0, Form::WHOLE, |r: &Row| r.declared(|o| trim(o.feed.get(), 1))),
                figures("time", 0, Form::WHOLE, |r: &Row| clock(r.report.time.into_iter().sum::<Sec>().get())),
                figures("restart point: line", 0, Form::WHOLE, restart),
            ];
            Table::new("", rows, columns)
        }
    }
}

/// Spline blocks of each operation that has some.
fn splines(operations: &[OperationReport]) -> impl Iterator<Item = String> {
    operations.iter().filter_map(|o| {
        let s = o.splines?;
        Some(format!(
            "{:<12} {} spline blocks, checked on {} chords that are at most {:.3} um away; the figures include it",
            o.name,
            s.blocks,
            s.chords,
            s.flutes.get() * 1e3
        ))
    })
}
