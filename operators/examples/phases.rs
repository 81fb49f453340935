//! Where the time of building a hierarchy goes, by edge collapse and quadrics: CPU and wall seconds of each phase, the least of
//! some runs, and thousands of triangles removed per CPU second of all of them; as a whole, and by regions.
//!
//! `cargo run --release -p mt-operators --example phases -- [MESH|TRIANGLES] [RUNS] [REGION] [THREADS] [whole|regions]`: a
//! mesh, or about how many triangles a generated surface of genus 2 has; vertices of a region; one way or both.

use mt_core::analysis::{AnalysisError, Ended, Options, RegionListener, Regions, analyse, analyse_by_regions};
use mt_core::format::{Format, read};
use mt_core::{ErrorKind, Mesh, NodeId, Recorder, Replay, Sequence, generate};
use mt_operators::EdgeCollapse;
use mt_operators::order::Stored;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let mesh = subject(&words.next().unwrap_or("1000000".into()))?;
    let mut number = |usual: usize| words.next().map_or(Ok(usual), |word| word.parse());
    let (runs, vertices, threads) = (number(3)?, number(Regions::default().vertices as usize)?, number(1)?);
    let way = words.next();
    println!("{} vertices, {} triangles", mesh.vertex_count(), mesh.cell_count());
    for (title, regions) in
        [("as a whole", None), ("by regions", Some(Regions { vertices: u32::try_from(vertices)?, threads }))]
    {
        if way.as_ref().is_some_and(|way| !title.contains(way)) {
            continue;
        }
        // As many threads for what follows from the analysis as for itself.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let mut best: Seconds = [[f64::INFINITY; 2]; 5];
        let mut removed = 0;
        for _ in 0..runs {
            let (seconds, left) = pool.install(|| once(&mesh, regions).map_err(|error| error.to_string()))?;
            for (best, now) in best.iter_mut().zip(seconds) {
                *best = [0, 1].map(|clock| best[clock].min(now[clock]));
            }
            removed = mesh.cell_count() - left;
        }
        println!("{title}:");
        let names = [
            "analysis, merges recorded",
            "  replay of the merges",
            "  dual-piece order",
            "analysis, cells recorded",
            "  order and bounds of the cells",
        ];
        let tell = |name: &str, [cpu, wall]: [f64; 2]| {
            println!("  {name:40} {:9.1} ms of CPU, {:9.1} ms of wall", cpu * 1e3, wall * 1e3);
        };
        names.iter().zip(best).for_each(|(name, seconds)| tell(name, seconds));
        let sum = |seconds: &[[f64; 2]]| [0, 1].map(|clock| seconds.iter().map(|both| both[clock]).sum::<f64>());
        tell("hierarchy", sum(&best[..3]));
        let rate = |seconds: &[[f64; 2]]| removed as f64 / sum(seconds)[0] / 1e3;
        println!("  thousand triangles a CPU second: {:.0} hierarchy, {:.0} cells", rate(&best[..3]), rate(&best[3..]));
    }
    Ok(())
}

fn subject(word: &str) -> Result<Mesh<3>, Box<dyn Error>> {
    if let Ok(triangles) = word.parse::<f64>() {
        // A surface on a grid of n has about 100 n² triangles.
        return Ok(generate::genus_surface(2, (triangles / 100.0).sqrt().max(8.0) as usize, 0.05, 7));
    }
    let format = Format::from_extension(word.rsplit('.').next().unwrap_or("")).ok_or("the ending tells no format")?;
    Ok(read(format, &std::fs::read(word)?, &Default::default(), &|_| None)?.0)
}

/// CPU and wall seconds of each phase.
type Seconds = [[f64; 2]; 5];

/// How long each phase takes, and the triangles left.
fn once(mesh: &Mesh<3>, regions: Option<Regions>) -> Result<(Seconds, usize), Box<dyn Error>> {
    let begun = Instant::now();
    let now = || [cpu_seconds(), begun.elapsed().as_secs_f64()];
    let mut clock = now();
    let mut lap = || {
        let before = std::mem::replace(&mut clock, now());
        [0, 1].map(|which| clock[which] - before[which])
    };
    let mut merges = Sequence::new(mesh);
    coarsen(mesh, regions, &mut merges)?;
    let sequence = lap();
    let replay = Replay::new(mesh, &[], &merges)?;
    let derived = lap();
    let order = Stored::dual_piece(&replay)?;
    let ordered = lap();
    let left = mesh.cell_count() - (0..replay.len()).map(|m| replay.born(NodeId(m)).len()).sum::<usize>();
    drop((merges, replay, order));
    lap();
    let mut recorder = Recorder::new(mesh)?;
    coarsen(mesh, regions, &mut recorder)?;
    let record = lap();
    drop(recorder.finish(ErrorKind::Estimate)?);
    Ok(([sequence, derived, ordered, record, lap()], left))
}

fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn coarsen(
    mesh: &Mesh<3>,
    regions: Option<Regions>,
    listener: &mut impl RegionListener<3>,
) -> Result<Ended, AnalysisError> {
    let options = Options::default();
    match regions {
        None => analyse(mesh, &EdgeCollapse::FULL, &options, listener, &mut |_| true),
        Some(regions) => analyse_by_regions(mesh, &EdgeCollapse::FULL, &options, &regions, listener, &mut |_| true),
    }
}
