//! `.bgi` files: a made-up wheel whose form is known in closed form, and the traps of the format.
//!
//! The hub is the cone r = 10 + 0.75 z, the shroud the cone r = 20 + 0.75 z, both from z = 0 to 40, 50 mm long. The blade goes
//! from z = 4 to z = 36 on straight edges at right angles to the axis, so that all layers are cones of this slope.

use super::{faults, good, line, noted, points};
use impellerc::blade::EdgeForm;
use impellerc::blade::angles::EdgeShape;
use impellerc::blade_files::angles::StatedAngle;
use impellerc::blade_files::{Handedness, LengthUnit, Options};

/// Slope of the cones: dr/dz, and length over dz.
const SLOPE: f64 = 0.75;
const LENGTH: f64 = 1.25;

/// Beta on the hub, deg.
const BETA: f64 = 30.0;

/// Thickness at hub and shroud, mm.
const THICKNESS: [f64; 2] = [2.0, 1.2];

fn list(points: &[[f64; 2]]) -> String {
    points.iter().map(|[a, b]| format!("        ( {a:.9},{b:.9} )\n")).collect()
}

fn segment(points: &[[f64; 2]]) -> String {
    let kind = if points.len() == 2 { "Linear" } else { "Spline" };
    let controls = |side: &str| if points.len() == 2 { String::new() } else { format!("      {side}Control=Free\n") };
    format!(
        "    New Segment\n      CurveType={kind}\n{}      Begin Data\n{}      End Data\n{}    End Segment\n",
        controls("Upstream"),
        list(points),
        controls("Downstream")
    )
}

fn meridian(name: &str, r: f64) -> String {
    let at = |k: u32| [4.0 * f64::from(k), r + SLOPE * 4.0 * f64::from(k)];
    // Two segments, as BladeGen writes them.
    let (first, second): (Vec<_>, Vec<_>) = ((0..=4).map(at).collect(), (4..=10).map(at).collect());
    format!("  Begin {name}\n{}{}  End {name}\n", segment(&first), segment(&second))
}

fn edge(name: &str, z: f64) -> String {
    let at = |k: u32| [z, 10.0 + SLOPE * z + 2.5 * f64::from(k)];
    format!("  Begin {name}\n{}  End {name}\n", segment(&(0..=4).map(at).collect::<Vec<_>>()))
}

/// Theta on the shroud of the file, deg: that of the constant beta of 20 deg.
fn theta(way: f64) -> f64 {
    let r = |way: f64| 23.0 + 24.0 * way;
    (20.0_f64.to_radians().tan() / 0.6 * (r(way) / r(0.0)).ln()).to_degrees()
}

fn curve(head: &str, values: &[[f64; 2]], kind: &str) -> String {
    format!("    New {kind}\n{head}{}    End {kind}\n", segment(values))
}

