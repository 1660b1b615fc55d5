//! The real program with bounded memory.

use std::process::Command;

/// Addresses that a run may take, kB: 2 GB, the memory of a plan by default.
const MOST: u32 = 2_000_000;

/// The program, whose arguments follow. Where the shell has no such limit the run goes without.
pub(crate) fn program() -> Command {
    let mut command = Command::new("bash");
    let script = format!("ulimit -v {MOST} 2> /dev/null; exec \"$0\" \"$@\"");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_impellerc")]);
    // Each thread takes addresses of its own.
    command.env("RAYON_NUM_THREADS", "2");
    command
}
