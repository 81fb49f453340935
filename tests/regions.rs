//! Analysis by regions: the same bytes for any number of threads, models that keep all laws, and what is asked for.

use mt_core::analysis::{AnalysisError, Ended, Options, Regions, Stopped, Unfit};
use mt_core::{ErrorKind, Explicit, Mesh, MultiTessellation, Recorder, Replay, Sequence, container, generate};
use multi_tessellation::verify;
use operators::AnyOperator;
use operators::order::Scheme;
use papers::distance::{Sampling, Surface};

const OPERATORS: [&str; 6] = [
    "edge-collapse",
    "half-edge-collapse",
    "edge-collapse/lindstrom-turk",
    "edge-collapse/quadric-attributes",
    "half-edge-collapse/edge-length",
    "edge-collapse/edge-length",
];

fn meshes() -> Vec<(&'static str, Mesh<3>)> {
    vec![
        ("a bumpy sphere", generate::bumpy_sphere(3, 0.15, 9)),
        ("a terrain", generate::terrain(24, 0.55, 7)),
        ("two tori", generate::components(&[generate::torus(20, 12), generate::torus(9, 7)])),
        ("a box", generate::sharp_box(7)),
        ("a flat sheet", generate::bumpy_grid(30, 20, 0.0, 1)),
        ("a hub", generate::components(&[hub(300), generate::torus(20, 12)])),
        ("vertices without cells", lonely(&generate::terrain(16, 0.55, 3))),
        ("a large torus", scaled(&generate::torus(30, 16), 1e15)),
        ("a Moebius band", generate::moebius(90)),
        ("an octahedron", generate::octahedron()),
    ]
}

/// Two discs of so many triangles each around a vertex, with a common rim.
fn hub(count: u32) -> Mesh<3> {
    let turn = |i: u32| std::f32::consts::TAU * i as f32 / count as f32;
    let rim = (0..count).map(|i| glam::vec3(turn(i).cos(), turn(i).sin(), 0.0));
    let positions = rim.chain([glam::vec3(0.0, 0.0, 0.5), glam::vec3(0.0, 0.0, -0.5)]).collect();
    let sides = (0..count).map(|i| (i, (i + 1) % count));
    let cells: Vec<_> = sides.flat_map(|(a, b)| [[a, b, count], [b, a, count + 1]]).collect();
    Mesh::from_indices(positions, &cells)
}

/// With vertices that no cell has, before and after each.
fn lonely(mesh: &Mesh<3>) -> Mesh<3> {
    let positions = mesh.positions.iter().flat_map(|&p| [p + glam::Vec3::Z, p]).collect();
    let cells = mesh.cells.iter().map(|cell| cell.map(|v| mt_core::VertexId(2 * v.0 + 1))).collect();
    Mesh { positions, cells }
}

fn scaled(mesh: &Mesh<3>, scale: f32) -> Mesh<3> {
    Mesh { positions: mesh.positions.iter().map(|p| *p * scale).collect(), cells: mesh.cells.clone() }
}

fn operator(name: &str) -> AnyOperator {
    name.parse().expect("an operator")
}

fn cells(mesh: &Mesh<3>, name: &str, options: &Options, regions: Regions) -> (Explicit<3>, Ended) {
    let mut recorder = Recorder::new(mesh).expect("a good mesh");
    let ended = operator(name).analyse_by_regions(mesh, options, &regions, &mut recorder, &mut |_| true);
    (recorder.finish(ErrorKind::Estimate).expect("a history"), ended.expect("a mesh that the operator takes"))
}

fn merges(mesh: &Mesh<3>, name: &str, regions: Regions) -> Sequence {
    let mut sequence = Sequence::new(mesh);
    let ended = operator(name).analyse_by_regions(mesh, &Options::default(), &regions, &mut sequence, &mut |_| true);
    ended.expect("a mesh that the operator takes");
    sequence
}

fn small(threads: usize) -> Regions {
    Regions { vertices: 40, threads }
}

#[test]
fn threads_change_no_byte() {
    for (what, mesh) in meshes() {
        for name in OPERATORS {
            let bytes = |threads| {
                let mut bytes = Vec::new();
                let model = cells(&mesh, name, &Options::default(), small(threads)).0;
                container::write(&model, &Default::default(), &mut bytes).expect("writing to memory cannot fail");
                (bytes, merges(&mesh, name, small(threads)))
            };
            let one = bytes(1);
            assert!(one == bytes(2) && one == bytes(16), "{name} on {what}");
        }
    }
}

