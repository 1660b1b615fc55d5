//! Parts whose axis does not stand along Z of the machine: `[part] direction` and `x-direction`.

use crate::machines::{front, with_text};
use crate::support::{self, jobs::Compiled};
use impellerc::base::source::Span;
use impellerc::diagnostics::Sink;
use impellerc::five_axis::Joints;
use impellerc::ir::{Program, RoughingStrategy};
use impellerc::nc;
use impellerc::wheel::control::{Decimals, PathForm};
use nalgebra::{Rotation3, Vector3};

/// A table B along Y on a table that tilts about X from -25 to 135 deg: at A90 the tool stands along B, on the side of -Y.
const AB_TABLE: [(&str, &str); 3] = [
    ("[\"-100 deg\", \"100 deg\"]", "[\"-25 deg\", \"135 deg\"]"),
    ("[axes.C]\ntravel = [\"-180 deg\", \"180 deg\"]", "[axes.B]\ntravel = [\"-9999 deg\", \"9999 deg\"]"),
    ("\"0 mm\", \"0 mm\", \"50 mm\"]", "\"0 mm\", \"-50 mm\", \"0 mm\"]"),
];

/// The machine file with lines behind the origin of the part.
fn ab_table(lines: &str) -> String {
    let origin = "\"0 mm\", \"-50 mm\", \"0 mm\"]\n";
    with_text(&AB_TABLE).replacen(origin, &format!("{origin}{lines}\n"), 1)
}

/// Tip and tool axis in the work frame by the plain turns of A and B, and in the frame of a part along -Y with X along X.
fn by_hand(joints: &Joints) -> [[Vector3<f64>; 2]; 2] {
    let [a, b] = joints.rotary;
    let turned = |v: Vector3<f64>| {
        let tilted = Vector3::new(v.x, a.cos() * v.y - a.sin() * v.z, a.sin() * v.y + a.cos() * v.z);
        Vector3::new(b.cos() * tilted.x + b.sin() * tilted.z, tilted.y, b.cos() * tilted.z - b.sin() * tilted.x)
    };
    let words = [turned(joints.xyz) - Vector3::new(0.0, -50.0, 0.0), turned(Vector3::z())];
    [words, words.map(|v| Vector3::new(v.x, v.z, -v.y))]
}

/// Numbers behind the addresses of a line; none where one is missing.
fn numbers(line: &str, addresses: [&str; 3]) -> Option<Vector3<f64>> {
    let of = |address: &str| line.split(' ').find_map(|word| word.strip_prefix(address)?.parse::<f64>().ok());
    let [x, y, z] = addresses.map(of);
    Some(Vector3::new(x?, y?, z?))
}

/// The first six numbers of a GOTO.
fn goto(line: &str) -> Option<[Vector3<f64>; 2]> {
    let all: Vec<f64> = line.strip_prefix("GOTO/")?.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    (all.len() >= 6).then(|| [Vector3::from_row_slice(&all[..3]), Vector3::from_row_slice(&all[3..6])])
}

