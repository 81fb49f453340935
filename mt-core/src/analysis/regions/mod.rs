//! Analysis by regions: a large mesh is coarsened in parts that fit the cache, several at once, to the same bytes
//! whatever the number of threads.
//!
//! Rounds. In each, the vertices that are left are numbered along a space-filling curve and cut into regions of equal
//! size; each region is coarsened as a mesh of its own, cheapest first, as far as a price that is the same for all. A
//! vertex with a cell that reaches into another region is *frozen* for the round: it keeps its place, its cells and its
//! memory. The next round has another curve and other cuts, and a higher price; the last one is a single region with no
//! price. Nothing depends on who works when, so threads change nothing.
//!
//! What is lost against one queue for all: within a round the cheapest of one region may come after dearer ones of another,
//! and what is frozen waits for a round. What is won besides threads: a queue of a million sites touches the whole of a
//! mesh again and again, a region stays in the cache.

mod partition;
mod residue;
mod round;
mod schedule;

use super::simplify::check_kind;
use super::{AnalysisError, Draft, Ended, Listener, Operator, Options, Progress, Stopped, Unfit};
use crate::bits::Bits;
use crate::explicit::{ErrorKind, HistoryError};
use crate::id::{CellId, VertexId};
use crate::mesh::Mesh;
use crate::plan::RefusalCounts;
use partition::{Partition, Remnant};
use rayon::prelude::*;
use round::Job;
use schedule::{Came, Schedule};

/// An operator that can work on a region of a mesh while others work on the rest.
///
/// Requires: a plan kills cells around vertices of its site alone, and neither legality nor price looks further than
/// the stars of these.
pub trait RegionOperator<const N: usize>: Operator<N, Aux: Send + Sync, Site: Send> + Sync {
    /// All that the operator knows of one vertex.
    type Memory: Copy + Send + Sync;

    /// What [`Operator::prepare`] gives, without naming the sites of the whole mesh: regions name their own.
    fn survey(&self, draft: &Draft<N>) -> Result<Self::Aux, Unfit>;

    /// What it knows of `v`.
    fn recall(&self, aux: &Self::Aux, v: VertexId) -> Self::Memory;

    /// Auxiliary data of a mesh whose vertices have these memories. What holds for the whole mesh is as in `of`.
    fn resume(&self, of: &Self::Aux, memories: &[Self::Memory]) -> Self::Aux;

    /// All sites of a draft, in an order that depends on its cells alone; each once.
    fn sites(&self, draft: &Draft<N>, aux: &Self::Aux, out: &mut Vec<Self::Site>);

    /// Whether a site is free to act: no vertex of it is frozen. Vertices beyond `frozen` are free.
    fn is_free(site: Self::Site, frozen: &Bits) -> bool;
}

/// A listener to which an analysis can be told region by region.
pub trait RegionListener<const N: usize>: Listener<N> + Send + Sized {
    /// A listener of a region: a mesh by itself, whose names are its own.
    fn of_region(region: &Mesh<N>) -> Result<Self, HistoryError>;

    /// Tells all that `part` has heard. Its vertices and cells are called `vertices` and `cells` here; told back are the
    /// names of all vertices of the region's draft, and of all cells by the names that the draft has for them.
    ///
    /// Requires: `vertices` and `cells` name those of the region, each once, and all of them are there.
    fn append(
        &mut self,
        part: Self,
        vertices: &[VertexId],
        cells: &[CellId],
    ) -> Result<(Vec<VertexId>, Vec<CellId>), HistoryError>;
}

/// How a mesh is cut.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Regions {
    /// About how many vertices a region has, at least 16. The result depends on it.
    pub vertices: u32,
    /// Threads to use, 0 for as many as there are cores. The result does not depend on it.
    pub threads: usize,
}

impl Default for Regions {
    /// A region of 4096 vertices nearly stays in a cache of half a megabyte; with smaller ones more is frozen, which
    /// costs quality and wins little. As many threads as there are cores.
    fn default() -> Self {
        Self { vertices: 4096, threads: 0 }
    }
}

/// Rounds are over when so many regions' worth of vertices is left.
const LAST_REGIONS: usize = 4;
/// Fewer vertices than this are no region.
const VERTICES_MIN: usize = 16;

/// Coarsens `mesh` by `operator`, region by region, and tells `listener` of every modification: see [`super::analyse`] for
/// the rest. `watch` hears of progress between some regions; what was told by the time it stops is a history of its own,
/// and the same for any number of threads.
///
/// O(cells log cells). Holds, besides what the listener keeps, a copy of what is left of the mesh with the operator's
/// memories, and the drafts of 16 regions with what is left of 16 others; before the first round a draft of the whole mesh,
/// while the operator surveys it.
pub fn analyse_by_regions<const N: usize, O: RegionOperator<N>, L: RegionListener<N>>(
    mesh: &Mesh<N>,
    operator: &O,
    options: &Options,
    regions: &Regions,
    listener: &mut L,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Ended, AnalysisError> {
    check_kind::<N>(options)?;
    if options.error_kind == ErrorKind::Measured {
        return Err(AnalysisError::MeasuredByRegions);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(regions.threads).build();
    let pool = pool.map_err(|error| AnalysisError::Threads(error.to_string()))?;
    let size = (regions.vertices as usize).max(VERTICES_MIN);
    let cells_in = mesh.cell_count();
    let mut refusals = RefusalCounts::default();
    let ended = |refusals, stopped| Ok(Ended { refusals, stopped });
    if !watch(Progress { cells_in, cells: cells_in }) {
        return ended(refusals, Stopped::Cancelled);
    }
    let (whole, remnant) = pool.install(|| prepare(mesh, operator))?;
    let mut partition = pool.install(|| Partition::new(remnant, size, 0));
    let mut schedule = Schedule::default();
    for number in 1.. {
        let cells = partition.left.cells.len();
        if options.until_cells.is_some_and(|wanted| cells <= wanted as usize) {
            return ended(refusals, Stopped::Cells);
        }
        let job = Job { operator, options, whole: &whole, cells_in, pool: &pool };
        let is_small = partition.left.positions.len() <= LAST_REGIONS * size;
        let price =
            if is_small { f64::INFINITY } else { schedule.next(|above| round::usual_price(&job, &partition, above)) };
        if price == f64::INFINITY {
            let (last, stopped) = round::last(&job, &Partition::whole(partition.left), listener, watch)?;
            refusals.add_all(&last);
            return ended(refusals, stopped);
        }
        let done = round::run(&job, &partition, price, listener, watch)?;
        refusals.add_all(&done.refusals);
        if done.is_cancelled {
            return ended(refusals, Stopped::Cancelled);
        }
        schedule.came(Came { cells_before: cells, cells_after: done.left.cells.len(), more: done.more });
        partition = pool.install(|| Partition::new(done.left, size, number));
    }
    unreachable!("the last round returns")
}

/// The operator's look at the whole mesh: what holds for all of it, and what it knows of each vertex.
fn prepare<const N: usize, O: RegionOperator<N>>(
    mesh: &Mesh<N>,
    operator: &O,
) -> Result<(O::Aux, Remnant<N, O::Memory>), AnalysisError> {
    let aux = operator.survey(&Draft::new(mesh))?;
    let vertices = 0..mesh.positions.len();
    let memories = vertices.into_par_iter().map(|v| operator.recall(&aux, VertexId::new(v))).collect();
    Ok((operator.resume(&aux, &[]), Remnant::of(mesh, memories)))
}
