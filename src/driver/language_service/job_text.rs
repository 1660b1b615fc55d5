//! Answers about a text of the job language.

use super::Document;
use super::judgement::{SavedProof, lock};
use super::messages::{address, position, range};
use crate::driver::DiskFiles;
use ::report::proof::contracts::{bound_and_found, computed};
use base::source::{Origin, SourceFile};
use diagnostics::{Diag, Fix, Severity};
use job::Files;
use job::language::{self, JOB, NamedFile, Position, Positions};
use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};
use syntax::ast::{ItemKind, Name};
use verify::certificate::{ContractReport, OperationReport};
use wheel::contract::clock;

/// A text with its address and its library.
pub(super) struct JobText<'d> {
    pub(super) uri: &'d str,
    pub(super) document: &'d Document,
    pub(super) positions: Positions<'d>,
    pub(super) library: Option<&'d Path>,
}

impl JobText<'_> {
    fn text(&self) -> &str {
        &self.document.text
    }

    fn files(&self) -> Option<DiskFiles> {
        DiskFiles::new(&self.document.path, self.library, None).ok()
    }

    fn range(&self, bytes: Range<usize>) -> Value {
        range(&self.positions, bytes)
    }

    /// The answer to a question about a place or a range; `None` for a method that the service does not have.
    ///
    /// # Errors
    /// The request cannot be done; the reason is for people.
    pub(super) fn answer(&self, method: &str, params: &Value) -> Result<Option<Value>, String> {
        let at = self.positions.byte(position(&params["position"]));
        Ok(Some(match method {
            "textDocument/completion" => self.completion(at),
            "textDocument/hover" => self.hover(at),
            "textDocument/definition" => self.definition(at),
            "textDocument/references" => {
                let given = params["context"]["includeDeclaration"].as_bool().unwrap_or(true);
                let places = language::places(&self.document.understood, at).into_iter().skip(usize::from(!given));
                places.map(|place| json!({ "uri": self.uri, "range": self.range(place) })).collect()
            }
            "textDocument/prepareRename" => self.renamed_place(at),
            "textDocument/rename" => self.rename(at, params["newName"].as_str().unwrap_or_default())?,
            "textDocument/documentSymbol" => self.outline(),
            "textDocument/foldingRange" => {
                let fold = |fold: Range<usize>| {
                    let [from, to] = self.positions.range(fold);
                    json!({ "startLine": from.line, "endLine": to.line.saturating_sub(1) })
                };
                language::folds(self.text()).into_iter().map(fold).collect()
            }
            "textDocument/formatting" => self.formatting(),
            "textDocument/codeAction" => {
                self.actions([position(&params["range"]["start"]), position(&params["range"]["end"])])
            }
            "textDocument/inlayHint" => {
                let [from, to] = ["start", "end"].map(|end| self.positions.byte(position(&params["range"][end])));
                self.hints(from..to)
            }
            "textDocument/codeLens" => self.lenses(),
            _ => return Ok(None),
        }))
    }

    fn completion(&self, at: usize) -> Value {
        let Some(mut files) = self.files() else { return Value::Null };
        let (word, words) = language::words_at(self.text(), at, &mut files);
        let place = self.range(word);
        let item = |word: String| json!({ "label": word, "textEdit": { "range": place, "newText": word } });
        words.into_iter().map(item).collect()
    }

    fn hover(&self, at: usize) -> Value {
        let file = || {
            let (named, place) = language::named_file(&self.document.understood.tree, at)?;
            Some((about(&named, self.files()?)?, place))
        };
        let word = || {
            let meaning = language::meaning(&self.document.understood, self.text(), at)?;
            Some((meaning.text, meaning.range))
        };
        let facts = self.facts(at);
        let Some((text, place)) = file().or_else(word).or_else(|| (!facts.is_empty()).then(|| (String::new(), at..at)))
        else {
            return Value::Null;
        };
        let text = std::iter::once(text).filter(|text| !text.is_empty()).chain(facts).collect::<Vec<_>>();
        let contents = json!({ "kind": "markdown", "value": text.join("\n\n---\n\n") });
        json!({ "contents": contents, "range": self.range(place) })
    }

    /// What the facts say of a place: of the word `part` all that they say of the part, such as its throat.
    fn facts(&self, at: usize) -> Vec<String> {
        let judgement = lock(&self.document.judgement);
        let Some(facts) = judgement.facts.as_ref().filter(|facts| facts.text == self.document.text) else {
            return Vec::new();
        };
        let part = self.document.understood.tree.items.iter().find(|item| {
            matches!(&item.kind, ItemKind::Part { body, .. } if (item.span.range().start..body.span.range().start).contains(&at))
        });
        let about = |diag: &&Diag| {
            let of_job = diag.labels.iter().map(|label| label.span).filter(|span| span.source == JOB);
            let spans: Vec<Range<usize>> = of_job.map(|span| span.range()).collect();
            let here = match part {
                // Facts without a place in the text, such as the throat, are those of the part.
                Some(part) => spans.is_empty() || spans.iter().any(|span| part.span.range().contains(&span.start)),
                None => spans.iter().any(|span| span.contains(&at)),
            };
            diag.severity == Severity::Remark && here
        };
        let said = facts.diags.iter().filter(about);
        said.map(|diag| {
            let mut text = vec![format!("{}: {}", diag.code.id(), diag.message)];
            text.extend(diag.notes.iter().cloned());
            text.join("  \n")
        })
        .collect()
    }

    fn definition(&self, at: usize) -> Value {
        if let Some(place) = language::definition(&self.document.understood, at) {
            return json!({ "uri": self.uri, "range": self.range(place) });
        }
        let found = || {
            let (named, _) = language::named_file(&self.document.understood.tree, at)?;
            place_in_file(&named, &self.document.understood.tree, self.files()?)
        };
        found().map_or(Value::Null, |(path, line)| {
            let start = json!({ "line": line, "character": 0 });
            json!({ "uri": address(&path), "range": { "start": start, "end": start } })
        })
    }

    fn renamed_place(&self, at: usize) -> Value {
        let places = language::places(&self.document.understood, at);
        let here = places.into_iter().find(|place| (place.start..=place.end).contains(&at));
        here.map_or(Value::Null, |place| {
            let name = self.text().get(place.clone()).unwrap_or_default();
            json!({ "range": self.range(place), "placeholder": name })
        })
    }

    fn rename(&self, at: usize, new: &str) -> Result<Value, String> {
        let mut files = self.files().ok_or("the folder of the job cannot be read")?;
        let places = language::rename(&self.document.understood, self.text(), at, new, &mut files)?;
        let edits: Vec<Value> =
            places.into_iter().map(|place| json!({ "range": self.range(place), "newText": new })).collect();
        Ok(json!({ "changes": { self.uri: edits } }))
    }

    fn outline(&self) -> Value {
        let symbol = |item: language::Outlined| {
            let place = self.range(item.range);
            // A module, in the words of the protocol.
            json!({ "name": item.name, "kind": 2, "range": place, "selectionRange": place })
        };
        language::outline(&self.document.understood.tree).into_iter().map(symbol).collect()
    }

    /// The edit that gives a text its usual form; none where it has faults.
    fn formatting(&self) -> Value {
        let formatted = syntax::format(self.text(), JOB, &mut diagnostics::Sink::default());
        match formatted {
            Ok(new) if new != self.text() => json!([{ "range": self.range(0..self.text().len()), "newText": new }]),
            Ok(_) => json!([]),
            Err(_) => Value::Null,
        }
    }

    /// Changes that remove the faults in a range.
    fn actions(&self, selected: [Position; 2]) -> Value {
        let [from, to] = selected.map(|at| self.positions.byte(at));
        let touches = |diag: &Diag| {
            diag.labels.iter().any(|l| l.span.source == JOB && l.span.range().start <= to && from <= l.span.range().end)
        };
        let action = |diag: &Diag, fix: &Fix| {
            let edit = json!({ "range": self.range(fix.span.range()), "newText": fix.replacement });
            let title = diag.help.clone().unwrap_or_else(|| format!("write `{}`", fix.replacement));
            let changes = json!({ "changes": { self.uri: [edit] } });
            json!({ "title": title, "kind": "quickfix", "isPreferred": true, "edit": changes })
        };
        let diags = self.document.understood.diags.iter().filter(|diag| touches(diag));
        diags.filter_map(|diag| Some(action(diag, diag.fix.as_ref().filter(|fix| fix.span.source == JOB)?))).collect()
    }

    fn hints(&self, selected: Range<usize>) -> Value {
        let hints = language::hints(&self.document.understood).into_iter();
        let within = hints.filter(|hint| selected.start <= hint.at && hint.at <= selected.end);
        let hint = |hint: language::Hint| {
            let at = self.positions.of(hint.at);
            json!({
                "position": { "line": at.line, "character": at.column },
                "label": hint.text,
                "tooltip": hint.meaning,
                "paddingLeft": true,
            })
        };
        within.map(hint).collect()
    }

    /// What verification found, over each operation and requirement. An edited text has none: they are those of the saved text.
    fn lenses(&self) -> Value {
        let judgement = lock(&self.document.judgement);
        let Some(proof) = judgement.proof.as_ref().filter(|proof| proof.is_of(&self.document.text)) else {
            return json!([]);
        };
        let lens = |place: Range<usize>, title: String| json!({ "range": self.range(place), "command": { "title": title, "command": "" } });
        let mut found = Vec::new();
        for item in &self.document.understood.tree.items {
            let ItemKind::Operation { kind, name, .. } = &item.kind else { continue };
            let own = proof.operations.iter().filter(|(span, _)| span.source == JOB && span.start == item.span.start);
            let reports: Vec<&OperationReport> = own.map(|(_, report)| report).collect();
            if !reports.is_empty() {
                let Name { span, .. } = name.as_ref().unwrap_or(kind);
                found.push(lens(span.range(), operation_title(&reports, proof)));
            }
        }
        let stated = proof.contracts.iter().filter(|contract| !contract.default && contract.span.source == JOB);
        found.extend(stated.map(|contract| lens(contract.span.range(), contract_title(contract))));
        Value::Array(found)
    }
}

