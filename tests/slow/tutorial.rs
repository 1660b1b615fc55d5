//! `docs/tutorial.md`: every command of the page runs, in its order, with the texts of the page.

use std::process::Command;

const PAGE: &str = include_str!("../../docs/tutorial.md");

/// The text of the block with a label.
fn block(label: &str) -> &'static str {
    let (_, behind) = PAGE.split_once(&format!("```imp {label}\n")).unwrap_or_else(|| panic!("no block {label}"));
    behind.split_once("```").unwrap().0
}

/// The job of the import with the texts of the page at the places that the page names.
fn edited(job: &str) -> String {
    let with = |text: &str, line: &str, label: &str| {
        let at = text.lines().find(|l| l.trim_start().starts_with(line)).unwrap_or_else(|| panic!("no line {line}"));
        text.replacen(&format!("{at}\n"), &format!("{at}\n{}", block(label)), 1)
    };
    let job = with(job, "edition 2026", "machine");
    let job = with(&job, "pressure ", "fillet");
    format!("{job}\n{}", block("operations"))
}

#[test]
fn the_tutorial_gives_verified_nc() {
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir("jobs/sections").unwrap() {
        let path = file.unwrap().path();
        std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let commands: Vec<&str> = PAGE.lines().filter_map(|line| line.strip_prefix("    impellerc ")).collect();
    assert_eq!(commands.len(), 4, "{commands:?}");
    for command in commands {
        let run = Command::new(env!("CARGO_BIN_EXE_impellerc"))
            .current_dir(folder.path())
            .args(command.split_whitespace())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned() + &String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success(), "{command}: {said}");
        if command.starts_with("import") {
            assert!(said.contains("9 main blades") && said.contains("11 sections"), "{said}");
            let job = folder.path().join("wheel.imp");
            std::fs::write(&job, edited(&std::fs::read_to_string(&job).unwrap())).unwrap();
        }
    }
    let made = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(
        made("wheel.nc").contains("TRAORI") && made("sheet.html").contains("<html") && made("wheel.html").len() > 1000
    );
}
