//! Contracts on surfaces and operations: their figures are compared with those of programs that consist of these alone;
//! and the effect of `allow`.

use crate::support;
use impellerc::base::entity::PrimaryMap;
use impellerc::base::progress::Progress;
use impellerc::base::source::Span;
use impellerc::base::units::{Mm, Share};
use impellerc::diagnostics::{Severity, Sink, codes::verification};
use impellerc::ir::{Allowed, Contract, Motion, Operation, OperationId, OperationKind, Program};
use impellerc::plan::passes::pipeline;
use impellerc::report::proof::contracts;
use impellerc::report::proof::details::details;
use impellerc::report::proof::head;
use impellerc::tool_stock::collide::Cutter;
use impellerc::verify::machine::Axes;
use impellerc::verify::stock::Settings;
use impellerc::verify::{Certificate, certify_with};
use impellerc::wheel::contract::{ContractKind, Cuts, Guarded, Scope};
use impellerc::wheel::method::{Flank, FlankMethod};
use impellerc::wheel::part::{BladeId, Guides, Part, Stock, SurfaceClass, SurfaceId, SurfaceKind, solid};
use std::sync::LazyLock;

/// Coarse finishing of all vanes and channels of a part that has three of the paper's vanes at half their size, with
/// fillets and a ball of two thirds: each case below certifies all of them.
static PLANNED: LazyLock<(Program, Motion)> = LazyLock::new(|| {
    let half = |points: &[[f64; 3]; 7]| support::curve(&points.map(|p| p.map(|x| 0.5 * x)));
    let [root, tip] = [half(&support::ROOT_PRESSURE), half(&support::TIP_PRESSURE)];
    let pressure = Guides { root: root.clone(), tip: tip.clone() };
    let suction = Guides { root: half(&support::ROOT_SUCTION), tip: half(&support::TIP_SUCTION) };
    let part = Part::new(3, pressure, suction, root, tip, Some(Mm(2.0)));
    let mut tools = PrimaryMap::new();
    let ball = tools.push(support::tool("t2", 2, Cutter::ball(2.0), 15.0, 28.0));
    let faces = BladeId::MAIN.faces().to_vec();
    let flank = OperationKind::Flank { faces, flank: Flank::by_ruling(FlankMethod::TwoPoint, 2) };
    let mut operations = PrimaryMap::new();
    for (name, kind, lead) in [("flank", flank, 7.5), ("channel", support::channel(0.5), 4.0)] {
        operations.push(support::operation(name, kind, ball, vec![0, 1, 2], lead));
    }
    let stock = Stock::turned(&part, Mm(0.0), Mm(2.5), Mm(-20.0));
    let program = Program { part, stock, tools, operations, data: Vec::new(), ..support::wei_program(&[0]) };
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink);
    let motion = plan.unwrap_or_else(|_| panic!("no plan: {:#?}", sink.diags())).motion;
    (program, motion)
});

/// Volume, mm3: without roughing far more is left.
const LEFT: f64 = 500.0 / 8.0;

/// Edge of the cells of the stock, mm. Figures of the stock are compared with one another, so coarse cells show as much.
const CELL: f64 = 1.0;

fn certify(program: &Program, motion: &Motion, sink: &mut Sink) -> Certificate {
    let mut settings = Settings { cell: Some(CELL), ..Settings::default() };
    certify_with(program, motion, &mut settings, &Progress::default(), sink).unwrap()
}

/// Each operation alone.
static ALONE: LazyLock<[Certificate; 2]> = LazyLock::new(|| [0, 1].map(alone));

