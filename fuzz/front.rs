//! What the targets run: the front end on texts in memory, and the readers of NC text.

pub mod blades;

use impellerc::base::source::{SourceFile, SourceMap, Span};
use impellerc::diagnostics::junit::junit;
use impellerc::diagnostics::sarif::sarif;
use impellerc::diagnostics::{Sink, codes, render};
use impellerc::five_axis::control::ModuloWay;
use impellerc::ir::Program;
use impellerc::job::files::shipped;
use impellerc::job::{self, Files, MissingFile};
use impellerc::nc::{self, motion_of::motion_of};
use impellerc::{lower, syntax};
use std::sync::OnceLock;

/// Texts of one compilation. A file that is not given is the shipped one, or that of the small job.
#[derive(Clone, Copy, Debug)]
pub struct Texts<'a> {
    /// The job.
    pub job: &'a str,
    /// Any machine file.
    pub machine: Option<&'a str>,
    /// Any tool file.
    pub tools: Option<&'a str>,
    /// Any curve file.
    pub curves: &'a str,
    /// Any mesh file.
    pub mesh: &'a [u8],
}

/// The small job of the fault campaign, and its curves.
pub const SMALL: Texts<'_> = Texts {
    job: include_str!("../jobs/small/small.imp"),
    machine: None,
    tools: None,
    curves: include_str!("../jobs/small/vane_curves.csv"),
    mesh: &[],
};

impl Files for Texts<'_> {
    fn machine(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find(name, self.machine, shipped::MACHINES)
    }

    fn tools(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find(name, self.tools, shipped::TOOLS)
    }

    fn post(&mut self, name: &str) -> Result<SourceFile, MissingFile> {
        find(name, None, shipped::POSTS)
    }

    fn curves(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        find(path, Some(self.curves), &[])
    }

    fn mesh(&mut self, path: &str) -> Result<SourceFile, MissingFile> {
        Ok(SourceFile { data: self.mesh.to_vec(), ..SourceFile::text(path, "") })
    }
}

fn find(name: &str, given: Option<&str>, files: &[(&str, &str)]) -> Result<SourceFile, MissingFile> {
    let known: Vec<String> = files.iter().map(|f| f.0.to_owned()).collect();
    match given.or_else(|| files.iter().find(|f| f.0 == name).map(|f| f.1)) {
        Some(text) => Ok(SourceFile::text(name, text)),
        None => Err(MissingFile { reason: "not in memory".to_owned(), known, ..MissingFile::default() }),
    }
}

/// The lowered program, where the texts give one. Whatever they are, every fault is told in every format, none of them as
/// a fault of the compiler, and nothing of a file reaches the terminal that would steer it.
pub fn front(texts: Texts<'_>) -> Option<Program> {
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let program = program(texts, &mut sources, &mut sink);
    assert!(program.is_some() || sink.has_errors(), "no program and no error");
    assert!(sink.diags().iter().all(|d| d.code != codes::files::INTERNAL), "a fault of the compiler");
    let human = render::human(&sink, &sources, false);
    for report in [human, render::json(&sink, &sources), sarif(&sink, &sources), junit(&sink, &sources, &[])] {
        let steers =
            |c: char| c.is_control() && c != '\n' || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        assert!(!report.contains(steers), "a report holds a character that steers a terminal: {report:?}");
    }
    program
}

fn program(texts: Texts<'_>, sources: &mut SourceMap, sink: &mut Sink) -> Option<Program> {
    let mut files = texts;
    let source = sources.add("job.imp", texts.job);
    let tree = syntax::parse(texts.job, source, sink);
    let _ = syntax::print::print(&tree);
    let job = job::resolve(&tree, &mut files, sources, sink).ok()?;
    let _ = job::print::print(&job);
    lower::lower(&job, sink).ok()
}

/// Reads NC text of a dialect, and the motion that the small job would see in it on a machine of the library, and on one whose
/// axis 2 is modulo 360 deg. Faults are told with a line of the text.
pub fn nc(post: &str, machine: &str, text: &str) {
    static PROGRAMS: OnceLock<Option<[Program; 2]>> = OnceLock::new();
    let machine = shipped::MACHINES.iter().find(|m| m.0 == machine).map(|m| m.1);
    let programs = || {
        let limited = front(Texts { machine, ..SMALL })?;
        let mut endless = limited.clone();
        let axis = &mut endless.machine.rotary[1];
        (axis.min, axis.max, axis.modulo) = (f64::NEG_INFINITY, f64::INFINITY, Some(ModuloWay::Shortest));
        Some([limited, endless])
    };
    let Some(programs) = PROGRAMS.get_or_init(programs) else { panic!("the small job is faulty") };
    programs.iter().for_each(|program| on_machine(post, program, text));
}

fn on_machine(post: &str, program: &Program, text: &str) {
    let Some(post) = nc::find(post) else { panic!("no post {post}") };
    let (mut sources, mut sink) = (SourceMap::default(), Sink::default());
    let source = sources.add("part.nc", text);
    let span = |line: usize| sources.line_span(source, line).unwrap_or(Span::new(source, 0..0));
    match post.read(text, &program.machine) {
        Err(faults) => assert!(!faults.is_empty(), "refused without a reason"),
        Ok(moves) => {
            let motion = motion_of(program, &moves, &span, &mut sink);
            assert!(motion.is_some() || sink.has_errors(), "no motion and no error");
        }
    }
    let _ = render::human(&sink, &sources, false);
}
