//! Messages never end the program: the faults of any text are reported in every format, in bounded time and size.

use impellerc::base::source::{SourceMap, Span};
use impellerc::diagnostics::junit::junit;
use impellerc::diagnostics::sarif::sarif;
use impellerc::diagnostics::{Diag, Sink, codes, render};
use std::process::Command;

/// The reports of a run on a job text, by format.
fn reports(text: &str) -> [(&'static str, String); 4] {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("job.imp");
    std::fs::write(&path, text).unwrap();
    ["human", "json", "sarif", "junit"].map(|format| {
        let run =
            Command::new(env!("CARGO_BIN_EXE_impellerc")).arg(&path).args(["--error-format", format]).output().unwrap();
        assert!(run.status.code().is_some_and(|c| c != 0 && c != 101), "{format}: {:?}", run.status);
        let report = String::from_utf8(run.stderr).unwrap();
        assert!(!report.contains("panicked"), "{format}: {report}");
        (format, report)
    })
}

/// The job with a fault behind so much text that no report may hold it.
fn checked(text: &str, code: &str) -> [(&'static str, String); 4] {
    let reports = reports(text);
    for (format, report) in &reports {
        assert!(report.contains(code), "{format}: {report:.2000}");
        assert!(report.len() < 2_000_000, "{format}: {} bytes", report.len());
    }
    reports
}

#[test]
fn lines_of_megabytes() {
    let [(_, human), (_, json), ..] = checked(&format!("let a = {}nothing", " ".repeat(3 << 20)), "IMP0203");
    let column = "let a = ".len() + (3 << 20) + 1;
    assert!(human.contains(&format!(":1:{column}]")), "{human:.2000}");
    assert!(human.contains("... ") && human.contains("nothing"), "{human:.2000}");
    assert!(json.contains(&format!("\"column\":{column}")), "{json:.2000}");
    // A name of a megabyte, a mark of a megabyte.
    checked(&format!("let {0} = 1\nlet {0} = 2", "a".repeat(1 << 20)), "IMP0202");
    checked(&format!("let a = 1 mm + ({})", "1 + ".repeat(10_000) + "1"), "IMP0207");
}

#[test]
fn lines_of_tabs() {
    for tabs in [100, 21_837, 70_000, 1 << 20] {
        let [(_, human), ..] = checked(&format!("let a = {}nothing", "\t".repeat(tabs)), "IMP0203");
        assert!(human.contains(&format!(":1:{}]", "let a = ".len() + tabs + 1)), "{human:.2000}");
    }
}

/// Remarks on places that far to the right come with an NC text that is whole, not in its stead.
#[test]
fn remarks_far_to_the_right_end_no_run() {
    // Its first operation alone gives NC text as well.
    let job = include_str!("../../jobs/small/small.imp");
    let [flank, end] = ["operation flank", "tolerance"].map(|words| job.find(words).unwrap());
    let job = [&job[..flank], &job[end..]].concat();
    let from = "      tip  spline from \"vane_curves.csv\" curve tip_suction mm";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("vane_curves.csv"), include_str!("../../jobs/small/vane_curves.csv")).unwrap();
    let compile = |blanks: &str| {
        assert!(job.contains(from));
        let [path, nc] = ["job.imp", "part.nc"].map(|name| folder.path().join(name));
        std::fs::write(&path, job.replacen(from, &format!("{blanks}{from}"), 1)).unwrap();
        let mut run = Command::new(env!("CARGO_BIN_EXE_impellerc"));
        let run = run.arg(&path).arg("-o").arg(&nc).args(["--stock-cell", "1"]).output().unwrap();
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.success() && said.contains("IMP0312") && !said.contains("panicked"), "{said:.2000}");
        let text = std::fs::read_to_string(&nc).unwrap();
        std::fs::remove_file(nc).unwrap();
        // Everything but the head, which has the hash of the job.
        text[text.find("\nN10 ").unwrap()..].to_owned()
    };
    let due = compile("");
    for blanks in [" ".repeat(70_000), "\t".repeat(22_000)] {
        assert_eq!(compile(&blanks), due);
    }
}

#[test]
fn many_faults() {
    // More than are kept, each with marks far apart.
    let text: String = (0..990).map(|i| format!("let a{i} = {}b{i}\n", "x * ".repeat(50))).collect();
    let [(_, human), (_, json), ..] = checked(&text, "IMP0203");
    assert!(human.contains("more\n"), "{human:.2000}");
    let last = json.lines().last().unwrap();
    assert!(last.contains("IMP0915") && last.contains("further errors are not shown"), "{last}");
}

/// Characters of a file that would steer the terminal.
#[test]
fn nothing_steers_the_terminal() {
    let text = "let a = b // \u{1b}[2J \u{202e} \u{9b}";
    let mut sources = SourceMap::default();
    let source = sources.add("job\u{1b}[31m.imp", text);
    let mut sink = Sink::default();
    sink.push(
        Diag::error(codes::job::UNKNOWN_NAME, "no \u{1b}]0;name\u{7}")
            .label(Span::new(source, 8..9), "\u{2066}here")
            .label(Span::new(source, 9..text.len()), "there\r")
            .help("h\u{200f}elp")
            .note("no\u{8}te")
            .fix(Span::new(source, 8..9), "\u{202e}fix"),
    );
    let reports = [
        render::human(&sink, &sources, false),
        render::json(&sink, &sources),
        sarif(&sink, &sources),
        junit(&sink, &sources, &[]),
    ];
    let steers =
        |c: char| c.is_control() && c != '\n' || matches!(c, '\u{200e}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    for report in &reports {
        assert!(!report.contains(steers), "{report:?}");
    }
    assert!(reports[0].contains("<U+001B>[2J <U+202E>"), "{}", reports[0]);
    // Tools get the text itself.
    let json: serde_json::Value = serde_json::from_str(&reports[1]).unwrap();
    assert_eq!(json["fix"]["replacement"], "\u{202e}fix");
    roxmltree::Document::parse(&reports[3]).unwrap();
}

/// Marks in every place of a text with tabs, wide and odd characters and without an end of the last line: none ends the
/// program, and the place is that of the text.
#[test]
fn marks_everywhere() {
    let long = format!("{}\u{1f980}{}", "\tab\u{e4}".repeat(300), "\u{1b}".repeat(300));
    for text in ["", "\n", "a\r\nb\rc\n\n", "\u{feff}a\tb\u{301}", &format!("x\n{long}\ny"), &long] {
        let mut sources = SourceMap::default();
        let source = sources.add("t", text);
        for start in (0..=text.len() + 2).step_by(1 + text.len() / 200) {
            for length in [0, 1, 7, text.len()] {
                let span = Span::new(source, start..start + length);
                let mut sink = Sink::default();
                let diag = Diag::error(codes::job::UNKNOWN_NAME, "m").label(span, "first");
                sink.push(
                    diag.label(Span::new(source, 0..1), "second")
                        .label(Span::new(source, text.len() / 2..text.len()), "third"),
                );
                let human = render::human(&sink, &sources, false);
                assert!(!human.contains("Failed to read"), "{human}");
                // Nothing can be marked behind the last line end, and half of a character is no place.
                if text.as_bytes().get(start).is_some_and(u8::is_ascii_graphic) {
                    let (line, column) = sources.line_column(span);
                    assert!(human.contains("first"), "{start} {length} {text:?}: {human}");
                    assert!(human.contains(&format!("[t:{line}:{column}]")), "{line} {column} {text:?}: {human}");
                }
            }
        }
    }
}
