//! Clipping: cuts a triangle to the part that can be projected, so that nothing behind the eye, and no
//! coordinate beyond what the rasteriser's integers hold, gets past this file.

use glam::{Vec3, Vec4};

/// A point in clip space, and what it is a mixture of: the triangle's three corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mixed {
    pub(crate) clip: Vec4,
    pub(crate) weights: Vec3,
}

/// A convex polygon: three corners, and one more for each of six planes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Polygon {
    points: [Mixed; 9],
    len: usize,
}

/// Half-widths of the picture that are kept on each side; wide, so that few triangles are cut.
const GUARD: f32 = 32.0;

/// Distances to far, near, left, right, lower and upper plane; negative outside.
fn distances(v: Vec4) -> [f32; 6] {
    let guard = GUARD * v.w;
    [v.z, v.w - v.z, guard + v.x, guard - v.x, guard + v.y, guard - v.y]
}

/// What of a triangle lies between the planes; empty where nothing does or a coordinate is not finite.
pub(crate) fn clip(corners: [Vec4; 3]) -> Polygon {
    let mut polygon = Polygon::default();
    if !corners.iter().all(|corner| corner.is_finite()) {
        return polygon;
    }
    for (clip, weights) in corners.into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        polygon.push(Mixed { clip, weights });
    }
    let outside = corners.map(|corner| distances(corner).map(|distance| distance < 0.0));
    for plane in 0..6 {
        match outside.iter().filter(|outside| outside[plane]).count() {
            0 => {}
            3 => return Polygon::default(),
            _ => polygon = polygon.cut(plane),
        }
    }
    // On the near plane w is the near distance; rounding may still reach 0 in absurd projections.
    if polygon.points().iter().any(|point| point.clip.w <= 0.0) { Polygon::default() } else { polygon }
}

impl Polygon {
    pub(crate) fn points(&self) -> &[Mixed] {
        &self.points[..self.len]
    }

    /// A convex polygon has at most one more corner after a cut; rounding cannot make it two.
    fn push(&mut self, point: Mixed) {
        if self.len < self.points.len() {
            self.points[self.len] = point;
            self.len += 1;
        }
    }

    /// Sutherland and Hodgman's step for one plane.
    fn cut(&self, plane: usize) -> Self {
        let mut kept = Self::default();
        for (i, &point) in self.points().iter().enumerate() {
            let next = self.points[(i + 1) % self.len];
            let (here, there) = (distances(point.clip)[plane], distances(next.clip)[plane]);
            if here >= 0.0 {
                kept.push(point);
            }
            if (here < 0.0) != (there < 0.0) {
                let share = here / (here - there);
                let weights = point.weights.lerp(next.weights, share);
                kept.push(Mixed { clip: point.clip.lerp(next.clip, share), weights });
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_inside_nothing_outside_and_a_quad_between() {
        let inside = [Vec4::new(0.0, 0.0, 0.5, 1.0), Vec4::new(0.5, 0.0, 0.5, 1.0), Vec4::new(0.0, 0.5, 0.5, 1.0)];
        assert_eq!(clip(inside).points().len(), 3);
        let behind = inside.map(|v| Vec4::new(v.x, v.y, -1.0, -0.5));
        assert!(clip(behind).points().is_empty());
        let quad = clip([inside[0], inside[1], behind[2]]);
        assert_eq!(quad.points().len(), 4);
        for point in quad.points() {
            assert!((point.weights.element_sum() - 1.0).abs() < 1e-6 && point.clip.z > -1e-6 && point.clip.w > 0.0);
        }
        assert!(clip([inside[0], inside[1], Vec4::NAN]).points().is_empty());
    }
}
