//! The Gabriel graph of points in space: two are joined when no third lies in the ball whose diameter they are.
//!
//! It is a part of the Delaunay triangulation and has the Euclidean minimum spanning tree in it, so it joins what is
//! nearest across every gap. Unlike the triangulation it is defined for any points, coplanar and cospherical ones too.

use glam::{DVec3, Vec3};
use mt_core::VertexId;
use rstar::RTree;
use rstar::primitives::GeomWithData;

type Point = GeomWithData<[f64; 3], VertexId>;

/// The edges of the Gabriel graph of these vertices that are not longer than `length`, in no particular sequence but
/// always the same. Of vertices in one place the first stands for all, and is joined to each of the others.
///
/// Requires: finite positions.
pub(super) fn edges(positions: &[Vec3], mut vertices: Vec<VertexId>, length: f64) -> Vec<[VertexId; 2]> {
    // Adding zero makes one zero of the two.
    let place = |v: &VertexId| (positions[v.index()] + Vec3::ZERO).to_array().map(f32::to_bits);
    vertices.sort_unstable_by_key(|v| (place(v), *v));
    let mut edges = Vec::new();
    let mut points = Vec::with_capacity(vertices.len());
    for run in vertices.chunk_by(|u, v| place(u) == place(v)) {
        edges.extend(run[1..].iter().map(|&v| [run[0], v]));
        points.push(Point::new(positions[run[0].index()].as_dvec3().to_array(), run[0]));
    }
    let tree = RTree::bulk_load(points.clone());
    let mut near: Vec<(f64, VertexId, DVec3)> = Vec::new();
    for point in &points {
        let (from, v) = (DVec3::from(*point.geom()), point.data);
        near.clear();
        near.extend(tree.locate_within_distance(*point.geom(), length * length).map(|other| {
            let at = DVec3::from(*other.geom());
            (at.distance_squared(from), other.data, at)
        }));
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.retain(|other| other.1 != v);
        for (i, &(distance, w, to)) in near.iter().enumerate().filter(|(_, other)| other.1 > v) {
            // What is in the ball is nearer than its far end.
            let inside = |other: &&(f64, VertexId, DVec3)| (from - other.2).dot(to - other.2) < 0.0;
            let nearer = near.iter().take_while(|other| other.0 <= distance);
            if nearer.take(i + 1).find(inside).is_none() {
                edges.push([v, w]);
            }
        }
    }
    edges
}
