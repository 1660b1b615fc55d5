//! Modules of a folder use each other in one direction: there is no cycle at any depth of the tree of a crate. Between
//! crates the compiler holds this.
//!
//! A folder with its content counts as one module. The file `mod.rs` of a folder, and `lib.rs` of a crate, may use the
//! content of the folder, and the content may use the definitions of this file.

use crate::support::sources::{files, folders};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module by its names from the root of the crate.
type Module = Vec<String>;

/// All modules of a crate with their code, tests and comments left out.
fn modules(folder: &Path) -> BTreeMap<Module, String> {
    files(folder)
        .into_iter()
        .map(|path| {
            let inner = path.strip_prefix(folder).unwrap().with_extension("");
            let mut module: Module = inner.iter().map(|p| p.to_str().unwrap().to_owned()).collect();
            if module.last().is_some_and(|m| m == "mod") || module == ["lib"] {
                module.pop();
            }
            let text = std::fs::read_to_string(&path).unwrap();
            (module, code(text.split("#[cfg(test)]\nmod").next().unwrap_or_default()))
        })
        .collect()
}

/// Code without comments and without places of visibility, which name modules as well.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n").replace("pub(in ", "pub(")
}

/// Paths that begin with a word, groups of a `use` spread out.
fn paths_from(code: &str, first: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices(first) {
        let own = code[..at].chars().next_back().is_none_or(|c| !(c.is_alphanumeric() || c == '_' || c == ':'));
        if own && code[at + first.len()..].starts_with("::") {
            spread(&code[at + first.len() + 2..], Vec::new(), &mut found);
        }
    }
    found
}

/// Reads one path, or a group of them, behind `::`; returns the bytes read.
fn spread(code: &str, before: Vec<String>, found: &mut Vec<Vec<String>>) -> usize {
    let mut path = before;
    let mut at = 0;
    loop {
        let rest = &code[at..];
        if let Some(group) = rest.strip_prefix('{') {
            let mut inside = 0;
            while inside < group.len() && !group[inside..].starts_with('}') {
                if group[inside..].starts_with(|c: char| c.is_alphanumeric() || c == '_') {
                    inside += spread(&group[inside..], path.clone(), found);
                } else {
                    inside += group[inside..].chars().next().map_or(1, char::len_utf8);
                }
            }
            return at + inside + 2;
        }
        let word: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        at += word.len();
        let empty = word.is_empty();
        path.push(word);
        if empty || !code[at..].starts_with("::") {
            found.push(path);
            return at.max(1);
        }
        at += 2;
    }
}

/// The module inside of a folder from which the file of the folder hands on a name by `pub use`.
fn handed_on(folder: &Module, name: &str, all: &BTreeMap<Module, String>) -> Option<Module> {
    let code = &all[folder];
    code.match_indices("pub use ").find_map(|(at, word)| {
        let statement = code[at + word.len()..].split(';').next()?;
        let mut paths = Vec::new();
        spread(statement, Vec::new(), &mut paths);
        let path = paths.into_iter().find(|p| p.len() > 1 && p.last().is_some_and(|last| last == name))?;
        let module: Module = folder.iter().cloned().chain(path[..path.len() - 1].iter().cloned()).collect();
        all.contains_key(&module).then_some(module)
    })
}

/// The modules that a module names.
fn named(own: &Module, code: &str, all: &BTreeMap<Module, String>) -> BTreeSet<Module> {
    let mut full: Vec<Module> = paths_from(code, "crate");
    for mut path in paths_from(code, "super") {
        let mut base = own[..own.len().saturating_sub(1)].to_vec();
        while path.first().is_some_and(|p| p == "super") {
            path.remove(0);
            base.pop();
        }
        full.push(base.into_iter().chain(path).collect());
    }
    let known = |path: &Module| {
        let found = (0..=path.len()).rev().map(|n| path[..n].to_vec()).find(|m| all.contains_key(m))?;
        // A name that a folder only hands on stands for the file that it comes from.
        let handed_on = path.get(found.len()).and_then(|name| handed_on(&found, name, all));
        Some(handed_on.unwrap_or(found))
    };
    full.iter().filter_map(known).collect()
}

