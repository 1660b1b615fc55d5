use impellerc::diag::Sink;
use impellerc::driver::{self, Options, Outcome, Stages};
use impellerc::entity::PrimaryMap;
use impellerc::ir::{MoveKind, Operation};
use impellerc::passes::pipeline;
use impellerc::progress::Progress;
use impellerc::verify::stock::{Settings, simulate};
use std::collections::BTreeMap;
fn main() {
    let mut args = std::env::args().skip(1);
    let job = args.next().unwrap();
    let cell: Option<f64> = args.next().and_then(|c| c.parse().ok());
    let ops: usize = args.next().and_then(|c| c.parse().ok()).unwrap_or(9);
    let show: usize = args.next().and_then(|c| c.parse().ok()).unwrap_or(10);
    let options = Options { job: job.into(), ..Options::default() };
    let mut program = driver::front(&options, &mut Stages::default(), &mut Outcome::default()).unwrap().unwrap();
    let mut operations = PrimaryMap::new();
    for (_, o) in program.operations.iter().take(ops) {
        operations.push(Operation { sectors: vec![0], ..o.clone() });
    }
    program.operations = operations;
    program.contracts.clear();
    let mut sink = Sink::default();
    let t = std::time::Instant::now();
    let plan = pipeline::run(&program, &mut sink);
    let Ok(plan) = plan else {
        for d in sink.diags() {
            println!("{} {} {:?}", d.code.id(), d.message, d.notes);
        }
        return;
    };
    println!("planned in {:.1} s", t.elapsed().as_secs_f64());
    for o in &plan.cl.operations {
        for n in &o.notes {
            println!("{n}");
        }
    }
    let motion = plan.motion;
    let mut settings = Settings { cell, after: None };
    let report = simulate(&program, &motion, &mut settings, &Progress::default(), &mut sink).unwrap();
    for (o, s) in motion.operations.iter().zip(&report.operations) {
        println!(
            "== {} removed {:.1} links {:.3} air {:.1} of {:.1} s outside slots {:?}",
            s.name, s.removed, s.by_links, s.air, s.time, s.arc_outside_slots
        );
        let mut hist: BTreeMap<(&str, &str), ([f64; 13], [f64; 13])> = BTreeMap::new();
        let mut worst: Vec<(f64, f64, usize)> = Vec::new();
        let mut linked: BTreeMap<String, f64> = BTreeMap::new();
        for (i, m) in o.moves.iter().enumerate() {
            let label = &o.labels[m.pass as usize];
            let kind = if label.ends_with("slot") { "slot" } else { "line" };
            let k = match m.kind {
                MoveKind::Cut => "cut",
                MoveKind::Link => "link",
                MoveKind::Rapid => "rapid",
            };
            let e = &s.moves[i];
            let h = hist.entry((kind, k)).or_default();
            let class = |a: f64| if a > 0.0 { (a / 15.0).ceil() as usize } else { 0 };
            h.0[class(e.arc)] += m.time;
            h.1[class(e.arc_bound)] += m.time;
            if m.kind == MoveKind::Link && e.rate > 0.0 {
                *linked.entry(label.clone()).or_default() += e.rate * m.time;
            }
            if kind == "slot" {
                worst.push((e.arc, e.arc_bound, i));
            }
        }
        println!("time by found arc: air, 15, 30 ... 180");
        for (k, (f, b)) in &hist {
            println!("{:?} total {:.1} s", k, f.iter().sum::<f64>());
            println!("   found {}", f.iter().map(|x| format!("{x:6.2}")).collect::<String>());
            println!("   bound {}", b.iter().map(|x| format!("{x:6.2}")).collect::<String>());
        }
        if std::env::var("PASSES").is_ok() {
            for p in 0..o.labels.len() {
                if !o.labels[p].ends_with("slot") {
                    continue;
                }
                let idx: Vec<usize> = (1..o.moves.len())
                    .filter(|i| o.moves[*i].pass as usize == p && o.moves[*i].kind == MoveKind::Cut)
                    .collect();
                let arc = idx.iter().map(|i| s.moves[*i].arc).fold(0.0, f64::max);
                let r = |i: &usize| {
                    let f = program.machine.forward(&o.moves[*i].joints);
                    (f.tip.x.hypot(f.tip.y), f.tip.z)
                };
                let rs: Vec<_> = idx.iter().map(r).collect();
                println!(
                    "pass {p} {} cut moves {} max arc {arc:.1} r {:.2}..{:.2} z {:.2}",
                    o.labels[p],
                    idx.len(),
                    rs.iter().map(|x| x.0).fold(1e9, f64::min),
                    rs.iter().map(|x| x.0).fold(0.0, f64::max),
                    rs.first().map_or(0.0, |x| x.1)
                );
            }
        }
        if let Ok(d) = std::env::var("DUMP") {
            for d in d.split(',') {
                let d: u32 = d.parse().unwrap();
                for i in 1..o.moves.len() {
                    let m = &o.moves[i];
                    if m.pass == d {
                        let f = program.machine.forward(&m.joints);
                        let t = f.tip + f.axis * 8.0;
                        println!(
                            "{i} {:?} arc {:.0} {:.0} tip {:.2} {:.2} {:.2} top {:.2} {:.2} {:.2}",
                            m.kind, s.moves[i].arc, s.moves[i].arc_bound, f.tip.x, f.tip.y, f.tip.z, t.x, t.y, t.z
                        );
                    }
                }
            }
        }
        worst.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (a, b, i) in worst.iter().take(show) {
            let m = &o.moves[*i];
            let f = program.machine.forward(&m.joints);
            println!(
                "{a:.1} {b:.1} move {i} pass {} {} {:?} at {:.2} {:.2} {:.2}",
                m.pass, o.labels[m.pass as usize], m.kind, f.tip.x, f.tip.y, f.tip.z
            );
        }
        let mut l: Vec<_> = linked.into_iter().collect();
        l.sort_by(|a, b| b.1.total_cmp(&a.1));
        println!("links remove {:?}", &l[..l.len().min(5)]);
    }
}
