//! What analysis by regions loses and wins against one queue for all: distances at a half, a tenth and a hundredth of the
//! triangles (extracted by error, as one uses them), and CPU seconds.
//!
//! `cargo run --release -p mt-papers --example regions -- FILE|TRIANGLES [VERTICES ...]`: a mesh, or about how many triangles
//! a generated surface has; how many vertices regions have. Distances are root mean squares in diagonals.

use mt_core::analysis::{Options, Regions, analyse, analyse_by_regions};
use mt_core::format::{Format, read};
use mt_core::model::mesh_of;
use mt_core::{ErrorKind, Mesh, MultiTessellation, Recorder, generate};
use mt_papers::distance::{Sampling, Surface};
use operators::EdgeCollapse;
use selective::{Limits, Strategy, UniformError, extract};
use std::error::Error;

const SHARES: [f64; 3] = [0.5, 0.1, 0.01];

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let mesh = subject(&words.next().ok_or("which mesh?")?)?;
    let sizes: Vec<u32> = words.map(|word| word.parse()).collect::<Result<_, _>>()?;
    let surface = Surface::new(&mesh)?;
    println!("{} triangles: root mean square at a half, a tenth, a hundredth", mesh.cell_count());
    tell(&mesh, &surface, None)?;
    let usual = [Regions::default().vertices];
    for &vertices in if sizes.is_empty() { &usual } else { sizes.as_slice() } {
        tell(&mesh, &surface, Some(Regions { vertices, threads: 1 }))?;
    }
    Ok(())
}

fn subject(word: &str) -> Result<Mesh<3>, Box<dyn Error>> {
    if let Ok(triangles) = word.parse::<f64>() {
        return Ok(generate::genus_surface(2, (triangles / 100.0).sqrt().max(8.0) as usize, 0.05, 7));
    }
    let format = Format::from_extension(word.rsplit('.').next().unwrap_or("")).ok_or("the ending tells no format")?;
    Ok(read(format, &std::fs::read(word)?, &Default::default(), &|_| None)?.0)
}

fn tell(mesh: &Mesh<3>, surface: &Surface, regions: Option<Regions>) -> Result<(), Box<dyn Error>> {
    let begun = cpu_seconds();
    let mut recorder = Recorder::new(mesh)?;
    let options = Options::default();
    match regions {
        None => analyse(mesh, &EdgeCollapse::FULL, &options, &mut recorder, &mut |_| true)?,
        Some(regions) => {
            analyse_by_regions(mesh, &EdgeCollapse::FULL, &options, &regions, &mut recorder, &mut |_| true)?
        }
    };
    let seconds = cpu_seconds() - begun;
    let model = recorder.finish(ErrorKind::Estimate)?;
    let title = regions.map_or("as a whole".to_owned(), |regions| format!("regions of {}", regions.vertices));
    print!("{title:20} {seconds:7.3} s  ");
    for share in SHARES {
        let limits = Limits { cells: Some((mesh.cell_count() as f64 * share) as u32), time: None };
        let (state, _) = extract(&model, &UniformError { error_max: -1.0 }, &limits, Strategy::Priority, ());
        let apart = Surface::new(&mesh_of(&model, &state.view.mesh))?.distance(surface, Sampling::default());
        print!("  {:.2e}", apart.rms() / mesh.diagonal());
    }
    println!("   base {}", model.cell_count(&model.base()));
    Ok(())
}

fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
