//! Boxes: the surface of any set of unit cubes, and a cube filled with tetrahedra.

use super::patches::split;
use crate::id::VertexId;
use crate::mesh::Mesh;
use glam::{DVec3, Vec3};
use rustc_hash::FxHashMap;

/// The surface of the cube from -1 to 1 with `n` x `n` squares (at least 1) a side, so with sharp edges and corners.
///
/// `6 n^2 + 2` vertices, `12 n^2` triangles, closed, genus 0.
pub fn sharp_box(n: usize) -> Mesh<3> {
    let quads = cube_surface([1; 3], n.max(1), |_| true);
    let positions = quads.positions.iter().map(|p| (*p * 2.0 - 1.0).as_vec3()).collect();
    Mesh { positions, cells: quads.quads.iter().flat_map(|&quad| split(quad)).collect() }
}

/// A cube of `n^3` unit cells (`n` at least 1), each cut in six tetrahedra about its diagonal (Kuhn), conforming.
///
/// `(n + 1)^3` vertices, `6 n^3` tetrahedra of volume 1/6, all positive. The coordinates are whole numbers.
pub fn tetrahedral_box(n: usize) -> Mesh<4> {
    let n = n.max(1);
    let side = n + 1;
    let name = |[x, y, z]: [usize; 3]| VertexId::new(x + side * (y + side * z));
    let place = |i: usize| Vec3::from_array([i % side, i / side % side, i / side / side].map(|x| x as f32));
    let mut cells = Vec::with_capacity(6 * n * n * n);
    for i in 0..n * n * n {
        let low = [i % n, i / n % n, i / n / n];
        for axis in 0..3 {
            // The two walks from the lowest corner to the highest that start along `axis`.
            for (second, even) in [((axis + 1) % 3, true), ((axis + 2) % 3, false)] {
                let step = |mut p: [usize; 3], axis: usize| {
                    p[axis] += 1;
                    p
                };
                let one = step(low, axis);
                let two = step(one, second);
                let [a, b, c, d] = [low, one, two, low.map(|x| x + 1)].map(name);
                cells.push(if even { [a, b, c, d] } else { [a, c, b, d] });
            }
        }
    }
    Mesh { positions: (0..side * side * side).map(place).collect(), cells }
}

/// A closed mesh of quadrilaterals.
pub(super) struct Quads {
    pub(super) positions: Vec<DVec3>,
    pub(super) quads: Vec<[VertexId; 4]>,
}

/// The surface of the unit cubes of a box of `size` that are `solid`, each side in `n` x `n` squares.
///
/// A closed manifold where no two solid cubes touch along an edge or at a corner only.
pub(super) fn cube_surface(size: [usize; 3], n: usize, solid: impl Fn([usize; 3]) -> bool) -> Quads {
    let mut surface = SurfaceOfCubes { n, names: FxHashMap::default(), quads: Vec::new() };
    for i in 0..size[0] * size[1] * size[2] {
        let cube = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
        if !solid(cube) {
            continue;
        }
        for axis in 0..3 {
            let (mut before, mut after) = (cube, cube);
            before[axis] = cube[axis].wrapping_sub(1);
            after[axis] += 1;
            if cube[axis] == 0 || !solid(before) {
                surface.side(cube, axis, false);
            }
            if after[axis] == size[axis] || !solid(after) {
                surface.side(cube, axis, true);
            }
        }
    }
    surface.finish()
}

/// A [`cube_surface`] on its way.
struct SurfaceOfCubes {
    n: usize,
    names: FxHashMap<[usize; 3], VertexId>,
    quads: Vec<[VertexId; 4]>,
}

impl SurfaceOfCubes {
    /// Adds the side of `cube` across `axis`, the far one where `high`.
    fn side(&mut self, cube: [usize; 3], axis: usize, high: bool) {
        let low = cube.map(|x| x * self.n);
        for i in 0..self.n * self.n {
            let (u, v) = (i % self.n, i / self.n);
            let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                let mut p = low;
                p[axis] += if high { self.n } else { 0 };
                p[(axis + 1) % 3] += u + du;
                p[(axis + 2) % 3] += v + dv;
                self.name(p)
            });
            if !high {
                quad.reverse();
            }
            self.quads.push(quad);
        }
    }

    /// The vertex at a point of the fine lattice, made when first asked for.
    fn name(&mut self, p: [usize; 3]) -> VertexId {
        let next = VertexId::new(self.names.len());
        *self.names.entry(p).or_insert(next)
    }

    fn finish(self) -> Quads {
        let mut positions = vec![DVec3::ZERO; self.names.len()];
        for (p, name) in self.names {
            positions[name.index()] = DVec3::from(p.map(|x| x as f64)) / self.n as f64;
        }
        Quads { positions, quads: self.quads }
    }
}