/// The whole program with every contract that the tests look at, all with bounds that hold; and their figures.
static ASKED: LazyLock<(Certificate, Sink, Vec<Contract>)> = LazyLock::new(|| {
    use ContractKind::{
        Air, AxisSpeed, ContourError, Engagement, Excess, Gouge, OrientationError, RemovalRate, RestVolume, Time,
    };
    use SurfaceClass::{Fillet, Hub, Pressure, Suction};
    let body = ContractKind::Clearance;
    let mut contracts = vec![
        on(Gouge, 1.0, &[], &[Pressure]),
        on(Gouge, 1.0, &[], &[Suction]),
        on(Gouge, 1.0, &[], &[Fillet]),
        on(Gouge, 1.0, &[], &[Hub]),
        on(Gouge, 1.0, &[], &[Pressure, Hub]),
        on(Excess, 100.0, &[], &[Fillet]),
        on(Gouge, 1.0, &[0], &[]),
        on(Gouge, 1.0, &[1], &[]),
        on(Gouge, 1.0, &[1], &[Hub]),
        on(Excess, 100.0, &[0], &[Hub]),
        on(Excess, 100.0, &[1], &[Hub]),
        on(Time, 1e6, &[], &[]),
        on(Time, 1e6, &[0], &[]),
        on(Time, 1e6, &[1], &[]),
        on(AxisSpeed, 1.0, &[], &[]),
        on(AxisSpeed, 1.0, &[0], &[]),
        on(AxisSpeed, 1.0, &[1], &[]),
        on(ContourError, 1.0, &[], &[]),
        on(ContourError, 1.0, &[0], &[]),
        on(ContourError, 1.0, &[1], &[]),
        on(OrientationError, 1.0, &[], &[]),
        on(OrientationError, 1.0, &[0], &[]),
        on(OrientationError, 1.0, &[1], &[]),
        on(body(Guarded::Body), 0.0, &[], &[]),
        on(body(Guarded::Tool), 0.0, &[], &[]),
        on(body(Guarded::Shank), 0.0, &[], &[]),
        on(body(Guarded::Shank), 0.0, &[1], &[]),
        on(body(Guarded::Holder), 0.0, &[], &[]),
        on(RestVolume, 1e7, &[], &[]),
        on(RestVolume, 1e7, &[0], &[]),
        on(RestVolume, 1e7, &[1], &[]),
        on(Air, 1.0, &[], &[]),
        on(Air, 1.0, &[0], &[]),
        on(RemovalRate, 1e9, &[], &[]),
        on(RemovalRate, 1e9, &[1], &[]),
        on(Engagement(Cuts::All), 360.0, &[], &[]),
        on(Engagement(Cuts::All), 360.0, &[1], &[]),
        on(Engagement(Cuts::OutsideSlots), 360.0, &[], &[]),
    ];
    contracts.extend(SurfaceClass::ALL.map(|s| on(body(Guarded::Shank), 0.0, &[], &[s])));
    let (certificate, sink) = judged(&contracts, &[]);
    (certificate, sink, contracts)
});

/// Contracts that fail, and one that cannot be judged.
static FAILED: LazyLock<(Certificate, Sink)> = LazyLock::new(|| {
    let gouge = on(ContractKind::Gouge, 1e-4, &[], &[SurfaceClass::Hub]);
    let volume = on(ContractKind::RestVolume, LEFT, &[], &[]);
    let between = [ContractKind::ContourError, ContractKind::OrientationError].map(|kind| on(kind, 0.0, &[1], &[]));
    let [contour, orientation] = between;
    judged(&[gouge, volume, on(ContractKind::Rest, 0.5, &[], &[]), contour, orientation], &[])
});

/// Figure of a contract of [`ASKED`].
fn asked(kind: ContractKind, operations: &[usize], surfaces: &[SurfaceClass]) -> f64 {
    let (certificate, _, contracts) = &*ASKED;
    let scope = on(kind, 0.0, operations, surfaces).scope;
    let index = contracts.iter().position(|c| c.kind == kind && c.scope == scope).expect("asked for");
    certificate.contracts[index].found
}

/// One operation alone.
fn alone(operation: usize) -> Certificate {
    let (program, motion) = &*PLANNED;
    let mut program = program.clone();
    let mut motion = motion.clone();
    let (_, declared) = program.operations.iter().nth(operation).unwrap();
    let declared = declared.clone();
    program.operations = PrimaryMap::new();
    let id = program.operations.push(declared);
    motion.operations = vec![motion.operations[operation].clone()];
    motion.operations[0].operation = id;
    certify(&program, &motion, &mut Sink::default())
}

fn judged(contracts: &[Contract], allowed: &[Allowed]) -> (Certificate, Sink) {
    let (program, motion) = &*PLANNED;
    let mut program = program.clone();
    program.contracts = contracts.to_vec();
    program.allowed = [allowed, &[support::deep_slots()]].concat();
    let mut sink = Sink::default();
    (certify(&program, motion, &mut sink), sink)
}

fn id(operation: usize) -> OperationId {
    PLANNED.0.operations.ids().nth(operation).unwrap()
}

