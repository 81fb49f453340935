//! An operator of one's own, and what comes with it: triangle collapse (`[Gieng1998]`).
//!
//! The three corners of a triangle become one vertex. The operator is the first part of this file; `main` coarsens a
//! mesh by it, refines the model for a camera, has every law checked and studies it beside edge collapse.
//!
//! `cargo run --release --example triangle_collapse`

use glam::Vec3;
use multi_tessellation::mt_core::analysis::{Draft, Operator, Options, Unfit, analyse, simplify};
use multi_tessellation::mt_core::cell::is_proper;
use multi_tessellation::mt_core::hierarchy::Dependency;
use multi_tessellation::mt_core::mesh::area_vector;
use multi_tessellation::mt_core::{Camera, Cell, Explicit, Hierarchy, Mesh, MultiTessellation, Plan, Refusal};
use multi_tessellation::mt_core::{Replay, Sequence, VertexId, generate};
use multi_tessellation::operators::AnyOperator;
use multi_tessellation::operators::metric::Quadric;
use multi_tessellation::operators::order::{DualPieceFree, ImplicitIds, Scheme};
use multi_tessellation::papers::study::{self, Config, NoCache, Subject};
use multi_tessellation::selective::{Limits, ScreenError, State, Strategy, UniformError, adapt, extract};
use multi_tessellation::verify;
use std::collections::BTreeSet;
use std::sync::Arc;

// The operator

/// A triangle becomes a vertex, where quadrics like it best; triangles with a corner on the boundary stay.
#[derive(Copy, Clone, Debug)]
struct TriangleCollapse;

impl Operator<3> for TriangleCollapse {
    type Site = Cell<3>;
    /// Of each vertex: whether it is on the boundary, and its quadric.
    type Aux = Vec<(bool, Quadric)>;

    fn name(&self) -> &'static str {
        "triangle-collapse"
    }

    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Cell<3>>) -> Result<Self::Aux, Unfit> {
        let mut aux = vec![(false, Quadric::default()); draft.positions.len()];
        for (_, &cell) in draft.complex.cells() {
            let quadric = Quadric::of_triangle(cell.map(|v| draft.positions[v.index()].as_dvec3()));
            cell.iter().for_each(|v| aux[v.index()].1 += quadric);
            sites.push(cell);
        }
        let boundary = draft.complex.boundary();
        boundary.iter().flat_map(|facet| facet.vertices()).for_each(|v| aux[v.index()].0 = true);
        Ok(aux)
    }

    fn price(&self, draft: &Draft<3>, aux: &Self::Aux, site: Cell<3>) -> Option<f64> {
        merged(draft, aux, site).map(|(position, quadric)| quadric.value(position.as_dvec3()))
    }

    fn plan(&self, draft: &Draft<3>, aux: &Self::Aux, site: Cell<3>, plan: &mut Plan<3>) -> Result<(), Refusal> {
        let (position, quadric) = merged(draft, aux, site).ok_or(Refusal::Stale)?;
        if site.iter().any(|v| aux[v.index()].0) {
            return Err(Refusal::Boundary);
        }
        let new = VertexId::new(draft.positions.len());
        let at = |v: VertexId| if v == new { position } else { draft.positions[v.index()] }.as_dvec3();
        let (mut dying, mut rim) = (BTreeSet::new(), BTreeSet::new());
        for (slot, _) in site.iter().flat_map(|&v| draft.complex.star(v)) {
            let old = *draft.complex.cell(slot);
            let cell = old.map(|v| if site.contains(&v) { new } else { v });
            if !is_proper(&cell) {
                dying.insert(slot);
                continue;
            }
            let [before, after] = [old, cell].map(|corners| area_vector(corners.map(at)));
            if before.dot(after) <= 0.2 * before.length() * after.length() {
                return Err(Refusal::FoldOver);
            }
            rim.extend(cell.into_iter().filter(|v| *v != new));
            plan.kills.push(slot);
            plan.makes.push(cell);
        }
        // A patch that loses four triangles, and whose rim of so many edges passes as many vertices, is by Euler's
        // formula a disc; so is what replaces it. Two edges are no rim.
        if dying.len() != 4 || rim.len() != plan.makes.len() || rim.len() < 3 {
            return Err(Refusal::Link);
        }
        plan.kills.extend(dying);
        plan.vertices.push(position);
        plan.error = quadric.distance(position.as_dvec3()) as f32;
        // A corner with three triangles goes first: so each of the two merges is a legal edge collapse by itself.
        plan.retired.extend(site);
        plan.retired.sort_by_key(|&v| draft.complex.star(v).nth(3).is_some());
        Ok(())
    }

    fn applied(&self, draft: &Draft<3>, aux: &mut Self::Aux, plan: &Plan<3>, again: &mut Vec<Cell<3>>) {
        let new = VertexId::new(aux.len());
        aux.push((false, plan.retired.iter().fold(Quadric::default(), |sum, v| sum + aux[v.index()].1)));
        again.extend(draft.complex.star(new).map(|(slot, _)| *draft.complex.cell(slot)));
    }
}

