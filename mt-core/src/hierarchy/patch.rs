//! What surrounds a vertex while a replay is built: bounds of patches, umbrellas, common neighbours.

use super::mesh::VertexMesh;
use super::replay::Replay;
use crate::bound::Cone;
use crate::cell::{Cell, is_short_cycle};
use crate::id::{NodeId, VertexId};
use crate::mesh::area_vector;
use glam::Vec3;

/// Looks around vertices, in buffers of its own.
#[derive(Default)]
pub(super) struct Surroundings {
    /// Neighbours, each with an edge of the link that has it.
    link: Vec<(VertexId, u32)>,
    edges: Vec<[VertexId; 2]>,
    open: Vec<VertexId>,
    seen: Vec<bool>,
    /// Of each vertex: when it was last seen to be a neighbour.
    marks: Vec<u32>,
    mark: u32,
}

impl Surroundings {
    /// Whether the link of `v` is surely one closed walk that passes no vertex twice; of long ones it is not known. O(star²).
    pub(super) fn is_cycle(&mut self, mesh: &VertexMesh, v: VertexId) -> bool {
        mesh.faces.link_edges(v, &mut self.edges);
        is_short_cycle(&self.edges)
    }

    /// Whether the triangles around `v` form one fan, open or closed, whose link passes no vertex twice.
    /// O(star log star).
    pub(super) fn is_umbrella(&mut self, mesh: &VertexMesh, v: VertexId) -> bool {
        mesh.faces.link_edges(v, &mut self.edges);
        if is_short_cycle(&self.edges) {
            return true;
        }
        self.link.clear();
        self.link.extend(self.edges.iter().enumerate().flat_map(|(at, ends)| ends.map(|w| (w, at as u32))));
        self.link.sort_unstable();
        let Some(&[start, _]) = self.edges.first() else { return false };
        let mut ends = 0;
        for run in self.link.chunk_by(|a, b| a.0 == b.0) {
            if run.len() > 2 {
                return false;
            }
            ends += usize::from(run.len() == 1);
        }
        // Paths and cycles only; two triangles with the same three corners are a cycle of two edges.
        let doubled = ends == 0 && self.edges.len() == 2;
        (ends == 0 || ends == 2) && !doubled && self.reached(start) == self.edges.len()
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

    /// How many vertices share a triangle with each of two. O(stars).
    pub(super) fn shared(&mut self, mesh: &VertexMesh, [a, b]: [VertexId; 2]) -> usize {
        self.marks.resize(mesh.faces.vertex_count(), 0);
        // Marks only grow, so none has to be wiped, but once in four thousand million.
        if self.mark >= u32::MAX - 2 {
            self.marks.fill(0);
            self.mark = 0;
        }
        let (near_a, near_both) = (self.mark + 1, self.mark + 2);
        self.mark += 2;
        let mut count = 0;
        for (end, found, made) in [(a, None, near_a), (b, Some(near_a), near_both)] {
            for (slot, i) in mesh.faces.star(end) {
                let cell = mesh.faces.cell(slot);
                for w in [cell[(i + 1) % 3], cell[(i + 2) % 3]] {
                    let mark = &mut self.marks[w.index()];
                    if found.is_none_or(|found| *mark == found) {
                        count += usize::from(found.is_some());
                        *mark = made;
                    }
                }
            }
        }
        count
    }
}

/// Measures the patches of one replay, node after node. The normals of the current cells are kept: a cell is part of many
/// fine sides before the next coarse side changes it.
pub(super) struct PatchBound {
    /// Unit normals of the current cells by slot; zero without area.
    normals: Vec<Vec3>,
    /// The normals of both sides of the current patch.
    both: Vec<Vec3>,
}

impl PatchBound {
    /// The input's cells.
    pub(super) fn new(replay: &Replay) -> Self {
        let normals = replay.cells.iter().map(|cell| normal(replay, cell)).collect();
        Self { normals, both: Vec::new() }
    }

    /// Looks at the triangles around centre and child of `m`, just before they become one: their radius about its vertex.
    pub(super) fn fine(&mut self, replay: &Replay, mesh: &VertexMesh, m: NodeId) -> f32 {
        let about = replay.positions[replay.vertex(m).index()].as_dvec3();
        let reach_to = |v: VertexId| replay.positions[v.index()].as_dvec3().distance_squared(about);
        self.both.clear();
        let mut reach = 0.0;
        for end in replay.ends(m) {
            reach = f64::max(reach, reach_to(end));
            for (slot, i) in mesh.faces.star(end) {
                let cell = mesh.faces.cell(slot);
                reach = reach.max(reach_to(cell[(i + 1) % 3])).max(reach_to(cell[(i + 2) % 3]));
                self.both.push(self.normals[slot as usize]);
            }
        }
        ((reach.sqrt() * (1.0 + 1e-14)) as f32).next_up()
    }

    /// Looks at the triangles around the vertex of `m`, just after: the cone of their normals and of those before.
    pub(super) fn coarse(&mut self, replay: &Replay, mesh: &VertexMesh, m: NodeId) -> Cone {
        for (slot, _) in mesh.faces.star(replay.vertex(m)) {
            let normal = normal(replay, mesh.faces.cell(slot));
            self.normals[slot as usize] = normal;
            self.both.push(normal);
        }
        Cone::of_normals(&self.both)
    }
}

fn normal(replay: &Replay, cell: &Cell<3>) -> Vec3 {
    area_vector(cell.map(|v| replay.positions[v.index()].as_dvec3())).as_vec3().normalize_or_zero()
}
