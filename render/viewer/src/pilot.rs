//! Where the camera is and how it is moved. Whatever is done to it, it can be looked through.

use glam::{Quat, Vec2, Vec3};
use mt_core::Camera;

/// The least and the largest share of the model's radius between eye and target.
const DISTANCES: [f32; 2] = [1e-4, 50.0];
/// Lengths whose squares are numbers still.
const SMALLEST: f32 = 1e-15;
/// Looking straight up or down has no upwards: the cosine is kept below this.
const STEEPEST: f32 = 0.9995;

/// How a camera moves when it is dragged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Flight {
    /// About the point that it looks at.
    #[default]
    Orbit,
    /// From where it is.
    Fly,
}

/// A camera with the model that it looks at.
#[derive(Clone, Debug)]
pub struct Pilot {
    camera: Camera,
    /// How it moves.
    pub flight: Flight,
    center: Vec3,
    radius: f32,
    low: Vec3,
    high: Vec3,
}

impl Pilot {
    /// Sees the box `low..high` whole; of a model without extent its surroundings.
    pub fn around(low: Vec3, high: Vec3) -> Self {
        let center = low * 0.5 + high * 0.5;
        let center = if center.is_finite() { center } else { Vec3::ZERO };
        // What is smaller than this beside its place has no directions in it.
        let least = (center.abs().max_element() * 1e-5).max(SMALLEST);
        let radius = (high * 0.5 - low * 0.5).length();
        let radius = if radius.is_finite() { radius.max(least) } else { least };
        let half = Vec3::splat(radius / 3f32.sqrt());
        let (low, high) = (center - half, center + half);
        let camera = Camera::around(low, high, Vec3::new(0.6, 0.5, 1.0));
        Self { camera, flight: Flight::Orbit, center, radius, low, high }
    }

    /// The camera, for a picture of this size.
    pub fn camera(&self, [width, height]: [u32; 2]) -> Camera {
        let camera = Camera { width_px: width.clamp(1, 16_384), height_px: height.clamp(1, 16_384), ..self.camera };
        self.with_planes(camera)
    }

    /// The same, with all that may be drawn around the model in view, such as the frustum of another eye.
    pub fn camera_outside(&self, size: [u32; 2]) -> Camera {
        let camera = self.camera(size);
        Camera { near: self.radius * 2e-3, far: camera.far + 20.0 * self.radius, ..camera }
    }

    /// Near and far plane just around the model, as far as the eye lets them.
    fn with_planes(&self, camera: Camera) -> Camera {
        let away = camera.eye.distance(self.center);
        let near = (away - self.radius * 1.01).max(self.radius * 2e-3);
        Camera { near, far: (away + self.radius * 1.01).max(near * 2.0), ..camera }
    }

    /// Takes a camera from elsewhere, unless it cannot be looked through.
    pub fn set(&mut self, camera: &Camera) {
        self.try_to(*camera);
    }

    /// Back to where all is seen.
    pub fn fit(&mut self) {
        let around = Camera::around(self.low, self.high, -self.camera.direction());
        // Straight up stays up, however steeply it looks.
        self.try_to(Camera { up: self.camera.up, ..around });
    }

    /// A drag by so many radians: about the target, or about the eye.
    pub fn turn(&mut self, by: Vec2) {
        let Camera { eye, target, up, .. } = self.camera;
        let forward = self.camera.direction();
        let up = up.normalize_or(Vec3::Y);
        let right = forward.cross(up).normalize_or(Vec3::X);
        let turned = Quat::from_axis_angle(up, -by.x) * Quat::from_axis_angle(right, -by.y) * forward;
        // No farther than nearly straight up or down.
        let turned = if turned.dot(up).abs() > STEEPEST { Quat::from_axis_angle(up, -by.x) * forward } else { turned };
        let length = eye.distance(target);
        self.try_to(match self.flight {
            Flight::Orbit => Camera { eye: target - turned * length, ..self.camera },
            Flight::Fly => Camera { target: eye + turned * length, ..self.camera },
        });
    }

    /// Eye and target together, by shares of their distance: right, up and forward.
    pub fn slide(&mut self, by: Vec3) {
        let forward = self.camera.direction();
        let right = forward.cross(self.camera.up).normalize_or(Vec3::X);
        let length = self.camera.eye.distance(self.camera.target);
        let way = (right * by.x + right.cross(forward) * by.y + forward * by.z) * length;
        self.try_to(Camera { eye: self.camera.eye + way, target: self.camera.target + way, ..self.camera });
    }

    /// Nearer to the target, or farther: the distance times `factor`.
    pub fn zoom(&mut self, factor: f32) {
        let [least, most] = DISTANCES.map(|share| share * self.radius);
        let length = (self.camera.eye.distance(self.camera.target) * factor).clamp(least, most);
        self.try_to(Camera { eye: self.camera.target - self.camera.direction() * length, ..self.camera });
    }

    /// Where that can be looked through and is not lost in space; else stays.
    fn try_to(&mut self, camera: Camera) {
        let camera = self.with_planes(camera);
        if camera.check().is_ok() && camera.eye.distance(self.center) <= 1e3 * self.radius {
            self.camera = camera;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pilot() -> Pilot {
        Pilot::around(Vec3::splat(-1.0), Vec3::splat(1.0))
    }

    fn eye(pilot: &Pilot) -> Vec3 {
        pilot.camera([640, 480]).eye
    }

    #[test]
    fn an_orbit_keeps_its_distance_and_comes_back() {
        let mut pilot = pilot();
        let before = eye(&pilot);
        for _ in 0..8 {
            pilot.turn(Vec2::new(std::f32::consts::TAU / 8.0, 0.0));
            assert!((eye(&pilot).length() - before.length()).abs() < 1e-4);
        }
        assert!(eye(&pilot).distance(before) < 1e-4);
        (0..100).for_each(|_| pilot.turn(Vec2::new(0.0, 0.1)));
        assert_eq!(pilot.camera([640, 480]).check(), Ok(()));
    }

    #[test]
    fn flying_turns_about_the_eye() {
        let mut pilot = Pilot { flight: Flight::Fly, ..pilot() };
        let before = eye(&pilot);
        pilot.turn(Vec2::new(0.5, 0.2));
        assert_eq!(eye(&pilot), before);
        pilot.slide(Vec3::Z);
        let camera = pilot.camera([640, 480]);
        assert!((camera.eye - before).normalize().dot(camera.direction()) > 0.999);
    }

    #[test]
    fn no_way_leads_to_a_camera_that_cannot_be() {
        let mut pilot = pilot();
        let bad = [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, 0.0];
        for x in bad {
            pilot.turn(Vec2::new(x, x));
            pilot.slide(Vec3::splat(x));
            pilot.zoom(x);
            pilot.set(&Camera { target: Vec3::splat(x), ..pilot.camera([9, 9]) });
            pilot.set(&Camera { eye: Vec3::splat(x), ..pilot.camera([9, 9]) });
            assert_eq!(pilot.camera([0, 100_000]).check(), Ok(()), "{x}");
        }
        (0..1000).for_each(|_| pilot.slide(Vec3::Z));
        assert!(eye(&pilot).length() < 1e4);
        // A model without extent.
        for (low, high) in
            [(Vec3::ZERO, Vec3::ZERO), (Vec3::splat(5.0), Vec3::splat(5.0)), (Vec3::INFINITY, Vec3::NEG_INFINITY)]
        {
            assert_eq!(Pilot::around(low, high).camera([64, 64]).check(), Ok(()));
        }
    }
}
