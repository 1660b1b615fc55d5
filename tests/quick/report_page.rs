//! What the reader of the report does, in a browser: colours, playback and NC text, section, measuring, touch, print.

use crate::report::{COMPILED, between, inflated};
use crate::support::browser::{self, Page, count};
use crate::support::pinned;
use impellerc::base::units::Sec;
use impellerc::verify::dynamics::MotionLimit;
use serde_json::Value;

/// The report of the reduced job in a window, with the folder of the browser.
fn open(size: [u32; 2]) -> Option<(Page, tempfile::TempDir)> {
    let program = browser::find()?;
    let folder = tempfile::tempdir().unwrap();
    let page = Page::open(&program, &COMPILED.report, size, &folder.path().join("profile"));
    Some((page, folder))
}

fn middle([left, top, width, height]: [usize; 4]) -> [usize; 2] {
    [left + width / 2, top + height / 2]
}

fn text(page: &mut Page, id: &str) -> String {
    page.evaluate(&format!("document.getElementById('{id}').textContent"))
}

/// Chooses a value of a list or enters it.
fn choose(page: &mut Page, id: &str, value: &str) {
    let change = "e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change'));";
    page.evaluate(&format!("{{ const e = document.getElementById('{id}'); e.value = '{value}'; {change} }}"));
    page.settle();
}

fn changed(a: &[[u8; 3]], b: &[[u8; 3]]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

#[test]
fn a_small_window_shows_verdict_part_and_worst_places() {
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    for selector in [".verdict", "#scene", "#places button", "#more", "#play", "#nc", "#scale"] {
        let [left, top, width, height] = page.place(selector);
        assert!(width > 10 && height > 10, "{selector} is {width} x {height}");
        assert!(left + width <= 1280 && top + height <= 720, "{selector} ends at {}, {}", left + width, top + height);
    }
    let [_, _, width, height] = page.place("#scene");
    assert!(width >= 600 && height >= 400, "the picture is {width} x {height}");
    assert_eq!(page.evaluate("document.documentElement.scrollWidth"), "1280");
    // The list is as long as the reader wants.
    let seen = "[...document.querySelectorAll('#places button')].filter(b => b.offsetHeight > 0).length";
    let all: usize = page.evaluate("document.querySelectorAll('#places button').length").parse().unwrap();
    let few: usize = page.evaluate(seen).parse().unwrap();
    assert!(few >= 4 && few < all, "{few} of {all} places");
    page.click("#more");
    assert_eq!(page.evaluate(seen), all.to_string());
}

#[test]
fn a_telephone_shows_the_page_without_scrolling_sideways() {
    let Some((mut page, _folder)) = open([390, 844]) else { return };
    // Wide tables scroll in frames of their own.
    let wide = "[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll') && e.getBoundingClientRect().right > \
                innerWidth && e.getBoundingClientRect().width > 0).map(e => e.tagName + ' ' + e.className).join()";
    assert_eq!(page.evaluate(wide), "", "of {} px", page.evaluate("document.documentElement.scrollWidth"));
}

#[test]
fn the_wheel_scrolls_the_page_until_the_picture_is_clicked() {
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    let scene = page.place("#scene");
    let scrolled = "Math.round(scrollY)";
    for selector in ["#scene", "#nc", "#places"] {
        let at = middle(page.place(selector));
        page.wheel(at, 60);
        assert_eq!(page.evaluate(scrolled), "60", "over {selector}");
        page.evaluate("scrollTo(0, 0)");
        page.settle();
    }
    assert!(text(&mut page, "hint").contains("click first, or hold Ctrl"));
    page.click("#scene");
    page.settle();
    assert!(text(&mut page, "hint").contains("wheel zooms"));
    let before = page.screenshot().part(scene);
    page.wheel(middle(scene), -300);
    assert_eq!(page.evaluate(scrolled), "0");
    let after = page.screenshot().part(scene);
    assert!(changed(&before, &after) * 20 > before.len(), "the wheel does not zoom");
    page.key("Escape");
    page.wheel(middle(scene), 60);
    assert_eq!(page.evaluate(scrolled), "60", "Esc gives the wheel back");
}

/// Red, green and blue in linear light.
fn linear(colour: [u8; 3]) -> [f64; 3] {
    colour.map(|v| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    })
}

