//! Named input, the text of BladeGen: blocks `Begin NAME` or `New NAME` to `End NAME`, lines `Key=Value`, flags, points `( a,b )`.

use crate::found::{Found, too_many};
use crate::limits;
use crate::lines::{Line, Text, ends};
use crate::nested::Open;
use base::source::Span;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};

/// A line with a key. A flag has no value.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelEntry<'t> {
    key: &'t str,
    value: Option<&'t str>,
    line: Line<'t>,
}

/// A value with its line.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModelValue<'t> {
    pub(super) text: &'t str,
    pub(super) line: Line<'t>,
}

/// A point of a list with its line.
#[derive(Clone, Copy, Debug)]
pub(super) struct ListedPoint<'t> {
    pub(super) at: [f64; 2],
    pub(super) line: Line<'t>,
}

/// A block with what is in it.
#[derive(Debug)]
pub(super) struct ModelSection<'t> {
    pub(super) name: &'t str,
    /// Line at which it begins.
    pub(super) line: Line<'t>,
    entries: Vec<ModelEntry<'t>>,
    blocks: Vec<ModelSection<'t>>,
    pub(super) points: Vec<ListedPoint<'t>>,
}

/// Whether two words are the same: neither case nor blanks count, `Both Ends` is `BothEnds`.
pub(super) fn same(a: &str, b: &str) -> bool {
    let letters = |text: &'_ str| text.chars().filter(|c| !c.is_whitespace()).map(|c| c.to_ascii_lowercase()).collect();
    let [a, b]: [Vec<char>; 2] = [letters(a), letters(b)];
    a == b
}

/// Reads a text to its blocks.
pub(super) fn blocks<'t>(text: Text<'t>, found: &mut Found) -> Result<Vec<ModelSection<'t>>, Diag> {
    let mut open = Open::default();
    let mut stack: Vec<ModelSection<'t>> = Vec::new();
    let mut top = Vec::new();
    let mut count = 0;
    let mut head = true;
    for line in text.lines() {
        if line.text.starts_with('!') {
            if head {
                continue;
            }
            return Err(line.fault("a comment behind the head of the file", "comments stand before all other lines"));
        }
        head = false;
        if let Some(inside) = line.text.strip_prefix('(') {
            point(inside, line, stack.last_mut(), found)?;
            continue;
        }
        count += 1;
        if count > limits::ENTRIES {
            return Err(too_many("lines that are not points", limits::ENTRIES, line.span));
        }
        let (word, rest) = line.text.split_once(char::is_whitespace).unwrap_or((line.text, ""));
        let rest = rest.trim();
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword) && !rest.is_empty() && !rest.starts_with('=');
        if is("Begin") || is("New") {
            open.begin(rest, line)?;
            stack.push(ModelSection { name: rest, line, entries: Vec::new(), blocks: Vec::new(), points: Vec::new() });
        } else if is("End") {
            open.end(rest, line)?;
            if let Some(done) = stack.pop() {
                stack.last_mut().map_or(&mut top, |block| &mut block.blocks).push(done);
            }
        } else {
            let Some(block) = stack.last_mut() else {
                return Err(line.fault("a line outside of the sections", "`Begin NAME` or `New NAME` is expected"));
            };
            block.entries.push(entry(line));
        }
    }
    open.closed(text)?;
    if top.is_empty() {
        return Err(ends(text, "the section `Model`"));
    }
    Ok(top)
}

fn point<'t>(
    inside: &'t str,
    line: Line<'t>,
    block: Option<&mut ModelSection<'t>>,
    found: &mut Found,
) -> Result<(), Diag> {
    let Some(block) = block.filter(|block| same(block.name, "Data")) else {
        return Err(line.fault("a point outside of a list", "points stand in a section `Data`"));
    };
    let Some(inside) = inside.strip_suffix(')') else {
        return Err(line.fault("the bracket of a point is not closed", "`( 12.5,3.75 )` is expected"));
    };
    let at = Line { text: inside, span: line.span }.numbers("two numbers are expected")?;
    block.points.push(ListedPoint { at, line });
    found.point(block.points.len(), line.span)
}

fn entry(line: Line<'_>) -> ModelEntry<'_> {
    match line.text.split_once('=') {
        Some((key, value)) => ModelEntry { key: key.trim(), value: Some(value.trim().trim_matches('"').trim()), line },
        None => ModelEntry { key: line.text, value: None, line },
    }
}

/// The only block with a name, where there is one.
pub(super) fn only_one<'b, 't>(
    blocks: &'b [ModelSection<'t>],
    name: &str,
) -> Result<Option<&'b ModelSection<'t>>, Diag> {
    let mut named = blocks.iter().filter(|block| same(block.name, name));
    let first = named.next();
    match named.next() {
        Some(again) => Err(again.line.fault(format!("the section `{name}` is given again"), "one is expected")),
        None => Ok(first),
    }
}

/// The fault of what is not read, with the way out that always works.
pub(super) fn not_read(message: impl Into<String>, line: Line<'_>, due: &str) -> Diag {
    not_read_at(message, line.span, due)
}

