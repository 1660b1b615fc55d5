//! Placements of assemblies: where the faces of a part stand in the whole.
//!
//! Faces belong to representations. A representation stands in another one by a relationship with a transformation, or as a mapped
//! item; a relationship without one says that both have the same frame (ISO 10303-43).

use super::picks::ListedFace;
use super::placement::{StepGeometry, StepPlacement};
use super::table::{Entity, EntityTable};
use base::source::Span;
use diagnostics::Diag;
use diagnostics::codes::import as codes;
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Translation3};
use std::collections::{BTreeMap, BTreeSet};

/// Deepest nesting of assemblies that is read.
const MAX_NESTING: usize = 8;

/// Most places at which a part may stand.
const MAX_PLACES: usize = 1000;

/// Deepest nesting of solids and shells above a face.
const ABOVE_FACE: usize = 4;

/// Kinds of representations of shape.
const REPRESENTATIONS: [&str; 6] = [
    "SHAPE_REPRESENTATION",
    "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "FACETED_BREP_SHAPE_REPRESENTATION",
    "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
    "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION",
    "REPRESENTATION",
];

/// Kinds between a representation and its faces.
const BODIES: [&str; 6] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "SHELL_BASED_SURFACE_MODEL",
    "CLOSED_SHELL",
    "OPEN_SHELL",
    "CONNECTED_FACE_SET",
];

/// How a representation stands in another one.
#[derive(Clone, Copy, Debug)]
struct PartStanding {
    parent: u64,
    /// Placements that coincide: of the representation, and of its parent.
    frames: [u64; 2],
    span: Span,
}

/// Representations of a file.
#[derive(Debug, Default)]
struct Assembly {
    /// The representation of each face.
    of_face: BTreeMap<u64, u64>,
    /// Items that belong to a representation already.
    seen: BTreeSet<u64>,
    /// Representations with the frame of another one.
    same: BTreeMap<u64, u64>,
    standing: BTreeMap<u64, Vec<PartStanding>>,
}

/// A place at which a representation stands in the whole.
#[derive(Clone, Copy, Debug)]
struct PlaceInWhole {
    /// The representation that is the whole.
    whole: u64,
    way: IsometryMatrix3<f64>,
}

