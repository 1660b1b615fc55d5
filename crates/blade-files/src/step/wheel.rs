//! Blades, hub and shroud of a wheel from its picked faces.

use super::blade::{BladeReader, EdgedLoop, StepBlade};
use super::copies;
use super::ends::WheelEnds;
use super::face::StepFace;
use super::fillet;
use super::fitted::{self, FittedSections};
use super::inlet::run_from_inlet;
use super::looped::{self, LoopedSections};
use super::meridian::StepMeridian;
use super::neighbours::EdgeFaces;
use super::picks::{ListedFace, MAX_FACES, PickedFaces, missing};
use super::placement::StepGeometry;
use super::revolved;
use super::turned_faces::{self, TurnedMeridian};
use crate::found::Found;
use crate::stated::RequiredFacts;
use crate::{BladeFace, BladeSurfaces, FaceRole, Handedness, Imported, ImportedBlade, ImportedRow, Options};
use base::source::{Span, Spanned};
use base::units::trim;
use blade::{Section, SectionForm};
use diagnostics::codes::import as codes;
use diagnostics::{Diag, printable};
use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};
use std::f64::consts::TAU;

/// A wheel that is read.
pub(super) struct StepWheel<'a, 't> {
    pub(super) geometry: StepGeometry<'a, 't>,
    pub(super) faces: &'a [ListedFace<'t>],
    pub(super) picked: &'a PickedFaces,
    pub(super) options: &'a Options,
    /// The end of the file.
    pub(super) end: Span,
}

impl<'a, 't> StepWheel<'a, 't> {
    /// Faces of a role, in the frame of a reader.
    fn all(&self, geometry: &StepGeometry<'a, 't>, role: FaceRole) -> Result<Vec<StepFace>, Diag> {
        self.picked.of(role).into_iter().map(|k| geometry.listed(&self.faces[k])).collect()
    }

    /// The wheel.
    ///
    /// # Errors
    /// A role without a face, a face that is not what its role demands, a fact that nothing tells.
    pub(super) fn read(mut self, found: &mut Found) -> Result<Imported, Diag> {
        let Some(first) = self.picked.of(FaceRole::Hub).first().map(|k| &self.faces[*k]) else {
            return Err(missing(self.faces, FaceRole::Hub, self.end));
        };
        self.note_places(found);
        let whole = self.geometry;
        // The wheel is read in the frame of the part that has the hub. Where that has no axis of rotation, the whole may have it.
        let frames = [whole.moved(&first.place().inverse()), whole];
        let hub_in = |geometry: &StepGeometry<'a, 't>| self.all(geometry, FaceRole::Hub);
        let (frame, axis) = revolved::axis(frames, &hub_in, self.options.axis, first.entity.span, found)?;
        self.geometry = frame.moved(&revolved::to_z(axis));
        let geometry = self.geometry;
        let hub_faces = self.all(&geometry, FaceRole::Hub)?;
        let TurnedMeridian { line: hub, spread } = turned_faces::meridian(&hub_faces)?;
        revolved::check(&hub_faces, spread, "hub", self.end, found)?;
        let of_main = |face: BladeFace| self.all(&geometry, FaceRole::OfBlade(0, face));
        let main: Vec<StepFace> =
            [of_main(BladeFace::Pressure)?, of_main(BladeFace::Suction)?].into_iter().flatten().collect();
        let ends = [of_main(BladeFace::Inlet)?, of_main(BladeFace::Outlet)?];
        found.moved(turned_faces::distance(&hub, &hub_faces));
        let hub = run_from_inlet(hub, &main, ends, self.options.start, axis, found)?;
        let count = self.count(found)?;
        let blades = self.blades(&hub, count, found)?;
        let fillets = self.fillets(&hub, &blades, found)?;
        let shroud_faces = self.all(&geometry, FaceRole::Shroud)?;
        let ends = WheelEnds::new(hub, &blades, &shroud_faces, found)?;
        let lines = ends.points(!shroud_faces.is_empty(), found);
        let [hub, shroud] = lines.ok_or_else(|| Diag::error(codes::NOT_READ, "hub or shroud has no length"))?;
        let ReadBlades { blades: mut read, surfaces } = if ends.all_turned(&blades) {
            of_faces(&blades, ends.extend, found)?
        } else {
            of_loops(&blades, &hub, &ends, found)?
        };
        for (blade, fillet) in read.iter_mut().zip(fillets) {
            blade.fillet = fillet;
        }
        Ok(Imported {
            hub: Some(hub),
            shroud: Some(shroud),
            rows: vec![ImportedRow { name: String::new(), count, blades: read }],
            surfaces,
            ..Imported::default()
        })
    }

