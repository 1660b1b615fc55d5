//! Entities of a Part 21 file: their places by number, and their arguments, read on demand.

use super::lexer::{Lexer, Token, decoded};
use crate::lines::malformed;
use base::source::{SourceId, Span};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};

/// Most entities. A wheel of splines has some 100 000.
const MAX_ENTITIES: usize = 8_000_000;

/// Deepest nesting of lists. The schemas have three.
const MAX_NESTING: usize = 16;

/// An argument.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ArgumentValue<'t> {
    Reference(u64),
    Number(f64),
    Text(&'t str),
    Enumeration(&'t str),
    List(Vec<ArgumentValue<'t>>),
    /// A value with its type, such as `PARAMETER_VALUE(0.5)`.
    Typed(&'t str, Vec<ArgumentValue<'t>>),
    /// `$`, `*`, binary values.
    None,
}

/// A type with its arguments. A complex entity has several.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EntityPart<'t> {
    pub(super) name: &'t str,
    arguments: Vec<ArgumentValue<'t>>,
}

/// An entity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entity<'t> {
    pub(super) number: u64,
    pub(super) span: Span,
    pub(super) parts: Vec<EntityPart<'t>>,
}

/// Where an entity stands: bytes of its text behind `=`, up to its semicolon.
#[derive(Clone, Copy, Debug)]
struct EntityPlace {
    number: u64,
    start: u32,
    end: u32,
}

/// All entities of a file.
#[derive(Debug)]
pub(super) struct EntityTable<'t> {
    source: SourceId,
    text: &'t str,
    places: Vec<EntityPlace>,
}

impl<'t> EntityTable<'t> {
    /// Finds the entities of a file.
    ///
    /// # Errors
    /// A text that is not a complete Part 21 file, a number that two entities have, too many entities.
    pub(super) fn read(source: SourceId, text: &'t str) -> Result<Self, Diag> {
        let mut lexer = Lexer::new(source, text, 0);
        let (first, span) = lexer.next()?;
        if first != Token::Keyword("ISO-10303-21") {
            return Err(malformed("this is not a STEP file", span, "`ISO-10303-21;` is expected"));
        }
        let mut places = Vec::new();
        expect_end(&mut lexer)?;
        loop {
            let (token, span) = lexer.next()?;
            match token {
                Token::Keyword("END-ISO-10303-21") => {
                    expect_end(&mut lexer)?;
                    break;
                }
                Token::Keyword("DATA") => {
                    let (_, end) = skip_record(&mut lexer, span.range().start)?;
                    data(&mut lexer, &mut places, end)?;
                }
                Token::Keyword("HEADER" | "ANCHOR" | "REFERENCE" | "SIGNATURE") => skip_section(&mut lexer, span)?,
                Token::End => return Err(lexer.cut("`END-ISO-10303-21;`", lexer.at())),
                _ => {
                    return Err(malformed(
                        "no section begins here",
                        span,
                        "`DATA;` or `END-ISO-10303-21;` is expected",
                    ));
                }
            }
        }
        places.sort_by_key(|place: &EntityPlace| (place.number, place.start));
        if let Some([first, second]) = places
            .windows(2)
            .find(|pair| pair[0].number == pair[1].number)
            .and_then(|pair| <&[EntityPlace; 2]>::try_from(pair).ok())
        {
            let at = |place: &EntityPlace| lexer.span(place.start as usize, place.end as usize);
            return Err(malformed(
                format!("two entities have the number #{}", first.number),
                at(second),
                "the second one",
            )
            .label(at(first), "the first one"));
        }
        Ok(Self { source, text, places })
    }

