//! Pictures: the laws of the painters. Twin (CPU and GPU agree), coverage, depth order, clipping, wire,
//! determinism, hostile scenes. Pictures that need a GPU are skipped with a printed line where there is
//! none; with MT_REQUIRE_GPU=1 they fail instead.

use glam::{Vec2, Vec3};
use mt_core::{Camera, Mesh};
use render::{Easel, Look, Overlay, Painter, Picture, Prefer, RenderError, Scene, encode, outside, paint};

/// Twins differ by rounding, and at a few samples by the order in which hardware interpolates: on average
/// at most this much of 255 a channel ...
const MEAN_MAX: f64 = 0.15;
/// ... with at most this share of pixels off by more than [`FAR`] in a channel.
const FAR_SHARE_MAX: f64 = 0.002;
const FAR: u8 = 12;

fn gpu() -> Option<Easel> {
    match Easel::new(Prefer::Gpu) {
        Ok(easel) => Some(easel),
        Err(error) if std::env::var_os("MT_REQUIRE_GPU").is_some_and(|value| value == "1") => panic!("{error}"),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

/// Looks along -z at the square from -1 to 1, which fills the picture of `side` pixels exactly.
fn square_camera(side: u32) -> Camera {
    let distance = 10.0;
    Camera {
        eye: Vec3::Z * distance,
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov_y_degrees: 2.0 * (1.0f32 / distance).atan().to_degrees(),
        near: 1.0,
        far: 100.0,
        width_px: side,
        height_px: side,
    }
}

/// A sphere that a sine roughens, 2 * rings * sectors triangles, counter-clockwise from outside.
fn bumpy_sphere(rings: u32, sectors: u32) -> Mesh<3> {
    let point = |ring: u32, sector: u32| {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        let around = std::f32::consts::TAU * sector as f32 / sectors as f32;
        let radius = 1.0 + 0.1 * (5.0 * around).sin() * polar.sin();
        Vec3::new(polar.sin() * around.cos(), polar.cos(), -polar.sin() * around.sin()) * radius
    };
    let positions = (0..=rings).flat_map(|ring| (0..sectors).map(move |sector| point(ring, sector))).collect();
    let quad = |ring: u32, sector: u32| {
        let next = (sector + 1) % sectors;
        let [a, b, c, d] =
            [(ring, sector), (ring + 1, sector), (ring + 1, next), (ring, next)].map(|(r, s)| r * sectors + s);
        [[a, b, c], [a, c, d]]
    };
    let cells: Vec<_> = (0..rings).flat_map(|ring| (0..sectors).flat_map(move |sector| quad(ring, sector))).collect();
    Mesh::from_indices(positions, &cells)
}

fn sphere_camera() -> Camera {
    let camera = Camera::around(Vec3::splat(-1.1), Vec3::splat(1.1), Vec3::new(0.4, 0.5, 1.0));
    Camera { width_px: 400, height_px: 300, ..camera }
}

fn cpu(scene: &Scene, camera: &Camera) -> Picture {
    let (picture, painter) = paint(scene, camera, Prefer::Cpu).expect("the CPU paints anything");
    assert_eq!(painter, Painter::Cpu);
    picture
}

/// The picture's background at a row: what an empty scene shows there.
fn is_background(picture: &Picture, camera: &Camera, x: u32, y: u32) -> bool {
    picture.pixel(x, y) == cpu(&Scene::default(), camera).pixel(x, y)
}

#[track_caller]
fn check_twins(name: &str, scene: &Scene, camera: &Camera) {
    let ours = cpu(scene, camera);
    let Some(easel) = gpu() else { return };
    let (theirs, painter) = easel.paint(scene, camera).expect("the GPU paints this");
    assert!(matches!(painter, Painter::Gpu { .. }));
    assert_eq!((ours.width, ours.height, ours.rgba.len()), (theirs.width, theirs.height, theirs.rgba.len()));
    let differences: Vec<u8> = ours.rgba.iter().zip(&theirs.rgba).map(|(a, b)| a.abs_diff(*b)).collect();
    let mean = differences.iter().map(|&d| f64::from(d)).sum::<f64>() / differences.len() as f64;
    let far = differences.chunks(4).filter(|pixel| pixel.iter().any(|&d| d > FAR)).count();
    let share = far as f64 / (differences.len() / 4) as f64;
    println!("{name}: mean {mean:.4}, far {share:.5}");
    assert!(mean <= MEAN_MAX && share <= FAR_SHARE_MAX, "{name}: mean {mean}, share of far pixels {share}");
}

#[test]
fn twins_agree() {
    let mesh = bumpy_sphere(24, 48);
    let camera = sphere_camera();
    let values: Vec<f32> = (0..mesh.cell_count()).map(|cell| (cell % 100) as f32).collect();
    let wired = Look { wireframe: true, ..Look::default() };
    let range = Overlay::range_of(&values);
    check_twins("empty", &Scene::default(), &camera);
    check_twins("flat", &encode(&mesh, &Look::default()), &camera);
    check_twins("smooth", &encode(&mesh, &Look { smooth: true, ..Look::default() }), &camera);
    check_twins("wire", &encode(&mesh, &wired), &camera);
    check_twins(
        "error",
        &encode(&mesh, &Look { overlay: Overlay::Error { values: &values, range }, ..wired }),
        &camera,
    );
    let odd = Camera { width_px: 333, height_px: 201, ..camera };
    check_twins("level", &encode(&mesh, &Look { overlay: Overlay::Level { values: &values, range }, ..wired }), &odd);
}

#[test]
fn twins_agree_from_within_and_from_outside() {
    let mesh = bumpy_sphere(24, 48);
    let look = Look { wireframe: true, ..Look::default() };
    let (low, high) = mesh.bounding_box().expect("it has vertices");
    let within =
        Camera { eye: Vec3::new(0.0, 0.0, 0.9), target: Vec3::new(0.4, 0.1, 0.0), near: 0.3, ..sphere_camera() };
    check_twins("within", &encode(&mesh, &look), &within);
    let mut scene = encode(&mesh, &look);
    scene.add_frustum(&within, low, high);
    check_twins("outside", &scene, &outside(&within, low, high));
    check_twins("lines cut by the near plane", &scene, &within);
}

/// More triangles than one vertex buffer takes: none is lost or cut between buffers.
#[test]
fn twins_agree_on_a_mesh_of_several_buffers() {
    let scene = encode(&bumpy_sphere(700, 720), &Look { wireframe: true, ..Look::default() });
    assert!(size_of_val(&scene.corners[..]) > 80 << 20);
    check_twins("several buffers", &scene, &sphere_camera());
}

#[test]
fn an_empty_scene_is_its_background() {
    let camera = square_camera(64);
    let scene = Scene { background: [[10, 20, 30, 255], [10, 20, 30, 255]], ..Scene::default() };
    assert!(cpu(&scene, &camera).rgba.chunks(4).all(|pixel| pixel == [10, 20, 30, 255]));
    assert_eq!(encode(&Mesh::default(), &Look::default()), Scene::default());
}

#[test]
fn a_triangle_covers_the_pixels_inside_it_and_no_others() {
    let side = 128;
    let camera = square_camera(side);
    let corners = [Vec2::new(-0.81, -0.63), Vec2::new(0.77, -0.4), Vec2::new(0.1, 0.9)];
    let mesh = Mesh::from_indices(corners.map(|corner| corner.extend(0.0)).into(), &[[0, 1, 2]]);
    let picture = cpu(&encode(&mesh, &Look::default()), &camera);
    let empty = cpu(&Scene::default(), &camera);
    for y in 0..side {
        for x in 0..side {
            let middle = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * (2.0 / side as f32);
            let at = Vec2::new(middle.x - 1.0, 1.0 - middle.y);
            let depth = (0..3).map(|i| {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                (to - from).perp_dot(at - from) / (to - from).length()
            });
            let depth_px = depth.fold(f32::MAX, f32::min) * side as f32 * 0.5;
            let painted = picture.pixel(x, y) != empty.pixel(x, y);
            assert!(depth_px.abs() < 0.75 || painted == (depth_px > 0.0), "pixel {x}, {y} at {depth_px} px");
        }
    }
}

#[test]
fn neighbours_leave_no_seam() {
    let mesh = bumpy_sphere(40, 80);
    let camera = Camera { target: Vec3::ZERO, fov_y_degrees: 12.0, ..sphere_camera() };
    let black = [0, 0, 0, 255];
    let scene =
        Scene { background: [[255, 0, 255, 255]; 2], ..encode(&mesh, &Look { material: black, ..Look::default() }) };
    assert!(cpu(&scene, &camera).rgba.chunks(4).all(|pixel| pixel == black));
}

#[test]
fn the_nearer_triangle_hides_the_farther_whatever_their_order() {
    let square = |z: f32| [Vec3::new(-2.0, -2.0, z), Vec3::new(2.0, -2.0, z), Vec3::new(0.0, 3.0, z)];
    let camera = square_camera(32);
    let overlay = |near_first: bool| {
        let heights = if near_first { [1.0, -1.0] } else { [-1.0, 1.0] };
        let mesh = Mesh::from_indices(heights.into_iter().flat_map(square).collect(), &[[0, 1, 2], [3, 4, 5]]);
        let look = Look { overlay: Overlay::Level { values: &heights, range: (-1.0, 1.0) }, ..Look::default() };
        cpu(&Scene { legend: None, ..encode(&mesh, &look) }, &camera)
    };
    let [first, second] = [overlay(true), overlay(false)];
    assert_eq!(first, second);
    let [red, _, blue, _] = first.pixel(16, 16);
    assert!(red > 200 && blue < 80, "the near triangle has the ramp's yellow end");
}

#[test]
fn both_sides_are_lit() {
    let corners = vec![Vec3::new(-3.0, -3.0, 0.0), Vec3::new(3.0, -3.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
    let camera = square_camera(16);
    let faces =
        [[0, 1, 2], [0, 2, 1]].map(|cell| encode(&Mesh::from_indices(corners.clone(), &[cell]), &Look::default()));
    let [front, back] = faces.each_ref().map(|scene| cpu(scene, &camera).pixel(8, 8));
    assert_eq!(front, back);
    assert!(front[0] > 150, "lit, not in the dark: {front:?}");
}

#[test]
fn a_camera_within_the_model_sees_it_all_around() {
    let mesh = bumpy_sphere(24, 48);
    let scene = Scene { background: [[255, 0, 255, 255]; 2], ..encode(&mesh, &Look::default()) };
    for direction in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::new(0.3, 0.9, 0.1)] {
        let camera =
            Camera { eye: Vec3::splat(0.1), target: Vec3::splat(0.1) + direction, near: 0.01, ..sphere_camera() };
        let picture = cpu(&scene, &camera);
        assert!(picture.rgba.chunks(4).all(|pixel| pixel[1] > 30), "background seen towards {direction}");
    }
}

#[test]
fn a_triangle_through_the_near_plane_is_cut_there() {
    let camera = square_camera(64);
    // A floor from far behind the eye to far ahead, below the axis: it fills the lower half up to the horizon.
    let floor = vec![Vec3::new(-500.0, -0.5, 400.0), Vec3::new(500.0, -0.5, 400.0), Vec3::new(0.0, -0.5, -80.0)];
    let picture = cpu(&encode(&Mesh::from_indices(floor, &[[0, 1, 2]]), &Look::default()), &camera);
    assert!(is_background(&picture, &camera, 32, 20), "nothing above the horizon");
    assert!(!is_background(&picture, &camera, 32, 63) && !is_background(&picture, &camera, 32, 45));
}

#[test]
fn the_wire_is_dark_and_thin() {
    let camera = square_camera(128);
    let corners =
        vec![Vec3::new(-3.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 9.0, 0.0), Vec3::new(0.0, -9.0, 0.0)];
    let mesh = Mesh::from_indices(corners, &[[0, 1, 2], [1, 0, 3]]);
    let picture = cpu(&encode(&mesh, &Look { wireframe: true, ..Look::default() }), &camera);
    let column: Vec<u8> = (0..128).map(|y| picture.pixel(40, y)[0]).collect();
    let plain = column[20];
    let dark: Vec<usize> = (0..128).filter(|&y| column[y] + 30 < plain).collect();
    assert!((1..=3).contains(&dark.len()) && dark.iter().all(|y| (62..=65).contains(y)), "dark rows {dark:?}");
}

#[test]
fn a_hidden_line_leaves_a_trace_and_an_open_one_is_full() {
    let camera = square_camera(64);
    let wall = vec![Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 9.0, 0.0)];
    let scene = encode(&Mesh::from_indices(wall, &[[0, 1, 2]]), &Look::default());
    let line = |z: f32| {
        let at = |x: f32| (Vec3::new(x, 0.0, z) - scene.origin).to_array();
        let segment = render::Segment { from: at(-0.9), to: at(0.9), colour: [0, 0, 0, 255], width_px: 6.0 };
        cpu(&Scene { segments: vec![segment], ..scene.clone() }, &camera).pixel(32, 32)[0]
    };
    let (wall, open, hidden) = (cpu(&scene, &camera).pixel(32, 32)[0], line(1.0), line(-1.0));
    assert!(open == 0 && hidden > 100 && hidden < wall, "{open} {hidden} {wall}");
}

#[test]
fn from_outside_the_model_and_the_frustum_are_seen_whole() {
    let (low, high) = (Vec3::splat(-1.0), Vec3::splat(1.0));
    let views = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(-1.0, -2.0, 0.5)].map(|from| Camera::around(low, high, from));
    let past = Camera { eye: Vec3::new(0.0, 0.0, 5.0), target: Vec3::new(0.0, 0.0, 9.0), ..views[0] };
    let endless = Camera { far: 1e12, near: 1e-6, ..views[2] };
    for camera in views.into_iter().chain([past, endless]) {
        let second = outside(&camera, low, high);
        second.check().expect("it can be looked through");
        let mut scene = Scene::default();
        scene.add_frustum(&camera, low, high);
        let ends = scene.segments.iter().flat_map(|segment| [segment.from, segment.to]).map(Vec3::from);
        for point in ends.chain([low, high]) {
            let clip = second.view_projection() * point.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            assert!(ndc.truncate().abs().max_element() < 1.0 && (0.0..=1.0).contains(&ndc.z), "{point} at {ndc}");
        }
    }
}

#[test]
fn colours_follow_values_and_strange_values_are_grey() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = Mesh::from_indices(corners, &[[0, 1, 2]; 6]);
    let values = [0.0, 5.0, 10.0, 99.0, f32::NAN];
    let look = Look { overlay: Overlay::Level { values: &values, range: (0.0, 10.0) }, ..Look::default() };
    let colours: Vec<_> = encode(&mesh, &look).corners.iter().step_by(3).map(|corner| corner.colour).collect();
    assert_eq!(colours[0], [0x44, 0x01, 0x54, 255]);
    assert_eq!(colours[2], [0xfd, 0xe7, 0x25, 255]);
    assert_eq!(colours[3], colours[2]);
    assert!(colours[1][1] > 120 && colours[1][1] < 160);
    assert!(colours[4..].iter().all(|colour| colour[0] == colour[1] && colour[1] == colour[2]));
    assert_eq!(Overlay::range_of(&values), (0.0, 99.0));
}