#[test]
fn a_wheel_on_a_table_along_y_is_cut_in_every_dialect() {
    let (program, outcome) = front("ab-table", &ab_table("direction = [0, -1, 0]"));
    let program = program.unwrap_or_else(|| panic!("{:?}", outcome.sink.diags()));
    assert!(
        impellerc::ir::print::program(&program).contains("  Z of the part along (0.0000, -1.0000, 0.0000), X along")
    );
    let compiled = Compiled::new(program);
    for dialect in ["siemens-840d", "heidenhain", "fanuc", "apt-cl"] {
        let program = support::with_post(dialect, &compiled.program);
        let post = nc::find(dialect).unwrap();
        let nc = nc::emit(post, &program, &compiled.motion, &[]);
        let text = nc.text();
        nc::read_back(post, &program, &compiled.motion, &text).unwrap_or_else(|d| panic!("{dialect}: {d:?}"));
        // What `verify` takes from the text is the motion.
        let mut sink = Sink::default();
        let read = nc::judge(post, &program, &text, &|_| Span::default(), &mut sink).unwrap().motion.motion;
        assert!(!sink.has_errors(), "{dialect}: {:?}", sink.diags());
        for (read, meant) in read.operations.iter().zip(&compiled.motion.operations) {
            assert_eq!(read.moves.len(), meant.moves.len(), "{dialect}");
            for (r, m) in read.moves.iter().zip(&meant.moves) {
                assert!((r.joints.xyz - m.joints.xyz).amax() < 0.01, "{dialect}: {r:?} {m:?}");
            }
        }
        // The words, by the plain turns of the axes.
        let mut compared = 0;
        for line in &nc.lines {
            let Some((operation, index)) = line.source else { continue };
            let joints = compiled.motion.operations[operation as usize].moves[index as usize].joints;
            let [words, part] = by_hand(&joints);
            let pose = program.machine.forward(&joints);
            assert!((pose.tip.coords - part[0]).amax() < 1e-9 && (pose.axis - part[1]).amax() < 1e-9);
            let said = match dialect {
                "siemens-840d" => {
                    let axis = numbers(&line.text, ["A3=", "B3=", "C3="]);
                    numbers(&line.text, ["X", "Y", "Z"]).zip(axis).map(|(tip, axis)| ([tip, axis], words))
                }
                "apt-cl" => goto(&line.text).map(|said| (said, part)),
                _ => None,
            };
            let Some((said, due)) = said else { continue };
            assert!((said[0] - due[0]).amax() < 6e-5 && (said[1] - due[1]).amax() < 1e-7, "{}: {due:?}", line.text);
            compared += 1;
        }
        assert!(compared > 2000 || !["siemens-840d", "apt-cl"].contains(&dialect), "{dialect}: {compared}");
        // Words of a control follow from the joints alone, poses of CL data from where the part is.
        let mut other = program.clone();
        other.machine.chain = other.machine.chain.with_part(Rotation3::identity());
        let head =
            nc::assumptions(post, &program).iter().any(|line| line.contains("Z of the part points along (0, -1, 0)"));
        assert_eq!(head, dialect != "apt-cl");
        let foreign = nc::read_back(post, &other, &compiled.motion, &text);
        assert_eq!(foreign.is_ok(), dialect != "apt-cl", "{foreign:?}");
    }
}

/// Polynomials and short words are turned too: the text says the motion that was proved.
#[test]
fn splines_and_few_digits_of_a_turned_part_read_back() {
    let turned = |dialect: &str| {
        let mut program = support::program_for(dialect, &support::flank_only(&[0]));
        program.machine.chain = program.machine.chain.with_part(Rotation3::from_euler_angles(0.05, -0.05, 0.7));
        program
    };
    let text = |program: Program| {
        let compiled = Compiled::new(program);
        let post = nc::find(&compiled.program.post.dialect).unwrap();
        let text = nc::emit(post, &compiled.program, &compiled.motion, &[]).text();
        nc::read_back(post, &compiled.program, &compiled.motion, &text).unwrap();
        let splines = compiled.motion.operations.iter().map(|o| o.splines.len()).sum::<usize>();
        (text, splines)
    };
    let mut program = turned("siemens-840d");
    program.post.control.path = PathForm::Splines;
    let (siemens, splines) = text(program);
    assert!(splines > 0 && siemens.contains("POLY"), "{splines}");
    let mut program = turned("fanuc");
    program.post.control.decimals = Decimals { length: 3, angle: 3, vector: 6, feed: 0 };
    assert!(program.post.control.decimals.is_coarse(program.post.control.orientation));
    text(program);
}

/// A wheel across its table is not what anybody means without saying so, and what the help says is accepted.
#[test]
fn a_part_across_its_table_is_refused_unless_stated() {
    let (program, outcome) = front("ab-table", &ab_table(""));
    let told = outcome.sink.diags().iter().find(|d| d.message.contains("across the axis B")).unwrap();
    assert!(program.is_none() && told.code.id() == "IMP0217", "{told:?}");
    let help = told.help.clone().unwrap();
    let stated: Vec<&str> = help.split('`').filter(|text| text.starts_with("direction = ")).collect();
    assert_eq!(stated, ["direction = [0, -1, 0]", "direction = [0, 0, 1]"]);
    for lines in stated {
        let (program, outcome) = front("ab-table", &ab_table(lines));
        assert!(program.is_some(), "{lines}: {:?}", outcome.sink.diags());
    }
    // Where A turns the other way the tool stands on the other side.
    let opposite = ab_table("").replacen("sense = \"iso\"", "sense = \"opposite\"", 1);
    let (_, outcome) = front("ab-table", &opposite);
    let told = outcome.sink.diags().iter().find(|d| d.message.contains("across the axis B")).unwrap();
    assert!(told.help.as_ref().unwrap().contains("`direction = [0, 1, 0]` for a part on the table B"), "{told:?}");
    // A head of two axes has no table, and a table that was measured a little oblique carries its part along its axis.
    let head = [("\"table-table\"", "\"head-head\"")];
    assert!(front("head", &with_text(&head)).0.is_some());
    let oblique = [("[axes.C]", "[axes.C]\ndirection = [0.0003, 0, 1]")];
    assert!(front("oblique", &with_text(&oblique)).0.is_some());
}