fn on(kind: ContractKind, bound: f64, operations: &[usize], surfaces: &[SurfaceClass]) -> Contract {
    let operations = operations.iter().map(|o| id(*o)).collect();
    Contract { scope: Scope { operations, surfaces: surfaces.to_vec() }, ..Contract::whole(kind, bound) }
}

fn allow(kind: ContractKind, operations: &[usize], surfaces: &[SurfaceClass]) -> Allowed {
    let scope = on(kind, 0.0, operations, surfaces).scope;
    Allowed { kind, scope, reason: "known".to_owned(), span: Span::default() }
}

fn found(certificate: &Certificate) -> Vec<f64> {
    certificate.contracts.iter().map(|c| c.found).collect()
}

/// Largest proved cut or rest on the surfaces whose name has a word.
fn most(certificate: &Certificate, word: &str, excess: bool) -> f64 {
    let named = certificate.surfaces.iter().filter(|s| s.surface.contains(word));
    named.map(|s| if excess { s.excess_bound.get() } else { s.gouge_bound.get() }).fold(0.0, f64::max)
}

#[test]
fn surfaces_are_told_apart() {
    use ContractKind::{Excess, Gouge};
    use SurfaceClass::{Fillet, Hub, Pressure, Suction};
    let whole = &ASKED.0;
    let expected = [("pressure face", Pressure), ("suction face", Suction), ("fillet", Fillet), ("hub", Hub)]
        .map(|(word, class)| (most(whole, word, false), asked(Gouge, &[], &[class])));
    assert!(expected.iter().all(|(due, found)| due == found), "{expected:?}");
    assert!(expected.iter().all(|(due, _)| *due > 1e-4), "coarse paths gouge all surfaces: {expected:?}");
    let both = most(whole, "pressure face", false).max(most(whole, "hub", false));
    assert_eq!(asked(Gouge, &[], &[Pressure, Hub]), both);
    let left = most(whole, "fillet", true);
    assert_eq!(asked(Excess, &[], &[Fillet]), left);
    assert!(left > 1e-4 && left < 1.0, "the fillets are reached everywhere, and not exactly: {left}");
    assert_eq!(whole.contracts[4].name(), "gouge on pressure, hub");
}

#[test]
fn operations_are_told_apart() {
    use ContractKind::{Excess, Gouge};
    use SurfaceClass::Hub;
    let [flank, channel] = &*ALONE;
    assert_eq!(asked(Gouge, &[0], &[]), most(flank, "", false));
    assert_eq!(asked(Gouge, &[1], &[]), most(channel, "", false));
    assert_eq!(asked(Gouge, &[1], &[Hub]), most(channel, "hub", false));
    // What stands after the first operation, and after both.
    let after = [asked(Excess, &[0], &[Hub]), asked(Excess, &[1], &[Hub])];
    assert_eq!(after, [most(flank, "hub", true), most(&ASKED.0, "hub", true)]);
    assert!(after[0] > 1.2 * after[1] && after[1] < 1.0, "the channel takes what the flank left: {after:?}");
    assert!(asked(Gouge, &[0], &[]) > asked(Gouge, &[1], &[]), "the flank cuts deeper than the channel");
}

