//! The direction along a face that belongs to a sense of milling.

use ir::Operation;
use wheel::method::Milling;
use wheel::part::{FaceId, Part, Surface};

/// Place along and across a face at which its sides are distinguished; they are the same at all places.
const FACE_MIDDLE: f64 = 0.5;

/// True where lines on a face run from the outlet to the inlet, so that the tool, which stands along the rulings, mills in
/// this sense. The two faces of a blade have opposite directions.
pub(crate) fn from_outlet(part: &Part, face: FaceId, milling: Milling) -> bool {
    let face = part.face(face);
    let (_, along, _) = face.surface.tangents(FACE_MIDDLE, FACE_MIDDLE);
    let right = along.cross(&face.surface.ruling(FACE_MIDDLE));
    // The normal points out of the material.
    let on_the_right = right.dot(&face.normal(FACE_MIDDLE, FACE_MIDDLE)) < 0.0;
    on_the_right != (milling == Milling::Climb)
}

/// Lengths of the leads of a line on a face at inlet and outlet, mm.
pub(crate) fn leads_at_ends(part: &Part, operation: &Operation, face: FaceId, milling: Milling) -> [f64; 2] {
    let [enters, leaves] = [operation.lead_in.get(), operation.lead_out.get()];
    if from_outlet(part, face, milling) { [leaves, enters] } else { [enters, leaves] }
}
