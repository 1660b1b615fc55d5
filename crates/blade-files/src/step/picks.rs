//! Which faces of a STEP file are hub, shroud, pressure and suction face, and the edges: by the caller, or by the names that our
//! own export gives.

use super::table::{Entity, EntityTable};
use crate::{BladeFace, FaceChoice, FaceRole, limits};
use base::source::Span;
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::IsometryMatrix3;

/// Most faces that are listed. A wheel of 40 blades with fillets has some 500.
pub(super) const MAX_FACES: usize = 20_000;

/// Most faces that are named in a message.
const MAX_NAMED_FACES: usize = 12;

/// A face of the list.
#[derive(Clone, Debug)]
pub(super) struct ListedFace<'t> {
    pub(super) entity: Entity<'t>,
    pub(super) name: String,
    pub(super) surface: String,
    /// Where it stands: ways from its own frame to that of the whole file. Parts of an assembly may stand at several places.
    pub(super) places: Vec<IsometryMatrix3<f64>>,
}

impl ListedFace<'_> {
    /// The first of its places.
    pub(super) fn place(&self) -> IsometryMatrix3<f64> {
        self.places.first().copied().unwrap_or_else(IsometryMatrix3::identity)
    }
}

/// Lists all faces of a file.
pub(super) fn listed<'t>(table: &EntityTable<'t>) -> Result<Vec<ListedFace<'t>>, Diag> {
    let mut faces = Vec::new();
    for entity in table.of_kinds(&["ADVANCED_FACE", "FACE_SURFACE"]) {
        let entity = entity?;
        if faces.len() >= MAX_FACES {
            return Err(Diag::error(codes::TOO_MUCH, format!("more than {MAX_FACES} faces, the limit"))
                .label(entity.span, "this one exceeds it")
                .help("export one sector of the wheel alone"));
        }
        let arguments = entity.arguments("FACE_SURFACE")?;
        let surface = table.entity(arguments.reference(2)?, entity.span)?.name();
        let name = arguments.text(0);
        faces.push(ListedFace { entity, name, surface, places: vec![IsometryMatrix3::identity()] });
    }
    Ok(faces)
}

/// Faces of each role, by their places in the list.
#[derive(Clone, Debug, Default)]
pub(super) struct PickedFaces {
    roles: Vec<(FaceRole, usize)>,
}

impl PickedFaces {
    pub(super) fn is_empty(&self) -> bool {
        self.roles.is_empty()
    }

    /// Whether a face of the list has a role.
    pub(super) fn has(&self, face: usize) -> bool {
        self.roles.iter().any(|(_, k)| *k == face)
    }

    /// Number of blades of a sector that have a face.
    pub(super) fn blades(&self) -> usize {
        let blades = self.roles.iter().filter_map(|(role, _)| match role {
            FaceRole::OfBlade(blade, _) => Some(blade + 1),
            FaceRole::Hub | FaceRole::Shroud => None,
        });
        blades.max().unwrap_or(1)
    }

    /// Faces of a role.
    pub(super) fn of(&self, role: FaceRole) -> Vec<usize> {
        self.roles.iter().filter(|(r, _)| *r == role).map(|(_, k)| *k).collect()
    }