#[test]
fn clearances_are_told_apart() {
    let certificate = &ASKED.0;
    let found = |body, operations: &[usize], surfaces: &[SurfaceClass]| {
        asked(ContractKind::Clearance(body), operations, surfaces)
    };
    let distance =
        |c: &Option<impellerc::verify::clearance::Clearance>| c.as_ref().map_or(f64::INFINITY, |c| c.distance.get());
    let shanks: Vec<f64> = certificate.operations.iter().map(|o| distance(&o.shank)).collect();
    let holders: Vec<f64> = certificate.operations.iter().map(|o| distance(&o.holder)).collect();
    // Farther than this is not looked for.
    let least = |x: &[f64]| x.iter().copied().fold(5.0, f64::min);
    assert_eq!(found(Guarded::Body, &[], &[]), least(&shanks).min(least(&holders)));
    assert_eq!(found(Guarded::Shank, &[], &[]), least(&shanks));
    assert_eq!(found(Guarded::Shank, &[1], &[]), least(&shanks[1..]));
    assert_eq!(found(Guarded::Tool, &[], &[]), certificate.rapid.as_ref().map_or(5.0, |c| c.distance.get()));
    assert_eq!(found(Guarded::Holder, &[], &[]), least(&holders));
    assert!(least(&shanks) < 5.0, "a shank comes near: {shanks:?}");
    // What was found lies above the bound, by no more than a surface can come nearer beside a sample, and than a piece differs from
    // its partners.
    let partners = 1e-9;
    let half = impellerc::verify::SPACING * std::f64::consts::FRAC_1_SQRT_2;
    for c in certificate.operations.iter().flat_map(|o| [&o.shank, &o.holder]).flatten() {
        assert!(
            c.found.get() > c.distance.get() && c.found.get() - c.distance.get() <= half + partners,
            "{} {}",
            c.found.get(),
            c.distance.get()
        );
        assert!(
            (c.found.get() - c.distance.get().max(0.0).hypot(half)).abs() < partners || c.found.get() <= half,
            "{c:?}"
        );
    }
    // The nearest of all surfaces is the nearest of one of them, within the resolution of the search.
    let per_surface = SurfaceClass::ALL.map(|s| found(Guarded::Shank, &[], &[s]));
    assert!((least(&per_surface) - least(&shanks)).abs() < 2e-3, "{per_surface:?} {shanks:?}");
    assert!(per_surface.iter().all(|d| *d > least(&shanks) - 2e-3), "{per_surface:?} {shanks:?}");
}

#[test]
fn times_and_speeds_are_told_apart() {
    use ContractKind::{AxisSpeed, Time};
    let times = [asked(Time, &[0], &[]), asked(Time, &[1], &[])];
    assert!(times.iter().all(|t| *t > 0.0) && (asked(Time, &[], &[]) - times[0] - times[1]).abs() < 1e-9, "{times:?}");
    let fastest = asked(AxisSpeed, &[], &[]);
    assert_eq!(fastest, asked(AxisSpeed, &[0], &[]).max(asked(AxisSpeed, &[1], &[])));
    let largest = {
        let Axes { linear, rotary } = &ASKED.0.machine.axes;
        let shares = linear.iter().map(|a| a.speed_share).chain(rotary.iter().map(|a| a.speed_share));
        shares.map(Share::get).fold(0.0, f64::max)
    };
    assert_eq!(fastest, largest);
}

#[test]
fn errors_between_blocks_are_told_apart() {
    use ContractKind::{ContourError, OrientationError};
    let runs = &ASKED.0.machine.runs;
    let contour = [0, 1].map(|o| runs[o].contour.value.get());
    let orientation = [0, 1].map(|o| runs[o].orientation.value.get());
    assert!(contour.iter().chain(&orientation).all(|e| *e > 0.0), "{contour:?} {orientation:?}");
    assert_eq!([0, 1].map(|o| asked(ContourError, &[o], &[])), contour);
    assert_eq!(asked(ContourError, &[], &[]), contour[0].max(contour[1]));
    assert_eq!([0, 1].map(|o| asked(OrientationError, &[o], &[])), orientation);
    assert_eq!(asked(OrientationError, &[], &[]), orientation[0].max(orientation[1]));
    let units = ASKED.0.contracts.iter().filter(|c| c.kind == ContractKind::OrientationError).map(|c| &*c.unit);
    assert_eq!(units.collect::<Vec<_>>(), ["deg"; 3]);
}

#[test]
fn a_failed_error_between_blocks_tells_its_parts_its_place_and_the_way_out() {
    let (certificate, sink) = &*FAILED;
    for (kind, code, unit) in [
        (ContractKind::ContourError, verification::CONTOUR_ERROR, "um"),
        (ContractKind::OrientationError, verification::ORIENTATION_ERROR, "deg"),
    ] {
        let contract = certificate.contracts.iter().find(|c| c.kind == kind).expect("judged");
        assert!(!contract.holds && contract.place.contains("channel"), "{contract:?}");
        let diag = sink.diags().iter().find(|d| d.code == code).expect("an error");
        assert!(
            diag.notes[0].starts_with(&format!("{} on operation channel: found ", kind.name())),
            "{:?}",
            diag.notes
        );
        assert!(diag.message.contains(unit) && diag.message.contains("rounding a corner"), "{}", diag.message);
        assert!(diag.help.as_ref().is_some_and(|h| h.contains("tolerance chord")) && diag.labels.len() == 2);
        let place = diag.place.as_ref().expect("a place");
        assert_eq!([place.point.x, place.point.y, place.point.z], contract.point.unwrap());
        assert!(place.what.starts_with("channel, ") && place.block.is_some(), "{}", place.what);
    }
}

