//! Forged and stale certificates: changes in a certificate, in the head of its text, or in both with matching hashes.
//! Hashes alone reveal the first two; only a measurement of the text against the job reveals the third. The cases are the
//! rows of `certificates.toml`, with words that have to be said (`says`). Where a row has no [`Change`], a function has its name.

use super::cases::parsed;
use super::changes::{Named, named as function};
use super::judging::Verdict::{self, Found, Harmless, Refused};
use super::tally;
use impellerc::report::certificate_file::{CertificateFile, HEAD, NcText, named, sha256};
use libtest_mimic::{Failed, Trial};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;
use tempfile::TempDir;

/// `certificates.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cases {
    least: usize,
    cases: BTreeMap<String, Vec<Case>>,
}

/// A row.
#[derive(Deserialize)]
#[serde(try_from = "toml::Table")]
struct Case {
    name: String,
    /// Where the row has none, the function of its name makes the change.
    change: Option<Change>,
    /// The text is measured against the job as well.
    measured: bool,
    /// All hashes fit again, and the text is measured against the job.
    sealed: bool,
    due: Verdict,
    says: String,
    why: String,
}

/// A change of what is given. Places in the certificate are JSON pointers, with the kind of a contract for its index.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Change {
    /// Another value at a place.
    Set((String, Value)),
    /// A figure at a place, times a factor.
    Scale((String, f64)),
    /// `null` at a place.
    Null(String),
    /// A field or an element is missing.
    Remove(String),
    /// An element is at the end of its list as well.
    Again(String),
    /// Behind the last occurrence of the first piece, the second one is replaced.
    Edit([String; 3]),
    /// The first occurrence of a piece of the certificate is replaced.
    Certificate([String; 2]),
    /// All of them.
    CertificateAll([String; 2]),
    /// The first occurrence of a piece of the NC text is replaced.
    Nc([String; 2]),
    /// All of them.
    NcAll([String; 2]),
    /// In a file of the job, the first occurrence of a piece is replaced.
    Input([String; 3]),
}

impl TryFrom<toml::Table> for Case {
    type Error = String;

    fn try_from(mut row: toml::Table) -> Result<Self, String> {
        let due = Verdict::due(&row)?;
        let mut text = |key: &str| match row.remove(key) {
            Some(toml::Value::String(text)) => Ok(text),
            _ => Err(format!("a case has a text for `{key}`")),
        };
        let (name, says, why) = (text("name")?, text("says")?, text(due.key())?);
        let mut flag = |key: &str| match row.remove(key) {
            None => Ok(false),
            Some(toml::Value::Boolean(flag)) => Ok(flag),
            Some(other) => Err(format!("`{key}` is true or false, not {other}")),
        };
        let (measured, sealed) = (flag("measured")?, flag("sealed")?);
        if row.len() > 1 {
            return Err(format!("a case has one change: {row}"));
        }
        let change = (!row.is_empty()).then(|| toml::Value::Table(row).try_into()).transpose();
        let change = change.map_err(|fault| format!("{name}: {fault}"))?;
        Ok(Self { name, change, measured, sealed, due, says, why })
    }
}

/// Text and certificate as they are given to `verify`, and the files of the job.
#[derive(Clone)]
struct Given {
    nc: String,
    certificate: String,
    /// By the path below the folder of the job.
    job: BTreeMap<&'static str, String>,
}

const MACHINE: &str = "_lib/machines/5mc850-c.toml";
const TOOLS: &str = "_lib/tools/carbide.toml";
const JOB: &str = "small.imp";
const CURVES: &str = "vane_curves.csv";

/// The largest cells that a job may have: the stock has no part in what is told here.
const CELLS: [&str; 2] = ["--stock-cell", "1"];

fn impellerc(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_impellerc")).current_dir(folder).args(arguments).output().unwrap()
}

