//! Pictures of the ledger: drawn by the CPU painter, so that they are the same on every machine.

use super::{Figure, LedgerError};
use glam::Vec3;
use mt_core::{Camera, Mesh};
use render::{Easel, Picture, Prefer, Scene};

/// Width and height of pictures.
const SIZE: (u32, u32) = (800, 600);

/// Paints scenes as figures.
pub(crate) struct Brush(Easel);

impl Brush {
    pub(crate) fn new() -> Result<Self, LedgerError> {
        let easel = Easel::new(Prefer::Cpu).map_err(|error| LedgerError::Picture("of the ledger".into(), error))?;
        Ok(Self(easel))
    }

    /// A scene as a camera sees it.
    pub(crate) fn paint(
        &self,
        name: &str,
        caption: &str,
        scene: &Scene,
        camera: &Camera,
    ) -> Result<Figure, LedgerError> {
        let bytes = self.picture(name, scene, camera)?.to_png();
        Ok(Figure { name: name.to_owned(), caption: caption.to_owned(), bytes })
    }

    /// The same by its pixels.
    pub(crate) fn picture(&self, name: &str, scene: &Scene, camera: &Camera) -> Result<Picture, LedgerError> {
        let camera = Camera { width_px: SIZE.0, height_px: SIZE.1, ..*camera };
        let painted = self.0.paint(scene, &camera);
        painted.map(|(picture, _)| picture).map_err(|error| LedgerError::Picture(name.to_owned(), error))
    }
}

/// A camera around a mesh that fills the picture.
pub(crate) fn close_up(mesh: &Mesh<3>, from: Vec3, up: Vec3) -> Camera {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let camera = Camera::around(low, high, from);
    Camera { fov_y_degrees: camera.fov_y_degrees * 0.72, up, ..camera }
}

/// A share as a percentage of one digit.
pub(crate) fn share(part: f64, whole: f64) -> String {
    if whole > 0.0 { format!("{:.1} %", 100.0 * part / whole) } else { String::new() }
}
