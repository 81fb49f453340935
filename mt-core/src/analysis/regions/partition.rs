//! Between rounds: what is left of the mesh, numbered along a curve through space and cut into regions.

use crate::bins::Bins;
use crate::bits::Bits;
use crate::cell::Cell;
use crate::id::{CellId, VertexId};
use crate::mesh::Mesh;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// What is left: vertices that cells have, with what the operator knows of them, and cells. Names are the listener's.
pub(super) struct Remnant<const N: usize, M> {
    pub(super) positions: Vec<Vec3>,
    pub(super) memories: Vec<M>,
    pub(super) names: Vec<VertexId>,
    pub(super) cells: Vec<Cell<N>>,
    pub(super) cell_names: Vec<CellId>,
}

impl<const N: usize, M: Copy + Send + Sync> Remnant<N, M> {
    /// All of the input.
    pub(super) fn of(mesh: &Mesh<N>, memories: Vec<M>) -> Self {
        Self {
            positions: mesh.positions.clone(),
            memories,
            names: (0..mesh.positions.len()).into_par_iter().map(VertexId::new).collect(),
            cells: mesh.cells.par_iter().copied().collect(),
            cell_names: (0..mesh.cells.len()).into_par_iter().map(CellId::new).collect(),
        }
    }

    /// With room for this much.
    pub(super) fn with_capacity(vertices: usize, cells: usize) -> Self {
        Self {
            positions: Vec::with_capacity(vertices),
            memories: Vec::with_capacity(vertices),
            names: Vec::with_capacity(vertices),
            cells: Vec::with_capacity(cells),
            cell_names: Vec::with_capacity(cells),
        }
    }

    /// Vertex `order[i]` becomes vertex `i`.
    fn renumber(&mut self, order: &[u32]) {
        let mut number = vec![0; order.len()];
        order.iter().enumerate().for_each(|(i, &v)| number[v as usize] = i as u32);
        self.positions = in_order(&self.positions, order);
        self.names = in_order(&self.names, order);
        self.memories = in_order(&self.memories, order);
        self.cells.par_iter_mut().for_each(|cell| cell.iter_mut().for_each(|v| v.0 = number[v.index()]));
    }

    /// Cell `order[i]` becomes cell `i`.
    fn reorder_cells(&mut self, order: &[u32]) {
        self.cells = in_order(&self.cells, order);
        self.cell_names = in_order(&self.cell_names, order);
    }
}

fn in_order<T: Copy + Send + Sync>(all: &[T], order: &[u32]) -> Vec<T> {
    order.par_iter().map(|&i| all[i as usize]).collect()
}

/// What is left, cut into regions: vertices and cells of a region are runs. Cells that reach into several come last.
pub(super) struct Partition<const N: usize, M> {
    pub(super) left: Remnant<N, M>,
    /// Vertices of each region but the last.
    size: usize,
    /// Where the cells of each region begin, and where those of the last end.
    cell_starts: Vec<usize>,
    /// Vertices with a cell that reaches into several regions.
    pub(super) frozen: Bits,
}

impl<const N: usize, M: Copy + Send + Sync> Partition<N, M> {
    /// Cuts into regions of about `size` vertices; each `round` cuts elsewhere.
    pub(super) fn new(mut left: Remnant<N, M>, size: usize, round: u32) -> Self {
        let order = along_curve(&left.positions, round);
        left.renumber(&order);
        drop(order);
        let vertices = left.positions.len();
        let regions = vertices.div_ceil(size).max(1);
        let mut partition = Self {
            left,
            size: vertices.div_ceil(regions).max(1),
            cell_starts: Vec::new(),
            frozen: Bits::new(vertices as u32),
        };
        partition.sort_cells(regions);
        partition
    }

    /// One region with all of it.
    pub(super) fn whole(left: Remnant<N, M>) -> Self {
        let (vertices, cells) = (left.positions.len(), left.cells.len());
        Self { left, size: vertices.max(1), cell_starts: vec![0, cells], frozen: Bits::new(vertices as u32) }
    }

    /// Number of regions.
    pub(super) fn len(&self) -> usize {
        self.cell_starts.len() - 1
    }

    /// The vertices of a region.
    pub(super) fn vertices(&self, region: usize) -> Range<usize> {
        let count = self.left.positions.len();
        (region * self.size).min(count)..((region + 1) * self.size).min(count)
    }

    /// The cells of a region.
    pub(super) fn cells(&self, region: usize) -> Range<usize> {
        self.cell_starts[region]..self.cell_starts[region + 1]
    }

    /// The cells of no region.
    pub(super) fn between(&self) -> Range<usize> {
        self.cell_starts[self.len()]..self.left.cells.len()
    }

    /// The region that all corners of a cell are in; `regions` where there are several.
    fn region_of(&self, cell: &Cell<N>, regions: usize) -> usize {
        let region = cell[0].index() / self.size;
        if cell.iter().all(|v| v.index() / self.size == region) { region } else { regions }
    }

