//! Placements of assemblies: parts that stand in other parts, once or several times.

use super::step_wheel::{WHEEL, five};
use super::{faults, good, noted};
use impellerc::blade::SectionForm;
use impellerc::blade_files::{Imported, Options};
use nalgebra::{Point3, Rotation3, Vector3};

/// The wheel of planes and cylinders with its hub in one part and its blade in another one. `rest` relates the representations: #9003
/// has the hub, #9006 the blade, #9010 is the whole. #9100 is the placement of parts in their own frame; those from #9200 on are
/// turned about Z by fifths and moved.
fn assembly(rest: &str) -> String {
    let number = |words: &str| {
        let line = WHEEL.lines().find(|line| line.contains(words)).unwrap();
        line.split('=').next().unwrap().to_owned()
    };
    let blade = ["vane 1 pressure face", "vane 1 suction face", "vane 1 inlet edge"].map(number).join(",");
    let mut text = format!(
        "#9001=OPEN_SHELL('',({}));\n#9002=SHELL_BASED_SURFACE_MODEL('',(#9001));\n\
         #9003=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#9100,#9002),#3);\n\
         #9004=OPEN_SHELL('',({blade}));\n#9005=SHELL_BASED_SURFACE_MODEL('',(#9004));\n\
         #9006=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#9100,#9005),#3);\n\
         #9007=SHAPE_REPRESENTATION('',(#9100),#3);\n#9008=SHAPE_REPRESENTATION('',(#9100),#3);\n\
         #9090=CARTESIAN_POINT('',(0.,0.,0.));\n#9100=AXIS2_PLACEMENT_3D('',#9090,$,$);\n",
        number("hub of channel 1")
    );
    for k in 0..5 {
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 5.0).sin_cos();
        let at = 9200 + 10 * k;
        text += &format!(
            "#{}=DIRECTION('',(0.,0.,1.));\n#{}=DIRECTION('',({cos:.15},{sin:.15},0.));\n\
             #{}=CARTESIAN_POINT('',(7.,8.,9.));\n#{at}=AXIS2_PLACEMENT_3D('',#{},#{},#{});\n",
            at + 1,
            at + 2,
            at + 3,
            at + 3,
            at + 1,
            at + 2
        );
    }
    let (head, tail) = WHEEL.rsplit_once("ENDSEC;").unwrap();
    format!("{head}{text}{rest}ENDSEC;{tail}")
}

/// The relationship by which a representation stands in another one at a placement.
fn stands(number: u32, child: u32, parent: u32, placement: u32) -> String {
    format!(
        "#{number}=(REPRESENTATION_RELATIONSHIP('','',#{child},#{parent}) \
         REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{}) SHAPE_REPRESENTATION_RELATIONSHIP());\n\
         #{}=ITEM_DEFINED_TRANSFORMATION('','',#9100,#{placement});\n",
        number + 1,
        number + 1
    )
}

fn points(imported: &Imported) -> Vec<Point3<f64>> {
    let sections = imported.rows[0].blades[0].sections.iter();
    let faces = sections.map(|section| match &section.form {
        SectionForm::Faces(faces) => faces.concat(),
        _ => panic!("no faces"),
    });
    faces.flatten().collect()
}

fn read(rest: &str) -> Imported {
    good(&[("a.step", &assembly(rest))], 1, &five())
}

/// Largest distance from the points of the wheel without an assembly, turned by fifths.
fn off(made: &Imported, fifths: f64) -> f64 {
    let due = good(&[("a.step", WHEEL)], 1, &five());
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), fifths * std::f64::consts::TAU / 5.0);
    let (made, due) = (points(made), points(&due));
    assert_eq!(made.len(), due.len());
    made.iter().zip(&due).map(|(p, q)| nalgebra::distance(p, &(turn * q))).fold(0.0, f64::max)
}

