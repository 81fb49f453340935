//! The camera seen from outside: its frustum as lines, and a second camera that sees frustum and model.

use crate::scene::{Scene, Segment};
use glam::Vec3;
use mt_core::Camera;

/// Deep orange: far from both ramps' middles, and from warm grey.
const FRUSTUM: [u8; 4] = [214, 72, 28, 255];

impl Scene {
    /// Adds the frustum of `camera` as lines, cut off shortly behind the box `low..high` of the model, and
    /// its eye as a dot. The middle of the upper side carries a mark, so that one sees which way is up.
    pub fn add_frustum(&mut self, camera: &Camera, low: Vec3, high: Vec3) {
        let [near, far] = rectangles(camera, low, high);
        let mut line = |from: Vec3, to: Vec3, width_px: f32| {
            let (from, to) = ((from - self.origin).to_array(), (to - self.origin).to_array());
            self.segments.push(Segment { from, to, colour: FRUSTUM, width_px });
        };
        for i in 0..4 {
            line(near[i], near[(i + 1) % 4], 1.4);
            line(far[i], far[(i + 1) % 4], 2.0);
            line(camera.eye, far[i], 2.0);
        }
        let roof = (far[2] + far[3]) * 0.5 + (far[2] - far[1]) * 0.07;
        for side in [0.45, 0.55] {
            line(far[3].lerp(far[2], side), roof, 2.0);
        }
        line(camera.eye, camera.eye, 11.0);
    }
}

/// A camera from which both the box `low..high` of the model and the frustum that
/// [`Scene::add_frustum`] draws for `camera` are seen whole; same picture size and lens angle.
pub fn outside(camera: &Camera, low: Vec3, high: Vec3) -> Camera {
    let [_, far] = rectangles(camera, low, high);
    let mut points: Vec<Vec3> = box_corners(low, high).into();
    points.extend(far);
    points.push(camera.eye);

    // From beside, above and a little behind the first camera: its frustum is seen in profile.
    let forward = camera.direction();
    let right = forward.cross(camera.up).normalize_or_zero();
    let up = right.cross(forward);
    let towards = (right * 0.8 + up * 0.45 - forward * 0.3).try_normalize().unwrap_or(Vec3::Z);
    let side = up.cross(towards).normalize_or_zero();
    let over = towards.cross(side);
    fit(camera, &points, [side, over, towards])
}

/// The camera with the given axes (right, up, backwards) that just sees all points, with a margin.
fn fit(like: &Camera, points: &[Vec3], axes: [Vec3; 3]) -> Camera {
    let local = |point: Vec3| Vec3::from_array(axes.map(|axis| axis.dot(point)));
    let first = local(points[0]);
    let (low, high) = points.iter().fold((first, first), |(low, high), &point| {
        let place = local(point);
        (low.min(place), high.max(place))
    });
    let middle = low * 0.5 + high * 0.5;
    let center = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
    let slope = (like.fov_y_degrees.clamp(20.0, 60.0).to_radians() * 0.5).tan() * 0.92;
    let needed = |point: &Vec3| {
        let place = local(*point) - middle;
        place.z + (place.x.abs() / like.aspect()).max(place.y.abs()) / slope
    };
    let size = (high - low).length().max(f32::MIN_POSITIVE * 1e6);
    let distance = points.iter().map(needed).fold(size * 0.1, f32::max);
    Camera {
        eye: center + axes[2] * distance,
        target: center,
        up: axes[1],
        fov_y_degrees: like.fov_y_degrees.clamp(20.0, 60.0),
        near: ((distance - size) * 0.9).max(size * 1e-3),
        far: distance + size,
        ..*like
    }
}

/// The near rectangle, and the far one drawn back to the model; each left-bottom, right-bottom, right-top, left-top.
fn rectangles(camera: &Camera, low: Vec3, high: Vec3) -> [[Vec3; 4]; 2] {
    let far = visible_length(camera, low, high);
    let near = camera.near.min(far * 0.5);
    let [a, b, c, d, e, f, g, h] = Camera { near, far, ..*camera }.frustum_corners();
    [[a, b, c, d], [e, f, g, h]]
}

/// How far the drawn frustum reaches: just behind the model, but at least half the model's size where
/// the camera looks past it, and never beyond the far plane.
fn visible_length(camera: &Camera, low: Vec3, high: Vec3) -> f32 {
    let forward = camera.direction();
    let depth = |corner: Vec3| forward.dot(corner - camera.eye);
    let behind = box_corners(low, high).map(depth).into_iter().fold(0.0, f32::max);
    let least = (high - low).length() * 0.5;
    let length = (behind * 1.03).max(least);
    if length > 0.0 { length.min(camera.far) } else { camera.far }
}

fn box_corners(low: Vec3, high: Vec3) -> [Vec3; 8] {
    let pick = |i: usize, axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
    std::array::from_fn(|i| Vec3::new(pick(i, 0), pick(i, 1), pick(i, 2)))
}