/// Where a triangle becomes a vertex (the best place, unless that is far away), and its quadric; none if it is gone.
fn merged(draft: &Draft<3>, aux: &[(bool, Quadric)], site: Cell<3>) -> Option<(Vec3, Quadric)> {
    draft.complex.star(site[0]).find(|(slot, _)| *draft.complex.cell(*slot) == site)?;
    let [a, b, c] = site.map(|v| draft.positions[v.index()].as_dvec3());
    let quadric = site.iter().fold(Quadric::default(), |sum, v| sum + aux[v.index()].1);
    let (middle, reach) = ((a + b + c) / 3.0, a.distance(b).max(b.distance(c)).max(c.distance(a)));
    let best = quadric.minimum().filter(|p| p.distance(middle) <= reach).unwrap_or(middle);
    Some((best.as_vec3(), quadric))
}

// What comes with it

/// How much of the laws to check.
const LAWS: verify::Options = verify::Options { fronts: 50, seed: 1, topology: verify::Topology::Kept };

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn main() -> Outcome {
    let mesh = generate::bumpy_sphere(5, 0.1, 7);
    println!("input: {} triangles", mesh.cell_count());

    let analysis = simplify(&mesh, &TriangleCollapse, &Options::default(), &mut |_| true)?;
    let refused: Vec<String> = analysis.refusals.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let model = analysis.model;
    println!(
        "model: {} collapses down to {} triangles; refused: {}",
        model.len(),
        model.base_cells().len(),
        refused.join(", ")
    );

    refine(&model);

    let checked = verify::explicit(&model, &LAWS, &mut |_| true).map_err(|found| found.breach.to_string())?;
    let checked: Vec<String> = checked.iter().map(|(law, times)| format!("{law} {times}")).collect();
    println!("laws that held, and how often: {}", checked.join(", "));
    hierarchies(&mesh)?;
    study(mesh)
}

/// Selective refinement: for an error everywhere, and for a camera that then moves.
fn refine(model: &Explicit<3>) {
    let wish = UniformError { error_max: 0.005 };
    let (everywhere, _) = extract(model, &wish, &Limits::NONE, Strategy::TopDown, ());
    println!("error {} everywhere: {} triangles", wish.error_max, everywhere.cell_count(model));

    let mut view = State::new(model, ());
    for step in 0..3 {
        let from = Vec3::new(1.0, 0.3 * step as f32, 0.5);
        let camera = Camera::around(Vec3::splat(-1.0), Vec3::splat(1.0), from);
        let outcome = adapt(model, &ScreenError::new(&camera, 1.0), &Limits::NONE, &mut view);
        let (finer, coarser) = (outcome.refined, outcome.coarsened);
        println!("camera {step}: {} triangles, {finer} refined, {coarser} coarsened", view.cell_count(model));
    }
}

/// The same sequence as a vertex hierarchy, in which a collapse is two nodes, under every scheme.
fn hierarchies(mesh: &Mesh<3>) -> Outcome {
    let mut sequence = Sequence::new(mesh);
    analyse(mesh, &TriangleCollapse, &Options::default(), &mut sequence, &mut |_| true)?;
    let replay = Arc::new(Replay::new(mesh, &[], &sequence)?);
    let sewn = replay.sewn().len();
    println!("hierarchy: {} merges of {} nodes, {sewn} of them sew or pinch", replay.merge_count(), replay.len());
    for scheme in Scheme::ALL {
        if let Some(order) = scheme.stored(&replay)? {
            laws_of(scheme.name(), &replay, order)?;
        }
    }
    laws_of("implicit-ids", &replay, ImplicitIds)?;
    laws_of("dual-piece-free", &replay, DualPieceFree::new(&replay)?)
}

