//! The models on which the machine plays: explicit ones of every operator, and hierarchies under every scheme.

use super::engine::Engine;
use super::ops::Op;
use super::rig::{Kit, play};
use crate::truth::{Cells, Merges, UnderScheme};
use crate::{History, VertexIntoNeighbour};
use glam::Vec3;
use mt_core::analysis::{Options, simplify};
use mt_core::container;
use mt_core::generate::{self, Named};
use mt_core::hierarchy::Dependency;
use mt_core::random::Random;
use mt_core::{Explicit, Hierarchy, Mesh, MultiTessellation, Replay, Sequence};
use operators::AnyOperator;
use operators::order::{DualPieceFree, ImplicitIds, Scheme, StoredIds};
use std::sync::Arc;

/// Operators of triangles by name.
pub const OPERATORS: [&str; 6] = [
    "edge-collapse",
    "half-edge-collapse",
    "fan-merge",
    "vertex-pair",
    "edge-collapse/edge-length",
    "vertex-pair/edge-length",
];

/// A random mesh of at most so many triangles, and of more than one.
pub fn small_mesh(seed: u64, most: usize) -> Named {
    let mut random = Random::new(seed);
    loop {
        let named = generate::random_mesh(random.bits());
        if (2..=most).contains(&named.mesh.cell_count()) {
            return named;
        }
    }
}

/// The history of a mesh, and the one that stops halfway: two models of one input.
fn histories(mesh: &Mesh<3>, operator: &str) -> [History; 2] {
    let operator: AnyOperator = operator.parse().expect("an operator");
    let halfway = Options { until_cells: Some(mesh.cell_count() as u32 / 2), ..Options::default() };
    [Options::default(), halfway].map(|options| History::new(mesh, &operator, &options).expect("manifolds are taken"))
}

fn explicit_kit<const N: usize>(model: Explicit<N>) -> Kit<N, Explicit<N>, Cells<N>> {
    let truth = Cells::new(&model);
    let original = model.clone();
    let reload = move || {
        let mut bytes = Vec::new();
        container::write(&original, &Default::default(), &mut bytes).expect("memory takes everything");
        let (model, _) = container::read::<N>(&bytes).expect("what was written is a model");
        assert!(model == original, "another model was read than was written");
        model
    };
    let (cells, leaves) = (model.input_cell_count() as usize, model.input_vertex_count() as usize);
    Kit::new(model, truth, cells, leaves, Box::new(reload))
}

/// Plays on the explicit models of a mesh.
pub fn on_cells(mesh: &Mesh<3>, operator: &str, engine: Engine, ops: &[Op]) -> Result<(), String> {
    play(&histories(mesh, operator).map(|history| explicit_kit(history.explicit)), engine, ops)
}

/// A box of tetrahedra with its inner vertices moved a little, and so many of its layers.
fn shaken_box(layers: usize, seed: u64) -> Mesh<4> {
    let mut random = Random::new(seed);
    let mut mesh = generate::tetrahedral_box(layers);
    let most = layers as f32;
    for p in &mut mesh.positions {
        if p.min_element() > 0.0 && p.max_element() < most {
            *p += Vec3::from_array([(); 3].map(|()| random.between(-0.2, 0.2) as f32));
        }
    }
    mesh
}

/// Plays on the explicit models of a box of tetrahedra.
pub fn on_tetrahedra(seed: u64, engine: Engine, ops: &[Op]) -> Result<(), String> {
    let mesh = shaken_box(2 + (seed % 3) as usize, seed);
    let halfway = Options { until_cells: Some(mesh.cell_count() as u32 * 3 / 4), ..Options::default() };
    let models = [Options::default(), halfway].map(|options| {
        simplify(&mesh, &VertexIntoNeighbour, &options, &mut |_| true).expect("a box of tetrahedra is taken").model
    });
    play(&models.map(explicit_kit), engine, ops)
}

/// Plays on the implicit ids of full collapses, of which everything is claimed that holds of an order.
pub fn on_ids_as_one_ring(mesh: &Mesh<3>, engine: Engine, ops: &[Op]) -> Result<(), String> {
    let histories = histories(mesh, "edge-collapse");
    under(&histories, Scheme::OneRing, |_| Some(ImplicitIds), engine, ops).expect("ids take everything")
}

/// Plays on the hierarchies of a mesh under a scheme; `None` where the scheme does not take them.
pub fn on_merges(
    mesh: &Mesh<3>,
    operator: &str,
    scheme: Scheme,
    engine: Engine,
    ops: &[Op],
) -> Option<Result<(), String>> {
    let histories = histories(mesh, operator);
    match scheme {
        Scheme::ImplicitIds => under(&histories, scheme, |_| Some(ImplicitIds), engine, ops),
        Scheme::ImplicitIdsStored => under(&histories, scheme, |replay| StoredIds::new(replay).ok(), engine, ops),
        Scheme::DualPieceFree => under(&histories, scheme, |replay| DualPieceFree::new(replay).ok(), engine, ops),
        _ => under(&histories, scheme, move |replay| scheme.stored(replay).ok()?, engine, ops),
    }
}

/// Plays on hierarchies under a dependency, judged by what a scheme is by definition.
fn under<D: Dependency + Clone + Send + 'static>(
    histories: &[History; 2],
    scheme: Scheme,
    derive: impl Fn(&Replay) -> Option<D> + Copy + 'static,
    engine: Engine,
    ops: &[Op],
) -> Option<Result<(), String>> {
    let kit = |history: &History| {
        let replay = history.replay();
        let model = Hierarchy { dependency: derive(&replay)?, replay };
        let merges = Arc::new(Merges::new(&history.mesh, &history.links, &history.sequence));
        let original = history.clone();
        let reload = move || {
            let sequence = Sequence::from_bytes(&original.sequence.to_bytes()).expect("what was written is a sequence");
            let reread = History { sequence, ..original.clone() };
            let replay = reread.replay();
            assert!(replay == original.replay(), "another replay was read than was written");
            Hierarchy { dependency: derive(&replay).expect("the scheme took it before"), replay }
        };
        let (cells, leaves) = (history.mesh.cell_count(), history.mesh.vertex_count());
        Some(Kit::new(model, UnderScheme::new(merges, scheme), cells, leaves, Box::new(reload)))
    };
    let kits = [kit(&histories[0])?, kit(&histories[1])?];
    debug_assert_eq!(kits[0].model.len() as usize, kits[0].bounds.len());
    Some(play(&kits, engine, ops))
}
