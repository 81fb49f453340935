//! Criteria on cells, as the tutorial states them: a Boolean for each cell of the mesh.
//!
//! The test of a whole modification can ask for more than its cells need. Here a modification is applied only when a
//! cell of its coarse side is in the mesh and fails. The result is the least front whose mesh satisfies the criterion,
//! whatever the criterion: a failing cell must go, and only one modification refines it.

use crate::criterion::Region;
use crate::state::{Outcome, State};
use glam::Vec3;
use mt_core::{CellId, Explicit, MultiTessellation, NodeId, Sink};

/// A cell as a criterion sees it.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct CellView<const N: usize> {
    /// Its corners in space.
    pub corners: [Vec3; N],
    /// The saturated error of the modification that would refine it, in model units; 0 for cells of the input.
    pub error: f32,
}

/// Judges single cells.
pub trait CellCriterion<const N: usize> {
    /// Whether the cell is fine enough. Cells of the input are not asked.
    fn holds(&self, cell: &CellView<N>) -> bool;
}

/// Which value of a threshold function counts over a cell.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Focus {
    /// The largest: the cell may be as coarse as its most lenient point allows (the tutorial's definition).
    Loose,
    /// The smallest: the cell must satisfy its most demanding point.
    Strict,
}

/// An error within a region, anything outside. Loose: cells inside the region. Strict: cells whose bounding box meets it.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct ErrorBelow {
    /// Largest error allowed, in model units.
    pub error_max: f32,
    /// Where; everywhere without.
    pub region: Option<Region>,
    /// How cells across the region's border are judged.
    pub focus: Focus,
}

impl<const N: usize> CellCriterion<N> for ErrorBelow {
    fn holds(&self, cell: &CellView<N>) -> bool {
        let Some(region) = self.region else { return cell.error <= self.error_max };
        let concerned = match self.focus {
            Focus::Loose => cell.corners.iter().all(|&p| region.contains(p)),
            Focus::Strict => {
                let low = cell.corners.iter().copied().fold(Vec3::INFINITY, Vec3::min);
                let high = cell.corners.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
                low.cmple(region.high).all() && region.low.cmple(high).all()
            }
        };
        !concerned || cell.error <= self.error_max
    }
}

/// The error against the largest or smallest value of a threshold function at the cell's corners.
///
/// Over the whole cell that is exact for the maximum of convex and the minimum of concave functions.
#[derive(Copy, Clone, Debug)]
pub struct ThresholdBelow<F> {
    /// Largest error allowed at a point, in model units.
    pub threshold: F,
    /// Which value counts.
    pub focus: Focus,
}

impl<const N: usize, F: Fn(Vec3) -> f32> CellCriterion<N> for ThresholdBelow<F> {
    fn holds(&self, cell: &CellView<N>) -> bool {
        let values = cell.corners.iter().map(|&p| (self.threshold)(p));
        let most = match self.focus {
            Focus::Loose => values.fold(f32::NEG_INFINITY, f32::max),
            Focus::Strict => values.fold(f32::INFINITY, f32::min),
        };
        cell.error <= most
    }
}

/// The least front whose mesh satisfies a criterion on cells. O(cells made, with a logarithm to find who refines one).
pub fn extract_exact<const N: usize, S: Sink<N>>(
    model: &Explicit<N>,
    criterion: &impl CellCriterion<N>,
    sink: S,
) -> (State<N, Explicit<N>, S>, Outcome) {
    let mut state = State::new(model, sink);
    let mut open: Vec<CellId> = model.base_cells().to_vec();
    let mut asked = 0;
    while let Some(cell) = open.pop() {
        if !state.view.mesh.contains(cell.0) {
            continue;
        }
        let Some(m) = model.refined_by(cell).filter(|&m| !criterion.holds(&cell_view(model, cell, m))) else {
            continue;
        };
        let mark = state.steps.len();
        state.force_counted(model, m);
        asked += 1;
        for step in &state.steps[mark..] {
            open.extend_from_slice(model.fine_side(step.node));
        }
    }
    let outcome = state.outcome_since(0, state.steps.len() as u32 - asked, true);
    (state, outcome)
}

fn cell_view<const N: usize>(model: &Explicit<N>, cell: CellId, m: NodeId) -> CellView<N> {
    CellView { corners: model.corners(cell).map(|v| model.positions()[v.index()]), error: model.bound(m).error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_across_the_border_is_concerned_or_not_as_one_says() {
        let region = Region { low: Vec3::ZERO, high: Vec3::ONE };
        let at = |x: f32| [Vec3::new(x, 0.1, 0.1), Vec3::new(x + 0.5, 0.1, 0.1), Vec3::new(x, 0.6, 0.1)];
        let holds = |corners: [Vec3; 3], error, focus| {
            let below = ErrorBelow { error_max: 0.5, region: Some(region), focus };
            CellCriterion::<3>::holds(&below, &CellView { corners, error })
        };
        for (corners, concerned) in [(at(0.2), [true, true]), (at(0.8), [false, true]), (at(3.0), [false, false])] {
            for (focus, concerned) in [Focus::Loose, Focus::Strict].into_iter().zip(concerned) {
                assert!(holds(corners, 0.5, focus) && holds(corners, 0.0, focus));
                assert_eq!(holds(corners, 0.6, focus), !concerned, "{focus:?} at {}", corners[0].x);
            }
        }
    }
}