    /// The face of a role that has one face at most.
    pub(super) fn only(&self, role: FaceRole, faces: &[ListedFace<'_>]) -> Result<Option<usize>, Diag> {
        match self.of(role).as_slice() {
            [] => Ok(None),
            [face] => Ok(Some(*face)),
            [first, second, ..] => Err(Diag::error(codes::NOT_READ, format!("the role {role} has several faces"))
                .label(faces[*second].entity.span, format!("#{}", faces[*second].entity.number))
                .label(faces[*first].entity.span, format!("#{}", faces[*first].entity.number))
                .help("pick one face; join the pieces of a face before the export")),
        }
    }
}

/// The role that the name of a face of our own export tells: those of the blades of the first sector, and the hub.
fn by_name(name: &str) -> Option<FaceRole> {
    if name.starts_with("hub of channel ") {
        return Some(FaceRole::Hub);
    }
    let (blade, face) = match name.strip_prefix("vane 1 ") {
        Some(face) => (0, face),
        None => {
            let (number, face) = name.strip_prefix("splitter 1.")?.split_once(' ')?;
            (number.parse().ok().filter(|number| (1..limits::BLADES).contains(number))?, face)
        }
    };
    let face = match face {
        "pressure face" => BladeFace::Pressure,
        "suction face" => BladeFace::Suction,
        "inlet edge" => BladeFace::Inlet,
        "outlet edge" => BladeFace::Outlet,
        "pressure fillet" | "suction fillet" => BladeFace::Fillet,
        _ => return None,
    };
    Some(FaceRole::OfBlade(blade, face))
}

/// The faces of all roles. What the caller picks for a role replaces what names tell of it.
pub(super) fn picked(faces: &[ListedFace<'_>], choices: &[FaceChoice], end: Span) -> Result<PickedFaces, Diag> {
    let mut roles: Vec<(FaceRole, usize)> = Vec::new();
    for choice in choices {
        let number = choice.face.strip_prefix('#').and_then(|digits| digits.parse::<u64>().ok());
        let fits = |face: &ListedFace<'_>| match number {
            Some(number) => face.entity.number == number,
            None => face.name == choice.face,
        };
        let found: Vec<usize> = (0..faces.len()).filter(|k| fits(&faces[*k])).collect();
        match found.as_slice() {
            [] => {
                return Err(candidates(
                    Diag::error(codes::NOT_STATED, format!("the file has no face `{}`", printable(&choice.face)))
                        .label(end, "in this file"),
                    faces,
                    choice.role,
                ));
            }
            [_, second, ..] if !choice.role.has_several() => {
                return Err(Diag::error(
                    codes::NOT_STATED,
                    format!("{} faces have the name `{}`", found.len(), printable(&choice.face)),
                )
                .label(faces[*second].entity.span, "the second of them")
                .help(format!(
                    "give the number of the face, such as `--face {}=#{}`",
                    choice.role, faces[*second].entity.number
                )));
            }
            _ => {}
        }
        for k in found {
            if let Some((other, _)) = roles.iter().find(|(role, face)| *face == k && *role != choice.role) {
                return Err(Diag::error(
                    codes::CONTRADICTS,
                    format!("one face is picked as {other} and as {}", choice.role),
                )
                .label(faces[k].entity.span, format!("#{}", faces[k].entity.number))
                .help("give each face one role"));
            }
            if !roles.contains(&(choice.role, k)) {
                roles.push((choice.role, k));
            }
        }
    }
    let stated: Vec<FaceRole> = roles.iter().map(|(role, _)| *role).collect();
    let named = faces.iter().enumerate().filter_map(|(k, face)| Some((by_name(&face.name)?, k)));
    let taken: Vec<usize> = roles.iter().map(|(_, k)| *k).collect();
    roles.extend(named.filter(|(role, k)| !stated.contains(role) && !taken.contains(k)));
    Ok(PickedFaces { roles })
}

/// The fault of a role without a face.
pub(super) fn missing(faces: &[ListedFace<'_>], role: FaceRole, end: Span) -> Diag {
    let fault = Diag::error(codes::NOT_STATED, format!("nothing tells which face is the {role}"))
        .label(end, "no face of this file has a name that tells it");
    candidates(fault, faces, role)
}

/// Adds the faces from which the caller can pick.
fn candidates(mut fault: Diag, faces: &[ListedFace<'_>], role: FaceRole) -> Diag {
    for face in faces.iter().take(MAX_NAMED_FACES) {
        fault = fault.note(format!("#{}: {} `{}`", face.entity.number, face.surface, printable(&face.name)));
    }
    if faces.len() > MAX_NAMED_FACES {
        fault = fault.note(format!(
            "{} more faces; the command without `-o` and `--face` lists all",
            faces.len() - MAX_NAMED_FACES
        ));
    }
    fault.help(format!("state `--face {role}=#NUMBER` or `--face {role}=NAME`"))
}