/// Places the listed faces in the whole: those that count are read with errors, the others where they can be.
///
/// # Errors
/// A placement of a face that counts that is not read, that is nested too deeply, or has too many places; faces that count in
/// parts that nothing places against each other.
pub(super) fn place(
    geometry: &StepGeometry<'_, '_>,
    faces: &mut [ListedFace<'_>],
    counts: &dyn Fn(usize) -> bool,
) -> Result<(), Diag> {
    let mut assembly = Assembly::read(geometry.table)?;
    if assembly.standing.is_empty() {
        return Ok(());
    }
    let mut known: BTreeMap<u64, Vec<PlaceInWhole>> = BTreeMap::new();
    let mut first: Option<(Option<u64>, Span)> = None;
    for (k, face) in faces.iter_mut().enumerate() {
        let group = assembly.of_face.get(&face.entity.number).copied().map(|part| assembly.group(part));
        if let Some(group) = group.filter(|group| !known.contains_key(group)) {
            let mut places = Vec::new();
            match assembly.places(geometry, group, IsometryMatrix3::identity(), 0, &mut places) {
                Ok(()) => known.insert(group, places),
                Err(fault) if counts(k) => return Err(fault),
                Err(_) => continue,
            };
        }
        let places = group.and_then(|group| known.get(&group));
        if let Some(places) = places {
            face.places = places.iter().map(|place| place.way).collect();
        }
        let whole = places.and_then(|places| places.first()).map(|place| place.whole);
        match first {
            Some((other, at)) if counts(k) && other != whole => return Err(of_another_solid(face.entity.span, at)),
            None if counts(k) => first = Some((whole, face.entity.span)),
            _ => {}
        }
    }
    Ok(())
}

/// The fault of faces in parts that nothing places against each other.
fn of_another_solid(here: Span, there: Span) -> Diag {
    Diag::error(codes::NOT_READ, "faces of the wheel belong to parts that no assembly places against each other")
        .label(here, "the part of this face")
        .label(there, "and that of this one")
        .help("export the wheel as a part of its own")
}

impl Assembly {
    fn read(table: &EntityTable<'_>) -> Result<Self, Diag> {
        let mut assembly = Self::default();
        for relationship in table.of_kinds(&["REPRESENTATION_RELATIONSHIP", "SHAPE_REPRESENTATION_RELATIONSHIP"]) {
            assembly.related(table, &relationship?)?;
        }
        for representation in table.of_kinds(&REPRESENTATIONS) {
            let representation = representation?;
            let own = representation.part("REPRESENTATION").map_or("SHAPE_REPRESENTATION", |part| part.name);
            for item in representation.arguments(own)?.references(1).unwrap_or_default() {
                assembly.item(table, item, &representation, 0)?;
            }
        }
        let standing = std::mem::take(&mut assembly.standing);
        for (child, standing) in standing {
            let group = assembly.group(child);
            assembly.standing.entry(group).or_default().extend(standing);
        }
        Ok(assembly)
    }

    /// The representation that stands for all with its frame.
    fn group(&mut self, representation: u64) -> u64 {
        let mut group = representation;
        while let Some(other) = self.same.get(&group) {
            group = *other;
        }
        // Later searches go there at once.
        let mut passed = representation;
        while passed != group {
            passed = self.same.insert(passed, group).unwrap_or(group);
        }
        group
    }

    fn stands(&mut self, child: u64, standing: PartStanding) {
        self.standing.entry(child).or_default().push(standing);
    }

    /// Two representations that are related.
    fn related(&mut self, table: &EntityTable<'_>, entity: &Entity<'_>) -> Result<(), Diag> {
        let arguments = entity.arguments("REPRESENTATION_RELATIONSHIP")?;
        let (Ok(child), Ok(parent)) = (arguments.reference(2), arguments.reference(3)) else { return Ok(()) };
        let Some(_) = entity.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") else {
            let (a, b) = (self.group(child), self.group(parent));
            if a != b {
                self.same.insert(a.max(b), a.min(b));
            }
            return Ok(());
        };
        let by = entity.arguments("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")?.reference(0)?;
        let by = table.entity(by, entity.span)?;
        if by.part("ITEM_DEFINED_TRANSFORMATION").is_none() {
            return Err(not_read(&by, "the placement of a part"));
        }
        let arguments = by.arguments("ITEM_DEFINED_TRANSFORMATION")?;
        let frames = [arguments.reference(2)?, arguments.reference(3)?];
        self.stands(child, PartStanding { parent, frames, span: by.span });
        Ok(())
    }

    /// An item of a representation, or what is below it.
    fn item(&mut self, table: &EntityTable<'_>, item: u64, within: &Entity<'_>, depth: usize) -> Result<(), Diag> {
        if !self.seen.insert(item) {
            return Ok(());
        }
        let entity = table.entity(item, within.span)?;
        if entity.part("ADVANCED_FACE").is_some() || entity.part("FACE_SURFACE").is_some() {
            self.of_face.insert(item, within.number);
        } else if entity.part("MAPPED_ITEM").is_some() {
            let arguments = entity.arguments("MAPPED_ITEM")?;
            let map = table.entity(arguments.reference(1)?, entity.span)?;
            let of_map = map.arguments("REPRESENTATION_MAP")?;
            let frames = [of_map.reference(0)?, arguments.reference(2)?];
            self.stands(of_map.reference(1)?, PartStanding { parent: within.number, frames, span: entity.span });
        } else if depth < ABOVE_FACE && BODIES.iter().any(|kind| entity.part(kind).is_some()) {
            let arguments = entity.arguments("CONNECTED_FACE_SET")?;
            let below = arguments.references(1).or_else(|_| arguments.reference(1).map(|one| vec![one]))?;
            for item in below {
                self.item(table, item, within, depth + 1)?;
            }
        }
        Ok(())
    }

    /// All ways from the frame of a group of representations to the whole. `way` leads from there to where the search begins.
    fn places(
        &mut self,
        geometry: &StepGeometry<'_, '_>,
        group: u64,
        way: IsometryMatrix3<f64>,
        depth: usize,
        places: &mut Vec<PlaceInWhole>,
    ) -> Result<(), Diag> {
        let above = self.standing.get(&group).cloned().unwrap_or_default();
        if above.is_empty() {
            places.push(PlaceInWhole { whole: group, way });
        }
        for standing in above {
            let fault = |message: String| {
                Diag::error(codes::NOT_READ, message)
                    .label(standing.span, "this placement")
                    .help("export the wheel as a part of its own")
            };
            if depth >= MAX_NESTING {
                return Err(fault(format!("assemblies are nested more than {MAX_NESTING} deep, or hold themselves")));
            }
            if places.len() >= MAX_PLACES {
                return Err(fault(format!("a part stands at more than {MAX_PLACES} places")));
            }
            let [own, there] = standing.frames.map(|frame| geometry.placement(frame, standing.span));
            let step = isometry(&there?) * isometry(&own?).inverse();
            let parent = self.group(standing.parent);
            self.places(geometry, parent, step * way, depth + 1, places)?;
        }
        Ok(())
    }
}

fn not_read(entity: &Entity<'_>, what: &str) -> Diag {
    Diag::error(codes::NOT_READ, format!("{what} is a {}, which is not read", entity.name()))
        .label(entity.span, format!("#{}", entity.number))
        .help("export the wheel as a part of its own")
}

/// The way from the frame of a placement to the frame in which it is given.
fn isometry(placement: &StepPlacement) -> IsometryMatrix3<f64> {
    let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&placement.axes));
    IsometryMatrix3::from_parts(Translation3::from(placement.origin.coords), turn)
}
