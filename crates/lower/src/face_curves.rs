//! The curves of a face of a blade, and the surface through them.

use super::curves;
use super::names::face_name;
use diagnostics::codes::geometry;
use diagnostics::{Diag, Sink};
use job::model::{BladeSpec, CurveSpec, FaceForm, FaceSpec, PartSpec};
use nurbs::{GeomError, LoftedSurface, NurbsCurve};
use wheel::part::{FaceSurface, Guides};

/// The curves of a face with their text in the job.
pub(super) struct FaceCurves<'a> {
    spec: &'a FaceSpec,
    /// Name of the face in messages: `pressure`, in a splitter `half pressure`.
    name: String,
    pub(super) root: NurbsCurve,
    sections: Vec<NurbsCurve>,
    pub(super) tip: NurbsCurve,
}

impl<'a> FaceCurves<'a> {
    pub(super) fn new(
        part: &PartSpec,
        blade: &BladeSpec,
        spec: &'a FaceSpec,
        face: &str,
        sink: &mut Sink,
    ) -> Option<Self> {
        let name = face_name(part, &blade.name, face);
        let root = curves::curve(&spec.root, &format!("{name} root"), sink);
        let tip = curves::curve(&spec.tip, &format!("{name} tip"), sink);
        let section =
            |(k, section): (usize, &CurveSpec)| curves::curve(section, &format!("{name} section {}", k + 1), sink);
        let sections: Vec<Option<NurbsCurve>> = spec.sections.iter().enumerate().map(section).collect();
        Some(Self { spec, name, root: root?, sections: sections.into_iter().collect::<Option<Vec<_>>>()?, tip: tip? })
    }

    /// All curves with their names and texts.
    pub(super) fn curves(&self) -> impl Iterator<Item = (String, &CurveSpec, &NurbsCurve)> {
        let ends = [("tip", &self.spec.tip, &self.tip), ("root", &self.spec.root, &self.root)];
        let ends = ends.into_iter().map(|(end, spec, curve)| (format!("{} {end}", self.name), spec, curve));
        let sections = self.spec.sections.iter().zip(&self.sections).enumerate();
        ends.chain(sections.map(|(k, (spec, curve))| (format!("{} section {}", self.name, k + 1), spec, curve)))
    }

    pub(super) fn surface(self, sink: &mut Sink) -> Option<FaceSurface> {
        match self.spec.form {
            FaceForm::Ruled => Some(Guides { root: self.root, tip: self.tip }.into()),
            FaceForm::Lofted => {
                let curves = std::iter::once(self.root).chain(self.sections).chain(std::iter::once(self.tip));
                let lofted = LoftedSurface::through(curves.collect());
                if let Err(fault) = &lofted {
                    sink.push(
                        Diag::error(
                            geometry::POINTS,
                            format!("the {} face has no surface through its sections", self.name),
                        )
                        .label(self.spec.root.span, "root: the first of them")
                        .note(no_surface(fault, "curves of root, sections and tip"))
                        .help("give the sections in order from root to tip, each at another height"),
                    );
                }
                lofted.ok().map(FaceSurface::from)
            }
        }
    }
}

/// Why no surface goes through some curves.
pub(super) fn no_surface(fault: &GeomError, curves: &str) -> String {
    match fault {
        GeomError::CoincidentPoints(k) => format!("two neighbouring {curves} coincide: {} and {}", k + 1, k + 2),
        other => other.to_string(),
    }
}
