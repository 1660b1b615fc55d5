//! A library file read for itself, as an editor shows it.

use super::machine as library;
use super::post_file;
use super::schema::LibraryFile;
use super::tool_file;
use super::tool_file::ToolLibrary;
use base::source::{SourceMap, Span};
use diagnostics::Sink;

/// Reads a library file; the faults that a job would have by it go to the sink. Returns the text with its places.
pub fn read_library_file(kind: LibraryFile, name: &str, text: &str, sink: &mut Sink) -> SourceMap {
    let mut sources = SourceMap::default();
    let source = sources.add(name, text);
    let whole = Span::new(source, 0..0);
    match kind {
        LibraryFile::Machine => drop(library::machine(name, source, &sources, whole, sink)),
        LibraryFile::Tools => {
            let mut library = ToolLibrary { alone: true, ..ToolLibrary::default() };
            tool_file::tools(source, &sources, whole, &mut library, sink);
        }
        LibraryFile::Post => drop(post_file::read(name, source, &sources, None, sink)),
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::shipped;

    /// What the reader says of a shipped machine with a line in the place of another.
    fn differences(line: &str, other: &str) -> Vec<String> {
        let text = shipped::MACHINES[0].1;
        assert!(text.contains(line), "{line}");
        let mut sink = Sink::default();
        read_library_file(LibraryFile::Machine, "machine", &text.replacen(line, other, 1), &mut sink);
        sink.diags().iter().flat_map(|diag| diag.labels.iter().map(|label| label.text.clone())).collect()
    }

    #[test]
    fn ranges_are_given_in_the_unit_that_stands_there() {
        let kind = "kind = \"table-table\"\n";
        assert_eq!(differences(kind, kind), [""; 0]);
        assert_eq!(differences(kind, &format!("{kind}cycle = \"0.01 s\"\n")), [""; 0]);
        let cycle = differences(kind, &format!("{kind}cycle = \"0.02 s\"\n"));
        assert!(cycle.contains(&"a value from 0.000001 to 0.01 s is expected".to_owned()), "{cycle:?}");
        let power = differences("[spindle]\n", "[spindle]\npower = \"2000 kW\"\n");
        assert!(power.contains(&"a value from 0.01 to 1000 kW is expected".to_owned()), "{power:?}");
    }
}
