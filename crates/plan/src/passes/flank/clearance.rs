//! Limits of a flank milling path apart from the surface itself: clearance of shank and holder, travel of rotary axis
//! 1.

use crate::passes::context::{Obstacles, STATIONS};
use axes::envelope::Target;
use axes::envelope::target::{LEVER, Of};
use ir::{OperationId, Program};
use nalgebra::{Point3, Vector3};
use nurbs::DualCurve;
use rayon::prelude::*;
use tool_stock::collide::Section;
use tool_stock::collide::tool::tool_coordinates;
use wheel::contract::Guarded;

/// Stations of a path that are checked: as many as its pass has contacts.
const CHECKED_STATIONS: usize = STATIONS;

/// Stations of a lead that are checked.
const LINE_STATIONS: usize = 30;

/// Reserve beyond each clearance, for places between samples and between stations, mm.
const RESERVE_MM: f64 = 0.05;

/// Reserve of the travel of rotary axis 1, radians: of a path that is checked at all of its stations.
const TILT_RESERVE: f64 = 1e-3;

/// Points with less than this distance to their limit join the bounds of the path, mm: about as far as a change of the
/// path moves a point.
const NEAR: f64 = 1.0;

/// Ratio by which these bounds give way further than the bounds on the face during the search. They may be violated by much
/// at first; when the bounds on the face hold, these hold as well.
const GIVE_RATIO: f64 = 100.0;

/// Clearances and travel of an operation.
pub(crate) struct Clearances<'a> {
    obstacles: &'a Obstacles,
    /// Shank and holder with the clearance of each section, mm.
    body: Vec<(Section, f64)>,
    /// Largest angle between tool axis and Z, radians.
    max_tilt: f64,
}

/// Result of a check of a path.
pub(crate) struct ClearanceCheck {
    /// True where all clearances and the travel are kept.
    pub(crate) kept: bool,
    /// Points near their limit, as bounds.
    pub(crate) near: Vec<Target>,
}

impl<'a> Clearances<'a> {
    pub(crate) fn new(program: &Program, operation: OperationId, obstacles: &'a Obstacles) -> Self {
        let solid = &program.tools[program.operations[operation].tool].solid;
        let required = |body: Guarded| program.required_clearance(body).unwrap_or(0.0).max(program.clearance.get());
        let [shank, holder] = [Guarded::Shank, Guarded::Holder].map(required);
        let shank = solid.shank.iter().map(|s| (*s, shank));
        let body = shank.chain(solid.holder.iter().map(|s| (*s, holder))).collect();
        Self { obstacles, body, max_tilt: program.machine.max_tilt() - TILT_RESERVE }
    }

    /// Shank and holder with the clearance of each section, mm.
    pub(crate) fn body(&self) -> &[(Section, f64)] {
        &self.body
    }

    /// Distance of shank and holder from a point in tool coordinates, less the clearance, mm.
    fn spare(&self, rho: f64, s: f64) -> f64 {
        self.body.iter().map(|(section, required)| section.distance(rho, s) - required).fold(f64::INFINITY, f64::min)
    }

    /// True when shank and holder are clear while the tool moves along a line.
    pub(crate) fn kept_on(&self, [from, to]: &[Point3<f64>; 2], axis: &Vector3<f64>) -> bool {
        let stations = (0..=LINE_STATIONS).map(|i| from + (to - from) * (i as f64 / LINE_STATIONS as f64));
        let clear =
            |tip: Point3<f64>| self.obstacles.nearest(&tip, axis, |rho, s| self.spare(rho, s), 0.0).next().is_none();
        stations.into_iter().all(clear)
    }

    /// Points near shank and holder along a path, and stations where the tilt of the axis is near the travel of rotary
    /// axis 1.
    pub(crate) fn found(&self, path: &DualCurve) -> ClearanceCheck {
        let station = |i: usize| {
            let t = i as f64 / CHECKED_STATIONS as f64;
            let at = path.at(t);
            let bodies = self.obstacles.nearest(&at.lower, &at.axis, |rho, s| self.spare(rho, s), NEAR);
            let bodies = bodies.map(move |(spare, point): (f64, Point3<f64>)| {
                let (rho, s) = tool_coordinates(&point, &at.lower, &at.axis);
                // The samples make the distance of an obstacle too large by this amount.
                let unseen = self.spare(rho, s) - spare;
                (spare, Target { of: Of::Body, give: [GIVE_RATIO; 2], ..Target::clear(point, unseen + RESERVE_MM) })
            });
            let tilt = LEVER * (self.max_tilt - libm::atan2(libm::hypot(at.axis.x, at.axis.y), at.axis.z));
            let of = Of::Tilt { t, most: self.max_tilt };
            let tilt =
                (tilt < NEAR).then(|| (tilt, Target { of, give: [GIVE_RATIO; 2], ..Target::clear(at.lower, 0.0) }));
            bodies.chain(tilt).collect::<Vec<_>>()
        };
        let found: Vec<(f64, Target)> = (0..=CHECKED_STATIONS).into_par_iter().flat_map_iter(station).collect();
        ClearanceCheck { kept: found.iter().all(|x| x.0 >= 0.0), near: found.into_iter().map(|x| x.1).collect() }
    }
}
