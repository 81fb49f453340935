//! Faults planted in a replay, each seen by the law that is there for it.

use super::replay::Born;
use super::{Replay, Sequence};
use crate::check::{self, Law};
use crate::front::Front;
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use crate::{Bits, generate};
use glam::Vec3;

/// An icosahedron after two edge collapses, the second at the vertex that the first made.
fn sample() -> (Mesh<3>, Replay) {
    let mesh = generate::icosahedron();
    let mut sequence = Sequence::new(&mesh);
    let [a, b, _] = mesh.cells[0];
    let merged = sequence.push(a, [b], [0.1], mesh.positions[a.index()].midpoint(mesh.positions[b.index()]), false);
    let around = |v: VertexId| mesh.cells.iter().filter(move |cell| cell.contains(&v)).flatten().copied();
    let next = around(a).find(|w| *w != a && *w != b && !around(b).any(|x| x == *w)).expect("a neighbour of one end");
    sequence.push(merged, [next], [0.2], Vec3::ZERO, false);
    let replay = Replay::new(&mesh, &[], &sequence).expect("a sequence");
    (mesh, replay)
}

/// Whether the mesh of each front that steps reach is the quotient.
fn is_quotient(replay: &Replay) -> bool {
    let mut mesh = replay.reference_mesh();
    let mut front = Front::reference(replay.len());
    let mut good = true;
    for m in (0..replay.len()).map(NodeId) {
        replay.coarsen(m, &mut mesh, &mut ());
        front.set(m, false);
    }
    for m in (0..replay.len()).rev().map(NodeId) {
        replay.refine(m, &mut mesh, &mut ());
        front.set(m, true);
        let cells: Vec<_> = mesh.faces.cells().map(|(slot, corners)| (CellId(slot), *corners)).collect();
        good &= cells == check::quotient(replay, &front);
    }
    good
}

#[test]
fn a_good_replay_is_good() {
    let (mesh, replay) = sample();
    assert!(is_quotient(&replay) && replay.is_manifold() && replay.reference() == mesh);
    assert_eq!(check::patch_bounds(&replay), Ok(()));
    assert_eq!(check::dual_pieces(&replay, &Front::base(replay.len())), Ok(()));
}

#[test]
fn swapped_ranks_are_seen_by_the_quotient() {
    let (mesh, mut replay) = sample();
    let [a, b, _] = mesh.cells[0].map(|v| v.index());
    replay.ranks.swap(a, b);
    assert!(!is_quotient(&replay));
}

#[test]
fn a_piece_that_is_not_where_it_should_be_is_seen_by_the_partition() {
    let (_, mut replay) = sample();
    replay.merges[1].span.first += 1;
    let breach = check::dual_pieces(&replay, &Front::base(replay.len())).unwrap_err();
    assert_eq!(breach.law, Law::Partition);
}

#[test]
fn a_triangle_of_the_wrong_node_is_seen_by_the_quotient() {
    let (_, mut replay) = sample();
    let Born::Pairs(pairs) = &mut replay.born else { panic!("edge collapses of a manifold") };
    let other = (0..20).map(CellId).find(|cell| !pairs.iter().flatten().any(|c| c == cell)).expect("twenty triangles");
    // Coarsening takes away what it should not, and refining would bring it back: only the coarse mesh is wrong.
    pairs[1][0] = other;
    let mut mesh = replay.reference_mesh();
    replay.coarsen(NodeId(0), &mut mesh, &mut ());
    replay.coarsen(NodeId(1), &mut mesh, &mut ());
    let cells: Vec<_> = mesh.faces.cells().map(|(slot, corners)| (CellId(slot), *corners)).collect();
    assert_ne!(cells, check::quotient(&replay, &Front::base(replay.len())));
}

#[test]
fn spheres_and_cones_that_are_too_small_are_seen() {
    let (_, mut replay) = sample();
    replay.nodes[1].radius = 0.5;
    assert_eq!(check::patch_bounds(&replay).unwrap_err().law, Law::Saturation);
    let (_, mut replay) = sample();
    replay.nodes[0].cone = crate::Cone::new(Vec3::X, 0.0);
    assert_eq!(check::patch_bounds(&replay).unwrap_err().law, Law::Saturation);
}

#[test]
fn what_sews_is_known() {
    // Two triangles side by side, merged at opposite corners: no edge of theirs, and no umbrella afterwards.
    let mesh = generate::components(&[generate::triangle(), generate::triangle()]);
    let mut sequence = Sequence::new(&mesh);
    sequence.push(VertexId(0), [VertexId(3)], [0.0], Vec3::ZERO, false);
    let replay = Replay::new(&mesh, &[], &sequence).unwrap();
    assert_eq!(replay.sewn(), [NodeId(0)]);
}

#[test]
fn sequences_that_are_none_are_refused() {
    let mesh = generate::octahedron();
    let refused = |change: &dyn Fn(&mut Sequence)| {
        let mut sequence = Sequence::new(&mesh);
        sequence.push(VertexId(0), [VertexId(2)], [0.1], Vec3::ZERO, false);
        change(&mut sequence);
        Replay::new(&mesh, &[], &sequence).map(|_| ()).unwrap_err().to_string()
    };
    for (change, says) in [
        (&(|s: &mut Sequence| s.children[0] = VertexId(0)) as &dyn Fn(&mut Sequence), "merged already"),
        (&|s| s.centers[0] = VertexId(6), "not made yet"),
        (&|s| s.errors[0] = f32::NAN, "error"),
        (&|s| s.errors.clear(), "errors"),
        (&|s| s.positions[0] = Vec3::splat(f32::INFINITY), "position"),
        (&|s| s.starts = vec![0, 0], "runs"),
        (&|s| s.starts.clear(), "runs"),
        (&|s| s.input_vertex_count = 7, "7 vertices"),
        (&|s| s.kept = Bits::full(1), "moves it"),
    ] {
        let told = refused(change);
        assert!(told.contains(says), "{told}");
    }
    let sequence = Sequence::new(&mesh);
    assert!(Replay::new(&mesh, &[[VertexId(0), VertexId(0)]], &sequence).is_err());
    assert!(Replay::new(&mesh, &[[VertexId(0), VertexId(9)]], &sequence).is_err());
}