    /// Says which faces belong to parts of an assembly.
    fn note_places(&self, found: &mut Found) {
        let placed = |face: &&ListedFace<'_>| face.place() != IsometryMatrix3::identity() || face.places.len() > 1;
        let picked = self.faces.iter().enumerate().filter(|(k, _)| self.picked.has(*k)).map(|(_, face)| face);
        for face in picked.filter(placed) {
            let note = match face.places.len() {
                1 => "its part stands in an assembly; it is placed against the part of the hub".to_owned(),
                many => format!("its part stands at {many} places of an assembly; the first one counts"),
            };
            found.note(face.entity.span, format!("#{} `{}`: {note}", face.entity.number, printable(&face.name)));
        }
    }

    /// Number of copies of a pressure face about the axis that the file has.
    fn copies(&self, blade: usize) -> Result<(Option<u32>, Span), Diag> {
        let role = FaceRole::OfBlade(blade, BladeFace::Pressure);
        let Some(own) = self.picked.only(role, self.faces)?.map(|k| &self.faces[k]) else {
            return Err(missing(self.faces, role, self.end));
        };
        let face = self.geometry.listed(own)?;
        let alike = self.faces.iter().filter(|f| f.surface == own.surface);
        if alike.clone().map(|f| f.places.len()).sum::<usize>() > MAX_FACES {
            let message = format!("more than {MAX_FACES} faces that may be copies of a blade, the limit");
            return Err(Diag::error(codes::TOO_MUCH, message)
                .label(own.entity.span, "copies of this face are counted")
                .help("export the wheel as a part of its own"));
        }
        let all = alike.flat_map(|f| f.places.iter().map(move |place| (f, place)));
        let others = all.filter(|(f, place)| f.entity.number != own.entity.number || **place != own.place());
        // A face of another kind than those that are read is no copy.
        let others = others.filter_map(|(f, place)| self.geometry.of_part(place).face(&f.entity).ok());
        Ok((copies::count(&face, others), face.span))
    }

    /// Number of main blades: that of equal copies of the pressure face about the axis, or the one that the caller states.
    fn count(&self, found: &mut Found) -> Result<u32, Diag> {
        let (counted, span) = self.copies(0)?;
        if counted.is_some() {
            found.note(span, "the blades are counted: the file has equal copies of the pressure face at equal angles");
        }
        let mut required = RequiredFacts::of(self.options, found, self.end);
        let count = required.blades(counted.map(|n| Spanned::new(n, span)))?;
        required.handedness(Some(Spanned::new(Handedness::Right, self.end)))?;
        required.end()?;
        for splitter in 1..self.picked.blades() {
            let (copies, span) = self.copies(splitter)?;
            if let Some(copies) = copies.filter(|copies| *copies != count) {
                return Err(Diag::error(codes::CONTRADICTS, format!("there are not as many splitters {splitter} as main blades"))
                    .label(span, format!("the file has {copies} equal copies of this face, and {count} main blades"))
                    .help(format!("pick a splitter of each kind between two main blades: where there are {copies} for {count} main blades, they are several splitters of a sector")));
            }
        }
        Ok(count)
    }

    /// The blades of a sector: the main blade, and its splitters between it and the next main blade.
    fn blades(&self, hub: &StepMeridian, count: u32, found: &mut Found) -> Result<Vec<StepBlade>, Diag> {
        let pitch = TAU / f64::from(count);
        let meeting = EdgeFaces::of(self.geometry.table, self.faces);
        let reader = |geometry: StepGeometry<'a, 't>| BladeReader {
            geometry,
            faces: self.faces,
            picked: self.picked,
            meeting: &meeting,
            hub,
            pitch,
            end: self.end,
        };
        let main = reader(self.geometry).blade(0, found)?;
        let mut blades = vec![main];
        for splitter in 1..self.picked.blades() {
            let given = reader(self.geometry).blade(splitter, &mut Found::default())?;
            let sectors = ((given.angle() - blades[0].angle()) / pitch).floor();
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -sectors * pitch);
            let by = IsometryMatrix3::from_parts(Translation3::identity(), turn);
            let whole = sectors.rem_euclid(f64::from(count));
            if whole != 0.0 {
                let note = format!("splitter {splitter} is turned by {whole} sectors, to the first main blade");
                found.note(given.faces[0].span, note);
            }
            blades.push(reader(self.geometry.moved(&by)).blade(splitter, found)?);
        }
        Ok(blades)
    }

    /// Fillets of the blades whose fillet faces are picked, mm.
    fn fillets(&self, hub: &StepMeridian, blades: &[StepBlade], found: &mut Found) -> Result<Vec<Option<f64>>, Diag> {
        blades.iter().enumerate().map(|(k, blade)| self.fillet(hub, k, blade, found)).collect()
    }

    fn fillet(&self, hub: &StepMeridian, k: usize, blade: &StepBlade, found: &mut Found) -> Result<Option<f64>, Diag> {
        let role = FaceRole::OfBlade(k, BladeFace::Fillet);
        let faces = self.all(&self.geometry, role)?;
        let of = if k == 0 { "the main blade".to_owned() } else { format!("splitter {k}") };
        let Some(first) = faces.first() else {
            if let Some(below) = blade.below.map(|k| &self.faces[k]) {
                let number = below.entity.number;
                let note = format!(
                    "{of} ends at #{number} `{}`, which is no face of the hub: its faces are extended to the hub, and it has no fillet. `--face {role}=#{number}` finds the radius, if #{number} is a fillet",
                    printable(&below.name)
                );
                found.note(below.entity.span, note.clone());
                found.note(None, note);
            }
            return Ok(None);
        };
        let count = faces.len();
        let measured = fillet::measured(&faces, hub).ok_or_else(|| {
            Diag::error(codes::NOT_READ, format!("the faces picked as fillet of {of} are no fillets"))
                .label(first.span, "no ball touches this face and the hub")
                .help("pick faces between the blade and the hub, or none: then state `fillet` in the job")
        })?;
        let constant = measured.is_constant();
        let note = if constant {
            let ([all, keep], within) = (measured.places, trim(1e3 * measured.within, 1));
            let radius = trim(measured.radius, 3);
            format!(
                "the fillet of {of} is {radius} mm by {count} faces: {keep} of {all} places keep to it within {within} um"
            )
        } else {
            let [least, most] = measured.range.map(|r| trim(r, 3));
            format!(
                "the fillet of {of} is not constant, from {least} to {most} mm: the job has none, state `fillet` there"
            )
        };
        found.note(first.span, note.clone());
        found.note(None, note);
        Ok(constant.then_some(measured.radius))
    }
}