#[test]
fn every_law_holds_on_what_regions_make() {
    let options = verify::Options { fronts: 12, ..verify::Options::default() };
    for (what, mesh) in meshes() {
        for name in OPERATORS {
            let (model, ended) = cells(&mesh, name, &Options::default(), small(2));
            assert_eq!(ended.stopped, Stopped::Exhausted);
            let held = verify::explicit(&model, &options, &mut |_| true);
            held.unwrap_or_else(|found| panic!("{name} on {what}: {}", found.breach));
            let sequence = merges(&mesh, name, small(2));
            assert_eq!(sequence.node_count(), model.len(), "{name} on {what}");
            let replay = std::sync::Arc::new(Replay::new(&mesh, &[], &sequence).expect("a sequence"));
            for scheme in [Scheme::OneRing, Scheme::DualPiece, Scheme::ImplicitIds] {
                let held = verify::scheme(&replay, scheme, &options, &mut |_| true).expect("merges of manifolds");
                held.unwrap_or_else(|found| panic!("{name}, {scheme} on {what}: {}", found.breach));
            }
        }
    }
}

/// Boundaries that are locked stay, and attributes go to the vertices that they are given for.
#[test]
fn what_is_known_of_a_vertex_stays_with_it() {
    use operators::edge_collapse::{BoundaryRule, EdgeCollapse};
    use operators::metric::QuadricAttributes;
    let mesh = generate::bumpy_grid(40, 30, 0.0, 1);
    let model = |operator: &dyn Fn(&mut Recorder<3>) -> Result<Ended, AnalysisError>| {
        let mut recorder = Recorder::new(&mesh).unwrap();
        operator(&mut recorder).unwrap();
        recorder.finish(ErrorKind::Estimate).unwrap()
    };
    let options = Options { until_cells: Some(300), ..Options::default() };
    let locked = EdgeCollapse { boundary: BoundaryRule::Locked, ..EdgeCollapse::FULL };
    let left = model(&|heard| {
        mt_core::analysis::analyse_by_regions(&mesh, &locked, &options, &small(2), heard, &mut |_| true)
    });
    let boundary = |cells: &[[mt_core::VertexId; 3]], of: usize| mt_core::Complex::new(of, cells).boundary();
    let base: Vec<_> = left.base_cells().iter().map(|cell| *left.corners(*cell)).collect();
    assert_eq!(boundary(&base, left.positions().len()), boundary(&mesh.cells, mesh.positions.len()));
    // A step in colour along a line of a flat sheet: no triangle reaches across it from far.
    let colours: Vec<[f32; 3]> = mesh.positions.iter().map(|p| [f32::from(p.x > 20.0), 0.0, 0.0]).collect();
    let coloured = EdgeCollapse::FULL.with(QuadricAttributes { attributes: Some(colours.into()), weight: 1.0 });
    let left = model(&|heard| {
        mt_core::analysis::analyse_by_regions(&mesh, &coloured, &options, &small(2), heard, &mut |_| true)
    });
    let across = left.base_cells().iter().filter(|cell| {
        let x = left.corners(**cell).map(|v| left.positions()[v.index()].x);
        x.iter().any(|&x| x < 18.0) && x.iter().any(|&x| x > 23.0)
    });
    assert_eq!(across.count(), 0, "triangles reach across the step");
}

/// Both listeners hear the same story: where vertices are put, one after the other.
#[test]
fn cells_and_merges_are_told_alike() {
    let mesh = generate::bumpy_sphere(4, 0.15, 2);
    let (model, _) = cells(&mesh, "edge-collapse", &Options::default(), small(1));
    let sequence = merges(&mesh, "edge-collapse", small(1));
    assert_eq!(model.positions()[mesh.vertex_count()..], sequence.positions);
    assert!(model.len() > 1000 && model.base_cells().len() == 4);
}

