//! Entities of curves and surfaces to their geometry.

use super::curve::StepCurve;
use super::placement::StepGeometry;
use super::spline::{HIGHEST_DEGREE, SplineKnots};
use super::surface::StepSurface;
use super::table::{Entity, EntityArguments};
use base::source::Span;
use diagnostics::Diag;
use nalgebra::{Point3, Vector4};

/// Curves that are read, in messages.
const CURVES: &str =
    "LINE, CIRCLE, ELLIPSE, B_SPLINE_CURVE_WITH_KNOTS, BEZIER_CURVE, UNIFORM_CURVE, QUASI_UNIFORM_CURVE";

/// Surfaces that are read, in messages.
const SURFACES: &str = "PLANE, CYLINDRICAL_SURFACE, CONICAL_SURFACE, SPHERICAL_SURFACE, TOROIDAL_SURFACE, \
                        SURFACE_OF_REVOLUTION, SURFACE_OF_LINEAR_EXTRUSION, B_SPLINE_SURFACE_WITH_KNOTS, BEZIER_SURFACE, \
                        UNIFORM_SURFACE, QUASI_UNIFORM_SURFACE";

/// Deepest chain of curves that name a curve.
const MAX_CURVE_CHAIN: usize = 8;

/// How the file gives the knots of a spline.
#[derive(Clone, Copy)]
enum KnotRule {
    Listed,
    Bezier,
    Uniform,
    QuasiUniform,
}

impl KnotRule {
    fn of(entity: &Entity<'_>, kind: &str) -> Option<Self> {
        let has = |name: String| entity.part(&name).is_some();
        if has(format!("B_SPLINE_{kind}_WITH_KNOTS")) {
            Some(Self::Listed)
        } else if has(format!("BEZIER_{kind}")) {
            Some(Self::Bezier)
        } else if has(format!("QUASI_UNIFORM_{kind}")) {
            Some(Self::QuasiUniform)
        } else if has(format!("UNIFORM_{kind}")) {
            Some(Self::Uniform)
        } else {
            None
        }
    }

    /// Knots of a direction; `listed` has multiplicities and values.
    fn knots(
        self,
        degree: usize,
        count: usize,
        listed: impl FnOnce() -> Result<(Vec<usize>, Vec<f64>), Diag>,
    ) -> Result<Option<SplineKnots>, Diag> {
        if !(1..=HIGHEST_DEGREE).contains(&degree) || count <= degree {
            return Ok(None);
        }
        let even = |m: &[usize]| m.iter().enumerate().map(|(k, _)| k as f64).collect::<Vec<f64>>();
        let multiplicities = match self {
            Self::Listed => {
                let (multiplicities, values) = listed()?;
                return Ok(SplineKnots::new(degree, &multiplicities, &values, count));
            }
            Self::Uniform => vec![1; count + degree + 1],
            Self::QuasiUniform => ends(degree + 1, vec![1; count - degree - 1]),
            Self::Bezier if (count - 1).is_multiple_of(degree) => {
                ends(degree + 1, vec![degree; (count - 1) / degree - 1])
            }
            Self::Bezier => return Ok(None),
        };
        Ok(SplineKnots::new(degree, &multiplicities, &even(&multiplicities), count))
    }
}

/// Multiplicities with those of both ends.
fn ends(end: usize, inside: Vec<usize>) -> Vec<usize> {
    std::iter::once(end).chain(inside).chain(std::iter::once(end)).collect()
}

/// Arguments of the part of a spline and the index of the first one: a simple entity has the name before it.
fn spline_part<'a, 't>(
    entity: &'a Entity<'t>,
    name: &str,
    before: usize,
) -> Result<(EntityArguments<'a, 't>, usize), Diag> {
    let simple = entity.parts.len() == 1;
    Ok((entity.arguments(name)?, if simple { 1 + before } else { 0 }))
}

