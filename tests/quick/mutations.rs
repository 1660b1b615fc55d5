//! Random changes of valid texts of every kind that comes from outside: bytes are dropped, doubled or replaced, numbers
//! made extreme, lines dropped, doubled or swapped, the end cut off. Each text is read, or refused with a place.

use crate::support;
use crate::support::pinned::{self, Pinned};
use impellerc::base::source::{Origin, SourceFile, SourceId, SourceMap, Span};
use impellerc::diagnostics::{Severity, Sink, codes, render};
use impellerc::five_axis::control::ModuloWay;
use impellerc::five_axis::{LinearAxis, Machine};
use impellerc::ir::Program;
use impellerc::job::files::shipped;
use impellerc::job::{self, Files, MissingFile};
use impellerc::lower;
use impellerc::nc::{self, MAX_FAULTS, Post, motion_of::motion_of};
use impellerc::report::certificate_file::{self, CertificateFile};
use impellerc::syntax;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Jobs with their curve files.
const JOBS: [[&str; 2]; 3] = [
    [include_str!("../../jobs/reduced/reduced.imp"), include_str!("../../jobs/reduced/vane_curves.csv")],
    [include_str!("../../jobs/wei2021/paper-strategies.imp"), include_str!("../../jobs/reduced/vane_curves.csv")],
    [include_str!("../../jobs/small/small.imp"), include_str!("../../jobs/small/vane_curves.csv")],
];

/// Name of the curve files.
const CURVES: &str = "vane_curves.csv";

#[derive(Clone, Debug)]
enum Change {
    Drop(usize),
    Double(usize),
    Byte(u8),
    Number(&'static str),
    SwapLines(Index),
    DropLine,
    DoubleLine,
    Cut,
}

const EXTREMES: [&str; 18] = [
    "0",
    "-0",
    "-1",
    "1e-300",
    "1e300",
    "-1e300",
    "1e999",
    "NaN",
    "inf",
    "0.1",
    "4294967296",
    "18446744073709551615",
    "-9223372036854775808",
    "99999999999999999999",
    "0.0000000000000000001",
    "100000",
    "3.0000001",
    "1000000000000",
];

fn change() -> impl Strategy<Value = (Index, Change)> {
    let kind = prop_oneof![
        (1_usize..8).prop_map(Change::Drop),
        (1_usize..40).prop_map(Change::Double),
        any::<u8>().prop_map(Change::Byte),
        select(&EXTREMES[..]).prop_map(Change::Number),
        select(&EXTREMES[..]).prop_map(Change::Number),
        any::<Index>().prop_map(Change::SwapLines),
        Just(Change::DropLine),
        Just(Change::DoubleLine),
        Just(Change::Cut),
    ];
    (any::<Index>(), kind)
}

fn changes() -> impl Strategy<Value = Vec<(Index, Change)>> {
    prop::collection::vec(change(), 1..4)
}

/// Places of the numbers of a text.
fn numbers(text: &[u8]) -> Vec<(usize, usize)> {
    let digit = |b: u8| b.is_ascii_digit() || b == b'.';
    let mut found = Vec::new();
    let mut i = 0;
    while i < text.len() {
        let start = i;
        while i < text.len() && digit(text[i]) {
            i += 1;
        }
        if i > start {
            found.push((start, i));
        }
        i += 1;
    }
    found
}

fn changed(text: &str, changes: &[(Index, Change)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for (at, change) in changes {
        if bytes.is_empty() {
            break;
        }
        let i = at.index(bytes.len());
        match change {
            Change::Drop(n) => _ = bytes.drain(i..(i + n).min(bytes.len())),
            Change::Double(n) => {
                let piece = bytes[i..(i + n).min(bytes.len())].to_vec();
                bytes.splice(i..i, piece);
            }
            Change::Byte(b) => bytes[i] = *b,
            Change::Number(extreme) => {
                let all = numbers(&bytes);
                if !all.is_empty() {
                    let (from, to) = all[at.index(all.len())];
                    bytes.splice(from..to, extreme.bytes());
                }
            }
            Change::SwapLines(_) | Change::DropLine | Change::DoubleLine => {
                let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
                let k = at.index(lines.len());
                match change {
                    Change::SwapLines(other) => {
                        let other = other.index(lines.len());
                        lines.swap(k, other);
                    }
                    Change::DropLine => _ = lines.remove(k),
                    _ => lines.insert(k, lines[k].clone()),
                }
                bytes = lines.concat();
            }
            Change::Cut => bytes.truncate(i),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Files of the library by name, changed where a test says so.
struct Memory(BTreeMap<String, String>);

impl Memory {
    fn with(name: &str, text: String) -> Self {
        let all = shipped::MACHINES.iter().chain(shipped::TOOLS).chain(shipped::POSTS).chain(&[(CURVES, JOBS[0][1])]);
        let mut files: BTreeMap<String, String> = all.map(|(n, t)| ((*n).to_owned(), (*t).to_owned())).collect();
        files.insert(name.to_owned(), text);
        Self(files)
    }

    fn find(&self, name: &str) -> Result<SourceFile, MissingFile> {
        match self.0.get(name) {
            Some(text) => Ok(SourceFile::text(name, text)),
            None => Err(MissingFile {
                reason: "not in memory".to_owned(),
                known: self.0.keys().cloned().collect(),
                ..MissingFile::default()
            }),
        }
    }
}

impl Files for Memory {
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.find(name)
    }

    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.find(name)
    }

    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        self.find(name)
    }

    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        self.find(path)
    }

    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        self.find(path)
    }
}

