//! Faces turned about the axis of rotation: the axis itself, and how near hub and shroud are to surfaces of revolution.

use super::face::StepFace;
use super::placement::StepGeometry;
use super::turned_faces::{self, REVOLVED};
use crate::Axis;
use crate::found::Found;
use base::source::Span;
use base::units::trim;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Translation3, Vector3};

/// Largest sine between the normal of a surface of revolution and its meridian plane: 0.6 deg.
const MAX_NORMAL_SINE: f64 = 0.01;

/// Reads the faces of the hub in a frame.
pub(super) type HubIn<'f, 'a, 't> = dyn Fn(&StepGeometry<'a, 't>) -> Result<Vec<StepFace>, Diag> + 'f;

/// The turn that makes an axis of the file the Z axis.
pub(super) fn to_z(axis: Axis) -> IsometryMatrix3<f64> {
    let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| Vector3::from(axis.to_z(unit.into())));
    let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns));
    IsometryMatrix3::from_parts(Translation3::identity(), turn)
}

/// The first frame with an axis about which the hub is turned, and this axis: the one that the caller states, or the only one that it
/// can be. `hub_in` reads the faces of the hub in a frame.
pub(super) fn axis<'a, 't>(
    [own, whole]: [StepGeometry<'a, 't>; 2],
    hub_in: &HubIn<'_, 'a, 't>,
    stated: Option<Axis>,
    span: Span,
    found: &mut Found,
) -> Result<(StepGeometry<'a, 't>, Axis), Diag> {
    let spreads = spreads(&own, hub_in)?;
    let fits = |spreads: &[AxisSpread; 3]| spreads.iter().any(|of| of.spread <= REVOLVED);
    if own.frame == whole.frame || fits(&spreads) {
        return Ok((own, chosen(spreads, stated, span, found)?));
    }
    let in_whole = self::spreads(&whole, hub_in)?;
    if fits(&in_whole) {
        found.note(
            span,
            "the frame is that of the assembly: the part of the hub is turned about no axis of its own frame",
        );
    }
    Ok((whole, chosen(in_whole, stated, span, found)?))
}

/// How far the borders of the hub lie off one meridian about an axis, mm.
#[derive(Clone, Copy)]
struct AxisSpread {
    axis: Axis,
    spread: f64,
}

fn spreads<'a, 't>(geometry: &StepGeometry<'a, 't>, hub_in: &HubIn<'_, 'a, 't>) -> Result<[AxisSpread; 3], Diag> {
    let mut spreads = [Axis::X, Axis::Y, Axis::Z].map(|axis| AxisSpread { axis, spread: f64::INFINITY });
    for AxisSpread { axis, spread } in &mut spreads {
        let hub = hub_in(&geometry.moved(&to_z(*axis)))?;
        *spread = turned_faces::meridian(&hub).map_or(f64::INFINITY, |meridian| meridian.spread);
    }
    Ok(spreads)
}

fn chosen(spreads: [AxisSpread; 3], stated: Option<Axis>, span: Span, found: &mut Found) -> Result<Axis, Diag> {
    let fits: Vec<Axis> = spreads.iter().filter(|of| of.spread <= REVOLVED).map(|of| of.axis).collect();
    let described = || described(spreads);
    match (stated, fits.as_slice()) {
        (Some(axis), fits) if fits.contains(&axis) => {
            found.note(None, format!("the axis of rotation is {axis}, by `--axis`"));
            Ok(axis)
        }
        (Some(axis), _) => {
            Err(Diag::error(codes::CONTRADICTS, format!("the hub is not turned about {axis}, as `--axis` says"))
                .label(span, described())
                .help("leave out `--axis`, or pick another face as hub"))
        }
        (None, [axis]) => {
            found.note(span, format!("the axis of rotation is {axis}: the hub is turned about it alone"));
            Ok(*axis)
        }
        (None, []) => Err(Diag::error(codes::NOT_READ, "the hub is turned about no axis of the file")
            .label(span, described())
            .help("pick other faces as hub, or export the wheel with its axis as x, y or z through the origin")),
        (None, _) => Err(Diag::error(codes::NOT_STATED, "the hub can be turned about several axes")
            .label(span, described())
            .help("state `--axis`: x, y or z")),
    }
}

/// How far the borders of the hub lie off one meridian about each axis, in words.
fn described(spreads: [AxisSpread; 3]) -> String {
    let (known, none): (Vec<_>, Vec<_>) = spreads.into_iter().partition(|of| of.spread.is_finite());
    let far: Vec<String> = known.iter().map(|of| format!("{} mm about {}", trim(of.spread, 3), of.axis)).collect();
    let none: Vec<String> = none.iter().map(|of| of.axis.to_string()).collect();
    let lie = (!far.is_empty()).then(|| format!("lie off one meridian by {}", far.join(", ")));
    let without = (!none.is_empty()).then(|| format!("have no meridian about {}", none.join(", ")));
    format!("its borders {}", [lie, without].into_iter().flatten().collect::<Vec<_>>().join(" and "))
}

/// Refuses faces that are not turned about Z, and says how near they are. `spread` is the distance of their borders from one
/// meridian, mm; `what` is their name in the wheel.
pub(super) fn check(faces: &[StepFace], spread: f64, what: &str, at: Span, found: &mut Found) -> Result<(), Diag> {
    /// Of the points of borders, one in so many is checked.
    const CHECKED: usize = 64;
    let mut most = 0.0_f64;
    for face in faces {
        for place in face.inside(CHECKED) {
            let jet = face.surface.at(place);
            let (p, normal) = (jet.point, jet.normal());
            let radius = libm::hypot(p.x, p.y);
            let sine = normal.map_or(0.0, |n| (n.y * p.x - n.x * p.y) / radius.max(f64::MIN_POSITIVE));
            most = most.max(sine.abs());
            if sine.abs() > MAX_NORMAL_SINE {
                return Err(Diag::error(
                    codes::NOT_READ,
                    format!("the face #{} is no {what}: it is not turned about the axis", face.number),
                )
                .label(
                    face.span,
                    format!(
                        "its normal leaves the meridian plane by {} deg",
                        trim(libm::asin(sine.abs()).to_degrees(), 2)
                    ),
                )
                .help(format!("pick the faces of the {what} between the blades, without fillets")));
            }
        }
    }
    found.note(
        faces.first().map_or(at, |face| face.span),
        format!(
            "the {what} is a surface of revolution within {} um; its normals leave the meridian plane by at most {} deg",
            trim(1e3 * spread, 2),
            trim(libm::asin(most).to_degrees(), 4)
        ),
    );
    Ok(())
}