fn placed(given: &Given) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let files = given.job.iter().map(|(name, text)| (*name, text));
    for (name, text) in files.chain([("part.nc", &given.nc), ("part.json", &given.certificate)]) {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

fn compiled(job: BTreeMap<&'static str, String>, more: &[&str]) -> Given {
    let mut given = Given { nc: String::new(), certificate: String::new(), job };
    let folder = placed(&given);
    let run =
        impellerc(folder.path(), &[&[JOB, "-o", "part.nc", "--certificate", "part.json"][..], &CELLS, more].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    given.nc = std::fs::read_to_string(folder.path().join("part.nc")).unwrap();
    given.certificate = std::fs::read_to_string(folder.path().join("part.json")).unwrap();
    given
}

/// The small job without its flanks, with its library beside it.
static ORIGINAL: LazyLock<Given> = LazyLock::new(|| {
    let read = |path: &str| std::fs::read_to_string(Path::new("jobs").join(path)).unwrap();
    let job = [(JOB, "small/small.imp"), (CURVES, "small/vane_curves.csv"), (MACHINE, MACHINE), (TOOLS, TOOLS)];
    let mut job: BTreeMap<_, _> = job.map(|(name, path)| (name, read(path))).into();
    let text = job.get_mut(JOB).unwrap();
    let [flank, channel] = ["operation flank", "operation channel"].map(|words| text.find(words).unwrap());
    text.replace_range(flank..channel, "");
    // The floor is finished beside what the flanks would have cut, in few lines.
    *text = text.replace("max-depth 4 mm", "max-depth 9 mm").replace("scallop 0.2 mm", "scallop 0.8 mm");
    *text = text.replace("tolerance chord", "allow slot on channel \"no flank before\"\ntolerance chord");
    compiled(job, &[])
});

/// The same for LinuxCNC.
static OTHER_POST: LazyLock<Given> =
    LazyLock::new(|| compiled(ORIGINAL.job.clone(), &["--post", "linuxcnc", "--machine", "5mc850-c-linuxcnc"]));

/// The same with a wider contract on clearance and slower axes.
static OTHER_JOB: LazyLock<Given> = LazyLock::new(|| {
    let mut job = ORIGINAL.job.clone();
    replace(job.get_mut(JOB).unwrap(), "clearance >= 0.5 mm", "clearance >= 0.4 mm");
    compiled(job, &[])
});

fn replace(text: &mut String, from: &str, to: &str) {
    assert!(text.contains(from), "{from:?} is not in the text");
    *text = text.replacen(from, to, 1);
}

fn replace_all(text: &mut String, from: &str, to: &str) {
    assert!(text.contains(from), "{from:?} is not in the text");
    *text = text.replace(from, to);
}

/// The certificate as a value, changed.
fn with_value(given: &mut Given, change: impl FnOnce(&mut Value)) {
    let mut all: Value = serde_json::from_str(&given.certificate).unwrap();
    change(&mut all);
    given.certificate = serde_json::to_string_pretty(&all).unwrap() + "\n";
}

/// The value at a place.
fn at<'a>(all: &'a mut Value, place: &str) -> &'a mut Value {
    let with_index = place.strip_prefix("/measured/contracts/").and_then(|rest| {
        let (kind, field) = rest.split_once('/')?;
        let contracts = all["measured"]["contracts"].as_array()?;
        let index = contracts.iter().position(|contract| contract["kind"] == kind)?;
        Some(format!("/measured/contracts/{index}/{field}"))
    });
    all.pointer_mut(with_index.as_deref().unwrap_or(place))
        .unwrap_or_else(|| panic!("{place} is not in the certificate"))
}

fn scale(given: &mut Given, place: &str, factor: f64) {
    with_value(given, |all| {
        let value = at(all, place);
        *value = (value.as_f64().unwrap_or_else(|| panic!("{place} is no figure")) * factor).into();
    });
}

/// The list or the object of a place, and the key in it.
fn parent<'a, 'p>(all: &'a mut Value, place: &'p str) -> (&'a mut Value, &'p str) {
    let (parent, key) = place.rsplit_once('/').unwrap();
    (at(all, parent), key)
}

