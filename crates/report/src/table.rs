//! One table, and how each kind of text shows it: columns on a terminal, Markdown, the page of the report, a sheet for printing.

use crate::markup::escaped;
use base::units::{Deg, Mm, Mm2, Mm3, Share};
use std::borrow::Cow;

/// How a number is written: its factor, its decimals, and what follows it.
#[derive(Clone, Copy)]
pub(crate) struct Form(f64, usize, &'static str);

impl Form {
    /// Without decimals.
    pub(crate) const WHOLE: Self = Self(1.0, 0, "");
    /// One decimal.
    pub(crate) const TENTHS: Self = Self(1.0, 1, "");
    /// Two decimals.
    pub(crate) const HUNDREDTHS: Self = Self(1.0, 2, "");
    /// Three decimals.
    pub(crate) const THOUSANDTHS: Self = Self(1.0, 3, "");
    /// Four decimals.
    pub(crate) const FINE: Self = Self(1.0, 4, "");
    /// Whole millimetres with their unit.
    pub(crate) const MM: Self = Self(1.0, 0, " mm");
    /// Millimetres as micrometres.
    pub(crate) const UM: Self = Self(1e3, 2, "");
    /// Millimetres as metres, or cubic millimetres as cubic centimetres.
    pub(crate) const THOUSANDS: Self = Self(1e-3, 2, "");
    /// A share in percent.
    pub(crate) const PERCENT: Self = Self(100.0, 1, " %");
    /// The same with two decimals.
    pub(crate) const CLOSE_PERCENT: Self = Self(100.0, 2, " %");
    /// A share in percent without decimals.
    pub(crate) const WHOLE_PERCENT: Self = Self(100.0, 0, " %");
    /// A share in percent, its unit in the heading.
    pub(crate) const PER_HUNDRED: Self = Self(100.0, 1, "");
    /// A rate by seconds as one by minutes.
    pub(crate) const BY_MINUTE: Self = Self(60.0, 1, "");

    /// The text of a number.
    pub(crate) fn of(self, value: f64) -> String {
        let Self(factor, decimals, unit) = self;
        format!("{:.decimals$}{unit}", value * factor)
    }
}

/// What a column says of a row: a number, which each text writes in its form, or words.
pub(crate) enum Figure {
    Number(f64),
    Words(String),
}

impl Figure {
    /// What stands where there is no figure.
    pub(crate) fn or(value: Option<impl Into<f64>>, none: &str) -> Self {
        value.map_or_else(|| Self::Words(none.to_owned()), |value| Self::Number(value.into()))
    }
}

impl From<f64> for Figure {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

/// A quantity as its number: what a text does with it is its form.
macro_rules! quantities {
    ($($unit:ident),*) => {
        $(impl From<$unit> for Figure {
            fn from(quantity: $unit) -> Self {
                Self::Number(quantity.get())
            }
        })*
    };
}

quantities!(Mm, Mm2, Mm3, Deg, Share);

impl From<usize> for Figure {
    fn from(count: usize) -> Self {
        Self::Words(count.to_string())
    }
}

impl From<String> for Figure {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

/// A cell of a table.
struct Cell {
    text: String,
    /// Class on the page, as `bad`; empty without one.
    mark: &'static str,
    /// Place on the page to which a click leads.
    place: Option<usize>,
}

/// A column: its heading, its width and side on a terminal.
struct Heading {
    text: Cow<'static, str>,
    width: usize,
    right: bool,
    /// Blanks before it on a terminal.
    gap: usize,
    /// Longer words lose their end on a terminal.
    cut: bool,
}

/// What a column says of a row.
type OfRow<'a, R, T> = Box<dyn Fn(&R) -> T + 'a>;

/// A column of rows `R`.
pub(crate) struct Column<'a, R> {
    heading: Heading,
    form: Form,
    figure: OfRow<'a, R, Figure>,
    mark: Option<OfRow<'a, R, &'static str>>,
    place: Option<OfRow<'a, R, Option<usize>>>,
}

/// A column of words, on the left side.
pub(crate) fn words<'a, R>(
    heading: impl Into<Cow<'static, str>>,
    width: usize,
    words: impl Fn(&R) -> String + 'a,
) -> Column<'a, R> {
    let heading = Heading { text: heading.into(), width, right: false, gap: 1, cut: false };
    let figure = Box::new(move |row: &R| Figure::Words(words(row)));
    Column { heading, form: Form::WHOLE, figure, mark: None, place: None }
}

