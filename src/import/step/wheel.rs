//! Blades, hub and shroud of a wheel from its picked faces.

use super::copies;
use super::face::StepFace;
use super::fitted::{self, FittedSections};
use super::meridian::{self, StepMeridian, flat};
use super::picks::{ListedFace, PickedFaces, missing};
use super::placement::StepGeometry;
use super::sheet::StepSheet;
use crate::diag::Diag;
use crate::diag::codes::import as codes;
use crate::geom::interpolate;
use crate::import::found::Found;
use crate::import::stated::Asked;
use crate::import::{Axis, BladeSurfaces, FaceRole, Handedness, Imported, ImportedBlade, ImportedRow, Options};
use crate::sections::{Section, SectionForm};
use crate::source::{Span, Spanned};
use crate::units::trim;
use nalgebra::{Point3, Vector2};

/// Largest distance of a surface of revolution from its meridian, mm.
const REVOLVED: f64 = 0.02;

/// Largest sine between the normal of a surface of revolution and its meridian plane: 0.6 deg.
const ACROSS: f64 = 0.01;

/// Largest distance of an end of a blade from the straight line between the ends of hub and shroud in the meridian plane, mm: the
/// lathe makes such an edge.
const STRAIGHT: f64 = 0.02;

/// Radii of both ends of a blade are different where their ratio is below this.
const SMALLER: f64 = 0.95;

/// Points of a side of a face.
const SIDE_STEPS: usize = 64;

/// Hub and shroud between the ends of the blade.
struct WheelEnds {
    /// Points (r, z) from inlet to outlet, mm.
    hub: Vec<[f64; 2]>,
    shroud: Vec<[f64; 2]>,
    /// Largest distance of the faces from them, mm.
    extend: f64,
}

/// A wheel that is read.
pub(super) struct StepWheel<'a, 't> {
    pub(super) geometry: StepGeometry<'a, 't>,
    pub(super) faces: &'a [ListedFace<'t>],
    pub(super) picked: &'a PickedFaces,
    pub(super) options: &'a Options,
    /// The end of the file.
    pub(super) end: Span,
}

impl StepWheel<'_, '_> {
    fn all(&self, role: FaceRole) -> Result<Vec<StepFace>, Diag> {
        self.picked.of(role).into_iter().map(|k| self.geometry.face(&self.faces[k].entity)).collect()
    }

    fn one(&self, role: FaceRole) -> Result<Option<StepFace>, Diag> {
        let k = self.picked.only(role, self.faces)?;
        k.map(|k| self.geometry.face(&self.faces[k].entity)).transpose()
    }

    fn required(&self, role: FaceRole) -> Result<StepFace, Diag> {
        self.one(role)?.ok_or_else(|| missing(self.faces, role, self.end))
    }

