//! A point from up to three planes through it, taken in order of importance (`[LindstromTurk1998]`, section 3.1).

use glam::{DMat3, DVec3};

/// Planes that are less than this apart in direction do not pin a point down: the cosine of 1 degree, squared, and the
/// sine. The paper's angle.
const COSINE_SQUARED: f64 = 0.999_695_413_509_547_9;
const SINE_SQUARED: f64 = 1.0 - COSINE_SQUARED;

/// Equations `row . x = value`, at most three, each of unit length and far enough from the span of those before it.
#[derive(Copy, Clone, Debug, Default)]
pub(super) struct Constraints {
    rows: [DVec3; 3],
    values: [f64; 3],
    count: usize,
}

impl Constraints {
    /// Takes an equation, unless it is no news or its row is not longer than `least`, below which it is noise.
    pub(super) fn add(&mut self, row: DVec3, value: f64, least: f64) {
        let length = row.length();
        if length <= least || !length.is_finite() {
            return;
        }
        let row = row / length;
        let [a, b, _] = self.rows;
        let news = match self.count {
            0 => true,
            1 => a.dot(row).powi(2) < COSINE_SQUARED,
            2 => a.cross(b).dot(row).powi(2) > a.cross(b).length_squared() * SINE_SQUARED,
            _ => false,
        };
        if news {
            self.rows[self.count] = row;
            self.values[self.count] = value / length;
            self.count += 1;
        }
    }

    /// Among the points that are left, those where `x A x + 2 b x` is least: as many equations as there is freedom for.
    /// What bends less than `share` of the trace of `A` pins nothing down.
    pub(super) fn minimise(&mut self, matrix: DMat3, linear: DVec3, share: f64) {
        let least = share * (matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z);
        let [a, b, _] = self.rows;
        let (free, freedom) = match self.count {
            0 => ([DVec3::X, DVec3::Y, DVec3::Z], 3),
            1 => {
                let (u, v) = a.any_orthonormal_pair();
                ([u, v, DVec3::ZERO], 2)
            }
            2 => ([a.cross(b).normalize_or_zero(), DVec3::ZERO, DVec3::ZERO], 1),
            _ => return,
        };
        for direction in &free[..freedom] {
            self.add(matrix * *direction, -linear.dot(*direction), least);
        }
    }

    /// The point, if three equations pin it down.
    pub(super) fn solve(&self) -> Option<DVec3> {
        let [a, b, c] = self.rows;
        let determinant = a.dot(b.cross(c));
        let [u, v, w] = self.values;
        (self.count == 3 && determinant != 0.0)
            .then(|| (b.cross(c) * u + c.cross(a) * v + a.cross(b) * w) / determinant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1f64..1.0).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn three_planes_meet_in_their_point(rows in prop::array::uniform3(vector()), point in vector()) {
            let mut constraints = Constraints::default();
            rows.iter().for_each(|row| constraints.add(*row, row.dot(point), 1e-3));
            if let Some(found) = constraints.solve() {
                prop_assert!(found.distance(point) < 1e-6);
            }
            // The rest of the freedom goes to the point nearest to one.
            constraints.minimise(DMat3::IDENTITY, -point, 0.0);
            prop_assert!(constraints.solve().expect("the nearest point is always one").distance(point) < 1e-6);
        }

        #[test]
        fn the_least_point_of_a_plane_is_found(row in vector(), value in -1f64..1.0, centre in vector(), other in vector()) {
            prop_assume!(row.length() > 0.1);
            let mut constraints = Constraints::default();
            constraints.add(row, value, 0.0);
            constraints.minimise(DMat3::IDENTITY, -centre, 0.0);
            let best = constraints.solve().expect("a paraboloid has a least point");
            prop_assert!((best.dot(row) - value).abs() < 1e-9);
            let on_plane = other - row * ((other.dot(row) - value) / row.length_squared());
            prop_assert!(best.distance(centre) <= on_plane.distance(centre) + 1e-9);
        }
    }

    #[test]
    fn no_news_is_not_taken() {
        let mut constraints = Constraints::default();
        constraints.add(DVec3::X, 1.0, 0.0);
        constraints.add(DVec3::new(1.0, 1e-3, 0.0), 5.0, 0.0);
        constraints.add(DVec3::Y, 2.0, 0.0);
        constraints.add(DVec3::new(1.0, 1.0, 1e-3), 5.0, 0.0);
        constraints.add(DVec3::ZERO, 5.0, 0.0);
        assert_eq!(constraints.solve(), None);
        constraints.add(DVec3::Z * 2.0, 6.0, 0.0);
        assert_eq!(constraints.solve(), Some(DVec3::new(1.0, 2.0, 3.0)));
    }
}
