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

use super::simplify::check_kind;
use super::{AnalysisError, Draft, Ended, Listener, Operator, Options, Progress, Stopped};
use crate::bits::Bits;
use crate::explicit::{ErrorKind, HistoryError};
use crate::id::{CellId, VertexId};
use crate::mesh::Mesh;
use crate::plan::RefusalCounts;
use partition::{Partition, Soup};
use rayon::ThreadPool;
use round::{Limit, Round};

/// An operator that can work on a region of a mesh while others work on the rest.
///
/// Requires: a plan kills cells around vertices of its site alone, and neither legality nor price looks further than
/// the stars of these.
pub trait RegionOperator<const N: usize>: Operator<N, Aux: Send + Sync, Site: Send> + Sync {
    /// All that the operator knows of one vertex.
    type Memory: Copy + Send + Sync;

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
    /// About how many vertices a region has. The result depends on it.
    pub vertices: u32,
    /// Threads to use, 0 for as many as there are cores. The result does not depend on it.
    pub threads: usize,
}

impl Default for Regions {
    /// A region of 2048 vertices stays in a cache of half a megabyte; with smaller ones more is frozen. As many threads as
    /// there are cores.
    fn default() -> Self {
        Self { vertices: 2048, threads: 0 }
    }
}

/// Rounds are over when so many regions' worth of vertices is left.
const LAST_REGIONS: usize = 4;
/// By how much the price rises from round to round. On a smooth surface prices rise with the sixth power of the edge
/// length, so this is a third of the triangles.
const RISE: f64 = 27.0;

/// Coarsens `mesh` by `operator`, region by region, and tells `listener` of every modification: see [`super::analyse`] for
/// the rest. O(cells log cells), in so many bytes a cell as the operator remembers of half a vertex, and about 100 more.
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
    let size = (regions.vertices as usize).max(16);
    by_rounds(mesh, operator, options, (size, &pool), listener, watch)
}

fn by_rounds<const N: usize, O: RegionOperator<N>, L: RegionListener<N>>(
    mesh: &Mesh<N>,
    operator: &O,
    options: &Options,
    (size, pool): (usize, &ThreadPool),
    listener: &mut L,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Ended, AnalysisError> {
    let cells_in = mesh.cell_count();
    let mut partition = pool.install(|| Partition::new(Soup::of(mesh), size, 0));
    let (whole, memories) = prepare(mesh, operator, &partition.soup)?;
    partition.soup.memories = memories;
    let mut refusals = RefusalCounts::default();
    let mut price = 0.0;
    let mut rise = RISE;
    for number in 1.. {
        let cells = partition.soup.cells.len();
        let is_last = partition.soup.positions.len() <= LAST_REGIONS * size || price == f64::INFINITY;
        if is_last {
            partition = Partition::whole(partition.soup);
        }
        let round = Round { operator, options, whole: &whole, partition: &partition, cells_in, pool };
        price = if is_last { f64::INFINITY } else { f64::max(price * rise, round.usual_price()) };
        let done = round.run(Limit { price, is_last }, listener, watch)?;
        refusals.add_all(&done.refusals);
        if is_last || done.stopped == Stopped::Cancelled {
            return Ok(Ended { refusals, stopped: done.stopped });
        }
        // Where little came of it, be bolder; where nothing comes of boldness, all that is left is one region.
        let left = done.soup.cells.len();
        rise = if left * 4 > cells * 3 { rise * RISE } else { RISE };
        if left == cells && rise > RISE.powi(6) {
            price = f64::INFINITY;
        }
        partition = pool.install(|| Partition::new(done.soup, size, number));
    }
    unreachable!("the last round returns")
}

/// The operator's look at the whole mesh, in the order in which the soup has it, which is kinder to the cache.
fn prepare<const N: usize, O: RegionOperator<N>>(
    mesh: &Mesh<N>,
    operator: &O,
    soup: &Soup<N, O::Memory>,
) -> Result<(O::Aux, Vec<O::Memory>), AnalysisError> {
    let draft = Draft { complex: crate::Complex::new(soup.positions.len(), &soup.cells), positions: soup.positions.clone() };
    let mut sites = Vec::new();
    let Ok(aux) = operator.prepare(&draft, &mut sites) else {
        // What is in the way is told by the names that the caller knows.
        return match operator.prepare(&Draft::new(mesh), &mut sites) {
            Err(unfit) => Err(unfit.into()),
            Ok(_) => unreachable!("what an operator takes does not depend on how vertices are numbered"),
        };
    };
    drop((draft, sites));
    let memories = (0..soup.positions.len()).map(|v| operator.recall(&aux, VertexId::new(v))).collect();
    Ok((operator.resume(&aux, &[]), memories))
}