#[test]
fn figures_of_the_stock_are_told_apart() {
    use ContractKind::{Air, Engagement, RemovalRate, RestVolume};
    let (program, _) = &*PLANNED;
    let stock = ASKED.0.stock.as_ref().unwrap();
    let [flank, channel] = [0, 1].map(|o| &stock.operations[o]);
    let part = solid::volume(&program.part, &program.stock, 1e-6).unwrap().value;
    assert!(part > 0.4 * stock.blank.get() && part < stock.blank.get(), "{part} {}", stock.blank.get());
    assert_eq!(asked(RestVolume, &[], &[]), channel.rest.get() - part);
    assert_eq!(asked(RestVolume, &[1], &[]), channel.rest.get() - part);
    // Without roughing the room between the vanes still stands after the flanks.
    assert_eq!(asked(RestVolume, &[0], &[]), stock.blank.get() - flank.removed.get() - part);
    let left = asked(RestVolume, &[], &[]);
    assert!(
        channel.removed.get() > 1.0 && left > LEFT && left < stock.blank.get() - part - flank.removed.get(),
        "{left} {}",
        channel.removed.get()
    );
    assert_eq!(asked(Air, &[0], &[]), flank.feed[1].get() / flank.feed[0].get());
    let [feed, air] = [0, 1].map(|k| flank.feed[k].get() + channel.feed[k].get());
    let shares = air / feed;
    assert!((asked(Air, &[], &[]) - shares).abs() < 1e-12 && shares > 0.0 && shares < 1.0);
    let rates = [flank, channel].map(|o| o.rate.unwrap().by_minute().value);
    assert_eq!(asked(RemovalRate, &[1], &[]), rates[1]);
    assert_eq!(asked(RemovalRate, &[], &[]), rates[0].max(rates[1]));
    let arcs = [flank, channel].map(|o| o.arc_bound.unwrap().value.get());
    assert_eq!(asked(Engagement(Cuts::All), &[1], &[]), arcs[1]);
    let outside = [flank, channel].map(|o| o.arc_outside_slots.map_or(0.0, |b| b.value.get()));
    assert_eq!(asked(Engagement(Cuts::OutsideSlots), &[], &[]), outside[0].max(outside[1]));
    assert!([flank, channel].iter().all(|o| o.arc_bound.unwrap().value >= o.arc.unwrap().value));
    assert_eq!(asked(Engagement(Cuts::All), &[], &[]), arcs[0].max(arcs[1]));
    assert!(arcs[1] > 1.0 && arcs.iter().all(|arc| *arc <= 360.0), "{arcs:?}");
}

#[test]
fn contracts_that_hold_are_no_errors() {
    let (certificate, sink, contracts) = &*ASKED;
    assert!(!sink.has_errors(), "{:?}", sink.diags());
    assert_eq!(certificate.contracts.len(), contracts.len());
    assert!(certificate.contracts.iter().all(|c| c.holds));
}

#[test]
fn a_failed_contract_tells_found_wanted_where_and_the_way_out() {
    let (certificate, sink) = &*FAILED;
    let contract = &certificate.contracts[0];
    assert!(!contract.holds);
    let diag = sink.diags().iter().find(|d| d.code == verification::GOUGE).expect("an error");
    assert_eq!(diag.severity, Severity::Error);
    // The bound is judged; beside it stands the deepest cut that was found.
    let [judged, computed] = diag.notes.as_slice() else { panic!("{:?}", diag.notes) };
    assert_eq!(*judged, format!("gouge on hub: found {:.2} um, required at most 0.10 um", contract.found * 1e3));
    let deepest = contracts::computed(contract).expect("a computed value");
    assert!(computed.starts_with(&format!("at the computed points {deepest} was found")), "{computed}");
    assert!(diag.message.contains("hub of channel"), "{}", diag.message);
    assert!(diag.help.is_some() && diag.labels.len() == 2);
    let place = diag.place.as_ref().unwrap();
    assert!(place.what.contains("move"), "{}", place.what);
    assert_eq!([place.point.x, place.point.y, place.point.z], contract.point.unwrap());
}

