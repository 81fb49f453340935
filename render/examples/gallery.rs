//! A gallery: a bumpy sphere in every look, by both painters, as PNG files in the folder named on the
//! command line. `cargo run --release -p mt-render --example gallery -- FOLDER`

use glam::Vec3;
use mt_core::{Camera, Mesh};
use mt_render::{Easel, Look, Overlay, Prefer, Scene, encode, outside};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: gallery FOLDER")?);
    std::fs::create_dir_all(&folder)?;
    let mesh = bumpy_sphere(40, 80);
    let (low, high) = mesh.bounding_box().ok_or("no vertices")?;
    let camera = Camera::around(low, high, Vec3::new(0.5, 0.4, 1.0));
    let values: Vec<f32> = mesh.cells.iter().map(|cell| mesh.positions[cell[0].index()].length() - 1.0).collect();
    let range = Overlay::range_of(&values);
    let levels: Vec<f32> = (0..mesh.cell_count()).map(|cell| (cell / 800) as f32).collect();

    let wired = Look { wireframe: true, ..Look::default() };
    let mut views = vec![
        ("plain", encode(&mesh, &Look::default()), camera),
        ("smooth", encode(&mesh, &Look { smooth: true, ..Look::default() }), camera),
        ("wireframe", encode(&mesh, &wired), camera),
        (
            "error",
            encode(&mesh, &Look { overlay: Overlay::Error { values: &values, range }, ..Look::default() }),
            camera,
        ),
        (
            "level",
            encode(&mesh, &Look { overlay: Overlay::Level { values: &levels, range: (0.0, 7.0) }, ..wired }),
            camera,
        ),
        ("dense", encode(&bumpy_sphere(160, 320), &wired), camera),
    ];
    let near = Camera {
        eye: Vec3::new(0.4, 0.3, 2.6),
        target: Vec3::new(0.4, 0.2, 0.0),
        fov_y_degrees: 30.0,
        near: 0.4,
        far: 60.0,
        ..camera
    };
    let mut scene = encode(&mesh, &wired);
    scene.add_frustum(&near, low, high);
    views.push(("outside", scene, outside(&near, low, high)));
    let within = Camera { eye: Vec3::new(0.0, 0.0, 0.95), target: Vec3::new(0.6, 0.2, 0.0), near: 0.01, ..camera };
    views.push(("inside", encode(&mesh, &wired), within));

    for prefer in [Prefer::Gpu, Prefer::Cpu] {
        match Easel::new(prefer) {
            Ok(easel) => hang(&easel, prefer, &views, &folder)?,
            Err(error) => println!("{error}"),
        }
    }
    Ok(())
}

/// Paints every view and writes it as `name-painter.png`.
fn hang(easel: &Easel, prefer: Prefer, views: &[(&str, Scene, Camera)], folder: &Path) -> Result<(), Box<dyn Error>> {
    for (name, scene, camera) in views {
        let start = Instant::now();
        let (picture, painter) = easel.paint(scene, camera)?;
        let painted = start.elapsed();
        let path = folder.join(format!("{name}-{prefer:?}.png").to_lowercase());
        std::fs::write(&path, picture.to_png())?;
        println!("{} ({} triangles) by {painter} in {painted:.1?}", path.display(), scene.corners.len() / 3);
    }
    Ok(())
}

/// A sphere with bumps: `rings` times `sectors` quadrilaterals, cut in two.
fn bumpy_sphere(rings: u32, sectors: u32) -> Mesh<3> {
    let point = |ring: u32, sector: u32| {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        let around = std::f32::consts::TAU * sector as f32 / sectors as f32;
        let radius =
            1.0 + 0.12 * (5.0 * around).sin() * (4.0 * polar).sin() * polar.sin() + 0.04 * (11.0 * polar).cos();
        Vec3::new(polar.sin() * around.cos(), polar.cos(), -polar.sin() * around.sin()) * radius
    };
    let positions = (0..=rings).flat_map(|ring| (0..sectors).map(move |sector| point(ring, sector))).collect();
    let name = |ring: u32, sector: u32| ring * sectors + sector % sectors;
    let quad = |ring: u32, sector: u32| {
        let [a, b] = [name(ring, sector), name(ring + 1, sector)];
        let [c, d] = [name(ring + 1, sector + 1), name(ring, sector + 1)];
        [[a, b, c], [a, c, d]]
    };
    let cells: Vec<_> = (0..rings).flat_map(|ring| (0..sectors).flat_map(move |sector| quad(ring, sector))).collect();
    Mesh::from_indices(positions, &cells)
}
