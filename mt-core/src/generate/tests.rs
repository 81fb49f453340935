//! What the generators promise, measured: counts, links, orientation, genus, boundary, shape, and the same mesh twice.

use super::*;
use crate::id::VertexId;
use crate::mesh::{Mesh, area_vector, volume_six};
use crate::random::Random;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

type Edge = (VertexId, VertexId);

/// What a triangle mesh is, up to bending it.
#[derive(Debug, PartialEq, Eq)]
struct Topology {
    vertices: usize,
    triangles: usize,
    components: usize,
    loops: usize,
    euler: isize,
    /// No edge is run through twice the same way.
    coherent: bool,
    /// Vertices whose link is neither one cycle nor one path.
    broken: usize,
}

impl Topology {
    /// Sum of the components' genera, of an orientable manifold.
    fn genus(&self) -> isize {
        (2 * self.components as isize - self.loops as isize - self.euler) / 2
    }
}

fn corners(mesh: &Mesh<3>) -> impl Iterator<Item = (VertexId, VertexId, VertexId)> + '_ {
    mesh.cells.iter().flat_map(|&[a, b, c]| [(a, b, c), (b, c, a), (c, a, b)])
}

fn topology(mesh: &Mesh<3>) -> Topology {
    let mut directed: BTreeMap<Edge, usize> = BTreeMap::new();
    let mut links: BTreeMap<VertexId, Vec<Edge>> = BTreeMap::new();
    for (a, b, c) in corners(mesh) {
        assert!(a != b && b != c && c != a, "a triangle with two corners alike");
        *directed.entry((a, b)).or_default() += 1;
        links.entry(a).or_default().push((b, c));
    }
    let edges: BTreeSet<Edge> = directed.keys().map(|&(a, b)| (a.min(b), a.max(b))).collect();
    let count = |a, b| directed.get(&(a, b)).copied().unwrap_or(0);
    let boundary: Vec<Edge> = edges.iter().copied().filter(|&(a, b)| count(a, b) + count(b, a) == 1).collect();
    let all: Vec<Edge> = edges.iter().copied().collect();
    Topology {
        vertices: mesh.vertex_count(),
        triangles: mesh.cell_count(),
        components: pieces(&all).len(),
        loops: pieces(&boundary).len(),
        euler: links.len() as isize - edges.len() as isize + mesh.cell_count() as isize,
        coherent: directed.values().all(|&n| n == 1),
        broken: links.values().filter(|link| !is_umbrella(link)).count(),
    }
}

/// The connected pieces of a graph, each the set of its vertices.
fn pieces(edges: &[Edge]) -> Vec<BTreeSet<VertexId>> {
    let mut neighbours: BTreeMap<VertexId, Vec<VertexId>> = BTreeMap::new();
    for &(a, b) in edges {
        neighbours.entry(a).or_default().push(b);
        neighbours.entry(b).or_default().push(a);
    }
    let mut seen = BTreeSet::new();
    let mut pieces = Vec::new();
    for &start in neighbours.keys() {
        let (mut piece, mut stack) = (BTreeSet::new(), vec![start]);
        while let Some(v) = stack.pop() {
            if seen.insert(v) {
                piece.insert(v);
                stack.extend(&neighbours[&v]);
            }
        }
        if !piece.is_empty() {
            pieces.push(piece);
        }
    }
    pieces
}

/// Whether the link of a vertex is one cycle or one path.
fn is_umbrella(link: &[Edge]) -> bool {
    let mut degree: BTreeMap<VertexId, usize> = BTreeMap::new();
    for &(a, b) in link {
        *degree.entry(a).or_default() += 1;
        *degree.entry(b).or_default() += 1;
    }
    let ends = degree.values().filter(|&&d| d == 1).count();
    pieces(link).len() == 1 && degree.values().all(|&d| d <= 2) && (ends == 0 || ends == 2)
}

fn points<const N: usize>(mesh: &Mesh<N>) -> impl Iterator<Item = [DVec3; N]> + '_ {
    mesh.cells.iter().map(|cell| cell.map(|v| mesh.positions[v.index()].as_dvec3()))
}

