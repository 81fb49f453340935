//! A view on the device: along a camera path, with changes alone sent, each frame is the picture of the whole mesh, and what
//! is sent goes with what changed.

use mt_core::analysis::{Options, analyse, simplify};
use mt_core::model::mesh_of;
use mt_core::{Bound, Camera, Explicit, Hierarchy, Mesh, MultiTessellation, Replay, Sequence, generate};
use operators::EdgeCollapse;
use operators::order::Stored;
use papers::study::camera_path;
use render::{Easel, LiveMesh, Look, Prefer, RenderError, Scene, Stage, encode};
use selective::{Limits, ScreenError, State, adapt};
use std::sync::Arc;

/// Bytes of a triangle in a vertex buffer.
const TRIANGLE: u64 = 84;

/// A device, or a plain word that there is none.
fn stage() -> Option<Stage> {
    match Stage::new() {
        Ok(stage) => Some(stage),
        Err(error) if std::env::var_os("MT_REQUIRE_GPU").is_some_and(|value| value == "1") => panic!("{error}"),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

fn surface() -> Mesh<3> {
    generate::genus_surface(2, 8, 0.02, 3)
}

fn sequence(mesh: &Mesh<3>) -> Sequence {
    let mut sequence = Sequence::new(mesh);
    analyse(mesh, &EdgeCollapse::FULL, &Options::default(), &mut sequence, &mut |_| true).unwrap();
    sequence
}

/// Follows a path and compares each frame, wire and all, with the picture of the whole mesh. Gives the bytes sent and the
/// steps taken after the first frame, and the bytes of the whole mesh.
fn follow<M: MultiTessellation<3, Bound = Bound>>(
    model: &M,
    input: &Mesh<3>,
    cells: u32,
    stage: &mut Stage,
) -> [u64; 3] {
    let easel = Easel::new(Prefer::Gpu).unwrap();
    let (low, high) = input.bounding_box().unwrap();
    let look = Look { wireframe: true, ..Look::default() };
    let origin = (low + high) * 0.5;
    let mut state = State::new(model, LiveMesh::new(model.positions(), cells, origin, look.material));
    let (mut sent, mut steps, mut whole) = (0, 0, 0);
    for (i, camera) in camera_path(input, 240).into_iter().take(24).enumerate() {
        let camera = Camera { width_px: 96, height_px: 72, ..camera };
        state.steps.clear();
        adapt(model, &ScreenError::new(&camera, 0.1), &Limits::NONE, &mut state);
        let uploaded = stage.update(&mut state.sink.places).unwrap();
        assert_eq!(state.sink.places.triangle_count() as u32, state.cell_count(model));
        if i > 0 {
            (sent, steps) = (sent + uploaded.bytes, steps + state.steps.len() as u64);
            whole += u64::from(state.cell_count(model)) * TRIANGLE;
        }
        // The same triangles in another sequence, which decides where two are equally near.
        let scene = recentred(&mesh_of(model, &state.view.mesh), &look, origin);
        let (expected, _) = easel.paint(&scene, &camera).unwrap();
        let picture = stage.paint(&Scene { corners: Vec::new(), ..scene }, &camera).unwrap();
        let differing = picture
            .rgba
            .chunks_exact(4)
            .zip(expected.rgba.chunks_exact(4))
            .filter(|(a, b)| (0..3).any(|c| a[c].abs_diff(b[c]) > 8));
        let differing = differing.count();
        assert!(differing * 200 < picture.rgba.len() / 4, "frame {i}: {differing} pixels differ");
    }
    [sent, steps, whole]
}

/// A scene whose coordinates are relative to a given point.
fn recentred(mesh: &Mesh<3>, look: &Look<'_>, origin: glam::Vec3) -> Scene {
    let mut scene = encode(mesh, look);
    let by = scene.origin - origin;
    for corner in &mut scene.corners {
        corner.position = (glam::Vec3::from_array(corner.position) + by).to_array();
    }
    scene.origin = origin;
    scene
}

#[test]
fn frames_of_an_explicit_model_are_those_of_its_meshes() {
    let Some(mut stage) = stage() else { return };
    let mesh = surface();
    let model: Explicit<3> = simplify(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap().model;
    follow(&model, &mesh, model.total_cell_count(), &mut stage);
}

#[test]
fn frames_of_a_hierarchy_are_those_of_its_meshes_and_little_is_sent() {
    let Some(mut stage) = stage() else { return };
    let mesh = surface();
    let replay = Arc::new(Replay::new(&mesh, &[], &sequence(&mesh)).unwrap());
    let model = Hierarchy { dependency: Stored::dual_piece(&replay).unwrap(), replay };
    let [sent, steps, whole] = follow(&model, &mesh, mesh.cell_count() as u32, &mut stage);
    // A step touches the star of a vertex; near ones are sent together.
    assert!(steps > 0 && sent < steps * 40 * TRIANGLE, "{sent} bytes for {steps} steps");
    assert!(sent * 2 < whole, "{sent} bytes sent, {whole} of whole meshes");
}

#[test]
fn a_camera_that_sees_nothing_and_one_that_cannot_be() {
    let Some(mut stage) = stage() else { return };
    let mut mesh = LiveMesh::new([], 0, glam::Vec3::ZERO, [9; 4]);
    assert_eq!(stage.update(&mut mesh.places).unwrap().bytes, 0);
    let (low, high) = surface().bounding_box().unwrap();
    let camera = Camera { width_px: 8, height_px: 6, ..Camera::around(low, high, glam::Vec3::Z) };
    let empty = stage.paint(&Scene::default(), &camera).unwrap();
    assert_eq!((empty.width, empty.height), (8, 6));
    let blind = Camera { eye: glam::Vec3::NAN, ..camera };
    assert!(matches!(stage.paint(&Scene::default(), &blind), Err(RenderError::Camera(_))));
    // A picture of another size afterwards.
    let larger = Camera { width_px: 20, height_px: 10, ..camera };
    assert_eq!(stage.paint(&Scene::default(), &larger).unwrap().width, 20);
}