/// The file: angles on two layers, thicknesses on the same.
pub fn file() -> String {
    let beta: Vec<[f64; 2]> = (0..=4).map(|k| [25.0 * f64::from(k), BETA]).collect();
    let thetas: Vec<[f64; 2]> = (0..=40).map(|k| [2.5 * f64::from(k), theta(f64::from(k) / 40.0)]).collect();
    let thick = |t: f64| -> Vec<[f64; 2]> { (0..=4).map(|k| [25.0 * f64::from(k), t]).collect() };
    let dims = "      HorizDim=PercentMeridional\n";
    let angle = |layer: &str, rest: &str| format!("      Layer=\"{layer}\"\n{rest}{dims}      VertDim=Degree\n");
    let thickness = |layer: &str| format!("      Layer=\"{layer}\"\n{dims}");
    let ends = "  LeadingEdgeEndType=Ellipse\n  HubLE_EllipseRatio=2.0\n  ShrLE_EllipseRatio=2.0\n  TrailingEdgeEndType=CutOff\n  EllipseAtMean=T\n";
    let cut: Vec<[f64; 2]> = (0..=4)
        .map(|k| f64::from(k) * 0.25)
        .map(|s| [18.0 - 2.0 * s, 10.0 + SLOPE * (18.0 - 2.0 * s) + 10.0 * s])
        .collect();
    [
        "! made up\nBegin Defaults\nEnd Defaults\nBegin Equations\nEnd Equations\nBegin Model\n  NumMainBlades=7\n  Mode=Angle/Thickness\n  RightHandedCoordSystem\n  NumBladePoints=60\n  DataFromLeToTe\n  BetaAxialDef\n  ThicknessIsDimension\n  MeridionalSpanCurveRuledShape=RuledElementOnly\n  Comment=\"\"\n  GeometryUnits=MM\nEnd Model\n",
        "Begin Meridional\n  MeridionalControlCurveMode=Normal\n  SpanByGeom\n",
        &meridian("HubCurve", 10.0),
        &meridian("ShroudCurve", 20.0),
        &edge("InletCurve", 0.0),
        &edge("ExhaustCurve", 40.0),
        &edge("LeadingEdgeCurve", 4.0),
        &edge("TrailingEdgeCurve", 36.0),
        "  New SpanLayer\n    Name=Layer1\n    OutputLayer=T\n    SpanFraction=0.000000000\n  End SpanLayer\n  New SpanLayer\n    Name=Layer2\n    OutputLayer=T\n    SpanFraction=1.000000000\n  End SpanLayer\nEnd Meridional\n",
        "New Blade\n  PitchFraction=0.000000000\n",
        ends,
        "  Begin AngleDefinition\n    AngleLocation=MeanLine\n    SpanwiseDistribution=General\n",
        &curve(&angle("Layer1", "      DefinitionType=BetaCurve\n      LE_Theta=5.0\n"), &beta, "AngleCurve"),
        &curve(&angle("Layer2", "      DefinitionType=ThetaCurve\n"), &thetas, "AngleCurve"),
        "  End AngleDefinition\n  Begin ThicknessDefinition\n    ThicknessType=Normal To Camber Line\n    SpanwiseDistribution=General\n",
        &curve(&thickness("Layer1"), &thick(THICKNESS[0]), "ThicknessCurve"),
        &curve(&thickness("Layer2"), &thick(THICKNESS[1]), "ThicknessCurve"),
        "  End ThicknessDefinition\nEnd Blade\n",
        "New Blade\n  PitchFraction=0.4500000000\n",
        ends,
        &format!("  Begin LeadingEdgeCut\n{}  End LeadingEdgeCut\nEnd Blade\n", segment(&cut)),
        "Begin PlusData\nBegin Case\nMachineType = Comp_Radial\nUnits = MM\nEnd Case\nEnd PlusData\n",
    ]
    .concat()
}

/// An example for other tests.
pub fn example() -> Vec<(String, String)> {
    vec![("a.bgi".to_owned(), file())]
}

fn read(text: &str) -> impellerc::blade_files::Imported {
    good(&[("a.bgi", text)], 1, &Options::default())
}

/// Distance of a point from a camber line on a cone of this slope, laid flat without strain: (angle of the camber line by the
/// radius, point). Points of the line are 1 um apart or less near to the point.
fn from_camber(theta: &dyn Fn(f64) -> f64, p: &nalgebra::Point3<f64>, turn: f64) -> f64 {
    let flat = |r: f64, angle: f64| {
        let (sin, cos) = (angle * 0.6).sin_cos();
        [r / 0.6 * cos, r / 0.6 * sin]
    };
    let r = p.x.hypot(p.y);
    let at = flat(r, p.y.atan2(p.x) - turn);
    let distance = |radius: f64| {
        let q = flat(radius, theta(radius));
        (q[0] - at[0]).hypot(q[1] - at[1])
    };
    let (mut low, mut high) = (r - 3.0, r + 3.0);
    for _ in 0..100 {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if distance(a) < distance(b) { high = b } else { low = a }
    }
    distance(0.5 * (low + high))
}

