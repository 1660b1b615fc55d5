//! Names of all surfaces of the finished part, and of its passages.

use super::blade::{BladeId, FaceId};
use serde::{Deserialize, Serialize};

/// A passage of a sector: the channel between two neighbouring blades. The first one follows the main blade.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PassageId(pub(super) u16);

impl PassageId {
    /// The passage that follows the main blade counter-clockwise.
    pub const FIRST: Self = Self(0);

    /// The passage that follows a blade, by the index of the blade.
    pub(super) fn new(index: usize) -> Self {
        Self(u16::try_from(index).unwrap_or(u16::MAX))
    }

    /// Its index: that of the blade which it follows.
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Suffix to the number of its sector, empty for the first passage: `channel 3`, `channel 3.1`.
    fn suffix(self) -> String {
        if self == Self::FIRST { String::new() } else { format!(".{}", self.0) }
    }
}

/// Kind of a design surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceKind {
    /// A face of a blade.
    Face(FaceId),
    /// The fillet between a face and the hub.
    Fillet(FaceId),
    /// The hub in a passage.
    Hub(PassageId),
    /// The turned tip of a blade.
    Tip(BladeId),
    /// The turned inlet edge of a blade.
    InletEdge(BladeId),
    /// The turned outlet edge of a blade.
    OutletEdge(BladeId),
    /// The surface between the fillets of a blade, from its inlet edge down to the hub.
    InletRoot(BladeId),
    /// The same at the outlet.
    OutletRoot(BladeId),
    /// Outside of the hub disc below the outlet.
    Rim,
    /// Back face of the hub disc.
    Back,
    /// Bore.
    Bore,
    /// Front face between the bore and the inlet of the hub.
    Nose,
}

/// A surface of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SurfaceId {
    /// Kind of the surface.
    pub kind: SurfaceKind,
    /// Sector, from 0.
    pub sector: u32,
}

impl SurfaceId {
    /// The surface of a name, as [`fmt::Display`](std::fmt::Display) gives it; `None` where no surface has the name.
    pub fn named(name: &str) -> Option<Self> {
        let numbers = name.split(|c: char| !(c.is_ascii_digit() || c == '.')).find(|word| !word.is_empty());
        // The number of the sector, and behind a dot that of the blade or the passage in it.
        let (sector, own) = numbers.map_or(("1", "0"), |word| word.split_once('.').unwrap_or((word, "0")));
        let (sector, own) = (sector.parse::<u32>().ok()?.checked_sub(1)?, own.parse().ok()?);
        let (blade, hub) = (BladeId::new(usize::from(own)), SurfaceKind::Hub(PassageId(own)));
        let faces = blade.faces().into_iter().chain([0, 1].map(|end| blade.edge(end)));
        let of_blade = [
            SurfaceKind::Tip(blade),
            SurfaceKind::InletEdge(blade),
            SurfaceKind::OutletEdge(blade),
            SurfaceKind::InletRoot(blade),
            SurfaceKind::OutletRoot(blade),
        ];
        let turned = [hub, SurfaceKind::Rim, SurfaceKind::Back, SurfaceKind::Bore, SurfaceKind::Nose];
        let kinds = faces.flat_map(|face| [SurfaceKind::Face(face), SurfaceKind::Fillet(face)]);
        let mut ids = kinds.chain(of_blade).chain(turned).map(|kind| Self { kind, sector });
        ids.find(|id| id.to_string() == name)
    }

    /// True for milled surfaces.
    pub fn milled(self) -> bool {
        matches!(self.kind, SurfaceKind::Face(_) | SurfaceKind::Fillet(_) | SurfaceKind::Hub(_))
    }
}

impl std::fmt::Display for SurfaceId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.kind.in_sectors(&[self.sector]))
    }
}

