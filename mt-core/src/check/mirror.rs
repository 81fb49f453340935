//! A sink that keeps the cells it hears of: what a renderer or a client knows of a mesh.

use crate::cell::Cell;
use crate::id::CellId;
use crate::model::Sink;
use rustc_hash::FxHashMap;

/// The mesh as told to a sink, and the first thing told that cannot be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mirror<const N: usize> {
    cells: FxHashMap<CellId, Cell<N>>,
    fault: Option<String>,
}

impl<const N: usize> Mirror<N> {
    /// The cells told, ascending by id; or what was told and cannot be.
    pub fn cells(&self) -> Result<Vec<(CellId, Cell<N>)>, String> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        let mut cells: Vec<_> = self.cells.iter().map(|(id, corners)| (*id, *corners)).collect();
        cells.sort_unstable();
        Ok(cells)
    }

    fn expect(&mut self, holds: bool, fault: impl FnOnce() -> String) {
        if !holds && self.fault.is_none() {
            self.fault = Some(fault());
        }
    }
}

impl<const N: usize> Sink<N> for Mirror<N> {
    fn kill(&mut self, cell: CellId) {
        let there = self.cells.remove(&cell).is_some();
        self.expect(there, || format!("cell {cell} is killed, but was not there"));
    }
    fn make(&mut self, cell: CellId, corners: Cell<N>) {
        let new = self.cells.insert(cell, corners).is_none();
        self.expect(new, || format!("cell {cell} is made, but was there"));
    }
    fn relabel(&mut self, cell: CellId, corners: Cell<N>) {
        let there = self.cells.insert(cell, corners).is_some();
        self.expect(there, || format!("cell {cell} is relabelled, but was not there"));
    }
}
