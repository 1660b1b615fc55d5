//! Tools of the library that may be taken: those that end in a ball.

use ir::{Program, Tool};

/// A tool of the library that ends in a ball.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Its name in the library.
    pub(crate) name: String,
    /// Radius of the ball, mm.
    pub(crate) ball: f64,
    pub(crate) tool: Tool,
}

impl Candidate {
    /// Whether its flutes have one diameter.
    pub(crate) fn is_straight(&self) -> bool {
        !self.tool.solid.cutter.widens()
    }

    /// Distance from the tip to the holder, mm.
    pub(crate) fn reach(&self) -> f64 {
        self.tool.solid.holder.first().map_or_else(|| self.tool.length(), |holder| holder.from)
    }

    /// Length of the flutes, mm.
    pub(crate) fn flute(&self) -> f64 {
        self.tool.solid.flute_length
    }
}

/// The tools of a program that end in a ball, with their names in the library, in the order in which they are taken: the largest ball
/// first; of equal ones the straight one, since a taper needs more of the channel, and then the stiffest.
pub(crate) fn candidates(program: &Program, names: &[String]) -> Vec<Candidate> {
    let with_ball = |(name, tool): (&String, &Tool)| {
        let cutter = &tool.solid.cutter;
        cutter.ends_in_ball().then(|| Candidate { name: name.clone(), ball: cutter.tip_radius(), tool: tool.clone() })
    };
    let tools = program.tools.iter().map(|(_, tool)| tool);
    let mut all: Vec<Candidate> = names.iter().zip(tools).filter_map(with_ball).collect();
    all.sort_by(|a, b| {
        let stiff = b.is_straight().cmp(&a.is_straight()).then(a.reach().total_cmp(&b.reach()));
        b.ball.total_cmp(&a.ball).then(stiff)
    });
    all
}

/// Least radius of a ball that is tried, as a share of the largest one that may fit.
const LEAST_SHARE: f64 = 0.3;

/// Number of tools that are tried for an operation.
const MAX_TRIED: usize = 10;

/// Candidates with a ball of at most a radius, mm, whose flutes are as long as a channel is deep: the first of each ball, then the second
/// ones. Where a tool has no axes, one with the same ball rarely has.
pub(crate) fn balls(all: &[Candidate], most: f64, depth: f64) -> Vec<&Candidate> {
    let fits = |c: &&Candidate| c.ball <= most + 1e-9 && c.ball >= LEAST_SHARE * most && c.flute() >= depth;
    let fitting: Vec<&Candidate> = all.iter().filter(fits).collect();
    let alike = |k: usize| fitting[..k].iter().filter(|other| other.ball == fitting[k].ball).count();
    let mut ranked: Vec<(usize, &Candidate)> = fitting.iter().enumerate().map(|(k, c)| (alike(k), *c)).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, candidate)| candidate).take(MAX_TRIED).collect()
}
