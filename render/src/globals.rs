//! What all triangles of a picture share: projection, lights and wire. Computed once, for both painters,
//! so that they can only differ in arithmetic.

use crate::scene::Scene;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};
use mt_core::Camera;

/// The uniform buffer of `shade.wgsl`, field by field.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Globals {
    /// Positions relative to the scene's origin, to clip space; depth 1 (near) to 0 (far).
    pub(crate) view_projection: [[f32; 4]; 4],
    /// Unit vectors towards the lights, and the strength of each.
    pub(crate) lights: [[f32; 4]; 3],
    /// Colour of the wire, 0 to 1; the last is 1 where there is a wire.
    pub(crate) wire: [f32; 4],
    /// Half the width of a wire in pixels; heights of a triangle in pixels at which its wire is faintest
    /// and fullest; ambient light.
    pub(crate) measures: [f32; 4],
}

const _: () = assert!(size_of::<Globals>() == 144);

/// Directions right, up, towards the viewer, and strength: a key light over the left shoulder, a
/// headlight that leaves no side dark, and a fill from the right that tells shaded facets apart.
const LIGHTS: [[f32; 4]; 3] = [[-0.5, 0.62, 0.6, 0.60], [0.0, 0.0, 1.0, 0.26], [0.8, -0.12, 0.59, 0.17]];
const AMBIENT: f32 = 0.13;
/// How much of a wire is left where triangles are too small for it: a veil, not a blot.
pub(crate) const WIRE_FLOOR: f32 = 0.16;

impl Globals {
    pub(crate) fn new(scene: &Scene, camera: &Camera) -> Self {
        // Depth reversed: 1 at the near plane and 0 at the far one, where the exponents of floats make up for what
        // perspective takes.
        let near_origin = Camera {
            eye: camera.eye - scene.origin,
            target: camera.target - scene.origin,
            near: camera.far,
            far: camera.near,
            ..*camera
        };
        let forward = camera.direction();
        let right = forward.cross(camera.up).normalize_or_zero();
        let up = right.cross(forward);
        let lights = LIGHTS.map(|[x, y, z, strength]| {
            (right * x + up * y - forward * z).normalize_or_zero().extend(strength).to_array()
        });
        let wire = scene.wire.map_or([0.0; 4], |[red, green, blue, _]| {
            [red, green, blue, 255].map(|channel| f32::from(channel) / 255.0)
        });
        let scale = scale(camera);
        Self {
            view_projection: near_origin.view_projection().to_cols_array_2d(),
            lights,
            wire,
            measures: [0.55 * scale, 1.5, 9.0 * scale, AMBIENT],
        }
    }

    pub(crate) fn matrix(&self) -> Mat4 {
        Mat4::from_cols_array_2d(&self.view_projection)
    }

    /// What the lights leave of a colour, where `normal` is on the viewer's side. The square root takes
    /// light to sRGB well enough, and costs little.
    pub(crate) fn light(&self, normal: Vec3) -> f32 {
        let arriving = |light: [f32; 4]| light[3] * normal.dot(Vec4::from_array(light).truncate()).max(0.0);
        (self.measures[3] + self.lights.map(arriving).iter().sum::<f32>()).sqrt()
    }

    /// How much of a pixel the wire covers, from barycentric coordinates and their slopes per pixel.
    pub(crate) fn wire_cover(&self, weights: Vec3, slopes: Vec3) -> f32 {
        let [half_width, faint, full, _] = self.measures;
        let slopes = slopes.max(Vec3::splat(1e-6));
        let distance = (weights / slopes).min_element();
        let height = 1.0 / slopes.max_element();
        let size = ((height - faint) / (full - faint)).clamp(0.0, 1.0);
        (half_width + 0.5 - distance).clamp(0.0, 1.0) * (WIRE_FLOOR + (1.0 - WIRE_FLOOR) * size)
    }

    /// How much lighter the wire is where the surface is nearly as dark as the wire.
    pub(crate) fn wire_lift(shaded: Vec3) -> f32 {
        0.42 * (1.0 - (4.0 * shaded.dot(Vec3::new(0.3, 0.6, 0.1))).min(1.0))
    }
}

/// Widths are meant for pictures 768 pixels high; larger pictures get wider lines, smaller ones do not
/// get thinner ones.
pub(crate) fn scale(camera: &Camera) -> f32 {
    (camera.height_px as f32 / 768.0).max(1.0)
}
