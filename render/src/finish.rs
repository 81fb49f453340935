//! Pictures for papers: finer than the screen's, and on no ground.

use crate::easel::{Easel, Painter, RenderError};
use crate::picture::Picture;
use crate::scene::Scene;
use mt_core::Camera;

/// What is asked of a picture besides what it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finish {
    /// How many pixels along each side are averaged to one, 1 to 8.
    pub finer: u32,
    /// Whether the ground is transparent.
    pub transparent: bool,
}

impl Default for Finish {
    fn default() -> Self {
        Self { finer: 1, transparent: false }
    }
}

impl Easel {
    /// [`Easel::paint`] with a finish. A transparent ground takes two pictures, on black and on white: what differs between
    /// them is seen through. So the opacity of edges and of traces of hidden lines is right, whoever paints.
    pub fn paint_finished(
        &self,
        scene: &Scene,
        camera: &Camera,
        finish: Finish,
    ) -> Result<(Picture, Painter), RenderError> {
        let finer = finish.finer.clamp(1, 8);
        let camera = Camera {
            width_px: camera.width_px.saturating_mul(finer),
            height_px: camera.height_px.saturating_mul(finer),
            ..*camera
        };
        if !finish.transparent {
            let (picture, painter) = self.paint(scene, &camera)?;
            return Ok((averaged(&picture, finer), painter));
        }
        let on = |ground: u8| {
            let scene = Scene { background: [[ground, ground, ground, 255]; 2], ..scene.clone() };
            self.paint(&scene, &camera)
        };
        let ((black, painter), (white, _)) = (on(0)?, on(255)?);
        let black = averaged(&black, finer);
        let white = averaged(&white, finer);
        let pixels = black.rgba.chunks_exact(4).zip(white.rgba.chunks_exact(4));
        let rgba = pixels.flat_map(|(black, white)| seen_through(black, white)).collect();
        Ok((Picture { rgba, ..black }, painter))
    }
}

/// The colour and opacity that look like these on black and on white.
fn seen_through(black: &[u8], white: &[u8]) -> [u8; 4] {
    let through = (0..3).map(|i| white[i].saturating_sub(black[i])).max().unwrap_or(0);
    let opacity = 255 - through;
    let channel = |i: usize| (u32::from(black[i]) * 255).checked_div(u32::from(opacity)).unwrap_or(0).min(255) as u8;
    [channel(0), channel(1), channel(2), opacity]
}

/// Squares of pixels as one.
fn averaged(picture: &Picture, finer: u32) -> Picture {
    if finer == 1 {
        return picture.clone();
    }
    let (width, height) = (picture.width / finer, picture.height / finer);
    let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let mut sums = [0u32; 4];
            for (dx, dy) in (0..finer).flat_map(|dy| (0..finer).map(move |dx| (dx, dy))) {
                let pixel = picture.pixel(x * finer + dx, y * finer + dy);
                (0..4).for_each(|i| sums[i] += u32::from(pixel[i]));
            }
            rgba.extend(sums.map(|sum| ((sum + finer * finer / 2) / (finer * finer)) as u8));
        }
    }
    Picture { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Look, Prefer, encode};
    use glam::Vec3;
    use mt_core::Mesh;

    fn triangle() -> (Scene, Camera) {
        let mesh =
            Mesh::from_indices(vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::Y], &[[0, 1, 2]]);
        let (low, high) = mesh.bounding_box().unwrap();
        let camera = Camera { width_px: 64, height_px: 48, ..Camera::around(low, high, Vec3::Z) };
        (encode(&mesh, &Look::default()), camera)
    }

    #[test]
    fn the_ground_is_seen_through_and_the_triangle_is_not() {
        let (scene, camera) = triangle();
        let easel = Easel::new(Prefer::Cpu).unwrap();
        let plain = easel.paint(&scene, &camera).unwrap().0;
        for finer in [1, 3] {
            let (picture, _) = easel.paint_finished(&scene, &camera, Finish { finer, transparent: true }).unwrap();
            assert_eq!((picture.width, picture.height), (64, 48));
            assert_eq!(picture.pixel(0, 0)[3], 0);
            let middle = picture.pixel(32, 26);
            assert_eq!(middle[3], 255);
            assert!((0..3).all(|i| middle[i].abs_diff(plain.pixel(32, 26)[i]) <= 2));
            let soft = picture.rgba.chunks_exact(4).filter(|pixel| !matches!(pixel[3], 0 | 255)).count();
            assert!(soft > 20, "the border is soft: {soft}");
        }
    }

    #[test]
    fn no_finish_is_the_plain_picture() {
        let (scene, camera) = triangle();
        let easel = Easel::new(Prefer::Cpu).unwrap();
        assert_eq!(
            easel.paint_finished(&scene, &camera, Finish::default()).unwrap().0,
            easel.paint(&scene, &camera).unwrap().0
        );
    }
}