/// Theta on the hub at a radius, rad: tan(beta) / sin(cone) ln(r / r0) in closed form.
fn theta_hub(r: f64) -> f64 {
    5.0_f64.to_radians() + BETA.to_radians().tan() / 0.6 * (r / 13.0).ln()
}

fn theta_shroud(r: f64) -> f64 {
    20.0_f64.to_radians().tan() / 0.6 * (r / 23.0).ln()
}

/// Both faces lie at half of the thickness from the closed form of the camber line, on hub and shroud, of main blade and
/// splitter; the edges have the stated forms.
#[test]
fn faces_lie_beside_the_closed_form_of_the_camber_line() {
    let read = read(&file());
    let row = &read.rows[0];
    assert_eq!((row.count, row.blades.len(), read.format), (7, 2, "bgi"));
    let pitch = std::f64::consts::TAU / 7.0;
    for (blade, turn, from) in [(&row.blades[0], 0.0, [4.0, 4.0]), (&row.blades[1], 0.45 * pitch, [18.0, 16.0])] {
        assert_eq!(blade.edges, [Some(EdgeForm::Round), Some(EdgeForm::CutOff)]);
        let (first, last) = (&blade.sections[0], blade.sections.last().unwrap());
        assert_eq!([first.span, last.span], [Some(0.0), Some(1.0)]);
        let lines: [(&dyn Fn(f64) -> f64, f64); 2] = [(&theta_hub, 10.0), (&theta_shroud, 20.0)];
        for (k, (section, (theta, r0))) in [first, last].into_iter().zip(lines).enumerate() {
            let half = 0.5 * THICKNESS[k];
            let (mut on_faces, mut worst) = (0, 0.0_f64);
            let mut foremost = f64::INFINITY;
            for p in points(&section.form) {
                assert!((p.x.hypot(p.y) - r0 - SLOPE * p.z).abs() < 1e-6, "off the cone: {p:?}");
                assert!(p.z < 36.0 + 1e-6);
                foremost = foremost.min(p.z);
                let off = from_camber(theta, p, turn);
                // Behind the ellipse, which is as long as the blade is thick.
                if p.z > from[k] + 2.0 * half + 0.3 {
                    on_faces += 1;
                    worst = worst.max((off - half).abs());
                } else {
                    assert!(off < half + 1e-3, "{off}");
                }
            }
            // The hub has beta, which is integrated; the shroud has 41 values of theta.
            assert!(on_faces > 200 && worst < 2e-5, "{on_faces} points, {worst}");
            // A slanting ellipse stands out over its nose: half axes of twice and once half the thickness.
            let (sin, cos) = [BETA, 20.0][k].to_radians().sin_cos();
            let out = half * ((2.0 * cos).hypot(sin) - 2.0 * cos) / LENGTH;
            assert!((foremost - from[k] + out).abs() < 0.01, "{foremost} {out}");
        }
    }
    assert!(noted(&read, "0.45 of the pitch"), "{:#?}", read.notes);
    for words in ["cubic spline", "layers are taken", "across the camber line", "`InletCurve` is not used"] {
        assert!(noted(&read, words), "{words}");
    }
}

/// The ellipse: at half of its length the blade has sqrt(3)/2 of its thickness.
#[test]
fn edges_are_ellipses_of_the_stated_ratio() {
    let read = read(&file());
    let stated = read.rows[0].blades[0].angles.as_ref().unwrap();
    assert_eq!(stated.shapes, [EdgeShape::Elliptic(2.0), EdgeShape::CutOff]);
    let section = &read.rows[0].blades[0].sections[0];
    let beta = BETA.to_radians();
    let mut found = 0;
    for p in points(&section.form) {
        let r = p.x.hypot(p.y);
        let off = from_camber(&theta_hub, p, 0.0);
        // Length along the camber line from its begin; the foot of the point is near to its own radius, and beta is constant.
        let beside = p.y.atan2(p.x) - theta_hub(r);
        let depth = (r - 13.0) / SLOPE * LENGTH / beta.cos() + off * beta.tan() * beside.signum();
        if depth < 1.8 && depth > 0.1 {
            let due = (1.0 - (1.0 - depth / 2.0_f64).powi(2)).sqrt();
            assert!((off - due).abs() < 0.03, "{depth} {off} {due}");
            found += 1;
        }
    }
    assert!(found > 10, "{found}");
}

