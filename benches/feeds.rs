//! Runs within speed, acceleration and jerk of five axes, by the number of stations.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a bench may stop at once")]

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use impellerc::five_axis::feedrate::{AXES, Axes, Limits, Rounding, Station, plan};
use std::hint::black_box;

/// Stations on a closed curve that is run through again and again, with all five axes moving; spacing in mm, feed in mm/s.
fn stations(count: usize, spacing: f64, feed: f64) -> Vec<Station> {
    let place = |i: usize| {
        let t = i as f64 * spacing / 25.0;
        let tip = [30.0 * t.cos(), 20.0 * t.sin(), 3.0 * (2.0 * t).sin()];
        let joints: Axes = [
            tip[0] + 10.0 * (0.7 * t).sin(),
            0.8 * tip[1],
            tip[2] + 5.0 * (0.3 * t).cos(),
            0.6 + 0.2 * t.sin(),
            0.8 * (0.9 * t).sin(),
        ];
        (tip, joints)
    };
    (0..count)
        .map(|i| {
            let ((tip, joints), (before, _)) = (place(i), place(i.saturating_sub(1)));
            let way: f64 = (0..3).map(|k| (tip[k] - before[k]).powi(2)).sum();
            Station { joints, tip, time: if i == 0 { 1.0 } else { way.sqrt() / feed } }
        })
        .collect()
}

fn growth(c: &mut Criterion) {
    let limits = Limits {
        speed: [500.0, 500.0, 500.0, 1.6755, std::f64::consts::PI],
        acceleration: [5000.0, 5000.0, 5000.0, 20.0, 20.0],
        jerk: [5e4, 5e4, 5e4, 200.0, 200.0],
    };
    let free = Limits { jerk: [f64::INFINITY; AXES], ..limits };
    let rounding = Rounding { tolerance: 0.002, height: 20.0 };
    for (name, limits, feed) in
        [("jerk, 4 mm/s", limits, 4.0), ("jerk, 50 mm/s", limits, 50.0), ("two passes, 50 mm/s", free, 50.0)]
    {
        let mut group = c.benchmark_group(format!("feeds within {name}, stations"));
        group.sampling_mode(SamplingMode::Flat).sample_size(10);
        for count in [10_000, 100_000, 1_000_000] {
            let stations = stations(count, 0.1, feed);
            let run = plan(&stations, &limits, &rounding);
            eprintln!("{count}: {:.3} s over a bound of {:.3} s, {} spans", run.time, run.least, run.legs.len());
            group.bench_function(BenchmarkId::from_parameter(count), |b| {
                b.iter(|| black_box(plan(&stations, &limits, &rounding).time));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, growth);
criterion_main!(benches);