impl Change {
    fn make(&self, given: &mut Given) {
        match self {
            Self::Set((place, value)) => with_value(given, |all| *at(all, place) = value.clone()),
            Self::Scale((place, factor)) => scale(given, place, *factor),
            Self::Null(place) => with_value(given, |all| *at(all, place) = Value::Null),
            Self::Remove(place) => with_value(given, |all| match parent(all, place) {
                (Value::Array(list), index) => drop(list.remove(index.parse().unwrap())),
                (fields, key) => drop(fields.as_object_mut().unwrap().remove(key).unwrap()),
            }),
            Self::Again(place) => with_value(given, |all| {
                let (list, index) = parent(all, place);
                let same = list[index.parse::<usize>().unwrap()].clone();
                list.as_array_mut().unwrap().push(same);
            }),
            Self::Edit([behind, from, to]) => {
                let text = &mut given.certificate;
                let start = text.rfind(behind).unwrap_or_else(|| panic!("{behind} is not in the certificate"));
                let found = start + text[start..].find(from).unwrap_or_else(|| panic!("{from} behind {behind}"));
                text.replace_range(found..found + from.len(), to);
            }
            Self::Certificate([from, to]) => replace(&mut given.certificate, from, to),
            Self::CertificateAll([from, to]) => replace_all(&mut given.certificate, from, to),
            Self::Nc([from, to]) => replace(&mut given.nc, from, to),
            Self::NcAll([from, to]) => replace_all(&mut given.nc, from, to),
            Self::Input([file, from, to]) => replace(given.job.get_mut(file.as_str()).unwrap(), from, to),
        }
    }
}

/// The first other digit in the place of one of a hash in the head of the text.
fn other_digit(given: &mut Given, word: &str) {
    let at = given.nc.find(word).unwrap() + word.len();
    let digit = if given.nc[at..].starts_with('0') { "1" } else { "0" };
    given.nc.replace_range(at..=at, digit);
}

fn line_with(text: &str, word: &str) -> String {
    text.lines().find(|l| l.contains(word)).unwrap().to_owned() + "\n"
}

/// Without the line of the head that has a hash.
fn no_line(given: &mut Given, word: &str) {
    given.nc = given.nc.replacen(&line_with(&given.nc, word), "", 1);
}

/// A piece of the line of the head with this word, replaced.
fn in_line(given: &mut Given, word: &str, from: &str, to: &str) {
    let line = line_with(&given.nc, word);
    let mut changed = line.clone();
    replace(&mut changed, from, to);
    given.nc = given.nc.replacen(&line, &changed, 1);
}

/// The hash of the certificate in the head of the text, written otherwise.
fn other_hash(given: &mut Given, change: impl Fn(&str) -> String) {
    let hash = named(&given.nc, HEAD[2]).unwrap().to_owned();
    given.nc = given.nc.replacen(&hash, &change(&hash), 1);
}

/// The certificate is named a second time, with a hash of zeros, before or behind the right one.
fn named_twice(given: &mut Given, right_one_first: bool) {
    let line = line_with(&given.nc, HEAD[2]);
    let hash = named(&given.nc, HEAD[2]).unwrap().to_owned();
    let wrong = line.replacen(&hash, &"0".repeat(64), 1);
    let both = if right_one_first { format!("{line}{wrong}") } else { format!("{wrong}{line}") };
    given.nc = given.nc.replacen(&line, &both, 1);
}

fn hash_behind_the_first_block(given: &mut Given) {
    let line = line_with(&given.nc, HEAD[2]);
    no_line(given, HEAD[2]);
    let at = given.nc.find("G17").unwrap();
    let end = at + given.nc[at..].find('\n').unwrap() + 1;
    given.nc.insert_str(end, &line);
}

fn no_spaces(given: &mut Given) {
    let all: Value = serde_json::from_str(&given.certificate).unwrap();
    given.certificate = all.to_string();
}

fn without_a_condition(given: &mut Given) {
    let mut file: CertificateFile = serde_json::from_str(&given.certificate).unwrap();
    file.nc.assumed.pop().unwrap();
    given.certificate = file.json().unwrap();
}

fn lower_excess(given: &mut Given) {
    let all: Value = serde_json::from_str(&given.certificate).unwrap();
    let surfaces = all["measured"]["surfaces"].as_array().unwrap();
    let far = surfaces.iter().position(|s| s["excess"]["value"].as_f64().unwrap() > 0.01).unwrap();
    scale(given, &format!("/measured/surfaces/{far}/excess/value"), 0.5);
}

fn other_inputs(given: &mut Given) {
    let before = named(&given.nc, HEAD[0]).unwrap().to_owned();
    let ones = "1".repeat(64);
    given.nc = given.nc.replacen(&before, &ones, 1);
    with_value(given, |all| *at(all, "/inputs/sha256") = ones.into());
}