#[test]
fn a_failed_rest_volume_tells_stock_and_part() {
    let (certificate, sink) = &*FAILED;
    let contract = &certificate.contracts[1];
    assert!(!contract.holds && contract.found == asked(ContractKind::RestVolume, &[], &[]));
    let diag = sink.diags().iter().find(|d| d.code == verification::REST_VOLUME).expect("an error");
    assert_eq!(diag.notes, [format!("rest-volume: found {:.1} mm3, required at most {LEFT:.1} mm3", contract.found)]);
    assert!(diag.message.contains("of stock after channel") && diag.message.contains("of part"), "{}", diag.message);
    assert!(diag.help.is_some() && diag.labels.len() == 2);
}

#[test]
fn what_is_allowed_is_taken_out_and_listed() {
    use ContractKind::{Excess, Gouge, Time};
    use SurfaceClass::{Fillet, Hub, Pressure, Suction};
    let hub = most(&ASKED.0, "hub", false);
    let faces = most(&ASKED.0, "face", false).max(most(&ASKED.0, "fillet", false));
    assert!(faces > hub, "the faces are cut deeper: {faces} {hub}");
    // Fails without `left`, as faces is above its bound; the hub keeps it; nothing asks for excess.
    let contracts = [on(Gouge, hub + 1e-6, &[], &[]), on(Time, 1e6, &[], &[])];
    let left = allow(Gouge, &[], &[Pressure, Suction, Fillet]);
    let allowed = [left, allow(Gouge, &[1], &[Hub]), allow(Excess, &[], &[Hub]), allow(Time, &[1], &[])];
    let (certificate, sink) = judged(&contracts, &allowed);
    assert!(certificate.contracts[0].holds && !sink.has_errors(), "{:?}", sink.diags());
    // What is left of the hub is what the first operation does there; allowed operations take no time.
    assert_eq!(found(&certificate), [most(&ALONE[0], "hub", false), asked(Time, &[0], &[])]);
    let listed = &certificate.allowed[0];
    assert_eq!((listed.found, listed.excuses, listed.reason.as_str()), (Some(faces), true, "known"));
    let text = details(&PLANNED.0, &PLANNED.1, &certificate);
    assert!(text.contains("gouge on pressure, suction, fillet") && text.contains(": known\n"), "{text}");
    assert_eq!(certificate.allowed.iter().map(|a| a.excuses).collect::<Vec<_>>(), [true, false, false, false, true]);
    let needless: Vec<_> = sink.diags().iter().filter(|d| d.code == verification::NEEDLESS_ALLOW).collect();
    assert_eq!(needless.len(), 3, "{:?}", sink.diags());
    assert!(needless.iter().all(|d| d.severity == Severity::Remark && d.message.contains(" on ")));
}

#[test]
fn what_cannot_be_measured_is_an_error() {
    // The third contract asks what roughing leaves; there is none.
    let (certificate, sink) = &*FAILED;
    assert_eq!(certificate.contracts.len(), 4);
    let told: Vec<_> = sink.diags().iter().filter(|d| d.code == verification::NOT_MEASURED).collect();
    assert_eq!(told.len(), 1);
    assert!(told[0].severity == Severity::Error && told[0].message.contains("`require rest`"), "{}", told[0].message);
}

/// A narrower contract elsewhere, even one that fails, takes nothing from what another one proves.
#[test]
fn each_contract_is_judged_by_its_own_bound() {
    let (program, motion) = &*PLANNED;
    let deepest = ASKED.0.surfaces.iter().map(|s| s.gouge.depth.get()).fold(0.0, f64::max);
    // Less over what is found than the proof leaves by itself.
    let close = deepest + 1e-4;
    let alone = judged_of(program, motion, &[on(ContractKind::Gouge, close, &[], &[])]);
    assert!(alone.contracts[0].holds, "{} over {close}", alone.contracts[0].found);
    let narrow = on(ContractKind::Gouge, 1e-4, &[], &[SurfaceClass::Hub]);
    let both = judged_of(program, motion, &[narrow, on(ContractKind::Gouge, close, &[], &[])]);
    assert!(!both.contracts[0].holds && both.contracts[1].holds, "{:?}", found(&both));
}

fn judged_of(program: &Program, motion: &Motion, contracts: &[Contract]) -> Certificate {
    let mut program = program.clone();
    program.contracts = contracts.to_vec();
    certify(&program, motion, &mut Sink::default())
}