impl SurfaceKind {
    /// Its class in contracts.
    pub fn class(self) -> SurfaceClass {
        match self {
            Self::Face(face) => [SurfaceClass::Pressure, SurfaceClass::Suction][face.index()],
            Self::Fillet(_) => SurfaceClass::Fillet,
            Self::Hub(_) => SurfaceClass::Hub,
            Self::Tip(_)
            | Self::InletEdge(_)
            | Self::OutletEdge(_)
            | Self::InletRoot(_)
            | Self::OutletRoot(_)
            | Self::Rim
            | Self::Back
            | Self::Bore
            | Self::Nose => SurfaceClass::Edge,
        }
    }

    /// Name of these surfaces in some sectors, from 0 and ascending: `vanes 1-3, 5 pressure face`.
    pub fn in_sectors(self, sectors: &[u32]) -> String {
        let runs: Vec<[u32; 2]> =
            sectors.chunk_by(|a, b| a + 1 == *b).filter_map(|run| Some([run.first()? + 1, run.last()? + 1])).collect();
        let many = if sectors.len() > 1 { "s" } else { "" };
        let numbers = |suffix: &str| {
            let texts = runs.iter().map(|[first, last]| {
                if first == last { format!("{first}{suffix}") } else { format!("{first}{suffix}-{last}{suffix}") }
            });
            texts.collect::<Vec<_>>().join(", ")
        };
        let of = |blade: BladeId| {
            let (word, suffix) = blade.words();
            format!("{word}{many} {}", numbers(&suffix))
        };
        match self {
            Self::Face(face) => format!("{} {} face", of(face.blade), face.name()),
            Self::Fillet(face) => format!("{} {} fillet", of(face.blade), face.name()),
            Self::Hub(passage) => format!("hub of channel{many} {}", numbers(&passage.suffix())),
            Self::Tip(blade) => format!("{} tip", of(blade)),
            Self::InletEdge(blade) => format!("{} inlet edge", of(blade)),
            Self::OutletEdge(blade) => format!("{} outlet edge", of(blade)),
            Self::InletRoot(blade) => format!("{} root at the inlet", of(blade)),
            Self::OutletRoot(blade) => format!("{} root at the outlet", of(blade)),
            // Turned all around: one surface for all sectors.
            Self::Rim => "rim".to_owned(),
            Self::Back => "back face".to_owned(),
            Self::Bore => "bore".to_owned(),
            Self::Nose => "nose".to_owned(),
        }
    }
}

base::named! {
    /// Surfaces that a scope can name; each class exists in every sector.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum SurfaceClass {
        /// Pressure faces.
        Pressure = "pressure",
        /// Suction faces.
        Suction = "suction",
        /// Fillets of both sides.
        Fillet = "fillet",
        /// The hub.
        Hub = "hub",
        /// The tips and edges of the vanes, turned or milled.
        Edge = "edge",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_gives_its_surface() {
        let kinds = |own: u16| {
            let blade = BladeId::new(usize::from(own));
            let faces = blade.faces().map(SurfaceKind::Face).into_iter().chain(blade.faces().map(SurfaceKind::Fillet));
            let turned = [SurfaceKind::Tip, SurfaceKind::InletEdge, SurfaceKind::OutletEdge].map(|of| of(blade));
            let roots =
                [SurfaceKind::InletRoot(blade), SurfaceKind::OutletRoot(blade), SurfaceKind::Hub(PassageId(own))];
            faces.chain(turned).chain(roots)
        };
        for id in (0..3).flat_map(kinds).flat_map(|kind| [0, 1, 10].map(|sector| SurfaceId { kind, sector })) {
            assert_eq!(SurfaceId::named(&id.to_string()), Some(id));
        }
        for (name, kind) in [("rim", SurfaceKind::Rim), ("back face", SurfaceKind::Back), ("nose", SurfaceKind::Nose)] {
            assert_eq!(SurfaceId::named(name), Some(SurfaceId { kind, sector: 0 }));
        }
        for wrong in
            ["", "vane", "vane 0 tip", "vane 1 hub", "vane 1.x tip", "vanes 1-2 tip", "hub of channel 99999999999"]
        {
            assert_eq!(SurfaceId::named(wrong), None, "{wrong}");
        }
    }
}
