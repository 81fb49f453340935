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

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let text = r#"{ "eye": [0, 0, 4], "target": [0, 0, 0], "fov_y_degrees": 90, "near": 1, "far": 7, "width_px": 200, "height_px": 100 }"#;
        serde_json::from_str(text).expect("a camera")
    }

    #[test]
    fn what_is_not_said_has_usual_values() {
        let camera: Camera =
            serde_json::from_str(r#"{ "eye": [0, 0, 4], "target": [0, 0, 0], "near": 1, "far": 7 }"#).unwrap();
        assert_eq!((camera.up, camera.fov_y_degrees), (Vec3::Y, 45.0));
        assert_eq!((camera.width_px, camera.height_px), (1024, 768));
        assert_eq!(camera.check(), Ok(()));
    }

    #[test]
    fn what_cannot_be_looked_through_is_refused() {
        let with = |change: fn(&mut Camera)| {
            let mut changed = camera();
            change(&mut changed);
            changed.check()
        };
        let not_finite: [fn(&mut Camera); 5] = [
            |c| c.eye.x = f32::NAN,
            |c| c.target.y = f32::INFINITY,
            |c| c.up.z = f32::NAN,
            |c| c.near = f32::NAN,
            |c| c.far = f32::INFINITY,
        ];
        assert!(not_finite.into_iter().all(|change| with(change) == Err(CameraError::NotFinite)));
        let directionless: [fn(&mut Camera); 3] = [|c| c.target = c.eye, |c| c.up = Vec3::Z, |c| c.up = Vec3::ZERO];
        assert!(directionless.into_iter().all(|change| with(change) == Err(CameraError::NoDirection)));
        let lens: [fn(&mut Camera); 9] = [
            |c| c.fov_y_degrees = 0.0,
            |c| c.fov_y_degrees = 180.0,
            |c| c.near = 0.0,
            |c| c.far = c.near,
            |c| c.near = -1.0,
            |c| c.width_px = 0,
            |c| c.height_px = 0,
            |c| c.width_px = 16_385,
            |c| c.height_px = 16_385,
        ];
        assert!(lens.into_iter().all(|change| with(change) == Err(CameraError::Lens)));
        let good: [fn(&mut Camera); 3] = [|c| c.width_px = 16_384, |c| c.height_px = 1, |c| c.fov_y_degrees = 179.0];
        assert!(good.into_iter().all(|change| with(change) == Ok(())));
    }

    #[test]
    fn a_lens_has_its_proportions() {
        let camera = camera();
        assert_eq!(camera.aspect(), 2.0);
        assert_eq!(camera.direction(), -Vec3::Z);
        // At a right angle half of the picture's height is as far as the picture.
        assert!((camera.pixels_per_unit() - 50.0).abs() < 1e-4);
    }

    #[test]
    fn a_camera_around_a_box_sees_it_whole() {
        let (low, high) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 6.0, 4.0));
        for from in [Vec3::Y, -Vec3::Y, Vec3::new(1.0, 0.2, -3.0), Vec3::ZERO] {
            let camera = Camera::around(low, high, from);
            assert_eq!(camera.check(), Ok(()));
            assert_eq!(camera.target, Vec3::new(1.5, 4.0, 3.5));
            let towards = from.try_normalize().unwrap_or(Vec3::Z);
            assert!(camera.direction().dot(towards) < -0.9999);
            // Wide enough for the sphere around the box, and no wider.
            let radius = (high - low).length() * 0.5;
            assert!((camera.eye.distance(camera.target) * (22.5f32).to_radians().sin() - radius).abs() < 1e-4);
            let planes = camera.frustum();
            for i in 0..8 {
                let at = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
                let corner = Vec3::new(at(0, low.x, high.x), at(1, low.y, high.y), at(2, low.z, high.z));
                assert!(planes.iter().all(|plane| plane.dot(corner.extend(1.0)) >= -1e-4), "{corner} from {from}");
            }
        }
    }

    #[test]
    fn planes_and_corners_are_of_one_frustum() {
        // At 60 degrees half of the height is not as far as the picture, nor the inverse of that.
        let camera = Camera { fov_y_degrees: 60.0, ..camera() };
        let half = 30f32.to_radians().tan();
        let corners = camera.frustum_corners();
        let near = [[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]];
        for (i, corner) in corners.iter().enumerate() {
            let depth = if i < 4 { 1.0 } else { 7.0 };
            let [x, y] = near[i % 4].map(|side: f32| side * half * depth);
            assert!(corner.distance(Vec3::new(x, y, 4.0 - depth)) < 1e-4, "corner {i} is {corner}");
        }
        // Left, right, bottom, top, near, far: each holds its own four corners, and the middle is inside.
        let on = [[0, 3, 4, 7], [1, 2, 5, 6], [0, 1, 4, 5], [2, 3, 6, 7], [0, 1, 2, 3], [4, 5, 6, 7]];
        for (plane, own) in camera.frustum().iter().zip(on) {
            assert!((plane.truncate().length() - 1.0).abs() < 1e-5);
            for (i, corner) in corners.iter().enumerate() {
                let height = plane.dot(corner.extend(1.0));
                assert!(if own.contains(&i) { height.abs() < 1e-3 } else { height > 0.3 }, "{plane} and corner {i}");
            }
            assert!(plane.dot(Vec4::new(0.0, 0.0, 0.0, 1.0)) > 0.5);
        }
    }
}
