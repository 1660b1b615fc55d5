//! No value that is not finite reaches a certificate: each kind of figure is replaced by such a value, and an error
//! names it.

use crate::support::pinned;
use ciborium::Value;
use impellerc::base::source::Span;
use impellerc::base::units::{Deg, Mm, Mm2, Mm3, Mm3PerSec, Sec, Share};
use impellerc::diagnostics::{Sink, codes::verification};
use impellerc::five_axis::control::Planning;
use impellerc::ir::{Motion, Program};
use impellerc::verify::certificate::ContractReport;
use impellerc::verify::{Certificate, certify, finite};
use impellerc::wheel::contract::{ContractKind, Relation};
use std::collections::BTreeSet;
use std::sync::LazyLock;

/// A finished face with its motion and certificate.
static FLANK: LazyLock<(Program, Motion, Certificate)> = LazyLock::new(|| {
    let flank = pinned::flank();
    let mut certificate = flank.certificate().clone();
    // The program has no contract.
    certificate.contracts.push(ContractReport {
        kind: ContractKind::Gouge,
        scope: String::new(),
        relation: Relation::AtMost,
        unit: "mm".into(),
        bound: 0.002,
        found: 0.001,
        place: String::new(),
        point: Some([1.0, 2.0, 3.0]),
        at: None,
        holds: true,
        default: false,
        computed: None,
        span: Span::default(),
    });
    (flank.program.clone(), flank.motion.clone(), certificate)
});

/// What is reported of a certificate.
fn reported(certificate: &Certificate) -> Vec<String> {
    let (program, motion, _) = &*FLANK;
    let mut sink = Sink::default();
    finite::report(program, motion, certificate, &mut sink);
    assert!(sink.diags().iter().all(|d| d.code == verification::NOT_A_NUMBER && d.help.is_some()));
    sink.diags().iter().map(|d| d.message.clone()).collect()
}

#[test]
fn a_sound_certificate_says_nothing() {
    assert!(reported(&FLANK.2).is_empty());
}

/// One figure of each part of the certificate.
#[test]
fn a_figure_that_is_none_is_an_error_with_its_name() {
    type Change = fn(&mut Certificate, f64);
    let changes: &[(&str, Change)] = &[
        ("operations.0.time.1", |c, x| c.operations[0].time[1] = Sec(x)),
        ("operations.0.length.2", |c, x| c.operations[0].length[2] = Mm(x)),
        ("surfaces.0.area", |c, x| c.surfaces[0].area = Mm2(x)),
        ("surfaces.0.gouge.depth", |c, x| c.surfaces[0].gouge.depth = Mm(x)),
        ("surfaces.0.percentiles.1", |c, x| c.surfaces[0].percentiles[1] = Mm(x)),
        ("perimeter.retract", |c, x| c.perimeter.retract = Mm(x)),
        ("machine.axes.3.speed_share", |c, x| c.machine.axes.rotary[0].speed_share = Share(x)),
        ("machine.axes.0.used.1", |c, x| c.machine.axes.linear[0].used[1] = Mm(x)),
        ("machine.pole_distance", |c, x| c.machine.pole_distance = Deg(x)),
        ("machine.runs.0.time.0", |c, x| c.machine.runs[0].time[0] = Sec(x)),
        ("machine.runs.0.jerk.4.value", |c, x| c.machine.runs[0].jerk[4].value = Share(x)),
        ("machine.runs.0.contour.tip.2", |c, x| c.machine.runs[0].contour.tip[2] = x),
        ("machine.other_rules.0.great_circle.value", |c, x| c.machine.other_rules[0].great_circle.value = Mm(x)),
        ("machine.fastest.0.share", |c, x| c.machine.fastest[0].as_mut().unwrap().share = Share(x)),
        ("stock.operations.0.removed", |c, x| c.stock.as_mut().unwrap().operations[0].removed = Mm3(x)),
        ("stock.operations.0.depth.tip.0", |c, x| {
            c.stock.as_mut().unwrap().operations[0].depth.as_mut().unwrap().tip[0] = x;
        }),
        ("stock.operations.0.moves", |c, x| c.stock.as_mut().unwrap().operations[0].moves[3].rate = Mm3PerSec(x)),
        ("contracts.0.found", |c, x| c.contracts[0].found = x),
        ("contracts.0.bound", |c, x| c.contracts[0].bound = x),
        ("contracts.0.point.1", |c, x| c.contracts[0].point = Some([0.0, x, 0.0])),
    ];
    for (name, change) in changes {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut certificate = FLANK.2.clone();
            change(&mut certificate, value);
            let reported = reported(&certificate);
            assert_eq!(reported.len(), 1, "{name}: {reported:?}");
            assert!(reported[0].contains(&format!("`{name}`")), "{name}: {}", reported[0]);
        }
    }
}

/// Every number of the certificate, one of each name.
#[test]
fn no_number_of_a_certificate_is_passed_over() {
    let whole = Value::serialized(&FLANK.2).unwrap();
    let mut places = Vec::new();
    numbers(&whole, &mut Vec::new(), &mut places);
    let mut seen = BTreeSet::new();
    for place in &places {
        let name: Vec<&str> = place.iter().filter(|s| s.parse::<usize>().is_err()).map(String::as_str).collect();
        if !seen.insert(name.join(".")) {
            continue;
        }
        let mut changed = whole.clone();
        *at(&mut changed, place) = Value::Float(f64::NAN);
        assert_eq!(finite::not_finite(&changed), Ok(vec![place.clone()]));
    }
    assert!(seen.len() > 60, "{seen:?}");
    assert_eq!(finite::not_finite(&whole), Ok(Vec::new()));
}

/// Steps to every number with a point.
fn numbers(value: &Value, path: &mut Vec<String>, places: &mut Vec<Vec<String>>) {
    let inner: Vec<(String, &Value)> = match value {
        Value::Float(_) => {
            places.push(path.clone());
            return;
        }
        Value::Array(values) => values.iter().enumerate().map(|(i, v)| (i.to_string(), v)).collect(),
        Value::Map(fields) => fields.iter().map(|(k, v)| (k.as_text().unwrap().to_owned(), v)).collect(),
        _ => return,
    };
    for (name, value) in inner {
        path.push(name);
        numbers(value, path, places);
        path.pop();
    }
}

fn at<'a>(value: &'a mut Value, path: &[String]) -> &'a mut Value {
    path.iter().fold(value, |value, step| match value {
        Value::Array(values) => &mut values[step.parse::<usize>().unwrap()],
        Value::Map(fields) => &mut fields.iter_mut().find(|(k, _)| k.as_text() == Some(step)).unwrap().1,
        _ => panic!("no {step}"),
    })
}

/// A planner that never comes to an end: the time is not made up, and the motion is refused.
#[test]
fn a_time_that_is_none_refuses_the_motion() {
    let (mut program, motion, _) = FLANK.clone();
    program.machine.planning = Planning::LinuxCnc;
    for axis in &mut program.machine.linear {
        axis.acceleration = 1e-12;
    }
    let mut sink = Sink::default();
    let certificate = certify(&program, &motion, &mut sink).unwrap();
    assert!(certificate.machine.runs[0].time.iter().any(|t| !t.get().is_finite()));
    let found: Vec<_> = sink.diags().iter().filter(|d| d.code == verification::NOT_A_NUMBER).collect();
    assert!(found.len() == 1 && found[0].message.contains("of `flank`"), "{found:?}");
    assert!(!found[0].labels.is_empty());
}