    /// The entity of a number; `named_at` is the place of what names it.
    pub(super) fn entity(&self, number: u64, named_at: Span) -> Result<Entity<'t>, Diag> {
        let found = self.places.binary_search_by_key(&number, |place| place.number);
        let Some(place) = found.ok().and_then(|k| self.places.get(k)) else {
            return Err(Diag::error(codes::MALFORMED, format!("the file has no entity #{number}"))
                .label(named_at, "it is named here")
                .help("export the file again"));
        };
        self.parsed(place)
    }

    /// Entities of which a part may have one of these names, in the order of their numbers.
    pub(super) fn of_kinds<'a>(&'a self, names: &'a [&str]) -> impl Iterator<Item = Result<Entity<'t>, Diag>> + 'a {
        let has = |place: &&EntityPlace| {
            let text = &self.text[place.start as usize..place.end as usize];
            let complex = text.trim_start().starts_with('(');
            names.iter().any(|name| if complex { text.contains(name) } else { text.trim_start().starts_with(name) })
        };
        let entities = self.places.iter().filter(has).map(|place| self.parsed(place));
        entities.filter(|entity| entity.as_ref().map_or(true, |e| names.iter().any(|name| e.part(name).is_some())))
    }

    fn parsed(&self, place: &EntityPlace) -> Result<Entity<'t>, Diag> {
        let mut lexer = Lexer::new(self.source, self.text, place.start as usize);
        let span = lexer.span(place.start as usize, place.end as usize);
        let mut parts = Vec::new();
        match lexer.next()? {
            (Token::Keyword(name), _) => parts.push(part(&mut lexer, name)?),
            (Token::Open, _) => loop {
                match lexer.next()? {
                    (Token::Keyword(name), _) => parts.push(part(&mut lexer, name)?),
                    (Token::Close, _) if !parts.is_empty() => break,
                    (_, span) => return Err(malformed("an entity has no type", span, "a type is expected")),
                }
            },
            (_, span) => return Err(malformed("an entity has no type", span, "a type is expected")),
        }
        match lexer.next()? {
            (Token::Semicolon, _) => Ok(Entity { number: place.number, span, parts }),
            (_, span) => Err(malformed("an entity goes on behind its arguments", span, "`;` is expected")),
        }
    }
}

fn expect_end(lexer: &mut Lexer<'_>) -> Result<(), Diag> {
    match lexer.next()? {
        (Token::Semicolon, _) => Ok(()),
        (Token::End, span) => Err(lexer.cut("`;`", span.range().start)),
        (_, span) => Err(malformed("`;` is missing", span, "`;` is expected")),
    }
}

/// Goes over words up to a semicolon outside of parentheses; returns where the first began and the last ended.
fn skip_record(lexer: &mut Lexer<'_>, began: usize) -> Result<(usize, usize), Diag> {
    let mut depth = 0_usize;
    let mut start = None;
    loop {
        let (token, span) = lexer.next()?;
        let range = span.range();
        match token {
            Token::Semicolon if depth == 0 => return Ok((start.unwrap_or(range.start), range.start)),
            Token::Semicolon => {
                return Err(malformed("a parenthesis is open at the end of an entity", span, "`)` is expected"));
            }
            Token::Equals => {
                return Err(malformed("an entity does not end", span, "`;` is expected before the next entity"));
            }
            Token::End => return Err(lexer.cut("the end of an entity", began)),
            Token::Open => depth += 1,
            Token::Close => match depth.checked_sub(1) {
                Some(less) => depth = less,
                None => return Err(malformed("a parenthesis is closed but not open", span, "this one")),
            },
            _ => {}
        }
        start = start.or(Some(range.start));
    }
}

/// Goes over a section that has no entities.
fn skip_section(lexer: &mut Lexer<'_>, begins: Span) -> Result<(), Diag> {
    loop {
        match lexer.next()? {
            (Token::Keyword("ENDSEC"), _) => return expect_end(lexer),
            (Token::End, _) => return Err(lexer.cut("`ENDSEC;`", begins.range().start)),
            _ => {}
        }
    }
}

/// Finds the entities of a section.
fn data(lexer: &mut Lexer<'_>, places: &mut Vec<EntityPlace>, begins: usize) -> Result<(), Diag> {
    loop {
        let (token, span) = lexer.next()?;
        match token {
            Token::Keyword("ENDSEC") => return expect_end(lexer),
            Token::Reference(number) => {
                let (Token::Equals, _) = lexer.next()? else {
                    return Err(malformed(format!("#{number} is no entity"), span, "`=` is expected behind it"));
                };
                let (start, end) = skip_record(lexer, span.range().start)?;
                if places.len() >= MAX_ENTITIES {
                    return Err(Diag::error(codes::TOO_MUCH, format!("more than {MAX_ENTITIES} entities, the limit"))
                        .label(span, "this one exceeds it")
                        .help("export one sector of the wheel alone"));
                }
                let byte = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
                places.push(EntityPlace { number, start: byte(start), end: byte(end) });
            }
            Token::End => return Err(lexer.cut("`ENDSEC;`", begins)),
            _ => return Err(malformed("no entity begins here", span, "`#` and its number are expected")),
        }
    }
}

/// The arguments of a type.
fn part<'t>(lexer: &mut Lexer<'t>, name: &'t str) -> Result<EntityPart<'t>, Diag> {
    match lexer.next()? {
        (Token::Open, _) => Ok(EntityPart { name, arguments: list(lexer, 0)? }),
        (_, span) => Err(malformed(format!("`{}` has no arguments", printable(name)), span, "`(` is expected")),
    }
}