/// Faults of a text as a whole, or of a part that is not there, have no place in it.
const WITHOUT_PLACE: [impellerc::diagnostics::Code; 2] = [codes::syntax::EMPTY, codes::job::MISSING_ITEM];

/// Reads a job down to its program; false when it was refused.
fn front(text: &str, mut files: Memory) -> Result<bool, TestCaseError> {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("job.imp", text);
    let ast = syntax::parse(text, source, &mut sink);
    let resolved = job::resolve(&ast, &mut files, &mut sources, &mut sink);
    let made = resolved.is_ok_and(|job| {
        let _ = job::print::print(&job);
        lower::lower(&job, &mut sink).is_ok()
    });
    prop_assert!(made != sink.has_errors(), "made {} with {:?}", made, sink.diags());
    for diag in sink.diags().iter().filter(|d| d.severity == Severity::Error) {
        let placed = !diag.labels.is_empty() || diag.place.is_some();
        prop_assert!(placed || WITHOUT_PLACE.contains(&diag.code), "no place: {:?}", diag);
        prop_assert!(diag.help.is_some(), "no way out: {:?}", diag);
        for label in &diag.labels {
            let text = &sources.get(label.span.source).expect("a text").text;
            let (from, to) = (label.span.start as usize, label.span.end as usize);
            prop_assert!(from <= to && text.get(from..to).is_some(), "{:?} of {} bytes", label, text.len());
        }
    }
    let _ = render::json(&sink, &sources);
    Ok(made)
}

/// `MUTATIONS_TIMES=100` makes that many times the cases.
fn config(cases: u32) -> ProptestConfig {
    let times = std::env::var("MUTATIONS_TIMES").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    ProptestConfig { cases: cases.saturating_mul(times), failure_persistence: None, ..ProptestConfig::default() }
}

/// A certificate as the compiler writes it, of an NC text of 250 lines.
static CERTIFICATE: LazyLock<(String, String)> = LazyLock::new(|| {
    let nc: String = (0..250).map(|i| format!("N{i} G1 X{i}\n")).collect();
    let lines = vec![
        certificate_file::OperationLines { name: "groove".to_owned(), first: 1, last: 120 },
        certificate_file::OperationLines { name: "flank".to_owned(), first: 121, last: 250 },
    ];
    let file = CertificateFile {
        format: certificate_file::FORMAT.to_owned(),
        version: certificate_file::VERSION,
        compiler: "impellerc 0.1.0".to_owned(),
        inputs: certificate_file::Inputs::new([
            ("small.imp".to_owned(), Origin::Given, JOBS[2][0].as_bytes()),
            (CURVES.to_owned(), Origin::BesideJob, JOBS[2][1].as_bytes()),
        ]),
        nc: certificate_file::NcText::new("siemens-840d", &nc, lines),
        measured: serde_json::json!({ "contracts": [
            { "kind": "gouge", "scope": "", "relation": "<=", "bound": 0.002, "found": 0.0018, "holds": true },
            { "kind": "time", "scope": "on operation flank", "bound": 600.0, "found": 500.5, "holds": true },
        ]}),
    };
    (file.json().unwrap(), nc)
});