/// A block in the middle of the last operation, which cuts the hub.
fn lower_block(given: &mut Given) {
    let lines: Vec<&str> = given.nc.lines().collect();
    let from = lines.iter().rposition(|l| l.contains("channel")).unwrap();
    let cuts: Vec<usize> = (from..lines.len()).filter(|i| lines[*i].contains(" X")).collect();
    let line = lines[cuts[cuts.len() / 2]];
    let at = line.find(" Z").unwrap() + 2;
    let end = line[at..].find(' ').map_or(line.len(), |n| at + n);
    let z: f64 = line[at..end].parse().unwrap();
    let lower = format!("{}{:.4}{}", &line[..at], z - 1.0, &line[end..]);
    given.nc = given.nc.replacen(&format!("{line}\n"), &format!("{lower}\n"), 1);
}

const FUNCTIONS: &[Named<fn(&mut Given)>] = &[
    ("nothing changed", |_| ()),
    ("inputs in the head", |g| other_digit(g, HEAD[0])),
    ("body in the head", |g| other_digit(g, HEAD[1])),
    ("certificate in the head", |g| other_digit(g, HEAD[2])),
    ("no inputs in the head", |g| no_line(g, HEAD[0])),
    ("no body in the head", |g| no_line(g, HEAD[1])),
    ("no certificate in the head", |g| no_line(g, HEAD[2])),
    ("certificate named twice, the right one last", |g| named_twice(g, false)),
    ("certificate named twice, the right one first", |g| named_twice(g, true)),
    ("hash cut short", |g| other_hash(g, |hash| hash[..60].to_owned())),
    ("hash in large letters", |g| other_hash(g, str::to_uppercase)),
    ("hash behind the first block", hash_behind_the_first_block),
    ("figure in the head", |g| in_line(g, "; gouge ", "um", "nm")),
    ("length of a tool in the head", |g| in_line(g, "tool t1 number", "length 1", "length 2")),
    ("one digit of a block", |g| {
        let at = g.nc.rfind(" X1").unwrap();
        g.nc.replace_range(at..at + 3, " X2");
    }),
    ("a line behind the end", |g| g.nc.push_str("; end\n")),
    ("a list", |g| g.certificate = format!("[{}]", g.certificate)),
    ("empty", |g| g.certificate.clear()),
    ("cut in the middle", |g| g.certificate.truncate(g.certificate.len() / 2)),
    ("last bracket cut", |g| g.certificate = g.certificate.trim_end().trim_end_matches('}').to_owned()),
    ("something behind it", |g| g.certificate.push_str("{}")),
    ("no spaces", no_spaces),
    ("a space more at its end", |g| g.certificate.push(' ')),
    ("the NC text", |g| g.certificate = g.nc.clone()),
    ("job", |g| g.certificate = OTHER_JOB.certificate.clone()),
    ("dialect", |g| g.certificate = OTHER_POST.certificate.clone()),
    ("text of another dialect", |g| g.nc = OTHER_POST.nc.clone()),
    ("text of another job", |g| g.nc = OTHER_JOB.nc.clone()),
    ("a condition left out", without_a_condition),
    ("excess of a surface lowered", lower_excess),
    ("inputs of the certificate", other_inputs),
    ("a block lowered by 1 mm", lower_block),
];

/// All hashes fit again, as a forger with the compiler at hand would make them.
fn sealed(given: &mut Given) {
    let body = named(&given.nc, HEAD[1]).unwrap().to_owned();
    let mut file: CertificateFile = serde_json::from_str(&given.certificate).unwrap();
    let now = NcText::new(&file.nc.post, &given.nc, Vec::new());
    given.nc = given.nc.replacen(&body, &now.body_sha256, 1);
    let assumed = std::mem::take(&mut file.nc.assumed);
    let sealed = NcText::new(&file.nc.post, &given.nc, std::mem::take(&mut file.nc.operations));
    file.nc = NcText { assumed, ..sealed };
    given.certificate = file.json().unwrap();
    let before = named(&given.nc, HEAD[2]).unwrap().to_owned();
    given.nc = given.nc.replacen(&before, &sha256(given.certificate.as_bytes()), 1);
}

