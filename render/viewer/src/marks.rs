//! Lines that are drawn over a view: spheres of nodes, and the chain that refining one of them forces.

use crate::any_view::{NodeFacts, Picked};
use glam::Vec3;
use render::{Rgba, Scene, Segment};
use std::f32::consts::TAU;

const PICKED: Rgba = [200, 40, 40, 255];
const PARENT: Rgba = [30, 90, 200, 255];
const CHAIN: Rgba = [222, 140, 20, 255];
/// Sides of a circle.
const SIDES: usize = 40;
/// Spheres of a chain that are drawn; more would hide the mesh.
const SPHERES: usize = 12;

/// Adds what was picked: its corner, the spheres of the node that it came with and of the one that refines it, and the chain.
pub fn add_picked(scene: &mut Scene, picked: &Picked) {
    dot(scene, picked.position, PICKED, 9.0);
    if let Some(came_with) = &picked.came_with {
        sphere(scene, came_with, PARENT, 1.5);
    }
    for pair in picked.chain.windows(2) {
        line(scene, pair[0].bound.center, pair[1].bound.center, CHAIN, 2.0);
    }
    let before = picked.chain.len().saturating_sub(1);
    for node in picked.chain.iter().take(before).rev().take(SPHERES) {
        sphere(scene, node, CHAIN, 1.0);
    }
    if let Some(refined_by) = &picked.refined_by {
        sphere(scene, refined_by, PICKED, 2.0);
    }
}

fn line(scene: &mut Scene, from: Vec3, to: Vec3, colour: Rgba, width_px: f32) {
    let [from, to] = [from, to].map(|p| (p - scene.origin).to_array());
    scene.segments.push(Segment { from, to, colour, width_px });
}

fn dot(scene: &mut Scene, at: Vec3, colour: Rgba, width_px: f32) {
    line(scene, at, at, colour, width_px);
}

/// Three circles about a node's sphere.
fn sphere(scene: &mut Scene, node: &NodeFacts, colour: Rgba, width_px: f32) {
    let (center, radius) = (node.bound.center, node.bound.radius);
    if !(center.is_finite() && radius.is_finite()) {
        return;
    }
    for axes in [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]] {
        let at = |side: usize| {
            let (sine, cosine) = (TAU * side as f32 / SIDES as f32).sin_cos();
            center + (axes[0] * cosine + axes[1] * sine) * radius
        };
        (0..SIDES).for_each(|side| line(scene, at(side), at(side + 1), colour, width_px));
    }
}
