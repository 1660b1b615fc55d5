//! Tools that may be taken: those that the job declares, and those of its libraries.

use ir::{Program, Tool, ToolId};

/// A tool that may be taken.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Its name in the job, or in the library.
    pub(crate) name: String,
    /// Whether the job declares it.
    pub(crate) declared: bool,
    /// Its place in the program that it was read from.
    pub(crate) id: ToolId,
    /// Radius of the ball that it ends in, mm; 0 without one.
    pub(crate) ball: f64,
    pub(crate) tool: Tool,
}

impl Candidate {
    /// Whether it ends in a ball.
    pub(crate) fn is_ball(&self) -> bool {
        self.ball > 0.0
    }

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

/// The tools of a program, in the order in which they are taken: the largest ball first; of equal ones the straight one, since a taper
/// needs more of the channel, then one that the job declares, and then the stiffest. `named` gives the name of a tool of the program
/// in the job or the library, and whether the job declares it.
pub(crate) fn candidates(program: &Program, named: &dyn Fn(&str) -> Option<(String, bool)>) -> Vec<Candidate> {
    let read = |(id, tool): (ToolId, &Tool)| {
        let cutter = &tool.solid.cutter;
        let (name, declared) = named(&tool.name)?;
        let ball = if cutter.ends_in_ball() { cutter.tip_radius() } else { 0.0 };
        Some(Candidate { name, declared, id, ball, tool: tool.clone() })
    };
    let mut all: Vec<Candidate> = program.tools.iter().filter_map(read).collect();
    all.sort_by(|a, b| {
        let stiff = b.declared.cmp(&a.declared).then(a.reach().total_cmp(&b.reach()));
        b.ball.total_cmp(&a.ball).then(b.is_straight().cmp(&a.is_straight())).then(stiff)
    });
    all
}

/// Least radius of a ball that is tried, as a share of the largest one that may fit.
pub(crate) const LEAST_SHARE: f64 = 0.3;

/// Least length of flutes that counts as the depth of a channel, as a share of it.
const SLANT: f64 = 0.9;

/// Number of tools that are tried for an operation.
const MAX_TRIED: usize = 10;

/// Candidates with a ball of at most a radius, mm, that sticks out as far as a channel is deep: those whose flutes are as long first, and
/// of them the first of each ball, then the second ones. Where a tool has no axes, one with the same ball rarely has.
pub(crate) fn balls(all: &[Candidate], most: f64, depth: f64) -> Vec<usize> {
    let fits =
        |c: &Candidate| c.is_ball() && c.ball <= most + 1e-9 && c.ball >= LEAST_SHARE * most && c.reach() >= depth;
    let fitting: Vec<usize> = (0..all.len()).filter(|k| fits(&all[*k])).collect();
    // The depth is that of the longest ruling, which is slanted.
    let is_short = |k: usize| all[k].flute() < SLANT * depth;
    let alike = |at: usize| {
        let before = fitting[..at].iter().filter(|k| is_short(**k) == is_short(fitting[at]));
        before.filter(|k| all[**k].ball == all[fitting[at]].ball).count()
    };
    let mut ranked: Vec<((bool, usize), usize)> =
        fitting.iter().enumerate().map(|(at, k)| ((is_short(*k), alike(at)), *k)).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, k)| k).take(MAX_TRIED).collect()
}
