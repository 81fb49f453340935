//! One round: every region is coarsened as a mesh of its own, and told to the listener one after the other.

use super::partition::{Partition, Remnant};
use super::residue::Residue;
use super::{RegionListener, RegionOperator};
use crate::analysis::queue;
use crate::analysis::simplify::{Until, Work};
use crate::analysis::{AnalysisError, Draft, Options, Progress, Stopped};
use crate::bits::Bits;
use crate::cell::Cell;
use crate::id::VertexId;
use crate::mesh::Mesh;
use crate::plan::RefusalCounts;
use rayon::ThreadPool;
use rayon::prelude::*;

/// What all regions of all rounds are coarsened by.
pub(super) struct Job<'a, const N: usize, O: RegionOperator<N>> {
    pub(super) operator: &'a O,
    pub(super) options: &'a Options,
    /// What holds for the whole mesh.
    pub(super) whole: &'a O::Aux,
    pub(super) cells_in: usize,
    pub(super) pool: &'a ThreadPool,
}

/// What a round has left.
pub(super) struct Done<const N: usize, M> {
    pub(super) left: Remnant<N, M>,
    pub(super) refusals: RefusalCounts,
    /// Whether any region had sites above the price.
    pub(super) more: bool,
    pub(super) is_cancelled: bool,
}

/// A region that has been coarsened: what was heard of it, and what is left.
struct Coarsened<const N: usize, M, L> {
    heard: L,
    residue: Residue<N, M>,
    refusals: RefusalCounts,
    stopped: Stopped,
    more: bool,
}

/// So many regions are worked on while as many are told. The same for any number of threads, so that whoever stops the work
/// stops it at the same place. Both sixteens are held at once, whatever the mesh: on small meshes they show at the peak.
const TOGETHER: usize = 16;
/// So many regions are asked for their prices.
const SAMPLES: usize = 6;
/// Of the cells that are wanted in the end, so many are left to the last round, which has one queue for all.
const LEFT_TO_THE_LAST: usize = 4;

