//! The cheapest sequence through the stations of a pass: one of several candidates at each station, with the least cost
//! in the axes of the machine.
//!
//! The cost of a step is the time that the slowest joint needs at its largest speed. A change of the step costs
//! `smoothness` times its square over the acceleration, summed over the joints. This cost depends on three stations.
//! The shortest path therefore runs over pairs of candidates of neighbouring stations (Mi, Yuan, Ma, Shen 2017:
//! difference graph). Rotary joints without limits are compared by their nearest winding. Both branches of a machine
//! are candidates like all others.

use nurbs::angle::nearest_turn;

/// Joints of a candidate: X, Y, Z in mm, rotary axes 1 and 2 in radians.
pub type Joints5 = [f64; 5];

/// A candidate of a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisCandidate {
    /// Joints.
    pub joints: Joints5,
    /// Additional cost of the candidate, s.
    pub penalty: f64,
}

/// Weights of the cost of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// Largest speeds, mm/s and rad/s.
    pub speed: Joints5,
    /// Largest accelerations, mm/s2 and rad/s2.
    pub acceleration: Joints5,
    /// Factor of the second differences, 1/s.
    pub smoothness: f64,
    /// Largest turn of a rotary axis in a step, radians: candidates farther apart are not connected.
    pub most_turn: f64,
}

impl Costs {
    /// Difference of two candidates, axis 2 by its nearest winding.
    fn difference(from: &Joints5, to: &Joints5) -> Joints5 {
        let mut d: Joints5 = std::array::from_fn(|k| to[k] - from[k]);
        d[4] = nearest_turn(d[4], 0.0);
        d
    }

    fn step(&self, d: &Joints5) -> f64 {
        (0..5).map(|k| d[k].abs() / self.speed[k]).fold(0.0, f64::max)
    }

    fn second_difference(&self, before: &Joints5, after: &Joints5) -> f64 {
        self.smoothness * (0..5).map(|k| (after[k] - before[k]).powi(2) / self.acceleration[k]).sum::<f64>()
    }

    /// Cost of a chosen sequence: formula (4) and the penalties.
    pub fn of(&self, stations: &[Vec<AxisCandidate>], choice: &[usize]) -> f64 {
        let at = |i: usize| &stations[i][choice[i]];
        let steps: Vec<Joints5> =
            (1..choice.len()).map(|i| Self::difference(&at(i - 1).joints, &at(i).joints)).collect();
        let penalties: f64 = (0..choice.len()).map(|i| at(i).penalty).sum();
        let seconds: f64 = steps.windows(2).map(|w| self.second_difference(&w[0], &w[1])).sum();
        penalties + steps.iter().map(|d| self.step(d)).sum::<f64>() + seconds
    }

    /// The cheapest sequence: an index of a candidate for each station. Of equal sequences the first is taken.
    ///
    /// # Errors
    /// The first station that no sequence reaches: it has no candidates, or none near enough.
    pub fn shortest(&self, stations: &[Vec<AxisCandidate>]) -> Result<Vec<usize>, usize> {
        let Some(first) = stations.first() else { return Ok(Vec::new()) };
        if first.is_empty() {
            return Err(0);
        }
        let Some(second) = stations.get(1) else {
            let least = (0..first.len()).min_by(|a, b| first[*a].penalty.total_cmp(&first[*b].penalty));
            return Ok(least.into_iter().collect());
        };
        // A state is a step: the candidates at both of its ends, and the least cost of a sequence that ends with it.
        let mut layers: Vec<AxisLayer> = Vec::with_capacity(stations.len());
        layers.push(self.steps(first, second));
        for (i, step) in layers[0].iter_mut().enumerate() {
            step.before = i;
            step.cost += first[step.from].penalty + second[step.to].penalty;
        }
        if layers[0].is_empty() {
            return Err(1);
        }
        for (i, pair) in stations.windows(2).enumerate().skip(1) {
            let mut layer = self.steps(&pair[0], &pair[1]);
            let last = &layers[i - 1];
            // Steps of the previous layer, by the candidate at their end, the cheapest first: a change of the step costs
            // nothing at least, so the search ends at the first one that costs more than the best sum.
            let mut arriving: Vec<Vec<usize>> = vec![Vec::new(); pair[0].len()];
            for (k, step) in last.iter().enumerate() {
                arriving[step.to].push(k);
            }
            for steps in &mut arriving {
                steps.sort_by(|a, b| last[*a].cost.total_cmp(&last[*b].cost));
            }
            for step in &mut layer {
                let mut best = (f64::INFINITY, 0);
                for k in &arriving[step.from] {
                    if last[*k].cost >= best.0 {
                        break;
                    }
                    let cost = last[*k].cost + self.second_difference(&last[*k].difference, &step.difference);
                    if cost < best.0 {
                        best = (cost, *k);
                    }
                }
                step.cost += best.0 + pair[1][step.to].penalty;
                step.before = best.1;
            }
            layer.retain(|s| s.cost.is_finite());
            if layer.is_empty() {
                return Err(i + 1);
            }
            layers.push(layer);
        }
        let mut choice = vec![0; stations.len()];
        let end = layers.last().map_or(&[][..], Vec::as_slice);
        let mut at = (0..end.len()).min_by(|a, b| end[*a].cost.total_cmp(&end[*b].cost)).unwrap_or(0);
        for (i, layer) in layers.iter().enumerate().rev() {
            let step = &layer[at];
            choice[i + 1] = step.to;
            choice[i] = step.from;
            at = step.before;
        }
        Ok(choice)
    }

    /// All steps from one station to the next, each with only its own cost.
    fn steps(&self, from: &[AxisCandidate], to: &[AxisCandidate]) -> AxisLayer {
        let mut steps = Vec::new();
        for (i, a) in from.iter().enumerate() {
            for (j, b) in to.iter().enumerate() {
                let difference = Self::difference(&a.joints, &b.joints);
                if difference[3].abs().max(difference[4].abs()) <= self.most_turn {
                    steps.push(AxisStep { from: i, to: j, before: 0, difference, cost: self.step(&difference) });
                }
            }
        }
        steps
    }
}

type AxisLayer = Vec<AxisStep>;

/// A step between neighbouring stations.
struct AxisStep {
    from: usize,
    to: usize,
    before: usize,
    difference: Joints5,
    cost: f64,
}
