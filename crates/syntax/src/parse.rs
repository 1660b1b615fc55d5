//! From text to [`File`]: pest reads one item after another, and its pairs become the tree.

use super::ast::{
    Block, Entry, Expr, ExprKind, File, Item, ItemKind, Name, Operator, Path, Point, Revolved, ScopeTarget, Spline,
    SplinePoints, Text, ToolSource, Value,
};
use super::repair;
use super::scan::{self, ITEMS, ItemText, MAX_FAULTS};
use base::source::{SourceId, Span};
use diagnostics::codes::syntax as codes;
use diagnostics::{Diag, Sink};
use pest::Parser;
use pest::error::{Error, ErrorVariant, InputLocation};
use pest::iterators::{Pair, Pairs};

#[derive(pest_derive::Parser)]
#[grammar = "../../../grammar/job.pest"]
struct JobParser;

/// Larger texts are refused: a job is some kilobytes, a curve file some megabytes.
const MAX_BYTES: usize = 16 << 20;

/// Reads a job. Every fault of the text goes to the sink; the readable items are returned.
pub fn parse(text: &str, source: SourceId, sink: &mut Sink) -> File {
    let broken = File { damaged: true, faulty: true, ..File::default() };
    if text.len() > MAX_BYTES {
        sink.push(
            Diag::error(
                codes::TOO_LARGE,
                format!("the job has {} MB; the limit is {} MB", text.len() >> 20, MAX_BYTES >> 20),
            )
            .help("put long lists of points into a file and read them with `spline from \"file.csv\" curve NAME mm`"),
        );
        return broken;
    }
    if let Some((at, c)) = text.char_indices().find(|(_, c)| c.is_control() && !matches!(c, '\n' | '\r' | '\t')) {
        sink.push(
            Diag::error(codes::NOT_TEXT, "the job is not a text file")
                .label(Span::new(source, at..at + c.len_utf8()), format!("control character U+{:04X}", u32::from(c)))
                .help("give the job file itself, a text file; `impellerc new part.imp` writes one"),
        );
        return broken;
    }
    let before = sink.count();
    let repaired = repair::repaired(text, source, sink);
    let text = repaired.as_deref().unwrap_or(text);
    let Some((pieces, comments)) = scan::scan(text, source, sink) else { return broken };
    if pieces.is_empty() && !sink.has_errors() {
        sink.push(
            Diag::error(codes::EMPTY, "the job is empty")
                .label(Span::new(source, 0..0), "no item behind this place")
                .help(
                    "a job begins with `edition 2026` and has a machine, a part, a stock, tools, operations and a post",
                ),
        );
        return broken;
    }
    let mut file = File { comments, ..File::default() };
    let parsed = sink.count();
    for piece in &pieces {
        if sink.count() - parsed >= MAX_FAULTS {
            file.damaged = true;
            break;
        }
        file.damaged |= piece.unreadable;
        if piece.unreadable {
            continue;
        }
        match read_piece(text, source, piece, sink) {
            Some(item) => file.items.push(item),
            None => file.damaged = true,
        }
    }
    // The parser has errors alone to say.
    file.faulty = sink.count() > before;
    file
}

/// One item; `None` when its head cannot be read.
fn read_piece(text: &str, source: SourceId, piece: &ItemText, sink: &mut Sink) -> Option<Item> {
    let slice = &text[piece.range.clone()];
    let word = scan::first_word(slice);
    if !ITEMS.contains(&word) {
        sink.push(unknown_item(source, piece, slice, word));
        return None;
    }
    let closed;
    let input = if piece.closers.is_empty() {
        slice
    } else {
        closed = format!("{slice}\n{}", piece.closers);
        &closed
    };
    let mut builder = Builder {
        source,
        offset: piece.range.start,
        limit: piece.range.end,
        // A missing bracket is one fault; faults that follow from it are not reported.
        quiet: piece.damaged,
        sink,
    };
    match JobParser::parse(Rule::item_only, input) {
        Ok(mut pairs) => pairs.next().and_then(|pair| builder.item(pair)),
        Err(error) => {
            builder.fault(&error, 0, input);
            None
        }
    }
}

