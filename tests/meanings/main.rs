//! The campaign of meanings: changes in the words of a program, each with the expected result and the reason by the
//! manual of the control. The reader refuses harmful kinds, or the verifier finds them; harmless kinds mean the same
//! motion. Forged and stale certificates are told in the same way.
//!
//! Each case is a test with the name `file::class::change`; `cases.rs` says how a row is written.
//!
//!     cargo test --test meanings                                  # all, a dot each
//!     cargo test --test meanings -- siemens-840d::head            # those whose name has this
//!     cargo test --test meanings -- --nocapture                   # with the counts by class
//!     MEANINGS_LIST=1 cargo test --test meanings -- fanuc::tape   # with what was said of each

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "counts and reasons are shown where someone wants them")]
#![allow(unreachable_pub, reason = "modules of one test")]

#[path = "../support/mod.rs"]
mod support;

mod apt_cl;
mod cases;
mod certificates;
mod changes;
mod fanuc;
mod heidenhain;
mod judging;
mod linuxcnc;
mod machines_and_jobs;
mod rows;
mod siemens;
mod tally;

use cases::{Case, Cases};
use changes::Dialect;
use judging::{Unchanged, Verdict};
use libtest_mimic::{Arguments, Failed, Trial};
use std::sync::OnceLock;

/// The changes by functions of a dialect.
fn dialect(post: &str) -> &'static Dialect {
    match post {
        "siemens-840d" => &siemens::DIALECT,
        "heidenhain" => &heidenhain::DIALECT,
        "fanuc" | "mitsubishi" => &fanuc::DIALECT,
        "linuxcnc" => &linuxcnc::DIALECT,
        "apt-cl" => &apt_cl::DIALECT,
        other => panic!("{other} has no changes by functions: write them as those of the others"),
    }
}

/// The cases of a file, and the text that they change.
struct Campaign {
    name: String,
    cases: Cases,
    unchanged: OnceLock<Unchanged>,
}

impl Campaign {
    fn unchanged(&self) -> &Unchanged {
        self.unchanged.get_or_init(|| Unchanged::new(&self.cases.post, self.cases.orientation))
    }

    fn run(&self, class: &str, case: &Case) -> Result<(), Failed> {
        let (found, said) = self.unchanged().changed(&case.change, dialect(&self.cases.post))?;
        tally::count(&self.name, class, found);
        if found != case.due {
            return Err(format!("{found:?}, due {:?} ({}): {said}", case.due, case.why).into());
        }
        tally::list(|| format!("{class}: {}: {found:?}, {}\n    {said}", case.change.shown(), case.why));
        Ok(())
    }

    /// The tests of the file: its cases, the text without a change, and the file itself.
    fn trials(&'static self) -> Vec<Trial> {
        let mut trials: Vec<Trial> = self
            .cases
            .all()
            .map(|(class, case)| {
                let name = format!("{}::{class}::{}", self.name, case.change.shown());
                Trial::test(name, move || self.run(class, case))
            })
            .collect();
        let of_file = |what: &str| format!("{}::file::{what}", self.name);
        trials.push(Trial::test(of_file("no case is missing, and none stands twice"), || {
            self.cases.fault().map_or(Ok(()), |fault| Err(fault.into()))
        }));
        trials.push(Trial::test(of_file("the text without a change is harmless"), || match self.unchanged().whole() {
            (Verdict::Harmless, _) => Ok(()),
            (verdict, said) => Err(format!("{verdict:?}: {said}").into()),
        }));
        // What is found is found for its change.
        if self.cases.all().any(|(_, case)| case.due == Verdict::Found) {
            trials.push(Trial::test(of_file("nothing is found in the text without a change"), || {
                let findings = self.unchanged().findings();
                if findings.is_empty() { Ok(()) } else { Err(findings.join("\n").into()) }
            }));
        }
        trials
    }
}

/// The tests of a file of cases; a test that fails where it cannot be read.
fn campaign(name: String, cases: Result<Cases, String>) -> Vec<Trial> {
    match cases {
        Ok(cases) => Box::leak(Box::new(Campaign { name, cases, unchanged: OnceLock::new() })).trials(),
        Err(fault) => vec![Trial::test(format!("{name}::file::is read"), || Err(fault.into()))],
    }
}

fn main() {
    let mut arguments = Arguments::from_args();
    // All of them are more lines than anybody reads.
    arguments.quiet |= arguments.filter.is_none() && arguments.format.is_none() && !arguments.list;
    let files: Vec<_> = cases::files().into_iter().map(|(name, path)| (name, cases::parsed::<Cases>(&path))).collect();
    let mut trials = rows::trials(&files);
    trials.extend(files.into_iter().flat_map(|(name, cases)| campaign(name, cases)));
    trials.extend(certificates::trials());
    let conclusion = libtest_mimic::run(&arguments, trials);
    if arguments.nocapture {
        tally::print();
    }
    conclusion.exit();
}
