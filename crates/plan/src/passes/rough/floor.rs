//! Reach of a tool of `rough`: where it fits near the hub, and all of its positions.

use super::channel_levels::lines;
use super::channel_points;
use super::groove::passes;
use super::layers::{Level, Roughing, length_of};
use crate::passes::context::Obstacles;
use base::progress::Progress;
use ir::{ClPoint, Operation, Program, RoughingStrategy};
use rayon::prelude::*;

/// For places along the channel, at most `spacing` apart (mm), whether the tool of an operation fits `over` above the hub
/// (mm), or on the allowance of the hub where that is higher; with the distance of the places, mm. In a cancelled run it fits nowhere.
pub(super) fn fits_over_hub(roughing: &Roughing<'_>, over: f64, spacing: f64, progress: &Progress) -> (Vec<bool>, f64) {
    let level = Level::OverHub(over.max(roughing.hub_allowance()));
    let chart = &roughing.chart;
    let length = length_of(|u| chart.point(u, 0.0, 0.5), 0.0, 1.0);
    let count = (length / spacing).ceil().max(1.0) as usize;
    let fits = |i: usize| {
        let u = i as f64 / count as f64;
        !progress.is_cancelled() && (level.v(chart, u, 0.5) >= 1.0 || roughing.free_interval(u, level).is_some())
    };
    ((0..=count).into_par_iter().map(fits).collect(), length / count as f64)
}

/// Names and stations of all lines of a `rough` operation in sector 0; none for another operation. In a cancelled run some are missing.
pub(super) fn positions(
    program: &Program,
    operation: &Operation,
    obstacles: &Obstacles,
    progress: &Progress,
) -> Vec<(String, Vec<ClPoint>)> {
    let Some(RoughingStrategy::Rough { levels: form, .. }) = operation.kind.strategy() else { return Vec::new() };
    let mut all = Vec::new();
    for passage in program.part.passages() {
        let Some(roughing) = Roughing::new(program, operation, passage.id, obstacles, progress) else { return all };
        let levels = roughing.levels(form, &operation.name, progress);
        let work = progress.begin(format!("{}, lines", operation.name), levels.len());
        let lines = passes(&roughing, lines(&roughing, &levels, operation, &work).named);
        all.par_extend(lines.into_par_iter().map(|pass| (pass.label.clone(), channel_points(&pass))));
    }
    all
}
