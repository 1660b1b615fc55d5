//! The JSON schemas of library files, compared with the readers of these files: same keys, same required keys, same forms.

use impellerc::diagnostics::Sink;
use impellerc::job::files::shipped;
use impellerc::job::{LibraryFile, library_schema, read_library_file};
use serde_json::{Value, json};
use std::collections::BTreeSet;

const KINDS: [(LibraryFile, &[(&str, &str)]); 3] = [
    (LibraryFile::Machine, shipped::MACHINES),
    (LibraryFile::Tools, shipped::TOOLS),
    (LibraryFile::Post, shipped::POSTS),
];

/// A value with every key that a schema has.
fn example(schema: &Value) -> Value {
    if let Some(words) = schema["enum"].as_array() {
        return words[0].clone();
    }
    match schema["type"].as_str().unwrap() {
        "object" => match schema["properties"].as_object() {
            Some(properties) => properties.iter().map(|(name, of)| (name.clone(), example(of))).collect(),
            None => json!({ "named": example(&schema["additionalProperties"]) }),
        },
        "array" => {
            let count = schema["minItems"].as_u64().unwrap_or(1);
            (0..count).map(|_| example(&schema["items"])).collect()
        }
        "string" => schema["examples"].get(0).cloned().unwrap_or(json!("text")),
        "integer" => json!(1),
        "number" => json!(1.0),
        "boolean" => json!(true),
        other => panic!("{other}"),
    }
}

/// Messages about the form of a file, with their help.
fn faults(kind: LibraryFile, value: &Value) -> Vec<[String; 2]> {
    let text = toml::to_string(&toml::Value::try_from(value).unwrap()).unwrap();
    let mut sink = Sink::default();
    read_library_file(kind, "example", &text, &mut sink);
    let said = sink.diags().iter().map(|diag| [diag.message.clone(), diag.help.clone().unwrap_or_default()]);
    let said: Vec<[String; 2]> = said.collect();
    // What the walk over the form lets through, the reader takes.
    assert!(said.iter().all(|[message, _]| !message.contains("is not TOML")), "{said:?}");
    let of_form =
        |message: &str| message.contains(" no `") || message.contains(" no key `") || message.contains(" must be ");
    said.into_iter().filter(|[message, _]| of_form(message)).collect()
}

/// Compares the table of a schema, at a place of the example, with the reader.
fn compare(kind: LibraryFile, whole: &Value, at: &str, schema: &Value, seen: &mut usize) {
    if let Some(properties) = schema["properties"].as_object() {
        *seen += 1;
        let mut more = whole.clone();
        more.pointer_mut(at).unwrap()["zqzqzq"] = json!(1);
        let [[said, help]] = &faults(kind, &more)[..] else { panic!("{at}: {:?}", faults(kind, &more)) };
        assert!(said.contains("no key `zqzqzq`"), "{at}: {said}");
        let listed = help.split(';').next().unwrap_or_default().trim_start_matches("known: ");
        let known: BTreeSet<&str> = listed.split(", ").collect();
        assert_eq!(known, properties.keys().map(String::as_str).collect(), "{at}: {help}");
        let required: BTreeSet<&str> =
            schema["required"].as_array().unwrap().iter().map(|r| r.as_str().unwrap()).collect();
        for (name, of) in properties {
            let mut less = whole.clone();
            less.pointer_mut(at).unwrap().as_object_mut().unwrap().remove(name);
            let missing = faults(kind, &less).iter().any(|[said, _]| said.contains(&format!("no `{name}`")));
            assert_eq!(missing, required.contains(name.as_str()), "{at}/{name}");
            wrongly_typed(kind, whole, &format!("{at}/{name}"));
            compare(kind, whole, &format!("{at}/{name}"), of, seen);
        }
    } else if schema["type"] == "object" {
        compare(kind, whole, &format!("{at}/named"), &schema["additionalProperties"], seen);
    } else if schema["type"] == "array" {
        compare(kind, whole, &format!("{at}/0"), &schema["items"], seen);
    }
}

/// A value of another type gives one message, in the words of the file format, and a help that shows the right form.
fn wrongly_typed(kind: LibraryFile, whole: &Value, at: &str) {
    let name = at.rsplit('/').next().unwrap();
    for wrong in
        [json!(-7), json!(2.5), json!("x"), json!(true), json!([]), json!([1, "x"]), json!([[1]]), json!({ "x": 1 })]
    {
        let text = |value: &Value| toml::to_string(&toml::Value::try_from(value).unwrap()).unwrap();
        let mut other = whole.clone();
        *other.pointer_mut(at).unwrap() = wrong.clone();
        let mut sink = Sink::default();
        read_library_file(kind, "example", &text(&other), &mut sink);
        for diag in sink.diags() {
            let said = format!("{}; {:?}; {:?}; {:?}", diag.message, diag.labels, diag.help, diag.notes);
            for word in [
                "invalid type",
                "expected struct",
                "expected a ",
                "missing field",
                "unknown field",
                "jobs/_lib",
                "u32",
                "usize",
            ] {
                assert!(!said.contains(word), "{at} = {wrong}: {said}");
            }
        }
        let right = whole.pointer(at).unwrap();
        if std::mem::discriminant(right) != std::mem::discriminant(&wrong) && !right.is_object() {
            let [diag] = sink.diags() else { panic!("{at} = {wrong}: {:?}", sink.diags()) };
            let help = diag.help.as_deref().unwrap_or_default();
            assert!(
                diag.message.contains(&format!("`{name}`")) && help.contains(&format!("{name} = ")),
                "{at} = {wrong}: {diag:?}"
            );
        }
    }
}

#[test]
fn keys_are_those_of_the_readers() {
    let mut seen = 0;
    for (kind, _) in KINDS {
        let schema = library_schema(kind);
        let whole = example(&schema);
        assert!(faults(kind, &whole).is_empty(), "{kind:?}");
        compare(kind, &whole, "", &schema, &mut seen);
    }
    // Axes, part, spindle and so on: the walk came to all tables.
    assert!(seen >= 25, "{seen}");
}

/// Whether a value fits a schema, with the words of the schemas here.
fn fits(value: &Value, schema: &Value) -> Result<(), String> {
    let wrong = || Err(format!("{value} does not fit {schema}"));
    if schema["enum"].as_array().is_some_and(|words| !words.contains(value)) {
        return wrong();
    }
    let right = match schema["type"].as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_u64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        other => panic!("{other}"),
    };
    if !right {
        return wrong();
    }
    if let (Some(text), Some(pattern)) = (value.as_str(), schema["pattern"].as_str()) {
        // The patterns are a number and one of some units.
        let units = pattern.rsplit_once('(').unwrap().1.split_once(')').unwrap().0;
        let unit = text.trim().trim_start_matches(|c: char| c.is_ascii_digit() || "+-.".contains(c)).trim();
        if !units.split('|').any(|known| known == unit) {
            return wrong();
        }
    }
    for item in value.as_array().into_iter().flatten() {
        fits(item, &schema["items"])?;
    }
    for (name, item) in value.as_object().into_iter().flatten() {
        match schema["properties"].get(name) {
            Some(of) => fits(item, of)?,
            None if schema["additionalProperties"].is_object() => fits(item, &schema["additionalProperties"])?,
            None => return Err(format!("`{name}` is no key")),
        }
    }
    Ok(())
}

#[test]
fn shipped_files_fit() {
    for (kind, files) in KINDS {
        assert!(!files.is_empty());
        for (name, text) in files {
            let value: toml::Value = toml::from_str(text).unwrap();
            fits(&serde_json::to_value(value).unwrap(), &library_schema(kind))
                .unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }
}