    /// The wheel.
    ///
    /// # Errors
    /// A role without a face, a face that is not what its role demands, a fact that nothing tells.
    pub(super) fn read(&self, found: &mut Found) -> Result<Imported, Diag> {
        let hub_faces = self.all(FaceRole::Hub)?;
        if hub_faces.is_empty() {
            return Err(missing(self.faces, FaceRole::Hub, self.end));
        }
        let blade = [self.required(FaceRole::Pressure)?, self.required(FaceRole::Suction)?];
        let axis = self.axis(&hub_faces, found)?;
        let turned = move |p: &Point3<f64>| Point3::from(axis.to_z(p.coords.into()));
        let (hub, spread) = meridian::of_faces(&hub_faces, turned)?;
        self.revolved(&hub_faces, spread, &turned, found)?;
        let hub = self.run_from_inlet(hub, &blade, &turned, found)?;
        let count = self.count(&blade[0], &turned, found)?;
        let along = |p: &Point3<f64>| hub.nearest(&flat(&turned(p)))[0];
        let above = |p: &Point3<f64>| hub.nearest(&flat(&turned(p)))[1];
        let [pressure, suction] = &blade;
        let sheets = [StepSheet::new(pressure, above, along)?, StepSheet::new(suction, above, along)?];
        for (sheet, face) in sheets.iter().zip(&blade) {
            let gap = trim(1e3 * sheet.apart, 2);
            found.note(
                face.span,
                format!("#{} `{}`: its edges lie within {gap} um of its surface", face.number, face.name),
            );
        }
        let WheelEnds { hub, shroud, extend } = self.ends(&hub, &sheets, &blade, &turned, found)?;
        let fitted = fitted::sections(&sheets, &turned).ok_or_else(|| {
            Diag::error(codes::NOT_READ, "no surface goes through the points of a face")
                .label(pressure.span, format!("#{}", pressure.number))
                .label(suction.span, format!("#{}", suction.number))
                .help("look at these faces in the program that wrote them: a side has no length")
        })?;
        let distance = trim(1e3 * fitted.distance, 2);
        found.note(pressure.span, format!("faces of the job lie within {distance} um of those of the file"));
        found.note(None, format!("faces of the job lie within {distance} um of those of the file where compared"));
        let lofted = fitted.rows.len() > 2;
        let blade = ImportedBlade { name: "main".to_owned(), ..sections(fitted, pressure.span) };
        Ok(Imported {
            hub: Some(hub),
            shroud: Some(shroud),
            rows: vec![ImportedRow { name: String::new(), count, blades: vec![blade] }],
            surfaces: if lofted { BladeSurfaces::Lofted { extend } } else { BladeSurfaces::Ruled { extend } },
            ..Imported::default()
        })
    }

    /// The axis about which the hub is turned: the one that the caller states, or the only one that it can be.
    fn axis(&self, hub: &[StepFace], found: &mut Found) -> Result<Axis, Diag> {
        let span = hub.first().map_or(self.end, |face| face.span);
        let spread = |axis: Axis| {
            let turned = move |p: &Point3<f64>| Point3::from(axis.to_z(p.coords.into()));
            meridian::of_faces(hub, turned).map_or(f64::INFINITY, |(_, spread)| spread)
        };
        let spreads = [Axis::X, Axis::Y, Axis::Z].map(|axis| (axis, spread(axis)));
        let fits: Vec<Axis> = spreads.iter().filter(|(_, s)| *s <= REVOLVED).map(|(axis, _)| *axis).collect();
        let told = || spreads.map(|(axis, s)| format!("{} mm about {axis}", trim(s, 3))).join(", ");
        match (self.options.axis, fits.as_slice()) {
            (Some(axis), fits) if fits.contains(&axis) => {
                found.note(None, format!("the axis of rotation is {axis}, by `--axis`"));
                Ok(axis)
            }
            (Some(axis), _) => {
                Err(Diag::error(codes::CONTRADICTS, format!("the hub is not turned about {axis}, as `--axis` says"))
                    .label(span, format!("its borders lie off one meridian by {}", told()))
                    .help("leave out `--axis`, or pick another face as hub"))
            }
            (None, [axis]) => {
                found.note(span, format!("the axis of rotation is {axis}: the hub is turned about it alone"));
                Ok(*axis)
            }
            (None, []) => Err(Diag::error(codes::NOT_READ, "the hub is turned about no axis of the file")
                .label(span, format!("its borders lie off one meridian by {}", told()))
                .help("pick other faces as hub, or export the wheel with its axis as x, y or z through the origin")),
            (None, _) => Err(Diag::error(codes::NOT_STATED, "the hub can be turned about several axes")
                .label(span, format!("its borders lie off one meridian by {}", told()))
                .help("state `--axis`: x, y or z")),
        }
    }