impl StepGeometry<'_, '_> {
    /// A curve.
    pub(super) fn curve(&self, number: u64, named_at: Span) -> Result<StepCurve, Diag> {
        let (mut number, mut named_at) = (number, named_at);
        for _ in 0..MAX_CURVE_CHAIN {
            let entity = self.entity(number, named_at)?;
            let has = |name: &str| entity.part(name).is_some();
            // A curve on surfaces has the curve in space first; a part of a curve is within its curve.
            if has("SURFACE_CURVE") || has("SEAM_CURVE") || has("INTERSECTION_CURVE") || has("TRIMMED_CURVE") {
                let name = entity.parts.first().map_or("", |part| part.name);
                (number, named_at) = (entity.arguments(name)?.reference(1)?, entity.span);
                continue;
            }
            return self.plain_curve(&entity);
        }
        Err(self.entity(number, named_at)?.fault("a curve names itself"))
    }

    fn plain_curve(&self, entity: &Entity<'_>) -> Result<StepCurve, Diag> {
        let has = |name: &str| entity.part(name).is_some();
        if has("LINE") {
            let arguments = entity.arguments("LINE")?;
            let start = self.point(arguments.reference(1)?, entity.span)?;
            return Ok(StepCurve::Line(start, self.vector(arguments.reference(2)?, entity.span)?));
        }
        if has("CIRCLE") || has("ELLIPSE") {
            let arguments = entity.arguments(if has("CIRCLE") { "CIRCLE" } else { "ELLIPSE" })?;
            let placement = self.placement(arguments.reference(1)?, entity.span)?;
            let a = self.radius(entity, &arguments, 2)?;
            let b = if has("CIRCLE") { a } else { self.radius(entity, &arguments, 3)? };
            return Ok(StepCurve::Ellipse(placement, [a, b]));
        }
        let Some(rule) = KnotRule::of(entity, "CURVE") else { return Err(self.unknown(entity, "curve", CURVES)) };
        let (arguments, first) = spline_part(entity, "B_SPLINE_CURVE", 0)?;
        let degree = arguments.count(first)?;
        let mut points = Vec::new();
        for number in arguments.references(first + 1)? {
            points.push(self.point(number, entity.span)?);
        }
        let knots = rule.knots(degree, points.len(), || {
            let (arguments, first) = spline_part(entity, "B_SPLINE_CURVE_WITH_KNOTS", 5)?;
            Ok((arguments.counts(first)?, arguments.numbers(first + 1)?))
        })?;
        let knots = knots.ok_or_else(|| faulty_knots(entity))?;
        let weights = match has("RATIONAL_B_SPLINE_CURVE") {
            true => Some(entity.arguments("RATIONAL_B_SPLINE_CURVE")?.numbers(0)?),
            false => None,
        };
        Ok(StepCurve::Spline(knots, homogeneous(entity, &points, weights)?))
    }

    /// A positive length, mm.
    fn radius(&self, entity: &Entity<'_>, arguments: &EntityArguments<'_, '_>, k: usize) -> Result<f64, Diag> {
        let radius = arguments.number(k)? * self.mm;
        if radius > 0.0 && radius.is_finite() { Ok(radius) } else { Err(entity.fault("a radius is not positive")) }
    }

