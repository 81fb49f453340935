//! What lies under a pixel: the nearest triangle of a view, and its nearest corner.

use glam::{DVec3, Vec2, Vec3};
use mt_core::{Camera, VertexId};
use render::{Placed, Places};

/// A triangle that was hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The triangle.
    pub placed: Placed,
    /// Its corner that is nearest to the place that was hit.
    pub corner: VertexId,
    /// The place, in model units.
    pub at: Vec3,
}

/// The nearest triangle under a place in the picture, in pixels from its upper left corner. O(triangles of the view).
pub fn pick(places: &Places, camera: &Camera, pixel: Vec2) -> Option<Hit> {
    let direction = ray(camera, pixel);
    // What lies before the near plane is not drawn.
    let nearest_seen = f64::from(camera.near) / direction.dot(camera.direction().as_dvec3()).max(f64::MIN_POSITIVE);
    let eye = (camera.eye - places.origin()).as_dvec3();
    let mut nearest: Option<(f64, Hit)> = None;
    for (placed, corners) in places.triangles() {
        let at = corners.map(|corner| Vec3::from_array(corner.position).as_dvec3());
        let Some(distance) = meet(eye, direction, at).filter(|&distance| distance >= nearest_seen) else { continue };
        if nearest.is_none_or(|(least, _)| distance < least) {
            let place = eye + direction * distance;
            let away = |i: &usize| at[*i].distance_squared(place);
            let corner = (0..3).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
            let hit = Hit { placed, corner: placed.corners[corner], at: place.as_vec3() + places.origin() };
            nearest = Some((distance, hit));
        }
    }
    nearest.map(|(_, hit)| hit)
}

/// The direction from the eye through a pixel.
fn ray(camera: &Camera, pixel: Vec2) -> DVec3 {
    let forward = camera.direction();
    let right = forward.cross(camera.up).normalize_or_zero();
    let up = right.cross(forward);
    let half = (camera.fov_y_degrees.to_radians() * 0.5).tan();
    let size = Vec2::new(camera.width_px as f32, camera.height_px as f32);
    let ndc = pixel / size * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
    let direction = forward + right * (ndc.x * half * camera.aspect()) + up * (ndc.y * half);
    direction.as_dvec3().normalize_or_zero()
}

/// How far along a ray it meets a triangle, from either side.
fn meet(eye: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (along, aside) = (b - a, c - a);
    let across = direction.cross(aside);
    let volume = along.dot(across);
    if volume == 0.0 {
        return None;
    }
    let from = eye - a;
    let v = from.dot(across) / volume;
    let turned = from.cross(along);
    let w = direction.dot(turned) / volume;
    let distance = aside.dot(turned) / volume;
    let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0 && distance > 0.0;
    inside.then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mt_core::{CellId, Sink, generate};
    use render::LiveMesh;

    /// Every triangle that faces the eye is hit where its middle is seen, if nothing is in front of it; brute force by the
    /// projection of the middle.
    #[test]
    fn middles_are_hit() {
        let mesh = generate::sphere(2);
        let mut live = LiveMesh::new(&mesh.positions, mesh.cell_count() as u32, Vec3::new(0.3, 0.1, 0.0), [9; 4]);
        mesh.cells.iter().enumerate().for_each(|(i, &cell)| live.make(CellId::new(i), cell));
        let (low, high) = mesh.bounding_box().unwrap();
        let camera = Camera::around(low, high, Vec3::new(0.2, 0.4, 1.0));
        let mut hits = 0;
        for (i, cell) in mesh.cells.iter().enumerate() {
            let at = cell.map(|v| mesh.positions[v.index()]);
            let middle = (at[0] + at[1] + at[2]) / 3.0;
            // A sphere is convex: what faces the eye is not hidden.
            let normal = (at[1] - at[0]).cross(at[2] - at[0]);
            if normal.dot(camera.eye - middle) <= 0.0 {
                continue;
            }
            let clip = camera.view_projection() * middle.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let pixel = Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * Vec2::new(1024.0, 768.0);
            let hit = pick(&live.places, &camera, pixel).expect("a triangle is there");
            assert_eq!(hit.placed.cell, CellId::new(i));
            assert!(hit.at.distance(middle) < 1e-3 && cell.contains(&hit.corner));
            hits += 1;
        }
        assert!(hits > 50, "{hits}");
        assert_eq!(pick(&live.places, &camera, Vec2::ZERO), None);
        assert_eq!(pick(&live.places, &camera, Vec2::NAN), None);
    }
}