/// A wheel that stands somewhere as a whole is the same wheel: it is read in the frame of the part that has the hub.
#[test]
fn a_wheel_may_stand_anywhere() {
    let both = stands(9300, 9003, 9007, 9210) + &stands(9310, 9006, 9007, 9210);
    let twice = both.clone() + &stands(9320, 9007, 9008, 9230);
    let same =
        format!("{}#9350=SHAPE_REPRESENTATION_RELATIONSHIP('','',#9006,#9003);\n", stands(9300, 9003, 9007, 9220));
    for rest in ["", &both, &twice, &same] {
        let made = read(rest);
        assert!(off(&made, 0.0) < 1e-6, "{rest} {}", off(&made, 0.0));
        assert_eq!(noted(&made, "its part stands in an assembly"), !rest.is_empty());
    }
}

/// Parts that stand differently are placed against each other, by relationships and as mapped items.
#[test]
fn parts_are_placed_against_each_other() {
    let hub = stands(9300, 9003, 9007, 9210);
    assert!(off(&read(&(hub.clone() + &stands(9310, 9006, 9007, 9230))), 2.0) < 1e-6);
    let mapped = "#9400=REPRESENTATION_MAP(#9100,#9006);\n#9401=MAPPED_ITEM('',#9400,#9240);\n\
                  #9402=SHAPE_REPRESENTATION('',(#9401),#3);\n#9403=SHAPE_REPRESENTATION_RELATIONSHIP('','',#9402,#9007);\n";
    assert!(off(&read(&(hub + mapped)), 3.0) < 1e-6);
}

/// A blade that stands five times at equal angles is counted.
#[test]
fn places_of_a_blade_are_counted() {
    let hub = stands(9300, 9003, 9007, 9200);
    let blades: String = (0..5).map(|k| stands(9310 + 10 * k, 9006, 9007, 9200 + 10 * k)).collect();
    let made = good(&[("a.step", &assembly(&(hub + &blades)))], 1, &Options::default());
    assert_eq!(made.rows[0].count, 5);
    assert!(noted(&made, "its part stands at 5 places of an assembly; the first one counts"), "{:?}", made.notes);
    assert!(off(&made, 0.0) < 1e-6);
}

/// Parts that nothing places against each other are refused: here the blade belongs to no assembly.
#[test]
fn parts_without_a_common_whole_are_refused() {
    let file = assembly(&stands(9300, 9003, 9007, 9210));
    let fault = &faults(&[("a.step", &file)], 1, &five())[0];
    assert_eq!((fault.code.id(), fault.message.contains("no assembly")), ("IMP1007", true), "{fault:?}");
}

/// Placements that are not read, and assemblies without an end, are refused with their line.
#[test]
fn what_is_no_placement_is_refused() {
    let operator = "#9300=(REPRESENTATION_RELATIONSHIP('','',#9006,#9007) REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#9301) \
                    SHAPE_REPRESENTATION_RELATIONSHIP());\n\
                    #9301=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,$,$,#9090,2.,$);\n";
    let round = stands(9300, 9006, 9007, 9200) + &stands(9310, 9007, 9006, 9200);
    let deep: String =
        (0..10).map(|k| stands(9300 + 10 * k, if k == 0 { 9006 } else { 9500 + k }, 9501 + k, 9200)).collect();
    let levels: String = (1..=10).map(|k| format!("#{}=SHAPE_REPRESENTATION('',(#9100),#3);\n", 9500 + k)).collect();
    for (rest, due) in [(operator.to_owned(), "#9301="), (round, "ITEM_DEFINED"), (deep + &levels, "ITEM_DEFINED")] {
        let file = assembly(&rest);
        let fault = &faults(&[("a.step", &file)], 1, &five())[0];
        assert_eq!(fault.code.id(), "IMP1007", "{fault:?}");
        let at = fault.labels[0].span.range();
        let line = file[..at.start].rsplit('\n').next().unwrap().to_owned() + &file[at];
        assert!(line.contains(due), "{line}");
    }
}