    /// Refuses a hub whose surfaces are not turned about the axis, and says how near they are.
    fn revolved(
        &self,
        hub: &[StepFace],
        spread: f64,
        turned: &dyn Fn(&Point3<f64>) -> Point3<f64>,
        found: &mut Found,
    ) -> Result<(), Diag> {
        /// Of the points of borders, one in so many is checked.
        const CHECKED: usize = 64;
        let mut most = 0.0_f64;
        for face in hub {
            let mut near = None;
            for p in face.borders.iter().flatten().flat_map(|edge| edge.iter().step_by(CHECKED)) {
                let (place, far) = face.surface.nearest(p, near);
                near = if far < REVOLVED { Some(place) } else { None };
                let normal = face.surface.at(place).normal().map(|n| turned(&Point3::from(n)).coords);
                let at = turned(p);
                let radius = libm::hypot(at.x, at.y);
                let sine = normal.map_or(0.0, |n| (n.y * at.x - n.x * at.y) / radius.max(f64::MIN_POSITIVE));
                most = most.max(sine.abs());
                if sine.abs() > ACROSS {
                    return Err(Diag::error(
                        codes::NOT_READ,
                        format!("the face #{} is no hub: it is not turned about the axis", face.number),
                    )
                    .label(
                        face.span,
                        format!(
                            "its normal leaves the meridian plane by {} deg",
                            trim(libm::asin(sine.abs()).to_degrees(), 2)
                        ),
                    )
                    .help("pick the faces of the hub between the blades, without fillets"));
                }
            }
        }
        let at = hub.first().map_or(self.end, |face| face.span);
        found.note(
            at,
            format!(
                "the hub is a surface of revolution within {} um; its normals leave the meridian plane by at most {} deg",
                trim(1e3 * spread, 2),
                trim(libm::asin(most).to_degrees(), 4)
            ),
        );
        Ok(())
    }

    /// The meridian of the hub from inlet to outlet: by an edge that was picked, otherwise the end of the blade nearer to the axis
    /// is the inlet.
    fn run_from_inlet(
        &self,
        hub: StepMeridian,
        blade: &[StepFace; 2],
        turned: &dyn Fn(&Point3<f64>) -> Point3<f64>,
        found: &mut Found,
    ) -> Result<StepMeridian, Diag> {
        let points = |face: &StepFace| -> Vec<Vector2<f64>> {
            face.borders
                .iter()
                .flatten()
                .flat_map(|edge| edge.iter().step_by(SIDE_STEPS))
                .map(|p| flat(&turned(p)))
                .collect()
        };
        let mean = |face: &StepFace| {
            let points = points(face);
            points.iter().map(|p| hub.nearest(p)[0]).sum::<f64>() / points.len().max(1) as f64
        };
        let middle = 0.5 * (mean(&blade[0]) + mean(&blade[1]));
        let inlet = self.one(FaceRole::Inlet)?.map(|face| (mean(&face) < middle, face));
        let outlet = self.one(FaceRole::Outlet)?.map(|face| (mean(&face) > middle, face));
        match (inlet, outlet) {
            (Some((a, inlet)), Some((b, outlet))) if a != b => {
                Err(Diag::error(codes::CONTRADICTS, "the edges at inlet and outlet are at one end of the blade")
                    .label(inlet.span, format!("#{} is the inlet edge", inlet.number))
                    .label(outlet.span, format!("#{} is the outlet edge", outlet.number))
                    .help("pick other edges with `--face inlet=` and `--face outlet=`"))
            }
            (Some((forward, face)), _) | (None, Some((forward, face))) => {
                found.note(face.span, format!("#{} `{}` tells the inlet", face.number, face.name));
                Ok(if forward { hub } else { hub.reversed() })
            }
            (None, None) => {
                let places: Vec<[f64; 2]> = blade.iter().flat_map(points).map(|p| [hub.nearest(&p)[0], p.x]).collect();
                let by = |a: &&[f64; 2], b: &&[f64; 2]| a[0].total_cmp(&b[0]);
                let ends = places.iter().min_by(by).zip(places.iter().max_by(by));
                let [first, last] = ends.map_or([0.0; 2], |(a, b)| [a[1], b[1]]);
                if first.min(last) >= SMALLER * first.max(last) {
                    return Err(Diag::error(codes::NOT_STATED, "nothing tells at which end of the blade the inlet is")
                        .label(
                            blade[0].span,
                            format!("its ends have the radii {} and {} mm", trim(first, 3), trim(last, 3)),
                        )
                        .help("state `--face inlet=#NUMBER`: a face at the inlet, such as the edge of the blade"));
                }
                found.note(
                    blade[0].span,
                    format!(
                        "the end of the blade at the radius {} mm is taken for the inlet, the one at {} mm for the outlet; `--face inlet=` says otherwise",
                        trim(first.min(last), 3),
                        trim(first.max(last), 3)
                    ),
                );
                Ok(if first < last { hub } else { hub.reversed() })
            }
        }
    }

