//! A view on the device: the triangles of a [`crate::LiveMesh`] in one vertex buffer that is kept from frame to frame and told
//! of changes alone, and pictures of it, read back or left on the device for a window to show.

use crate::easel::RenderError;
use crate::gpu::{Buffers, Canvas, Gpu};
use crate::live::Places;
use crate::picture::Picture;
use crate::scene::{Corner, Scene};
use mt_core::Camera;
use std::ops::Range;

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

/// A device with the triangles of one view, which may be looked at by several cameras.
pub struct Stage {
    gpu: Gpu,
    buffer: Option<wgpu::Buffer>,
    /// Places that the buffer has room for, and those that are drawn.
    room: u64,
    places: u32,
    /// What is shown instead of the view, while it is.
    instead: Option<Buffers>,
    /// One for each camera that looks.
    canvases: Vec<Option<Canvas>>,
}

impl Stage {
    /// Looks for a device: some 100 ms. Errors with [`RenderError::NoGpu`] where there is none.
    pub fn new() -> Result<Self, RenderError> {
        Ok(Self::with(Gpu::open()?))
    }

    /// On a device that is there already, as a window has one; it should have been made by [`Stage::device_descriptor`].
    pub fn on(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, RenderError> {
        Ok(Self::with(Gpu::on(&adapter.get_info(), device, queue)?))
    }

    /// Another view on the same device.
    pub fn beside(&self) -> Self {
        Self::with(self.gpu.clone())
    }

    /// What device a stage asks an adapter for.
    pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        Gpu::device_descriptor(adapter)
    }

    fn with(gpu: Gpu) -> Self {
        Self { gpu, buffer: None, room: 0, places: 0, instead: None, canvases: Vec::new() }
    }

    /// The adapter's name and interface.
    pub fn adapter(&self) -> &str {
        &self.gpu.adapter
    }

    /// Sends what changed. O(changes), but where the buffer has to grow, by a half: O(mesh). After an error all is sent anew.
    ///
    /// Call it with one view always: changes are told once.
    pub fn update(&mut self, view: &mut Places) -> Result<Uploaded, RenderError> {
        let changes = view.take_changes();
        let sent = self.send(view, &changes);
        match sent {
            Ok(_) => self.places = view.place_count(),
            Err(_) => (self.buffer, self.room, self.places) = (None, 0, 0),
        }
        sent
    }

    fn send(&mut self, view: &Places, changes: &[Range<u32>]) -> Result<Uploaded, RenderError> {
        let corners: &[u8] = bytemuck::cast_slice(view.corners());
        let places = u64::from(view.place_count());
        let grown = places > self.room;
        if grown {
            let room = places * 3 / 2 + 1024;
            (self.buffer, self.room) = (Some(self.gpu.vertex_buffer(room * TRIANGLE)?), room);
        }
        let Some(buffer) = &self.buffer else { return Ok(Uploaded::default()) };
        let all = std::slice::from_ref(&(0..view.place_count())).to_vec();
        let ranges = if grown { &all } else { changes };
        let mut bytes = 0;
        self.gpu.guarded(|queue| {
            for range in ranges {
                let (from, to) = (u64::from(range.start) * TRIANGLE, u64::from(range.end) * TRIANGLE);
                queue.write_buffer(buffer, from, &corners[from as usize..to as usize]);
                bytes += to - from;
            }
        })?;
        Ok(Uploaded { bytes, pieces: ranges.len() as u32, grown })
    }

    /// Forgets the view, so that the next [`Stage::update`] sends all of another.
    pub fn clear(&mut self) {
        (self.buffer, self.room, self.places, self.instead) = (None, 0, 0, None);
    }

    /// Shows these triangles instead of the view, until [`Stage::show_view`]. They are sent once.
    pub fn show_instead(&mut self, corners: &[Corner]) -> Result<(), RenderError> {
        self.instead = Some(self.gpu.upload_guarded(corners)?);
        Ok(())
    }

    /// Shows the view again.
    pub fn show_view(&mut self) {
        self.instead = None;
    }

    /// Paints what was sent as `camera` sees it, with the lines, colours and ground of `scene`, whose own triangles are left
    /// out; its origin has to be that of the view.
    pub fn paint(&mut self, scene: &Scene, camera: &Camera) -> Result<Picture, RenderError> {
        let gpu = self.gpu.clone();
        gpu.read(self.draw(scene, camera, 0)?)
    }

    /// The same, left on the device: a texture of the camera's size, for one of several cameras that look at the view. It is
    /// the same texture from frame to frame, until that camera's size changes.
    pub fn show(&mut self, scene: &Scene, camera: &Camera, which: usize) -> Result<&wgpu::Texture, RenderError> {
        self.draw(scene, camera, which).map(Canvas::texture)
    }

    fn draw(&mut self, scene: &Scene, camera: &Camera, which: usize) -> Result<&Canvas, RenderError> {
        camera.check()?;
        if self.canvases.len() <= which {
            self.canvases.resize_with(which + 1, || None);
        }
        let size = [camera.width_px, camera.height_px];
        let kept = self.canvases[which].take().filter(|canvas| canvas.size() == size);
        let canvas = kept.map_or_else(|| self.gpu.new_canvas(camera), Ok)?;
        let own = || self.buffer.iter().map(|buffer| (buffer.clone(), 3 * self.places)).collect();
        let buffers = self.instead.clone().unwrap_or_else(own);
        self.gpu.draw_buffers(scene, camera, &canvas, buffers)?;
        Ok(self.canvases[which].insert(canvas))
    }
}
