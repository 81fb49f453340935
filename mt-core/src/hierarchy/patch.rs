//! What surrounds a vertex while a replay is built: bounds of patches, umbrellas, common neighbours.

use crate::bound::Cone;
use crate::cell::{Cell, is_short_cycle, sides};
use crate::complex::{Complex, Slot};
use crate::id::VertexId;
use crate::mesh::area_vector;
use glam::Vec3;

/// What the triangles around a vertex are.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Fan {
    /// One fan all around: the link is one closed walk that passes no vertex twice.
    Closed,
    /// One fan that begins and ends.
    Open,
    /// Several, or something else.
    Other,
}

/// Looks at links, in buffers of its own.
#[derive(Default)]
pub(super) struct Links {
    /// Neighbours, each with an edge of the link that has it.
    link: Vec<(VertexId, u32)>,
    edges: Vec<[VertexId; 2]>,
    open: Vec<VertexId>,
    seen: Vec<bool>,
}

impl Links {
    /// What the triangles around `v` are. O(star log star), and of short links O(star²).
    pub(super) fn fan(&mut self, mesh: &Complex<3>, v: VertexId) -> Fan {
        mesh.link_edges(v, &mut self.edges);
        if is_short_cycle(&self.edges) {
            return Fan::Closed;
        }
        self.link.clear();
        self.link.extend(self.edges.iter().enumerate().flat_map(|(at, ends)| ends.map(|w| (w, at as u32))));
        self.link.sort_unstable();
        let Some(&[start, _]) = self.edges.first() else { return Fan::Other };
        let mut ends = 0;
        for run in self.link.chunk_by(|a, b| a.0 == b.0) {
            if run.len() > 2 {
                return Fan::Other;
            }
            ends += usize::from(run.len() == 1);
        }
        // Paths and cycles only; two triangles with the same three corners are a cycle of two edges.
        let doubled = ends == 0 && self.edges.len() == 2;
        if ends > 2 || doubled || self.reached(start) != self.edges.len() {
            return Fan::Other;
        }
        if ends == 0 { Fan::Closed } else { Fan::Open }
    }

    /// How many edges of the link can be walked to from `start`.
    fn reached(&mut self, start: VertexId) -> usize {
        self.seen.clear();
        self.seen.resize(self.edges.len(), false);
        self.open.clear();
        self.open.push(start);
        let mut count = 0;
        while let Some(w) = self.open.pop() {
            let from = self.link.partition_point(|entry| entry.0 < w);
            for &(_, at) in self.link[from..].iter().take_while(|entry| entry.0 == w) {
                if !std::mem::replace(&mut self.seen[at as usize], true) {
                    count += 1;
                    self.open.extend(self.edges[at as usize].into_iter().filter(|&x| x != w));
                }
            }
        }
        count
    }
}

/// Measures the patches of merges, one after the other. The normals of the current cells are kept: a cell is part of many
/// fine sides before the next coarse side changes it.
pub(super) struct Patch {
    /// Of the vertices.
    positions: Vec<Vec3>,
    /// Unit normals of the current cells by slot; zero without area, not a number where a cell has moved since.
    normals: Vec<Vec3>,
    /// The normals of both sides of the current patch.
    both: Vec<Vec3>,
    /// Of each vertex: when it was last seen to be a neighbour.
    marks: Vec<u32>,
    mark: u32,
}

/// What is seen of a patch just before its merge.
pub(super) struct Before {
    /// How far the patch reaches from where the merged vertex will be, rounded up.
    pub(super) radius: f32,
    /// How many vertices share a triangle with each of the two that are merged.
    pub(super) shared: usize,
}

impl Patch {
    /// Of these cells, by slot, and the vertices at these positions.
    pub(super) fn new(positions: Vec<Vec3>, cells: &[Cell<3>]) -> Self {
        let normals = cells.iter().map(|cell| normal(&positions, cell)).collect();
        Self { normals, both: Vec::new(), marks: vec![0; positions.len()], mark: 0, positions }
    }

    /// Where a vertex is.
    pub(super) fn position(&self, v: VertexId) -> Vec3 {
        self.positions[v.index()]
    }

    /// Forgets the normal of a cell whose corner has moved while nobody looked at it.
    pub(super) fn moved(&mut self, slot: Slot) {
        self.normals[slot as usize] = Vec3::NAN;
    }

    /// Looks at the triangles around two vertices just before they become `into`. O(stars).
    pub(super) fn before(&mut self, mesh: &Complex<3>, ends: [VertexId; 2], into: VertexId) -> Before {
        // Marks only grow, so none has to be wiped, but once in four thousand million.
        if self.mark >= u32::MAX - 2 {
            self.marks.fill(0);
            self.mark = 0;
        }
        let (near_first, near) = (self.mark + 1, self.mark + 2);
        self.mark += 2;
        let about = self.positions[into.index()].as_dvec3();
        let positions = &self.positions;
        let squared = |v: VertexId| positions[v.index()].as_dvec3().distance_squared(about);
        self.both.clear();
        let mut reach = f64::max(squared(ends[0]), squared(ends[1]));
        let mut shared = 0;
        let normals = &mut self.normals;
        let mut normal_of = |slot: Slot| {
            let kept = &mut normals[slot as usize];
            if kept.x.is_nan() {
                *kept = normal(positions, mesh.cell(slot));
            }
            *kept
        };
        for (slot, i) in mesh.star(ends[0]) {
            self.both.push(normal_of(slot));
            for w in sides(mesh.cell(slot), i) {
                let mark = &mut self.marks[w.index()];
                if *mark != near_first {
                    *mark = near_first;
                    reach = reach.max(squared(w));
                }
            }
        }
        for (slot, i) in mesh.star(ends[1]) {
            self.both.push(normal_of(slot));
            for w in sides(mesh.cell(slot), i) {
                let mark = &mut self.marks[w.index()];
                if *mark == near_first {
                    shared += 1;
                } else if *mark != near {
                    reach = reach.max(squared(w));
                }
                *mark = near;
            }
        }
        Before { radius: ((reach.sqrt() * (1.0 + 1e-14)) as f32).next_up(), shared }
    }

    /// Looks at the triangles around the merged vertex, just after: the cone of their normals and of those before.
    pub(super) fn after(&mut self, mesh: &Complex<3>, into: VertexId) -> Cone {
        for (slot, _) in mesh.star(into) {
            let normal = normal(&self.positions, mesh.cell(slot));
            self.normals[slot as usize] = normal;
            self.both.push(normal);
        }
        Cone::of_normals(&self.both)
    }
}

fn normal(positions: &[Vec3], cell: &Cell<3>) -> Vec3 {
    area_vector(cell.map(|v| positions[v.index()].as_dvec3())).as_vec3().normalize_or_zero()
}
