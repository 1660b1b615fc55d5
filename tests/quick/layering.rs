//! Dependencies of modules: a module uses only modules further left in its own layer and modules below, see
//! `ARCHITECTURE.md`.

use crate::support::sources::files;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What each module may name beside itself and the foundation.
const MAY: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("progress", &[]),
    ("post_file", &[]),
    ("contract", &["part"]),
    ("entity", &[]),
    ("material", &[]),
    ("method", &[]),
    ("operation", &["part"]),
    ("source", &[]),
    ("diag", &[]),
    ("geom", &[]),
    ("kin", &["geom"]),
    ("collide", &[]),
    ("stock", &["collide"]),
    ("sections", &["geom"]),
    ("import", &["sections", "geom"]),
    ("part", &["geom", "sections", "collide", "stock"]),
    ("envelope", &["geom", "collide"]),
    ("orient", &["geom"]),
    ("syntax", &[]),
    ("job", &["syntax", "import", "sections", "part", "stock"]),
    ("ir", &["part", "geom", "kin", "collide"]),
    ("language", &["job", "syntax"]),
    ("lower", &["job", "ir", "part", "sections", "geom", "kin", "collide"]),
    ("analysis", &["envelope", "ir", "part", "geom", "kin", "collide"]),
    ("passes", &["analysis", "ir", "part", "geom", "kin", "collide", "stock", "envelope", "orient"]),
    ("verify", &["ir", "part", "geom", "kin", "collide", "stock"]),
    ("compare", &["verify", "ir", "kin"]),
    ("post", &["verify", "ir", "geom", "kin"]),
    ("export", &["verify", "ir", "part", "geom", "kin", "collide", "stock"]),
    ("output", &[]),
];

/// Every module may name these.
const FOUNDATION: &[&str] = &[
    "units",
    "contract",
    "material",
    "method",
    "operation",
    "post_file",
    "entity",
    "source",
    "diag",
    "entity_id",
    "codes",
    "progress",
];

/// The engines know neither diagnostics nor texts.
const ENGINES: &[&str] = &["geom", "sections", "kin", "collide", "stock", "part", "envelope", "orient"];

const FORBIDDEN_NAMES: &[&str] = &["util", "helper", "common", "misc", "manager"];

/// Lines from which a file is hard to hold in the head.
const LONGEST_FILE: usize = 700;

/// Lines from which a function is more than one thought.
const LONGEST_FUNCTION: usize = 80;

/// Top-level module of a source file.
fn module(path: &Path) -> String {
    let first = path.strip_prefix("src").unwrap().components().next().unwrap().as_os_str().to_str().unwrap();
    first.trim_end_matches(".rs").to_owned()
}

/// Modules named by `crate::` paths, groups of a `use` included.
fn named(text: &str) -> Vec<String> {
    let mut names = Vec::new();
    let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    for (i, _) in text.match_indices("crate::") {
        let rest = &text[i + "crate::".len()..];
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut item = true;
            for (k, c) in group.char_indices() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => item = true,
                    c if item && c.is_alphabetic() => {
                        names.push(word(&group[k..]));
                        item = false;
                    }
                    _ => {}
                }
            }
        } else {
            names.push(word(rest));
        }
    }
    names
}

#[test]
fn modules_name_only_what_lies_below_them() {
    let all = files(Path::new("src"));
    let mut faults = Vec::new();
    for path in &all {
        let own = module(path);
        let text = std::fs::read_to_string(path).unwrap();
        // Comments may name anything.
        let code: String =
            text.lines().filter(|l| !l.trim_start().starts_with("//")).map(|l| format!("{l}\n")).collect();
        let Some((_, may)) = MAY.iter().find(|(m, _)| *m == own) else {
            assert!(["lib", "command_line", "driver"].contains(&own.as_str()), "{} has no layer", path.display());
            continue;
        };
        for name in named(&code) {
            let engine = ENGINES.contains(&own.as_str());
            let founded =
                FOUNDATION.contains(&name.as_str()) && !(engine && ["diag", "source"].contains(&name.as_str()));
            if name != own && !founded && !may.contains(&name.as_str()) {
                faults.push(format!("{} names {name}", path.display()));
            }
        }
        for (krate, owner) in [("parry3d_f64", "collide"), ("pest", "syntax"), ("toml::", "job"), ("spade", "geom")] {
            if own != owner && code.contains(&format!("use {krate}")) {
                faults.push(format!("{} names {krate}", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Where letters of rotary axes may stand: kinematics of named controls, machine files, texts for people and for machines.
const LETTERS: &[&str] =
    &["src/kin/", "src/job/library.rs", "src/job/library_schema.rs", "src/post/", "src/diag/codes/"];

/// Where the names of a blade's faces may stand: the part, the language, and pages for people.
const FACES: &[&str] =
    &["src/part/", "src/sections/", "src/import/", "src/syntax/", "src/job/", "src/lower/", "src/diag/codes/"];

/// Lines of the code, tests of a file left out, that name something outside of the places where it may stand.
fn named_outside(places: &[&str], names: impl Fn(&str) -> bool) -> Vec<String> {
    let all = files(Path::new("src"));
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
    let all = files(Path::new("src"));
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
    let all = files(Path::new("src"));
    let mut long = Vec::new();
    for path in &all {
        let text = std::fs::read_to_string(path).unwrap();
        let beyond = functions(&text).into_iter().filter(|(_, lines)| *lines > LONGEST_FUNCTION);
        long.extend(beyond.map(|(name, lines)| format!("{}: {name} has {lines} lines", path.display())));
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

/// Files of `src` outside of a folder whose code names it as a module, and the number of such lines in each.
fn naming(folder: &Path) -> Vec<(String, usize)> {
    let name = folder.file_name().unwrap().to_str().unwrap().to_owned();
    let all = files(Path::new("src"));
    let forms = [format!("{name}::"), format!("mod {name};")];
    let other = format!("analysis::{name}::");
    let names = |line: &&str| {
        let named = !line.trim_start().starts_with("//") && forms.iter().any(|form| line.contains(form));
        named && !line.contains(&other)
    };
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
    let folders = std::fs::read_dir("src/post").unwrap().map(|e| e.unwrap().path());
    let dialects: Vec<PathBuf> = folders.filter(|p| p.join("writer.rs").is_file()).collect();
    // A folder has a dialect, or a family of dialects that differ by data.
    let families: BTreeSet<&str> = impellerc::post::POSTS.iter().map(|post| post.family()).collect();
    assert_eq!(dialects.len(), families.len());
    for dialect in dialects {
        assert!(dialect.join("reader.rs").is_file(), "{} has no reader", dialect.display());
        let found: Vec<_> = naming(&dialect).into_iter().filter(|(path, _)| !path.ends_with("motion_of.rs")).collect();
        let folder = dialect.file_name().unwrap().to_str().unwrap().replace('_', "-");
        let members = impellerc::post::POSTS.iter().filter(|post| post.family() == folder).count();
        // Its `mod` and its places in `POSTS`.
        assert_eq!(found, [("src/post/mod.rs".to_owned(), 1 + members)], "{}", dialect.display());
    }
}

#[test]
fn an_operation_is_one_folder_and_a_line_in_the_pipeline() {
    for room in ["rough", "flank", "point", "channel"] {
        let found = naming(&Path::new("src/passes").join(room));
        let places: Vec<&str> = found.iter().map(|(path, _)| path.as_str()).collect();
        assert_eq!(places, ["src/passes/axis/orient_tool.rs", "src/passes/mod.rs", "src/passes/pipeline.rs"], "{room}");
    }
}
