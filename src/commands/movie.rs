//! `mtess movie`: a model along a camera path, frame by frame.

use super::{CommandError, print_text};
use crate::files::{self, FileError, Model};
use crate::progress::Progress;
use crate::selection;
use crate::subject::Subject;
use clap::Args;
use mt_core::hierarchy::Dependency;
use mt_core::model::mesh_of;
use mt_core::{Bound, Camera, Hierarchy, Mesh, MultiTessellation};
use operators::order::Visit;
use render::{Animation, Easel, Edges, Look, Picture, Prefer, RenderError};
use selective::{Limits, ScreenError, State, adapt};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args)]
pub struct Movie {
    #[command(flatten)]
    subject: Subject,
    /// The cameras, one frame each: a JSON list of cameras
    #[arg(long, value_name = "FILE.json")]
    cameras: Option<PathBuf>,
    /// Without --cameras: frames of a path once around the model
    #[arg(long, value_name = "N", default_value_t = 90, conflicts_with = "cameras", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Largest error on the screen, in pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    pixels: f32,
    /// Draw the triangles' edges
    #[arg(long)]
    wireframe: bool,
    /// Draw edges of one triangle, blue, and of more than two, violet
    #[arg(long)]
    boundary: bool,
    /// See each frame's mesh and frustum from outside
    #[arg(long)]
    from_outside: bool,
    /// Width and height, instead of the cameras' own
    #[arg(long, value_name = "WxH", value_parser = super::render::parse_size)]
    size: Option<(u32, u32)>,
    /// Also one animated PNG, beside the frames
    #[arg(long, value_name = "OUT.png")]
    animation: Option<PathBuf>,
    /// Frames of the animation a second
    #[arg(long, value_name = "N", default_value_t = 24, requires = "animation", value_parser = clap::value_parser!(u16).range(1..=240))]
    rate: u16,
    /// Folder of the frames: 0001.png and so on
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

impl Movie {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        if self.pixels.is_nan() || self.pixels < 0.0 {
            return Err(CommandError::Other("--pixels must be a number, 0 or more".into()));
        }
        if let Some(path) = &self.animation {
            files::check_output(path, "an animation", "png")?;
        }
        let model = self.subject.load()?;
        files::make_folder(&self.output)?;
        files::check_writable(&self.output)?;
        let told = match model {
            Model::Triangles(model) => self.film(&*model, &model.reference())?,
            Model::Hierarchy { replay, scheme } => {
                scheme.visit(&replay, Film(&self)).map_err(|error| FileError::new(self.subject.path(), error))??
            }
            Model::Tetrahedra(_) => return Err(files::no_triangles(self.subject.path()).into()),
        };
        print_text(&told);
        Ok(ExitCode::SUCCESS)
    }

    /// Paints frame after frame, each adapted from the last. Gives a line on what was done.
    fn film<M: MultiTessellation<3, Bound = Bound>>(&self, model: &M, input: &Mesh<3>) -> Result<String, CommandError> {
        let cameras = self.sized(selection::cameras(self.cameras.as_deref(), self.frames, &input.positions)?)?;
        let wrong =
            |error: RenderError| FileError::new(self.subject.path(), format!("the frames cannot be drawn: {error}"));
        let easel = Easel::new(Prefer::Any).map_err(wrong)?;
        let mut animation = match &self.animation {
            Some(path) => {
                let size = [cameras[0].width_px, cameras[0].height_px];
                let begun = Animation::new(size, cameras.len() as u32, self.rate);
                Some(begun.map_err(|error| FileError::new(path, error))?)
            }
            None => None,
        };
        let mut state = State::new(model, ());
        let mut progress = Progress::new("filming", cameras.len() as u64);
        let (mut painter, mut steps) = (String::new(), 0);
        for (i, camera) in cameras.iter().enumerate() {
            if !progress.at(i as u64) {
                return Err(CommandError::Other(format!(
                    "interrupted after {i} of {} frames, which are there",
                    cameras.len()
                )));
            }
            state.steps.clear();
            adapt(model, &ScreenError::new(camera, self.pixels), &Limits::NONE, &mut state);
            steps += state.steps.len();
            let mesh = mesh_of(model, &state.view.mesh);
            let picture;
            (picture, painter) = self.frame(&easel, &mesh, camera, input).map_err(wrong)?;
            files::write_bytes(&self.output.join(format!("{:04}.png", i + 1)), &picture.to_png())?;
            if let (Some(animation), Some(path)) = (&mut animation, &self.animation) {
                animation.add(&picture).map_err(|error| FileError::new(path, error))?;
            }
        }
        drop(progress);
        if let (Some(animation), Some(path)) = (animation, &self.animation) {
            let bytes = animation.finish().map_err(|error| FileError::new(path, error))?;
            files::write_bytes(path, &bytes)?;
        }
        let mean = steps as f64 / cameras.len() as f64;
        Ok(format!("{}: {} frames, {mean:.0} steps a frame, drawn by {painter}", self.output.display(), cameras.len()))
    }

    /// The cameras with the size that was asked for; an animation has frames of one size.
    fn sized(&self, mut cameras: Vec<Camera>) -> Result<Vec<Camera>, CommandError> {
        if let Some((width, height)) = self.size {
            cameras.iter_mut().for_each(|camera| (camera.width_px, camera.height_px) = (width, height));
        }
        let size = |camera: &Camera| (camera.width_px, camera.height_px);
        if self.animation.is_some() && cameras.iter().any(|camera| size(camera) != size(&cameras[0])) {
            return Err(CommandError::Other(
                "the cameras have pictures of several sizes; --size makes them one".into(),
            ));
        }
        Ok(cameras)
    }

    fn frame(
        &self,
        easel: &Easel,
        mesh: &Mesh<3>,
        camera: &Camera,
        input: &Mesh<3>,
    ) -> Result<(Picture, String), RenderError> {
        let mut scene = render::encode(mesh, &Look { wireframe: self.wireframe, ..Look::default() });
        if self.boundary {
            scene.add_edges(&mesh.positions, &mesh.cells, Edges::Boundary);
        }
        let mut from = *camera;
        if self.from_outside {
            let (low, high) = input.bounding_box().unwrap_or_default();
            scene.add_frustum(camera, low, high);
            from = render::outside(camera, low, high);
        }
        easel.paint(&scene, &from).map(|(picture, painter)| (picture, painter.to_string()))
    }
}

/// Films a hierarchy, whatever its dependencies.
struct Film<'a>(&'a Movie);

impl Visit for Film<'_> {
    type Output = Result<String, CommandError>;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        self.0.film(model, &model.replay.reference())
    }
}
