//! The dependency schemes by their definitions, on the meshes of the analysis and on the current one.

use super::merges::{Merges, Moment};
use super::{Needs, Truth};
use mt_core::{Cell, CellId, Step};
use operators::order::Scheme;
use std::sync::Arc;

/// A sequence of merges under a scheme.
#[derive(Clone, Debug)]
pub struct UnderScheme {
    /// The sequence.
    pub merges: Arc<Merges>,
    scheme: Scheme,
    order: Option<Needs>,
}

impl UnderScheme {
    /// Looks at the mesh before each node of the analysis, and writes down what the scheme would have it wait for.
    pub fn new(merges: Arc<Merges>, scheme: Scheme) -> Self {
        let pairs = match scheme {
            Scheme::Explicit => Some(explicit(&merges)),
            Scheme::OneRing => Some(stages(&merges, |m, now| next_of(now, now.around(m)))),
            Scheme::CutPair => Some(stages(&merges, |m, now| next_of(now, apexes(&merges, m, now)))),
            Scheme::FourFace => Some([four_face(&merges), dual_piece(&merges)].concat()),
            Scheme::DualPiece => Some(dual_piece(&merges)),
            Scheme::ImplicitIds | Scheme::ImplicitIdsStored | Scheme::DualPieceFree => None,
        };
        let order = pairs.map(|mut pairs| {
            pairs.extend((0..merges.len()).filter_map(|m| Some((m, merges.parent[m]?))));
            Needs::new(merges.len(), pairs)
        });
        Self { merges, scheme, order }
    }

    /// Whether a dynamic rule lets a step be taken; `None` for stored ids, whose rule is unsound and not told twice.
    fn lets(&self, now: &Moment<'_>, refined: &[bool], step: Step) -> Option<bool> {
        let (merges, m) = (&*self.merges, step.node.index());
        let free = match (self.scheme, step.refined) {
            // A split's id is above those of all neighbours, a merge's parent below all the neighbours' parents.
            (Scheme::ImplicitIds, true) => now.ring(merges.vertex[m]).iter().all(|&w| now.latest(w) < Some(m)),
            (Scheme::ImplicitIds, false) => now.around(m).iter().all(|&w| now.next(w).is_none_or(|next| next > m)),
            // The two cut vertices differ; the ends have no neighbour in common but the cut vertices.
            (Scheme::DualPieceFree, true) => {
                let cuts: Vec<usize> = cut_leaves(merges, m).iter().map(|&leaf| now.above[leaf]).collect();
                cuts.len() != 2 || cuts[0] != cuts[1]
            }
            (Scheme::DualPieceFree, false) => {
                let [rings, cuts] = [merges.ends[m].map(|end| now.ring(end)), [apexes(merges, m, now), Vec::new()]];
                let ends = merges.ends[m];
                rings[0].iter().all(|w| !rings[1].contains(w) || cuts[0].contains(w) || ends.contains(w))
            }
            _ => return None,
        };
        let forest = if step.refined {
            merges.parent[m].is_none_or(|parent| refined[parent])
        } else {
            (0..merges.len()).all(|child| merges.parent[child] != Some(m) || !refined[child])
        };
        Some(free && forest && refined[m] != step.refined)
    }
}

impl Truth<3> for UnderScheme {
    fn len(&self) -> usize {
        self.merges.len()
    }

    fn mesh(&self, refined: &[bool]) -> Vec<(CellId, Cell<3>)> {
        self.merges.at(refined).mesh()
    }

    fn order(&self) -> Option<&Needs> {
        self.order.as_ref()
    }

    fn allows(&self, refined: &[bool], step: Step) -> Option<bool> {
        match &self.order {
            Some(order) => Some(order.allows(refined, step)),
            None if self.scheme == Scheme::ImplicitIdsStored => None,
            None => self.lets(&self.merges.at(refined), refined, step),
        }
    }

    fn run(&self, m: usize) -> (usize, usize) {
        self.merges.runs[m]
    }
}

type Pairs = Vec<(usize, usize)>;

/// What each node needs, as the mesh just before it in the analysis tells.
fn stages(merges: &Merges, needs: impl Fn(usize, &Moment<'_>) -> Vec<usize>) -> Pairs {
    let mut refined = vec![true; merges.len()];
    let mut pairs = Vec::new();
    for m in 0..merges.len() {
        pairs.extend(needs(m, &merges.at(&refined)).into_iter().map(|need| (m, need)));
        refined[m] = false;
    }
    pairs
}

fn next_of(now: &Moment<'_>, vertices: Vec<usize>) -> Vec<usize> {
    vertices.into_iter().filter_map(|w| now.next(w)).collect()
}

/// The third corners of the triangles on the edge between the ends.
fn apexes(merges: &Merges, m: usize, now: &Moment<'_>) -> Vec<usize> {
    let ends = merges.ends[m];
    let on_edge = now.cells.iter().filter(|(_, corners)| ends.iter().all(|end| corners.contains(end)));
    on_edge.flat_map(|(_, corners)| *corners).filter(|w| !ends.contains(w)).collect()
}

/// Whoever changed a cell first needs whoever changes it next.
fn explicit(merges: &Merges) -> Pairs {
    let mut maker = vec![None; merges.cells.len()];
    let mut refined = vec![true; merges.len()];
    let mut pairs = Vec::new();
    for m in 0..merges.len() {
        let changed = if merges.kept[m] { &merges.ends[m][1..] } else { &merges.ends[m][..] };
        for (cell, _) in merges.at(&refined).cells.iter().filter(|(_, cell)| changed.iter().any(|v| cell.contains(v))) {
            pairs.extend(maker[*cell].replace(m).map(|maker| (maker, m)));
        }
        refined[m] = false;
    }
    pairs
}

/// The triangles beside the two that die, across the edges that do not, have to be there.
fn four_face(merges: &Merges) -> Pairs {
    let dies_at = |cell: usize| merges.born.iter().position(|born| born.contains(&cell));
    stages(merges, |m, now| {
        let dying = |cell: usize| merges.born[m].contains(&cell);
        let corners = |cell: usize| now.cells.iter().find(|(other, _)| *other == cell).expect("it is there").1;
        let beside = |cell: usize, other: &[usize; 3]| corners(cell).iter().filter(|v| other.contains(v)).count() == 2;
        let besides = now
            .cells
            .iter()
            .filter(|(other, at)| !dying(*other) && merges.born[m].iter().any(|&cell| beside(cell, at)));
        besides.filter_map(|(cell, _)| dies_at(*cell)).collect()
    })
}

/// The vertices of the input opposite the edge, in the triangles that die.
fn cut_leaves(merges: &Merges, m: usize) -> Vec<usize> {
    // Under the merged vertex are the leaves that have the node on their path.
    let under = |leaf: &usize| merges.path(*leaf).contains(&m);
    let third = |cell: &usize| merges.cells[*cell].iter().map(|v| v.index()).find(|leaf| !under(leaf));
    merges.born[m].iter().filter_map(third).collect()
}

/// The lowest node above both fundamental cut vertices.
fn dual_piece(merges: &Merges) -> Pairs {
    let of = |m: usize| {
        let [left, right] = cut_leaves(merges, m)[..] else { return None };
        let right = merges.path(right);
        merges.path(left).into_iter().find(|node| right.contains(node)).map(|node| (m, node))
    };
    (0..merges.len()).filter_map(of).collect()
}