/// Degenerate, huge, infinite and misnamed: each is drawn or left out, and never brings a painter down.
#[test]
fn hostile_scenes_are_painted() {
    let huge = 3e38;
    let positions = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::splat(huge),
        Vec3::new(-huge, huge, -huge),
        Vec3::NAN,
        Vec3::new(f32::INFINITY, 0.0, 0.0),
        Vec3::splat(1e-42),
        Vec3::new(1e7, -1e7, 9.999),
        Vec3::new(-1e7, 1e7, 9.0),
    ];
    let cells =
        [[0, 0, 0], [0, 1, 1], [0, 1, 2], [0, 3, 4], [3, 3, 4], [0, 1, 5], [6, 1, 2], [0, 7, 1], [0, 1, 99], [8, 9, 1]];
    let mesh = Mesh::from_indices(positions, &cells);
    let camera = Camera { near: 1e-6, far: 1e30, ..square_camera(50) };
    for smooth in [false, true] {
        let mut scene = encode(&mesh, &Look { wireframe: true, smooth, ..Look::default() });
        scene.add_frustum(&square_camera(10), Vec3::splat(-huge), Vec3::splat(huge));
        cpu(&scene, &camera);
        if let Some(easel) = gpu() {
            easel.paint(&scene, &camera).expect("the GPU takes it too");
        }
    }
}