    /// Number of blades: that of equal copies of the pressure face about the axis, or the one that the caller states.
    fn count(
        &self,
        face: &StepFace,
        turned: &dyn Fn(&Point3<f64>) -> Point3<f64>,
        found: &mut Found,
    ) -> Result<u32, Diag> {
        let kind = self.faces.iter().find(|f| f.entity.number == face.number).map(|f| f.surface.as_str());
        let alike = |f: &&ListedFace<'_>| Some(f.surface.as_str()) == kind && f.entity.number != face.number;
        // A face of another kind than those that are read is no copy.
        let others: Vec<StepFace> =
            self.faces.iter().filter(alike).filter_map(|f| self.geometry.face(&f.entity).ok()).collect();
        let counted = copies::count(face, &others, turned);
        if counted.is_some() {
            found.note(
                face.span,
                "the blades are counted: the file has equal copies of the pressure face at equal angles",
            );
        }
        let mut asked = Asked::of(self.options, found, self.end);
        let count = asked.blades(counted.map(|n| Spanned::new(n, face.span)))?;
        asked.handedness(Some(Spanned::new(Handedness::Right, self.end)))?;
        asked.end()?;
        Ok(count)
    }

    /// Points of hub and shroud between the ends of the blade, and how far the faces are to be extended to them, mm.
    fn ends(
        &self,
        hub: &StepMeridian,
        sheets: &[StepSheet; 2],
        blade: &[StepFace; 2],
        turned: &dyn Fn(&Point3<f64>) -> Point3<f64>,
        found: &mut Found,
    ) -> Result<WheelEnds, Diag> {
        let row = |sheet: &StepSheet, t: f64| -> Vec<Vector2<f64>> {
            sheet.row(t, 8 * SIDE_STEPS).iter().map(|p| flat(&turned(p))).collect()
        };
        let shroud_faces = self.all(FaceRole::Shroud)?;
        let shroud = if shroud_faces.is_empty() {
            found.note(
                blade[0].span,
                "the shroud goes through the tip of the pressure face: no face is picked as shroud",
            );
            StepMeridian::new(row(&sheets[0], 1.0))
        } else {
            let (shroud, spread) = meridian::of_faces(&shroud_faces, turned)?;
            self.revolved(&shroud_faces, spread, turned, found)?;
            let [first, last] = [0.0, 1.0].map(|s| shroud.nearest(&flat(&turned(&sheets[0].jet(s, 1.0).point)))[0]);
            Some(if first < last { shroud } else { shroud.reversed() })
        };
        let Some(shroud) = shroud else {
            return Err(Diag::error(codes::NOT_READ, "the tip of the pressure face has no length")
                .label(blade[0].span, "this face")
                .help("pick another face"));
        };
        let mut gaps = [0.0_f64; 2];
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for sheet in sheets {
            for (k, line) in [hub, &shroud].into_iter().enumerate() {
                let points = row(sheet, k as f64);
                gaps[k] = points.iter().map(|p| line.nearest(p)[1]).fold(gaps[k], f64::max);
                let corners = [points.first(), points.last()].map(|p| p.map_or(0.0, |p| line.nearest(p)[0]));
                ranges[k] = [ranges[k][0].min(corners[0]), ranges[k][1].max(corners[1])];
            }
        }
        let [root, tip] = gaps.map(|gap| trim(1e3 * gap, 2));
        found.note(
            blade[0].span,
            format!("the faces end within {root} um of the hub and within {tip} um of the shroud"),
        );
        self.straight([hub, &shroud], ranges, sheets, blade, turned, found)?;
        let [hub, shroud] = [(hub, ranges[0]), (&shroud, ranges[1])].map(|(line, range)| points(line, range));
        Ok(WheelEnds { hub, shroud, extend: gaps[0].max(gaps[1]) })
    }

