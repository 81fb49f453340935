//! The GPU painter: wgpu without a window. Every call is made inside error scopes, so that whatever the
//! device refuses comes back as an error.

use crate::easel::RenderError;
use crate::globals::Globals;
use crate::ink::{Ink, InkCorner};
use crate::picture::Picture;
use crate::raster::SAMPLES;
use crate::scene::{Corner, Scene};
use bytemuck::Pod;
use mt_core::Camera;

const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Bytes of all samples beyond which a picture is left to the CPU, which paints in bands.
const SAMPLES_MAX: u64 = 2 << 30;
/// Bytes of one vertex buffer; larger meshes are drawn in chunks.
const CHUNK: u64 = 64 << 20;

/// A device with its two pipelines. A copy is another handle on the same device.
#[derive(Clone)]
pub(crate) struct Gpu {
    pub(crate) adapter: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    mesh: wgpu::RenderPipeline,
    ink: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

/// Where a picture is painted, resolved and read back.
pub(crate) struct Canvas {
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::Texture,
    size: wgpu::Extent3d,
}

impl Canvas {
    /// Pixels in a row, and rows.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.size.width, self.size.height]
    }

    /// What is painted, one sample a pixel.
    pub(crate) fn texture(&self) -> &wgpu::Texture {
        &self.resolved
    }
}

/// Vertices on the device, and how many.
pub(crate) type Buffers = Vec<(wgpu::Buffer, u32)>;

impl Gpu {
    /// The first adapter that offers itself, hardware before software.
    pub(crate) fn open() -> Result<Self, RenderError> {
        let adapter = adapter()?;
        let (device, queue) =
            pollster::block_on(adapter.request_device(&Self::device_descriptor(&adapter))).map_err(no_gpu)?;
        Self::on(&adapter.get_info(), device, queue)
    }

