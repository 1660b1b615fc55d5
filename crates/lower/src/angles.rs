//! A blade from its angles and thicknesses: camber surface, sections, surfaces.

use super::curves;
use super::face_curves::no_surface;
use super::names::blade_name;
use super::pressure::{facing, side};
use base::source::Span;
use base::units::{length, trim};
use blade::angles::limits::{LEAST_LENGTH, OFF_ENDS};
use blade::angles::{
    AngleBlade, CamberAngles, CamberRow, CamberSurface, Distribution, EdgeLine, FaultKind, MAX_CAMBER_ANGLE, MadeFault,
    MeridianByLength, MeridionalPatch, SectionFault, SteepCamber, SurfaceResidual, Thickness, made,
};
use blade::loft::{LoftFault, LoftedBlade};
use blade::outline::Side;
use diagnostics::codes::geometry as codes;
use diagnostics::{Diag, Sink};
use job::model::{
    AnglesAtSpan, AnglesSpec, BladeSpec, CamberSpec, DistributionSpec, EdgePlace, MeridianPlace, PartSpec,
};
use nurbs::NurbsCurve;
use wheel::part::{Blade, FaceSurface};

/// A blade by angles in its part.
pub(super) struct AngleBladeGiven<'a> {
    pub(super) part: &'a PartSpec,
    pub(super) blade: &'a BladeSpec,
    pub(super) spec: &'a AnglesSpec,
    /// Side of the pressure face of the main blade: its splitters have the same.
    pub(super) side: Option<Side>,
}

fn percent(share: f64) -> String {
    format!("{} %", trim(share * 100.0, 2))
}

fn deg(angle: f64) -> String {
    format!("{} deg", trim(angle.to_degrees(), 4))
}

/// The spline through values of the job, which are in order.
fn through(spec: &DistributionSpec) -> Option<Distribution> {
    Distribution::through(&spec.points)
}

