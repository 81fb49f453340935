//! The camera path of a study: once around the model, from far to near and back.

use glam::Vec3;
use mt_core::{Camera, Mesh};
use std::f32::consts::TAU;

/// `frames` cameras around a mesh. Far away all of it is in view; nearest, the camera is just outside and sees a part.
pub fn camera_path(mesh: &Mesh<3>, frames: u32) -> Vec<Camera> {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let center = (low + high) * 0.5;
    let radius = ((high - low).length() * 0.5).max(f32::MIN_POSITIVE);
    let camera = |frame: u32| {
        let t = frame as f32 / frames.max(1) as f32;
        let (turn, away) = (TAU * t, 1.55 + 0.95 * (TAU * t).cos());
        let from = Vec3::new(turn.sin(), 0.35 + 0.1 * (2.0 * turn).sin(), turn.cos()).normalize();
        let eye = center + from * (radius * away);
        // Near the surface the camera looks past the centre, along its way.
        let ahead = Vec3::new(turn.cos(), 0.0, -turn.sin()) * (radius * 0.35 * (2.5 - away).max(0.0));
        Camera {
            eye,
            target: center + ahead,
            up: Vec3::Y,
            fov_y_degrees: 40.0,
            near: radius * 0.02,
            far: radius * 6.0,
            width_px: 1024,
            height_px: 768,
        }
    };
    (0..frames).map(camera).collect()
}
