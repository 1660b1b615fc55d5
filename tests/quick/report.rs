//! The report as its reader sees it: in a browser, and as a file.

use crate::support::browser::{self, Page, colours, count};
use crate::support::pinned;
use flate2::read::ZlibDecoder;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::{Mm, Mm2};
use impellerc::diagnostics::Diag;
use impellerc::diagnostics::codes::verification;
use impellerc::ir::{Operation, Tool};
use impellerc::report::proof::details::details;
use impellerc::report::report::{self, Input};
use impellerc::verify::proof::sweep::Sweep;
use impellerc::verify::surface::{CORNER_SLACK, FAR};
use nalgebra::Point3;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// Edge of the cells of the stock, mm: coarser than the contract on the engagement asks for. The report shows the figures
/// of whatever cells there are.
const CELL: &str = "0.6";

/// Compiles the reduced job with other contracts; gives what was said and the report.
fn compile(folder: &Path, contracts: &str) -> (Output, PathBuf) {
    compile_text(folder, &std::fs::read_to_string("jobs/reduced/reduced.imp").unwrap(), contracts)
}

/// The same for the text of a job with the curves of the reduced one.
fn compile_text(folder: &Path, original: &str, contracts: &str) -> (Output, PathBuf) {
    let job = original.replace("require clearance >= 0.5 mm", contracts);
    assert_ne!(job, original);
    std::fs::write(folder.join("job.imp"), job).unwrap();
    std::fs::copy("jobs/reduced/vane_curves.csv", folder.join("vane_curves.csv")).unwrap();
    let report = folder.join("part.html");
    let output = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .args(["--library", "jobs/_lib", "--stock-cell", CELL])
        .arg(folder.join("job.imp"))
        .arg("-o")
        .arg(folder.join("part.nc"))
        .arg("--report")
        .arg(&report)
        .output()
        .unwrap();
    (output, report)
}

/// Contracts that the reduced job keeps.
const KEPT: &str = "require clearance >= 0.4 mm\nrequire engagement <= 180 deg on operation groove";

/// What the job with these contracts said, its NC text, and its report.
pub struct Compiled {
    pub folder: tempfile::TempDir,
    said: String,
    pub report: PathBuf,
}

/// Compiled once for all who look at it.
pub static COMPILED: LazyLock<Compiled> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let (output, report) = compile(folder.path(), KEPT);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    Compiled { folder, said, report }
});

/// Bytes of a deflated array of the page.
pub fn inflated(html: &str, name: &str) -> Vec<u8> {
    let packed = browser::base64(between(html, &format!("id=\"{name}\">"), "</script>"));
    let mut bytes = Vec::new();
    ZlibDecoder::new(packed.as_slice()).read_to_end(&mut bytes).unwrap();
    bytes
}

/// Text between two marks.
pub fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let from = text.find(start).unwrap_or_else(|| panic!("no {start}")) + start.len();
    &text[from..from + text[from..].find(end).unwrap()]
}

