//! What surrounds a vertex while a replay is built: bounds of patches, umbrellas, common neighbours.

use super::mesh::VertexMesh;
use super::replay::Replay;
use crate::bound::{Cone, cone_of_cells};
use crate::id::{NodeId, VertexId};
use glam::Vec3;

/// Looks around vertices, in buffers of its own.
#[derive(Default)]
pub(super) struct Surroundings {
    /// Neighbours, each with an edge of the link that has it.
    link: Vec<(VertexId, u32)>,
    edges: Vec<[VertexId; 2]>,
    open: Vec<VertexId>,
    seen: Vec<bool>,
    others: Vec<VertexId>,
}

impl Surroundings {
    /// Whether the triangles around `v` form one fan, open or closed, whose link passes no vertex twice.
    /// O(star log star).
    pub(super) fn is_umbrella(&mut self, mesh: &VertexMesh, v: VertexId) -> bool {
        self.edges.clear();
        self.edges.extend(mesh.faces.star(v).map(|(slot, i)| {
            let cell = mesh.faces.cell(slot);
            [cell[(i + 1) % 3], cell[(i + 2) % 3]]
        }));
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

    /// How many vertices share a triangle with each of two. O(stars log stars).
    pub(super) fn shared(&mut self, mesh: &VertexMesh, [a, b]: [VertexId; 2]) -> usize {
        mesh.faces.neighbours(a, &mut self.open);
        mesh.faces.neighbours(b, &mut self.others);
        self.open.iter().filter(|w| self.others.binary_search(w).is_ok()).count()
    }
}

/// Measures patches in buffers of its own.
#[derive(Default)]
pub(super) struct PatchBound {
    corners: Vec<[Vec3; 3]>,
    vectors: Vec<Vec3>,
}

impl PatchBound {
    /// The radius about the vertex of `m` of the triangles around centre and child, and the cone of their normals.
    pub(super) fn measure(&mut self, replay: &Replay, mesh: &VertexMesh, m: NodeId) -> (f32, Cone) {
        let vertex = replay.vertex(m);
        let [center, child] = replay.ends(m);
        self.gather(replay, mesh, [center, child]);
        let about = replay.positions[vertex.index()].as_dvec3();
        let ends = [center, child].map(|v| replay.positions[v.index()]);
        let points = self.corners.iter().flatten().chain(&ends);
        let reach = points.map(|p| p.as_dvec3().distance_squared(about)).fold(0.0, f64::max).sqrt();
        (((reach * (1.0 + 1e-14)) as f32).next_up(), cone_of_cells(&self.corners, &mut self.vectors))
    }

    pub(super) fn cone_after(&mut self, replay: &Replay, mesh: &VertexMesh, m: NodeId) -> Cone {
        let vertex = replay.vertex(m);
        self.gather(replay, mesh, [vertex, vertex]);
        cone_of_cells(&self.corners, &mut self.vectors)
    }

    fn gather(&mut self, replay: &Replay, mesh: &VertexMesh, ends: [VertexId; 2]) {
        self.corners.clear();
        let distinct = if ends[0] == ends[1] { &ends[..1] } else { &ends[..] };
        for &end in distinct {
            for (slot, _) in mesh.faces.star(end) {
                self.corners.push(mesh.faces.cell(slot).map(|v| replay.positions[v.index()]));
            }
        }
    }
}
