//! A wish, and what each scheme makes of it: closures, and the sizes of their meshes.

use crate::ledger::LedgerError;
use mt_core::hierarchy::Dependency;
use mt_core::order::Rows;
use mt_core::{Bits, Front, Hierarchy, NodeId, Order, Replay, Rule, check};
use operators::order::{DualPieceFree, Scheme, Stored, Visit};
use selective::State;
use std::sync::Arc;

/// The three schemes of the paper's table, as it names them.
pub(super) const SCHEMES: [(&str, Scheme); 3] =
    [("Xia, Varshney", Scheme::OneRing), ("Hoppe", Scheme::FourFace), ("Kim, Lee", Scheme::DualPiece)];

/// The hierarchy of a static scheme.
pub(super) type Static = Hierarchy<Stored>;
/// Its state at a front.
pub(super) type At = State<3, Static, ()>;

/// Nodes that are asked for, with those above them in the forest.
pub(super) struct Wished {
    pub(super) replay: Arc<Replay>,
    pub(super) nodes: Front,
}

/// Vertices and triangles.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Sizes {
    pub(super) vertices: usize,
    pub(super) triangles: usize,
}

impl Wished {
    pub(super) fn new(replay: Arc<Replay>, nodes: impl IntoIterator<Item = NodeId>) -> Self {
        let mut front = Front::from_nodes(replay.len(), nodes);
        forest(&replay).close(&mut front);
        Self { replay, nodes: front }
    }

    /// The share of the input's vertices that a mesh of the wish would have, if nothing had to be forced.
    pub(super) fn share(&self) -> f64 {
        let left = self.replay.leaf_count() - self.replay.len() + self.nodes.len();
        f64::from(left) / f64::from(self.replay.leaf_count().max(1))
    }

    /// The least front of a scheme that holds the wish.
    pub(super) fn closed(&self, scheme: Scheme) -> Result<Front, LedgerError> {
        let order = scheme
            .visit(&self.replay, OrderOf)
            .map_err(|error| LedgerError::Hierarchy(scheme.name().into(), error))??;
        let mut front = self.nodes.clone();
        order.close(&mut front);
        Ok(front)
    }

    /// The hierarchy of a static scheme, and its state at the scheme's front.
    pub(super) fn state(&self, scheme: Scheme) -> Result<(Static, At), LedgerError> {
        let wrong = |error| LedgerError::Hierarchy(scheme.name().into(), error);
        let stored = scheme.stored(&self.replay).map_err(wrong)?;
        let dependency = stored.ok_or_else(|| LedgerError::Data(format!("{scheme} is no static order")))?;
        let model = Hierarchy { replay: Arc::clone(&self.replay), dependency };
        let mut state = State::new(&model, ());
        selective::approach(&model, &self.closed(scheme)?, &mut state);
        Ok((model, state))
    }

    /// The size of the mesh of a front. Each node adds a vertex, whatever the front.
    pub(super) fn sizes(&self, front: &Front) -> Sizes {
        let replay = &self.replay;
        let mut used = Bits::new(replay.leaf_count());
        replay.cells().iter().flatten().for_each(|v| _ = used.insert(v.0));
        let all: usize = (0..replay.len()).map(|m| replay.born(NodeId(m)).len()).sum();
        let born: usize = front.finest_first().map(|m| replay.born(m).len()).sum();
        Sizes {
            vertices: (used.count() - replay.len() + front.len()) as usize,
            triangles: replay.cells().len() - all + born,
        }
    }

    /// The rule of the paper as it is written: each node of the wish is forced, coarsest first. Gives the front.
    pub(super) fn as_written(&self) -> Result<Front, LedgerError> {
        let dependency = DualPieceFree::new(&self.replay)
            .map_err(|error| LedgerError::Hierarchy("dual-piece-free".into(), error))?;
        let model = Hierarchy { replay: Arc::clone(&self.replay), dependency };
        let mut state = State::new(&model, ());
        let mut nodes: Vec<NodeId> = self.nodes.finest_first().collect();
        nodes.reverse();
        nodes.into_iter().for_each(|m| state.force(&model, m));
        Ok(state.front().clone())
    }
}

/// The forest by itself as an order.
fn forest(replay: &Replay) -> Order {
    let mut rows = Rows::default();
    (0..replay.len()).for_each(|m| rows.push(replay.parent(NodeId(m))));
    Order::from_needs(rows).expect("a parent was merged later")
}

/// The whole order of a scheme.
struct OrderOf;

impl Visit for OrderOf {
    type Output = Result<Order, LedgerError>;

    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        debug_assert!(D::RULE == Rule::Static);
        check::order_of(model).map_err(|breach| LedgerError::Data(breach.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::{Bare, Size, Workshop};
    use crate::truly_selective::models::{NAMES, column};
    use mt_core::MultiTessellation;

    #[test]
    fn sizes_are_those_of_the_meshes_and_schemes_are_nested() {
        let (mut bare, mut watch) = (Bare, |_: &str, _: f32| true);
        let mut workshop = Workshop::new(Size::Small, &mut bare, &mut watch);
        for name in NAMES {
            let (_, wished) = column(&mut workshop, name, 0.3).unwrap();
            let mut outer = Front::reference(wished.replay.len());
            for (_, scheme) in SCHEMES {
                let (model, state) = wished.state(scheme).unwrap();
                let front = state.front();
                assert!(front.is_subset(&outer) && wished.nodes.is_subset(front), "{name}, {scheme}");
                let sizes = wished.sizes(front);
                assert_eq!(sizes.triangles as u32, state.cell_count(&model), "{name}, {scheme}");
                let mut used = Bits::new(model.positions().len() as u32);
                model.cells(&state.view.mesh, |_, cell| cell.iter().for_each(|v| _ = used.insert(v.0)));
                assert_eq!(sizes.vertices as u32, used.count(), "{name}, {scheme}");
                outer = front.clone();
            }
            assert_eq!(wished.as_written().unwrap(), outer, "{name}: the rule as written and the static order");
        }
    }
}
