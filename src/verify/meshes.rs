//! Making a mesh small on which something fails: cut down, coarsened by an operator that is trusted, and thinned out cell
//! by cell, as long as the same law is broken.

use super::specimen::Generated;
use glam::Vec3;
use mt_core::Mesh;
use std::time::{Duration, Instant};

/// Making a mesh small stops after this at the latest.
const TIME_MAX: Duration = Duration::from_secs(25);

/// The smallest mesh found on which `judge` still finds what is wrong, and what that is there. `hint` is a mesh that may
/// have all it takes, such as the input of a history made small.
pub(super) fn smallest<const N: usize, T>(
    mesh: &Mesh<N>,
    hint: Option<Mesh<N>>,
    trouble: T,
    judge: &dyn Fn(&Mesh<N>) -> Option<T>,
) -> (Mesh<N>, T)
where
    Mesh<N>: Generated<N>,
{
    let deadline = Instant::now() + TIME_MAX;
    let mut search = Search { best: mesh.clone(), trouble, judge, deadline };
    if let Some(hint) = hint {
        let around: Vec<Mesh<N>> = [1.5, 3.0, 6.0].into_iter().map(|scale| near(mesh, &hint, scale)).collect();
        // The first that will do is the smallest.
        _ = search.try_mesh(hint) || around.into_iter().any(|part| search.try_mesh(part));
    }
    loop {
        let before = search.best.cell_count();
        search.coarsen();
        search.halve();
        search.thin_out();
        if search.best.cell_count() == before || Instant::now() >= deadline {
            return (search.best, search.trouble);
        }
    }
}

struct Search<'a, const N: usize, T> {
    best: Mesh<N>,
    trouble: T,
    judge: &'a dyn Fn(&Mesh<N>) -> Option<T>,
    deadline: Instant,
}

impl<const N: usize, T> Search<'_, N, T>
where
    Mesh<N>: Generated<N>,
{
    fn try_mesh(&mut self, mesh: Mesh<N>) -> bool {
        if mesh.cell_count() >= self.best.cell_count() || mesh.cells.is_empty() || Instant::now() >= self.deadline {
            return false;
        }
        match (self.judge)(&mesh) {
            Some(trouble) => {
                (self.best, self.trouble) = (mesh, trouble);
                true
            }
            None => false,
        }
    }

    /// The same shape with fewer cells: a few, then as many as it takes.
    fn coarsen(&mut self) {
        let count = self.best.cell_count();
        let few = [4, 8, 12, 20, 32, 50, 100, 200, 500, 1000, 2000];
        let most = [count / 10, count / 4, count / 2, count * 3 / 4, count * 9 / 10, count.saturating_sub(2)];
        let mut wanted: Vec<usize> = few.into_iter().chain(most).filter(|&cells| cells < count).collect();
        wanted.sort_unstable();
        _ = self.best.coarser(&wanted).into_iter().any(|mesh| self.try_mesh(mesh));
    }

    /// One side of a plane across the middle, over and over.
    fn halve(&mut self) {
        let mut cut = true;
        while cut {
            cut = (0..3).any(|axis| [true, false].into_iter().any(|low| self.try_mesh(half(&self.best, axis, low))));
        }
    }

    /// Cells go in chunks.
    fn thin_out(&mut self) {
        let mut chunk = self.best.cell_count().div_ceil(2);
        while chunk > 0 && Instant::now() < self.deadline {
            let (mut at, before) = (0, self.best.cell_count());
            while at < self.best.cell_count() {
                let left = |i: usize| i < at || i >= at + chunk;
                let cells = self.best.cells.iter().enumerate().filter(|(i, _)| left(*i)).map(|(_, cell)| *cell);
                let part = Mesh { cells: cells.collect(), positions: self.best.positions.clone() }.compact();
                at += if self.try_mesh(part) { 0 } else { chunk };
            }
            chunk = if self.best.cell_count() < before { chunk.min(self.best.cell_count()) } else { chunk / 2 };
        }
    }
}

fn middle<const N: usize>(mesh: &Mesh<N>, cell: &[mt_core::VertexId; N]) -> Vec3 {
    cell.iter().map(|v| mesh.positions[v.index()] / N as f32).sum()
}

fn part_of<const N: usize>(mesh: &Mesh<N>, keep: impl Fn(Vec3) -> bool) -> Mesh<N> {
    let cells = mesh.cells.iter().filter(|cell| keep(middle(mesh, cell))).copied().collect();
    Mesh { positions: mesh.positions.clone(), cells }.compact()
}

/// The cells on one side of the median of their middles.
fn half<const N: usize>(mesh: &Mesh<N>, axis: usize, low: bool) -> Mesh<N> {
    let mut places: Vec<f32> = mesh.cells.iter().map(|cell| middle(mesh, cell)[axis]).collect();
    if places.is_empty() {
        return mesh.clone();
    }
    let at = places.len() / 2;
    let median = *places.select_nth_unstable_by(at, f32::total_cmp).1;
    part_of(mesh, |p| (p[axis] < median) == low)
}

/// The cells of a mesh in a box around another one, so much larger.
fn near<const N: usize>(mesh: &Mesh<N>, other: &Mesh<N>, scale: f32) -> Mesh<N> {
    let Some((low, high)) = other.bounding_box() else { return Mesh { positions: Vec::new(), cells: Vec::new() } };
    let (center, reach) = (0.5 * (low + high), 0.5 * scale * (high - low) + f32::MIN_POSITIVE);
    part_of(mesh, |p| (p - center).abs().cmple(reach).all())
}