/// A circle among modules, each with those that it names; folders count as one with all that is in them.
fn circle(names: &BTreeMap<Module, BTreeSet<Module>>) -> Option<Vec<Module>> {
    let mut edges: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
    for (from, to) in names.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to))) {
        let same = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if same < from.len() && same < to.len() {
            edges.entry(from[..=same].to_vec()).or_default().insert(to[..=same].to_vec());
        }
    }
    let mut done = BTreeSet::new();
    edges.keys().find_map(|start| from_here(start, &edges, &mut Vec::new(), &mut done))
}

fn from_here(
    at: &Module,
    edges: &BTreeMap<Module, BTreeSet<Module>>,
    path: &mut Vec<Module>,
    done: &mut BTreeSet<Module>,
) -> Option<Vec<Module>> {
    if let Some(begin) = path.iter().position(|m| m == at) {
        return Some(path[begin..].to_vec());
    }
    if !done.insert(at.clone()) {
        return None;
    }
    path.push(at.clone());
    let found = edges.get(at).into_iter().flatten().find_map(|next| from_here(next, edges, path, done));
    path.pop();
    found
}

#[test]
fn no_modules_of_a_folder_form_a_circle() {
    let (mut modules_in_all, mut edges) = (0, 0);
    let mut found = Vec::new();
    for folder in folders() {
        let all = modules(&folder);
        let names: BTreeMap<Module, BTreeSet<Module>> =
            all.iter().map(|(own, code)| (own.clone(), named(own, code, &all))).collect();
        modules_in_all += all.len();
        edges += names.values().map(BTreeSet::len).sum::<usize>();
        found.extend(circle(&names).map(|c| {
            format!("{}: {}", folder.display(), c.iter().map(|m| m.join("::")).collect::<Vec<_>>().join(" -> "))
        }));
    }
    assert!(modules_in_all > 150 && edges > 500, "{modules_in_all} modules, {edges} names of others");
    assert_eq!(found, [""; 0]);
}

#[test]
fn circles_are_found() {
    let module = |path: &str| -> Module { path.split("::").map(str::to_owned).collect() };
    let found = |files: &[(&str, &str)]| {
        let all: BTreeMap<Module, String> = files.iter().map(|(p, text)| (module(p), code(text))).collect();
        let names = all.iter().map(|(own, code)| (own.clone(), named(own, code, &all))).collect();
        circle(&names).map(|c| c.iter().map(|m| m.join("::")).collect::<Vec<_>>())
    };
    assert_eq!(found(&[("a::b", "use super::c::X;"), ("a::c", "")]), None);
    let two = found(&[("a::b", "use super::c::X;"), ("a::c", "fn f() { crate::a::b::g() }")]);
    assert_eq!(two.unwrap(), ["a::b", "a::c"]);
    // In a group, and through files deeper in the same folders.
    let deep =
        [("a::b::x", "use crate::{m::Y, a::c::{y::Z, W}};"), ("a::c::y", "use super::super::b::x::V;"), ("m", "")];
    assert_eq!(found(&deep).unwrap(), ["a::b", "a::c"]);
    // By a name that the folder hands on.
    let handed = [("a", "pub use b::X;"), ("a::b", "use super::c::Y;"), ("a::c", "use super::X;")];
    assert_eq!(found(&handed).unwrap(), ["a::b", "a::c"]);
    // Comments name what they like; the file of a folder and what is in the folder may name each other.
    assert_eq!(found(&[("a::b", "// super::c::X"), ("a::c", "use super::b::X;")]), None);
    assert_eq!(found(&[("a", "use crate::a::b::X;"), ("a::b", "use super::Y;")]), None);
}