#[test]
fn a_left_handed_frame_is_mirrored_and_units_are_converted() {
    let right = read(&file());
    let left = read(&file().replace("RightHanded", "LeftHanded"));
    for (a, b) in right.rows[0].blades.iter().zip(&left.rows[0].blades) {
        let stated = b.angles.as_ref().unwrap();
        // The mirror image of 0.45 of the pitch is 0.55 of it, behind the blade before.
        let (sin, cos) = if stated.turn > 0.0 { (std::f64::consts::TAU / 7.0).sin_cos() } else { (0.0, 1.0) };
        for (p, q) in a.sections.iter().zip(&b.sections) {
            let mirrored = points(&p.form).iter().map(|p| [cos * p.x + sin * p.y, sin * p.x - cos * p.y, p.z]);
            let far = |p: [f64; 3]| {
                let near = points(&q.form).iter().map(|q| (q.x - p[0]).hypot(q.y - p[1]).hypot(q.z - p[2]));
                near.fold(f64::INFINITY, f64::min)
            };
            assert!(mirrored.map(far).all(|d| d < 1e-6));
        }
        assert!(stated.turn == 0.0 || (stated.turn - 0.55).abs() < 1e-12);
    }
    let StatedAngle::Beta(beta, start) = &left.rows[0].blades[0].angles.as_ref().unwrap().camber[0].says else {
        panic!()
    };
    assert!((start.to_degrees() + 5.0).abs() < 1e-9 && (beta[0][1].to_degrees() + BETA).abs() < 1e-9);

    let inches = read(&file().replace("GeometryUnits=MM", "GeometryUnits=IN"));
    let hubs = [&right, &inches].map(|read| read.hub.clone().unwrap());
    for end in [<[[f64; 2]]>::first, <[[f64; 2]]>::last] {
        let [a, b] = hubs.each_ref().map(|hub| *end(hub).unwrap());
        assert!((0..2).all(|i| (a[i] * 25.4 - b[i]).abs() < 1e-6), "{a:?} {b:?}");
    }
    let unstated = file().replace("  GeometryUnits=MM\n", "");
    assert_eq!(faults(&[("a.bgi", &unstated)], 1, &Options::default())[0].code.id(), "IMP1004");
    let options = Options { unit: Some(LengthUnit::Millimetre), ..Options::default() };
    assert_eq!(good(&[("a.bgi", &unstated)], 1, &options).hub, right.hub);
    let options = Options { handedness: Some(Handedness::Left), ..Options::default() };
    assert_eq!(line(&[("a.bgi", &file())], 1, &options).0, "IMP1005");
}

/// A splitter is a part of the main blade, also where layers between hub and shroud have angles of their own, and blanks, flags
/// and the words for sections vary.
#[test]
fn other_ways_to_write_the_same_are_read() {
    let text = file();
    let same = text
        .replace("New ", "Begin ")
        .replace("EllipseAtMean=T", "EllipseAtMean")
        .replace('=', " = ")
        .replace("RuledElementOnly", "Ruled Element Only")
        .replace('\n', "\r\n");
    let [a, b] = [&text, &same].map(|text| read(text));
    assert_eq!(
        a.rows,
        b.rows
            .iter()
            .map(|row| impellerc::blade_files::ImportedRow {
                blades: row
                    .blades
                    .iter()
                    .zip(&a.rows[0].blades)
                    .map(|(b, a)| impellerc::blade_files::ImportedBlade { places: a.places.clone(), ..b.clone() })
                    .collect(),
                ..row.clone()
            })
            .collect::<Vec<_>>()
    );
    // BladeGen's numbers end a little beside 100 %.
    let beside = text.replace("( 100.000000000,30.0", "( 99.999231260,30.0");
    assert!(beside != text && noted(&read(&beside), "beside 0 % and 100 %"));
}