/// CIE L*a*b* of a colour in linear light, white point D65.
fn lab(rgb: [f64; 3]) -> [f64; 3] {
    let rows = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    let white = [0.9505, 1.0, 1.089];
    let [x, y, z] = [0, 1, 2].map(|k| {
        let t = (0..3).map(|i| rows[k][i] * rgb[i]).sum::<f64>() / white[k];
        if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// What readers see who lack one kind of cones, in linear light (Machado, Oliveira and Fernandes 2009, severity 1).
const SIGHTS: [(&str, [[f64; 3]; 3]); 4] = [
    ("all cones", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]],
    ),
    (
        "deuteranopia",
        [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
    ),
    (
        "tritanopia",
        [[1.255_528, -0.076_749, -0.178_779], [-0.078_411, 0.930_809, 0.147_602], [0.004_733, 0.691_367, 0.303_900]],
    ),
];

/// Distance of two colours as a reader sees them, in units of CIE 1976.
fn distance(sight: &[[f64; 3]; 3], a: [u8; 3], b: [u8; 3]) -> f64 {
    let [a, b] = [a, b].map(|c| {
        let c = linear(c);
        lab([0, 1, 2].map(|k| (0..3).map(|i| sight[k][i] * c[i]).sum::<f64>().clamp(0.0, 1.0)))
    });
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[test]
fn readers_who_do_not_see_red_or_green_tell_gouge_from_excess() {
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    choose(&mut page, "low", "5");
    choose(&mut page, "high", "5");
    let bar = page.place("#scale");
    // A row of the bar above its text and its marks.
    let row = page.screenshot().part([bar[0], bar[1] + 1, bar[2], 1]);
    let at = |share: f64| row[(0.5 * (1.0 + share) * row.len() as f64) as usize];
    // The tolerance takes 48 % of each side.
    for share in [-0.46, -0.3, -0.1, 0.1, 0.3, 0.46] {
        assert_eq!(at(share), at(0.0), "not neutral at {share}");
    }
    let grey = at(0.0);
    assert!(grey.iter().max().unwrap() - grey.iter().min().unwrap() < 16, "{grey:?} is not neutral");
    for (sight, matrix) in &SIGHTS {
        for share in [0.52, 0.75, 0.98] {
            let apart = distance(matrix, at(-share), at(share));
            let seen = [-share, share].map(|s| distance(matrix, at(s), at(0.0)));
            println!("{sight}, at {share}: gouge to excess {apart:.0}, to neutral {:.0} and {:.0}", seen[0], seen[1]);
            assert!(apart > 25.0 && seen.iter().all(|d| *d > 20.0), "{sight}, {share}: {apart:.0} {seen:?}");
        }
    }
    // The picture has the colours of the bar.
    let scene = page.place("#scene");
    let coloured = |page: &mut Page, tolerance: &str| {
        choose(page, "low", tolerance);
        choose(page, "high", tolerance);
        let vivid = |p: &&[u8; 3]| p.iter().max().unwrap() - p.iter().min().unwrap() > 60;
        page.screenshot().part(scene).iter().filter(vivid).count()
    };
    let [tight, wide] = ["0.1", "100000"].map(|t| coloured(&mut page, t));
    assert!(
        tight > 2000 && wide * 20 < tight,
        "{tight} coloured pixels beyond a tight tolerance, {wide} in a wide one"
    );
}

/// The marked line of the NC text, its text, and whether it is in the window.
fn marked(page: &mut Page) -> (usize, String, bool) {
    let row = "document.querySelector('#nc [aria-selected=true]')";
    let line = page.evaluate(&format!("{row}?.dataset.line || '0'")).parse().unwrap();
    let text = page.evaluate(&format!("{row}?.textContent || ''"));
    let inside = page.evaluate(&format!(
        "(() => {{ const r = {row}?.getBoundingClientRect(), b = document.getElementById('nc').getBoundingClientRect(); \
         return !!r && r.top >= b.top && r.bottom <= b.bottom; }})()"
    ));
    (line, text, inside == "true")
}

#[test]
fn tool_and_nc_text_follow_each_other() {
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    let nc = std::fs::read_to_string(COMPILED.folder.path().join("part.nc")).unwrap();
    let lines: Vec<&str> = nc.lines().collect();
    let html = std::fs::read_to_string(&COMPILED.report).unwrap();
    assert!(inflated(&html, "nc-text") == nc.as_bytes(), "the text of the page is another one");
    let scene = page.place("#scene");
    let check = |page: &mut Page| {
        let (line, shown, inside) = marked(page);
        assert!(inside, "line {line} is not in the window");
        assert_eq!(shown, lines[line - 1]);
        let now = text(page, "now");
        assert!(now.ends_with(&format!("NC line {line}")), "line {line} is marked, the tool is at {now}");
        line
    };
    // Without a body the page draws faster.
    choose(&mut page, "body", "none");
    // Steps by block: every line once, and the same ones back.
    let mut seen = vec![check(&mut page)];
    for _ in 0..8 {
        page.key(".");
        seen.push(check(&mut page));
    }
    assert!(seen.is_sorted_by(|a, b| a < b), "{seen:?}");
    for expected in seen.iter().rev().skip(1) {
        page.key(",");
        assert_eq!(check(&mut page), *expected);
    }
    // The time goes to the block, a click on a block to its time.
    let time = page_half(&mut page);
    choose(&mut page, "time", &time);
    let half = check(&mut page);
    choose(&mut page, "body", "part");
    assert!(half > lines.len() / 10, "line {half} of {} at half the time", lines.len());
    let pose = page.screenshot().part(scene);
    page.click(&format!("#nc [data-line='{}']", half - 3));
    assert_eq!(check(&mut page), half - 3);
    page.key(",");
    assert!(check(&mut page) < half - 3);
    // A view that follows the tool moves with it.
    page.key("f");
    let before = page.screenshot().part(scene);
    assert!(changed(&pose, &before) * 10 > pose.len(), "the view does not go to the tool");
    for _ in 0..3 {
        page.key(".");
    }
    let after = page.screenshot().part(scene);
    assert!(changed(&before, &after) * 20 > before.len(), "the view does not follow");
    // Playback passes blocks without a key.
    let start = check(&mut page);
    page.key("p");
    std::thread::sleep(std::time::Duration::from_millis(600));
    page.key("p");
    page.settle();
    let end = check(&mut page);
    assert!(end > start, "from line {start} playback came to {end}");
    assert!(page.complaints.is_empty(), "{:?}", page.complaints);
}

fn page_half(page: &mut Page) -> String {
    page.evaluate("String(document.getElementById('time').max / 2)")
}

#[test]
fn the_stock_is_that_of_the_time() {
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    let scene = page.place("#scene");
    let hide = "if (document.getElementById('tool').checked) document.getElementById('tool').click()";
    let mut shown = |body: &str, share: f64| {
        choose(&mut page, "body", body);
        let time = page.evaluate(&format!("String({share} * document.getElementById('time').max)"));
        choose(&mut page, "time", &time);
        page.evaluate(hide);
        // The list and the note are over the picture and differ.
        page.evaluate("document.querySelectorAll('.tools, #stock-note').forEach(e => e.style.visibility = 'hidden')");
        page.settle();
        let picture = page.screenshot().part(scene);
        (picture, text(&mut page, "now"))
    };
    let (start, _) = shown("follow", 0.0);
    assert_eq!(changed(&start, &shown("blank", 0.0).0), 0, "the blank stands at the start");
    let (end, now) = shown("follow", 1.0);
    assert_eq!(changed(&end, &shown("3", 1.0).0), 0, "{now}");
    let (between, now) = shown("follow", 0.5);
    let operations = ["groove", "expand", "flank", "channel"];
    let running = operations.iter().position(|o| now.contains(o)).unwrap();
    let ended = if running == 0 { "blank".to_owned() } else { (running - 1).to_string() };
    assert_eq!(changed(&between, &shown(&ended, 0.5).0), 0, "{now}");
    assert!(changed(&between, &end) > 100 || running == 3, "{now}");
}

#[test]
fn a_section_opens_the_part_and_two_points_give_a_distance() {
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    let scene = page.place("#scene");
    // Stripes of cut material are the only green in the picture.
    let green = |p: &&[u8; 3]| p[1] > p[0].saturating_add(10) && p[1] > p[2].saturating_add(15);
    let opened = |page: &mut Page| page.screenshot().part(scene).iter().filter(green).count();
    page.click("[data-view=side]");
    assert!(opened(&mut page) < 50);
    choose(&mut page, "section", "x");
    let at_axis = opened(&mut page);
    assert!(at_axis > 5000, "{at_axis} pixels of cut material");
    // The bore is open: in the middle of the picture its wall is seen, not cut material.
    let [x, y] = middle(scene);
    let bore = page.screenshot().part([x - 5, y - 5, 10, 10]);
    assert_eq!(bore.iter().filter(green).count(), 0, "the bore is filled");
    choose(&mut page, "body", "blank");
    let blank = opened(&mut page);
    let bore = page.screenshot().part([x - 5, y - 5, 10, 10]);
    assert_eq!(bore.iter().filter(green).count(), 0, "the bore of the blank is filled");
    assert!(blank > at_axis, "{blank} pixels of cut blank, {at_axis} of the part");
    choose(&mut page, "body", "part");
    // Far from the axis the section is smaller.
    let far = page.evaluate("String(0.8 * document.getElementById('offset').max)");
    choose(&mut page, "offset", &far);
    let near_rim = opened(&mut page);
    assert!(near_rim * 2 < at_axis, "{near_rim} of {at_axis} pixels near the rim");
    choose(&mut page, "section", "");
    assert!(opened(&mut page) < 50);

    // From above: two places of the ring about the bore on opposite sides of the axis.
    let html = std::fs::read_to_string(&COMPILED.report).unwrap();
    let data: Value = serde_json::from_str(between(&html, "id=\"data\">", "</script>")).unwrap();
    let pairs = |v: &Value| -> Vec<[f64; 2]> { serde_json::from_value(v.clone()).unwrap() };
    let (blank, turned) = (pairs(&data["blank"]), pairs(&data["part"]["turned"][0]));
    let most = |k: usize| blank.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
    let least = blank.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let [bore, ring] = [turned[3], turned[4]];
    let (eye, target) = (3.9 * most(0).max(1.0), 0.85 * least + 0.15 * most(1));
    let size = 2.0 * (15_f64).to_radians().tan() * (eye + target - ring[1]) / scene[3] as f64;
    let pixels = (0.5 * (bore[0] + ring[0]) / size).round() as usize;
    page.click("[data-view=top]");
    page.key("m");
    let [x, y] = middle(scene);
    let (mut points, mut found) = ([[x - pixels, y], [x + pixels, y]], Vec::new());
    for _ in 0..2 {
        for [x, y] in points {
            page.mouse("mouseMoved", x, y);
            page.mouse("mousePressed", x, y);
            page.mouse("mouseReleased", x, y);
            page.settle();
        }
        let readout = text(&mut page, "readout");
        let figure =
            readout.strip_prefix("distance ").and_then(|r| r.split(' ').next()).unwrap_or_else(|| panic!("{readout}"));
        found.push(figure.parse::<f64>().unwrap());
        points.reverse();
    }
    let expected = 2.0 * pixels as f64 * size;
    assert!((found[0] - expected).abs() < 0.01 * expected, "{found:?} mm measured, {expected} mm expected");
    assert!((found[0] - found[1]).abs() < 0.002, "{found:?}: the way back is another one");
    page.key("Escape");
    assert_eq!(text(&mut page, "readout"), "");

    // What lies under the pointer has the number of its sector that tables and contracts have, from 1.
    let count = data["part"]["sectors"].as_u64().unwrap();
    let mut sectors = std::collections::BTreeSet::new();
    for (k, sign) in (1..8).flat_map(|k| [(k, 1), (k, -1)]) {
        let across = k * scene[3] / 16;
        page.mouse("mouseMoved", if sign > 0 { x + across } else { x - across }, y + across / 2);
        page.settle();
        let readout = text(&mut page, "readout");
        sectors
            .extend(readout.split_once(", sector ").and_then(|(_, rest)| rest.split(':').next()?.parse::<u64>().ok()));
    }
    assert!(sectors.len() > 1 && sectors.iter().all(|sector| (1..=count).contains(sector)), "{sectors:?} of {count}");
}

#[test]
fn one_finger_turns_and_two_zoom() {
    let Some((mut page, _folder)) = open([800, 900]) else { return };
    let scene = page.place("#scene");
    let [x, y] = middle(scene);
    let before = page.screenshot().part(scene);
    page.touch(&[vec![[x, y], [x + 20, y], [x + 70, y + 10]]]);
    let turned = page.screenshot().part(scene);
    assert!(changed(&before, &turned) * 20 > before.len(), "one finger does not turn");
    assert_eq!(page.evaluate("Math.round(scrollY)"), "0");
    let sheet = |p: &[[u8; 3]]| p.iter().filter(|c| c[2] > 215 && c[2] >= c[0]).count();
    page.touch(&[vec![[x - 20, y], [x - 50, y], [x - 90, y]], vec![[x + 20, y], [x + 50, y], [x + 90, y]]]);
    let near = page.screenshot().part(scene);
    assert!(sheet(&near) * 2 < sheet(&turned), "{} and {} pixels about the part", sheet(&turned), sheet(&near));
}

#[test]
fn print_leaves_out_the_controls_and_shows_all_places() {
    let Some((mut page, _folder)) = open([1100, 800]) else { return };
    page.as_printed();
    for selector in ["#nc", ".playback", ".tools", "#hint", "#theme", "#more"] {
        let shown = page.evaluate(&format!("document.querySelector('{selector}').offsetParent !== null"));
        assert_eq!(shown, "false", "{selector} is printed");
    }
    let hidden = "[...document.querySelectorAll('#places button')].filter(b => b.offsetHeight === 0).length";
    assert_eq!(page.evaluate(hidden), "0");
    let clipped =
        "[...document.querySelectorAll('.scroll, #places')].filter(e => e.scrollHeight > e.clientHeight + 2).length";
    assert_eq!(page.evaluate(clipped), "0");
    let [_, _, width, height] = page.place("#scene");
    assert!(width > 400 && height > 300);
}

/// The part is in the file before the script that draws it, everything else behind.
#[test]
fn the_part_is_drawn_before_the_rest_is_read() {
    let html = std::fs::read_to_string(&COMPILED.report).unwrap();
    let at = |id: &str| html.find(&format!("<script type=\"text/plain\" id=\"{id}\">")).unwrap();
    let script = html.find("'use strict';").unwrap();
    for id in ["positions", "normals", "deviations"] {
        assert!(at(id) < script, "{id}");
    }
    for id in ["joints", "kinds", "limiting", "stock-positions-0", "nc-text"] {
        assert!(at(id) > script, "{id}");
    }
    let Some((mut page, _folder)) = open([1280, 720]) else { return };
    let part: f64 = page.evaluate("document.documentElement.dataset.part").parse().unwrap();
    let whole: f64 = page.evaluate("performance.now()").parse().unwrap();
    println!("the part after {part} ms, all within {whole:.0} ms");
    assert!(part > 0.0 && part < whole);
}

/// Each move with a time has the limit that the certificate counts for it.
#[test]
fn every_move_has_the_limit_of_its_feed() {
    let reduced = pinned::reduced("siemens-840d");
    let ((_, motion), certificate) = (reduced.planned(), reduced.certificate());
    for (run, operation) in certificate.machine.runs.iter().zip(&motion.operations) {
        assert!(run.of_moves.is_sorted_by(|a, b| a.index < b.index));
        assert!(run.of_moves.len() + 2 >= operation.moves.iter().filter(|m| m.time > 0.0).count());
        let whole = run.time.into_iter().sum::<Sec>().get();
        let at_feed = run.limits.iter().filter(|l| l.limit == MotionLimit::Feed).flat_map(|l| l.time);
        let at_feed = at_feed.sum::<Sec>().get();
        let of_moves = run.of_moves.iter().filter(|m| run.limits[m.limit].limit == MotionLimit::Feed);
        let by_moves: f64 = of_moves.map(|m| operation.moves[m.index as usize].time).sum();
        assert!((by_moves - at_feed).abs() < 0.2 * whole, "{by_moves} s at feed by moves, {at_feed} s of {whole} s");
    }
    let html = std::fs::read_to_string(&COMPILED.report).unwrap();
    let data: Value = serde_json::from_str(between(&html, "id=\"data\">", "</script>")).unwrap();
    let names = data["paths"]["limits"].as_array().unwrap();
    let limiting = inflated(&html, "limiting");
    assert_eq!(limiting.len() as u64, data["paths"]["kept"].as_u64().unwrap());
    let known = limiting.iter().filter(|l| usize::from(**l) < names.len()).count();
    assert!(known * 10 > limiting.len() * 9, "{known} of {} moves", limiting.len());
    assert_eq!(data["limit_colours"].as_array().unwrap().len(), names.len());

    let Some((mut page, _folder)) = open([1280, 2200]) else { return };
    let plots = page.place("#plots");
    let drawn = page.screenshot().part(plots);
    assert!(count(&drawn, [0xe9, 0xc4, 0x6a]) > 2000, "the process feed is not drawn");
}