/// The values of a list whose parenthesis is open.
fn list<'t>(lexer: &mut Lexer<'t>, depth: usize) -> Result<Vec<ArgumentValue<'t>>, Diag> {
    let mut values = Vec::new();
    loop {
        let (token, span) = lexer.next()?;
        if depth >= MAX_NESTING {
            return Err(malformed("lists are nested too deeply", span, "this list"));
        }
        let value = match token {
            Token::Close if values.is_empty() => return Ok(values),
            Token::Reference(number) => ArgumentValue::Reference(number),
            Token::Number(x) => ArgumentValue::Number(x),
            Token::Text(text) => ArgumentValue::Text(text),
            Token::Enumeration(word) => ArgumentValue::Enumeration(word),
            Token::Omitted | Token::Derived | Token::Binary => ArgumentValue::None,
            Token::Open => ArgumentValue::List(list(lexer, depth + 1)?),
            Token::Keyword(name) => match lexer.next()? {
                (Token::Open, _) => ArgumentValue::Typed(name, list(lexer, depth + 1)?),
                (_, span) => return Err(malformed("a typed value has no value", span, "`(` is expected")),
            },
            _ => return Err(malformed("this is not a value", span, "a value is expected")),
        };
        values.push(value);
        match lexer.next()? {
            (Token::Comma, _) => {}
            (Token::Close, _) => return Ok(values),
            (_, span) => return Err(malformed("a list goes on without a comma", span, "`,` or `)` is expected")),
        }
    }
}

impl<'t> Entity<'t> {
    /// Its name: that of its only part, or those of all.
    pub(super) fn name(&self) -> String {
        let names: Vec<_> = self.parts.iter().map(|part| printable(part.name)).collect();
        names.join(" ")
    }

    pub(super) fn part(&self, name: &str) -> Option<&EntityPart<'t>> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// The fault of an argument.
    pub(super) fn fault(&self, message: impl Into<String>) -> Diag {
        Diag::error(codes::MALFORMED, message)
            .label(self.span, format!("#{}", self.number))
            .help("export the file again; a file that was changed by hand may be faulty here")
    }

    /// EntityArguments of the only part, or of the part of a name.
    pub(super) fn arguments(&self, name: &str) -> Result<EntityArguments<'_, 't>, Diag> {
        let part = if let [part] = self.parts.as_slice() { Some(part) } else { self.part(name) };
        let part = part.ok_or_else(|| self.fault(format!("#{} has no {name}", self.number)))?;
        Ok(EntityArguments { entity: self, values: &part.arguments })
    }
}

/// EntityArguments of an entity, by their places from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct EntityArguments<'a, 't> {
    entity: &'a Entity<'t>,
    values: &'a [ArgumentValue<'t>],
}

