//! Names of blades and faces in messages.

use job::model::PartSpec;

/// Name of a blade in messages.
pub(super) fn blade_name(spec: &PartSpec, blade: &str) -> String {
    if spec.main().name == blade { "the vane".to_owned() } else { format!("the splitter `{blade}`") }
}

/// Name of a face in messages; in a splitter it includes the name of the blade.
pub(super) fn face_name(spec: &PartSpec, blade: &str, face: &str) -> String {
    if spec.main().name == blade { face.to_owned() } else { format!("{blade} {face}") }
}
