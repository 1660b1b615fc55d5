//! Leads of lines on blades that begin inside of the part.

use crate::support::{self, jobs};
use impellerc::base::entity::PrimaryMap;
use impellerc::base::units::Mm;
use impellerc::diagnostics::Sink;
use impellerc::ir::OperationKind;
use impellerc::plan::passes::pipeline;
use impellerc::tool_stock::collide::Cutter;
use impellerc::verify::certify;
use impellerc::wheel::method::{AxisMethod, Lines};
use impellerc::wheel::part::SurfaceKind;

/// The lowest line on the pressure face of the splitter touches the hub, which is hollow along its meridian, and the face leans
/// over the hub at its leading edge: an arc along the normal of the face went 0.3 mm into the hub.
#[test]
fn leads_of_a_ball_with_the_radius_of_the_fillet_stay_off_a_hollow_hub() {
    let mut program = jobs::program("splitter", None);
    (program.tools, program.operations) = (PrimaryMap::new(), PrimaryMap::new());
    program.contracts.clear();
    let tool = program.tools.push(support::tool("t1", 1, Cutter::ball(1.5), 20.0, 30.0));
    let splitter = program.part.blade_ids().last().unwrap();
    let kind = OperationKind::Point {
        surfaces: vec![SurfaceKind::Face(splitter.faces()[0])],
        scallop: Mm(0.2),
        lines: Lines::Zigzag,
        milling: None,
        levels: None,
        method: AxisMethod::Blend,
    };
    program.operations.push(support::operation("point", kind, tool, vec![0], 4.0));
    let mut sink = Sink::default();
    let plan = pipeline::run(&program, &mut sink)
        .unwrap_or_else(|_| panic!("{:?}", sink.diags().iter().map(|d| (&d.message, &d.place)).collect::<Vec<_>>()));
    let certificate = certify(&program, &plan.motion, &mut sink).expect("a certificate");
    let gouges = certificate.surfaces.iter().filter(|s| s.surface.starts_with("hub")).map(|s| s.gouge_bound.get());
    let deepest = gouges.fold(0.0, f64::max);
    assert!(deepest <= 0.002, "{deepest}");
}
