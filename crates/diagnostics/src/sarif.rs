//! Diagnostics as SARIF 2.1.0 (OASIS, 2020), the format that code hosts show as comments of a review.

use super::{Code, Diag, Severity, Sink, shown};
use base::source::{SourceMap, Span};
use serde_json::{Value, json};

/// All diagnostics of a run as one SARIF log. Lines and columns count from 1, columns in characters.
pub fn sarif(sink: &Sink, sources: &SourceMap) -> String {
    let shown = shown::all(sink);
    let mut rules: Vec<Code> = Vec::new();
    for diag in &shown {
        if !rules.contains(&diag.code) {
            rules.push(diag.code);
        }
    }
    let results: Vec<Value> = shown.iter().map(|d| result(d, &rules, sources)).collect();
    let log = json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "impellerc",
                "semanticVersion": env!("CARGO_PKG_VERSION"),
                "rules": rules.iter().map(|c| rule(*c)).collect::<Vec<_>>(),
            }},
            "columnKind": "unicodeCodePoints",
            "invocations": [{ "executionSuccessful": !sink.has_errors() }],
            "results": results,
        }],
    });
    shown::json(&format!("{log:#}\n"))
}

fn rule(code: Code) -> Value {
    json!({
        "id": code.id(),
        "shortDescription": { "text": code.0.title },
        "help": { "text": code.0.page.trim_end() },
    })
}

fn result(diag: &Diag, rules: &[Code], sources: &SourceMap) -> Value {
    let mut text = diag.message.clone();
    for note in &diag.notes {
        text.push_str(&format!("\nnote: {note}"));
    }
    if let Some(help) = &diag.help {
        text.push_str(&format!("\nhelp: {help}"));
    }
    let level = match diag.severity {
        Severity::Remark => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    let mut value = json!({
        "ruleId": diag.code.id(),
        "ruleIndex": rules.iter().position(|r| *r == diag.code),
        "level": level,
        "message": { "text": text },
        "locations": [],
    });
    let mut places: Vec<Value> = diag
        .labels
        .iter()
        .filter_map(|label| {
            let mut place = physical(label.span, sources)?;
            place["message"] = json!({ "text": label.text });
            Some(place)
        })
        .collect();
    if !places.is_empty() {
        let first = places.remove(0);
        value["locations"] = json!([first]);
    }
    if !places.is_empty() {
        for (id, place) in places.iter_mut().enumerate() {
            place["id"] = json!(id + 1);
        }
        value["relatedLocations"] = Value::Array(places);
    }
    if let Some(place) = &diag.place {
        // A place on the part in mm: SARIF has no element for it.
        let p = place.point;
        value["properties"] = json!({ "place": { "what": place.what, "point": [p.x, p.y, p.z] } });
    }
    if let Some((fix, location)) = diag.fix.as_ref().and_then(|f| Some((f, physical(f.span, sources)?))) {
        let location = &location["physicalLocation"];
        value["fixes"] = json!([{ "artifactChanges": [{
            "artifactLocation": location["artifactLocation"],
            "replacements": [{
                "deletedRegion": location["region"],
                "insertedContent": { "text": fix.replacement },
            }],
        }]}]);
    }
    value
}

fn physical(span: Span, sources: &SourceMap) -> Option<Value> {
    let file = sources.get(span.source)?;
    let (line, column) = sources.line_column(span);
    let (end_line, end_column) = sources.line_column(Span { start: span.end, ..span });
    Some(json!({ "physicalLocation": {
        "artifactLocation": { "uri": uri(file.path()) },
        "region": { "startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column },
    }}))
}

/// A path as a reference of RFC 3986, as the user wrote the path; a relative path stays relative.
fn uri(path: &str) -> String {
    let mut out = String::new();
    let path = path.replace('\\', "/");
    if path.starts_with('/') {
        out.push_str("file://");
    }
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::uri;

    #[test]
    fn paths_become_references() {
        assert_eq!(uri("jobs/a b.imp"), "jobs/a%20b.imp");
        assert_eq!(uri("/t/p\u{e4}rt#1.nc"), "file:///t/p%C3%A4rt%231.nc");
        assert_eq!(uri("jobs\\x.imp"), "jobs/x.imp");
    }
}
