//! An explicit model by set algebra: the cells of a front are those of the base and of all fine sides, less all coarse.

use super::{Needs, Truth};
use mt_core::{Cell, CellId, Explicit, NodeId, Step};
use std::collections::BTreeSet;

/// The cells of an explicit model, and what follows from them.
#[derive(Clone, Debug)]
pub struct Cells<const N: usize> {
    corners: Vec<Cell<N>>,
    base: BTreeSet<u32>,
    fine: Vec<Vec<u32>>,
    coarse: Vec<Vec<u32>>,
    order: Needs,
}

impl<const N: usize> Cells<N> {
    /// Reads the two sides of each node; the base is what no node kills, and a node needs who kills what it made.
    pub fn new(model: &Explicit<N>) -> Self {
        let count = model.parts().node_count();
        let fine: Vec<Vec<u32>> =
            (0..count).map(|m| model.fine_side(NodeId(m)).iter().map(|cell| cell.0).collect()).collect();
        let coarse: Vec<Vec<u32>> = (0..count).map(|m| model.coarse_side(NodeId(m)).map(|c| c.0).collect()).collect();
        let corners = model.parts().corners.clone();
        let mut base: BTreeSet<u32> = (0..corners.len() as u32).collect();
        let mut killer = vec![None; corners.len()];
        for (m, side) in fine.iter().enumerate() {
            for &cell in side {
                base.remove(&cell);
                killer[cell as usize] = Some(m);
            }
        }
        let made = coarse.iter().enumerate().flat_map(|(m, side)| side.iter().map(move |&cell| (m, cell)));
        let order = Needs::new(fine.len(), made.filter_map(|(m, cell)| Some((m, killer[cell as usize]?))));
        Self { corners, base, fine, coarse, order }
    }
}

impl<const N: usize> Truth<N> for Cells<N> {
    fn len(&self) -> usize {
        self.fine.len()
    }

    fn mesh(&self, refined: &[bool]) -> Vec<(CellId, Cell<N>)> {
        let mut there = vec![0; self.corners.len()];
        self.base.iter().for_each(|&cell| there[cell as usize] += 1);
        for m in (0..refined.len()).filter(|&m| refined[m]) {
            self.fine[m].iter().for_each(|&cell| there[cell as usize] += 1);
            self.coarse[m].iter().for_each(|&cell| there[cell as usize] -= 1);
        }
        assert!(there.iter().all(|&n| n == 0 || n == 1), "a cell is there more than once, or less than not");
        let cells = there.iter().enumerate().filter(|(_, n)| **n == 1);
        cells.map(|(cell, _)| (CellId::new(cell), self.corners[cell])).collect()
    }

    fn order(&self) -> Option<&Needs> {
        Some(&self.order)
    }

    fn allows(&self, refined: &[bool], step: Step) -> Option<bool> {
        Some(self.order.allows(refined, step))
    }
}
