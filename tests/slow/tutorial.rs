//! What a new user does: every command of `docs/tutorial.md` runs, in its order, with the texts of the page, and the job of the first page
//! compiles.

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
        // No finishing tool cuts a slot deeper than its diameter: both channels beside the vane are open.
        for (before, _) in said.match_indices(" % of the diameter").map(|(at, _)| said.split_at(at)) {
            let share: f64 = before.rsplit(' ').next().unwrap().parse().unwrap();
            assert!(share <= 100.0, "{command}: {share} %");
        }
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

/// The job of the first page compiles as it is pasted, and is refused with the change that the page describes.
#[test]
fn the_job_of_the_first_page_compiles() {
    let page = include_str!("../../README.md");
    let job = page.split("```\n").find(|block| block.starts_with("edition 2026")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let compiled = |job: &str, output: &str| {
        std::fs::write(folder.path().join("blade.imp"), job).unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_impellerc"))
            .current_dir(folder.path())
            .args(["blade.imp", "-o", output])
            .output()
            .unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    let (code, said) = compiled(job, "blade.nc");
    assert_eq!(code, Some(0), "{said}");
    assert!(folder.path().join("blade.nc").exists());
    assert!(page.contains("change `excess` to `<= 40 um`") && job.contains("excess    <= 60 um"));
    let (code, said) = compiled(&job.replace("excess    <= 60 um", "excess    <= 40 um"), "refused.nc");
    // The scallop of 50 um tells it before any plan.
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("IMP0451") && said.contains("help:"), "{said}");
    assert!(!folder.path().join("refused.nc").exists());
}
