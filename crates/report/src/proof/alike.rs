//! Surfaces of one kind with the same figures in several sectors: reported once, with all their vanes.

use verify::surface::SurfaceReport;

/// Surfaces with the same figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Alike {
    /// Name of all of them: `vanes 1-3, 5 pressure face`.
    pub(crate) name: String,
    /// Their indices in the given list, in its order.
    pub(crate) members: Vec<usize>,
}

impl Alike {
    /// The member with the largest value; of equal values the last member.
    pub(crate) fn worst<'a, Q: Into<f64>>(
        &self,
        surfaces: &'a [SurfaceReport],
        value: impl Fn(&SurfaceReport) -> Q,
    ) -> Option<(usize, &'a SurfaceReport)> {
        let members = self.members.iter().filter_map(|i| Some((*i, surfaces.get(*i)?)));
        members.max_by(|a, b| value(a.1).into().total_cmp(&value(b.1).into()))
    }
}

/// Groups surfaces of one kind with the same text, in the order of their first members. `text_of` gives the text, or
/// `None` for a surface that is not reported.
pub(crate) fn alike(surfaces: &[SurfaceReport], text_of: impl Fn(&SurfaceReport) -> Option<String>) -> Vec<Alike> {
    let mut keys: Vec<(usize, String)> = Vec::new();
    let mut groups: Vec<Alike> = Vec::new();
    for (i, s) in surfaces.iter().enumerate() {
        let Some(text) = text_of(s) else { continue };
        let same = |(first, key): &(usize, String)| {
            surfaces.get(*first).is_some_and(|f| f.id.kind == s.id.kind) && *key == text
        };
        match keys.iter().position(same).and_then(|at| groups.get_mut(at)) {
            Some(group) => group.members.push(i),
            None => {
                keys.push((i, text));
                groups.push(Alike { name: s.surface.clone(), members: vec![i] });
            }
        }
    }
    for group in groups.iter_mut().filter(|g| g.members.len() > 1) {
        let ids: Vec<_> = group.members.iter().filter_map(|i| surfaces.get(*i)).map(|s| s.id).collect();
        if let Some(first) = ids.first() {
            group.name = first.kind.in_sectors(&ids.iter().map(|id| id.sector).collect::<Vec<_>>());
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::units::{Mm, Mm2};
    use verify::surface::Worst;
    use wheel::part::{FaceId, PassageId, SurfaceId, SurfaceKind};

    fn surface(kind: SurfaceKind, sector: u32, depth: f64) -> SurfaceReport {
        let id = SurfaceId { kind, sector };
        let worst = Worst { value: Mm(0.0), point: [0.0; 3], parameters: [0.0; 2], at: None, depth: Mm(depth) };
        SurfaceReport {
            surface: id.to_string(),
            follows: None,
            samples: 0,
            points: 0,
            area: Mm2(0.0),
            gouge: worst.clone(),
            gouge_bound: Mm(depth),
            excess: worst,
            excess_bound: Mm(0.0),
            percentiles: [Mm(0.0); 3],
            not_reached: Mm2(0.0),
            nearest_there: Vec::new(),
            id,
            corners: Vec::new(),
        }
    }

    #[test]
    fn groups_are_of_one_kind_and_one_figure() {
        let face = SurfaceKind::Face(FaceId::PRESSURE);
        let depths = [
            (face, 0, 5.0),
            (face, 1, 5.1),
            (face, 2, 7.0),
            (face, 4, 5.2),
            (SurfaceKind::Hub(PassageId::FIRST), 0, 5.0),
        ];
        let surfaces: Vec<_> = depths.into_iter().map(|(kind, sector, d)| surface(kind, sector, d)).collect();
        let groups = alike(&surfaces, |s| Some(format!("{:.0}", s.gouge.depth.get())));
        let found: Vec<_> = groups.iter().map(|g| (g.name.as_str(), g.members.as_slice())).collect();
        let due: [(&str, &[usize]); 3] =
            [("vanes 1-2, 5 pressure face", &[0, 1, 3]), ("vane 3 pressure face", &[2]), ("hub of channel 1", &[4])];
        assert_eq!(found, due);
        assert_eq!(groups[0].worst(&surfaces, |s| s.gouge.depth).map(|w| w.0), Some(3));
        // A surface that is not reported is in no group.
        let deep = alike(&surfaces, |s| (s.gouge.depth.get() > 6.0).then(String::new));
        assert_eq!(deep.iter().map(|g| g.members.as_slice()).collect::<Vec<_>>(), [[2]]);
        assert_eq!(SurfaceKind::Hub(PassageId::FIRST).in_sectors(&[0, 1, 2, 7, 9]), "hub of channels 1-3, 8, 10");
    }
}
