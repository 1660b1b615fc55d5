//! Rules of the source tree that no compiler holds: what crates never depend on, where names of axes and faces may
//! stand, how long files and functions are, see `ARCHITECTURE.md`.

use crate::support::sources::{all_files, files};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What a crate never depends on, through others neither: planner and verifier do not know each other, and no engine
/// knows diagnostics.
const NEVER: &[(&str, &str)] = &[
    ("plan", "verify"),
    ("verify", "plan"),
    ("nc", "plan"),
    ("nurbs", "diagnostics"),
    ("five-axis", "diagnostics"),
    ("tool-stock", "diagnostics"),
    ("blade", "diagnostics"),
    ("wheel", "diagnostics"),
    ("axes", "diagnostics"),
    ("ir", "diagnostics"),
];

/// Libraries that stand alone.
const ALONE: &[(&str, &[&str])] = &[("nurbs", &[]), ("five-axis", &["nurbs"]), ("tool-stock", &[])];

/// The one crate that names a library, so that the library can be exchanged there.
const OWNERS: &[(&str, &str)] = &[("pest", "syntax"), ("toml", "job"), ("spade", "nurbs")];

const FORBIDDEN_NAMES: &[&str] = &["util", "helper", "common", "misc", "manager"];

/// Lines from which a file is hard to hold in the head.
const LONGEST_FILE: usize = 700;

/// Lines from which a function is more than one thought.
const LONGEST_FUNCTION: usize = 80;

/// Dependencies of each crate, those of its tests left out.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let manifest = |folder: PathBuf| {
        let text = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let table: toml::Table = text.parse().unwrap();
        let names = table["dependencies"].as_table().unwrap().keys().cloned().collect();
        (folder.file_name().unwrap().to_str().unwrap().to_owned(), names)
    };
    std::fs::read_dir("crates").unwrap().map(|e| manifest(e.unwrap().path())).collect()
}