/// What only rounding of positions far from 0 can spoil.
#[test]
fn a_model_far_from_the_origin_looks_as_it_does_there() {
    let near = bumpy_sphere(12, 24);
    let shift = Vec3::new(262_144.0, -131_072.0, 65_536.0);
    // The shift is a power of two, so only positions that survive the addition compare equal.
    let snap = |p: Vec3| (p * 32.0).round() / 32.0;
    let near = Mesh { positions: near.positions.into_iter().map(snap).collect(), ..near };
    let far = Mesh { positions: near.positions.iter().map(|p| *p + shift).collect(), ..near.clone() };
    let camera = Camera { eye: Vec3::new(0.0, 1.0, 4.0), target: Vec3::ZERO, near: 1.0, far: 8.0, ..sphere_camera() };
    let moved = Camera { eye: camera.eye + shift, target: camera.target + shift, ..camera };
    let look = Look { wireframe: true, ..Look::default() };
    assert_eq!(cpu(&encode(&near, &look), &camera), cpu(&encode(&far, &look), &moved));
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let scene = encode(&bumpy_sphere(30, 60), &Look { wireframe: true, ..Look::default() });
    let camera = sphere_camera();
    let first = cpu(&scene, &camera);
    assert_eq!(first, cpu(&scene, &camera));
    assert_eq!(first.to_png(), cpu(&scene, &camera).to_png());
    if let Some(easel) = gpu() {
        let paint = || easel.paint(&scene, &camera).expect("the GPU paints this").0;
        assert_eq!(paint(), paint());
    }
}

#[test]
fn png_holds_the_same_pixels() {
    let picture = cpu(
        &encode(&bumpy_sphere(10, 20), &Look::default()),
        &Camera { width_px: 61, height_px: 47, ..sphere_camera() },
    );
    let bytes = picture.to_png();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("a PNG header");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut pixels).expect("a PNG picture");
    assert_eq!((info.width, info.height, pixels), (61, 47, picture.rgba));
}

#[test]
fn cameras_and_pictures_that_cannot_be_are_refused() {
    let blind = Camera { target: Vec3::Z * 10.0, ..square_camera(8) };
    let any = paint(&Scene::default(), &blind, Prefer::Any);
    assert!(matches!(any, Err(RenderError::Camera(_))));
    if let Some(easel) = gpu() {
        let vast = easel.paint(&Scene::default(), &square_camera(16_384));
        assert!(matches!(vast, Err(RenderError::TooLarge { .. })), "{:?}", vast.map(|(_, painter)| painter));
    }
}