/// The proof knows a table about the axis of the part. Another one is no table that it would overlook.
#[test]
fn a_table_that_the_proof_does_not_know_is_refused() {
    let table =
        "\n[table]\ntop = \"10 mm\"\nsection = [{ length = \"20 mm\", upper = \"100 mm\", lower = \"100 mm\" }]\n";
    let with_table = |lines: &str| front("ab-table", &format!("{}{table}", ab_table(lines)));
    let (program, outcome) = with_table("direction = [0, -1, 0]");
    let program = program.unwrap_or_else(|| panic!("{:?}", outcome.sink.diags()));
    // Its top counts along the axis of the part, on which the part lies 50 mm up.
    assert_eq!(program.machine.carried[0].profile[0], [0.0, -40.0]);
    for lines in ["direction = [0, 0, 1]", "direction = [0, -1, 1]"] {
        let (program, outcome) = with_table(lines);
        let told = outcome.sink.diags().iter().any(|d| d.message.contains("oblique to its table"));
        assert!(program.is_none() && told, "{lines}: {:?}", outcome.sink.diags());
    }
}

#[test]
fn directions_of_the_part_are_judged_and_have_a_zero() {
    let cases = [
        ("direction = [0, 0, 0]", "`direction` of the part is no direction"),
        ("direction = [0, -1, 0]\nx-direction = [0, 0, 0]", "`x-direction` of the part is no direction"),
        ("x-direction = [0, 1, 0]", "across the axis B"),
        ("direction = [0, -1, 0]\nx-direction = [1, 1, 0]", "`x-direction` is 135 deg from the axis of the part"),
    ];
    for (lines, words) in cases {
        let (program, outcome) = front("odd", &ab_table(lines));
        let told = outcome.sink.diags();
        assert!(program.is_none() && told.iter().any(|d| d.message.contains(words)), "{words}: {told:?}");
    }
    // X of the part where the file does not say it: along X of the machine as far as possible.
    let zeros = [
        ("direction = [0, -1, 0]", [1.0, 0.0, 0.0]),
        ("direction = [0, 2, 0]", [1.0, 0.0, 0.0]),
        ("direction = [1, 0, 0]", [0.0, 0.0, -1.0]),
        ("direction = [-1, 0, 0]", [0.0, 0.0, 1.0]),
        ("direction = [3, 0, 4]", [0.8, 0.0, -0.6]),
        ("direction = [0, -1, 0]\nx-direction = [0, 0, 5]", [0.0, 0.0, 1.0]),
        ("direction = [0, 0, 1]\nx-direction = [0, 1, 0]", [0.0, 1.0, 0.0]),
    ];
    for (lines, x) in zeros {
        let (program, outcome) = front("turned", &ab_table(lines));
        let program = program.unwrap_or_else(|| panic!("{lines}: {:?}", outcome.sink.diags()));
        let [of_x, of_y, of_z] = program.machine.part_directions();
        assert!((of_x - Vector3::from(x)).amax() < 1e-12, "{lines}: {of_x}");
        assert!((of_x.cross(&of_y) - of_z).amax() < 1e-12 && (of_z.norm() - 1.0).abs() < 1e-12, "{lines}");
    }
}

/// A part that is clamped the wrong way round is told with the direction that the tool reaches.
#[test]
fn a_part_that_is_reached_from_below_alone_is_told() {
    let (program, _) = front("ab-table", &ab_table("direction = [0, 1, 0]"));
    let mut program = program.unwrap();
    assert_eq!(program.machine.reached_from_below(), Some(Vector3::new(0.0, -1.0, 0.0)));
    let groove = program
        .operations
        .iter()
        .find(|(_, o)| matches!(o.kind.strategy(), Some(RoughingStrategy::Groove { .. })))
        .unwrap()
        .1
        .clone();
    program.operations = impellerc::base::entity::PrimaryMap::new();
    program.operations.push(groove);
    let mut sink = Sink::default();
    assert!(impellerc::plan::passes::pipeline::run(&program, &mut sink).is_err());
    let told = sink.diags().iter().any(|d| d.notes.iter().any(|note| note.contains("`[part] direction = [0, -1, 0]`")));
    assert!(told, "{:?}", sink.diags());
}
