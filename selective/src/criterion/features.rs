//! Feature points: where the surface has to stay fine whatever its error.

use crate::criterion::{Criterion, Relax};
use glam::Vec3;
use mt_core::Bound;
use std::sync::Arc;

/// Points in space, arranged so that spheres are quickly found to hold one: a k-d tree without pointers, whose nodes are
/// the middles of ranges and split by x, y and z in turn. 12 bytes a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointIndex {
    points: Vec<Vec3>,
}

/// More ranges than ever wait at once: one a level, and ranges halve.
const WAITING_MAX: usize = 40;

impl PointIndex {
    /// Arranges points; those that are not finite are left out. O(n log n).
    pub fn new(points: impl IntoIterator<Item = Vec3>) -> Self {
        let mut points: Vec<Vec3> = points.into_iter().filter(|p| p.is_finite()).collect();
        let mut open = vec![(0, points.len(), 0)];
        while let Some((low, high, axis)) = open.pop() {
            if high - low > 1 {
                let middle = low + (high - low) / 2;
                points[low..high].select_nth_unstable_by(middle - low, |a, b| a[axis].total_cmp(&b[axis]));
                open.extend([(low, middle, (axis + 1) % 3), (middle + 1, high, (axis + 1) % 3)]);
            }
        }
        Self { points }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Whether a point lies within a sphere. About O(log n), unless the sphere is large and empty.
    pub fn any_within(&self, center: Vec3, radius: f32) -> bool {
        let radius = f64::from(radius);
        let mut open = [(0, self.points.len(), 0); WAITING_MAX];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (low, high, axis) = open[waiting];
            if low >= high {
                continue;
            }
            let middle = low + (high - low) / 2;
            let point = self.points[middle];
            if point.as_dvec3().distance(center.as_dvec3()) <= radius {
                return true;
            }
            let (beyond, next) = (f64::from(center[axis]) - f64::from(point[axis]), (axis + 1) % 3);
            // Each side in turn, unless the sphere lies wholly on the other.
            for (range, reaches) in [((low, middle), beyond <= radius), ((middle + 1, high), beyond >= -radius)] {
                if reaches {
                    open[waiting] = (range.0, range.1, next);
                    waiting += 1;
                }
            }
        }
        false
    }
}

/// An error everywhere, and a smaller one where the bound's sphere holds a feature point.
///
/// The sphere holds all that is discovered under a node, so it asks along the way to every feature.
#[derive(Clone, Debug)]
pub struct FeaturePoints {
    /// The points.
    pub points: Arc<PointIndex>,
    /// Largest error allowed where they are, in model units. Below 0 asks for everything there.
    pub error_at: f32,
    /// Largest error allowed elsewhere, in model units; not below `error_at`.
    pub error_max: f32,
}

impl FeaturePoints {
    /// With the features that a predicate picks among vertices.
    pub fn pick(positions: &[Vec3], is_feature: impl Fn(usize) -> bool, error_at: f32, error_max: f32) -> Self {
        let picked = positions.iter().enumerate().filter(|&(i, _)| is_feature(i)).map(|(_, &p)| p);
        Self { points: Arc::new(PointIndex::new(picked)), error_at, error_max }
    }
}

impl Criterion<Bound> for FeaturePoints {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        let (strict, lax) = (bound.error - self.error_at, bound.error - self.error_max);
        // The search is for those whose fate it decides.
        let decides = strict > lax && strict > 0.0;
        if decides && self.points.any_within(bound.center, bound.radius) { strict } else { lax }
    }
}

impl Relax for FeaturePoints {
    fn relax(&mut self, by: f32) {
        self.error_at *= by;
        self.error_max *= by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::tests::{ball, point};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_index_finds_what_a_search_of_all_points_finds(
            points in prop::collection::vec(point(), 0..60), center in point(), radius in 0f32..12.0,
        ) {
            let index = PointIndex::new(points.iter().copied());
            let near = |p: &Vec3| p.as_dvec3().distance(center.as_dvec3()) <= f64::from(radius);
            prop_assert_eq!(index.any_within(center, radius), points.iter().any(near));
        }
    }

    #[test]
    fn many_equal_points_are_no_trouble() {
        let index = PointIndex::new(vec![Vec3::ONE; 5000]);
        assert!(index.any_within(Vec3::ONE, 0.0) && !index.any_within(Vec3::X, 1.0));
        assert!(index.any_within(Vec3::X, 1.5) && !PointIndex::new([Vec3::NAN]).any_within(Vec3::ZERO, 9.0));
    }

    #[test]
    fn features_stay_fine() {
        let points = [Vec3::ZERO, Vec3::X * 10.0];
        let criterion = FeaturePoints::pick(&points, |i| i == 1, 0.01, 1.0);
        assert_eq!(criterion.points.len(), 1);
        assert!(criterion.asks(&ball(Vec3::X * 9.5, 1.0, 0.1), false));
        assert!(
            !criterion.asks(&ball(Vec3::ZERO, 1.0, 0.1), false) && criterion.asks(&ball(Vec3::ZERO, 1.0, 2.0), false)
        );
    }
}
