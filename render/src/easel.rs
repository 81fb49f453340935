//! Choosing a painter, and what may go wrong with it.

use crate::cpu;
#[cfg(feature = "gpu")]
use crate::gpu::Gpu;
use crate::picture::Picture;
use crate::scene::Scene;
use mt_core::Camera;
use mt_core::camera::CameraError;
use std::fmt;

/// Which painter is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Prefer {
    /// The GPU where one is found and takes the scene, else the CPU.
    #[default]
    Any,
    /// The GPU or an error.
    Gpu,
    /// The CPU.
    Cpu,
}

/// Which painter painted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Painter {
    /// wgpu, which may be a driver in software.
    Gpu {
        /// The adapter's name and interface.
        adapter: String,
    },
    /// Our own rasteriser.
    Cpu,
}

impl fmt::Display for Painter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Painter::Gpu { adapter } => write!(f, "the GPU painter on {adapter}"),
            Painter::Cpu => f.write_str("the CPU painter"),
        }
    }
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The camera cannot be looked through.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// There is no adapter, it gave no device, or the crate was built without the feature `gpu`.
    #[error("no GPU to paint with: {0}")]
    NoGpu(String),
    /// Something is larger than the device takes.
    #[error("{what} needs {size}, and the GPU takes {limit}")]
    TooLarge {
        /// What is too large, with its unit.
        what: &'static str,
        /// Its size.
        size: u64,
        /// The most the device takes.
        limit: u64,
    },
    /// The device refused a command, ran out of memory or was lost.
    #[error("the GPU failed: {0}")]
    Gpu(String),
}

/// A painter set up once for many pictures, which spares each the search for a device.
pub struct Easel {
    #[cfg(feature = "gpu")]
    gpu: Option<Gpu>,
    prefer: Prefer,
}

impl Easel {
    /// Looks for a device unless the CPU is preferred: some 100 ms.
    ///
    /// Errors with [`RenderError::NoGpu`] or [`RenderError::Gpu`] under [`Prefer::Gpu`] only.
    pub fn new(prefer: Prefer) -> Result<Self, RenderError> {
        #[cfg(feature = "gpu")]
        let gpu = match prefer {
            Prefer::Cpu => None,
            Prefer::Gpu => Some(Gpu::open()?),
            Prefer::Any => Gpu::open().ok(),
        };
        #[cfg(not(feature = "gpu"))]
        if prefer == Prefer::Gpu {
            return Err(RenderError::NoGpu("built without the feature `gpu`".into()));
        }
        Ok(Self {
            #[cfg(feature = "gpu")]
            gpu,
            prefer,
        })
    }

    /// Paints a scene as `camera` sees it, and says who did. O(triangles + pixels).
    ///
    /// Refuses a camera that [`Camera::check`] refuses. Under [`Prefer::Any`] whatever the GPU fails at is
    /// painted by the CPU, which takes any scene.
    pub fn paint(&self, scene: &Scene, camera: &Camera) -> Result<(Picture, Painter), RenderError> {
        camera.check()?;
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            match gpu.paint(scene, camera) {
                Ok(picture) => return Ok((picture, Painter::Gpu { adapter: gpu.adapter.clone() })),
                Err(error) if self.prefer == Prefer::Gpu => return Err(error),
                Err(_) => {}
            }
        }
        debug_assert!(self.prefer != Prefer::Gpu, "an easel for the GPU has one");
        Ok((cpu::paint(scene, camera), Painter::Cpu))
    }
}

/// Paints one scene: [`Easel::new`] and [`Easel::paint`] in one.
pub fn paint(scene: &Scene, camera: &Camera, prefer: Prefer) -> Result<(Picture, Painter), RenderError> {
    Easel::new(prefer)?.paint(scene, camera)
}
