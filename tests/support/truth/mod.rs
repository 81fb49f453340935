//! What engines are judged by: fronts as plain lists of truths, meshes and rules from first principles, slow and short.
//!
//! Nothing here calls what it judges. Of an explicit model the cells are read, of a hierarchy the sequence of merges; what
//! needs what, who is whose neighbour and which cells a front has is told once more from the definitions.

mod cells;
mod merges;
mod rules;

pub use cells::Cells;
pub use merges::{Merges, Moment};
pub use rules::UnderScheme;

use mt_core::{Cell, CellId, Step};

/// A front: of each node, whether it is refined.
pub type Set = Vec<bool>;

/// A model as its definition has it.
pub trait Truth<const N: usize> {
    /// Number of nodes.
    fn len(&self) -> usize;
    /// Whether there is nothing to refine.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The mesh of a front, ascending by cell.
    fn mesh(&self, refined: &[bool]) -> Vec<(CellId, Cell<N>)>;
    /// What each node needs, and who needs it; `None` for dynamic rules.
    fn order(&self) -> Option<&Needs>;
    /// Whether a step is legal at a front. `None` where the rule is not told here.
    fn allows(&self, refined: &[bool], step: Step) -> Option<bool>;
    /// The nodes that a coarse step makes at once: first and last.
    fn run(&self, m: usize) -> (usize, usize) {
        (m, m)
    }
}

/// An order: what each node needs, and who needs it. Rows may say what other rows imply.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Needs {
    /// What each node needs.
    pub needs: Vec<Vec<usize>>,
    /// Who needs each node.
    pub dependents: Vec<Vec<usize>>,
}

impl Needs {
    /// The order of these pairs of a node and what it needs.
    pub fn new(count: usize, pairs: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let mut order = Self { needs: vec![Vec::new(); count], dependents: vec![Vec::new(); count] };
        for (m, need) in pairs {
            if !order.needs[m].contains(&need) {
                order.needs[m].push(need);
                order.dependents[need].push(m);
            }
        }
        order
    }

    /// Whether every refined node has what it needs.
    pub fn is_closed(&self, refined: &[bool]) -> bool {
        (0..refined.len()).all(|m| !refined[m] || self.needs[m].iter().all(|&need| refined[need]))
    }

    /// The least closed front that holds another.
    pub fn closure(&self, wish: &[bool]) -> Set {
        let mut refined = vec![false; wish.len()];
        let mut open: Vec<usize> = (0..wish.len()).filter(|&m| wish[m]).collect();
        while let Some(m) = open.pop() {
            if !std::mem::replace(&mut refined[m], true) {
                open.extend(&self.needs[m]);
            }
        }
        refined
    }

    /// Whether a step leads from a closed front to a closed front.
    pub fn allows(&self, refined: &[bool], step: Step) -> bool {
        let m = step.node.index();
        if step.refined {
            !refined[m] && self.needs[m].iter().all(|&need| refined[need])
        } else {
            refined[m] && !self.dependents[m].iter().any(|&other| refined[other])
        }
    }
}
