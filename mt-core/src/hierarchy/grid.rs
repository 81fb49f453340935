//! Positions on a grid: fewer digits, which files tell in fewer bytes.
//!
//! The step is a power of two and the grid goes through the origin, so a place on it is a whole number of steps without any
//! rounding, and comes back to the bit. What a story on a grid is a story of is its input *on the grid*: all laws hold of that,
//! and the law on ends says that the finest mesh is the input with every vertex moved by at most half a step along each axis.

use super::part::Story;
use crate::mesh::Mesh;
use glam::Vec3;

/// The step of a grid on which the longest side of the box around these is at most `2^bits` steps long. `None` for a mesh
/// without extent, and for one so far from the origin that 32 bits do not count the steps to it.
pub fn grid_step(positions: &[Vec3], bits: u32) -> Option<f32> {
    let (low, high) = Mesh::<3> { positions: positions.to_vec(), cells: Vec::new() }.bounding_box()?;
    let extent = (high.as_dvec3() - low.as_dvec3()).max_element();
    let step = (extent / f64::from(bits).exp2()).log2().ceil().exp2() as f32;
    let far = f64::from(low.abs().max(high.abs()).max_element()) / f64::from(step);
    (extent > 0.0 && step.is_normal() && far < f64::from(i32::MAX / 2)).then_some(step)
}

/// How many steps along each axis the place is that is nearest to `p`. Requires: no further than 32 bits count.
pub fn steps_to(p: Vec3, step: f32) -> [i32; 3] {
    (p.as_dvec3() / f64::from(step)).round().to_array().map(|count| count as i32)
}

/// The place so many steps from the origin.
pub fn place_at(steps: [i32; 3], step: f32) -> Vec3 {
    Vec3::from(steps.map(|count| (f64::from(count) * f64::from(step)) as f32))
}

impl Story {
    /// The same story with all vertices, merged ones too, at the nearest places of a grid. Requires: a step from
    /// [`grid_step`] of these vertices.
    pub fn on_grid(&self, step: f32) -> Self {
        let mut story = self.clone();
        let all = story.mesh.positions.iter_mut().chain(&mut story.sequence.positions);
        all.for_each(|p| *p = place_at(steps_to(*p, step), step));
        story
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn places_come_back_to_the_bit(p in prop::array::uniform3(-1e6f32..1e6), bits in 4u32..24, extent in 1e-3f32..1e6) {
            let p = Vec3::from(p);
            let Some(step) = grid_step(&[p, p + Vec3::X * extent], bits) else { return Ok(()) };
            prop_assert_eq!(step.log2().fract(), 0.0);
            let place = place_at(steps_to(p, step), step);
            prop_assert!(((place - p).abs().as_dvec3() * 2.0).max_element() <= f64::from(step));
            prop_assert_eq!(place_at(steps_to(place, step), step), place);
        }
    }

    #[test]
    fn a_grid_is_as_fine_as_asked() {
        let step = grid_step(&[Vec3::ZERO, Vec3::new(1.0, 3.0, 0.5)], 10).unwrap();
        assert_eq!(step, 1.0 / 256.0);
        assert_eq!(grid_step(&[Vec3::ONE; 3], 10), None);
        assert_eq!(grid_step(&[], 10), None);
        assert_eq!(grid_step(&[Vec3::splat(1e9), Vec3::splat(1e9) + Vec3::X * 64.0], 20), None);
    }
}