    /// A surface.
    pub(super) fn surface(&self, number: u64, named_at: Span) -> Result<StepSurface, Diag> {
        let entity = self.entity(number, named_at)?;
        let has = |name: &str| entity.part(name).is_some();
        let simple = ["PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SPHERICAL_SURFACE", "TOROIDAL_SURFACE"];
        if let Some(name) = simple.into_iter().find(|name| has(name)) {
            let arguments = entity.arguments(name)?;
            let placement = self.placement(arguments.reference(1)?, entity.span)?;
            return Ok(match name {
                "PLANE" => StepSurface::Plane(placement),
                "CYLINDRICAL_SURFACE" => StepSurface::Cone(placement, self.radius(&entity, &arguments, 2)?, 0.0),
                "CONICAL_SURFACE" => {
                    // The radius may be zero: the tip of the cone.
                    let (radius, angle) = (arguments.number(2)? * self.mm, arguments.number(3)? * self.radians);
                    if !(radius >= 0.0 && radius.is_finite() && angle.abs() < std::f64::consts::FRAC_PI_2) {
                        return Err(entity.fault("this is no cone: its radius or its angle is wrong"));
                    }
                    StepSurface::Cone(placement, radius, libm::tan(angle))
                }
                "SPHERICAL_SURFACE" => StepSurface::Torus(placement, 0.0, self.radius(&entity, &arguments, 2)?),
                _ => StepSurface::Torus(
                    placement,
                    self.radius(&entity, &arguments, 2)?,
                    self.radius(&entity, &arguments, 3)?,
                ),
            });
        }
        if has("SURFACE_OF_REVOLUTION") {
            let arguments = entity.arguments("SURFACE_OF_REVOLUTION")?;
            let curve = self.curve(arguments.reference(1)?, entity.span)?;
            return Ok(StepSurface::Revolution(self.placement(arguments.reference(2)?, entity.span)?, curve));
        }
        if has("SURFACE_OF_LINEAR_EXTRUSION") {
            let arguments = entity.arguments("SURFACE_OF_LINEAR_EXTRUSION")?;
            let curve = self.curve(arguments.reference(1)?, entity.span)?;
            return Ok(StepSurface::Extrusion(curve, self.vector(arguments.reference(2)?, entity.span)?));
        }
        self.spline_surface(&entity)
    }

    fn spline_surface(&self, entity: &Entity<'_>) -> Result<StepSurface, Diag> {
        let Some(rule) = KnotRule::of(entity, "SURFACE") else { return Err(self.unknown(entity, "surface", SURFACES)) };
        let (arguments, first) = spline_part(entity, "B_SPLINE_SURFACE", 0)?;
        let degrees = [arguments.count(first)?, arguments.count(first + 1)?];
        let rows = arguments.rows_of_references(first + 2)?;
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().any(|row| row.len() != columns) {
            return Err(entity.fault(format!("the rows of control points of #{} are not equally long", entity.number)));
        }
        let mut points = Vec::with_capacity(rows.len() * columns);
        for number in rows.iter().flatten() {
            points.push(self.point(*number, entity.span)?);
        }
        let of = |k: usize| {
            let knots = rule.knots(degrees[k], [rows.len(), columns][k], || {
                let (arguments, first) = spline_part(entity, "B_SPLINE_SURFACE_WITH_KNOTS", 7)?;
                Ok((arguments.counts(first + k)?, arguments.numbers(first + 2 + k)?))
            })?;
            knots.ok_or_else(|| faulty_knots(entity))
        };
        let knots = [of(0)?, of(1)?];
        let weights = match entity.part("RATIONAL_B_SPLINE_SURFACE").is_some() {
            true => Some(entity.arguments("RATIONAL_B_SPLINE_SURFACE")?.rows_of_numbers(0)?.concat()),
            false => None,
        };
        Ok(StepSurface::Spline(knots, homogeneous(entity, &points, weights)?, columns))
    }
}

fn faulty_knots(entity: &Entity<'_>) -> Diag {
    entity.fault(format!(
        "degree, control points and knots of #{} are no spline: degrees from 1 to {HIGHEST_DEGREE}, ascending knots, one more than \
         degree and control points together",
        entity.number
    ))
}

/// Control points with their weights.
fn homogeneous(
    entity: &Entity<'_>,
    points: &[Point3<f64>],
    weights: Option<Vec<f64>>,
) -> Result<Vec<Vector4<f64>>, Diag> {
    let weights = weights.unwrap_or_else(|| vec![1.0; points.len()]);
    if weights.len() != points.len() || weights.iter().any(|w| !(1e-9..1e9).contains(w)) {
        return Err(entity.fault(format!("the weights of #{} are not positive, one a control point", entity.number)));
    }
    Ok(points.iter().zip(weights).map(|(p, w)| (p.coords * w).push(w)).collect())
}