/// Says how near the faces of the job are to those of the file.
fn note_distance(distance: f64, span: Span, found: &mut Found) {
    found.moved(distance);
    let distance = trim(1e3 * distance, 2);
    found.note(span, format!("faces of the job lie within {distance} um of those of the file"));
    found.note(None, format!("faces of the job lie within {distance} um of those of the file where compared"));
}

/// Blades with the kind of their surfaces.
struct ReadBlades {
    blades: Vec<ImportedBlade>,
    surfaces: BladeSurfaces,
}

/// Blades whose faces are surfaces between edges that the lathe makes.
fn of_faces(blades: &[StepBlade], extend: f64, found: &mut Found) -> Result<ReadBlades, Diag> {
    let mut read = Vec::with_capacity(blades.len());
    let mut lofted = false;
    for (k, blade) in blades.iter().enumerate() {
        let [pressure, suction] = &blade.faces;
        let fitted = fitted::sections(&blade.sheets).ok_or_else(|| {
            Diag::error(codes::NOT_READ, "no surface goes through the points of a face")
                .label(pressure.span, format!("#{}", pressure.number))
                .label(suction.span, format!("#{}", suction.number))
                .help("look at these faces in the program that wrote them: a side has no length")
        })?;
        note_distance(fitted.distance, pressure.span, found);
        lofted |= fitted.rows.len() > 2;
        let FittedSections { rows, .. } = fitted;
        read.push(imported(k, blade, rows.into_iter().map(SectionForm::Faces).collect()));
    }
    let surfaces = if lofted { BladeSurfaces::Lofted { extend } } else { BladeSurfaces::Ruled { extend } };
    Ok(ReadBlades { blades: read, surfaces })
}

/// Blades as closed sections, where edges are surfaces of their own.
fn of_loops(blades: &[StepBlade], hub: &[[f64; 2]], ends: &WheelEnds, found: &mut Found) -> Result<ReadBlades, Diag> {
    let mut read = Vec::with_capacity(blades.len());
    for (k, blade) in blades.iter().enumerate() {
        let span = blade.faces[0].span;
        let read_as = looped::sections(blade, hub, ends.turned_of(blade));
        let LoopedSections { loops, distance, forms } = read_as.map_err(|why| {
            Diag::error(codes::NOT_READ, "the faces of a blade give no closed sections")
                .label(span, why)
                .help("export sections of the blade as points, such as a table of closed loops")
        })?;
        note_distance(distance, span, found);
        let divided = |EdgedLoop { points, edges }| SectionForm::DividedLoop { points, edges };
        let sections = loops.into_iter().map(divided).collect();
        let edges = forms.map(Some);
        read.push(ImportedBlade { edges, pressure: Some(blade.pressure_side()), ..imported(k, blade, sections) });
    }
    Ok(ReadBlades { blades: read, surfaces: BladeSurfaces::Loops { extend: ends.extend, fit: looped::FIT } })
}

/// A blade with sections from root to tip.
fn imported(k: usize, blade: &StepBlade, forms: Vec<SectionForm>) -> ImportedBlade {
    let last = (forms.len().max(2) - 1) as f64;
    let places = vec![blade.faces[0].span; forms.len()];
    let of = |(k, form): (usize, SectionForm)| Section { span: Some(k as f64 / last), form };
    ImportedBlade {
        name: crate::part_source::blade_name(k),
        sections: forms.into_iter().enumerate().map(of).collect(),
        places,
        ..ImportedBlade::default()
    }
}
