//! SARIF for comments of a review and JUnit for build servers: both are well formed and name the right lines, for both
//! commands.

use serde_json::Value;
use std::path::Path;
use std::process::Command;

const JOB: &str = "jobs/small/small.imp";

/// Runs and gives the report, with whether the run succeeded.
fn report(arguments: &[&str], format: &str) -> (bool, String) {
    let run = Command::new(env!("CARGO_BIN_EXE_impellerc"))
        .args(arguments)
        .args(["--error-format", format])
        .output()
        .unwrap();
    (run.status.success(), String::from_utf8(run.stderr).unwrap())
}

/// Names of the properties of an object, all of which the schema must know.
fn only(value: &Value, known: &[&str]) {
    for name in value.as_object().unwrap_or_else(|| panic!("no object: {value}")).keys() {
        assert!(known.contains(&name.as_str()), "the schema has no {name} in {value}");
    }
}

fn text(value: &Value) -> &str {
    value.as_str().filter(|t| !t.is_empty()).unwrap_or_else(|| panic!("no text: {value}"))
}

/// A `region`: 3.30 of the standard.
fn check_region(region: &Value) {
    only(region, &["startLine", "startColumn", "endLine", "endColumn"]);
    let number = |key: &str| region[key].as_u64().unwrap_or_else(|| panic!("no {key} in {region}"));
    let (start, end) = ((number("startLine"), number("startColumn")), (number("endLine"), number("endColumn")));
    assert!(start.0 >= 1 && start.1 >= 1 && start <= end, "{region}");
}

/// An `artifactLocation`: 3.4; its `uri` is a reference of RFC 3986, a relative one where the user gave one.
fn check_artifact(location: &Value) {
    only(location, &["uri"]);
    let uri = text(&location["uri"]);
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-._~:/?#[]@!$&'()*+,;=%".contains(c);
    assert!(uri.chars().all(allowed), "{uri}");
    for (i, _) in uri.match_indices('%') {
        assert!(uri[i + 1..].len() >= 2 && uri[i + 1..i + 3].chars().all(|c| c.is_ascii_hexdigit()), "{uri}");
    }
    assert!(uri.starts_with("file:///") || !uri.starts_with('/') && !uri.contains(':'), "{uri}");
}