    /// Refuses blades whose ends are not straight lines between the ends of hub and shroud in the meridian plane.
    fn straight(
        &self,
        lines: [&StepMeridian; 2],
        ranges: [[f64; 2]; 2],
        sheets: &[StepSheet; 2],
        blade: &[StepFace; 2],
        turned: &dyn Fn(&Point3<f64>) -> Point3<f64>,
        found: &mut Found,
    ) -> Result<(), Diag> {
        for (end, name) in ["inlet", "outlet"].into_iter().enumerate() {
            let [low, high] = [0, 1].map(|k| lines[k].at(ranges[k][end]));
            let way = high - low;
            let mut most = (0.0_f64, 0);
            for (k, sheet) in sheets.iter().enumerate() {
                for p in sheet.end(end as f64, SIDE_STEPS).iter().map(|p| flat(&turned(p))) {
                    let off = (way.perp(&(p - low)) / way.norm().max(f64::MIN_POSITIVE)).abs();
                    most = if off > most.0 { (off, k) } else { most };
                }
            }
            let face = &blade[most.1];
            if most.0 > STRAIGHT {
                return Err(Diag::error(
                    codes::NOT_READ,
                    format!("the blade has an edge of its own at the {name}, which is not read from faces"),
                )
                .label(
                    face.span,
                    format!("this face ends {} mm beside the straight line between hub and shroud", trim(most.0, 3)),
                )
                .help(
                    "export sections of the blade as points, such as a table of closed loops: their edges are read",
                ));
            }
            let off = trim(1e3 * most.0, 2);
            found.note(
                face.span,
                format!("the {name} edge is turned: it keeps to a straight line in the meridian plane within {off} um"),
            );
        }
        Ok(())
    }
}

/// Points of a meridian, as many as its spline needs.
fn points(line: &StepMeridian, range: [f64; 2]) -> Vec<[f64; 2]> {
    /// Distance of the spline from the meridian that is good enough, mm.
    const NEAR: f64 = 1e-5;
    const STEPS: [usize; 4] = [12, 24, 48, 96];
    let mut points = Vec::new();
    for steps in STEPS {
        points = line.between(range, steps);
        let space: Vec<Point3<f64>> = points.iter().map(|[r, z]| Point3::new(*r, 0.0, *z)).collect();
        let Ok(curve) = interpolate(&space, 3) else { continue };
        let places = (0..4 * steps).map(|k| curve.point((k as f64 + 0.5) / (4 * steps) as f64));
        let off = places.map(|p| line.nearest(&Vector2::new(p.x, p.z))[1]).fold(0.0, f64::max);
        if off < NEAR {
            break;
        }
    }
    points
}

/// The sections of a blade.
fn sections(fitted: FittedSections, span: Span) -> ImportedBlade {
    let last = (fitted.rows.len() - 1) as f64;
    let of = |(k, faces): (usize, [Vec<Point3<f64>>; 2])| Section {
        span: Some(k as f64 / last),
        form: SectionForm::Faces(faces),
    };
    let places = vec![span; fitted.rows.len()];
    ImportedBlade {
        sections: fitted.rows.into_iter().enumerate().map(of).collect(),
        places,
        ..ImportedBlade::default()
    }
}
