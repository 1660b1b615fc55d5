//! Blades of the typed job: their curves, or their angles and thicknesses.

use base::source::Span;
use base::units::Mm;
use blade::angles::EdgeShape;

/// Points of a curve in mm, from inlet to outlet.
#[derive(Clone, Debug)]
pub struct CurveSpec {
    /// At least two.
    pub points: Vec<[f64; 3]>,
    /// Place of each point.
    pub spans: Vec<Span>,
    /// Whole curve.
    pub span: Span,
}

base::named! {
    /// Where a face looks, about Z and seen from +Z.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Facing {
        /// Ahead in the sense of positive angles.
        CounterClockwise = "counter-clockwise",
        /// The other way.
        Clockwise = "clockwise",
    }
}

/// A blade by angles of camber lines and thicknesses.
#[derive(Clone, Debug)]
pub struct AnglesSpec {
    /// What gives its camber surface.
    pub camber: CamberSpec,
    /// Thicknesses, mm, by the share of the way along the blade.
    pub thickness: Vec<SpanSpec<DistributionSpec>>,
    /// Leading and trailing edge.
    pub edges: [EdgeShape; 2],
    /// Largest distance of the surfaces to the stated sections.
    pub fit: Mm,
    /// Sense about Z, seen from +Z, in which the pressure face looks, where the job states it.
    pub pressure: Option<Facing>,
    /// Place in the text.
    pub span: Span,
}

/// What a job says at a share of the span.
#[derive(Clone, Debug)]
pub struct SpanSpec<T> {
    /// Share of the span from hub (0) to shroud (1).
    pub at: f64,
    /// What it says.
    pub says: T,
    /// Place in the text.
    pub span: Span,
}

/// Values by shares; one value holds everywhere.
#[derive(Clone, Debug)]
pub struct DistributionSpec {
    /// Share and value in base units.
    pub points: Vec<[f64; 2]>,
    /// Place in the text.
    pub span: Span,
}

/// A camber surface.
#[derive(Clone, Debug)]
pub enum CamberSpec {
    /// Of the blade itself.
    Own {
        /// Angles at spans.
        angles: Vec<SpanSpec<AnglesAtSpan>>,
        /// Turn of the sections about Z by the share of the span, rad.
        lean: Option<DistributionSpec>,
        /// Meridional leading and trailing edge.
        edges: Box<[EdgePlace; 2]>,
    },
    /// A part of that of the main blade: shares of its way at hub and shroud where it begins and ends.
    OfMain {
        /// Beginning, then end.
        part: [[f64; 2]; 2],
    },
}

/// Angles of a camber line.
#[derive(Clone, Debug)]
pub enum AnglesAtSpan {
    /// Angle about +Z, rad.
    Theta(DistributionSpec),
    /// Angle to the meridian, rad.
    Beta {
        /// The angle.
        beta: DistributionSpec,
        /// Angle about +Z at the leading (end 0) or trailing edge (1), rad.
        theta: f64,
        /// The end with that angle.
        end: usize,
    },
}

/// Where a meridional edge is.
#[derive(Clone, Debug)]
pub enum EdgePlace {
    /// The straight line between places of hub and shroud.
    Places([MeridianPlace; 2], Option<Span>),
    /// A curve from hub to shroud. Its azimuth does not matter.
    Curve(CurveSpec),
}

/// A place of a meridian, from its inlet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeridianPlace {
    /// Share of its length.
    Share(f64),
    /// Length, mm.
    Length(Mm),
}
