//! One portion of a forest, replayed on the triangles around it: what dies at each of its nodes is what that node makes
//! appear, what is around it bounds it.
//!
//! The triangles around a portion have corners of other portions as well. These are strangers: they are merged when their
//! time comes, so that triangles are at each node what they are in the whole mesh, and nothing is asked of them.

use super::build::include;
use super::patch::{Fan, Links, Patch};
use super::portions::Portions;
use super::replay::{Node, Replay};
use crate::bound::Bound;
use crate::cell::Cell;
use crate::complex::{Complex, Slot};
use crate::id::{CellId, NodeId, VertexId};
use glam::Vec3;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// What belongs to a portion, and what it is replayed on.
pub(super) struct Portion {
    /// The ranks of its leaves; none of what lies across cuts.
    pub(super) leaves: Range<u32>,
    /// Its merges, ascending.
    pub(super) merges: Vec<u32>,
    /// At least all triangles that are ever around a vertex of it, ascending.
    pub(super) cells: Vec<u32>,
}

/// What is found out about a portion. Nodes are those of its merges, one after the other.
pub(super) struct Found {
    /// Bounded; by all that is under them, if the portion has leaves.
    pub(super) nodes: Vec<Node>,
    /// Where the triangles of each node begin, and where those of the last end.
    pub(super) starts: Vec<u32>,
    /// The triangles that appear at each node, ascending.
    pub(super) born: Vec<CellId>,
    /// The nodes whose merged vertex is not the centre of one umbrella.
    pub(super) sewn: Vec<NodeId>,
    /// Whether all leaves that have triangles are centres of umbrellas.
    pub(super) is_manifold: bool,
    /// The triangles that are around vertices across the cuts at any time, as far as vertices of the portion lead there.
    pub(super) crossed: Vec<u32>,
}

/// Names that begin at 0 in each portion: leaves by rank, merged vertices in their order, strangers as they are met.
struct Names<'a> {
    replay: &'a Replay,
    portion: &'a Portion,
    strangers: FxHashMap<VertexId, VertexId>,
    /// The vertices by name; none where one was not met.
    known: Vec<VertexId>,
    /// Whether a merge of the portion takes the vertex.
    is_taken: Vec<bool>,
}

impl<'a> Names<'a> {
    fn new(replay: &'a Replay, portion: &'a Portion) -> Self {
        let own = portion.leaves.len() + portion.merges.len();
        let (known, is_taken) = (vec![VertexId::NONE; own], vec![false; own]);
        Self { replay, portion, strangers: FxHashMap::default(), known, is_taken }
    }

    /// The name of what the merge at this place in the portion makes.
    fn made(&self, place: usize) -> VertexId {
        VertexId::new(self.portion.leaves.len() + place)
    }

    #[inline]
    fn of(&mut self, v: VertexId) -> VertexId {
        let Portion { leaves, merges, .. } = self.portion;
        let own = match self.replay.merge_making(v) {
            None => {
                let place = self.replay.rank(v).wrapping_sub(leaves.start);
                (place < leaves.end - leaves.start).then_some(VertexId(place))
            }
            Some(merge) => merges.binary_search(&merge).ok().map(|place| self.made(place)),
        };
        match own {
            Some(name) => {
                self.known[name.index()] = v;
                name
            }
            None => self.of_stranger(v),
        }
    }

    #[inline(never)]
    fn of_stranger(&mut self, v: VertexId) -> VertexId {
        let next = VertexId::new(self.known.len());
        let name = *self.strangers.entry(v).or_insert(next);
        if name == next {
            self.known.push(v);
            self.is_taken.push(false);
        }
        name
    }
}

/// Two vertices become one, by their names in the portion. The first may be what they become.
struct Step {
    node: NodeId,
    ends: [VertexId; 2],
    into: VertexId,
}

/// The steps of the portion's nodes, ascending.
fn own_steps(names: &mut Names) -> Vec<Step> {
    let (replay, portion) = (names.replay, names.portion);
    let mut steps = Vec::with_capacity(portion.merges.len());
    for (place, &merge) in portion.merges.iter().enumerate() {
        let into = names.made(place);
        let (first, end) = replay.run_of(merge).into_inner();
        names.known[into.index()] = replay.vertex(first);
        for node in (first.0..=end.0).map(NodeId) {
            let [stays, child] = replay.ends(node);
            let ends = [if node == first { names.of(stays) } else { into }, names.of(child)];
            ends.into_iter().filter(|&end| end != into).for_each(|end| names.is_taken[end.index()] = true);
            steps.push(Step { node, ends, into });
        }
    }
    steps
}