fn laws_of<D: Dependency + Send>(name: &str, replay: &Arc<Replay>, dependency: D) -> Outcome {
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    let checked = verify::hierarchy(&model, &LAWS, &mut |_| true).map_err(|found| found.breach.to_string())?;
    println!("  {name:16} {} laws held, {} times in all", checked.len(), checked.values().sum::<u64>());
    Ok(())
}

/// The study, beside edge collapse: the same camera path, the same table.
fn study(mesh: Mesh<3>) -> Outcome {
    let config = Config {
        operators: vec!["edge-collapse".parse()?, AnyOperator::yours(TriangleCollapse)],
        frames: 10,
        picture_px: None,
        ..Config::default()
    };
    let subject = Subject { name: "sphere".into(), mesh };
    let results = study::run(&[subject], &config, &mut NoCache, &mut |_, _| true)?;
    println!("study: {} frames under {} dependencies", results.observations.len(), config.dependencies.len());
    for built in &results.built {
        let (base, bytes) = (built.triangles_base, built.bytes_per_vertex);
        println!("  {}: base of {base} triangles, {bytes:.0} bytes a vertex", built.operator);
    }
    for quality in &results.qualities {
        println!(
            "  {} at {} triangles: distance {:.1e} of the extent",
            quality.operator, quality.triangles, quality.rms
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use multi_tessellation::mt_core::Recorder;

    #[test]
    fn every_law_holds_on_meshes_of_every_kind() {
        let options = verify::Options { fronts: 8, seed: 3, topology: verify::Topology::Kept };
        let mut collapses = 0;
        for seed in 0..48 {
            let generate::Named { name, mesh } = generate::random_mesh(seed);
            assert_eq!(verify::determinism(&mesh, &TriangleCollapse), Ok(()), "{name}");
            let mut listener = (Recorder::new(&mesh).unwrap(), Sequence::new(&mesh));
            analyse(&mesh, &TriangleCollapse, &Options::default(), &mut listener, &mut |_| true).unwrap();
            let model = listener.0.finish(Default::default()).unwrap();
            collapses += model.len();
            let verdict = verify::explicit(&model, &options, &mut |_| true);
            verdict.unwrap_or_else(|found| panic!("{name}: {}", found.breach));
            let replay = Arc::new(Replay::new(&mesh, &[], &listener.1).unwrap());
            assert_eq!(replay.sewn(), [], "{name}: a merge of two is no legal edge collapse");
            assert_eq!((replay.merge_count(), replay.len()), (model.len(), 2 * model.len()), "{name}");
            let check = |scheme: &str, verdict: Result<_, Box<verify::Counterexample<3>>>| {
                let _: verify::Summary = verdict.unwrap_or_else(|found| panic!("{name}, {scheme}: {}", found.breach));
            };
            for scheme in Scheme::ALL {
                if let Some(dependency) = scheme.stored(&replay).unwrap() {
                    let model = Hierarchy { replay: Arc::clone(&replay), dependency };
                    check(scheme.name(), verify::hierarchy(&model, &options, &mut |_| true));
                }
            }
            let model = Hierarchy { replay: Arc::clone(&replay), dependency: ImplicitIds };
            check("implicit-ids", verify::hierarchy(&model, &options, &mut |_| true));
        }
        assert!(collapses > 1000, "{collapses}");
    }

    #[test]
    fn the_base_mesh_is_small() {
        let closed =
            [generate::bumpy_sphere(4, 0.1, 7), generate::torus(32, 16), generate::genus_surface(2, 10, 0.02, 7)];
        for mesh in closed {
            let model = simplify(&mesh, &TriangleCollapse, &Options::default(), &mut |_| true).unwrap().model;
            let (base, input) = (model.base_cells().len(), mesh.cell_count());
            assert!(base * 20 < input, "{base} of {input}");
        }
    }

    #[test]
    fn what_surrounds_no_disc_stays() {
        // Nothing surrounds a triangle of a tetrahedron but one vertex; the others have nothing inside.
        for mesh in [generate::tetrahedron(), generate::triangle(), generate::strip(6), generate::fan3()] {
            let model = simplify(&mesh, &TriangleCollapse, &Options::default(), &mut |_| true).unwrap().model;
            assert_eq!(model.len(), 0);
        }
    }

    #[test]
    fn it_is_studied_beside_ours() {
        study(generate::bumpy_sphere(3, 0.1, 7)).unwrap();
    }
}