/// Words of other languages that take another file in.
const INCLUDES: [&str; 6] = ["import", "include", "load", "read", "require_file", "call"];

fn unknown_item(source: SourceId, piece: &ItemText, slice: &str, word: &str) -> Diag {
    let start = piece.range.start;
    let length = if word.is_empty() { slice.chars().next().map_or(0, char::len_utf8) } else { word.len() };
    let shown = &slice[..length];
    let diag =
        Diag::error(codes::UNKNOWN_ITEM, format!("`{shown}` is not the name of an item")).known(ITEMS.iter().copied());
    let span = Span::new(source, start..start + length);
    match ITEMS.iter().map(|i| (strsim::damerau_levenshtein(word, i), i)).min() {
        Some((distance, item)) if distance <= 2 && !word.is_empty() => {
            diag.label(span, format!("did you mean `{item}`?")).help(format!("write `{item}`")).fix(span, *item)
        }
        _ if is_of_nc(shown, slice) => Diag::error(codes::MISWRITTEN, format!("`{shown}` is of NC text, not of a job"))
            .label(span, "not of this language")
            .help("remove the line: the post writes head, modes and end of the program"),
        _ if INCLUDES.contains(&word) => diag.label(span, "a job is one file").help(
            "write all items into this file; curves come by `spline from`, machines and tools by `use`, and `impellerc import` \
             writes blades of other files as a part",
        ),
        _ if ["unit", "units"].contains(&word) => {
            diag.label(span, "each value has its unit").help("remove the line, and write values like `2 mm`")
        }
        _ => diag
            .label(span, "an item is expected here")
            .help(format!("items are {}; a comment begins with `//`", ITEMS.join(", "))),
    }
}

/// Whether an item begins as a line of NC text: `G54`, `N10 ...`, `O1001`, `%`.
fn is_of_nc(shown: &str, slice: &str) -> bool {
    let number = shown.strip_prefix(|c: char| c.is_ascii_uppercase()).unwrap_or_default();
    shown == "%" && slice.trim() == "%" || !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())
}

/// The form of the item that a text begins with, for the help of its faults.
fn form_of_item(text: &str) -> Option<&'static str> {
    Some(match scan::first_word(text) {
        "edition" => "write `edition 2026`",
        "use" => "write `use machine \"5mc850-c\"` or `use tools \"carbide\"`",
        "let" => "write `let NAME = VALUE`, such as `let depth = 1.5 mm`",
        "require" => {
            "write `require QUANTITY <= VALUE`, such as `require gouge <= 2 um` or `require clearance >= 0.5 mm on pressure`"
        }
        "allow" => {
            "write quantity, surfaces and a reason in quotes: `allow excess on fillet \"an end mill leaves it\"`"
        }
        "operations" => {
            "write `operations auto`, which chooses tools and operations; or `operation KIND { ... }` for one of your own"
        }
        "post" => "write `post siemens-840d`; `impellerc posts` lists all",
        "tolerance" => "write `tolerance chord 1 um, rough 10 um`",
        _ => return None,
    })
}

/// Words for what pest expected.
fn expectation(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::name | Rule::path => "a name",
        Rule::text => "a quoted text",
        Rule::number | Rule::quantity => "a number",
        Rule::value | Rule::expr | Rule::term | Rule::factor => "a value",
        Rule::equals => "`=`",
        Rule::upto => "`..`",
        Rule::comma => "`,`",
        Rule::block | Rule::open | Rule::named_block | Rule::placed_block => "`{`",
        Rule::close | Rule::entry | Rule::bad_entry => "an entry or `}`",
        Rule::close_list | Rule::point => "a point or `]`",
        Rule::close_group => "`)`",
        Rule::relation => "`<=` or `>=`",
        Rule::kw_curve => "`curve`",
        Rule::kw_on | Rule::scope => "`on`",
        Rule::target => "a surface or an operation",
        Rule::from_file | Rule::points | Rule::kw_from => "`[` or `from`",
        Rule::add_op | Rule::mul_op => "an operator",
        Rule::unit | Rule::metre => "a unit",
        Rule::end | Rule::EOI => "the end",
        _ => return None,
    })
}

