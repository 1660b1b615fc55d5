//! Tilt of the tool axis of `rough` away from the walls of the channel.

/// Neighbouring places whose mean is taken on both sides, so that the axis turns evenly.
const AVERAGED_NEIGHBOURS: usize = 2;

/// Tilts away from both walls at places along the channel, radians; none for an axis along the rulings.
#[derive(Clone, Debug, Default)]
pub(super) struct WallTilt {
    places: Vec<[f64; 2]>,
}

impl WallTilt {
    /// The same tilt everywhere, radians.
    pub(super) fn even(tilt: f64) -> Self {
        Self { places: vec![[tilt; 2]] }
    }

    /// Tilts away from the first and from the second wall, radians.
    pub(super) fn at(&self, u: f64) -> [f64; 2] {
        let Some(last) = self.places.len().checked_sub(1) else { return [0.0; 2] };
        let at = u.clamp(0.0, 1.0) * last as f64;
        let (i, share) = (at as usize, at.fract());
        let next = self.places[(i + 1).min(last)];
        [0, 1].map(|side: usize| self.places[i][side] + (next[side] - self.places[i][side]) * share)
    }

    /// Each tilt replaced by the mean of its neighbourhood.
    pub(super) fn smooth(places: &[[f64; 2]]) -> Self {
        let mean = |i: usize, side: usize| {
            let near = &places[i.saturating_sub(AVERAGED_NEIGHBOURS)..places.len().min(i + AVERAGED_NEIGHBOURS + 1)];
            near.iter().map(|tilts| tilts[side]).sum::<f64>() / near.len() as f64
        };
        Self { places: (0..places.len()).map(|i| [0, 1].map(|side| mean(i, side))).collect() }
    }
}
