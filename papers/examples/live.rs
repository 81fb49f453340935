//! What a frame costs where a mesh lives on the device: adapting, sending what changed, painting and reading back.
//!
//! `cargo run --release -p mt-papers --example live -- TRIANGLES|FILE [FRONT]`: a generated terrain of about so many triangles,
//! or a mesh; how many triangles a frame is to have, 100,000 if not said. Frames of 1280 x 720, along a path once around.

use mt_core::analysis::{Options, Regions, analyse_by_regions};
use mt_core::format::{Format, LoadOptions, read};
use mt_core::{Camera, Hierarchy, Mesh, Replay, Sequence, generate};
use mt_papers::study::camera_path;
use operators::EdgeCollapse;
use operators::order::Stored;
use render::{LiveMesh, Look, Scene, Stage};
use selective::{Limits, ScreenError, State, adapt};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const FRAMES: u32 = 300;
const SEEN: usize = 60;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let mesh = subject(&words.next().ok_or("which mesh?")?)?;
    let front: u32 = words.next().map_or(Ok(100_000), |word| word.parse())?;
    let mut sequence = Sequence::new(&mesh);
    let (options, regions) = (Options::default(), Regions::default());
    analyse_by_regions(&mesh, &EdgeCollapse::FULL, &options, &regions, &mut sequence, &mut |_| true)?;
    let replay = Arc::new(Replay::new(&mesh, &[], &sequence)?);
    let model = Hierarchy { dependency: Stored::dual_piece(&replay)?, replay };
    let cameras: Vec<Camera> = camera_path(&mesh, FRAMES)
        .into_iter()
        .map(|camera| Camera { width_px: 1280, height_px: 720, ..camera })
        .collect();
    let error_px = error_for(&model, &cameras[0], front);
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let (origin, look) = ((low + high) * 0.5, Look::default());
    let live = LiveMesh::new(model.replay.positions(), mesh.cell_count() as u32, origin, look.material);
    let mut state = State::new(&model, live);
    let mut stage = Stage::new()?;
    let scene = Scene { origin, ..Scene::default() };
    println!("{} triangles, {error_px:.3} px, {}", mesh.cell_count(), stage.adapter());
    let mut times: [Vec<f64>; 3] = Default::default();
    let (mut bytes, mut steps, mut triangles) = (0, 0, 0);
    for (i, camera) in cameras.iter().take(SEEN + 1).enumerate() {
        state.steps.clear();
        let begun = Instant::now();
        adapt(&model, &ScreenError::new(camera, error_px), &Limits::NONE, &mut state);
        let adapted = begun.elapsed();
        let sent = stage.update(&mut state.sink.places)?;
        let updated = begun.elapsed();
        stage.paint(&scene, camera)?;
        let painted = begun.elapsed();
        if i > 0 {
            let all = [adapted, updated - adapted, painted - updated];
            times.iter_mut().zip(all).for_each(|(times, time)| times.push(time.as_secs_f64() * 1e3));
            (bytes, steps, triangles) =
                (bytes + sent.bytes, steps + state.steps.len(), triangles + state.sink.places.triangle_count());
        }
    }
    for (what, times) in ["adapt", "send", "paint and read back"].into_iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        println!("{what}: median {:.2} ms, worst {:.2} ms", times[SEEN / 2], times[SEEN - 1]);
    }
    println!("a frame: {} triangles, {} steps, {} bytes sent", triangles / SEEN, steps / SEEN, bytes / SEEN as u64);
    Ok(())
}

/// The error on the screen at which the first frame has about so many triangles.
fn error_for(model: &Hierarchy<Stored>, camera: &Camera, front: u32) -> f32 {
    let (mut low, mut high) = (1e-4f32, 100.0f32);
    let mut state = State::new(model, ());
    for _ in 0..24 {
        let middle = (low * high).sqrt();
        adapt(model, &ScreenError::new(camera, middle), &Limits::NONE, &mut state);
        if state.cell_count(model) > front { low = middle } else { high = middle }
    }
    high
}

fn subject(name: &str) -> Result<Mesh<3>, Box<dyn Error>> {
    if let Ok(triangles) = name.parse::<f64>() {
        return Ok(generate::terrain((triangles / 2.0).sqrt() as usize, 0.55, 7));
    }
    let format = name.rsplit('.').next().and_then(Format::from_extension).ok_or("no format that can be read")?;
    Ok(read(format, &std::fs::read(name)?, &LoadOptions::default(), &|_| None)?.0)
}
