//! Making a case small: nodes go by closed sets, at either end of the order; then cells go that the failure does not need.
//!
//! A node can go in two ways: it stays refined for ever (with all that it needs), or it stays coarse for ever (with all
//! that need it). So what is left is what lies between two closed fronts, a model again. Chunks go first, halves, then
//! quarters, as in delta debugging; with every success all further tries cost less, so a model of many thousand cells
//! takes few looks at its full size.

use super::shrink::without;
use mt_core::check::{Breach, Law, Random};
use mt_core::hierarchy::Story;
use mt_core::{CellId, Explicit, Front, NodeId, Order, Replay};
use std::sync::Arc;
use std::time::Instant;

/// What has parts of its own kind.
pub(super) trait Divisible: Sized {
    /// An order whose closed sets bound parts.
    fn order(&self) -> Order;
    /// Number of cells of the input.
    fn cell_count(&self) -> usize;
    /// What lies between two fronts, of the cells those that `keep` names, and those that have to be there.
    fn between(&self, low: &Front, high: &Front, keep: &dyn Fn(CellId) -> bool) -> Option<Self>;
}

impl<const N: usize> Divisible for Explicit<N> {
    fn order(&self) -> Order {
        Explicit::order(self).clone()
    }
    fn cell_count(&self) -> usize {
        self.input_cell_count() as usize
    }
    fn between(&self, low: &Front, high: &Front, keep: &dyn Fn(CellId) -> bool) -> Option<Self> {
        Explicit::between(self, low, high, keep).ok()
    }
}

/// By the forest alone: a part of a sequence is a sequence, whatever the scheme.
impl Divisible for Arc<Replay> {
    fn order(&self) -> Order {
        let mut rows = mt_core::order::Rows::default();
        (0..self.len()).for_each(|m| rows.push(self.parent(NodeId(m))));
        Order::from_needs(rows).expect("parents have higher ranks")
    }
    fn cell_count(&self) -> usize {
        self.cells().len()
    }
    fn between(&self, low: &Front, high: &Front, keep: &dyn Fn(CellId) -> bool) -> Option<Self> {
        // Merges that sew a part together, and not the whole, are another fault; where they do sew the whole, what they
        // do it to has to be there.
        let whole = self.is_manifold();
        let touched = |cell: CellId| self.cells()[cell.index()].iter().any(|&v| !self.merged_at(v).is_none());
        let part = Replay::between(self, low, high, &|cell| keep(cell) || !whole && touched(cell)).replay().ok()?;
        (part.is_manifold() || !whole).then(|| Arc::new(part))
    }
}

/// The story of a replay as it is.
pub(super) fn story_of(replay: &Replay) -> Story {
    replay.between(&Front::base(replay.len()), &Front::reference(replay.len()), &|_| true)
}

/// Where a law is broken, and what is wrong there.
#[derive(Clone, Debug)]
pub(super) struct At {
    /// The front; where the model as a whole is wrong, one that shows the node.
    pub(super) front: Front,
    pub(super) breach: Breach,
    /// What else was drawn there: steps, other fronts, criteria.
    pub(super) case: Random,
}

/// Judges a part: at the front that is carried along, and where the part is small at others.
pub(super) type Judge<'a, S> = dyn Fn(&S, &Front) -> Option<At> + 'a;

/// Whether two laws say the same of different things: a bad mesh may show in one or the other as it gets smaller.
pub(super) fn alike(one: Law, other: Law) -> bool {
    let kind = |law| match law {
        Law::Conformity | Law::Cells | Law::CrackFree | Law::Quotient | Law::Partition => 0,
        Law::Order | Law::Closure => 1,
        Law::Inverse | Law::FrontDeterminesMesh | Law::Ends => 2,
        Law::Minimality | Law::Saturation => 3,
        Law::Determinism => 4,
        Law::Conduct => 5,
    };
    kind(one) == kind(other)
}

/// The smallest part of `start` in which the same law is broken; `None` where no part has it.
pub(super) fn smallest<S: Divisible>(start: &S, at: &At, judge: &Judge<S>, deadline: Instant) -> Option<(S, At)> {
    let mut search = Search { start, found: None, at: at.clone(), judge, deadline, exact: true };
    if let Some(m) = at.breach.node.filter(|m| m.0 < size_of(start)) {
        search.alone(m);
    }
    search.go_on();
    if search.subject().cell_count() > FEW {
        search.exact = false;
        search.go_on();
    }
    search.found.map(|part| (part, search.at))
}

/// A case of so many cells can be looked at. Above, a law that says much the same may take the place of the one broken.
const FEW: usize = 48;

fn size_of<S: Divisible>(subject: &S) -> u32 {
    subject.order().len()
}