proptest! {
    #![proptest_config(config(1000))]

    #[test]
    fn job_texts(which in 0..JOBS.len(), changes in changes()) {
        let [job, curves] = JOBS[which];
        front(&changed(job, &changes), Memory::with(CURVES, curves.to_owned()))?;
    }

    #[test]
    fn machine_files(which in 0..shipped::MACHINES.len(), changes in changes()) {
        let (name, text) = shipped::MACHINES[which];
        front(&JOBS[0][0].replacen("5mc850-c", name, 1), Memory::with(name, changed(text, &changes)))?;
    }

    #[test]
    fn tool_files(changes in changes()) {
        let (name, text) = shipped::TOOLS[0];
        front(JOBS[0][0], Memory::with(name, changed(text, &changes)))?;
    }

    #[test]
    fn curve_files(changes in changes()) {
        front(JOBS[0][0], Memory::with(CURVES, changed(JOBS[0][1], &changes)))?;
    }

    #[test]
    fn certificates(changes in changes(), of_text in changes()) {
        let (text, nc) = &*CERTIFICATE;
        compare(&changed(text, &changes), &changed(nc, &of_text))?;
    }
}

/// Reads a certificate and compares an NC text with it.
fn compare(text: &str, nc: &str) -> Result<(), TestCaseError> {
    let original = CertificateFile::read(&CERTIFICATE.0).unwrap();
    match CertificateFile::read(text) {
        Ok(file) => {
            let again = CertificateFile::read(&file.json().unwrap()).unwrap();
            prop_assert_eq!(&again.nc, &file.nc);
            prop_assert!(certificate_file::contracts(&file.measured).is_some_and(|c| c.len() <= 16));
            let same = file.inputs.sha256 == original.inputs.sha256;
            prop_assert_eq!(file.inputs.differences(&original.inputs).is_empty(), same);
            if let Some((first, last, _)) = file.nc.first_difference(nc) {
                let lines = nc.lines().count().max(1);
                prop_assert!(first >= 1 && first <= last && last <= lines, "{} {} of {}", first, last, lines);
            }
        }
        // Where in the text, or which field.
        Err(reason) => prop_assert!(
            ["line ", "field", "format", "version", "form is wrong", "does not hold"]
                .iter()
                .any(|w| reason.contains(w)),
            "{}",
            reason
        ),
    }
    Ok(())
}

/// Every number of a certificate that stands by itself, with every extreme, against a text that differs late.
#[test]
fn extreme_numbers_in_certificates() {
    let (text, nc) = &*CERTIFICATE;
    let edited = nc.replacen("X220", "X221", 1);
    let mut seen = 0;
    for (k, line) in text.lines().enumerate() {
        let Some((key, value)) = line.split_once(": ") else { continue };
        let number = value.trim_end_matches(',');
        if number.is_empty() || !number.bytes().all(|b| b.is_ascii_digit() || b == b'.') {
            continue;
        }
        seen += 1;
        for extreme in EXTREMES {
            let changed = format!("{key}: {}", value.replacen(number, extreme, 1));
            let lines: Vec<&str> = text.lines().enumerate().map(|(i, l)| if i == k { &changed } else { l }).collect();
            compare(&lines.join("\n"), &edited).unwrap();
        }
    }
    assert!(seen > 10, "{seen}");
}

/// A finished face in both dialects, as the compiler writes it, and its program.
static NC: LazyLock<(Program, Vec<String>)> = LazyLock::new(|| {
    let Pinned { program, motion, .. } = pinned::flank();
    // The first passes say all that there is to say; a reader of long texts would be slow here.
    let of = |p: &dyn Post| nc::emit(p, &support::program_for(p.name(), program), motion, &[]).lines;
    let whole = nc::POSTS.iter().map(|p| of(*p));
    let texts = whole.map(|lines| {
        let ends = lines.len() - 12;
        // Some controls turn the tables to the first target in blocks of their own.
        let starts = lines.iter().position(|l| l.source == Some((0, 1))).unwrap();
        let kept = lines.iter().enumerate().filter(|(i, _)| *i < starts + 48 || *i >= ends);
        kept.map(|(_, l)| format!("{}\n", l.text)).collect()
    });
    (program.clone(), texts.collect())
});

/// The texts that the fuzz targets begin with: their posts, their names and what they say.
static CORPUS: LazyLock<Vec<(&'static dyn Post, String, String)>> = LazyLock::new(|| {
    let mut texts = Vec::new();
    for post in nc::POSTS {
        let folder = format!("fuzz/corpus/{}", post.name().replace('-', "_"));
        let Ok(entries) = std::fs::read_dir(folder) else { continue };
        let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        let text =
            |path: std::path::PathBuf| (*post, path.display().to_string(), std::fs::read_to_string(path).unwrap());
        texts.extend(paths.into_iter().map(text));
    }
    texts
});