/// The same at a place.
pub(super) fn not_read_at(message: impl Into<String>, at: Span, due: &str) -> Diag {
    Diag::error(codes::NOT_READ, message).label(at, due.to_owned()).help(
        "change it in BladeGen and save the file again, or export the blades as points: `.inf` with its curve files",
    )
}

impl<'t> ModelSection<'t> {
    /// The value of a key, where the block has it.
    pub(super) fn value(&self, key: &str) -> Result<Option<ModelValue<'t>>, Diag> {
        let Some(entry) = self.entry(key)? else { return Ok(None) };
        let text = entry.value.filter(|text| !text.is_empty());
        let text = text.ok_or_else(|| entry.line.fault(format!("`{key}` has no value"), "`Key=Value` is expected"))?;
        Ok(Some(ModelValue { text, line: entry.line }))
    }

    fn entry(&self, key: &str) -> Result<Option<ModelEntry<'t>>, Diag> {
        let mut named = self.entries.iter().filter(|entry| same(entry.key, key));
        let first = named.next().copied();
        match named.next() {
            Some(again) => Err(again.line.fault(format!("`{key}` is given again"), "one is expected")),
            None => Ok(first),
        }
    }

    /// The line of a flag that is set, alone or as `=T`.
    pub(super) fn flag(&self, key: &str) -> Result<Option<Line<'t>>, Diag> {
        let Some(entry) = self.entry(key)? else { return Ok(None) };
        match entry.value {
            None => Ok(Some(entry.line)),
            Some(value) if value.eq_ignore_ascii_case("T") => Ok(Some(entry.line)),
            Some(value) if value.eq_ignore_ascii_case("F") => Ok(None),
            Some(_) => Err(entry.line.fault(format!("`{key}` is a flag"), "T or F is expected")),
        }
    }

    /// The number of a key.
    pub(super) fn number(&self, key: &str) -> Result<Option<(f64, Line<'t>)>, Diag> {
        self.value(key)?.map(|value| Ok((value.line.number(value.text)?, value.line))).transpose()
    }

    /// The fault of a key that is missing: what BladeGen takes then is not known.
    pub(super) fn missing(&self, what: &str) -> Diag {
        let name = printable(self.name);
        Diag::error(codes::NOT_STATED, format!("the section `{name}` does not state `{what}`"))
            .label(self.line.span, "this section")
            .help(format!(
                "add the line `{what}` to the section, or save the file again from BladeGen, which writes all of them"
            ))
    }

    /// Refuses a key that has another value than the one that is read, or none.
    pub(super) fn must_be(&self, key: &str, due: &str) -> Result<(), Diag> {
        let value = self.value(key)?.ok_or_else(|| self.missing(&format!("{key}={due}")))?;
        if same(value.text, due) {
            return Ok(());
        }
        let given = printable(value.text);
        Err(not_read(format!("`{key}={given}` is not read"), value.line, &format!("`{due}` is read")))
    }

    /// Refuses a block without a flag.
    pub(super) fn must_have(&self, flag: &str) -> Result<(), Diag> {
        self.flag(flag)?.map(|_| ()).ok_or_else(|| self.missing(flag))
    }

    /// Refuses keys and blocks that are not known.
    pub(super) fn only(&self, keys: &[&str], blocks: &[&str]) -> Result<(), Diag> {
        let in_this = printable(self.name);
        if let Some(entry) = self.entries.iter().find(|entry| !keys.iter().any(|key| same(entry.key, key))) {
            let key = printable(entry.key);
            let message = format!("`{key}` in the section `{in_this}` is not known");
            return Err(not_read(message, entry.line, "it may change the blade"));
        }
        if let Some(block) = self.blocks.iter().find(|block| !blocks.iter().any(|name| same(block.name, name))) {
            let name = printable(block.name);
            let message = format!("the section `{name}` in the section `{in_this}` is not known");
            return Err(not_read(message, block.line, "it may change the blade"));
        }
        Ok(())
    }

    /// Refuses a block that has something in it.
    pub(super) fn must_be_empty(&self) -> Result<(), Diag> {
        let first = self.entries.first().map(|entry| entry.line).or(self.blocks.first().map(|block| block.line));
        match first {
            Some(line) => {
                let name = printable(self.name);
                Err(not_read(format!("the section `{name}` is not empty"), line, "formulas are not read"))
            }
            None => Ok(()),
        }
    }

    /// The blocks with a name.
    pub(super) fn all(&self, name: &str) -> Vec<&ModelSection<'t>> {
        self.blocks.iter().filter(|block| same(block.name, name)).collect()
    }

    /// The only block with a name, where there is one.
    pub(super) fn block(&self, name: &str) -> Result<Option<&ModelSection<'t>>, Diag> {
        only_one(&self.blocks, name)
    }

    /// The only block with a name, which the file must have.
    pub(super) fn required(&self, name: &str) -> Result<&ModelSection<'t>, Diag> {
        self.block(name)?.ok_or_else(|| {
            Diag::error(codes::ENDS_EARLY, format!("the section `{}` has no section `{name}`", printable(self.name)))
                .label(self.line.span, "this section")
                .help("save the file again from BladeGen")
        })
    }
}
