//! What every pass looks at: the program, the obstacles, the coordinates of the channel, and limits of size.

mod channel_chart;
mod lean;
pub(crate) mod limits;
mod obstacles;

pub(crate) use channel_chart::ChannelChart;
pub(crate) use lean::Lean;
pub use obstacles::Obstacles;
pub(crate) use obstacles::{Ends, Keep};

use crate::analysis::cost::Stations;
use crate::diag::{Aborted, Diag, Sink, codes::files};
use crate::ir::Program;
use crate::ir::validate::Malformed;
use crate::progress::Progress;

/// Stations along a face: a dense set that `sample-to-tolerance` thins. At 400 a station lies about 0.15 mm from the
/// next, so that the chord between two is below 0.1 um for the radii of a vane.
pub(crate) const STATIONS: usize = 400;

/// What a pass may look at, and where it reports.
pub(crate) struct PassContext<'a> {
    pub(crate) program: &'a Program,
    pub(crate) obstacles: &'a Obstacles,
    pub(crate) progress: &'a Progress,
    pub(crate) sink: &'a mut Sink,
    /// Stations that are planned so far.
    pub(crate) stations: Stations,
}

impl PassContext<'_> {
    /// Ends a run that was cancelled. Nobody waits for a reason: nothing goes to the sink.
    pub(crate) fn go_on(&self) -> Result<(), Aborted> {
        if self.progress.is_cancelled() { Err(Aborted) } else { Ok(()) }
    }

    /// Refuses to go on from a malformed value: asked after every pass in debug builds, and so in tests. Ends a run that was
    /// cancelled.
    pub(crate) fn holds(
        &mut self,
        pass: &str,
        validate: impl FnOnce(&Program) -> Result<(), Malformed>,
    ) -> Result<(), Aborted> {
        self.go_on()?;
        if !cfg!(debug_assertions) {
            return Ok(());
        }
        validate(self.program).map_err(|malformed| {
            self.sink.push(
                Diag::error(files::INTERNAL, format!("`{pass}` made a malformed value: {malformed}"))
                    .note("this is a fault of the compiler, not of the job")
                    .help("report the job file"),
            );
            Aborted
        })
    }
}
