//! A library file read for itself, as an editor shows it.

use super::library_schema::LibraryFile;
use super::tool_file::ToolLibrary;
use super::{library, post_file, tool_file};
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
