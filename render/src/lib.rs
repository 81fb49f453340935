//! Headless pictures of triangle meshes: one plain encoding, and two painters that draw the same.
//!
//! ```text
//! mesh ─ encode ─▶ Scene (corners, segments) ─┬─▶ gpu.rs + shade.wgsl ─┬─▶ Picture ─▶ PNG bytes
//!                       camera ─▶ Globals, Ink ┴─▶ cpu.rs, raster.rs   ─┘
//! ```
//!
//! A [`Scene`] is data; nothing is drawn before [`paint`]. Both painters take four samples a pixel at the
//! same places, shade each pixel once at its middle and light it from the same globals, so their
//! pictures differ by rounding only. No file is opened here and nothing global is set.
//!
//! The rooms, in the order in which a picture passes through them:
//!
//! | room | what is there |
//! |---|---|
//! | `scene`, `ramp` | the encoding: corners and segments, what is shown of a mesh and in which colours |
//! | `frustum`, `edges`, `pieces` | what else is shown: the camera from outside, edges that say something, dual pieces |
//! | `globals`, `ink`, `font` | what both painters are given alike: projection and light, lines and legends as triangles |
//! | `clip`, `raster`, `cpu` | the CPU painter: clip, cover samples, shade |
//! | `gpu`, `shade.wgsl` | the GPU painter, with the feature `gpu` (a default) |
//! | `animation` | pictures one after the other as one file |
//! | `finish` | finer pictures, and pictures on no ground |
//! | `drawing` | vector drawings with hidden lines removed, as SVG and PDF |
//! | `inspect`, `tint` | what triangles have to do with nodes, and what their colours tell of it |
//! | `live`, `stage` | a mesh that changes, and its triangles on the device, which hear of changes alone |
//! | `easel`, `picture` | which painter it is, and what may go wrong; the pixels, and PNG |
//!
//! ```
//! use mt_core::{Camera, Mesh};
//! use mt_render::{Look, Prefer, encode, paint};
//!
//! let mesh = Mesh::from_indices(vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y], &[[0, 1, 2]]);
//! let (low, high) = mesh.bounding_box().unwrap();
//! let camera = Camera::around(low, high, glam::Vec3::Z);
//! let scene = encode(&mesh, &Look { wireframe: true, ..Look::default() });
//! let (picture, painter) = paint(&scene, &camera, Prefer::Cpu)?;
//! assert_eq!((picture.width, painter.to_string().as_str()), (1024, "the CPU painter"));
//! let _file: Vec<u8> = picture.to_png();
//! # Ok::<(), mt_render::RenderError>(())
//! ```

mod animation;
mod clip;
mod cpu;
mod drawing;
mod easel;
mod edges;
mod finish;
mod font;
mod frustum;
mod globals;
#[cfg(feature = "gpu")]
mod gpu;
mod ink;
mod inspect;
mod live;
mod picture;
mod pieces;
mod ramp;
mod raster;
mod scene;
#[cfg(feature = "gpu")]
mod stage;
mod tint;

pub use animation::Animation;
pub use drawing::{Drawing, Line};
pub use easel::{Easel, Painter, Prefer, RenderError, paint};
pub use edges::Edges;
pub use finish::Finish;
pub use frustum::outside;
pub use inspect::{ExplicitIndex, Fan, Index, Inspect};
pub use live::{LiveMesh, Placed, Places};
pub use picture::Picture;
pub use pieces::dual_pieces;
pub use ramp::{Ramp, Rgba};
pub use scene::{Corner, Legend, Look, Overlay, Scene, Segment, WIRE, encode};
#[cfg(feature = "gpu")]
pub use stage::{Stage, Uploaded};
pub use tint::{Seen, Tint, Tinting, by_fans};
/// The crate whose devices a [`Stage`] works on.
#[cfg(feature = "gpu")]
pub use wgpu;