struct Builder<'a> {
    source: SourceId,
    offset: usize,
    limit: usize,
    quiet: bool,
    sink: &'a mut Sink,
}

impl Builder<'_> {
    fn span(&self, span: pest::Span<'_>) -> Span {
        self.range(span.start()..span.end())
    }

    /// A range of the item as a place in the whole text; added brackets are at its end.
    fn range(&self, range: std::ops::Range<usize>) -> Span {
        let clamp = |n: usize| (n + self.offset).min(self.limit);
        Span::new(self.source, clamp(range.start)..clamp(range.end))
    }

    /// Reports where the parser stopped; `base` is the place in the item at which `input` begins.
    fn fault(&mut self, error: &Error<Rule>, base: usize, input: &str) {
        if self.quiet || self.sink.count() >= MAX_FAULTS {
            return;
        }
        let at = match error.location {
            InputLocation::Pos(at) | InputLocation::Span((at, _)) => at.min(input.len()),
        };
        let mut words: Vec<&str> = match &error.variant {
            ErrorVariant::ParsingError { positives, .. } => {
                let mut rules: Vec<_> = positives.iter().filter_map(|r| expectation(*r)).collect();
                rules.sort_unstable();
                rules.dedup();
                rules
            }
            ErrorVariant::CustomError { .. } => Vec::new(),
        };
        // An operator or a comma may follow nearly everything, so that naming them does not help.
        if words.iter().any(|w| !matches!(*w, "an operator" | "`,`" | "`..`" | "the end" | "a unit")) {
            words.retain(|w| !matches!(*w, "an operator" | "`,`" | "`..`" | "a unit"));
        }
        let rest = &input[at..];
        let word = scan::first_word(rest);
        let length = match word {
            "" if rest.starts_with("..") => 2,
            "" => rest.chars().next().map_or(0, char::len_utf8),
            word => word.len(),
        };
        let found = match &rest[..length] {
            "" => "the end of the item".to_owned(),
            "\n" => "the end of the line".to_owned(),
            word => format!("`{word}`"),
        };
        let mut diag = Diag::error(codes::UNEXPECTED, format!("{found} is not expected here"));
        let due = match words.as_slice() {
            [] => "unexpected".to_owned(),
            [one] => format!("{one} is expected"),
            [first @ .., last] => format!("{} or {last} is expected", first.join(", ")),
        };
        diag = diag.label(self.range(at + base..at + base + length), due);
        diag = diag.help(if rest.starts_with("..") {
            "give one value; only `allowance vane` has two with `..` between them: `vane 0.2 mm .. 0.4 mm`"
        } else if rest.starts_with('.') {
            "write a digit before the point: 0.5"
        } else if base == 0 && rest.starts_with('{') && scan::first_word(input) == "require" {
            "write each requirement as an item of its own: `require gouge <= 2 um`"
        } else if words.as_slice() == ["`)`"] && !rest.starts_with(['{', '}', ']']) {
            "a comma stands between the values in a bracket: `(0 %, 30 deg)`, `(15, -38.5, 0)`"
        } else if base == 0 && scan::first_word(input) == "require" && input[..at].contains(['<', '>']) {
            "write each requirement as an item on a line of its own: `require gouge <= 2 um`; places follow `on`"
        } else if words.as_slice() == ["the end"] {
            "begin each item on its own line"
        } else {
            let own = (base == 0 && !input[..at].contains('{')).then(|| form_of_item(input)).flatten();
            let entry = "write an entry as a name and its values, such as `depth 1.5 mm`; a comma separates values of one entry";
            own.unwrap_or(entry)
        });
        self.sink.push(diag);
    }

    fn item(&mut self, pair: Pair<'_, Rule>) -> Option<Item> {
        let span = self.span(pair.as_span());
        let rule = pair.as_rule();
        let mut parts = pair.into_inner();
        parts.next(); // keyword
        let kind = match rule {
            Rule::edition => ItemKind::Edition(self.name(&parts.next()?)),
            Rule::use_item => ItemKind::Use { kind: self.name(&parts.next()?), what: self.text(&parts.next()?) },
            Rule::let_item => {
                let name = self.name(&parts.next()?);
                parts.next(); // equals
                ItemKind::Let { name, value: self.expr(parts.next()?)? }
            }
            Rule::part => ItemKind::Part { name: self.name(&parts.next()?), body: self.block(parts.next()?) },
            Rule::stock => ItemKind::Stock { kind: self.name(&parts.next()?), body: self.block(parts.next()?) },
            Rule::tool => {
                let name = self.name(&parts.next()?);
                parts.next(); // equals
                let first = parts.next()?;
                let source = if first.as_rule() == Rule::text {
                    ToolSource::Library(self.text(&first))
                } else {
                    ToolSource::Shape(self.name(&first), self.block(parts.next()?))
                };
                ItemKind::Tool { name, source }
            }
            Rule::operation => {
                let kind = self.name(&parts.next()?);
                let next = parts.next()?;
                if next.as_rule() == Rule::name {
                    let name = Some(self.name(&next));
                    ItemKind::Operation { kind, name, body: self.block(parts.next()?) }
                } else {
                    ItemKind::Operation { kind, name: None, body: self.block(next) }
                }
            }
            Rule::operations => ItemKind::Operations(self.name(&parts.next()?)),
            Rule::tolerance => ItemKind::Tolerance(self.values(parts)),
            Rule::require => {
                let what = self.name(&parts.next()?);
                let mut next = parts.next()?;
                let mut body = None;
                if next.as_rule() == Rule::name {
                    body = Some(self.name(&next));
                    next = parts.next()?;
                }
                let relation = self.name(&next);
                let bound = self.expr(parts.next()?)?;
                let (outside, scope) = self.cuts_and_scope(parts);
                ItemKind::Require { what, body, relation, bound, outside, scope }
            }
            Rule::allow => {
                let what = self.name(&parts.next()?);
                let (mut body, mut scope) = (None, Vec::new());
                let mut next = parts.next()?;
                if next.as_rule() == Rule::name {
                    body = Some(self.name(&next));
                    next = parts.next()?;
                }
                if next.as_rule() == Rule::scope {
                    scope = self.scope(Some(next));
                    next = parts.next()?;
                }
                ItemKind::Allow { what, body, scope, reason: self.text(&next) }
            }
            Rule::post => {
                let name = self.name(&parts.next()?);
                ItemKind::Post { name, body: parts.next().map(|b| self.block(b)) }
            }
            _ => return None,
        };
        Some(Item { kind, span })
    }

    fn name(&self, pair: &Pair<'_, Rule>) -> Name {
        Name { text: pair.as_str().to_owned(), span: self.span(pair.as_span()) }
    }

    fn text(&self, pair: &Pair<'_, Rule>) -> Text {
        Text { text: pair.as_str().trim_matches('"').to_owned(), span: self.span(pair.as_span()) }
    }

    /// Words after `on`; none when there is no scope.
    /// The word after `outside of`, and the scope, in either order.
    fn cuts_and_scope(&self, parts: Pairs<'_, Rule>) -> (Option<Name>, Vec<ScopeTarget>) {
        let (mut outside, mut scope) = (None, Vec::new());
        for part in parts {
            match part.as_rule() {
                Rule::outside => {
                    outside = part.into_inner().find(|p| p.as_rule() == Rule::name).map(|n| self.name(&n));
                }
                _ => scope = self.scope(Some(part)),
            }
        }
        (outside, scope)
    }

    fn scope(&self, pair: Option<Pair<'_, Rule>>) -> Vec<ScopeTarget> {
        let targets = pair.into_iter().flat_map(Pair::into_inner).filter(|p| p.as_rule() == Rule::target);
        targets
            .filter_map(|target| {
                let operation = target.clone().into_inner().any(|p| p.as_rule() == Rule::kw_operation);
                let name = target.into_inner().find(|p| p.as_rule() == Rule::name)?;
                Some(ScopeTarget { operation, name: self.name(&name) })
            })
            .collect()
    }

    fn block(&mut self, pair: Pair<'_, Rule>) -> Block {
        let span = self.span(pair.as_span());
        let mut block = Block { entries: Vec::new(), span, damaged: self.quiet };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::entry => match self.entry(part) {
                    Some(entry) => block.entries.push(entry),
                    None => block.damaged = true,
                },
                Rule::bad_entry => {
                    block.damaged = true;
                    let base = part.as_span().start();
                    if let Err(error) = JobParser::parse(Rule::entry_only, part.as_str()) {
                        self.fault(&error, base, part.as_str());
                    }
                }
                _ => {}
            }
        }
        block
    }

    fn entry(&mut self, pair: Pair<'_, Rule>) -> Option<Entry> {
        let span = self.span(pair.as_span());
        let mut parts = pair.into_inner();
        let name = self.name(&parts.next()?);
        let values = self.values(parts);
        (!values.is_empty()).then_some(Entry { name, values, span })
    }

    fn values(&mut self, parts: Pairs<'_, Rule>) -> Vec<Value> {
        let mut values = Vec::new();
        for part in parts {
            match part.as_rule() {
                Rule::named_block => {
                    let mut inner = part.into_inner();
                    let Some(first) = inner.next() else { continue };
                    if first.as_rule() == Rule::name {
                        let name = self.name(&first);
                        values.extend(inner.next().map(|b| Value::Block(Some(name), self.block(b))));
                    } else {
                        values.push(Value::Block(None, self.block(first)));
                    }
                }
                Rule::placed_block => {
                    let mut inner = part.into_inner();
                    let (Some(at), Some(block)) = (inner.next(), inner.next()) else { continue };
                    let at = self.expr(at);
                    values.extend(at.map(|at| Value::Placed(at, self.block(block))));
                }
                Rule::value => values.extend(part.into_inner().next().and_then(|v| self.value(v))),
                _ => {}
            }
        }
        values
    }

    fn value(&mut self, pair: Pair<'_, Rule>) -> Option<Value> {
        let span = self.span(pair.as_span());
        Some(match pair.as_rule() {
            Rule::expr => Value::Expr(self.expr(pair)?),
            Rule::text => Value::Text(self.text(&pair)),
            Rule::labelled => {
                let mut parts = pair.into_inner();
                let name = self.name(&parts.next()?);
                let first = self.expr(parts.next()?)?;
                // The sign `..` comes before the second value.
                match parts.nth(1) {
                    Some(second) => Value::Range(name, [first, self.expr(second)?]),
                    None => Value::Labelled(name, first),
                }
            }
            Rule::revolve => {
                let inner = pair.into_inner().nth(1)?;
                let revolved = match inner.as_rule() {
                    Rule::spline => Revolved::Own(self.spline(inner)?),
                    _ => Revolved::OfBlade(self.path(inner)),
                };
                Value::Revolve(revolved, span)
            }
            Rule::loops => {
                let mut parts = pair.clone().into_inner();
                if parts.next()?.as_rule() == Rule::kw_loop {
                    Value::Loop(self.spline(pair)?)
                } else {
                    let file = self.text(&parts.nth(1)?);
                    Value::Loops { file, unit: parts.next().map(|u| self.name(&u)), span }
                }
            }
            Rule::spline => Value::Spline(self.spline(pair)?),
            Rule::list => Value::List(self.points(pair.into_inner().next()?), span),
            _ => return None,
        })
    }

    /// Points of a curve behind its first word.
    fn spline(&mut self, pair: Pair<'_, Rule>) -> Option<Spline> {
        let span = self.span(pair.as_span());
        let mut parts = pair.into_inner().skip(1);
        let first = parts.next()?;
        let mut unit = parts.next().map(|u| self.name(&u));
        let points = if first.as_rule() == Rule::from_file {
            let mut inner = first.into_inner().skip(1);
            let file = self.text(&inner.next()?);
            let curve = self.name(&inner.nth(1)?);
            unit = inner.next().map(|u| self.name(&u));
            SplinePoints::File { file, curve }
        } else {
            SplinePoints::Inline(self.points(first))
        };
        Some(Spline { points, unit, span })
    }

    fn points(&mut self, pair: Pair<'_, Rule>) -> Vec<Point> {
        let points = pair.into_inner().filter(|p| p.as_rule() == Rule::point);
        points.filter_map(|p| self.point(p)).collect()
    }

    fn point(&mut self, pair: Pair<'_, Rule>) -> Option<Point> {
        let span = self.span(pair.as_span());
        let expressions = pair.into_inner().filter(|p| p.as_rule() == Rule::expr);
        let coordinates = expressions.map(|e| self.expr(e)).collect::<Option<_>>()?;
        Some(Point { coordinates, span })
    }

    fn path(&self, pair: Pair<'_, Rule>) -> Path {
        let span = self.span(pair.as_span());
        Path { names: pair.into_inner().map(|n| self.name(&n)).collect(), span }
    }

    /// An `expr`, `term` or `factor`. The recursion is as deep as the brackets, and the scanner bounds their depth.
    fn expr(&mut self, pair: Pair<'_, Rule>) -> Option<Expr> {
        let rule = pair.as_rule();
        let mut span = self.span(pair.as_span());
        // A sum or product includes the blanks and comments behind it; its last factor does not.
        let mut last = pair.clone();
        while let Some(inner) = last.clone().into_inner().last().filter(|_| last.as_rule() != Rule::factor) {
            last = inner;
        }
        span.end = self.span(last.as_span()).end;
        let mut parts = pair.into_inner();
        let first = parts.next()?;
        if rule == Rule::factor {
            if first.as_rule() == Rule::minus {
                let inner = self.atom(parts.next()?)?;
                return Some(Expr { kind: ExprKind::Negative(Box::new(inner)), span });
            }
            return self.atom(first);
        }
        let head = self.expr(first)?;
        let mut rest = Vec::new();
        while let (Some(operator), Some(operand)) = (parts.next(), parts.next()) {
            let operator = match operator.as_str() {
                "+" => Operator::Add,
                "-" => Operator::Subtract,
                "*" => Operator::Multiply,
                _ => Operator::Divide,
            };
            rest.push((operator, self.expr(operand)?));
        }
        if rest.is_empty() {
            return Some(head);
        }
        Some(Expr { kind: ExprKind::Chain(Box::new(head), rest), span })
    }

    fn atom(&mut self, pair: Pair<'_, Rule>) -> Option<Expr> {
        let span = self.span(pair.as_span());
        let kind = match pair.as_rule() {
            Rule::quantity => {
                let mut parts = pair.into_inner();
                let number = parts.next()?.as_str().parse().ok()?;
                ExprKind::Number(number, parts.next().map(|u| self.name(&u)))
            }
            Rule::path => ExprKind::Path(self.path(pair)),
            Rule::group => return self.expr(pair.into_inner().next()?),
            _ => return None,
        };
        Some(Expr { kind, span })
    }
}