/// The machine that the texts of the corpus were written for: its Z goes up to 650 mm.
fn corpus_machine() -> Machine {
    let machine = NC.0.machine.clone();
    let [x, y, z] = machine.linear;
    Machine { linear: [x, y, LinearAxis { min: -50.0, max: 650.0, ..z }], retract: 650.0, ..machine }
}

/// The job with an axis 2 that turns without end.
fn endless(program: &Program) -> Program {
    let mut program = program.clone();
    let axis = &mut program.machine.rotary[1];
    (axis.min, axis.max, axis.modulo) = (f64::NEG_INFINITY, f64::INFINITY, Some(ModuloWay::Shortest));
    program
}

/// Reads an NC text, and its motion.
fn nc_text(post: &dyn Post, program: &Program, text: &str) -> Result<(), TestCaseError> {
    let lines = text.lines().count().max(1);
    let file = SourceId(7);
    match post.read(text, &program.machine) {
        Ok(sections) => {
            let mut sink = Sink::default();
            let motion = motion_of(program, &sections, &|line| Span::new(file, line..line), &mut sink);
            prop_assert!(motion.is_some() || sink.has_errors(), "{:?}", sink.diags());
            for diag in sink.diags().iter().filter(|d| d.severity == Severity::Error) {
                let mut own = diag.labels.iter().filter(|l| l.span.source == file);
                prop_assert!(own.any(|l| (1..=lines).contains(&(l.span.start as usize))), "{:?}", diag);
            }
            for j in motion.iter().flat_map(|m| &m.motion.operations).flat_map(|o| &o.moves) {
                prop_assert!(j.time >= 0.0 && j.time.is_finite() && j.joints.xyz.iter().all(|x| x.is_finite()));
            }
        }
        Err(faults) => {
            prop_assert!(!faults.is_empty() && faults.len() <= MAX_FAULTS);
            prop_assert!(faults.iter().all(|f| (1..=lines).contains(&f.line) && !f.reason.is_empty()));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn nc_texts(which in 0..nc::POSTS.len(), changes in changes()) {
        let (program, texts) = &*NC;
        let post = nc::POSTS[which];
        nc_text(post, &support::program_for(post.name(), program), &changed(&texts[which], &changes))?;
    }

    /// Arcs, comments, polynomials, calls, axes modulo 360 deg: texts that the compiler writes rarely or never.
    #[test]
    fn texts_of_the_corpus(which in any::<Index>(), without_end in any::<bool>(), changes in changes()) {
        let (post, _, text) = which.get(CORPUS.as_slice());
        let program = support::program_for(post.name(), &Program { machine: corpus_machine(), ..NC.0.clone() });
        let program = if without_end { endless(&program) } else { program };
        nc_text(*post, &program, &changed(text, &changes))?;
    }
}

/// The originals of all these tests are read: what is refused is refused for its change. So are the texts of the corpus with
/// polynomials, calls and axes modulo 360 deg.
#[test]
fn the_originals_are_read() {
    for name in ["polynomials.mpf", "repeat.mpf", "modulo.mpf", "spl.h", "subprograms.ngc"] {
        let (post, _, text) = CORPUS.iter().find(|(_, path, _)| path.ends_with(&format!("/{name}"))).unwrap();
        let machine = support::machine_for(post.name(), &corpus_machine());
        let machine =
            if name == "modulo.mpf" { endless(&Program { machine, ..NC.0.clone() }).machine } else { machine };
        let faults = post.read(text, &machine).err();
        assert_eq!(faults, None, "{name}");
    }
    for [job, curves] in JOBS {
        assert!(front(job, Memory::with(CURVES, curves.to_owned())).unwrap());
    }
    let (program, texts) = &*NC;
    for (post, text) in nc::POSTS.iter().zip(texts) {
        let sections = post.read(text, &support::program_for(post.name(), program).machine).unwrap();
        assert!(motion_of(program, &sections, &|_| Span::default(), &mut Sink::default()).is_some(), "{}", post.name());
    }
    let (text, nc) = &*CERTIFICATE;
    assert_eq!(CertificateFile::read(text).unwrap().nc.first_difference(nc), None);
}