impl AngleBladeGiven<'_> {
    fn name(&self) -> String {
        blade_name(self.part, &self.blade.name)
    }

    /// The camber surface of the blade itself between hub and shroud; `None` for a faulty one, and for a part of the main
    /// blade.
    pub(super) fn camber(&self, ends: [&NurbsCurve; 2], sink: &mut Sink) -> Option<CamberSurface> {
        let CamberSpec::Own { angles, lean, edges } = &self.spec.camber else { return None };
        let [hub, shroud] = ends.map(MeridianByLength::new);
        let ends = [hub?, shroud?];
        let [leading, trailing] = [0, 1].map(|edge: usize| self.edge(&edges[edge], &ends, sink));
        let edges = [leading?, trailing?];
        self.edges_in_order(&edges, sink)?;
        let row = |(k, _): (usize, f64)| {
            let given = &angles[k].says;
            let angles_at = match given {
                AnglesAtSpan::Theta(theta) => CamberAngles::Theta(through(theta)?),
                AnglesAtSpan::Beta { beta, theta, end } => {
                    CamberAngles::Beta { beta: through(beta)?, end: *end, theta: *theta }
                }
            };
            Some(CamberRow { span: angles[k].at, angles: angles_at })
        };
        let rows = angles.iter().map(|a| a.at).enumerate().map(row).collect::<Option<Vec<_>>>()?;
        let lean = lean.as_ref().map_or(Some(Distribution::constant(0.0)), through)?;
        match CamberSurface::new(MeridionalPatch::new(ends, edges), &rows, lean) {
            Ok(surface) => Some(surface),
            Err(SteepCamber { row, way, beta }) => {
                sink.push(
                    Diag::error(codes::STEEP, format!("the camber line of {} runs round the axis", self.name()))
                        .label(angles[row].span, format!("beta is {} at {} of the way", deg(beta), percent(way)))
                        .note("the spline through the values may go beyond them")
                        .help("let theta change less over the way, or give more or smaller values of beta"),
                );
                None
            }
        }
    }

    fn edge(&self, place: &EdgePlace, ends: &[MeridianByLength; 2], sink: &mut Sink) -> Option<EdgeLine> {
        match place {
            EdgePlace::Places(places, span) => {
                let lengths = [0, 1].map(|k: usize| match places[k] {
                    MeridianPlace::Share(share) => share * ends[k].length(),
                    MeridianPlace::Length(from_inlet) => from_inlet.get(),
                });
                for (k, name) in ["hub", "shroud"].iter().enumerate() {
                    if lengths[k] > ends[k].length() {
                        let text = format!("the {name} has {} along its meridian", length(ends[k].length()));
                        sink.push(
                            Diag::error(codes::EDGE_PLACE, format!("{} has an edge beyond the {name}", self.name()))
                                .label(span.unwrap_or(self.spec.span), text)
                                .help(format!("give a place on the {name}, from 0 % to 100 %")),
                        );
                        return None;
                    }
                }
                Some(EdgeLine::straight(lengths))
            }
            EdgePlace::Curve(spec) => {
                let curve = curves::meridian(spec, "meridional edge", sink)?;
                let (line, off) = EdgeLine::curved(MeridianByLength::new(&curve)?, [&ends[0], &ends[1]]);
                let worst = [("hub", "begins", off[0]), ("shroud", "ends", off[1])];
                let worst = worst.into_iter().find(|(_, _, off)| *off > OFF_ENDS);
                if let Some((surface, verb, off)) = worst {
                    sink.push(
                        Diag::error(
                            codes::EDGE_PLACE,
                            format!("a meridional edge of {} is no line from hub to shroud", self.name()),
                        )
                        .label(spec.span, format!("it {verb} {} beside the {surface}", length(off)))
                        .help(format!("give the points from hub to shroud, the ends within {OFF_ENDS} mm of them")),
                    );
                    return None;
                }
                Some(line)
            }
        }
    }

    /// Reports a trailing edge before the leading edge.
    fn edges_in_order(&self, edges: &[EdgeLine; 2], sink: &mut Sink) -> Option<()> {
        let [from, to] = edges.each_ref().map(EdgeLine::places);
        for (k, name) in ["hub", "shroud"].iter().enumerate() {
            if to[k] - from[k] < LEAST_LENGTH {
                sink.push(
                    Diag::error(codes::EDGE_PLACE, format!("{} ends before it begins", self.name()))
                        .label(
                            self.spec.span,
                            format!("on the {name} it goes from {} to {}", length(from[k]), length(to[k])),
                        )
                        .help("let the place in `from` be nearer to the inlet than that in `to`"),
                );
                return None;
            }
        }
        Some(())
    }

    /// The blade on a camber surface, and the side of its pressure face; faults and what was found go to the sink.
    pub(super) fn made(&self, camber: &CamberSurface, sink: &mut Sink) -> Option<(Blade, Side)> {
        let (name, spec) = (self.name(), self.spec);
        let part = match &spec.camber {
            CamberSpec::Own { .. } => [[0.0; 2], [1.0; 2]],
            CamberSpec::OfMain { part } => *part,
        };
        let rows = spec.thickness.iter().map(|row| through(&row.says)).collect::<Option<_>>()?;
        let thickness = Thickness { spans: spec.thickness.iter().map(|row| row.at).collect(), rows };
        let blade = AngleBlade { camber, part, thickness, edges: spec.edges };
        let side = side(spec.pressure, self.side, blade.turns(), &name, spec.span, sink)?;
        let (surfaces, residual) = match made(&blade, side, spec.fit.get()) {
            Ok(found) => found,
            Err(MadeFault::Section(fault)) => {
                sink.push(self.section_fault(&name, &fault));
                return None;
            }
            Err(MadeFault::Loft(fault)) => {
                let why = match &fault {
                    LoftFault::Surface(fault) => no_surface(fault, "sections"),
                    LoftFault::EdgesDiffer { .. } | LoftFault::Points { .. } => "a section gives no curve".to_owned(),
                };
                sink.push(
                    Diag::error(codes::POINTS, format!("{name} has no surface through its sections"))
                        .label(spec.span, "this blade")
                        .note(why)
                        .help("check that hub and shroud are apart everywhere between both edges"),
                );
                return None;
            }
        };
        self.report(&name, &surfaces, &residual, side, sink).then(|| {
            let LoftedBlade { faces: [pressure, suction], edges, .. } = surfaces;
            let fillet = self.blade.fillet.clone();
            let made = Blade::new(&self.blade.name, [pressure.into(), suction.into()], fillet);
            (made.with_edges(edges.map(|edge| edge.map(FaceSurface::from))), side)
        })
    }

    fn section_fault(&self, name: &str, fault: &SectionFault) -> Diag {
        let SectionFault { span, way, at, kind } = *fault;
        let place = format!("{name}, {} of the span, {} of the way", percent(span), percent(way));
        let on = |code, message: String, label: String, span: Span| {
            Diag::error(code, message).label(span, label).place(place.clone(), at)
        };
        let angles = match &self.spec.camber {
            CamberSpec::Own { angles, .. } => {
                let nearest = angles.iter().min_by(|a, b| (a.at - span).abs().total_cmp(&(b.at - span).abs()));
                nearest.map_or(self.spec.span, |a| a.span)
            }
            CamberSpec::OfMain { .. } => self.spec.span,
        };
        let thickness = self.spec.thickness.iter().min_by(|a, b| (a.at - span).abs().total_cmp(&(b.at - span).abs()));
        let thickness = thickness.map_or(self.spec.span, |row| row.says.span);
        match kind {
            FaultKind::Steep(beta) => on(
                codes::STEEP,
                format!("the camber line of {name} runs round the axis"),
                format!("beta is {} there; less than {} is possible", deg(beta), deg(MAX_CAMBER_ANGLE)),
                angles,
            )
            .help("let theta change less over the way, or give smaller values of beta"),
            FaultKind::Thin(thick) => on(
                codes::THIN,
                format!("{name} has no thickness"),
                format!("the spline goes to {}", length(thick)),
                thickness,
            )
            .help("give more values where the thickness changes fast"),
            FaultKind::Fold(thick) => on(
                codes::THICK,
                format!("a face of {name} folds"),
                format!("the thickness is {} there, and the camber line bends too much for it", length(thick)),
                thickness,
            )
            .help("make the blade thinner there, or let its angles change less over a short way"),
            FaultKind::EdgesMeet([edges, whole]) => on(
                codes::THICK,
                format!("the edges of {name} take all of its length"),
                format!("both edges have {} along a camber line of {}", length(edges), length(whole)),
                thickness,
            )
            .help("give a smaller number for `elliptic`, or make the blade thinner at its edges"),
            FaultKind::NotCut(edge) => on(
                codes::THICK,
                format!("{name} is too thick for its {} edge", ["leading", "trailing"][edge]),
                "a face does not reach the line at which the edge is cut off".to_owned(),
                thickness,
            )
            .help("make the blade thinner there, or the angle between camber line and meridian smaller"),
        }
    }

    /// Reports what was made; `false` when the surfaces do not keep `fit`.
    fn report(&self, name: &str, made: &LoftedBlade, residual: &SurfaceResidual, side: Side, sink: &mut Sink) -> bool {
        let spec = self.spec;
        let place = format!("{name}, {} of the span", percent(residual.span));
        if residual.distance > spec.fit.get() {
            // The next tenth of a micrometre above.
            let enough = (residual.distance * 1e4).ceil() / 1e4;
            sink.push(
                Diag::error(
                    codes::SECTION_FIT,
                    format!("the surfaces of {name} miss its stated form by up to {}", length(residual.distance)),
                )
                .label(spec.span, format!("at most {} are asked for", length(spec.fit.get())))
                .place(place, residual.at)
                .help(format!(
                    "allow more with `fit {}`, or let angles and thickness change less there",
                    length(enough)
                )),
            );
            return false;
        }
        let counts = made.faces[0].to_surface().counts();
        let forms = made.edges.each_ref().map(|edge| if edge.is_some() { "round" } else { "cut off" });
        sink.push(
            Diag::remark(
                codes::SECTIONS_FOUND,
                format!("{name}: its surfaces lie within {} of its stated form", length(residual.distance)),
            )
            .label(spec.span, format!("leading edge {}, trailing edge {}", forms[0], forms[1]))
            .place(place, residual.at)
            .note(format!(
                "the pressure face looks {}; {} sections, a face has {} by {} control points",
                facing(side).name(),
                residual.sections,
                counts[0],
                counts[1]
            ))
            .help("state `pressure` where this is not what you mean"),
        );
        true
    }
}
