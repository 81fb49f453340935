//! Cells of four corners: the same recorder, orders, engine, container and laws, on a tetrahedral history.

use mt_core::analysis::{Options, simplify};
use mt_core::model::mesh_of;
use mt_core::{
    CellId, ErrorKind, Explicit, Mesh, MultiTessellation, Recorder, VertexId, check, container, generate, history,
};
use mt_tests::VertexIntoNeighbour;
use multi_tessellation::verify;
use selective::{Limits, Strategy, UniformError, extract};

fn model(n: u32) -> (Mesh<4>, Explicit<4>) {
    let mesh = generate::tetrahedral_box(n as _);
    let model = simplify(&mesh, &VertexIntoNeighbour, &Options::default(), &mut |_| true).unwrap().model;
    (mesh, model)
}

#[test]
fn every_law_holds_on_a_box_of_tetrahedra() {
    let (mesh, model) = model(5);
    assert!(model.len() > 30, "only {} inner vertices went", model.len());
    check::ends(&model, &mesh).unwrap();
    let domain = check::conformity(&model).unwrap();
    assert!(domain.manifold && domain.oriented && domain.content.is_some());
    verify::explicit(&model, &verify::Options { fronts: 60, seed: 3, ..verify::Options::default() }, &mut |_| true)
        .unwrap_or_else(|found| panic!("{}", found.breach));
}

#[test]
fn a_history_recorded_by_hand() {
    // Four tetrahedra around an inner vertex lose it.
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.2, 0.2]];
    let mesh = Mesh::from_indices(
        corners.map(glam::Vec3::from).to_vec(),
        &[[4, 1, 2, 3], [0, 4, 2, 3], [0, 1, 4, 3], [0, 1, 2, 4]],
    );
    let mut recorder = Recorder::new(&mesh).unwrap();
    (0..4).for_each(|cell| recorder.kill(CellId(cell)).unwrap());
    recorder.make([0, 1, 2, 3].map(VertexId)).unwrap();
    recorder.end(0.5).unwrap();
    let model = recorder.finish(ErrorKind::Measured).unwrap();
    verify::explicit(&model, &verify::Options { fronts: 4, seed: 1, ..verify::Options::default() }, &mut |_| true)
        .unwrap_or_else(|found| panic!("{}", found.breach));
    let (state, _) = extract(&model, &UniformError { error_max: 0.6 }, &Limits::NONE, Strategy::TopDown, ());
    assert_eq!(mesh_of(&model, &state.view.mesh).cell_count(), 1);
}

#[test]
fn turned_over_tetrahedra_are_caught() {
    let (_, good) = model(3);
    let mut parts = good.parts().clone();
    let first_made = good.input_cell_count() as usize;
    // Two corners swapped turn one made cell inside out.
    parts.corners[first_made].swap(0, 1);
    let bad = Explicit::from_parts(parts).unwrap();
    assert!(
        verify::explicit(&bad, &verify::Options { fronts: 40, seed: 1, ..verify::Options::default() }, &mut |_| true)
            .is_err()
    );
}

#[test]
fn containers_and_histories_round_trip() {
    let (mesh, model) = model(4);
    let mut bytes = Vec::new();
    container::write(&model, &container::Meta::default(), &mut bytes).unwrap();
    assert_eq!(container::read::<4>(&bytes).unwrap().0, model);
    assert!(matches!(container::read::<3>(&bytes), Err(container::ContainerError::Corners { found: 4, wanted: 3 })));
    let mut text = Vec::new();
    history::write(&model, &mut text).unwrap();
    assert_eq!(history::read(&mesh, text.as_slice()).unwrap(), model);
}
