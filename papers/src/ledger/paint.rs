//! Pictures of the ledger: drawn by the CPU painter, so that they are the same on every machine.

use super::{Figure, LedgerError};
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::{Camera, Mesh, VertexId};
use render::{Corner, Easel, Picture, Prefer, Rgba, Scene, Segment};

/// Width and height of pictures.
const SIZE: (u32, u32) = (800, 600);
/// Where two dual pieces meet.
const BORDER: Rgba = [40, 40, 44, 255];

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

/// The dual pieces over an input mesh: around each vertex the part of its triangles that is nearer to it, in the colour of
/// `piece`, and lines of this width where two pieces meet. 6 times the triangles.
pub(crate) fn dual_pieces(mesh: &Mesh<3>, width_px: f32, piece: impl Fn(VertexId) -> VertexId) -> Scene {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let origin = (low + high) * 0.5;
    let mut scene = Scene { origin, ..Scene::default() };
    for cell in &mesh.cells {
        let at = cell.map(|v| mesh.positions[v.index()] - origin);
        let normal = area_vector(at.map(Vec3::as_dvec3)).normalize_or_zero().as_vec3().to_array();
        let middle = (at[0] + at[1] + at[2]) / 3.0;
        let pieces = cell.map(&piece);
        for i in 0..3 {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            let (after, before) = ((at[i] + at[next]) * 0.5, (at[i] + at[last]) * 0.5);
            let colour = colour_of(pieces[i]);
            for p in [at[i], after, middle, at[i], middle, before] {
                scene.corners.push(Corner { position: p.to_array(), normal, colour });
            }
            if pieces[i] != pieces[next] {
                let (from, to) = (after.to_array(), middle.to_array());
                scene.segments.push(Segment { from, to, colour: BORDER, width_px });
            }
        }
    }
    scene
}

/// A light colour that differs from one vertex to the next.
fn colour_of(v: VertexId) -> Rgba {
    let hash = (v.0 ^ (v.0 >> 7)).wrapping_mul(0x9e37_79b9);
    let channel = |shift: u32| 150 + ((hash >> shift) % 97) as u8;
    [channel(4), channel(12), channel(20), 255]
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
