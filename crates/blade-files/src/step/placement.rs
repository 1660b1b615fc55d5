//! Points, directions and placements of STEP files.

use super::table::{Entity, EntityTable};
use crate::limits;
use base::source::Span;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::{IsometryMatrix3, Point3, Vector3};

/// A right-handed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepPlacement {
    /// Its origin, mm.
    pub(super) origin: Point3<f64>,
    /// Its unit vectors.
    pub(super) axes: [Vector3<f64>; 3],
}

/// Reader of geometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepGeometry<'a, 't> {
    pub(super) table: &'a EntityTable<'t>,
    /// Millimetres of the unit of length.
    pub(super) mm: f64,
    /// Radians of the unit of angles.
    pub(super) radians: f64,
    /// The way from the frame of the entities to the one in which geometry is read, mm.
    pub(super) frame: IsometryMatrix3<f64>,
}

impl<'t> StepGeometry<'_, 't> {
    /// The same reader, with the frame in which it reads moved.
    pub(super) fn moved(self, by: &IsometryMatrix3<f64>) -> Self {
        Self { frame: by * self.frame, ..self }
    }

    /// The reader of a part that stands at a place of the whole.
    pub(super) fn of_part(self, place: &IsometryMatrix3<f64>) -> Self {
        Self { frame: self.frame * place, ..self }
    }

    pub(super) fn entity(&self, number: u64, named_at: Span) -> Result<Entity<'t>, Diag> {
        self.table.entity(number, named_at)
    }

    /// The fault of an entity of a kind that is not read.
    pub(super) fn unknown(&self, entity: &Entity<'_>, what: &str, known: &str) -> Diag {
        Diag::error(codes::NOT_READ, format!("the {what} #{} is a {}, which is not read", entity.number, entity.name()))
            .label(entity.span, "this entity")
            .help(format!("export it as one of {known}"))
    }

    fn three(&self, number: u64, named_at: Span, kind: &str) -> Result<(Entity<'t>, Vector3<f64>), Diag> {
        let entity = self.entity(number, named_at)?;
        if entity.part(kind).is_none() {
            return Err(entity.fault(format!("#{number} is not a {kind}")));
        }
        let numbers = entity.arguments(kind)?.numbers(1)?;
        let [x, y, z] = numbers[..] else {
            return Err(entity.fault(format!("#{number} has {} coordinates, not 3", numbers.len())));
        };
        Ok((entity, Vector3::new(x, y, z)))
    }

    /// A point, mm.
    pub(super) fn point(&self, number: u64, named_at: Span) -> Result<Point3<f64>, Diag> {
        let (entity, at) = self.three(number, named_at, "CARTESIAN_POINT")?;
        let at = at * self.mm;
        if at.norm().is_nan() || at.norm() > limits::LENGTH {
            return Err(Diag::error(
                codes::TOO_MUCH,
                format!("a point is farther than {} m from the origin", limits::LENGTH / 1000.0),
            )
            .label(entity.span, "this point")
            .help("check the unit of the file, and this number"));
        }
        Ok(self.frame * Point3::from(at))
    }

    /// A unit vector.
    fn direction(&self, number: u64, named_at: Span) -> Result<Vector3<f64>, Diag> {
        let (entity, along) = self.three(number, named_at, "DIRECTION")?;
        let along = along.try_normalize(1e-100);
        along
            .map(|along| self.frame * along)
            .ok_or_else(|| entity.fault(format!("the direction #{number} has no length")))
    }

    /// The way of a vector, mm.
    pub(super) fn vector(&self, number: u64, named_at: Span) -> Result<Vector3<f64>, Diag> {
        let entity = self.entity(number, named_at)?;
        let arguments = entity.arguments("VECTOR")?;
        let way = self.direction(arguments.reference(1)?, entity.span)? * (arguments.number(2)? * self.mm);
        if way.norm() > 0.0 && way.norm().is_finite() {
            return Ok(way);
        }
        Err(entity.fault(format!("the vector #{number} has no length")))
    }

    /// A placement by its origin, its axis and a direction across it. The axis of rotation of a surface is a placement without
    /// the latter.
    pub(super) fn placement(&self, number: u64, named_at: Span) -> Result<StepPlacement, Diag> {
        let entity = self.entity(number, named_at)?;
        if entity.part("AXIS2_PLACEMENT_3D").is_none() && entity.part("AXIS1_PLACEMENT").is_none() {
            return Err(entity.fault(format!("#{number} is not a placement")));
        }
        let arguments = entity.arguments("AXIS2_PLACEMENT_3D")?;
        let origin = self.point(arguments.reference(1)?, entity.span)?;
        let given = |k: usize| match arguments.is_given(k) {
            true => self.direction(arguments.reference(k)?, entity.span).map(Some),
            false => Ok(None),
        };
        let z = given(2)?.unwrap_or_else(|| self.frame * Vector3::z());
        let [first, second] = [Vector3::x(), Vector3::y()].map(|axis| self.frame * axis);
        let other = if z.dot(&first).abs() < 0.9 { first } else { second };
        let across = given(3)?.unwrap_or(other);
        let x = (across - z * across.dot(&z))
            .try_normalize(1e-9)
            .ok_or_else(|| entity.fault(format!("both directions of the placement #{number} are the same")))?;
        Ok(StepPlacement { origin, axes: [x, z.cross(&x), z] })
    }
}