impl<'t> EntityArguments<'_, 't> {
    fn wrong(&self, k: usize, due: &str) -> Diag {
        self.entity.fault(format!("argument {} of {} is not {due}", k + 1, self.entity.name()))
    }

    fn value(&self, k: usize) -> Option<&ArgumentValue<'t>> {
        self.values.get(k)
    }

    pub(super) fn number(&self, k: usize) -> Result<f64, Diag> {
        let value = match self.value(k) {
            Some(ArgumentValue::Typed(_, inner)) if inner.len() == 1 => inner.first(),
            value => value,
        };
        match value {
            Some(ArgumentValue::Number(x)) => Ok(*x),
            _ => Err(self.wrong(k, "a number")),
        }
    }

    pub(super) fn reference(&self, k: usize) -> Result<u64, Diag> {
        match self.value(k) {
            Some(ArgumentValue::Reference(number)) => Ok(*number),
            _ => Err(self.wrong(k, "an entity")),
        }
    }

    pub(super) fn text(&self, k: usize) -> String {
        match self.value(k) {
            Some(ArgumentValue::Text(raw)) => decoded(raw),
            _ => String::new(),
        }
    }

    pub(super) fn word(&self, k: usize) -> Option<&'t str> {
        if let Some(ArgumentValue::Enumeration(word)) = self.value(k) { Some(word) } else { None }
    }

    fn list(&self, k: usize, due: &str) -> Result<&[ArgumentValue<'t>], Diag> {
        match self.value(k) {
            Some(ArgumentValue::List(values)) => Ok(values),
            _ => Err(self.wrong(k, due)),
        }
    }

    /// Whether an argument has a value.
    pub(super) fn is_given(&self, k: usize) -> bool {
        !matches!(self.value(k), None | Some(ArgumentValue::None))
    }

    /// A list of numbers.
    pub(super) fn numbers(&self, k: usize) -> Result<Vec<f64>, Diag> {
        let due = "a list of numbers";
        numbers(self.list(k, due)?).ok_or_else(|| self.wrong(k, due))
    }

    /// A whole number from 0.
    pub(super) fn count(&self, k: usize) -> Result<usize, Diag> {
        whole(self.number(k)?).ok_or_else(|| self.wrong(k, "a whole number"))
    }

    /// A list of whole numbers from 0.
    pub(super) fn counts(&self, k: usize) -> Result<Vec<usize>, Diag> {
        let all: Option<Vec<usize>> = self.numbers(k)?.into_iter().map(whole).collect();
        all.ok_or_else(|| self.wrong(k, "a list of whole numbers"))
    }

    fn rows<T>(
        &self,
        k: usize,
        due: &str,
        of: fn(&[ArgumentValue<'t>]) -> Option<Vec<T>>,
    ) -> Result<Vec<Vec<T>>, Diag> {
        let row = |value: &ArgumentValue<'t>| if let ArgumentValue::List(row) = value { of(row) } else { None };
        self.list(k, due)?.iter().map(row).collect::<Option<Vec<_>>>().ok_or_else(|| self.wrong(k, due))
    }

    /// Rows of numbers.
    pub(super) fn rows_of_numbers(&self, k: usize) -> Result<Vec<Vec<f64>>, Diag> {
        self.rows(k, "a list of lists of numbers", numbers)
    }

    /// Rows of entities.
    pub(super) fn rows_of_references(&self, k: usize) -> Result<Vec<Vec<u64>>, Diag> {
        self.rows(k, "a list of lists of entities", references)
    }

    pub(super) fn references(&self, k: usize) -> Result<Vec<u64>, Diag> {
        let due = "a list of entities";
        references(self.list(k, due)?).ok_or_else(|| self.wrong(k, due))
    }
}

fn numbers(values: &[ArgumentValue<'_>]) -> Option<Vec<f64>> {
    values.iter().map(|value| if let ArgumentValue::Number(x) = value { Some(*x) } else { None }).collect()
}

/// A whole number that is not too large for an index.
fn whole(x: f64) -> Option<usize> {
    (x.fract() == 0.0 && (0.0..1e9).contains(&x)).then_some(x as usize)
}

fn references(values: &[ArgumentValue<'_>]) -> Option<Vec<u64>> {
    values.iter().map(|value| if let ArgumentValue::Reference(number) = value { Some(*number) } else { None }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file around entities.
    fn file(data: &str) -> String {
        format!("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('A'));\nENDSEC;\nDATA;\n{data}ENDSEC;\nEND-ISO-10303-21;\n")
    }

    #[test]
    fn entities_are_found_and_parsed() {
        let text = file("#7=A('x',(#2,#3),.U.);\n/* #9=C(); */ #2 = (B(1.5) C($,*));\n");
        let table = EntityTable::read(SourceId::default(), &text).unwrap();
        let at = Span::default();
        let a = table.entity(7, at).unwrap();
        let arguments = a.arguments("A").unwrap();
        assert_eq!((arguments.text(0), arguments.references(1).unwrap()), ("x".to_owned(), vec![2, 3]));
        assert_eq!((arguments.word(2), a.name()), (Some("U"), "A".to_owned()));
        let complex = table.entity(2, at).unwrap();
        assert!(complex.arguments("B").unwrap().number(0).is_ok_and(|x| (x - 1.5).abs() < 1e-15));
        assert!(complex.part("C").is_some() && table.entity(9, at).is_err());
        let found: Vec<u64> = table.of_kinds(&["C"]).map(|e| e.unwrap().number).collect();
        assert_eq!(found, [2]);
    }

    /// However long the start of a file is, it is refused, and no place lies behind its end.
    #[test]
    fn cut_files_are_refused() {
        let text = file("#1=A('it''s',(1.,2.));\n#2=(B(#1) C(.T.));\n");
        for end in 0..text.trim_end().len() {
            let diag = EntityTable::read(SourceId::default(), &text[..end]).expect_err("cut off");
            assert!(diag.help.is_some() && diag.labels.iter().all(|l| l.span.range().end <= end), "{end}");
        }
        assert!(EntityTable::read(SourceId::default(), &text).is_ok());
    }

    #[test]
    fn faulty_files_are_refused() {
        for data in ["#1=A();#1=B();", "#1=A(", "#1=A());", "#1=A(;", "#1 A();", "A();", "#1=A()#2=B();", "#1=A('x);"] {
            assert!(EntityTable::read(SourceId::default(), &file(data)).is_err(), "{data}");
        }
        let deep = format!("#1=A({}{});#2=A(1 2);#3=1;#4=();#5=A() B();#6=A(,);", "(".repeat(40), ")".repeat(40));
        let text = file(&deep);
        let table = EntityTable::read(SourceId::default(), &text).unwrap();
        for number in 1..=6 {
            assert!(table.entity(number, Span::default()).is_err(), "#{number}");
        }
    }
}
