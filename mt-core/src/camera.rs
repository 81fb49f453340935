//! A pinhole camera: what criteria measure errors against and renderers look through.

use glam::{Mat4, Vec3, Vec4};
use serde::{Deserialize, Serialize};

/// A perspective camera in model units; read from and written to JSON as it stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where the camera is.
    pub eye: Vec3,
    /// The point it looks at.
    pub target: Vec3,
    /// Roughly upwards; must not point along the view.
    #[serde(default = "default_up")]
    pub up: Vec3,
    /// Vertical field of view in degrees, in (0, 180).
    #[serde(default = "default_fov")]
    pub fov_y_degrees: f32,
    /// Distance of the near plane, above 0.
    pub near: f32,
    /// Distance of the far plane, above `near`.
    pub far: f32,
    /// Width of the picture in pixels.
    #[serde(default = "default_width")]
    pub width_px: u32,
    /// Height of the picture in pixels.
    #[serde(default = "default_height")]
    pub height_px: u32,
}

fn default_up() -> Vec3 {
    Vec3::Y
}
fn default_fov() -> f32 {
    45.0
}
fn default_width() -> u32 {
    1024
}
fn default_height() -> u32 {
    768
}

/// Why a camera cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A coordinate is infinite or not a number.
    #[error("camera has a value that is not finite")]
    NotFinite,
    /// `eye` and `target` coincide, or `up` is along the view.
    #[error("camera has no direction: eye and target must differ, and up must not point along the view")]
    NoDirection,
    /// The lens or the picture size is out of range.
    #[error("camera needs 0 < fov_y_degrees < 180, 0 < near < far, and a picture of 1 to 16384 pixels a side")]
    Lens,
}

impl Camera {
    /// A camera outside the box `low..high`, which it sees whole, from the direction `from`.
    pub fn around(low: Vec3, high: Vec3, from: Vec3) -> Self {
        let center = (low + high) * 0.5;
        let radius = ((high - low).length() * 0.5).max(f32::MIN_POSITIVE);
        let from = from.try_normalize().unwrap_or(Vec3::Z);
        let distance = radius / (default_fov().to_radians() * 0.5).sin();
        Self {
            eye: center + from * distance,
            target: center,
            up: if from.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y },
            fov_y_degrees: default_fov(),
            near: (distance - radius).max(radius * 1e-3),
            far: distance + radius * 1.01,
            width_px: default_width(),
            height_px: default_height(),
        }
    }

    /// Refuses what cannot be looked through.
    pub fn check(&self) -> Result<(), CameraError> {
        let lens = [self.fov_y_degrees, self.near, self.far];
        if !(self.eye.is_finite() && self.target.is_finite() && self.up.is_finite())
            || lens.iter().any(|x| !x.is_finite())
        {
            return Err(CameraError::NotFinite);
        }
        let side = self.direction().cross(self.up.normalize_or_zero());
        if self.direction() == Vec3::ZERO || side.length() < 1e-4 {
            return Err(CameraError::NoDirection);
        }
        let sizes = 1..=16_384;
        let good_lens =
            self.fov_y_degrees > 0.0 && self.fov_y_degrees < 180.0 && self.near > 0.0 && self.far > self.near;
        if !good_lens || !sizes.contains(&self.width_px) || !sizes.contains(&self.height_px) {
            return Err(CameraError::Lens);
        }
        Ok(())
    }

    /// Unit vector from the eye towards the target; zero where they coincide.
    pub fn direction(&self) -> Vec3 {
        (self.target - self.eye).normalize_or_zero()
    }

    /// Width over height of the picture.
    pub fn aspect(&self) -> f32 {
        self.width_px as f32 / self.height_px as f32
    }

    /// Pixels that a length of 1 at distance 1 covers, in the middle of the picture.
    pub fn pixels_per_unit(&self) -> f32 {
        self.height_px as f32 / (2.0 * (self.fov_y_degrees.to_radians() * 0.5).tan())
    }

    /// World to clip space, right-handed, depth 0 (near) to 1 (far), y up.
    pub fn view_projection(&self) -> Mat4 {
        let view = glam::camera::rh::view::look_at_mat4(self.eye, self.target, self.up);
        let fov = self.fov_y_degrees.to_radians();
        glam::camera::rh::proj::directx::perspective(fov, self.aspect(), self.near, self.far) * view
    }

    /// The six planes of the view frustum, unit normals pointing inwards: `dot(n, p) + d >= 0` inside.
    pub fn frustum(&self) -> [Vec4; 6] {
        let m = self.view_projection();
        let (x, y, z, w) = (m.row(0), m.row(1), m.row(2), m.row(3));
        [w + x, w - x, w + y, w - y, z, w - z].map(|plane| plane / plane.truncate().length())
    }

    /// The eight corners of the frustum: near then far, each left-bottom, right-bottom, right-top, left-top.
    pub fn frustum_corners(&self) -> [Vec3; 8] {
        let forward = self.direction();
        let right = forward.cross(self.up).normalize_or_zero();
        let up = right.cross(forward);
        let half = (self.fov_y_degrees.to_radians() * 0.5).tan();
        let corner = |i: usize| {
            let depth = if i < 4 { self.near } else { self.far };
            let x = if matches!(i % 4, 1 | 2) { 1.0 } else { -1.0 };
            let y = if i % 4 >= 2 { 1.0 } else { -1.0 };
            self.eye + (forward + right * (x * half * self.aspect()) + up * (y * half)) * depth
        };
        std::array::from_fn(corner)
    }
}