/// What is met in a portion and merged by others. It is followed as long as it has triangles here, and what it comes to be is
/// named when that happens: a chain of merges elsewhere may be long, and mean nothing here.
struct Others<'a> {
    names: Names<'a>,
    portions: &'a Portions,
    /// The last node of the portion.
    last: NodeId,
    /// Who is merged when. At one node the centre goes before the child, as in a step of one's own: what comes of stars in
    /// which order is the same everywhere.
    waiting: BinaryHeap<Reverse<(NodeId, bool, VertexId)>>,
    /// A name that nobody has.
    free: VertexId,
}

impl<'a> Others<'a> {
    fn new(mut names: Names<'a>, portions: &'a Portions, last: NodeId) -> Self {
        let free = VertexId::new(names.known.len());
        names.known.push(VertexId::NONE);
        names.is_taken.push(false);
        let mut others = Self { names, portions, last, waiting: BinaryHeap::new(), free };
        (0..free.index()).for_each(|name| others.wait(VertexId::new(name)));
        others
    }

    /// Lets a name wait for its merge, if others make it before the portion is done.
    fn wait(&mut self, name: VertexId) {
        let (v, replay) = (self.names.known[name.index()], self.names.replay);
        if v.is_none() || self.names.is_taken[name.index()] {
            return;
        }
        let node = replay.merged_at(v);
        if node <= self.last {
            self.waiting.push(Reverse((node, v == replay.node(node).child, name)));
        }
    }

    /// Makes the merges of others before a node.
    fn go_on_until(&mut self, node: NodeId, finding: &mut Finding) {
        while let Some(&Reverse((at, _, from))) = self.waiting.peek().filter(|next| next.0.0 < node) {
            self.waiting.pop();
            if !finding.mesh.has_star(from) {
                continue;
            }
            let replay = self.names.replay;
            let made = replay.vertex(at);
            let is_across = self.portions.is_across(replay.span(made));
            if let Some(&into) = self.names.strangers.get(&made) {
                finding.let_others(from, into, is_across);
                continue;
            }
            let into = std::mem::replace(&mut self.free, from);
            self.names.known[into.index()] = made;
            self.names.strangers.insert(made, into);
            finding.patch.put(into, replay.positions[made.index()]);
            finding.let_others(from, into, is_across);
            self.wait(into);
        }
    }
}

/// Replays a portion. O(stars of its merges, and of the strangers that are merged in its time, with a logarithm for each of
/// these merges).
///
/// Where links are closed walks, they stay so as long as no node of the whole forest sews or pinches: with `trusting` they
/// are not looked at again. If any portion then finds a node that does, what was found is worth nothing.
pub(super) fn find(replay: &Replay, portions: &Portions, portion: &Portion, trusting: bool) -> Found {
    let mut names = Names::new(replay, portion);
    let corners = |&cell: &u32| replay.cells[cell as usize].map(|v| names.of(v));
    let cells: Vec<Cell<3>> = portion.cells.iter().map(corners).collect();
    let own = own_steps(&mut names);
    // A portion without merges has nobody to wait for.
    let last = own.last().map_or(NodeId(0), |step| step.node);
    let mut others = Others::new(names, portions, last);
    // What was never met is nowhere.
    let place = |v: &VertexId| if v.is_none() { Vec3::ZERO } else { replay.positions[v.index()] };
    let positions: Vec<Vec3> = others.names.known.iter().map(place).collect();
    let mut finding = Finding::new(replay, portion, positions, &cells);
    finding.look_at_leaves(trusting);
    for step in &own {
        others.go_on_until(step.node, &mut finding);
        finding.take(step, trusting);
    }
    let Finding { mesh, mut found, mut crossed, .. } = finding;
    // Whatever has an own vertex that is not a root will be around a vertex across the cuts.
    let own = portion.leaves.len() + portion.merges.len();
    let goes_on = |v: &VertexId| v.index() < own && !replay.merged_at(others.names.known[v.index()]).is_none();
    crossed.extend(mesh.cells().filter(|(_, corners)| corners.iter().any(goes_on)).map(|(slot, _)| slot));
    crossed.sort_unstable();
    crossed.dedup();
    found.crossed = crossed.into_iter().map(|slot| portion.cells[slot as usize]).collect();
    found
}