    fn sort_cells(&mut self, regions: usize) {
        let cells = &self.left.cells;
        let bins = Bins::new(cells.len() as u32, regions + 1, |cell| [self.region_of(&cells[cell as usize], regions)]);
        let sorted: Vec<Vec<u32>> = (0..=regions).into_par_iter().map(|region| bins.of(region)).collect();
        drop(bins);
        let mut starts = vec![0; regions + 1];
        (0..regions).for_each(|region| starts[region + 1] = starts[region] + sorted[region].len());
        let order = sorted.concat();
        drop(sorted);
        self.left.reorder_cells(&order);
        self.cell_starts = starts;
        for i in self.between() {
            self.left.cells[i].iter().for_each(|v| _ = self.frozen.insert(v.0));
        }
    }
}

/// The order of points along a curve through all octants of a box (`[Morton1966]`), which lies elsewhere in every round, so
/// that no plane between octants is one for ever. Points at one place keep their order.
fn along_curve(positions: &[Vec3], round: u32) -> Vec<u32> {
    let Some(&first) = positions.first() else { return Vec::new() };
    let wider = |(low, high): (Vec3, Vec3), (p, q): (Vec3, Vec3)| (low.min(p), high.max(q));
    let (low, high) = positions.par_iter().map(|&p| (p, p)).reduce(|| (first, first), wider);
    // In double precision, which holds the extent of whatever single precision holds.
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let size = (high - low).max_element().max(f64::from(f32::MIN_POSITIVE));
    // Multiples of an irrational number never come back to the same place.
    let golden = 0.618_033_988_749_895;
    let shift = |axis: u32| size * (f64::from(round * 3 + axis + 1) * golden).fract();
    let corner = low - DVec3::new(shift(0), shift(1), shift(2));
    let steps = f64::from((1u32 << BITS) - 1);
    let code = |p: Vec3| {
        let at = ((p.as_dvec3() - corner) * (steps / (2.0 * size))).clamp(DVec3::ZERO, DVec3::splat(steps));
        spread(at.x as u64) | spread(at.y as u64) << 1 | spread(at.z as u64) << 2
    };
    let mut keys: Vec<(u64, u32)> = positions.par_iter().enumerate().map(|(v, &p)| (code(p), v as u32)).collect();
    keys.par_sort_unstable();
    keys.into_par_iter().map(|(_, v)| v).collect()
}

/// Bits of each coordinate on the curve: what single precision tells apart, and no more than a third of 64.
const BITS: u32 = 21;

/// Puts two zeros between any two of the lower 21 bits.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;

    #[test]
    fn bits_are_spread_by_three() {
        for x in [0u64, 1, 2, 3, 0x1f_ffff, 0x15_5555, 0x0a_cafe] {
            let slow = (0..21).fold(0, |sum, bit| sum | (x >> bit & 1) << (3 * bit));
            assert_eq!(spread(x), slow);
        }
    }

    #[test]
    fn every_cell_is_in_one_region_or_between_frozen_vertices() {
        let mesh = generate::torus(40, 30);
        for round in 0..4 {
            let partition = Partition::new(Remnant::of(&mesh, vec![0u8; mesh.positions.len()]), 100, round);
            assert_eq!(partition.len(), 12);
            let mut cells = 0;
            for region in 0..partition.len() {
                let (vertices, own) = (partition.vertices(region), partition.cells(region));
                assert!(partition.left.cells[own.clone()].iter().flatten().all(|v| vertices.contains(&v.index())));
                cells += own.len();
            }
            let between = partition.between();
            assert_eq!(cells + between.len(), mesh.cells.len());
            assert!(partition.left.cells[between].iter().flatten().all(|v| partition.frozen.contains(v.0)));
            // Most of it can be worked on, and names lead back to the input.
            assert!(partition.frozen.count() < 800, "{}", partition.frozen.count());
            for (cell, name) in partition.left.cells.iter().zip(&partition.left.cell_names) {
                assert_eq!(cell.map(|v| partition.left.names[v.index()]), mesh.cells[name.index()]);
            }
        }
    }

    #[test]
    fn the_curve_takes_extents_of_any_size() {
        let mesh = generate::torus(20, 10);
        let scaled = |scale: f32| mesh.positions.iter().map(|p| *p * scale).collect::<Vec<_>>();
        let usual = along_curve(&scaled(1.0), 3);
        // Powers of two change no digit.
        for scale in [f32::from_bits(0x7e00_0000), f32::from_bits(0x0200_0000)] {
            assert_eq!(along_curve(&scaled(scale), 3), usual, "{scale:e}");
        }
        let all_at_one_place = vec![Vec3::splat(7.0); 5];
        assert_eq!(along_curve(&all_at_one_place, 0), [0, 1, 2, 3, 4]);
        assert!(along_curve(&[], 0).is_empty());
    }
}