/// A column of figures, on the right side.
pub(crate) fn figures<'a, R, F: Into<Figure>>(
    heading: impl Into<Cow<'static, str>>,
    width: usize,
    form: Form,
    figure: impl Fn(&R) -> F + 'a,
) -> Column<'a, R> {
    let heading = Heading { text: heading.into(), width, right: true, gap: 1, cut: false };
    Column { heading, form, figure: Box::new(move |row: &R| figure(row).into()), mark: None, place: None }
}

impl<'a, R> Column<'a, R> {
    /// Two blanks before it.
    pub(crate) fn with_gap(mut self) -> Self {
        self.heading.gap = 2;
        self
    }

    /// Words that are longer than the column lose their end.
    pub(crate) fn cut(mut self) -> Self {
        self.heading.cut = true;
        self
    }

    /// A class of each cell on the page.
    pub(crate) fn mark(self, mark: impl Fn(&R) -> &'static str + 'a) -> Self {
        Self { mark: Some(Box::new(mark)), ..self }
    }

    /// A place of each cell on the page.
    pub(crate) fn place(self, place: impl Fn(&R) -> Option<usize> + 'a) -> Self {
        Self { place: Some(Box::new(place)), ..self }
    }

    fn cell(&self, row: &R) -> Cell {
        let text = match (self.figure)(row) {
            Figure::Number(value) => self.form.of(value),
            Figure::Words(words) => words,
        };
        let mark = self.mark.as_ref().map_or("", |mark| mark(row));
        Cell { text, mark, place: self.place.as_ref().and_then(|place| place(row)) }
    }
}

/// A table with what stands over and under it.
#[derive(Default)]
pub(crate) struct Table {
    /// Lines over the table on a terminal; the caption on the page.
    title: String,
    headings: Vec<Heading>,
    rows: Vec<Vec<Cell>>,
    /// Lines under it.
    pub(crate) notes: Vec<String>,
}

impl Table {
    /// A table of rows.
    pub(crate) fn new<R>(
        title: impl Into<String>,
        rows: impl IntoIterator<Item = R>,
        columns: Vec<Column<'_, R>>,
    ) -> Self {
        let rows = rows.into_iter().map(|row| columns.iter().map(|column| column.cell(&row)).collect()).collect();
        let headings = columns.into_iter().map(|column| column.heading).collect();
        Self { title: title.into(), headings, rows, notes: Vec::new() }
    }

    /// Lines without a table.
    pub(crate) fn lines(title: impl Into<String>, notes: Vec<String>) -> Self {
        Self { title: title.into(), notes, ..Self::default() }
    }

    /// With lines under it.
    pub(crate) fn with(mut self, notes: impl IntoIterator<Item = String>) -> Self {
        self.notes.extend(notes);
        self
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Columns of a terminal.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        let mut add = |line: &str| {
            text.push_str(line);
            text.push('\n');
        };
        self.title.lines().for_each(&mut add);
        let line = |cells: Vec<&str>| {
            let cells = self.headings.iter().zip(cells);
            let cells: String = cells.map(|(heading, cell)| heading.padded(cell)).collect();
            format!(" {}", cells.trim_end())
        };
        if self.headings.iter().any(|heading| !heading.text.is_empty()) {
            add(&line(self.headings.iter().map(|heading| heading.text.as_ref()).collect()));
        }
        self.rows.iter().for_each(|row| add(&line(row.iter().map(|cell| cell.text.as_str()).collect())));
        self.notes.iter().for_each(|note| add(&format!("  {note}")));
        text
    }

    /// Rows of Markdown.
    pub(crate) fn markdown(&self) -> String {
        // A bar would end a cell.
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let cells = |row: &Vec<Cell>| row.iter().map(|cell| cell.text.replace('|', "\\|")).collect();
        let rows = self.rows.iter().map(|row| line(cells(row)));
        let under = format!("|{}\n", "---|".repeat(self.headings.len()));
        let head = line(self.headings.iter().map(|heading| heading.text.clone().into_owned()).collect());
        [head, under].into_iter().chain(rows).collect()
    }