fn volume(mesh: &Mesh<3>) -> f64 {
    points(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn angle_min_degrees([a, b, c]: [DVec3; 3]) -> f64 {
    let corners = [(a, b, c), (b, c, a), (c, a, b)];
    corners.map(|(p, q, r)| (q - p).angle_between(r - p).to_degrees()).into_iter().fold(180.0, f64::min)
}

/// Counts, and a closed, connected, coherent, outward manifold of that genus.
fn check_closed(name: &str, mesh: &Mesh<3>, vertices: usize, triangles: usize, genus: isize) {
    let found = topology(mesh);
    let euler = 2 - 2 * genus;
    let wanted = Topology { vertices, triangles, components: 1, loops: 0, euler, coherent: true, broken: 0 };
    assert_eq!(found, wanted, "{name}");
    assert!(volume(mesh) > 0.0, "{name} is inside out");
    assert!(points(mesh).all(|t| area_vector(t).length() > 0.0), "{name} has a triangle without area");
}

/// Counts, and a connected, coherent manifold of genus 0 with so many boundary loops.
fn check_open(name: &str, mesh: &Mesh<3>, vertices: usize, triangles: usize, loops: usize) {
    let found = topology(mesh);
    let euler = 2 - loops as isize;
    assert_eq!(
        found,
        Topology { vertices, triangles, components: 1, loops, euler, coherent: true, broken: 0 },
        "{name}"
    );
    assert!(points(mesh).all(|t| area_vector(t).length() > 0.0), "{name} has a triangle without area");
}

fn faces_up(mesh: &Mesh<3>, up: DVec3) -> bool {
    points(mesh).all(|t| area_vector(t).dot(up) > 0.0)
}

#[test]
fn tiny_meshes() {
    check_open("triangle", &triangle(), 3, 1, 1);
    check_closed("tetrahedron", &tetrahedron(), 4, 4, 0);
    check_closed("octahedron", &octahedron(), 6, 8, 0);
    check_closed("icosahedron", &icosahedron(), 12, 20, 0);
}

#[test]
fn patches_face_up_and_have_their_loops() {
    for (mesh, vertices, triangles, loops) in [
        (grid(1, 1), 4, 2, 1),
        (grid(5, 3), 24, 30, 1),
        (bumpy_grid(7, 4, 0.5, 1), 40, 56, 1),
        (annulus(3, 1), 6, 6, 2),
        (annulus(12, 4), 60, 96, 2),
        (strip(1), 3, 1, 1),
        (strip(9), 11, 9, 1),
        (slivers(3), 81, 128, 1),
    ] {
        check_open("patch", &mesh, vertices, triangles, loops);
        assert!(faces_up(&mesh, DVec3::Z));
    }
    check_open("cylinder", &cylinder(8, 3), 32, 48, 2);
    let outward = |[a, b, c]: [DVec3; 3]| area_vector([a, b, c]).dot((a + b + c) * DVec3::new(1.0, 1.0, 0.0)) > 0.0;
    assert!(points(&cylinder(8, 3)).all(outward));
}

#[test]
fn slivers_are_slivers() {
    for seed in 0..50 {
        let mesh = slivers(seed);
        let thin = points(&mesh).filter(|&t| angle_min_degrees(t) < 5.0).count();
        assert!(thin >= 32, "seed {seed}: {thin} thin triangles");
        assert!(faces_up(&mesh, DVec3::Z), "seed {seed}");
    }
}

#[test]
fn round_meshes() {
    for level in 0..5 {
        let four = 4usize.pow(level);
        check_closed("sphere", &sphere(level), 10 * four + 2, 20 * four, 0);
        check_closed("bumpy_sphere", &bumpy_sphere(level, 0.3, 7), 10 * four + 2, 20 * four, 0);
    }
    check_closed("torus", &torus(3, 3), 9, 18, 1);
    check_closed("torus", &torus(20, 9), 180, 360, 1);
    assert!(sphere(4).positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
}

#[test]
fn boxes() {
    for n in [1, 2, 5] {
        check_closed("sharp_box", &sharp_box(n), 6 * n * n + 2, 12 * n * n, 0);
        assert!((volume(&sharp_box(n)) - 8.0).abs() < 1e-6);
    }
}

#[test]
fn genus_surfaces_have_their_genus_and_good_triangles() {
    for genus in 0..=3 {
        for resolution in [2, 3, 4, 6, 14] {
            let mesh = genus_surface(genus, resolution, 0.0, 0);
            let squares = (18 * genus + 14) * resolution * resolution;
            let name = format!("genus_surface({genus}, {resolution})");
            check_closed(&name, &mesh, squares + 2 - 2 * genus, 2 * squares, genus as isize);
            let worst = points(&mesh).map(angle_min_degrees).fold(180.0, f64::min);
            assert!(worst > 20.0, "{name}: an angle of {worst} degrees");
        }
    }
}

#[test]
fn detail_leaves_the_triangles_sound() {
    for genus in 0..=3 {
        let mesh = genus_surface(genus, 14, 0.08, 5);
        let mut angles: Vec<f64> = points(&mesh).map(angle_min_degrees).collect();
        angles.sort_by(f64::total_cmp);
        let percentile = angles[angles.len() / 100];
        assert!(angles[0] > 4.0 && percentile > 15.0, "genus {genus}: {} and {percentile} degrees", angles[0]);
        assert!(mesh != genus_surface(genus, 14, 0.0, 5));
    }
}

#[test]
fn terrain_is_a_height_field() {
    for n in [1, 2, 10, 100] {
        let mesh = terrain(n, 0.5, 42);
        check_open("terrain", &mesh, (n + 1) * (n + 1), 2 * n * n, 1);
        assert!(faces_up(&mesh, DVec3::Y));
        let (low, high) = mesh.bounding_box().expect("vertices");
        assert!(low.x == -1.0 && high.x == 1.0 && low.z == -1.0 && high.z == 1.0);
        assert!(n < 10 || high.y - low.y > 0.1, "flat");
    }
    let steepness = |roughness| points(&terrain(200, roughness, 1)).map(|t| area_vector(t).length()).sum::<f64>();
    assert!(steepness(1.0) > steepness(0.5) && steepness(0.5) > steepness(0.0));
}

#[test]
fn broken_meshes_are_broken_where_they_say() {
    let hourglass = topology(&hourglass());
    assert_eq!((hourglass.broken, hourglass.components, hourglass.loops), (1, 1, 0));
    assert!(hourglass.coherent);
    assert_eq!(topology(&fan3()).broken, 2);
    for n in [5, 6, 30] {
        let strip = topology(&moebius(n));
        let wanted = Topology {
            vertices: 3 * n,
            triangles: 4 * n,
            components: 1,
            loops: 1,
            euler: 0,
            coherent: false,
            broken: 0,
        };
        assert_eq!(strip, wanted);
    }
}

#[test]
fn components_stay_apart() {
    let union = components(&[sphere(1), torus(5, 4), grid(3, 3)]);
    let found = topology(&union);
    assert_eq!((found.components, found.loops, found.genus(), found.broken), (3, 1, 1, 0));
    assert_eq!(found.vertices, 42 + 20 + 16);
    let high = |range: std::ops::Range<usize>| union.positions[range].iter().map(|p| p.x).fold(f32::MIN, f32::max);
    let low = |range: std::ops::Range<usize>| union.positions[range].iter().map(|p| p.x).fold(f32::MAX, f32::min);
    assert!(high(0..42) < low(42..62) && high(42..62) < low(62..78));
    assert_eq!(components(&[]), Mesh::default());
}

#[test]
fn tetrahedra_fill_the_cube() {
    for n in [1, 2, 4] {
        let mesh = tetrahedral_box(n);
        assert_eq!((mesh.vertex_count(), mesh.cell_count()), ((n + 1).pow(3), 6 * n.pow(3)));
        assert!(points(&mesh).all(|t| volume_six(t) == 1.0));
        let mut faces: BTreeMap<[VertexId; 3], usize> = BTreeMap::new();
        for cell in &mesh.cells {
            for i in 0..4 {
                let mut face: Vec<VertexId> = (0..4).filter(|&k| k != i).map(|k| cell[k]).collect();
                face.sort_unstable();
                *faces.entry([face[0], face[1], face[2]]).or_default() += 1;
            }
        }
        assert!(faces.values().all(|&n| n <= 2));
        assert_eq!(faces.values().filter(|&&count| count == 1).count(), 12 * n * n, "conforming: the rest is inside");
    }
}

#[test]
fn random_meshes_are_sound_and_varied() {
    let mut seen = BTreeSet::new();
    for seed in 0..400 {
        let Named { name, mesh } = random_mesh(seed);
        let found = topology(&mesh);
        assert!(found.broken == 0 && found.coherent, "seed {seed}: {name}: {found:?}");
        assert!((1..=6000).contains(&found.triangles), "seed {seed}: {name}: {} triangles", found.triangles);
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "seed {seed}: {name}");
        assert_eq!(mesh.compact(), mesh, "seed {seed}: {name} has unused vertices");
        seen.insert((found.components.min(2), found.loops.min(2), found.genus().min(3)));
    }
    for wanted in [(1, 0, 0), (1, 0, 1), (1, 0, 2), (1, 0, 3), (1, 1, 0), (1, 2, 0)] {
        assert!(seen.contains(&wanted), "no mesh of {wanted:?}");
    }
    assert!(seen.iter().any(|kind| kind.0 == 2), "never two components");
}

#[test]
fn same_seed_same_mesh() {
    for seed in 0..60 {
        assert_eq!(random_mesh(seed), random_mesh(seed));
    }
    assert_eq!(terrain(20, 0.5, 9), terrain(20, 0.5, 9));
    assert_ne!(terrain(20, 0.5, 9), terrain(20, 0.5, 10));
    assert_ne!(bumpy_sphere(2, 0.2, 1), bumpy_sphere(2, 0.2, 2));
    assert_ne!(genus_surface(1, 3, 0.1, 1), genus_surface(1, 3, 0.1, 2));
}

#[test]
fn split_mix_is_split_mix() {
    // The first numbers of the reference implementation from seed 1234567.
    let mut rng = Random::new(1_234_567);
    assert_eq!(rng.bits(), 6_457_827_717_110_365_317);
    assert_eq!(rng.bits(), 3_203_168_211_198_807_973);
    assert!((0..1000).all(|_| rng.below(7) < 7 && (0.0..1.0).contains(&rng.unit())));
}
