//! What every pass reads: the program, the obstacles, the coordinates of the channel, the size of a ball, and changes of a
//! tool for messages.

mod channel_chart;
pub(crate) mod largest_ball;
mod maximal_ranges;
mod milling_direction;
mod obstacles;
mod remedy;
mod tilt;

pub(crate) use channel_chart::{ChannelChart, Crossing, MIN_OUTWARD};
pub(crate) use maximal_ranges::maximal_ranges;
pub(crate) use milling_direction::{from_outlet, leads_at_ends};
pub(crate) use obstacles::{Ends, Keep, TableTool};
pub use obstacles::{MotionBound, Obstacles};
pub(crate) use remedy::remedy;
pub(crate) use tilt::{AxisTilt, TILT_RESERVE, within_tilt};

use crate::budget::{self, Stations};
use base::progress::Progress;
use diagnostics::{Aborted, Diag, Sink, codes::files};
use ir::validate::Malformed;
use ir::{Operation, Program};
use nalgebra::Point3;
use wheel::part::{BladeId, Part, PassageId};

/// Clearance of the side of a cutter to faces that it does not finish, mm.
pub(crate) const SIDE_CLEARANCE: f64 = 0.1;

/// Number of stations along a face: a dense set that `sample-to-tolerance` thins. With 400 stations, neighbours lie
/// about 0.15 mm apart, so that the chord between them is below 0.1 um for the radii of a vane.
pub(crate) const STATIONS: usize = 400;

/// A text about a passage, with the blade that the passage follows where a sector has several passages.
pub(crate) fn in_passage(part: &Part, passage: PassageId, text: String) -> String {
    if part.blades.len() == 1 {
        text
    } else {
        format!("after {}, {text}", part.blade(BladeId::new(passage.index())).name)
    }
}

/// What a pass may read, and where it reports.
pub(crate) struct PassContext<'a> {
    pub(crate) program: &'a Program,
    pub(crate) obstacles: &'a Obstacles,
    pub(crate) progress: &'a Progress,
    pub(crate) sink: &'a mut Sink,
    /// Stations planned so far.
    pub(crate) stations: Stations,
}

impl PassContext<'_> {
    /// A pass and a point of sector 0 as they are in the first sector of an operation, for messages.
    pub(crate) fn in_first_sector(&self, operation: &Operation, label: &str, at: Point3<f64>) -> (String, Point3<f64>) {
        let sector = operation.sectors.first().copied().unwrap_or(0);
        (format!("sector {} {label}", sector + 1), self.program.part.sector_rotation(sector) * at)
    }

    /// Refuses an operation with this number of points in a sector where they exceed the memory, together with the stations
    /// planned so far.
    pub(crate) fn check_points(&mut self, operation: &Operation, points: f64) -> Result<(), Aborted> {
        budget::check_points(self.program, self.stations.and(points, operation), operation, self.sink)
    }

    /// Ends a run that was cancelled. No reason goes to the sink.
    pub(crate) fn go_on(&self) -> Result<(), Aborted> {
        if self.progress.is_cancelled() { Err(Aborted) } else { Ok(()) }
    }

    /// Runs a pass, whose time counts under its name.
    pub(crate) fn pass<T>(&mut self, name: &'static str, run: impl FnOnce(&mut Self) -> T) -> T {
        let progress = self.progress;
        progress.span(name, || run(self))
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
                Diag::error(files::INTERNAL, format!("the stage `{pass}` gave a malformed value: {malformed}"))
                    .note("this is a fault of the compiler, not of the job")
                    .help("report the job file"),
            );
            Aborted
        })
    }
}