/// A default contract is judged where no other speaks, and what is allowed in its place is told.
#[test]
fn a_default_holds_where_no_other_contract_speaks() {
    use SurfaceClass::{Fillet, Hub, Pressure, Suction};
    let default = Contract { default: true, ..on(ContractKind::Gouge, 1e-4, &[], &[]) };
    let (certificate, sink) = judged(std::slice::from_ref(&default), &[]);
    assert!(!certificate.contracts[0].holds && certificate.contracts[0].default);
    let diag = sink.diags().iter().find(|d| d.code == verification::GOUGE).unwrap();
    assert!(diag.notes.iter().any(|n| n.contains("the default is")), "{:?}", diag.notes);
    assert!(details(&PLANNED.0, &PLANNED.1, &certificate).contains("; the default"));
    // On the faces another contract speaks: there it decides.
    let stated = on(ContractKind::Gouge, 1.0, &[], &[Pressure, Suction, Fillet]);
    let (certificate, _) = judged(&[stated, default.clone()], &[]);
    let on_hub = asked(ContractKind::Gouge, &[], &[Hub]);
    assert!(certificate.contracts[0].holds);
    assert!((certificate.contracts[1].found - on_hub).abs() < 1e-3, "{:?} {on_hub}", found(&certificate));
    let everywhere = on(ContractKind::Gouge, 1.0, &[], &[Pressure, Suction, Fillet, Hub]);
    assert_eq!(judged(&[everywhere, default], &[]).0.contracts.len(), 1);
    // Allowed away: listed with its figure, and no head says "verified".
    let (certificate, _) = judged(&[], &[allow(ContractKind::Gouge, &[], &[])]);
    assert!(certificate.allowed[0].waives && certificate.allowed[0].excuses);
    assert_eq!(head::lines(&certificate)[0], "NOT VERIFIED: gouge, which the job allows: known");
    assert!(head::lines(&ASKED.0)[0].starts_with("verified"));
}

/// Excess is asked where the job is to finish. The same motion fails a job that is to finish all sectors.
#[test]
fn excess_is_asked_in_the_sectors_that_operations_finish() {
    let in_sectors = |sectors: &[u32]| {
        let mut operations = PrimaryMap::new();
        for (_, operation) in PLANNED.0.operations.iter() {
            operations.push(Operation { sectors: sectors.to_vec(), ..operation.clone() });
        }
        Program { operations, ..PLANNED.0.clone() }
    };
    let first = in_sectors(&[0]);
    let motion = pipeline::run(&first, &mut Sink::default()).expect("a plan").motion;
    let whole = judged(&[on(ContractKind::Excess, 1.0, &[], &[])], &[]).0.contracts[0].found;
    let contract = on(ContractKind::Excess, whole + 1e-3, &[], &[]);
    let of = |program: &Program| judged_of(program, &motion, std::slice::from_ref(&contract)).contracts[0].clone();
    let of_first = of(&first);
    assert!(of_first.holds && of_first.scope == "in sector 1 of 3", "{of_first:?}");
    let of_all = of(&in_sectors(&[0, 1, 2]));
    assert!(!of_all.holds && of_all.scope.is_empty(), "{of_all:?}");
    // A face of another sector is not asked for, nor a fillet whose floor is in another sector.
    let [one, other] = BladeId::MAIN.faces();
    let asks = |kind: SurfaceKind, sector: u32| first.asks_for(SurfaceId { kind, sector });
    assert!(asks(SurfaceKind::Face(one), 0) && asks(SurfaceKind::Face(other), 0) && !asks(SurfaceKind::Face(one), 1));
    let fillets = [one, other].map(|face| asks(SurfaceKind::Fillet(face), 0));
    assert!(fillets[0] != fillets[1], "{fillets:?}");
}

/// The move of a contract's worst place is that of the check that found it.
#[test]
fn a_worst_place_carries_its_own_move() {
    let (certificate, _, contracts) = &*ASKED;
    let of_surfaces = contracts.iter().zip(&certificate.contracts).take(5);
    for (asked, c) in of_surfaces {
        assert!(asked.kind == ContractKind::Gouge && asked.scope.operations.is_empty());
        let owner = certificate.surfaces.iter().find(|s| Some(s.gouge.point) == c.point).unwrap();
        assert!(c.at.is_some() && c.at == owner.gouge.at, "{}: {:?} {:?}", c.name(), c.at, owner.gouge.at);
    }
}
