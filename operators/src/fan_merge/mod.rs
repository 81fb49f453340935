//! Fan-merge (`[LivnySokolovskyElSana2006]`): all vertices around a vertex are merged into it at once, or one at a time.
//!
//! A coarse step takes about twelve triangles away; the same step is a run of half-edge collapses, and each prefix of the
//! run is legal, so that a fine path may make them one at a time and stop anywhere. Where the paper is silent or cannot
//! be meant:
//!
//! - It does not say when a merge is legal, and unchecked merging breaks every mesh. Ours holds the link condition
//!   (`[DeyEdelsbrunner1999]`) at each collapse of the run, and no triangle may fold over at any of them.
//! - It merges "in a decreasing order of errors", which must be increasing; we also order the children of a fan so, as
//!   far as legality allows.
//! - Full fans stall while many vertices are left. What happens then is [`BelowStall`].
//! - Its quadrics are of unit planes of the triangles that a merge modifies, which is [`Planes::Current`] but for the
//!   weights: ours are areas. By default quadrics are accumulated from the input, as `[GarlandHeckbert1997]` does.
//! - That no full fan is left is told by trying each refused one once more before the first partial one; a fan that
//!   becomes legal between those two is found later. Partial fans are priced as if all their children went.
//! - The errors of a vertex need not grow, in its metric. Ours are root mean square distances in model units, of the
//!   quadric that a prefix has gathered, and no less than what the vertex and those merged into it had before.

mod aux;
mod run;
mod tally;
#[cfg(test)]
mod tests;

pub use aux::Aux;
pub use tally::{FanTally, Step};

use crate::edge_collapse::{BoundaryRule, manifold};
use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::{Plan, Refusal, VertexId};

/// The most vertices that one step may merge: the paper counts them in a byte.
pub const LINK_MAX: usize = 255;

/// Which planes the distance of the kept vertex is taken to.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Planes {
    /// Those of all input triangles that a vertex has gathered.
    #[default]
    Accumulated,
    /// Those of the triangles that the merge modifies, as the mesh is now: nothing is remembered, errors add up.
    Current,
}

/// What to do when no legal full fan is left.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum BelowStall {
    /// End there.
    Stop,
    /// Merge the children that can go: at least two, or one where nowhere two can.
    #[default]
    Partial,
    /// Merge the one child that is cheapest, until a full fan is legal again.
    Collapse,
}

/// Fan-merge by quadrics.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct FanMerge {
    /// Which planes to measure to.
    pub planes: Planes,
    /// What to do when no legal full fan is left.
    pub below_stall: BelowStall,
    /// Whether a fan's price is multiplied by the number of vertices around it, so that small fans go first.
    pub weigh_degree: bool,
    /// What may happen to boundary edges; a boundary vertex is merged along the boundary only.
    pub boundary: BoundaryRule,
    /// Weight of boundary planes, in squared edge lengths.
    pub boundary_weight: f64,
    /// The least cosine between a triangle's normal before and after; 1 forbids any turn, -1 allows all.
    pub fold_cosine: f64,
}

impl FanMerge {
    /// Full fans, then partial ones.
    pub const PARTIAL: Self = Self {
        planes: Planes::Accumulated,
        below_stall: BelowStall::Partial,
        weigh_degree: false,
        boundary: BoundaryRule::Weighted,
        boundary_weight: 4.0,
        fold_cosine: 0.2,
    };
    /// Full fans, then half-edge collapses.
    pub const COLLAPSE: Self = Self { below_stall: BelowStall::Collapse, ..Self::PARTIAL };
    /// Full fans and nothing else.
    pub const STOP: Self = Self { below_stall: BelowStall::Stop, ..Self::PARTIAL };
}

/// A vertex, how often its price has changed, and what is tried there.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Site {
    hub: VertexId,
    stamp: u32,
    round: Round,
}

/// What is tried at a vertex. Each is priced above all sites of those before it, so a round is over when the next begins.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Round {
    /// The full fan.
    Full,
    /// The full fan once more, when all others have been tried: what was in the way may be gone. Once an analysis has
    /// stalled, this is the next round.
    Again,
    /// As many children as can go, at least two.
    Partial,
    /// One child.
    Single,
}

/// How many vertices a step merges.
#[derive(Copy, Clone, Debug)]
enum Demand {
    /// All that are around.
    All,
    /// At least and at most so many.
    Between(usize, usize),
}

impl Operator<3> for FanMerge {
    type Site = Site;
    type Aux = Aux;

    fn name(&self) -> &'static str {
        "fan-merge"
    }

    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Site>) -> Result<Aux, Unfit> {
        let edges = manifold::check(&draft.complex, false)?;
        let vertices = (0..draft.positions.len()).map(VertexId::new).filter(|&v| draft.complex.has_star(v));
        sites.extend(vertices.map(|hub| Site { hub, stamp: 0, round: Round::Full }));
        Ok(Aux::new(self, draft, &edges))
    }

    fn price(&self, draft: &Draft<3>, aux: &Aux, site: Site) -> Option<f64> {
        if aux.is_stale(draft, site) {
            return None;
        }
        let round = self.round(aux, site);
        let price = match (round, self.planes) {
            (Round::Single, _) => aux.least_price(self, draft, site.hub),
            (_, Planes::Accumulated) => aux.price(self, site.hub),
            (_, Planes::Current) => aux.price_of_current(self, draft, site.hub),
        };
        Some(aux.in_round(price, round))
    }

    fn plan(&self, draft: &Draft<3>, aux: &Aux, site: Site, plan: &mut Plan<3>) -> Result<(), Refusal> {
        if aux.is_stale(draft, site) {
            return Err(Refusal::Stale);
        }
        let demand = match self.round(aux, site) {
            Round::Full | Round::Again => Demand::All,
            Round::Partial => Demand::Between(2, LINK_MAX),
            Round::Single => Demand::Between(1, 1),
        };
        run::plan(self, draft, aux, site.hub, demand, plan)
    }

    fn alternative(&self, site: Site, refusal: Refusal) -> Option<Site> {
        // Neither goes away while the fan stays as it is.
        let forever = matches!(refusal, Refusal::Boundary | Refusal::Limit);
        let round = match (self.below_stall, site.round) {
            (BelowStall::Stop, _) | (_, Round::Single) => return None,
            (_, Round::Full) if !forever => Round::Again,
            (BelowStall::Partial, Round::Full | Round::Again) => Round::Partial,
            _ => Round::Single,
        };
        Some(Site { round, ..site })
    }

    fn waits(&self, site: Site) -> bool {
        site.round == Round::Full
    }

    fn applied(&self, draft: &Draft<3>, aux: &mut Aux, plan: &Plan<3>, again: &mut Vec<Site>) {
        aux.merged(self, draft, plan, again);
    }
}

impl FanMerge {
    /// What is tried at a site. Below the stall a partial fan is as welcome as a full one, and nothing is tried twice.
    fn round(&self, aux: &Aux, site: Site) -> Round {
        match (self.below_stall, site.round) {
            (BelowStall::Partial, Round::Full | Round::Again) if aux.has_stalled() => Round::Partial,
            (BelowStall::Collapse, Round::Again) if aux.has_stalled() => Round::Single,
            (_, round) => round,
        }
    }
}