#[test]
fn a_reader_sees_part_scale_plots_and_worst_places() {
    let Some(program) = browser::find() else { return };
    let report = &COMPILED.report;
    let folder = tempfile::tempdir().unwrap();
    let mut page = Page::open(&program, report, [1680, 2200], &folder.path().join("profile"));

    let [scene, scale, plots] = ["#scene", "#scale", "#plots"].map(|s| page.place(s));
    let first = page.screenshot();
    // Shaded surfaces in the colours of the scale; an empty canvas has a dozen greys.
    let part = first.part(scene);
    assert!(colours(&part) > 150, "{} colours in the view", colours(&part));
    let bar = first.part(scale);
    assert!(colours(&bar) > 30, "{} colours in the scale", colours(&bar));
    for end in [[0x7f, 0x2a, 0x04], [0x08, 0x28, 0x5c]] {
        assert!(count(&bar, end) > 20, "the scale does not reach {end:?}");
    }
    let drawn = first.part(plots);
    for (axis, colour) in [("X", [0xd9, 0x48, 0x0f]), ("Y", [0x2b, 0x8a, 0x3e]), ("Z", [0x19, 0x71, 0xc2])] {
        assert!(count(&drawn, colour) > 300, "{} pixels of axis {axis}", count(&drawn, colour));
    }
    for (axis, colour) in [("A", [0xc2, 0x25, 0x5c]), ("C", [0x70, 0x48, 0xe8])] {
        assert!(count(&drawn, colour) > 300, "{} pixels of axis {axis}", count(&drawn, colour));
    }

    // The paths of the first operation appear in its colour.
    let green = [0x0c, 0xa6, 0x78];
    let before = count(&part, green);
    page.click("#operations input");
    let after = count(&page.screenshot().part(scene), green);
    assert!(after > before + 300, "{before} green pixels without paths, {after} with them");
    page.click("#operations input");

    // A worst place jumps to the middle of the view, with a ring about it.
    page.click("#places button");
    let jumped = page.screenshot().part(scene);
    let changed = part.iter().zip(&jumped).filter(|(a, b)| a != b).count();
    assert!(changed * 10 > part.len(), "{changed} of {} pixels changed", part.len());
    let middle = [scene[0] + scene[2] / 2 - 20, scene[1] + scene[3] / 2 - 20, 40, 40];
    let ring = [217, 13, 89];
    let seen = count(&page.screenshot().part(middle), ring);
    assert!(seen > 60, "{seen} pixels of the ring about the place");
    assert!(page.evaluate("document.getElementById('readout').textContent").contains("mm"));
    assert!(page.evaluate("document.getElementById('move').textContent").contains("NC line"));

    // Every other view and body draws too.
    page.click("[data-view=top]");
    let top = page.screenshot().part(scene);
    page.evaluate("const b = document.getElementById('body'); b.value = 'blank'; b.dispatchEvent(new Event('change'))");
    page.settle();
    let blank = page.screenshot().part(scene);
    let changed = top.iter().zip(&blank).filter(|(a, b)| a != b).count();
    assert!(changed * 10 > top.len(), "the blank looks like the part: {changed} pixels changed");
    // The stock after each operation: less than the blank after the first, less again after the second.
    let mut before = blank;
    for stage in 0..2 {
        let choose = format!("body.value = '{stage}'; body.dispatchEvent(new Event('change'))");
        page.evaluate(&choose);
        page.settle();
        let stock = page.screenshot().part(scene);
        let changed = before.iter().zip(&stock).filter(|(a, b)| a != b).count();
        assert!(changed * 200 > stock.len(), "stock {stage} looks like what was before it: {changed} pixels changed");
        let note = page.evaluate("document.getElementById('stock-note').textContent");
        assert!(note.contains("Simulated in cells of") && note.contains("drawn in cells of"), "{note}");
        before = stock;
    }

    let address = format!("file://{}", report.display());
    assert_eq!(page.requests, [address], "the page asks for nothing but itself");
    assert!(page.complaints.is_empty(), "{:?}", page.complaints);
}

#[test]
fn the_file_is_whole_bounded_and_the_same_again() {
    // In a pipe nothing is said about progress: neither bars nor control signs.
    let Compiled { said, report, .. } = &*COMPILED;
    assert!(!said.contains('\u{1b}') && !said.contains('\r') && !said.contains("verify"), "{said:?}");

    let html = std::fs::read_to_string(report).unwrap();
    assert!(html.len() < 15_000_000, "{} bytes", html.len());
    assert!(!html.contains("<!--@"), "a mark was not filled");
    for outside in ["src=", "href=", "@import", "fetch(", "XMLHttpRequest", "WebSocket", "://"] {
        assert!(!html.contains(outside), "the page names {outside}");
    }
    let data = between(&html, "id=\"data\">", "</script>");
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let moves = data["paths"]["kept"].as_u64().unwrap() as usize;
    assert_eq!(data["paths"]["operations"].as_array().unwrap().len(), 4);
    let joints = inflated(&html, "joints");
    assert_eq!(joints.len(), moves * 6 * 4);
    let finite = |four: &[u8]| f32::from_le_bytes([four[0], four[1], four[2], four[3]]).is_finite();
    assert!(joints.chunks(4).all(finite), "joints that are no numbers");

    let folder = tempfile::tempdir().unwrap();
    let (_, again) = compile(folder.path(), KEPT);
    assert!(std::fs::read_to_string(again).unwrap() == html, "the same job made another report");
}

/// Every bar of active limits is whole; each operation has its histogram, and those with a contract its bound.
#[test]
fn bars_and_histograms_show_what_the_certificate_has() {
    let html = std::fs::read_to_string(&COMPILED.report).unwrap();
    let bars: Vec<&str> = html.split("<div class=bar>").skip(1).collect();
    assert!(bars.len() > 4, "{} bars", bars.len());
    for bar in bars {
        let bar = &bar[..bar.find("</div>").unwrap()];
        let parts = bar.split("flex:").skip(1).map(|p| p[..p.find(';').unwrap()].parse::<f64>().unwrap());
        let sum: f64 = parts.sum();
        assert!((sum - 100.0).abs() < 0.2, "{sum} %: {bar}");
    }
    let figures: Vec<&str> = html.split("<figure>").skip(1).map(|f| &f[..f.find("</figure>").unwrap()]).collect();
    assert_eq!(figures.len(), 4);
    for figure in figures {
        assert_eq!(figure.matches("<rect").count(), 13, "air and twelve classes");
        assert_eq!(figure.contains("at most 180"), figure.contains("<figcaption>groove:"), "{figure}");
    }
}