/// The median price of the sites of some regions that are dearer than `above`.
pub(super) fn usual_price<const N: usize, O: RegionOperator<N>>(
    job: &Job<N, O>,
    partition: &Partition<N, O::Memory>,
    above: f64,
) -> Option<f64> {
    let step = partition.len().div_ceil(SAMPLES).max(1);
    let sample: Vec<usize> = (0..partition.len()).skip(step / 2).step_by(step).collect();
    let counts = sample.par_iter().map(|&region| work(job, partition, region, &mesh(partition, region)).price_counts());
    let add = |mut a: Vec<usize>, b: Vec<usize>| {
        a.resize(a.len().max(b.len()), 0);
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    queue::median_above(&job.pool.install(|| counts.reduce(Vec::new, add)), above)
}

/// Coarsens all regions as far as the price, and tells the listener in their order: while some are worked on, those before
/// them are told.
pub(super) fn run<const N: usize, O: RegionOperator<N>, L: RegionListener<N>>(
    job: &Job<N, O>,
    partition: &Partition<N, O::Memory>,
    price: f64,
    listener: &mut L,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Done<N, O::Memory>, AnalysisError> {
    let mut told = Told::new(partition);
    let regions: Vec<usize> = (0..partition.len()).collect();
    let mut worked_on: Vec<(usize, Coarsened<N, O::Memory, L>)> = Vec::new();
    for some in regions.chunks(TOGETHER) {
        // What was worked on before counts as done, told or not, and is told before anybody may stop it.
        let cells = told.cells - worked_on.iter().map(|(region, done)| done.gone(partition, *region)).sum::<usize>();
        if !watch(Progress { cells_in: job.cells_in, cells }) {
            told.tell_all(worked_on, listener)?;
            return Ok(Done { is_cancelled: true, ..told.done });
        }
        let one = |&region: &usize| {
            let cells_min = share_of_cells(job, partition, partition.cells(region).len());
            let until = Until { price, cells: cells_min };
            Ok((region, coarsen::<N, O, L>(job, partition, region, until, &mut |_| true)?))
        };
        let before = std::mem::take(&mut worked_on);
        let work = || some.par_iter().map(one).collect::<Result<Vec<_>, AnalysisError>>();
        let (now, telling) = job.pool.install(|| rayon::join(work, || told.tell_all(before, listener)));
        telling?;
        worked_on = now?;
    }
    told.tell_all(worked_on, listener)?;
    Ok(told.finish())
}

/// What the listener has been told of a round, and what is left of the regions that it has heard of.
struct Told<'a, const N: usize, M> {
    partition: &'a Partition<N, M>,
    done: Done<N, M>,
    /// Where the vertices that are frozen have come to be.
    number: Vec<VertexId>,
    /// How many cells there are.
    cells: usize,
}

impl<'a, const N: usize, M: Copy + Send + Sync> Told<'a, N, M> {
    fn new(partition: &'a Partition<N, M>) -> Self {
        let before = &partition.left;
        let left = Remnant::with_capacity(before.positions.len() / 2, before.cells.len() / 2);
        let done = Done { left, refusals: RefusalCounts::default(), more: false, is_cancelled: false };
        let number = vec![VertexId::NONE; before.positions.len()];
        Self { partition, done, number, cells: before.cells.len() }
    }

    /// Tells of regions in their order.
    fn tell_all<L: RegionListener<N>>(
        &mut self,
        regions: Vec<(usize, Coarsened<N, M, L>)>,
        listener: &mut L,
    ) -> Result<(), AnalysisError> {
        let before = &self.partition.left;
        for (region, coarsened) in regions {
            self.cells -= coarsened.gone(self.partition, region);
            let Coarsened { heard, residue, refusals, more, .. } = coarsened;
            self.done.refusals.add_all(&refusals);
            self.done.more |= more;
            let (vertices, own) = (self.partition.vertices(region), self.partition.cells(region));
            let names = listener.append(heard, &before.names[vertices.clone()], &before.cell_names[own])?;
            residue.settle(&names, &mut self.done.left, &mut self.number[vertices]);
        }
        Ok(())
    }

    /// What the round has left, when all regions are told.
    fn finish(mut self) -> Done<N, M> {
        let (before, left) = (&self.partition.left, &mut self.done.left);
        for i in self.partition.between() {
            left.cells.push(before.cells[i].map(|v| self.number[v.index()]));
            left.cell_names.push(before.cell_names[i]);
        }
        self.done
    }
}

impl<const N: usize, M: Copy + Send + Sync, L> Coarsened<N, M, L> {
    /// How many cells the region has lost.
    fn gone(&self, partition: &Partition<N, M>, region: usize) -> usize {
        partition.cells(region).len() - self.residue.cells.len()
    }
}

/// Coarsens all that is left as one region, as far as it goes.
pub(super) fn last<const N: usize, O: RegionOperator<N>, L: RegionListener<N>>(
    job: &Job<N, O>,
    partition: &Partition<N, O::Memory>,
    listener: &mut L,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<(RefusalCounts, Stopped), AnalysisError> {
    let cells = job.options.until_cells.map(|cells| cells as usize);
    let until = Until { price: f64::INFINITY, cells };
    let Coarsened { heard, refusals, stopped, .. } = coarsen::<N, O, L>(job, partition, 0, until, watch)?;
    listener.append(heard, &partition.left.names, &partition.left.cell_names)?;
    Ok((refusals, stopped))
}

fn coarsen<const N: usize, O: RegionOperator<N>, L: RegionListener<N>>(
    job: &Job<N, O>,
    partition: &Partition<N, O::Memory>,
    region: usize,
    until: Until,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Coarsened<N, O::Memory, L>, AnalysisError> {
    let mesh = mesh(partition, region);
    let mut heard = L::of_region(&mesh)?;
    let mut work = work(job, partition, region, &mesh);
    let cells_in = job.cells_in;
    let stopped = work.run(until, &mut heard, &mut |at| watch(Progress { cells_in, ..at }))?;
    let residue = Residue::of(work.draft(), |v| job.operator.recall(work.aux(), v), work.frozen());
    Ok(Coarsened { heard, residue, refusals: work.refusals(), stopped, more: work.has_sites() })
}

/// The mesh of a region, with its own numbers.
fn mesh<const N: usize, M: Copy + Send + Sync>(partition: &Partition<N, M>, region: usize) -> Mesh<N> {
    let vertices = partition.vertices(region);
    let local = |cell: &Cell<N>| cell.map(|v| VertexId::new(v.index() - vertices.start));
    let cells = partition.left.cells[partition.cells(region)].iter().map(local).collect();
    Mesh { positions: partition.left.positions[vertices.clone()].to_vec(), cells }
}

fn work<'a, const N: usize, O: RegionOperator<N>>(
    job: &Job<'a, N, O>,
    partition: &Partition<N, O::Memory>,
    region: usize,
    mesh: &Mesh<N>,
) -> Work<'a, N, O> {
    let vertices = partition.vertices(region);
    let aux = job.operator.resume(job.whole, &partition.left.memories[vertices.clone()]);
    let mut frozen = Bits::new(vertices.len() as u32);
    let ours = vertices.clone().filter(|&v| partition.frozen.contains(v as u32));
    ours.for_each(|v| _ = frozen.insert((v - vertices.start) as u32));
    Work::in_region(Draft::new(mesh), job.operator, aux, frozen, job.options)
}

/// The cells that a region has to keep so that all together keep more than are wanted.
fn share_of_cells<const N: usize, O: RegionOperator<N>>(
    job: &Job<N, O>,
    partition: &Partition<N, O::Memory>,
    cells: usize,
) -> Option<usize> {
    let wanted = job.options.until_cells? as usize;
    let all = partition.left.cells.len().max(1);
    let share = (cells as u128 * (wanted + wanted / LEFT_TO_THE_LAST) as u128).div_ceil(all as u128) as usize;
    // A step may go beyond by what it kills.
    Some(share + 2 * N)
}
