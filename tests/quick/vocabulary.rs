//! The tables of the words of the language against the front end that uses them, and the page that is made from them.

use impellerc::base::source::SourceMap;
use impellerc::diagnostics::{Severity, Sink};
use impellerc::job::language::understand;
use impellerc::job::vocabulary::{self, Topic, TopicKind, Without};
use impellerc::job::{self, InMemory, print};
use impellerc::syntax;
use std::collections::BTreeSet;

/// A word that is near to no word of the language.
const PROBE: &str = "zqzqzqzqzqzq";

/// The job into which an example is put: that of the first page, with the item of the topic replaced.
fn with_example(topic: &Topic, example: &str) -> String {
    let text = std::fs::read_to_string("jobs/new/vanes.imp").unwrap();
    let (before, rest) = text.split_once("operation rough").unwrap();
    let plunger = "tool t4 = flat { diameter 6 mm  flutes 4  flute 30 mm  reach 40 mm  plunge-width 3 mm  holder \"er16-mini\" }\n";
    let operation = "operation channel { tool t2  speed 8000 rpm  feed 250 mm/min  scallop 50 um }\n";
    let rest = rest.split_once("tolerance").unwrap().1.replace("require rest      <= 1 mm\n", "");
    match (topic.kind, topic.name) {
        (TopicKind::Operation, _) | (TopicKind::Item, "operation") => {
            format!("{before}{plunger}{example}\ntolerance{rest}")
        }
        (TopicKind::Tool, _) | (TopicKind::Item, "tool" | "let") => {
            format!("{before}{example}\n{operation}tolerance{rest}")
        }
        (_, name) => {
            // The items of the job that the example replaces are single lines.
            let job = format!(
                "{before}{operation}operation fillet {{ tool t2  speed 8000 rpm  feed 250 mm/min  scallop 20 um }}\ntolerance{rest}"
            );
            let kept = job.lines().filter(|line| !line.starts_with(name));
            let kept = kept.fold(String::new(), |all, line| all + line + "\n");
            if matches!(name, "edition" | "use") { format!("{example}\n{kept}") } else { format!("{kept}{example}\n") }
        }
    }
}

/// Topics whose example is a whole text; the others have a form with `...`.
fn whole() -> impl Iterator<Item = &'static Topic> {
    vocabulary::topics().filter(|t| t.kind != TopicKind::Block && !t.example.contains("..."))
}

fn errors(text: &str) -> Vec<String> {
    let found = understand("job.imp", text, &mut InMemory::default());
    let errors = found.diags.iter().filter(|d| d.severity == Severity::Error);
    errors.map(|d| format!("{}: {}", d.code.id(), d.message)).collect()
}

/// The job with all defaults.
fn printed(text: &str) -> String {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("job.imp", text);
    let tree = syntax::parse(text, source, &mut sink);
    let job = job::resolve(&tree, &mut InMemory::default(), &mut sources, &mut sink);
    print::print(&job.unwrap_or_else(|_| panic!("{:#?}\n{text}", sink.diags())))
}

#[test]
fn examples_compile() {
    assert!(whole().count() > 24);
    for topic in whole() {
        let text = with_example(topic, topic.example);
        assert_eq!(errors(&text), [""; 0], "{}\n{text}", topic.name);
    }
}

/// The example with a property added, or with another value of it.
fn with_property(example: &str, name: &str, value: &str) -> String {
    let start =
        [format!("{{ {name} "), format!("  {name} ")].iter().find_map(|s| example.rfind(s.as_str()).map(|at| at + 2));
    let Some(start) = start else {
        let end = example.rfind('}').unwrap();
        return format!("{}  {name} {value} }}{}", example[..end].trim_end(), &example[end + 1..]);
    };
    let rest = &example[start..];
    let end = ["  ", " }", "\n"].iter().filter_map(|e| rest.find(e)).min().unwrap();
    format!("{}{name} {value}{}", &example[..start], &rest[end..])
}

/// Words in backticks of a text.
fn marked(text: &str) -> BTreeSet<String> {
    let words = text.split('`').skip(1).step_by(2).filter(|w| w.chars().all(|c| c.is_ascii_lowercase() || c == '-'));
    words.map(str::to_owned).collect()
}

#[test]
fn values_are_those_that_the_front_end_knows() {
    let mut compared = 0;
    for topic in whole().filter(|t| t.kind == TopicKind::Operation || matches!(t.name, "stock" | "post")) {
        for property in topic.all() {
            let words = marked(&property.value());
            if words.len() < 2 || matches!(property.name, "allowance" | "rest") {
                continue;
            }
            let lines = property.name == "milling" && matches!(topic.name, "point" | "fillet");
            let example =
                if lines { with_property(topic.example, "lines", "one-way") } else { topic.example.to_owned() };
            let text = with_example(topic, &with_property(&example, property.name, PROBE));
            let found = understand("job.imp", &text, &mut InMemory::default());
            let known: Vec<BTreeSet<String>> =
                found.diags.iter().filter(|d| !d.known.is_empty()).map(|d| d.known.iter().cloned().collect()).collect();
            assert_eq!(known, [words], "`{}` of {}\n{:#?}\n{text}", property.name, topic.name, found.diags);
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn defaults_are_those_of_the_front_end() {
    let mut compared = 0;
    for topic in whole().filter(|t| t.kind == TopicKind::Operation) {
        let plain = printed(&with_example(topic, topic.example));
        for property in topic.all() {
            let Without::Is(value) = property.without else { continue };
            let lines = property.name == "milling" && matches!(topic.name, "point" | "fillet");
            let example =
                if lines { with_property(topic.example, "lines", "one-way") } else { topic.example.to_owned() };
            let plain = if lines { printed(&with_example(topic, &example)) } else { plain.clone() };
            let stated = printed(&with_example(topic, &with_property(&example, property.name, value)));
            assert_eq!(stated, plain, "`{}` of {}", property.name, topic.name);
            compared += 1;
        }
    }
    assert!(compared > 40, "{compared}");
}

#[test]
fn words_are_explained() {
    for word in vocabulary::words() {
        let page = vocabulary::explain(word).unwrap_or_else(|| panic!("{word} has no page"));
        assert!(page.contains(&format!("`{word}`")), "{page}");
    }
    assert_eq!(vocabulary::explain(PROBE), None);
    let page = vocabulary::explain("scallop").unwrap();
    assert!(page.starts_with("`scallop`, a property of point, fillet, edge, tip, channel\n"), "{page}");
}

#[test]
fn the_reference_is_made_from_the_tables() {
    let (path, made) = ("docs/reference.md", vocabulary::reference());
    if std::env::var_os("INSTA_UPDATE").is_some_and(|how| how == "always") {
        std::fs::write(path, &made).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    assert!(written == made, "write it again: `impellerc explain --reference > {path}`");
}