#[test]
fn a_failed_contract_is_shown_and_nothing_else_written() {
    // The first operation alone leaves enough.
    let text = std::fs::read_to_string("jobs/reduced/reduced.imp").unwrap();
    let (first, rest) = text.split_once("operation expand").unwrap();
    let (_, after) = rest.split_once("tolerance").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let contracts = "require clearance >= 0.4 mm\nrequire excess <= 1 um";
    let (output, report) = compile_text(folder.path(), &format!("{first}tolerance{after}"), contracts);
    assert!(!output.status.success());
    assert!(!folder.path().join("part.nc").exists());
    let html = std::fs::read_to_string(report).unwrap();
    assert!(html.contains("1 of 3 contracts fail"));
    assert!(html.contains("none: a fault stopped it"));
}

#[test]
fn nc_text_from_a_file_has_a_report_too() {
    let folder = &COMPILED.folder;
    let report = folder.path().join("read.html");
    let output = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .args(["verify", "--library", "jobs/_lib", "--stock-cell", CELL, "--job"])
        .arg(folder.path().join("job.imp"))
        .arg("--report")
        .arg(&report)
        .arg(folder.path().join("part.nc"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let html = std::fs::read_to_string(report).unwrap();
    let data: serde_json::Value = serde_json::from_str(between(&html, "id=\"data\">", "</script>")).unwrap();
    let lines = std::fs::read_to_string(folder.path().join("part.nc")).unwrap().lines().count();
    assert!(html.contains(&format!("{lines} lines")));
    let runs = data["paths"]["operations"][0]["lines"].as_array().unwrap();
    assert!(!runs.is_empty() && runs.iter().all(|r| r[1].as_u64().unwrap() <= lines as u64));
}

/// Brute force: the least distance to all pieces of all operations, point by point.
#[test]
fn colours_are_what_a_search_over_the_whole_program_finds() {
    let reduced = pinned::reduced("siemens-840d");
    let ((program, motion), certificate) = (reduced.planned(), reduced.certificate());
    let (samples, deviations) = report::deviations(program, certificate);
    assert_eq!(deviations.len(), samples.len() * program.part.vane_count as usize);
    let sweeps: Vec<Sweep<'_>> = (0..motion.operations.len()).filter_map(|o| Sweep::new(program, motion, o)).collect();
    let (mut compared, mut far) = (0, 0);
    for (i, shown) in deviations.iter().enumerate().step_by(37) {
        let (sample, sector) = (&samples[i % samples.len()], (i / samples.len()) as u32);
        assert_eq!(shown.is_nan(), !sample.surface.milled());
        if shown.is_nan() {
            continue;
        }
        let p = program.part.sector_rotation(sector) * sample.position;
        let least = sweeps.iter().filter_map(|s| s.nearest(&p, FAR)).map(|n| n.distance).fold(FAR, f64::min);
        let over = shown - least;
        assert!((-3e-5..=CORNER_SLACK).contains(&over), "{shown} is shown at {p}, the program leaves {least}");
        compared += 1;
        far += usize::from(least >= FAR);
    }
    assert!(compared > 3000 && far < compared, "{compared} places, {far} of them out of reach");
}

#[test]
fn worst_places_that_look_alike_are_listed_once_and_by_size() {
    let reduced = pinned::reduced("siemens-840d");
    let ((program, motion), certificate) = (reduced.planned(), reduced.certificate());
    let mut certificate = certificate.clone();
    // All alike to the digits that are shown, but one; the deepest of them is that of vane 5.
    for s in &mut certificate.surfaces {
        let face = s.surface.contains("pressure face");
        let sector = f64::from(s.id.sector);
        s.gouge.depth = Mm(if face { 0.004_12 + 1e-9 * (4.0 - (sector - 4.0).abs()) } else { 0.0 });
        if face && s.id.sector == 2 {
            s.gouge.depth = Mm(0.007);
        }
        s.gouge_bound = Mm((s.gouge.depth.get() * 1e5).ceil() / 1e5);
        (s.excess.value, s.excess_bound, s.percentiles, s.not_reached) = (Mm(-1e-3), Mm(0.0), [Mm(0.0); 3], Mm2(0.0));
    }
    let html = report::report(&Input {
        program,
        motion,
        certificate: &certificate,
        samples: &[],
        deviations: &[],
        findings: &[],
        hash: "",
        post: "",
        nc_text: None,
        lines: &[],
        notes: &[],
        stock: &[],
    });
    let data = between(&html, "id=\"data\">", "</script>");
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let mut cuts: Vec<&serde_json::Value> =
        data["places"].as_array().unwrap().iter().filter(|p| p["group"] == "deepest cut into a surface").collect();
    assert_eq!(cuts.len(), 8, "each surface keeps a place of its own for its row of the table");
    cuts.retain(|p| p["listed"] != "");
    cuts.sort_by(|a, b| b["rank"].as_f64().unwrap().total_cmp(&a["rank"].as_f64().unwrap()));
    let listed: Vec<_> =
        cuts.iter().map(|p| [&p["listed"], &p["value"], &p["name"]].map(|v| v.as_str().unwrap())).collect();
    assert_eq!(
        listed,
        [
            ["vane 3 pressure face", "7.00 \u{b5}m", "vane 3 pressure face"],
            ["vanes 1-2, 4-8 pressure face", "4.12 \u{b5}m", "vane 5 pressure face"],
        ]
    );
    // The text of the certificate: the same, with the places of the worst.
    let text = details(program, motion, &certificate);
    let lines: Vec<&str> = text.lines().filter(|l| l.contains("pressure face") && l.contains('(')).collect();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].trim_start().starts_with("vane 3 pressure face "), "{lines:?}");
    assert!(lines[1].trim_start().starts_with("vanes 1-2, 4-8 pressure face "), "{lines:?}");
    let deepest = &certificate.surfaces.iter().find(|s| s.surface == "vane 5 pressure face").unwrap().gouge.point;
    assert!(lines[1].contains(&format!("({:.3}, {:.3}, {:.3})", deepest[0], deepest[1], deepest[2])), "{lines:?}");
    assert!(text.contains("no gouge over 7.00 um anywhere, deepest found 7.00 um on vane 3 pressure face"));
}

