//! The shortest edge first: what every other metric has to beat.

use super::{Boundary, Merge, Metric, Offer, Place, RegionMetric, ends_of, fixed, put};
use mt_core::VertexId;
use mt_core::analysis::{Draft, Unfit};

/// The price is the distance between the two vertices, the best place is halfway.
///
/// The error bounds how far any point of the input has been moved. A sequence of collapses maps each vertex of the input
/// to one that is left, and the surface by straight lines between them, so no point moves further than some vertex has;
/// and each vertex keeps the longest way that one of those it stands for may have come. It is a bound of the Hausdorff
/// distance, and a loose one: moving along a flat surface counts as much as leaving it.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct EdgeLength;

/// How far each vertex may be from those it stands for, in model units.
#[derive(Clone, Debug, Default)]
pub struct Displacements(Vec<f32>);

impl Metric for EdgeLength {
    type State = Displacements;
    /// The displacements of both.
    type Pair = [f32; 2];

    fn name(&self) -> &'static str {
        "edge-length"
    }

    fn prepare(&self, draft: &Draft<3>, _: &Boundary<'_>) -> Result<Displacements, Unfit> {
        Ok(Displacements(vec![0.0; draft.positions.len()]))
    }

    fn pair(&self, _: &Draft<3>, state: &Displacements, ends: [VertexId; 2]) -> [f32; 2] {
        ends.map(|v| state.0[v.index()])
    }

    fn offer(&self, draft: &Draft<3>, ends: [VertexId; 2], pair: &[f32; 2], place: Place) -> Offer {
        let ends = ends_of(draft, ends);
        let position = fixed(ends, place).unwrap_or_else(|| ends[0].midpoint(ends[1]));
        let from = |i: usize| f64::from(pair[i]) + ends[i].as_dvec3().distance(position.as_dvec3());
        let price = ends[0].as_dvec3().distance(ends[1].as_dvec3());
        Offer { position, price, error: from(0).max(from(1)) }
    }

    fn merged(&self, draft: &Draft<3>, state: &mut Displacements, merge: &Merge) {
        let to = draft.positions[merge.into.index()].as_dvec3();
        let from = |v: VertexId| f64::from(state.0[v.index()]) + draft.positions[v.index()].as_dvec3().distance(to);
        let [a, b] = merge.ends.map(from);
        put(&mut state.0, merge.into, a.max(b) as f32);
    }
}

impl RegionMetric for EdgeLength {
    type Memory = f32;

    fn recall(&self, state: &Displacements, v: VertexId) -> f32 {
        state.0[v.index()]
    }

    fn resume(&self, _: &Displacements, memories: impl Iterator<Item = f32>) -> Displacements {
        Displacements(memories.collect())
    }
}
