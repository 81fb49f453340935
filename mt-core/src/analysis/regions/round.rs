//! One round: every region is coarsened as a mesh of its own, and told to the listener one after the other.

use super::partition::{Partition, Soup};
use super::residue::Residue;
use super::{RegionListener, RegionOperator};
use crate::analysis::simplify::{Until, Work};
use crate::analysis::{AnalysisError, queue, Draft, Options, Progress, Stopped};
use crate::bits::Bits;
use crate::cell::Cell;
use crate::complex::Complex;
use crate::id::VertexId;
use crate::mesh::Mesh;
use crate::plan::RefusalCounts;
use rayon::ThreadPool;
use rayon::prelude::*;

/// What the regions of a round are coarsened by, and what they are.
pub(super) struct Round<'a, const N: usize, O: RegionOperator<N>> {
    pub(super) operator: &'a O,
    pub(super) options: &'a Options,
    /// What holds for the whole mesh.
    pub(super) whole: &'a O::Aux,
    pub(super) partition: &'a Partition<N, O::Memory>,
    pub(super) cells_in: usize,
    pub(super) pool: &'a ThreadPool,
}

/// How far a round goes.
#[derive(Clone, Copy)]
pub(super) struct Limit {
    /// Sites above this price wait for the next round.
    pub(super) price: f64,
    /// Whether there is no next round.
    pub(super) is_last: bool,
}

/// What a round has left.
pub(super) struct Done<const N: usize, M> {
    pub(super) soup: Soup<N, M>,
    pub(super) refusals: RefusalCounts,
    pub(super) stopped: Stopped,
}

/// A region that has been coarsened: what was heard of it, and what is left.
struct Coarsened<const N: usize, M, L> {
    heard: L,
    residue: Residue<N, M>,
    refusals: RefusalCounts,
    stopped: Stopped,
}

/// So many regions for each thread are worked on before they are told.
const REGIONS_A_THREAD: usize = 8;
/// So many regions are asked for their prices before a round.
const SAMPLES: usize = 6;

impl<'a, const N: usize, O: RegionOperator<N>> Round<'a, N, O> {
    /// The price that half the sites of some regions are below.
    pub(super) fn usual_price(&self) -> f64 {
        let regions = self.partition.len();
        let step = regions.div_ceil(SAMPLES).max(SAMPLES);
        let sample: Vec<usize> = (0..regions).step_by(step).collect();
        let counts = sample.par_iter().map(|&region| self.work(region).price_counts());
        let add = |mut a: Vec<usize>, b: Vec<usize>| {
            a.resize(a.len().max(b.len()), 0);
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        queue::median(&self.pool.install(|| counts.reduce(Vec::new, add)))
    }

    /// Coarsens all regions as far as the limit, and tells the listener in their order.
    pub(super) fn run<L: RegionListener<N>>(
        &self,
        limit: Limit,
        listener: &mut L,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Done<N, O::Memory>, AnalysisError> {
        let soup = &self.partition.soup;
        let mut left = Soup::with_capacity(soup.positions.len() / 2, soup.cells.len() / 2);
        let mut done = Done { soup: Soup::with_capacity(0, 0), refusals: RefusalCounts::default(), stopped: Stopped::Exhausted };
        // Where the vertices that are frozen have come to be.
        let mut number = vec![VertexId::NONE; soup.positions.len()];
        let mut cells = soup.cells.len();
        let regions: Vec<usize> = (0..self.partition.len()).collect();
        for some in regions.chunks(REGIONS_A_THREAD * self.pool.current_num_threads()) {
            let coarsened: Vec<_> = if limit.is_last {
                vec![self.coarsen::<L>(some[0], limit, watch)?]
            } else {
                let all = some.par_iter().map(|&region| self.coarsen::<L>(region, limit, &mut |_| true));
                self.pool.install(|| all.collect::<Result<_, AnalysisError>>())?
            };
            for (&region, region_done) in some.iter().zip(coarsened) {
                let Coarsened { heard, residue, refusals, stopped } = region_done;
                done.refusals.add_all(&refusals);
                cells -= self.partition.cells(region).len() - residue.cells.len();
                if limit.is_last {
                    done.stopped = stopped;
                }
                let (vertices, own) = (self.partition.vertices(region), self.partition.cells(region));
                let names = listener.append(heard, &soup.names[vertices.clone()], &soup.cell_names[own])?;
                residue.settle(&names, &mut left, &mut number[vertices]);
            }
            if !limit.is_last && !watch(Progress { cells_in: self.cells_in, cells }) {
                done.stopped = Stopped::Cancelled;
                break;
            }
        }
        for i in self.partition.between() {
            left.cells.push(soup.cells[i].map(|v| number[v.index()]));
            left.cell_names.push(soup.cell_names[i]);
        }
        done.soup = left;
        Ok(done)
    }

    /// The mesh of a region, with its own numbers.
    fn mesh(&self, region: usize) -> Mesh<N> {
        let vertices = self.partition.vertices(region);
        let local = |cell: &Cell<N>| cell.map(|v| VertexId::new(v.index() - vertices.start));
        let cells = self.partition.soup.cells[self.partition.cells(region)].iter().map(local).collect();
        Mesh { positions: self.partition.soup.positions[vertices.clone()].to_vec(), cells }
    }

    /// The vertices of a region that may not be touched, by its own numbers.
    fn frozen(&self, region: usize) -> Bits {
        let vertices = self.partition.vertices(region);
        let mut frozen = Bits::new(vertices.len() as u32);
        let ours = vertices.clone().filter(|&v| self.partition.frozen.contains(v as u32));
        ours.for_each(|v| _ = frozen.insert((v - vertices.start) as u32));
        frozen
    }

    fn work(&self, region: usize) -> Work<'a, N, O> {
        self.work_on(region, &self.mesh(region))
    }

    fn work_on(&self, region: usize, mesh: &Mesh<N>) -> Work<'a, N, O> {
        let draft = Draft { complex: Complex::new(mesh.positions.len(), &mesh.cells), positions: mesh.positions.clone() };
        let aux = self.operator.resume(self.whole, &self.partition.soup.memories[self.partition.vertices(region)]);
        Work::in_region(draft, self.operator, aux, self.frozen(region), self.options)
    }

    fn coarsen<L: RegionListener<N>>(
        &self,
        region: usize,
        limit: Limit,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Coarsened<N, O::Memory, L>, AnalysisError> {
        let mesh = self.mesh(region);
        let mut heard = L::of_region(&mesh)?;
        let mut work = self.work_on(region, &mesh);
        let until = Until { price: limit.price, cells: self.share_of_cells(mesh.cell_count()) };
        let cells_in = self.cells_in;
        let stopped = work.run(until, &mut heard, &mut |at| watch(Progress { cells_in, ..at }))?;
        let residue = Residue::of(work.draft(), |v| self.operator.recall(work.aux(), v), &self.frozen(region));
        Ok(Coarsened { heard, residue, refusals: work.refusals(), stopped })
    }

    /// The cells that a region has to keep so that all together keep as many as are wanted.
    fn share_of_cells(&self, cells: usize) -> Option<usize> {
        let wanted = self.options.until_cells? as usize;
        let all = self.partition.soup.cells.len().max(1);
        Some((cells as u128 * wanted as u128).div_ceil(all as u128) as usize)
    }
}
