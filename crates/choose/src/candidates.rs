//! Tools of the library that may be taken.

use ir::{Program, Tool};
use tool_stock::collide::Section;

/// A tool of the library.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Its name in the library.
    pub(crate) name: String,
    pub(crate) tool: Tool,
}

impl Candidate {
    /// Radius of its ball, mm; `None` where its end is no ball.
    pub(crate) fn ball(&self) -> Option<f64> {
        let cutter = &self.tool.solid.cutter;
        cutter.ends_in_ball().then(|| cutter.tip_radius())
    }

    /// Whether its flutes have one diameter.
    pub(crate) fn is_straight(&self) -> bool {
        !self.tool.solid.cutter.widens()
    }

    /// Distance from the tip to the holder, mm.
    pub(crate) fn reach(&self) -> f64 {
        self.tool.solid.holder.first().map_or_else(|| self.tool.length(), |holder: &Section| holder.from)
    }

    /// Length of the flutes, mm.
    pub(crate) fn flute(&self) -> f64 {
        self.tool.solid.flute_length
    }
}

/// The tools of a program as candidates, with their names in the library.
pub(crate) fn candidates(program: &Program, names: &[String]) -> Vec<Candidate> {
    let tools = program.tools.iter().map(|(_, tool)| tool);
    names.iter().zip(tools).map(|(name, tool)| Candidate { name: name.clone(), tool: tool.clone() }).collect()
}

/// Least radius of a ball that is tried, as a share of the largest one that may fit.
const LEAST_SHARE: f64 = 0.3;

/// Number of tools that are tried for an operation.
const MAX_TRIED: usize = 10;

/// Balls of at most a radius whose flutes are as long as a channel is deep, in the order in which they are tried: the largest
/// first; of these the straight ones, since a taper needs more of the channel, and then the stiffest.
pub(crate) fn balls(all: &[Candidate], most: f64, depth: f64) -> Vec<&Candidate> {
    let fits =
        |c: &&Candidate| c.ball().is_some_and(|r| r <= most + 1e-9 && r >= LEAST_SHARE * most) && c.flute() >= depth;
    let mut balls: Vec<&Candidate> = all.iter().filter(fits).collect();
    let radius = |c: &Candidate| c.ball().unwrap_or(0.0);
    let order = |a: &&Candidate, b: &&Candidate| {
        let stiff = b.is_straight().cmp(&a.is_straight()).then(a.reach().total_cmp(&b.reach()));
        radius(b).total_cmp(&radius(a)).then(stiff)
    };
    balls.sort_by(order);
    balls.truncate(MAX_TRIED);
    balls
}
