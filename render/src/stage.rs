//! A view on the device: the triangles of a [`LiveMesh`] in one vertex buffer that is kept from frame to frame and told of
//! changes alone, and pictures of it.

use crate::easel::RenderError;
use crate::gpu::{Canvas, Gpu};
use crate::live::LiveMesh;
use crate::picture::Picture;
use crate::scene::{Corner, Scene};
use mt_core::Camera;

/// Bytes of a triangle in a vertex buffer.
const TRIANGLE: u64 = 3 * size_of::<Corner>() as u64;

/// What was sent to the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Uploaded {
    /// Bytes.
    pub bytes: u64,
    /// In so many pieces.
    pub pieces: u32,
    /// Whether the buffer was too small, so that all was sent.
    pub grown: bool,
}

/// A device with the triangles of one view.
pub struct Stage {
    gpu: Gpu,
    buffer: Option<wgpu::Buffer>,
    /// Places that the buffer has room for, and those that are drawn.
    room: u64,
    places: u32,
    canvas: Option<Canvas>,
}

impl Stage {
    /// Looks for a device: some 100 ms. Errors with [`RenderError::NoGpu`] where there is none.
    pub fn new() -> Result<Self, RenderError> {
        Ok(Self { gpu: Gpu::open()?, buffer: None, room: 0, places: 0, canvas: None })
    }

    /// The adapter's name and interface.
    pub fn adapter(&self) -> &str {
        &self.gpu.adapter
    }

    /// Sends what changed. O(changes), but where the buffer has to grow, by a half: O(mesh).
    ///
    /// Call it with one mesh always: changes are told once.
    pub fn update(&mut self, mesh: &mut LiveMesh<'_>) -> Result<Uploaded, RenderError> {
        let changes = mesh.take_changes();
        self.places = mesh.place_count();
        if u64::from(self.places) > self.room {
            return self.grow(mesh);
        }
        let Some(buffer) = &self.buffer else { return Ok(Uploaded::default()) };
        let corners: &[u8] = bytemuck::cast_slice(mesh.corners());
        let mut bytes = 0;
        self.gpu.guarded(|queue| {
            for range in &changes {
                let (from, to) = (u64::from(range.start) * TRIANGLE, u64::from(range.end) * TRIANGLE);
                queue.write_buffer(buffer, from, &corners[from as usize..to as usize]);
                bytes += to - from;
            }
        })?;
        Ok(Uploaded { bytes, pieces: changes.len() as u32, grown: false })
    }

    fn grow(&mut self, mesh: &LiveMesh<'_>) -> Result<Uploaded, RenderError> {
        let room = u64::from(self.places) * 3 / 2 + 1024;
        let buffer = self.gpu.vertex_buffer(room * TRIANGLE)?;
        let corners: &[u8] = bytemuck::cast_slice(mesh.corners());
        self.gpu.guarded(|queue| queue.write_buffer(&buffer, 0, corners))?;
        (self.buffer, self.room) = (Some(buffer), room);
        Ok(Uploaded { bytes: corners.len() as u64, pieces: 1, grown: true })
    }

    /// Paints what was sent as `camera` sees it, with the lines, colours and ground of `scene`, whose own triangles are left
    /// out; its origin has to be that of the mesh.
    pub fn paint(&mut self, scene: &Scene, camera: &Camera) -> Result<Picture, RenderError> {
        camera.check()?;
        let size = [camera.width_px, camera.height_px];
        let canvas = match self.canvas.take().filter(|canvas| canvas.size() == size) {
            Some(canvas) => canvas,
            None => self.gpu.new_canvas(camera)?,
        };
        let buffers: Vec<_> = self.buffer.iter().map(|buffer| (buffer.clone(), 3 * self.places)).collect();
        let picture = self.gpu.paint_buffers(scene, camera, &canvas, buffers);
        self.canvas = Some(canvas);
        picture
    }
}