    /// The device that is asked for: buffers and pictures as large as the adapter takes.
    pub(crate) fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        let offered = adapter.limits();
        let limits = wgpu::Limits {
            max_buffer_size: offered.max_buffer_size,
            ..wgpu::Limits::downlevel_defaults().using_resolution(offered)
        };
        wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() }
    }

    /// The pipelines on a device that is there.
    pub(crate) fn on(info: &wgpu::AdapterInfo, device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, RenderError> {
        let (mesh, ink, layout) = guarded(&device, || Ok(pipelines(&device)))?;
        Ok(Self { adapter: format!("{} ({})", info.name, info.backend), device, queue, mesh, ink, layout })
    }

    /// Paints and waits for the picture.
    pub(crate) fn paint(&self, scene: &Scene, camera: &Camera) -> Result<Picture, RenderError> {
        let canvas = self.new_canvas(camera)?;
        let triangles = self.upload_guarded(&scene.corners)?;
        self.draw_buffers(scene, camera, &canvas, triangles)?;
        self.read(&canvas)
    }

    /// Triangles on the device.
    pub(crate) fn upload_guarded(&self, corners: &[Corner]) -> Result<Buffers, RenderError> {
        guarded(&self.device, || Ok(self.upload(corners)))
    }

    /// Paints triangles that are on the device already, and leaves the picture there.
    pub(crate) fn draw_buffers(
        &self,
        scene: &Scene,
        camera: &Camera,
        canvas: &Canvas,
        triangles: Buffers,
    ) -> Result<(), RenderError> {
        guarded(&self.device, || {
            self.draw(scene, camera, canvas, triangles);
            Ok(())
        })
    }

    /// A canvas of a camera's size, where the device has room for it.
    pub(crate) fn new_canvas(&self, camera: &Camera) -> Result<Canvas, RenderError> {
        self.check_size(camera)?;
        guarded(&self.device, || Ok(self.canvas(camera)))
    }

    /// An empty buffer for vertices, that can be written to.
    pub(crate) fn vertex_buffer(&self, size: u64) -> Result<wgpu::Buffer, RenderError> {
        let limit = self.device.limits().max_buffer_size;
        if size > limit {
            return Err(RenderError::TooLarge { what: "the triangles of a view, in bytes,", size, limit });
        }
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        guarded(&self.device, || Ok(self.device.create_buffer(&descriptor)))
    }

    /// Does work with the queue; what the device refuses comes back as an error.
    pub(crate) fn guarded(&self, work: impl FnOnce(&wgpu::Queue)) -> Result<(), RenderError> {
        guarded(&self.device, || {
            work(&self.queue);
            Ok(())
        })
    }

    fn check_size(&self, camera: &Camera) -> Result<(), RenderError> {
        let (width, height) = (u64::from(camera.width_px), u64::from(camera.height_px));
        let limits = self.device.limits();
        let within = |what, size, limit| {
            if size <= limit { Ok(()) } else { Err(RenderError::TooLarge { what, size, limit }) }
        };
        within("a side of the picture, in pixels,", width.max(height), u64::from(limits.max_texture_dimension_2d))?;
        within(
            "the picture read back, in bytes,",
            u64::from(padded_row(camera.width_px)) * height,
            limits.max_buffer_size,
        )?;
        within("the samples of the picture, in bytes,", width * height * 8 * SAMPLES as u64, SAMPLES_MAX)
    }

    fn canvas(&self, camera: &Camera) -> Canvas {
        let size = wgpu::Extent3d { width: camera.width_px, height: camera.height_px, depth_or_array_layers: 1 };
        let texture = |format, sample_count, usage| {
            self.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size,
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let target = wgpu::TextureUsages::RENDER_ATTACHMENT;
        Canvas {
            samples: texture(COLOUR, SAMPLES as u32, target).create_view(&Default::default()),
            depth: texture(DEPTH, SAMPLES as u32, target).create_view(&Default::default()),
            resolved: texture(COLOUR, 1, target | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING),
            size,
        }
    }

    fn draw(&self, scene: &Scene, camera: &Camera, canvas: &Canvas, triangles: Buffers) {
        let globals = Globals::new(scene, camera);
        let ink = Ink::new(scene, camera, &globals);
        let uniform = self.filled(bytemuck::bytes_of(&globals), wgpu::BufferUsages::UNIFORM);
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let layers = [
            (&self.ink, self.upload::<InkCorner>(&ink.under)),
            (&self.mesh, triangles),
            (&self.ink, self.upload::<InkCorner>(&ink.over)),
        ];
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.pass(&mut encoder, canvas, &group, &layers);
        self.queue.submit([encoder.finish()]);
    }

    /// A buffer with these bytes. (wgpu's own way to make one panics on a device that was lost.)
    fn filled(&self, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let (size, usage) = (bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
        let buffer =
            self.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// The picture in a buffer that can be read, and the bytes of a row there.
    fn copy(&self, canvas: &Canvas) -> (wgpu::Buffer, u32) {
        let row = padded_row(canvas.size.width);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row) * u64::from(canvas.size.height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            canvas.resolved.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            canvas.size,
        );
        self.queue.submit([encoder.finish()]);
        (buffer, row)
    }

    /// Vertices as buffers within the device's limits, cut between triangles, with the count in each.
    fn upload<T: Pod>(&self, corners: &[T]) -> Buffers {
        let most = self.device.limits().max_buffer_size.min(CHUNK) as usize / size_of::<T>() / 3 * 3;
        let buffer =
            |chunk: &[T]| (self.filled(bytemuck::cast_slice(chunk), wgpu::BufferUsages::VERTEX), chunk.len() as u32);
        corners.chunks(most.max(3)).map(buffer).collect()
    }

    fn pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        canvas: &Canvas,
        group: &wgpu::BindGroup,
        layers: &[(&wgpu::RenderPipeline, Buffers)],
    ) {
        let resolved = canvas.resolved.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &canvas.samples,
                depth_slice: None,
                resolve_target: Some(&resolved),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Discard },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &canvas.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, group, &[]);
        for (pipeline, buffers) in layers {
            pass.set_pipeline(pipeline);
            for (buffer, count) in buffers {
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(0..*count, 0..1);
            }
        }
    }

    /// Waits for the picture and drops the padding of its rows.
    pub(crate) fn read(&self, canvas: &Canvas) -> Result<Picture, RenderError> {
        let (buffer, padded) = guarded(&self.device, || Ok(self.copy(canvas)))?;
        let (tell, told) = std::sync::mpsc::channel();
        // The receiver is gone only if we gave up waiting, and then nobody asks.
        buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(tell.send(result)));
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(failed)?;
        told.recv().map_err(failed)?.map_err(failed)?;
        let mapped = buffer.get_mapped_range(..).map_err(failed)?;
        let (width, height) = (canvas.size.width, canvas.size.height);
        let row = 4 * width as usize;
        let mut rgba = Vec::with_capacity(row * height as usize);
        for padded in mapped.chunks_exact(padded as usize) {
            rgba.extend_from_slice(&padded[..row]);
        }
        Ok(Picture { width, height, rgba })
    }
}