/// All crates of this tree that a crate depends on, through others as well.
fn below(name: &str, all: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<String> {
    let own = all[name].iter().filter(|n| all.contains_key(*n));
    own.flat_map(|n| below(n, all).into_iter().chain([n.clone()])).collect()
}

#[test]
fn crates_depend_on_what_lies_below_them() {
    let all = dependencies();
    for (name, never) in NEVER {
        assert!(!below(name, &all).contains(*never), "{name} depends on {never}");
    }
    for (name, may) in ALONE {
        assert_eq!(below(name, &all), may.iter().map(|m| (*m).to_owned()).collect(), "{name}");
    }
    for (library, owner) in OWNERS {
        let users: Vec<&String> = all.iter().filter(|(_, d)| d.contains(*library)).map(|(name, _)| name).collect();
        assert_eq!(users, [owner], "{library}");
    }
}

/// Where letters of rotary axes may stand: kinematics of named controls, machine files, texts for people and for machines.
const LETTERS: &[&str] = &[
    "crates/five-axis/",
    "crates/job/src/library/machine.rs",
    "crates/job/src/library/schema.rs",
    "crates/nc/",
    "crates/diagnostics/src/codes/",
];

/// Where the names of a blade's faces may stand: the part, the language, and pages for people.
const FACES: &[&str] = &[
    "crates/wheel/src/part/",
    "crates/blade/",
    "crates/blade-files/",
    "crates/syntax/",
    "crates/job/",
    "crates/lower/",
    "crates/diagnostics/src/codes/",
];

/// Lines of the code, tests of a file left out, that name something outside of the places where it may stand.
fn named_outside(places: &[&str], names: impl Fn(&str) -> bool) -> Vec<String> {
    let all = all_files();
    let mut faults = Vec::new();
    for path in all.iter().filter(|p| !places.iter().any(|place| p.starts_with(place))) {
        let text = std::fs::read_to_string(path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let named = code.lines().enumerate().filter(|(_, line)| names(line));
        faults.extend(named.map(|(i, line)| format!("{}:{}: {}", path.display(), i + 1, line.trim())));
    }
    faults
}

#[test]
fn faces_have_no_names_outside_of_the_part() {
    let faults = named_outside(FACES, |line| {
        let line = line.to_lowercase();
        !line.trim_start().starts_with("//") && (line.contains("pressure") || line.contains("suction"))
    });
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn rotary_axes_have_no_letters_outside_of_texts() {
    let faults = named_outside(LETTERS, |line| {
        ["A", "B", "C"].into_iter().any(|letter| {
            [format!("\"{letter}\""), format!("'{letter}'"), format!("axis {letter} "), format!(" of {letter} ")]
                .into_iter()
                .chain(["A", "C"].into_iter().map(|other| format!(" {letter} and {other} ")))
                .any(|words| line.contains(&words))
        })
    });
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn files_have_headers_and_stay_short() {
    let all = all_files();
    for path in &all {
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.starts_with("//!"), "{} has no header", path.display());
        assert!(text.lines().count() <= LONGEST_FILE, "{} is too long", path.display());
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(!FORBIDDEN_NAMES.iter().any(|f| name.contains(f)), "{}", path.display());
    }
}

/// Name of the function that begins in a line.
fn function(line: &str) -> Option<String> {
    let (before, rest) = line.split_once("fn ")?;
    let declares = before.split_whitespace().all(|w| w.starts_with("pub") || ["const", "async", "unsafe"].contains(&w));
    declares.then(|| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect())
}

/// Functions of a text with their lines, from `fn` to the closing brace at its indentation; those of tests are left out.
fn functions(text: &str) -> Vec<(String, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    let mut tests = false;
    for (i, line) in lines.iter().enumerate() {
        tests = (tests || (*line == "mod tests {" && lines[i - 1] == "#[cfg(test)]")) && *line != "}";
        let Some(name) = function(line).filter(|_| !tests) else { continue };
        let indent = &line[..line.len() - line.trim_start().len()];
        // A trait may leave out the body.
        let ends = |l: &&str| {
            let l = l.strip_prefix(indent).unwrap_or_default();
            l == "}" || (l.starts_with(')') && l.ends_with(';'))
        };
        let count = if line.ends_with([';', '}']) { 0 } else { lines[i..].iter().position(ends).unwrap() };
        found.push((name, count + 1));
    }
    found
}

#[test]
fn functions_stay_short() {
    let all = all_files();
    let mut long = Vec::new();
    for path in &all {
        let text = std::fs::read_to_string(path).unwrap();
        let beyond = functions(&text).into_iter().filter(|(_, lines)| *lines > LONGEST_FUNCTION);
        long.extend(beyond.map(|(name, lines)| format!("{}: {name} has {lines} lines", path.display())));
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

/// Files beside and outside of a folder whose code names it as a module, and the number of such lines in each.
fn naming(folder: &Path) -> Vec<(String, usize)> {
    let name = folder.file_name().unwrap().to_str().unwrap().to_owned();
    let all = all_files();
    let forms = [format!("{name}::"), format!("mod {name};")];
    let names = |line: &&str| !line.trim_start().starts_with("//") && forms.iter().any(|form| line.contains(form));
    let inside = folder.parent().unwrap();
    all.iter()
        .filter(|path| path.starts_with(inside) && !path.starts_with(folder))
        .map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            (path.display().to_string(), text.lines().filter(names).count())
        })
        .filter(|(_, lines)| *lines > 0)
        .collect()
}

#[test]
fn a_dialect_is_one_folder_and_one_line() {
    let folders = std::fs::read_dir("crates/nc/src").unwrap().map(|e| e.unwrap().path());
    let dialects: Vec<PathBuf> = folders.filter(|p| p.join("writer.rs").is_file()).collect();
    // A folder has a dialect, or a family of dialects that differ by data.
    let families: BTreeSet<&str> = impellerc::nc::POSTS.iter().map(|post| post.dialect().family).collect();
    assert_eq!(dialects.len(), families.len());
    for dialect in dialects {
        assert!(dialect.join("reader.rs").is_file(), "{} has no reader", dialect.display());
        let found: Vec<_> = naming(&dialect).into_iter().filter(|(path, _)| !path.ends_with("motion_of.rs")).collect();
        let folder = dialect.file_name().unwrap().to_str().unwrap().replace('_', "-");
        let members = impellerc::nc::POSTS.iter().filter(|post| post.dialect().family == folder).count();
        // Its `mod` and its places in `POSTS`.
        assert_eq!(found, [("crates/nc/src/lib.rs".to_owned(), 1 + members)], "{}", dialect.display());
    }
}

#[test]
fn an_operation_is_one_folder_and_a_line_in_the_pipeline() {
    for room in ["rough", "flank", "point", "channel"] {
        let found = naming(&Path::new("crates/plan/src/passes").join(room));
        let places: Vec<&str> = found.iter().map(|(path, _)| path.as_str()).collect();
        assert_eq!(
            places,
            [
                "crates/plan/src/passes/axis/orient_tool.rs",
                "crates/plan/src/passes/mod.rs",
                "crates/plan/src/passes/pipeline.rs"
            ],
            "{room}"
        );
    }
}

#[test]
fn planning_asks_the_control_and_never_the_post() {
    let naming: Vec<String> = files(Path::new("crates/plan/src/passes"))
        .iter()
        .filter(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            [".post.", ".post;", ".post)", "post_file"].iter().any(|name| text.contains(name))
        })
        .map(|path| path.display().to_string())
        .collect();
    assert_eq!(naming, [""; 0]);
}

/// Lines of arms `_ =>` that stand below an arm of a kind of operation.
fn swallowed(text: &str) -> Vec<usize> {
    const KINDS: [&str; 8] = ["Roughing", "Groove", "Expand", "Rough", "Plunge", "Flank", "Channel", "Point"];
    const ENUMS: [&str; 3] = ["OperationKind::", "RoughingStrategy::", "Self::"];
    let lines: Vec<&str> = text.lines().collect();
    let indentation = |line: &str| line.len() - line.trim_start().len();
    let of_kind = |line: &str| {
        let arm = line.trim_start().trim_start_matches("| ").trim_start_matches("Some").trim_start_matches('(');
        KINDS.iter().any(|kind| ENUMS.iter().any(|of| arm.starts_with(&format!("{of}{kind} {{"))))
    };
    let wild = lines.iter().enumerate().filter(|(_, line)| line.trim_start().starts_with("_ =>"));
    let below = wild.filter(|(at, line)| {
        let arms = lines[..*at]
            .iter()
            .rev()
            .take_while(|before| before.is_empty() || indentation(before) >= indentation(line));
        arms.filter(|before| indentation(before) == indentation(line)).any(|before| of_kind(before))
    });
    below.map(|(at, _)| at + 1).collect()
}

#[test]
fn no_match_swallows_a_new_operation() {
    for arm in
        ["OperationKind::Flank { .. }", "RoughingStrategy::Groove { .. }", "Some(RoughingStrategy::Groove { .. })"]
    {
        assert_eq!(swallowed(&format!("match kind {{\n    {arm} => 1,\n    _ => 2,\n}}\n")), [3], "{arm}");
    }
    let found: Vec<String> = all_files()
        .iter()
        .flat_map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            swallowed(&text).into_iter().map(move |line| format!("{}:{line}", path.display()))
        })
        .collect();
    assert_eq!(found, Vec::<String>::new(), "a new operation would take these arms without a word");
}
