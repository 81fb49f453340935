//! Edge collapse on regions of a mesh: what is kept of a vertex, and which edges a region has.

use super::{Aux, Edge, EdgeCollapse, manifold};
use crate::metric::RegionMetric;
use mt_core::analysis::{Draft, RegionOperator, Unfit};
use mt_core::{Bits, VertexId};

/// What is kept of a vertex from one round to the next.
#[derive(Copy, Clone, Debug)]
pub struct Memory<T> {
    metric: T,
    on_boundary: bool,
}

impl<M: RegionMetric> RegionOperator<3> for EdgeCollapse<M> {
    type Memory = Memory<M::Memory>;

    fn survey(&self, draft: &Draft<3>) -> Result<Self::Aux, Unfit> {
        self.aux_of(draft, &manifold::check(&draft.complex, false)?)
    }

    fn recall(&self, aux: &Self::Aux, v: VertexId) -> Self::Memory {
        Memory { metric: self.metric.recall(&aux.metric, v), on_boundary: aux.on_boundary[v.index()] }
    }

    fn resume(&self, of: &Self::Aux, memories: &[Self::Memory]) -> Self::Aux {
        Aux {
            metric: self.metric.resume(&of.metric, memories.iter().map(|memory| memory.metric)),
            on_boundary: memories.iter().map(|memory| memory.on_boundary).collect(),
            coherent: of.coherent,
            stamps: self.stamps(memories.len()),
        }
    }

    fn sites(&self, draft: &Draft<3>, aux: &Self::Aux, out: &mut Vec<Edge>) {
        let mut others = Vec::new();
        for (_, &[a, b, c]) in draft.complex.cells() {
            for [u, v] in [[a, b], [b, c], [c, a]] {
                // Where triangles agree on their sides, an edge with two of them comes once in each direction; the others
                // come once for each triangle.
                let is_inner = aux.coherent && !(aux.on_boundary[u.index()] && aux.on_boundary[v.index()]);
                if !is_inner {
                    others.push(aux.edge(u, v));
                } else if u < v {
                    out.push(aux.edge(u, v));
                }
            }
        }
        others.sort_unstable();
        others.dedup();
        out.append(&mut others);
    }

    fn is_free(site: Edge, frozen: &Bits) -> bool {
        [site.a, site.b].iter().all(|v| v.0 >= frozen.capacity() || !frozen.contains(v.0))
    }
}
