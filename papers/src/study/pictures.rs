//! The pictures of a study.

use super::{Config, Picture, Results, StudyError, Subject, camera_path};
use mt_core::model::{cells_of, mesh_of};
use mt_core::{Camera, Explicit, Mesh};
use render::{Index, Look, Prefer, Seen, Tint};
use selective::{Limits, ScreenError, State, Strategy, UniformError, extract};

/// Draws the pictures of one model: the view-dependent mesh as its camera sees it and from outside, and error and level
/// at a tenth of the triangles.
pub(super) fn draw(
    subject: &Subject,
    model: &Explicit<3>,
    config: &Config,
    size: (u32, u32),
    results: &mut Results,
) -> Result<(), StudyError> {
    let sized = |camera: Camera| Camera { width_px: size.0, height_px: size.1, ..camera };
    let Some(camera) = close_camera(&subject.mesh, config.frames) else { return Ok(()) };
    let (low, high) = subject.mesh.bounding_box().unwrap_or_default();
    let (view, _) = extract(model, &ScreenError::new(&camera, config.error_px), &Limits::NONE, Strategy::TopDown, ());
    let seen = mesh_of(model, &view.view.mesh);
    let wire = Look { wireframe: true, ..Look::default() };
    let triangles = seen.cell_count();
    let mut easel = Easel { subject, operator: config.operators[0].name(), size, results };
    let caption = format!(
        "{}: {triangles} of {} triangles for {} px on the screen, as the camera sees it",
        subject.name,
        subject.mesh.cell_count(),
        config.error_px
    );
    let view =
        Viewed { from: sized(camera), kept: camera, options: format!("--camera FILE --pixels {}", config.error_px) };
    easel.paint("camera", caption, render::encode(&seen, &wire), view)?;
    let mut scene = render::encode(&seen, &wire);
    scene.add_frustum(&camera, low, high);
    let caption = format!(
        "{}: the same mesh from outside, with the camera's frustum; what it does not see is coarse",
        subject.name
    );
    let options = format!("--camera FILE --pixels {} --from-outside", config.error_px);
    let view = Viewed { from: sized(render::outside(&camera, low, high)), kept: camera, options };
    easel.paint("outside", caption, scene, view)?;
    let tenth = tenth_of(model, &subject.mesh);
    let around = sized(Camera::around(low, high, glam::Vec3::new(0.6, 0.5, 1.0)));
    let cells = subject.mesh.cell_count() / 10;
    let of_tenth = |overlay: &str| Viewed {
        from: around,
        kept: around,
        options: format!("--cells {cells} --look-from FILE --overlay {overlay}"),
    };
    let (index, cells) = (Index::of(model), cells_of(model, &tenth.view.mesh));
    let asks = |_| true;
    let seen = Seen { model, index: &index, front: tenth.front(), asks: &asks, steps: &[] };
    let caption = format!("{}: error of each triangle at a tenth of the input, in model units", subject.name);
    easel.paint("error", caption, seen.encode(Tint::Error, &cells, true), of_tenth("error"))?;
    let caption = format!("{}: level of each triangle, the longest chain of modifications to it", subject.name);
    easel.paint("level", caption, seen.encode(Tint::Level, &cells, true), of_tenth("level"))
}

/// A camera of the path that is near the surface and has some of it in view.
fn close_camera(mesh: &Mesh<3>, frames: u32) -> Option<Camera> {
    let cameras = camera_path(mesh, frames);
    let seen = |camera: &Camera| {
        let planes = camera.frustum();
        let inside = |p: &&glam::Vec3| planes.iter().all(|plane| plane.dot(p.extend(1.0)) >= 0.0);
        mesh.positions.iter().filter(inside).count()
    };
    // Nearest first; the next ones where that looks past the model.
    let order = [8, 7, 9, 6, 10, 5, 11, 4, 12].map(|i| cameras.get(cameras.len() * i / 16));
    let enough = mesh.positions.len() / 20;
    let found = order.into_iter().flatten().find(|camera| seen(camera) > enough);
    found.or(cameras.get(cameras.len() / 2)).copied()
}

fn tenth_of(model: &Explicit<3>, input: &Mesh<3>) -> State<3, Explicit<3>, ()> {
    let limits = Limits { cells: Some((input.cell_count() / 10) as u32), time: None };
    extract(model, &UniformError { error_max: -1.0 }, &limits, Strategy::Priority, ()).0
}

/// How a picture is seen, and how the command is told of it.
struct Viewed {
    from: Camera,
    /// The camera that is kept in a file.
    kept: Camera,
    /// Options of `mtess render` besides the wireframe and the size; the camera's file stands as `FILE`.
    options: String,
}

struct Easel<'a> {
    subject: &'a Subject,
    operator: String,
    size: (u32, u32),
    results: &'a mut Results,
}

impl Easel<'_> {
    fn paint(&mut self, what: &str, caption: String, scene: render::Scene, view: Viewed) -> Result<(), StudyError> {
        let stem = format!("{}-{what}", self.subject.name);
        let name = format!("{stem}.png");
        let (picture, painter) =
            render::paint(&scene, &view.from, Prefer::Any).map_err(|error| StudyError::Picture(name.clone(), error))?;
        let (png, painter) = (picture.to_png(), painter.to_string());
        let model = format!("{}.mt", self.subject.name);
        let options = view.options.replace("FILE", &format!("{stem}.json"));
        let (width, height) = self.size;
        let command = format!(
            "mtess build MESH --operator {} --regions 0 -o {model}\n\
             mtess render {model} {options} --overlay wireframe --size {width}x{height} -o {name}",
            self.operator
        );
        let (model, camera) = (self.subject.name.clone(), view.kept);
        self.results.pictures.push(Picture { model, name, caption, painter, camera, command, png });
        Ok(())
    }
}