/// Times, passes and choices of an item, which with several tools is several operations.
fn operation_title(reports: &[&OperationReport], proof: &SavedProof) -> String {
    let sums = [0, 1, 2].map(|k| reports.iter().map(|report| report.time[k].get()).sum::<f64>());
    let all = clock(sums.iter().sum());
    let [cut, link, rapid] = sums.map(clock);
    let passes = match reports.iter().map(|report| report.passes).sum::<usize>() {
        1 => "one pass".to_owned(),
        count => format!("{count} passes"),
    };
    let of_item = |operation: &String| reports.iter().any(|report| report.name == *operation);
    let chosen = proof.notes.iter().find(|(operation, _)| of_item(operation));
    let chosen = chosen.map_or_else(String::new, |(_, note)| format!("; {note}"));
    format!("{all}: cutting {cut}, links {link}, rapid {rapid}; {passes}{chosen}")
}

/// What a requirement allows and what was found.
fn contract_title(contract: &ContractReport) -> String {
    let verdict = if contract.holds { "holds" } else { "FAILS" };
    let [bound, found] = bound_and_found(contract);
    let measured = computed(contract).map_or_else(String::new, |worst| format!(", at the computed points {worst}"));
    format!("{verdict}: proved {found}{measured}; required {} {bound}", contract.relation.sign())
}

