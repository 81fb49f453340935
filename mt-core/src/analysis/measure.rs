//! Measured errors: the largest distance from the input vertices of a patch to its coarse side.
//!
//! Each input vertex is kept with the triangle of the current mesh that was nearest when its patch last changed, so a
//! modification looks only at the vertices of its own fine side. One-sided, and exact for the patch: a coarse triangle
//! elsewhere may be nearer, so the number is not below the distance to the whole mesh.

use super::Draft;
use crate::complex::Slot;
use crate::id::VertexId;
use crate::mesh::Mesh;
use crate::plan::Plan;
use glam::DVec3;

/// Which input vertices each slot answers for, as lists threaded through the vertices.
#[derive(Clone, Debug)]
pub(super) struct Measure {
    points: Vec<DVec3>,
    first: Vec<u32>,
    next: Vec<u32>,
    /// The vertices of the plan that was measured last, and which made cell is nearest to each.
    found: Vec<(u32, u32)>,
    killed: Vec<Slot>,
}

const NONE: u32 = u32::MAX;

impl Measure {
    pub(super) fn new<const N: usize>(mesh: &Mesh<N>) -> Self {
        let mut measure = Self {
            points: mesh.positions.iter().map(|p| p.as_dvec3()).collect(),
            first: vec![NONE; mesh.cells.len()],
            next: vec![NONE; mesh.positions.len()],
            found: Vec::new(),
            killed: Vec::new(),
        };
        let mut placed = vec![false; mesh.positions.len()];
        for (slot, cell) in mesh.cells.iter().enumerate() {
            for v in cell {
                if !std::mem::replace(&mut placed[v.index()], true) {
                    measure.give(v.0, slot as u32);
                }
            }
        }
        measure
    }

    fn give(&mut self, point: u32, slot: Slot) {
        self.next[point as usize] = self.first[slot as usize];
        self.first[slot as usize] = point;
    }

    /// The distance of the fine side's input vertices to the coarse side. A coarse side without cells has none to
    /// measure to, and its error is the extent of what it loses.
    pub(super) fn of_plan<const N: usize>(&mut self, draft: &Draft<N>, plan: &Plan<N>) -> f32 {
        self.found.clear();
        self.killed.clear();
        self.killed.extend_from_slice(&plan.kills);
        let position = |v: VertexId| match v.index().checked_sub(draft.positions.len()) {
            Some(new) => plan.vertices[new].as_dvec3(),
            None => draft.positions[v.index()].as_dvec3(),
        };
        if plan.makes.is_empty() {
            return self.extent(plan);
        }
        let mut worst: f64 = 0.0;
        for &slot in &plan.kills {
            let mut point = self.first[slot as usize];
            while point != NONE {
                let p = self.points[point as usize];
                let distances =
                    plan.makes.iter().map(|cell| distance_squared(p, [cell[0], cell[1], cell[2]].map(position)));
                let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).expect("there is a made cell");
                self.found.push((point, nearest.0 as u32));
                worst = worst.max(nearest.1);
                point = self.next[point as usize];
            }
        }
        (worst.sqrt() as f32).next_up()
    }

    /// The diagonal of the box around the points of the fine side.
    fn extent<const N: usize>(&self, plan: &Plan<N>) -> f32 {
        let lists = plan.kills.iter().map(|&slot| self.first[slot as usize]);
        let points = lists.flat_map(|first| {
            let present = |point: u32| (point != NONE).then_some(point);
            std::iter::successors(present(first), move |&point| present(self.next[point as usize]))
        });
        let points = points.map(|point| self.points[point as usize]);
        let (low, high) =
            points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        if low.x <= high.x { (low.distance(high) as f32).next_up() } else { 0.0 }
    }

    /// Hears that the plan measured last was applied, and where its cells went.
    pub(super) fn applied(&mut self, slots: &[Slot]) {
        let top = slots.iter().map(|&s| s as usize + 1).max().unwrap_or(0);
        self.first.resize(self.first.len().max(top), NONE);
        for slot in std::mem::take(&mut self.killed) {
            self.first[slot as usize] = NONE;
        }
        for (point, made) in std::mem::take(&mut self.found) {
            if let Some(&slot) = slots.get(made as usize) {
                self.give(point, slot);
            }
        }
    }
}