struct Search<'a, S> {
    start: &'a S,
    found: Option<S>,
    /// Of what was found, or of the start.
    at: At,
    judge: &'a Judge<'a, S>,
    deadline: Instant,
    /// Whether it has to be the same law.
    exact: bool,
}

impl<S: Divisible> Search<'_, S> {
    fn subject(&self) -> &S {
        self.found.as_ref().unwrap_or(self.start)
    }

    fn size(&self) -> (u32, usize) {
        (size_of(self.subject()), self.subject().cell_count())
    }

    /// Drops nodes and cells as long as that gets somewhere.
    fn go_on(&mut self) {
        loop {
            let before = self.size();
            self.drop_nodes();
            self.drop_cells();
            if self.size() == before || Instant::now() >= self.deadline {
                return;
            }
        }
    }

    /// Tries a part; keeps it if the same law is broken there.
    fn try_part(&mut self, low: &Front, high: &Front, keep: &dyn Fn(CellId) -> bool) -> bool {
        if Instant::now() >= self.deadline {
            return false;
        }
        let Some(subject) = self.subject().between(low, high, keep) else { return false };
        let nodes: Vec<NodeId> = high.difference(low).collect();
        let refined = nodes.iter().enumerate().filter(|(_, m)| self.at.front.is_refined(**m));
        let mut carried = Front::from_nodes(nodes.len() as u32, refined.map(|(i, _)| NodeId::new(i)));
        // The part may order its nodes otherwise than the whole.
        subject.order().close(&mut carried);
        let law = self.at.breach.law;
        let same = |at: &At| at.breach.law == law || !self.exact && alike(at.breach.law, law);
        match (self.judge)(&subject, &carried).filter(same) {
            Some(at) => {
                (self.found, self.at) = (Some(subject), at);
                true
            }
            None => false,
        }
    }

    /// The node by itself: what it needs refined, and nothing that needs it.
    fn alone(&mut self, m: NodeId) {
        let order = self.subject().order();
        let mut low = Front::from_nodes(order.len(), order.needs(m).iter().copied());
        order.close(&mut low);
        let mut high = low.clone();
        high.set(m, true);
        self.at.front = high.clone();
        if !self.try_part(&low, &high, &|_| false) {
            self.try_part(&low, &high, &|_| true);
        }
    }

    /// Drops nodes in chunks, each refined for ever or coarse for ever.
    fn drop_nodes(&mut self) {
        let mut chunk = size_of(self.subject()).div_ceil(2);
        while chunk > 0 && Instant::now() < self.deadline {
            let mut shrunk = false;
            let mut at = 0;
            while at < size_of(self.subject()) {
                let order = self.subject().order();
                let count = order.len();
                let part: Vec<NodeId> = (at..(at + chunk).min(count)).map(NodeId).collect();
                let coarse = without(&order, &Front::reference(count), &part);
                let mut refined = Front::from_nodes(count, part);
                order.close(&mut refined);
                let dropped = self.try_part(&Front::base(count), &coarse, &|_| true)
                    || self.try_part(&refined, &Front::reference(count), &|_| true);
                shrunk |= dropped;
                at += if dropped { 0 } else { chunk };
            }
            let left = size_of(self.subject());
            chunk = if shrunk { chunk.min(left.div_ceil(2)) } else { chunk / 2 };
        }
    }

    /// Drops cells in chunks: first all that nothing kills.
    fn drop_cells(&mut self) {
        let count = size_of(self.subject());
        let (low, high) = (Front::base(count), Front::reference(count));
        let before = self.subject().cell_count();
        if self.try_part(&low, &high, &|_| false) && self.subject().cell_count() < before {
            return;
        }
        let mut chunk = before.div_ceil(2);
        while chunk > 0 && Instant::now() < self.deadline {
            let mut shrunk = false;
            let mut at = 0;
            while at < self.subject().cell_count() && Instant::now() < self.deadline {
                let (left, gone) = (self.subject().cell_count(), at..at + chunk);
                // Cells that must be there stay, and then nothing is won.
                let dropped = self.try_smaller(&low, &high, &|cell| !gone.contains(&cell.index()), left);
                shrunk |= dropped;
                at += if dropped { 0 } else { chunk };
            }
            chunk = if shrunk { chunk.min(self.subject().cell_count().div_ceil(2)) } else { chunk / 2 };
        }
    }

    fn try_smaller(&mut self, low: &Front, high: &Front, keep: &dyn Fn(CellId) -> bool, than: usize) -> bool {
        let smaller = self.subject().between(low, high, keep).is_some_and(|part| part.cell_count() < than);
        smaller && self.try_part(low, high, keep)
    }
}

/// Random closed fronts to look at besides the one that is carried along: the smaller the case, the more.
pub(super) fn fronts_to_try(nodes: u32) -> u32 {
    (4_000 / nodes.max(1)).min(24)
}
