//! What surrounds a vertex while a replay is built: bounds of patches, umbrellas, common neighbours.

use crate::bound::Cone;
use crate::cell::{Cell, sides};
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
    /// Of each vertex: the walk in which it was last seen, and who follows it there.
    follower: Vec<(u32, VertexId)>,
    /// The number of the last walk.
    walk: u32,
}

impl Links {
    /// What the triangles around `v` are. O(star), where they agree on their sides and close; else O(star log star).
    pub(super) fn fan(&mut self, mesh: &Complex<3>, v: VertexId) -> Fan {
        mesh.link_edges(v, &mut self.edges);
        self.follower.resize(mesh.vertex_count(), (0, VertexId::NONE));
        if self.is_cycle() {
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

    /// A quick yes: the edges of the link are one closed walk in which each begins where just one other ends.
    fn is_cycle(&mut self) -> bool {
        let Some(&[start, _]) = self.edges.first().filter(|_| self.edges.len() > 2) else { return false };
        if self.walk == u32::MAX {
            self.follower.fill((0, VertexId::NONE));
            self.walk = 0;
        }
        self.walk += 1;
        for &[from, to] in &self.edges {
            if self.follower[from.index()].0 == self.walk {
                return false;
            }
            self.follower[from.index()] = (self.walk, to);
        }
        // A walk that first comes back after as many steps as there are edges has taken each of them.
        let mut at = start;
        for step in 1..=self.edges.len() {
            let (walk, next) = self.follower[at.index()];
            if walk != self.walk || (next == start) != (step == self.edges.len()) {
                return false;
            }
            at = next;
        }
        true
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

/// Makes merges, one after the other, and measures their patches on the way. The normals of the current cells are kept: a
/// cell is part of many fine sides before the next coarse side changes it.
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
    /// The squared distance of what is furthest from the merged vertex.
    reach: f64,
    /// How many neighbours of the second end were neighbours of the first.
    shared: usize,
}

/// What is seen of a patch.
pub(super) struct Seen {
    /// How far the patch reaches from the merged vertex, rounded up.
    pub(super) radius: f32,
    /// The normals of the triangles before and after.
    pub(super) cone: Cone,
    /// How many vertices shared a triangle with each of the two that are merged.
    pub(super) shared: usize,
}

impl Patch {
    /// Of these cells, by slot, and the vertices at these positions.
    pub(super) fn new(positions: Vec<Vec3>, cells: &[Cell<3>]) -> Self {
        let normals = cells.iter().map(|cell| normal(&positions, cell)).collect();
        let marks = vec![0; positions.len()];
        Self { positions, normals, both: Vec::new(), marks, mark: 0, reach: 0.0, shared: 0 }
    }

    /// Where a vertex is.
    pub(super) fn position(&self, v: VertexId) -> Vec3 {
        self.positions[v.index()]
    }

    /// Puts a vertex somewhere, none of whose cells has been looked at.
    pub(super) fn put(&mut self, v: VertexId, at: Vec3) {
        self.positions[v.index()] = at;
    }

    /// Forgets the normal of a cell whose corner has moved while nobody looked at it.
    pub(super) fn moved(&mut self, slot: Slot) {
        self.normals[slot as usize] = Vec3::NAN;
    }

    /// Makes one vertex of two, the first of which may be that vertex, and tells which cells die. O(stars), each cell of
    /// which is looked at once.
    pub(super) fn merge(
        &mut self,
        mesh: &mut Complex<3>,
        [stays, child]: [VertexId; 2],
        into: VertexId,
        mut died: impl FnMut(Slot),
    ) -> Seen {
        // Marks only grow, so none has to be wiped, but once in four thousand million.
        if self.mark >= u32::MAX - 2 {
            self.marks.fill(0);
            self.mark = 0;
        }
        self.mark += 2;
        self.both.clear();
        self.shared = 0;
        self.reach = f64::max(self.squared(stays, into), self.squared(child, into));
        if stays == into {
            for (slot, i) in mesh.star(into) {
                self.see_first(slot, i, mesh.cell(slot), [stays, child]);
            }
        } else {
            mesh.join_star(stays, into, |slot, i, cell, _| self.see_first(slot, i, cell, [stays, child]));
        }
        mesh.join_star(child, into, |slot, i, cell, lives| {
            if lives {
                self.see_second(slot, i, cell, child);
            } else {
                // It was seen around the first end. Its third corner is a neighbour of both.
                sides(cell, i).into_iter().filter(|&w| w != into).for_each(|w| self.meet_again(w, into));
                died(slot);
            }
        });
        let radius = ((self.reach.sqrt() * (1.0 + 1e-14)) as f32).next_up();
        Seen { radius, cone: Cone::of_normals(&self.both), shared: self.shared }
    }

    /// A cell of the first end, which has the merged vertex at corner `i` by now.
    #[inline]
    fn see_first(&mut self, slot: Slot, i: usize, cell: &Cell<3>, [stays, child]: [VertexId; 2]) {
        let others = sides(cell, i);
        for w in others {
            let mark = &mut self.marks[w.index()];
            if *mark != self.mark - 1 {
                *mark = self.mark - 1;
                self.reach = self.reach.max(self.squared(w, cell[i]));
            }
        }
        self.see_normals(slot, i, cell, stays, !others.contains(&child));
    }

    /// A cell of the second end, which has the merged vertex at corner `i` by now and not before.
    #[inline]
    fn see_second(&mut self, slot: Slot, i: usize, cell: &Cell<3>, child: VertexId) {
        sides(cell, i).into_iter().for_each(|w| self.meet_again(w, cell[i]));
        self.see_normals(slot, i, cell, child, true);
    }

    /// A neighbour of the second end.
    #[inline]
    fn meet_again(&mut self, w: VertexId, into: VertexId) {
        let mark = &mut self.marks[w.index()];
        if *mark == self.mark {
            return;
        }
        if *mark == self.mark - 1 {
            *mark = self.mark;
            self.shared += 1;
        } else {
            *mark = self.mark;
            self.reach = self.reach.max(self.squared(w, into));
        }
    }

    /// The normals of a cell before corner `i` moved from a vertex, and after, if it `lives` so long.
    #[inline]
    fn see_normals(&mut self, slot: Slot, i: usize, cell: &Cell<3>, from: VertexId, lives: bool) {
        let mut before = self.normals[slot as usize];
        if before.x.is_nan() {
            let mut old = *cell;
            old[i] = from;
            before = normal(&self.positions, &old);
        }
        self.both.push(before);
        if lives {
            let after = normal(&self.positions, cell);
            self.normals[slot as usize] = after;
            self.both.push(after);
        }
    }

    #[inline]
    fn squared(&self, v: VertexId, about: VertexId) -> f64 {
        self.positions[v.index()].as_dvec3().distance_squared(self.positions[about.index()].as_dvec3())
    }
}

#[inline]
fn normal(positions: &[Vec3], cell: &Cell<3>) -> Vec3 {
    area_vector(cell.map(|v| positions[v.index()].as_dvec3())).as_vec3().normalize_or_zero()
}