/// Squared distance from a point to a triangle.
pub(crate) fn distance_squared(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let segment = |a: DVec3, b: DVec3| {
        let along = b - a;
        let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // A segment without length gives 0 / 0; its one point is the nearest.
        p.distance_squared(if t.is_nan() { a } else { a + along * t })
    };
    let normal = (b - a).cross(c - a);
    let inside = |a: DVec3, b: DVec3| normal.cross(b - a).dot(p - a) >= 0.0;
    if normal != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
        let height = (p - a).dot(normal);
        return height * height / normal.length_squared();
    }
    segment(a, b).min(segment(b, c)).min(segment(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::generate;
    use crate::id::VertexId;
    use crate::random::Random;

    #[test]
    fn a_point_is_as_far_as_the_nearest_of_many_points_of_the_triangle() {
        let mut random = Random::new(11);
        let mut point = || DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        for _ in 0..200 {
            let (p, [a, b, c]) = (point(), [point(), point(), point()]);
            let exact = distance_squared(p, [a, b, c]).sqrt();
            let mut near = f64::INFINITY;
            for i in 0..=100 {
                for k in 0..=100 - i {
                    let (u, v) = (f64::from(i) / 100.0, f64::from(k) / 100.0);
                    near = near.min(p.distance(a + (b - a) * u + (c - a) * v));
                }
            }
            assert!(exact <= near + 1e-12 && near <= exact + 0.05, "{exact} and {near}");
        }
        // Without area, and without length.
        assert_eq!(distance_squared(DVec3::Y * 2.0, [DVec3::ZERO, DVec3::X, DVec3::X * 3.0]), 4.0);
        assert_eq!(distance_squared(DVec3::Y * 2.0, [DVec3::ZERO; 3]), 4.0);
    }

    #[test]
    fn points_go_with_the_cells_that_are_nearest() {
        // A fan of four around a raised vertex becomes two flat triangles; then these become one, which has lost a corner.
        let mesh = Mesh::from_indices(
            [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.5]]
                .map(glam::Vec3::from)
                .to_vec(),
            &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        );
        let mut draft = Draft::new(&mesh);
        let mut measure = Measure::new(&mesh);
        let ids = |cell: [u32; 3]| cell.map(VertexId);
        let mut slots = Vec::new();
        let first = Plan {
            kills: vec![0, 1, 2, 3],
            makes: vec![ids([0, 1, 2]), ids([0, 2, 3])],
            retired: vec![VertexId(4)],
            ..Plan::default()
        };
        let error = measure.of_plan(&draft, &first);
        assert!((0.5..0.500_001).contains(&error), "{error}");
        draft.apply(&first, &mut slots);
        measure.applied(&slots);
        let second =
            Plan { kills: vec![0, 1], makes: vec![ids([0, 1, 2])], retired: vec![VertexId(3)], ..Plan::default() };
        let error = measure.of_plan(&draft, &second);
        assert!((2f32.sqrt()..2f32.sqrt() + 1e-6).contains(&error), "{error}");
        draft.apply(&second, &mut slots);
        measure.applied(&slots);
        // What goes altogether is as wrong as it was large: the raised vertex is still answered for.
        let third = Plan { kills: vec![0], ..Plan::<3>::default() };
        let error = measure.of_plan(&draft, &third);
        let extent = (4.0f32 + 4.0 + 0.25).sqrt();
        assert!((extent..extent + 1e-6).contains(&error), "{error}");
    }

    #[test]
    fn a_tetrahedron_lost_is_measured_by_its_extent() {
        let mesh = generate::tetrahedron();
        let mut measure = Measure::new(&mesh);
        let gone = Plan { kills: vec![0, 1, 2, 3], ..Plan::default() };
        assert!((f64::from(measure.of_plan(&Draft::new(&mesh), &gone)) - mesh.diagonal()).abs() < 1e-6);
    }

    #[test]
    fn cells_in_new_slots_answer_for_points_too() {
        let ids = |cell: [u32; 3]| cell.map(VertexId);
        let mesh = generate::triangle();
        let (mut draft, mut measure, mut slots) = (Draft::new(&mesh), Measure::new(&mesh), Vec::new());
        let middle = (mesh.positions[0] + mesh.positions[1] + mesh.positions[2]) / 3.0;
        let parted = Plan {
            kills: vec![0],
            makes: vec![ids([0, 1, 3]), ids([1, 2, 3]), ids([2, 0, 3])],
            vertices: vec![middle],
            ..Plan::default()
        };
        assert!(measure.of_plan(&draft, &parted) < 1e-6);
        draft.apply(&parted, &mut slots);
        assert_eq!(slots, [0, 1, 2]);
        measure.applied(&slots);
        // All three corners are still answered for, whichever slots they went to.
        let gone = Plan { kills: slots.clone(), ..Plan::<3>::default() };
        assert!((f64::from(measure.of_plan(&draft, &gone)) - mesh.diagonal()).abs() < 1e-6);
    }
}