/// The results of a SARIF log, after all of it was held against what sarif-schema-2.1.0.json requires and knows.
fn results(text_of_log: &str) -> (Value, Vec<Value>) {
    let log: Value = serde_json::from_str(text_of_log).unwrap_or_else(|e| panic!("{e}: {text_of_log}"));
    only(&log, &["$schema", "version", "runs"]);
    assert_eq!(log["version"], "2.1.0");
    assert!(log["$schema"].as_str().unwrap().contains("sarif-2.1.0"));
    let runs = log["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 1);
    only(&runs[0], &["tool", "results", "invocations", "columnKind"]);
    assert!(["utf16CodeUnits", "unicodeCodePoints"].contains(&runs[0]["columnKind"].as_str().unwrap()));
    for invocation in runs[0]["invocations"].as_array().unwrap() {
        assert!(invocation["executionSuccessful"].is_boolean(), "required by 3.20.14");
    }
    only(&runs[0]["tool"], &["driver"]);
    let driver = &runs[0]["tool"]["driver"];
    only(driver, &["name", "semanticVersion", "informationUri", "rules"]);
    assert_eq!(driver["name"], "impellerc");
    let rules = driver["rules"].as_array().unwrap();
    for (i, rule) in rules.iter().enumerate() {
        only(rule, &["id", "shortDescription", "help", "helpUri"]);
        assert!(rules[..i].iter().all(|r| r["id"] != rule["id"]), "rules are unique: {rule}");
        for message in ["shortDescription", "help"] {
            only(&rule[message], &["text", "markdown"]);
            text(&rule[message]["text"]);
        }
    }
    let results = runs[0]["results"].as_array().unwrap().clone();
    for result in &results {
        let known = ["ruleId", "ruleIndex", "level", "message", "locations", "relatedLocations", "fixes", "properties"];
        only(result, &known);
        let index = usize::try_from(result["ruleIndex"].as_u64().unwrap()).unwrap();
        assert_eq!(rules[index]["id"], result["ruleId"], "a rule belongs to its result");
        assert!(["note", "warning", "error"].contains(&result["level"].as_str().unwrap()));
        only(&result["message"], &["text"]);
        text(&result["message"]["text"]);
        let related = result["relatedLocations"].as_array();
        for location in result["locations"].as_array().unwrap().iter().chain(related.into_iter().flatten()) {
            only(location, &["id", "physicalLocation", "message"]);
            text(&location["message"]["text"]);
            only(&location["physicalLocation"], &["artifactLocation", "region"]);
            check_artifact(&location["physicalLocation"]["artifactLocation"]);
            check_region(&location["physicalLocation"]["region"]);
        }
        for change in
            result["fixes"].as_array().into_iter().flatten().flat_map(|f| f["artifactChanges"].as_array().unwrap())
        {
            only(change, &["artifactLocation", "replacements"]);
            check_artifact(&change["artifactLocation"]);
            for replacement in change["replacements"].as_array().unwrap() {
                only(replacement, &["deletedRegion", "insertedContent"]);
                check_region(&replacement["deletedRegion"]);
                assert!(replacement["insertedContent"]["text"].is_string());
            }
        }
    }
    (runs[0].clone(), results)
}

/// File and line of a SARIF result.
fn location(result: &Value) -> (String, u64) {
    let place = &result["locations"][0]["physicalLocation"];
    (place["artifactLocation"]["uri"].as_str().unwrap().to_owned(), place["region"]["startLine"].as_u64().unwrap())
}

fn line_of(text: &str, words: &str) -> u64 {
    text.lines().position(|l| l.contains(words)).unwrap_or_else(|| panic!("no {words}")) as u64 + 1
}

struct Case {
    class: String,
    name: String,
    place: Option<(String, u64)>,
    failure: Option<String>,
}

/// The cases of a JUnit report, after its counts were compared with them.
fn cases(text: &str) -> Vec<Case> {
    let document = roxmltree::Document::parse(text).unwrap_or_else(|e| panic!("{e}: {text}"));
    let root = document.root_element();
    assert_eq!(root.tag_name().name(), "testsuites");
    let suites: Vec<_> = root.children().filter(roxmltree::Node::is_element).collect();
    assert!(suites.len() == 1 && suites[0].tag_name().name() == "testsuite");
    let found: Vec<Case> = suites[0]
        .children()
        .filter(|n| n.has_tag_name("testcase"))
        .map(|n| Case {
            class: n.attribute("classname").unwrap().to_owned(),
            name: n.attribute("name").unwrap().to_owned(),
            place: n.attribute("file").map(|f| (f.to_owned(), n.attribute("line").unwrap().parse().unwrap())),
            failure: n
                .children()
                .find(|c| c.has_tag_name("failure"))
                .map(|f| format!("{}\n{}", f.attribute("message").unwrap(), f.text().unwrap_or_default())),
        })
        .collect();
    let failures = found.iter().filter(|c| c.failure.is_some()).count();
    for node in [root, suites[0]] {
        assert_eq!(node.attribute("tests").unwrap(), found.len().to_string());
        assert_eq!(node.attribute("failures").unwrap(), failures.to_string());
    }
    found
}

/// Every example of a code of the job language, in both forms: the same diagnostics at the same lines as in JSON.
#[test]
fn faulty_jobs_in_all_formats() {
    let mut checked = 0;
    for entry in std::fs::read_dir("jobs/_errors").unwrap() {
        let path = entry.unwrap().path();
        let job = path.to_str().unwrap();
        // Those that are only remarked would be planned.
        if path.extension().is_none_or(|e| e != "imp") || checked >= 12 && !job.contains("quote") {
            continue;
        }
        let arguments = [job, "--emit", "ir"];
        let (ok, json) = report(&arguments, "json");
        let all: Vec<Value> = json.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        let (sarif_ok, sarif) = report(&arguments, "sarif");
        let (run, found) = results(&sarif);
        assert_eq!((sarif_ok, run["invocations"][0]["executionSuccessful"].as_bool()), (ok, Some(ok)));
        assert_eq!(found.len(), all.len());
        for (diag, result) in all.iter().zip(&found) {
            assert_eq!(diag["code"], result["ruleId"]);
            if let Some(label) = diag["labels"].get(0) {
                assert_eq!(
                    location(result),
                    (label["file"].as_str().unwrap().to_owned(), label["line"].as_u64().unwrap())
                );
                let column = &result["locations"][0]["physicalLocation"]["region"]["startColumn"];
                assert_eq!(column, &label["column"]);
            }
            assert_eq!(result.get("fixes").is_some(), !diag["fix"].is_null());
            if let Some(fix) = result["fixes"].get(0) {
                let change = &fix["artifactChanges"][0]["replacements"][0]["insertedContent"]["text"];
                assert_eq!(change, &diag["fix"]["replacement"]);
            }
        }
        let (junit_ok, junit) = report(&arguments, "junit");
        let cases = cases(&junit);
        assert_eq!(junit_ok, ok);
        let errors: Vec<&Value> = all.iter().filter(|d| d["severity"] == "error").collect();
        let failed: Vec<&Case> = cases.iter().filter(|c| c.failure.is_some()).collect();
        assert_eq!(failed.len(), errors.len());
        for (diag, case) in errors.iter().zip(&failed) {
            assert_eq!(case.class, diag["code"].as_str().unwrap());
            let failure = case.failure.as_ref().unwrap();
            // Newlines of an attribute become blanks in XML.
            let message = diag["message"].as_str().unwrap();
            assert!(failure.contains(&message.replace('\n', " ")), "{failure} {message}");
            if let Some(label) = diag["labels"].get(0) {
                let place = (label["file"].as_str().unwrap().to_owned(), label["line"].as_u64().unwrap());
                assert_eq!(case.place.as_ref(), Some(&place));
                assert!(failure.contains(&format!("{}:{}:", place.0, place.1)), "{failure}");
            }
        }
        checked += 1;
    }
    assert!(checked >= 12, "{checked}");
}

const PROGRAM: &str = "\
N10 G17 G710 G90 G94 G40
N20 TRAFOOF
N30 TRANS
N40 G500
N50 SUPA G0 Z650 D0
N60 T=\"t1\" M6
N70 S4500 M3
N80 SUPA G0 A=30 C=20 D0
N90 SUPA G0 X40 Y-10 D0
N100 G54 D1
N110 CYCLE832(0.2,_ORI_ROUGH,0.1)
N120 TRAORI
N130 G54 ORIWKS ORIAXES M8
N140 G0 X50 Y-40 Z10 A=30 C=20
N150 G1 X<3 Y-17 Z4 A=30 C=20 F150
N160 G33 X5
N170 G0 X50 Y-40 Z10 A=30 C=20
N180 TRAFOOF
N190 SUPA G0 Z650 D0 M9
N200 M5
N210 M30
";

#[test]
fn faulty_nc_text_in_both_formats() {
    let folder = tempfile::tempdir().unwrap();
    let nc = folder.path().join("a part & <more>.nc");
    std::fs::write(&nc, PROGRAM).unwrap();
    let shown = nc.to_str().unwrap();
    let arguments = ["verify", shown, "--job", JOB];
    let (ok, sarif) = report(&arguments, "sarif");
    assert!(!ok);
    let (_, all) = results(&sarif);
    let found: Vec<(String, u64)> = all.iter().filter(|r| r["ruleId"] == "IMP0821").map(location).collect();
    let uri =
        format!("file://{}", shown.replace(' ', "%20").replace('&', "%26").replace('<', "%3C").replace('>', "%3E"));
    assert_eq!(found, [(uri.clone(), line_of(PROGRAM, "N150")), (uri, line_of(PROGRAM, "N160"))]);
    let (ok, junit) = report(&arguments, "junit");
    assert!(!ok);
    let failed: Vec<Case> = cases(&junit).into_iter().filter(|c| c.failure.is_some()).collect();
    let places: Vec<_> = failed.iter().map(|c| c.place.clone().unwrap()).collect();
    assert_eq!(places, [(shown.to_owned(), 15), (shown.to_owned(), 16)]);
    assert!(failed[0].failure.as_ref().unwrap().contains("`<3` is not a number"), "{:?}", failed[0].failure);
}

/// A run without errors and one with a failed contract: the contract's line in the job is commented.
#[test]
fn a_run_that_holds_and_one_that_fails() {
    let (ok, junit) = report(&[JOB, "--stock-cell", "1"], "junit");
    assert!(ok, "{junit}");
    let held = cases(&junit);
    assert!(held.iter().all(|c| c.failure.is_none()));
    assert!(held.iter().any(|c| c.class == "contract" && c.name.contains("clearance")), "{junit}");
    assert!(held.iter().any(|c| c.name == "no errors"));
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("small.imp");
    // Less than the faces are cut into, more than the edges are.
    let text =
        std::fs::read_to_string(JOB).unwrap().replacen("require gouge     <= 2 um", "require gouge <= 0.9 um", 1);
    std::fs::write(&job, &text).unwrap();
    std::fs::copy(Path::new(JOB).with_file_name("vane_curves.csv"), folder.path().join("vane_curves.csv")).unwrap();
    let (ok, sarif) = report(&[job.to_str().unwrap(), "--stock-cell", "1"], "sarif");
    assert!(!ok);
    let (_, all) = results(&sarif);
    let failed: Vec<&Value> = all.iter().filter(|r| r["level"] == "error").collect();
    assert_eq!(failed.len(), 1, "{sarif}");
    assert_eq!(failed[0]["ruleId"], "IMP0702");
    assert_eq!(location(failed[0]).1, line_of(&text, "require gouge"));
    let operation = &failed[0]["relatedLocations"][0];
    assert_eq!(operation["physicalLocation"]["region"]["startLine"], line_of(&text, "operation flank"), "{operation}");
    assert!(failed[0]["properties"]["place"]["point"].as_array().unwrap().len() == 3);

    // The failed run lists the contract that holds too, under the name that it has when all hold.
    let (_, junit) = report(&[job.to_str().unwrap(), "--stock-cell", "1"], "junit");
    let judged = cases(&junit);
    let names: Vec<&str> = judged.iter().filter(|c| c.class == "contract").map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["gouge <= 0.90 um", "clearance >= 0.500 mm"]);
    assert!(held.iter().any(|c| c.name == names[1]));
    assert!(judged[1].failure.is_none() && judged[1].place.as_ref().unwrap().1 == line_of(&text, "require clearance"));
    assert!(judged[0].failure.as_ref().unwrap().contains("deep into"), "{junit}");
    assert_eq!(judged[0].place.as_ref().unwrap().1, line_of(&text, "require gouge"));
    assert_eq!(judged.len(), 2, "the failed contract is no second case: {junit}");
}

/// A finding in a file beside the job is placed where a reviewer has that file.
#[test]
fn files_beside_the_job_have_their_paths() {
    let (_, sarif) = report(&["jobs/small/small.imp", "--emit", "cc"], "sarif");
    let (_, all) = results(&sarif);
    let files: Vec<String> =
        all.iter().filter(|r| !r["locations"].as_array().unwrap().is_empty()).map(|r| location(r).0).collect();
    assert!(files.iter().any(|f| f == "jobs/small/vane_curves.csv"), "{files:?}");
    assert!(files.iter().all(|f| Path::new(f).is_file()), "{files:?}");
}