/// What becomes of what is given, with all that is said.
fn judged(given: &Given, measured: bool) -> (Verdict, String) {
    let folder = placed(given);
    let arguments = ["verify", "part.nc", "--certificate", "part.json", "--error-format", "json"];
    // The cells are those of the certificate.
    let against = ["--job", JOB];
    let run = impellerc(folder.path(), &[&arguments[..], if measured { &against } else { &[] }].concat());
    let said = format!("{}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(!said.contains("panicked"), "{said}");
    let belongs = said.contains("belong together");
    let verdict = match run.status.code() {
        Some(0) if belongs => Harmless,
        // Hashes fit, and measuring finds it.
        Some(1 | 2) if belongs => Found,
        Some(1 | 2) => Refused,
        code => panic!("{code:?}: {said}"),
    };
    (verdict, said)
}

impl Case {
    fn run(&self, class: &str) -> Result<(), Failed> {
        let mut given = ORIGINAL.clone();
        match &self.change {
            Some(change) => change.make(&mut given),
            None => function(&self.name, &[FUNCTIONS]).ok_or("no function has the name of the row")?(&mut given),
        }
        if self.sealed {
            sealed(&mut given);
        }
        let (found, said) = judged(&given, self.measured || self.sealed);
        tally::count("certificates", class, found);
        if found != self.due || !said.contains(&self.says) {
            let said: String = said.chars().take(1500).collect();
            return Err(format!("{found:?}, due {:?} with {:?} ({}): {said}", self.due, self.says, self.why).into());
        }
        tally::list(|| format!("{class}: {}: {found:?}, {}", self.name, self.why));
        Ok(())
    }
}

/// What is wrong with the rows.
fn fault(cases: &Cases) -> Option<String> {
    let all = || cases.cases.iter().flat_map(|(class, cases)| cases.iter().map(move |case| (class, case)));
    let count = all().count();
    if count < cases.least {
        return Some(format!("{count} cases, at least {} are due", cases.least));
    }
    let mut names: Vec<(&String, &str)> = all().map(|(class, case)| (class, case.name.as_str())).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|w| w[0] == w[1]) {
        return Some(format!("{:?} stands twice", twice[0]));
    }
    let by_function = |name: &str| all().any(|(_, case)| case.change.is_none() && case.name == name);
    FUNCTIONS.iter().find(|(name, _)| !by_function(name)).map(|(name, _)| format!("no row has the function {name:?}"))
}

/// Rows that are refused, and words of the reason.
const WRONG: [(&str, &str); 5] = [
    (r#"{ name = "n", sett = ["/format", 1], says = "s", refused = "why" }"#, "unknown variant `sett`"),
    (r#"{ name = "n", null = "/nc", remove = "/nc", says = "s", refused = "why" }"#, "one change"),
    (r#"{ name = "n", null = "/nc", says = "s" }"#, "one of refused, found, harmless"),
    (r#"{ name = "n", null = "/nc", refused = "why" }"#, "`says`"),
    (r#"{ name = "n", null = "/nc", sealed = "yes", says = "s", refused = "why" }"#, "true or false"),
];

fn wrong_rows_are_refused() -> Result<(), Failed> {
    for (row, words) in WRONG {
        let file = format!("least = 1\n[cases]\nform = [\n{row}\n]\n");
        let said = toml::from_str::<Cases>(&file).err().map(|fault| fault.to_string()).unwrap_or_default();
        if !said.contains(words) {
            return Err(format!("{row}: {said:?}").into());
        }
    }
    Ok(())
}

/// The tests.
pub fn trials() -> Vec<Trial> {
    let cases = match parsed::<Cases>(Path::new("tests/meanings/certificates.toml")) {
        Ok(cases) => &*Box::leak(Box::new(cases)),
        Err(fault) => return vec![Trial::test("certificates::file::is read", || Err(fault.into()))],
    };
    let mut trials = vec![Trial::test("certificates::file::no case is missing, and none stands twice", || {
        fault(cases).map_or(Ok(()), |fault| Err(fault.into()))
    })];
    let wrong = "certificates::file::rows that are written wrongly are refused";
    trials.push(Trial::test(wrong, wrong_rows_are_refused));
    for (class, of_class) in &cases.cases {
        trials.extend(
            of_class
                .iter()
                .map(|case| Trial::test(format!("certificates::{class}::{}", case.name), || case.run(class))),
        );
    }
    trials
}