/// As coarse as one queue for all makes it, and not much further from the input on the way.
#[test]
fn little_is_lost_against_one_queue() {
    let mesh = generate::genus_surface(2, 22, 0.05, 7);
    let surface = Surface::new(&mesh).expect("a surface");
    let away = |model: &Explicit<3>| {
        let limits = selective::Limits { cells: Some(mesh.cell_count() as u32 / 10), time: None };
        let all = selective::UniformError { error_max: -1.0 };
        let (state, _) = selective::extract(model, &all, &limits, selective::Strategy::Priority, ());
        let tenth = mt_core::model::mesh_of(model, &state.view.mesh);
        Surface::new(&tenth).expect("a surface").distance(&surface, Sampling::default()).rms()
    };
    let mut recorder = Recorder::new(&mesh).unwrap();
    operator("edge-collapse").analyse(&mesh, &Options::default(), &mut recorder, &mut |_| true).unwrap();
    let whole = recorder.finish(ErrorKind::Estimate).unwrap();
    let (parted, _) = cells(&mesh, "edge-collapse", &Options::default(), Regions { vertices: 1024, threads: 2 });
    assert!(parted.base_cells().len() <= whole.base_cells().len() + 4);
    let (whole, parted) = (away(&whole), away(&parted));
    println!("a tenth of {} triangles: {whole:e} as a whole, {parted:e} by regions", mesh.cell_count());
    assert!(parted <= 1.1 * whole, "{parted:e} is more than {whole:e} and a tenth");
}

#[test]
fn wishes_stop_it_where_they_say() {
    let mesh = generate::bumpy_sphere(4, 0.15, 2);
    for wanted in [5000, 2000, 500, 100, 20] {
        let options = Options { until_cells: Some(wanted), ..Options::default() };
        let (model, ended) = cells(&mesh, "edge-collapse", &options, small(2));
        assert_eq!(ended.stopped, Stopped::Cells);
        let left = model.base_cells().len() as u32;
        assert!(left <= wanted && left + 2 >= wanted, "{wanted} wanted, {left} left");
    }
    let options = Options { until_error: Some(0.01), ..Options::default() };
    let (model, ended) = cells(&mesh, "edge-collapse", &options, small(2));
    assert_eq!(ended.stopped, Stopped::Error);
    assert!(model.parts().bounds.iter().all(|bound| bound.error <= 0.01) && model.base_cells().len() > 20);
}

#[test]
fn whoever_watches_can_stop_it() {
    let mesh = generate::terrain(60, 0.55, 7);
    for patience in [0, 1, 2, 5] {
        let mut recorder = Recorder::new(&mesh).unwrap();
        let mut heard = 0;
        let mut before = mesh.cell_count();
        let mut watch = |at: mt_core::analysis::Progress| {
            assert!(at.cells_in == mesh.cell_count() && at.cells <= before);
            (heard, before) = (heard + 1, at.cells);
            heard <= patience
        };
        let options = Options::default();
        let ended = operator("edge-collapse").analyse_by_regions(&mesh, &options, &small(2), &mut recorder, &mut watch);
        assert_eq!((ended.unwrap().stopped, heard), (Stopped::Cancelled, patience + 1));
        // What was told by then is a history.
        recorder.finish(ErrorKind::Estimate).unwrap();
    }
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let analyse = |mesh: &Mesh<3>, options: Options| {
        let mut recorder = Recorder::new(mesh).unwrap();
        let ended =
            operator("edge-collapse").analyse_by_regions(mesh, &options, &small(1), &mut recorder, &mut |_| true);
        ended.map(|ended| ended.stopped)
    };
    let measured = Options { error_kind: ErrorKind::Measured, ..Options::default() };
    assert_eq!(analyse(&generate::torus(20, 12), measured), Err(AnalysisError::MeasuredByRegions));
    // Where the mesh is no manifold is told by the numbers that the caller knows.
    let book = generate::components(&[generate::torus(20, 12), generate::fan3()]);
    let Err(AnalysisError::Unfit(Unfit::NonManifold { edges, edge_places, .. })) = analyse(&book, Options::default())
    else {
        panic!("three triangles at an edge are no manifold");
    };
    assert!(edges == 1 && edge_places.contains("240-241"), "{edge_places}");
    assert_eq!(analyse(&Mesh { positions: Vec::new(), cells: Vec::new() }, Options::default()), Ok(Stopped::Exhausted));
}
