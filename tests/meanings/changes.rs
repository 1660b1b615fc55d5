//! How a change is made.

use super::cases::Change;
use super::machines_and_jobs;
use impellerc::ir::Program;

/// A change by a function, under the name that rows have for it.
pub type Named<F> = (&'static str, F);

/// A text, changed.
pub type TextChange = fn(&str) -> String;

/// What is particular to the texts of a dialect.
pub struct Dialect {
    /// Whether an operation begins at a line of the text.
    pub begins: fn(&[&str], usize) -> bool,
    /// Start of the block in the cut.
    pub in_the_cut: fn(&str) -> usize,
    /// Changes of the text by functions.
    pub texts: &'static [Named<TextChange>],
}

/// Changes of the text by functions in every dialect.
pub const TEXTS: &[Named<TextChange>] = &[
    ("lower case", |t| t.to_lowercase()),
    ("cut in the middle", |t| t[..t.len() / 2].to_owned()),
    ("empty", |_| String::new()),
];

/// The function of a name.
pub fn named<F: Copy>(name: &str, tables: &[&[Named<F>]]) -> Option<F> {
    tables.iter().copied().flatten().find(|(own, _)| *own == name).map(|(_, change)| *change)
}

/// Start of the third block at feed in a row, so that its words are those of a cut or a link.
pub fn block_at_feed(text: &str) -> usize {
    let at_feed = |line: &str| {
        line.starts_with("G1 X") || line.starts_with("LN X") || (line.starts_with("L X") && !line.contains("FMAX"))
    };
    let mut starts =
        text.match_indices('\n').map(|(i, _)| i + 1).filter(|i| at_feed(text[*i..].lines().next().unwrap_or("")));
    starts.nth(2).unwrap()
}

/// A changed text; or what the text lacks.
type Made = Result<String, String>;

fn replaced(text: &str, at: Option<usize>, [from, to]: &[String; 2]) -> Made {
    let at = at.ok_or_else(|| format!("{from:?} is not in the text"))?;
    Ok(format!("{}{to}{}", &text[..at], &text[at + from.len()..]))
}

/// The text with another word in the place of the one of an address in the block in the cut; the word begins with a blank.
fn word_changed(text: &str, block: usize, address: &str, new: impl Fn(&str) -> String) -> Made {
    let line = &text[block..block + text[block..].find('\n').unwrap()];
    let at = line.find(&format!(" {address}")).ok_or_else(|| format!("no word {address} is in {line:?}"))?;
    let end = line[at + 1..].find(' ').map_or(line.len(), |n| at + 1 + n);
    let new = new(&line[at..end]);
    Ok(format!("{}{}{new}{}{}", &text[..block], &line[..at], &line[end..], &text[block + line.len()..]))
}

/// Start of the first line that begins like this.
fn line_start(text: &str, start: &str) -> Result<usize, String> {
    text.find(&format!("\n{start}")).map(|at| at + 1).ok_or_else(|| format!("{start:?} begins no line"))
}

/// The start of the line behind the one that begins here.
fn next_line(text: &str, at: usize) -> usize {
    at + text[at..].find('\n').unwrap() + 1
}

/// The head and the operations, in this order, and the last line.
fn ordered(text: &str, begins: fn(&[&str], usize) -> bool, order: &[usize]) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let last = lines.len() - 1;
    let mut starts = vec![0];
    starts.extend((1..last).filter(|i| begins(&lines, *i)));
    starts.push(last);
    assert_eq!(starts.len(), 5, "a head and three operations");
    let pieces = order.iter().map(|k| &lines[starts[*k]..starts[*k + 1]]);
    pieces.chain([&lines[last..]]).flatten().map(|line| format!("{line}\n")).collect()
}

impl Change {
    /// The changed text; or what the change needs and is not there.
    pub fn made(&self, text: &str, dialect: &Dialect, program: &mut Program) -> Made {
        let block = || (dialect.in_the_cut)(text);
        let no_function = |name: &str| format!("no function has the name {name:?}");
        match self {
            Self::First(pieces) => replaced(text, text.find(&pieces[0]), pieces),
            Self::Last(pieces) => replaced(text, text.rfind(&pieces[0]), pieces),
            Self::All(pieces) => {
                replaced(text, text.find(&pieces[0]), pieces)?;
                Ok(text.replace(&pieces[0], &pieces[1]))
            }
            Self::Path(pieces) => {
                let feed = block() - 1;
                replaced(text, text[feed..].find(&pieces[0]).map(|n| n + feed), pieces)
            }
            Self::Move([line, behind]) => {
                let whole = [format!("\n{line}\n"), "\n".to_owned()];
                let rest = replaced(text, text.find(&whole[0]), &whole)?;
                let end = next_line(&rest, line_start(&rest, behind)?);
                Ok(format!("{}{line}\n{}", &rest[..end], &rest[end..]))
            }
            Self::Swap(start) => {
                let at = line_start(text, start)?;
                let next = next_line(text, at);
                let end = next_line(text, next);
                Ok(format!("{}{}{}{}", &text[..at], &text[next..end], &text[at..next], &text[end..]))
            }
            Self::Without(start) => {
                line_start(text, start)?;
                Ok(text.lines().filter(|line| !line.starts_with(start)).map(|line| format!("{line}\n")).collect())
            }
            Self::Insert(line) => Ok(format!("{}{line}\n{}", &text[..block()], &text[block()..])),
            Self::Prefix(piece) => Ok(format!("{piece}{text}")),
            Self::Suffix(piece) => Ok(format!("{text}{piece}")),
            Self::Twice(address) => word_changed(text, block(), address, |word| word.repeat(2)),
            Self::Missing(address) => word_changed(text, block(), address, |_| String::new()),
            Self::Number([address, number]) => word_changed(text, block(), address, |_| format!(" {address}{number}")),
            Self::Address([address, other]) => {
                word_changed(text, block(), address, |word| format!(" {other}{}", &word[1 + address.len()..]))
            }
            Self::Order(order) => Ok(ordered(text, dialect.begins, order)),
            Self::Text(name) => Ok(named(name, &[dialect.texts, TEXTS]).ok_or_else(|| no_function(name))?(text)),
            Self::Machine(name) => {
                named(name, &[machines_and_jobs::MACHINES]).ok_or_else(|| no_function(name))?(&mut program.machine);
                Ok(text.to_owned())
            }
            Self::Job(name) => {
                named(name, &[machines_and_jobs::JOBS]).ok_or_else(|| no_function(name))?(program);
                Ok(text.to_owned())
            }
        }
    }
}