    /// HTML for printing.
    pub(crate) fn sheet(&self) -> String {
        let row = |tag: &str, cells: Vec<&str>| {
            let cells = cells.into_iter().map(|text| format!("<{tag}>{}</{tag}>", escaped(text)));
            format!("<tr>{}</tr>\n", cells.collect::<String>())
        };
        let head = row("th", self.headings.iter().map(|heading| heading.text.as_ref()).collect());
        let rows = self.rows.iter().map(|cells| row("td", cells.iter().map(|cell| cell.text.as_str()).collect()));
        format!("<table>{head}{}</table>\n", rows.collect::<String>())
    }

    /// HTML of the page of the report, where cells lead to their places.
    pub(crate) fn page(&self) -> String {
        let side = |heading: &Heading| if heading.right && !self.rows.is_empty() { " class=n" } else { "" };
        let head = self.headings.iter().map(|h| format!("<th scope=col{}>{}</th>", side(h), escaped(&h.text)));
        let mut out = format!(
            "<div class=scroll><table><caption>{}</caption><thead><tr>{}</tr></thead><tbody>\n",
            escaped(&self.title),
            head.collect::<String>()
        );
        for row in &self.rows {
            let cells = self.headings.iter().zip(row).enumerate();
            let cells = cells.map(|(k, (heading, cell))| {
                let (open, close) = if k == 0 { ("<th scope=row", "</th>") } else { ("<td", "</td>") };
                format!("{open}{}>{}{close}", cell.class(heading.right), cell.content())
            });
            out.push_str(&format!("<tr>{}</tr>\n", cells.collect::<String>()));
        }
        out + "</tbody></table></div>\n"
    }
}

impl Heading {
    /// A text in the width of the column.
    fn padded(&self, text: &str) -> String {
        let &Self { width, gap, .. } = self;
        let shortened = if self.cut { short(text, width) } else { Cow::Borrowed(text) };
        if self.right { format!("{:gap$}{shortened:>width$}", "") } else { format!("{:gap$}{shortened:<width$}", "") }
    }
}

/// A name that keeps its columns: a longer name loses its end.
fn short(name: &str, columns: usize) -> Cow<'_, str> {
    if name.chars().count() <= columns {
        return Cow::Borrowed(name);
    }
    Cow::Owned(name.chars().take(columns.saturating_sub(2)).chain("..".chars()).collect())
}

impl Cell {
    fn class(&self, right: bool) -> String {
        match (right, self.mark) {
            (false, "") => String::new(),
            (false, mark) => format!(" class=\"{mark}\""),
            (true, "") => " class=\"n\"".to_owned(),
            (true, mark) => format!(" class=\"n {mark}\""),
        }
    }

    fn content(&self) -> String {
        let text = escaped(&self.text);
        match self.place {
            Some(place) => format!("<button type=button class=jump data-place={place}>{text}</button>"),
            None => text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_become_markup() {
        let hostile = "</script><img src=x onerror='a'>&\"<!--@json-->";
        let table = Table::new(
            hostile,
            [()],
            vec![
                words(hostile, 0, |()| hostile.to_owned()),
                figures(hostile, 0, Form::WHOLE, |()| hostile.to_owned()).place(|()| Some(3)),
            ],
        );
        for page in [table.page(), table.sheet()] {
            assert!(!page.contains("<img") && !page.contains("</script") && !page.contains("onerror='"));
        }
    }

    #[test]
    fn each_text_shows_the_same_cells() {
        let table = Table::new(
            "lengths",
            [("a|b", 0.0125), ("a long name", 1.0)],
            vec![
                words("name", 6, |r: &(&str, f64)| r.0.to_owned()).cut(),
                figures("um", 8, Form::UM, |r: &(&str, f64)| r.1).with_gap(),
            ],
        )
        .with(["measured".to_owned()]);
        assert_eq!(table.text(), "lengths\n  name          um\n  a|b        12.50\n  a lo..   1000.00\n  measured\n");
        assert_eq!(table.markdown(), "| name | um |\n|---|---|\n| a\\|b | 12.50 |\n| a long name | 1000.00 |\n");
        assert!(table.page().contains("<tr><th scope=row>a|b</th><td class=\"n\">12.50</td></tr>"));
        assert!(table.sheet().starts_with("<table><tr><th>name</th><th>um</th></tr>\n<tr><td>a|b</td><td>12.50</td>"));
    }
}
