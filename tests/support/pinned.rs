//! Programs and motions that are pinned as stage files in `golden/stages`, for tests of what stands behind the planner: they
//! begin at the stage that they test, and a change of the planner is not theirs. `pinned_values_are_those_of_today` plans each
//! of them anew and compares it by bytes, so that none becomes old.

use super::jobs::{self, Dialects, Planned};
use impellerc::base::progress::Progress;
use impellerc::base::source::{SourceFile, SourceMap};
use impellerc::diagnostics::Sink;
use impellerc::driver::Options;
use impellerc::ir::stage_file::{self, PlannedMotion, StageFile, StageValue};
use impellerc::ir::{Motion, Program};
use impellerc::plan::passes::pipeline::{self, Plan};
use impellerc::verify::stock::Settings;
use impellerc::verify::{Certificate, Verified, examine};
use std::path::PathBuf;
use std::sync::{LazyLock, OnceLock};

/// A program and its motion as they are pinned; the proof is made on first use.
pub struct Pinned {
    pub program: Program,
    pub motion: Motion,
    proof: OnceLock<(Verified<Motion>, Certificate)>,
}

impl Pinned {
    fn read(name: &str) -> Self {
        let text = std::fs::read_to_string(path(name)).unwrap();
        let StageFile { program, value: StageValue::Motion(PlannedMotion { motion, .. }), .. } =
            stage_file::read(&text).unwrap_or_else(|fault| panic!("{name}: {fault:?}"))
        else {
            panic!("{name} is no motion");
        };
        Self { program, motion, proof: OnceLock::new() }
    }

    fn proof(&self) -> &(Verified<Motion>, Certificate) {
        self.proof.get_or_init(|| jobs::proved(&self.program, &self.motion))
    }

    /// The motion as the verifier hands it out.
    pub fn verified(&self) -> &Verified<Motion> {
        &self.proof().0
    }

    /// The certificate.
    pub fn certificate(&self) -> &Certificate {
        &self.proof().1
    }

    /// The program and its motion.
    pub fn planned(&self) -> (&Program, &Motion) {
        (&self.program, &self.motion)
    }
}

/// The small job.
pub fn small(dialect: &str) -> &'static Pinned {
    static SMALL: Dialects<Pinned> =
        Dialects([LazyLock::new(|| Pinned::read("small")), LazyLock::new(|| Pinned::read("small-linuxcnc"))]);
    SMALL.on(dialect)
}

/// The small job made short, see [`jobs::SHORTER`].
pub fn short(dialect: &str) -> &'static Pinned {
    static SHORT: Dialects<Pinned> =
        Dialects([LazyLock::new(|| Pinned::read("short")), LazyLock::new(|| Pinned::read("short-linuxcnc"))]);
    SHORT.on(dialect)
}

/// The reduced job.
pub fn reduced(dialect: &str) -> &'static Pinned {
    static REDUCED: Dialects<Pinned> =
        Dialects([LazyLock::new(|| Pinned::read("reduced")), LazyLock::new(|| Pinned::read("reduced-linuxcnc"))]);
    REDUCED.on(dialect)
}

/// Both faces of one vane of the paper's part, and nothing else.
pub fn flank() -> &'static Pinned {
    static FLANK: LazyLock<Pinned> = LazyLock::new(|| Pinned::read("flank"));
    &FLANK
}

/// Where a value is pinned.
pub fn path(name: &str) -> PathBuf {
    PathBuf::from(format!("golden/stages/{name}.json"))
}

/// Names of all pinned values.
pub const NAMES: [&str; 7] =
    ["small", "small-linuxcnc", "short", "short-linuxcnc", "reduced", "reduced-linuxcnc", "flank"];

/// The stage file of a value as the compiler of today plans it.
pub fn planned_today(name: &str) -> String {
    let (job, dialect) = name.split_once('-').unwrap_or((name, "siemens-840d"));
    let machine = jobs::machine_of(dialect);
    match job {
        "flank" => {
            let mut sources = SourceMap::default();
            // Of its places only those of the post file are somewhere.
            let post = "jobs/_lib/posts/siemens-840d.toml";
            _ = sources.add_file(SourceFile::text(post, std::fs::read_to_string(post).unwrap()));
            let Planned { program, plan } = jobs::planned_flank();
            stage_text(&sources, program, plan)
        }
        "short" => {
            let folder = jobs::small_with(&jobs::SHORTER);
            let mut options = Options { job: folder.path().join("small.imp"), ..Options::default() };
            options.run.machine = machine.map(str::to_owned);
            let (sources, program) = jobs::front(&options);
            let plan = pipeline::run(&program, &mut Sink::default()).unwrap_or_else(|_| panic!("no plan of {name}"));
            // In coarse cells of the stock, as the tests judge it that change its text.
            let (mut settings, mut sink) = (Settings { cell: Some(4.0), ..Settings::default() }, Sink::default());
            let examined = examine(&program, plan.motion.clone(), &mut settings, &Progress::default(), &mut sink);
            assert!(examined.is_ok_and(|(judged, _)| judged.is_ok()), "{name}: {:#?}", sink.diags());
            stage_text(&sources, &program, &plan)
        }
        _ => {
            let Planned { program, plan } = jobs::planned(job, dialect);
            stage_text(&jobs::front(&jobs::options(job, machine)).0, program, plan)
        }
    }
}

fn stage_text(sources: &SourceMap, program: &Program, plan: &Plan) -> String {
    let motion = PlannedMotion::new(&plan.cl, plan.motion.clone());
    stage_file::write(sources, program, &StageValue::Motion(motion)).unwrap()
}