/// Rows of copied textures start at multiples of 256 bytes.
fn padded_row(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Runs `work` and turns what the device reports meanwhile, which would panic otherwise, into an error.
fn guarded<T>(device: &wgpu::Device, work: impl FnOnce() -> Result<T, RenderError>) -> Result<T, RenderError> {
    let filters = [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal];
    let scopes = filters.map(|filter| device.push_error_scope(filter));
    let result = work();
    // Scopes nest, so the last one pushed goes first.
    let errors: Vec<_> = scopes.into_iter().rev().map(|scope| pollster::block_on(scope.pop())).collect();
    match errors.into_iter().flatten().next() {
        Some(error) => Err(failed(error)),
        None => result,
    }
}

fn no_gpu(error: impl std::error::Error) -> RenderError {
    RenderError::NoGpu(error.to_string())
}

fn failed(error: impl std::error::Error) -> RenderError {
    RenderError::Gpu(error.to_string())
}

/// The pipelines of mesh and ink, and the layout of the globals they share.
fn pipelines(device: &wgpu::Device) -> (wgpu::RenderPipeline, wgpu::RenderPipeline, wgpu::BindGroupLayout) {
    let module = device.create_shader_module(wgpu::include_wgsl!("shade.wgsl"));
    let globals = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&globals)],
        immediate_size: 0,
    });
    let mesh = Kind {
        entries: ["mesh_vertex", "mesh_fragment"],
        stride: size_of::<Corner>() as u64,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4],
        blend: None,
        writes_depth: true,
        compare: wgpu::CompareFunction::Greater,
    };
    let ink = Kind {
        entries: ["ink_vertex", "ink_fragment"],
        stride: size_of::<InkCorner>() as u64,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4],
        blend: Some(wgpu::BlendState::ALPHA_BLENDING),
        writes_depth: false,
        compare: wgpu::CompareFunction::GreaterEqual,
    };
    (mesh.pipeline(device, &module, &layout), ink.pipeline(device, &module, &layout), globals)
}

/// In what the two pipelines differ.
struct Kind<'a> {
    /// Vertex and fragment shader.
    entries: [&'a str; 2],
    stride: u64,
    attributes: &'a [wgpu::VertexAttribute],
    blend: Option<wgpu::BlendState>,
    writes_depth: bool,
    compare: wgpu::CompareFunction,
}

impl Kind<'_> {
    fn pipeline(
        &self,
        device: &wgpu::Device,
        module: &wgpu::ShaderModule,
        layout: &wgpu::PipelineLayout,
    ) -> wgpu::RenderPipeline {
        let [vertex, fragment] = self.entries;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: self.stride,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: self.attributes,
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(self.writes_depth),
                depth_compare: Some(self.compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: SAMPLES as u32, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: COLOUR,
                    blend: self.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// The first adapter of the modern backends, else of OpenGL, whose drivers talk on standard error as soon as they are
/// asked. `WGPU_BACKEND` overrides both.
fn adapter() -> Result<wgpu::Adapter, RenderError> {
    let wish =
        wgpu::RequestAdapterOptions { power_preference: wgpu::PowerPreference::HighPerformance, ..Default::default() };
    let wanted = wgpu::Backends::from_env();
    let ask = |backends: wgpu::Backends| {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        descriptor.backends = wanted.unwrap_or(backends);
        pollster::block_on(wgpu::Instance::new(descriptor).request_adapter(&wish))
    };
    ask(wgpu::Backends::PRIMARY).or_else(|_| ask(wgpu::Backends::all())).map_err(no_gpu)
}