/// What a file says of itself, and where it comes from.
fn about(named: &NamedFile, mut files: DiskFiles) -> Option<String> {
    let (found, command) = match named {
        NamedFile::Machine(name) => (files.machine(name), format!("impellerc machines {name}")),
        NamedFile::Tools(name) => (files.tools(name), format!("impellerc tools {name}")),
        NamedFile::Post(name) => (files.post(name), format!("impellerc posts {name}")),
        _ => return None,
    };
    let file = found.ok()?;
    let about = crate::driver::library::about(&file.text);
    let origin = match (&file.disk, file.origin) {
        (Some(path), _) => path.display().to_string(),
        (None, Origin::Shipped) => format!("comes with the compiler; `{command}` shows it"),
        (None, origin) => origin.word().to_owned(),
    };
    Some(format!("**{}**: {about}\n\n{origin}", file.name))
}

/// The file on the disk, and the line from 0 at which it gives what the job names.
fn place_in_file(named: &NamedFile, tree: &syntax::ast::File, mut files: DiskFiles) -> Option<(PathBuf, usize)> {
    let of_table = |files: &mut DiskFiles, table: &str, name: &str| {
        // Of two tools of one name the later one counts.
        let libraries = tree.items.iter().rev().filter_map(|item| match &item.kind {
            ItemKind::Use { kind, what } if kind.text == "tools" => Some(what.text.clone()),
            _ => None,
        });
        let headers = [format!("[{table}.{name}]"), format!("[{table}.\"{name}\"]")];
        libraries.filter_map(|library| files.tools(&library).ok()).find_map(|file| {
            let line = file.text.lines().position(|line| headers.iter().any(|header| line.trim() == header))?;
            Some((file.disk?, line))
        })
    };
    let whole = |file: SourceFile| Some((file.disk?, 0));
    match named {
        NamedFile::Machine(name) => whole(files.machine(name).ok()?),
        NamedFile::Tools(name) => whole(files.tools(name).ok()?),
        NamedFile::Post(name) => whole(files.post(name).ok()?),
        NamedFile::Tool(name) => of_table(&mut files, "tool", name),
        NamedFile::Holder(name) => of_table(&mut files, "holder", name),
        NamedFile::Curve { file, curve } => {
            let file = files.curves(file).ok()?;
            let of_curve = |line: &str| {
                curve.as_ref().is_some_and(|curve| line.split([',', ';', '\t']).any(|cell| cell.trim() == curve))
            };
            let line = file.text.lines().position(of_curve).unwrap_or(0);
            Some((file.disk?, line))
        }
    }
}