/// A portion under way.
struct Finding<'a> {
    replay: &'a Replay,
    portion: &'a Portion,
    mesh: Complex<3>,
    patch: Patch,
    links: Links,
    /// Of each vertex: whether its link is known to be a closed walk.
    is_closed: Vec<bool>,
    /// Of each vertex: the place of the last node that made it, if the portion did.
    latest: Vec<u32>,
    /// The triangles that come to be around a vertex across the cuts.
    crossed: Vec<Slot>,
    found: Found,
}

impl<'a> Finding<'a> {
    fn new(replay: &'a Replay, portion: &'a Portion, positions: Vec<Vec3>, cells: &[Cell<3>]) -> Self {
        let vertices = positions.len();
        let found = Found {
            nodes: Vec::with_capacity(portion.merges.len()),
            starts: vec![0],
            born: Vec::with_capacity(cells.len()),
            sewn: Vec::new(),
            is_manifold: true,
            crossed: Vec::new(),
        };
        Self {
            replay,
            portion,
            mesh: Complex::new(vertices, cells),
            patch: Patch::new(positions, cells),
            links: Links::default(),
            is_closed: vec![false; vertices],
            latest: vec![u32::MAX; vertices],
            crossed: Vec::new(),
            found,
        }
    }

    fn look_at_leaves(&mut self, trusting: bool) {
        for leaf in (0..self.portion.leaves.len()).map(VertexId::new).filter(|&leaf| self.mesh.has_star(leaf)) {
            let fan = self.links.fan(&self.mesh, leaf);
            self.found.is_manifold &= fan != Fan::Other;
            self.is_closed[leaf.index()] = trusting && fan == Fan::Closed;
        }
    }

    /// Lets others merge a vertex into another; keeps what comes to be around a vertex across the cuts.
    fn let_others(&mut self, from: VertexId, into: VertexId, is_across: bool) {
        if is_across {
            self.crossed.extend(self.mesh.star(from).map(|(slot, _)| slot));
        }
        self.mesh.join_star(from, into, |slot, _, _, _| self.patch.moved(slot));
    }

    /// Makes a step of the portion.
    fn take(&mut self, step: &Step, trusting: bool) {
        let &Step { node: m, ends, into } = step;
        let (mesh, found) = (&mut self.mesh, &mut self.found);
        let from = found.born.len();
        let died = |slot| found.born.push(CellId(self.portion.cells[slot as usize]));
        let seen = self.patch.merge(mesh, ends, into, died);
        found.born[from..].sort_unstable();
        found.starts.push(found.born.len() as u32);
        let died = found.born.len() - from;
        // A third neighbour in common is a loop that closes: a waist, or a hole with three edges.
        let closes = seen.shared != died;
        // Two links that are cycles and have two vertices in common, besides each other's, are joined into a cycle; no
        // need to look, unless it is a cycle of two.
        let is_cycle = ends.iter().all(|end| self.is_closed[end.index()])
            && !closes
            && died == 2
            && mesh.star(into).nth(2).is_some();
        let fan = if is_cycle { Fan::Closed } else { self.links.fan(mesh, into) };
        self.is_closed[into.index()] = trusting && fan == Fan::Closed;
        if closes || fan == Fan::Other {
            found.sewn.push(m);
        }
        self.keep(step, Node { radius: seen.radius, cone: seen.cone, ..*self.replay.node(m) });
    }

    /// Keeps a node, grown until it holds those under it.
    fn keep(&mut self, step: &Step, mut node: Node) {
        let place = self.found.nodes.len() as u32;
        if !self.portion.leaves.is_empty() {
            let center = self.patch.position(step.into);
            let mut under = step.ends.map(|end| (self.latest[end.index()], end));
            under.sort_unstable();
            for (place, end) in under.into_iter().filter(|(place, _)| *place != u32::MAX) {
                let Node { error, radius, cone, .. } = self.found.nodes[place as usize];
                include(&mut node, center, &Bound { center: self.patch.position(end), radius, error, cone });
            }
        }
        self.latest[step.into.index()] = place;
        self.found.nodes.push(node);
    }
}