/// What is not understood is refused with its line: (change, code, words of the line).
#[test]
fn what_may_change_the_blade_is_refused() {
    let text = file();
    for (from, to, code) in [
        ("Mode=Angle/Thickness", "Mode=Prs/Sct", "IMP1007"),
        ("  Mode=Angle/Thickness\n", "", "IMP1004"),
        ("  BetaAxialDef\n", "", "IMP1007"),
        ("  DataFromLeToTe\n", "", "IMP1004"),
        ("  ThicknessIsDimension\n", "", "IMP1004"),
        ("GeometryUnits=MM", "GeometryUnits=FURLONG", "IMP1002"),
        ("NumMainBlades=7", "NumMainBlades=NumBladeSets", "IMP1002"),
        ("NumMainBlades=7", "NumMainBlades=0", "IMP1002"),
        ("NumBladePoints=60", "NumBladePoints=60\n  NewWord=3", "IMP1007"),
        ("RightHandedCoordSystem", "RightHandedCoordSystem\n  LeftHandedCoordSystem", "IMP1005"),
        ("Begin Defaults\n", "Begin Defaults\nNumBladeSets=11\n", "IMP1007"),
        ("RuledElementOnly", "Always", "IMP1007"),
        ("CurveMode=Normal", "CurveMode=Ratio", "IMP1007"),
        ("  SpanByGeom\n", "  SpanByFlow\n", "IMP1007"),
        ("CurveType=Spline", "CurveType=Bezier", "IMP1007"),
        ("CurveType=Spline", "CurveType=Linear", "IMP1007"),
        ("UpstreamControl=Free", "UpstreamControl=Tangent", "IMP1007"),
        ("( 20.000000000,25.000000000 )", "( 20.000000000,28.000000000 )", "IMP1007"),
        ("( 16.000000000,22.000000000 )\n        ( 20.0", "( 16.100000000,22.000000000 )\n        ( 20.0", "IMP1005"),
        (
            "( 4.000000000,13.000000000 )\n        ( 4.000000000,15.5",
            "( 4.000000000,12.900000000 )\n        ( 4.000000000,15.5",
            "IMP1005",
        ),
        ("SpanFraction=1.0", "SpanFraction=1.5", "IMP1002"),
        ("SpanFraction=1.0", "SpanFraction=0.9", "IMP1007"),
        ("Name=Layer2", "Name=Layer1", "IMP1002"),
        ("Layer=\"Layer2\"", "Layer=\"Layer7\"", "IMP1002"),
        ("Layer=\"Layer2\"", "Layer=\"Layer1\"", "IMP1002"),
        ("AngleLocation=MeanLine", "AngleLocation=Side1", "IMP1007"),
        ("SpanwiseDistribution=General", "SpanwiseDistribution=Ruled", "IMP1007"),
        ("DefinitionType=BetaCurve", "DefinitionType=OtherCurve", "IMP1007"),
        ("      LE_Theta=5.0\n", "", "IMP1004"),
        ("HorizDim=PercentMeridional", "HorizDim=Meridional Prime", "IMP1007"),
        ("VertDim=Degree", "VertDim=Radian", "IMP1007"),
        ("Normal To Camber Line", "Tangential", "IMP1007"),
        ("LeadingEdgeEndType=Ellipse", "LeadingEdgeEndType=Square", "IMP1007"),
        ("EllipseAtMean=T", "EllipseAtMean=F", "IMP1004"),
        ("ShrLE_EllipseRatio=2.0", "ShrLE_EllipseRatio=3.0", "IMP1007"),
        ("HubLE_EllipseRatio=2.0", "HubLE_EllipseRatio=0.1", "IMP1007"),
        ("PitchFraction=0.000000000", "PitchFraction=0.1", "IMP1007"),
        ("PitchFraction=0.4500000000", "PitchFraction=1.5", "IMP1002"),
        ("( 100.000000000,30.0", "( 98.000000000,30.0", "IMP1007"),
        ("( 25.000000000,30.0", "( 0.000000000,30.0", "IMP1002"),
        ("( 25.000000000,30.000000000 )", "( 25.000000000,89.500000000 )", "IMP1008"),
        ("( 25.000000000,2.000000000 )", "( 25.000000000,-2.000000000 )", "IMP1002"),
        ("( 25.000000000,2.000000000 )", "( 25.000000000,2,0 )", "IMP1002"),
        ("( 25.000000000,2.000000000 )", "( 25.000000000,2.000000000", "IMP1002"),
        ("( 25.000000000,2.000000000 )", "( 25.000000000,1e400 )", "IMP1002"),
        ("Begin Equations\n", "! late\nBegin Equations\n", "IMP1002"),
        ("Begin Equations\n", "x=1\nBegin Equations\n", "IMP1002"),
        ("Begin Equations\nEnd Equations", "Begin Trim\nEnd Trim", "IMP1007"),
        ("End Equations", "End Equation", "IMP1002"),
        ("Begin LeadingEdgeCut", "Begin TrailingEdgeCut", "IMP1002"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let diags = faults(&[("a.bgi", &changed)], 1, &Options::default());
        assert_eq!(diags[0].code.id(), code, "{to}: {diags:#?}");
        let found = line(&[("a.bgi", &changed)], 1, &Options::default()).2;
        // The line of the change, or that of the section that lacks it or of the end of the curve.
        let at = text[..text.find(from).unwrap()].lines().count();
        assert!(to.is_empty() || found <= at + 40, "{to}: line {found}, not {at}");
    }
}

#[test]
fn a_blade_that_ends_before_it_begins_is_refused() {
    let exchanged = file().replace("LeadingEdgeCurve", "Other").replace("TrailingEdgeCurve", "LeadingEdgeCurve");
    let exchanged = exchanged.replace("Other", "TrailingEdgeCurve");
    let diags = faults(&[("a.bgi", &exchanged)], 1, &Options::default());
    assert!(diags[0].code.id() == "IMP1005" && diags[0].message.contains("before it begins"), "{diags:#?}");
    // A cut behind the trailing edge.
    let cut = file().replace("( 18.000000000,23.500000000 )", "( 38.000000000,38.500000000 )");
    assert_eq!(faults(&[("a.bgi", &cut)], 1, &Options::default())[0].code.id(), "IMP1005");
}

/// The file may be cut off behind each of its lines.
#[test]
fn a_file_that_is_cut_off_is_refused() {
    let text = file();
    let lines: Vec<&str> = text.lines().collect();
    for count in 0..lines.len() {
        let diags = faults(&[("a.bgi", &lines[..count].join("\n"))], 1, &Options::default());
        assert!(["IMP1003", "IMP1004", "IMP1007"].contains(&diags[0].code.id()), "{count}: {diags:#?}");
    }
    let cut = text.split("New Blade\n  PitchFraction=0.45").next().unwrap();
    assert_eq!(line(&[("a.bgi", cut)], 1, &Options::default()).0, "IMP1003");
}

#[test]
fn memory_is_bounded() {
    let deep = "Begin A\n".repeat(100_000);
    assert_eq!(line(&[("a.bgi", &deep)], 1, &Options::default()).0, "IMP1002");
    let many = format!("Begin A\n{}", "x=1\n".repeat(200_000));
    assert_eq!(line(&[("a.bgi", &many)], 1, &Options::default()), ("IMP1006", "a.bgi".to_owned(), 100_001));
    let points = format!("Begin Data\n{}", "( 1,2 )\n".repeat(20_000));
    assert_eq!(line(&[("a.bgi", &points)], 1, &Options::default()).0, "IMP1006");
}
