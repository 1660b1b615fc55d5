//! The real program with bounded memory.

use std::process::Command;

/// Address space of a run, kB: 2 GB, the default memory of a plan.
const MOST: u32 = 2_000_000;

/// The program; the caller adds its arguments. Where the shell has no such limit, the run has none.
pub(crate) fn program() -> Command {
    let mut command = Command::new("bash");
    let script = format!("ulimit -v {MOST} 2> /dev/null; exec \"$0\" \"$@\"");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_impellerc")]);
    // Each thread takes address space of its own.
    command.env("RAYON_NUM_THREADS", "2");
    command
}
