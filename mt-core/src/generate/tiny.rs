//! Meshes small enough to draw on paper, the broken ones among them.

use crate::mesh::Mesh;
use glam::{DVec3, Vec3, vec3};

/// One triangle in the plane z = 0: 3 vertices, one boundary loop.
pub fn triangle() -> Mesh<3> {
    Mesh::from_indices(vec![Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]])
}

/// The regular tetrahedron within the unit sphere: 4 vertices, 4 triangles, closed, genus 0.
pub fn tetrahedron() -> Mesh<3> {
    let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
    on_unit_sphere(&corners.map(|p: [i32; 3]| p.map(f64::from)), &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
}

/// The octahedron within the unit sphere: 6 vertices, 8 triangles, closed, genus 0.
pub fn octahedron() -> Mesh<3> {
    let positions = vec![Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let cells = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
    Mesh::from_indices(positions, &cells)
}

/// The icosahedron within the unit sphere: 12 vertices, 20 triangles, closed, genus 0.
pub fn icosahedron() -> Mesh<3> {
    let golden = (1.0 + 5.0f64.sqrt()) / 2.0;
    // Three golden rectangles, one across each axis.
    let corners = [
        [-1.0, golden, 0.0],
        [1.0, golden, 0.0],
        [-1.0, -golden, 0.0],
        [1.0, -golden, 0.0],
        [0.0, -1.0, golden],
        [0.0, 1.0, golden],
        [0.0, -1.0, -golden],
        [0.0, 1.0, -golden],
        [golden, 0.0, -1.0],
        [golden, 0.0, 1.0],
        [-golden, 0.0, -1.0],
        [-golden, 0.0, 1.0],
    ];
    #[rustfmt::skip]
    let cells = [
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    on_unit_sphere(&corners, &cells)
}

/// Two tetrahedra that share vertex 0 and nothing else: 7 vertices, 8 triangles, closed, not a manifold at vertex 0.
pub fn hourglass() -> Mesh<3> {
    let positions = vec![
        Vec3::ZERO,
        vec3(1.0, 0.0, 1.0),
        vec3(-0.5, 0.75, 1.0),
        vec3(-0.5, -0.75, 1.0),
        vec3(1.0, 0.0, -1.0),
        vec3(-0.5, 0.75, -1.0),
        vec3(-0.5, -0.75, -1.0),
    ];
    let cells = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3], [0, 4, 5], [0, 5, 6], [0, 6, 4], [4, 6, 5]];
    Mesh::from_indices(positions, &cells)
}

/// Three triangles on the edge from vertex 0 to 1: 5 vertices, not a manifold along that edge.
pub fn fan3() -> Mesh<3> {
    let positions = vec![Vec3::ZERO, Vec3::Z, Vec3::X, vec3(-0.5, 0.75, 0.0), vec3(-0.5, -0.75, 0.0)];
    Mesh::from_indices(positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]])
}

fn on_unit_sphere(corners: &[[f64; 3]], cells: &[[u32; 3]]) -> Mesh<3> {
    let positions = corners.iter().map(|&p| DVec3::from(p).normalize().as_vec3()).collect();
    Mesh::from_indices(positions, cells)
}
