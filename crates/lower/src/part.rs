//! The part: blades from curves of their faces or from sections, hub and shroud.

use super::angles::AngleBladeGiven;
use super::face_curves::FaceCurves;
use super::sections::{SectionBlade, fitted};
use super::{checks, curves, facing};
use blade::angles::CamberSurface;
use blade::outline::Side;
use diagnostics::{Aborted, Sink};
use job::model::{BladeForm, BladeSpec, CamberSpec, PartSpec, RevolvedSpec, ToolSpec};
use nurbs::NurbsCurve;
use wheel::part::{Blade, FaceId, FaceSurface, Part, RulingEnd};

/// The design part, checked from the points up; later checks assume that the earlier ones have passed. The tools show whether
/// its size is likely.
pub(super) fn part(spec: &PartSpec, tools: &[ToolSpec], sink: &mut Sink) -> Result<Part, Aborted> {
    // Curves of the faces of each blade; none for a blade of sections.
    let mut given: Vec<Vec<FaceCurves<'_>>> = Vec::new();
    let mut whole = true;
    for blade in &spec.blades {
        let faces = blade.faces().into_iter().flatten().zip(FaceId::NAMES);
        let curves: Vec<_> = faces.map(|(face, name)| FaceCurves::new(spec, blade, face, name, sink)).collect();
        match curves.into_iter().collect::<Option<Vec<_>>>() {
            Some(curves) => given.push(curves),
            None => whole = false,
        }
    }
    if !whole {
        return Err(Aborted);
    }
    let generators = generators(spec, &given[0], sink);
    checks::ends(spec, sink)?;
    let faces: Vec<&FaceCurves<'_>> = given.iter().flatten().collect();
    checks::meridians(&faces, sink)?;
    checks::directions(&faces, sink)?;
    let [hub, shroud] = generators.ok_or(Aborted)?;
    checks::own_meridians(spec, [&hub, &shroud], sink)?;
    facing::same_way(spec, [&hub, &shroud], sink)?;
    let doubt = facing::size([&hub, &shroud], tools);
    let mut blades: Vec<Option<Blade>> = Vec::new();
    let mut side = None;
    // Camber surface of the main blade, of which splitters may be a part.
    let mut of_main: Option<CamberSurface> = None;
    for (blade, faces) in spec.blades.iter().zip(given) {
        if matches!(blades.first(), Some(None)) {
            // The main blade is faulty: any side serves to look for faults of its splitters.
            side = side.or(Some(Side::Greater));
        }
        let found = match &blade.form {
            BladeForm::Faces(_) => {
                blades.push(from_faces(blade, faces, sink));
                continue;
            }
            BladeForm::Sections(sections) => {
                fitted(&SectionBlade { part: spec, blade, sections, hub: &hub, side }, sink)
            }
            BladeForm::Angles(angles) => {
                let given = AngleBladeGiven { part: spec, blade, spec: angles, side };
                match &angles.camber {
                    CamberSpec::Own { .. } => {
                        let camber = given.camber([&hub, &shroud], sink);
                        let found = camber.as_ref().and_then(|camber| given.made(camber, sink));
                        of_main = of_main.or(camber.filter(|_| blade.name == spec.main().name));
                        found
                    }
                    CamberSpec::OfMain { .. } => of_main.as_ref().and_then(|camber| given.made(camber, sink)),
                }
            }
        };
        side = side.or(found.as_ref().map(|(_, side)| *side));
        blades.push(found.map(|(made, _)| made));
    }
    let Some(blades) = blades.into_iter().collect::<Option<Vec<_>>>() else { return Err(Aborted) };
    let turned = blades.into_iter().zip(&spec.blades);
    let turned =
        turned.map(|(made, blade)| if blade.angle.get() == 0.0 { made } else { made.rotated(blade.angle.get()) });
    let mut blades = turned.collect::<Vec<_>>().into_iter();
    let Some(main) = blades.next() else { return Err(Aborted) };
    let part = Part::with_blades(spec.vanes.value, main, blades.collect(), hub, shroud);
    facing::exchanged(spec, [&part.hub, &part.shroud], sink)?;
    checks::heights(spec, &part, sink)?;
    checks::faces(spec, &part, sink)?;
    checks::overlap(spec, &part, sink)?;
    checks::splitters_between(spec, &part, sink)?;
    checks::extensions(spec, &part, doubt.as_deref(), sink)?;
    facing::upside_down(spec, &part.hub, sink);
    if let Some(doubt) = doubt {
        facing::warn_of_size(spec, doubt, sink);
    }
    Ok(part)
}

/// The curves that generate hub and shroud.
fn generators(spec: &PartSpec, main: &[FaceCurves<'_>], sink: &mut Sink) -> Option<[NurbsCurve; 2]> {
    let [hub, shroud] = [("hub", &spec.hub), ("shroud", &spec.shroud)].map(|(name, given)| match given {
        RevolvedSpec::OfBlade(curve) => {
            let face = main.get(curve.face.index())?;
            Some(if curve.end == RulingEnd::Tip { face.tip.clone() } else { face.root.clone() })
        }
        RevolvedSpec::Own(own) => curves::meridian(own, name, sink),
    });
    Some([hub?, shroud?])
}

fn from_faces(blade: &BladeSpec, faces: Vec<FaceCurves<'_>>, sink: &mut Sink) -> Option<Blade> {
    let surfaces: Vec<Option<FaceSurface>> = faces.into_iter().map(|face| face.surface(sink)).collect();
    let surfaces: Vec<FaceSurface> = surfaces.into_iter().collect::<Option<_>>()?;
    let surfaces: [FaceSurface; 2] = surfaces.try_into().ok()?;
    let fillet = blade.fillet.clone();
    Some(Blade::new(&blade.name, surfaces, fillet))
}