#[test]
fn texts_of_the_job_stay_texts() {
    let hostile = "</script><script>window.broken=1</script><img src=x onerror=window.broken=1>\"'`${1}\\<!--@json-->";
    let reduced = pinned::reduced("siemens-840d");
    let (program, motion) = reduced.planned();
    let (mut program, mut motion, mut certificate) = (program.clone(), motion.clone(), reduced.certificate().clone());
    let (samples, deviations) = report::deviations(&program, &certificate);
    let name = |text: &mut String| hostile.clone_into(text);
    let (mut operations, mut tools) = (PrimaryMap::new(), PrimaryMap::new());
    for (_, o) in program.operations.iter() {
        operations.push(Operation { name: hostile.to_owned(), ..o.clone() });
    }
    for (_, t) in program.tools.iter() {
        tools.push(Tool { name: hostile.to_owned(), ..t.clone() });
    }
    (program.operations, program.tools) = (operations, tools);
    motion.operations.iter_mut().flat_map(|o| &mut o.labels).for_each(name);
    certificate.operations.iter_mut().for_each(|o| {
        name(&mut o.name);
        name(&mut o.tool);
    });
    [&mut program.name, &mut program.machine.name, &mut certificate.name, &mut certificate.machine_name]
        .into_iter()
        .for_each(name);
    let finding = Diag::warning(verification::NOT_REACHED, hostile).place(hostile, Point3::origin()).help(hostile);
    let html = report::report(&Input {
        program: &program,
        motion: &motion,
        certificate: &certificate,
        samples: &samples,
        deviations: &deviations,
        findings: &[finding],
        hash: hostile,
        post: hostile,
        nc_text: None,
        lines: &[],
        notes: &[(hostile.to_owned(), hostile.to_owned())],
        stock: &[],
    });
    // Elements that begin, and handlers: only those of the page itself.
    assert!(!html.contains("<img") && !html.contains("<script>window"));
    let lower = html.to_lowercase();
    // One for the data, one for each array, one that is run.
    assert_eq!((lower.matches("<script").count(), lower.matches("</script").count()), (12, 12));

    let Some(browser) = browser::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hostile.html");
    std::fs::write(&file, &html).unwrap();
    let mut page = Page::open(&browser, &file, [1400, 1000], &folder.path().join("profile"));
    assert_eq!(page.evaluate("typeof window.broken"), "undefined");
    assert_eq!(page.evaluate("document.querySelector('h1').textContent"), hostile);
    assert_eq!(page.evaluate("document.querySelector('#operations label').textContent"), hostile);
    page.click("#places button");
    assert!(page.evaluate("document.getElementById('move').textContent").contains(hostile));
    assert_eq!(page.evaluate("typeof window.broken"), "undefined");
    assert!(page.complaints.is_empty(), "{:?}", page.complaints);
}
