//! Vertex hierarchies under every dependency scheme: all laws, and how the schemes relate.

use mt_core::check::Law;
use mt_core::generate::{self, Named};
use mt_core::hierarchy::Dependency;
use mt_core::hierarchy::VertexMesh;
use mt_core::model::{MultiTessellation, cells_of};
use mt_core::random::Random;
use mt_core::{Coarsen, Front, Hierarchy, NodeId, Order, Replay, Rule, Sequence, VertexId, View, check};
use mt_tests::{both_of, replay_of};
use multi_tessellation::verify::{self, Topology};
use operators::fan_merge::BelowStall;
use operators::metric::{AnyMetric, Quadrics};
use operators::order::{DualPieceFree, ImplicitIds, Scheme, Stored, StoredIds};
use operators::vertex_pair::Preference;
use operators::{AnyOperator, EdgeCollapse, FanMerge, VertexPair};
use proptest::prelude::*;
use selective::State;
use std::sync::Arc;

fn laws_hold<D: Dependency + Send>(name: &str, replay: &Arc<Replay>, dependency: D, seed: u64, fronts: u32) {
    hold_under(verify::Options { fronts, seed, topology: Topology::Kept }, name, replay, dependency);
}

fn hold_under<D: Dependency + Send>(options: verify::Options, name: &str, replay: &Arc<Replay>, dependency: D) {
    let model = Hierarchy { replay: Arc::clone(replay), dependency };
    if let Err(found) = verify::hierarchy(&model, &options, &mut |_| true) {
        panic!("{name}: {} at a front of {} nodes (found at {})", found.breach, found.front.len(), found.found.front);
    }
}

fn all_laws(name: &str, replay: &Arc<Replay>, seed: u64, fronts: u32) {
    for scheme in Scheme::ALL {
        if let Some(stored) = scheme.stored(replay).expect("a manifold") {
            laws_hold(&format!("{name} {scheme}"), replay, stored, seed, fronts);
        }
    }
    laws_hold(&format!("{name} implicit-ids"), replay, ImplicitIds, seed, fronts);
    // Stored ids are unsound (see their documentation), so no law is asked of them here.
    assert_eq!(StoredIds::new(replay).is_err(), !replay.is_single(), "{name}: fans and nothing else are refused");
    laws_hold(&format!("{name} dual-piece-free"), replay, DualPieceFree::new(replay).unwrap(), seed, fronts);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn every_law_holds_under_every_scheme(mesh_seed in any::<u64>(), half in any::<bool>(), seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let (_, replay) = both_of(&mesh, if half { &EdgeCollapse::HALF } else { &EdgeCollapse::FULL });
        all_laws(&name, &replay, seed, 8);
    }
}

fn fan(below_stall: BelowStall) -> AnyOperator {
    AnyOperator::FanMerge(FanMerge { below_stall, ..FanMerge::PARTIAL })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn every_law_holds_for_fans(mesh_seed in any::<u64>(), below in 0usize..3, seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let below = [BelowStall::Partial, BelowStall::Collapse, BelowStall::Stop][below];
        all_laws(&name, &replay_of(&mesh, &fan(below)), seed, 8);
    }

    #[test]
    fn every_law_holds_for_pairs(mesh_seed in any::<u64>(), equal in any::<bool>(), seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let preference = if equal { Preference::Equal } else { Preference::GeometryFirst };
        let quadric = AnyMetric::Quadric(Quadrics);
        let operator = AnyOperator::VertexPair(VertexPair { preference, ..VertexPair::default() }.with(quadric));
        let replay = replay_of(&mesh, &operator);
        let options = verify::Options { fronts: 8, seed, topology: Topology::Coarsened };
        for stored in [Stored::explicit(&replay), Stored::one_ring(&replay)] {
            hold_under(options, &name, &replay, stored);
        }
        hold_under(options, &name, &replay, ImplicitIds);
    }
}

#[test]
fn a_fan_is_one_step_or_a_run_of_steps() {
    // Whole runs in the order of analysis, and the same nodes one by one in the midst of others: one mesh.
    let mesh = generate::bumpy_sphere(3, 0.1, 6);
    let replay = replay_of(&mesh, &fan(BelowStall::Partial));
    assert!(!replay.is_single() && replay.merge_count() * 3 < replay.len());
    let order = Stored::dual_piece(&replay).unwrap();
    let model = Hierarchy { replay: Arc::clone(&replay), dependency: order };
    let mut random = Random::new(2);
    let mut state = State::new(&model, ());
    for _ in 0..200 {
        let m = NodeId::new(random.below(model.len() as usize));
        state.force(&model, m);
        assert_eq!(cells_of(&model, &state.view.mesh), check::quotient(&replay, state.front()));
    }
    let partial = (0..replay.merge_count()).filter(|&merge| {
        let (first, last) = replay.run_of(merge).into_inner();
        state.front().is_refined(last) && !state.front().is_refined(first)
    });
    assert!(partial.count() > 5, "no fan is merged in part");
}

#[test]
fn sewing_is_found_out_where_topology_is_said_to_be_kept() {
    // Two tetrahedra that nothing joins but a merge across the gap.
    let mesh = generate::components(&[generate::tetrahedron(), generate::tetrahedron()]);
    let mut sequence = Sequence::new(&mesh);
    sequence.push(VertexId(0), [VertexId(4)], [0.0], glam::Vec3::ZERO, false);
    let replay = Arc::new(Replay::new(&mesh, &[], &sequence).unwrap());
    let model = Hierarchy { dependency: Stored::one_ring(&replay), replay };
    let judge = |topology| verify::hierarchy(&model, &verify::Options { fronts: 4, seed: 1, topology }, &mut |_| true);
    assert_eq!(judge(Topology::Kept).unwrap_err().breach.law, Law::CrackFree);
    assert!(judge(Topology::Coarsened).is_ok());
}

#[test]
fn schemes_that_cut_refuse_pairs() {
    let boxes = generate::components(&[generate::octahedron(), generate::octahedron()]);
    let replay = replay_of(&boxes, &"vertex-pair".parse().unwrap());
    for scheme in [Scheme::FourFace, Scheme::DualPiece, Scheme::CutPair] {
        let refused = scheme.stored(&replay).unwrap_err().to_string();
        assert!(refused.contains("does not take this sequence"), "{refused}");
    }
    assert!(DualPieceFree::new(&replay).is_err());
}

/// A random wish, and what forcing it makes of the base mesh.
fn forced<D: Dependency + Send>(model: &Hierarchy<D>, wish: &[NodeId]) -> Front {
    let mut state = State::new(model, ());
    wish.iter().for_each(|&m| state.force(model, m));
    state.view.front
}

fn closed(order: &Order, wish: &[NodeId]) -> Front {
    let mut front = Front::from_nodes(order.len(), wish.iter().copied());
    order.close(&mut front);
    front
}

fn wishes(count: u32, seed: u64) -> Vec<Vec<NodeId>> {
    let mut random = Random::new(seed);
    let pick = |random: &mut Random| NodeId::new(random.below(count as usize));
    (0..12)
        .map(|_| {
            let picks = f64::from(count).powf(random.unit() * 0.7) as u32 + 1;
            (0..picks).map(|_| pick(&mut random)).collect()
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn on_full_collapses_ids_rings_and_cells_give_one_closure(mesh_seed in any::<u64>(), seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let (explicit, replay) = both_of(&mesh, &EdgeCollapse::FULL);
        prop_assume!(!replay.is_empty());
        let [cells, ring, four, dual] =
            [Scheme::Explicit, Scheme::OneRing, Scheme::FourFace, Scheme::DualPiece].map(|s| s.stored(&replay).unwrap().unwrap());
        // Nested as orders, so as closures.
        prop_assert_eq!(ring.contains(&replay, &cells), Ok(()), "{}", name);
        prop_assert_eq!(cells.contains(&replay, &ring), Ok(()), "{}", name);
        prop_assert_eq!(ring.contains(&replay, &four), Ok(()), "{}", name);
        prop_assert_eq!(four.contains(&replay, &dual), Ok(()), "{}", name);
        let ids = Hierarchy { replay: Arc::clone(&replay), dependency: ImplicitIds };
        let free = Hierarchy { replay: Arc::clone(&replay), dependency: DualPieceFree::new(&replay).unwrap() };
        let orders = [&ring, &four, &dual].map(|stored| stored.order(&replay));
        for wish in wishes(replay.len(), seed) {
            let [of_ring, of_four, of_dual] = [0, 1, 2].map(|i| closed(&orders[i], &wish));
            prop_assert!(of_ring == closed(explicit.order(), &wish), "{}: cells", name);
            prop_assert!(of_ring == forced(&ids, &wish), "{}: ids", name);
            prop_assert!(of_four.is_subset(&of_ring) && of_dual.is_subset(&of_four), "{}", name);
            // From the base mesh a split of the free rule waits for what the static order says.
            prop_assert!(of_dual == forced(&free, &wish), "{}: free", name);
        }
    }

    #[test]
    fn orders_nest_on_every_kind_of_sequence(mesh_seed in any::<u64>(), kind in 0usize..3) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let replay = match kind {
            0 => both_of(&mesh, &EdgeCollapse::FULL).1,
            1 => both_of(&mesh, &EdgeCollapse::HALF).1,
            _ => replay_of(&mesh, &fan(BelowStall::Partial)),
        };
        let ring = Stored::one_ring(&replay);
        let dual = Stored::dual_piece(&replay).unwrap();
        for scheme in [Scheme::Explicit, Scheme::FourFace, Scheme::CutPair] {
            let between = scheme.stored(&replay).unwrap().unwrap();
            prop_assert_eq!(ring.contains(&replay, &between), Ok(()), "{} {}", name, scheme);
            prop_assert_eq!(between.contains(&replay, &dual), Ok(()), "{} {}", name, scheme);
        }
    }

    #[test]
    fn half_edge_histories_differ(mesh_seed in any::<u64>()) {
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let (explicit, replay) = both_of(&mesh, &EdgeCollapse::HALF);
        prop_assume!(!replay.is_empty());
        // The model of cells alone is looser than the ring: its fronts need not be cuts of the forest.
        let ring = Stored::one_ring(&replay).order(&replay);
        let mut random = Random::new(mesh_seed);
        for _ in 0..8 {
            let front = check::random_front(&ring, &mut random);
            prop_assert_eq!(explicit.order().unmet(&front), None, "{}", name);
        }
    }

    #[test]
    fn what_coarsens_also_agrees(mesh_seed in any::<u64>(), seed in any::<u64>()) {
        // From the input down to a wish: the ids let go of what the ring order lets go of.
        let Named { name, mesh } = generate::random_mesh(mesh_seed);
        let (_, replay) = both_of(&mesh, &EdgeCollapse::FULL);
        prop_assume!(!replay.is_empty());
        let ring = Stored::one_ring(&replay).order(&replay);
        let ids = Hierarchy { replay: Arc::clone(&replay), dependency: ImplicitIds };
        for wish in wishes(replay.len(), seed).into_iter().take(4) {
            let target = closed(&ring, &wish);
            let mut state = State::new(&ids, ());
            (0..replay.len()).rev().for_each(|m| state.force(&ids, NodeId(m)));
            for m in (0..replay.len()).map(NodeId).filter(|m| !target.is_refined(*m)) {
                prop_assert!(state.try_coarsen(&ids, m), "{}: node {} stays", name, m);
            }
            prop_assert!(*state.front() == target);
            // And of nothing that the wish needs.
            for m in target.finest_first() {
                let needed = ring.dependents(m).iter().any(|&d| target.is_refined(d));
                let mut out = Vec::new();
                let free = ids.obstacles(m, &state.view, &mut out) == Coarsen::Now;
                prop_assert_eq!(free, !needed, "{}: node {}", name, m);
            }
        }
    }
}

#[test]
fn the_slides_rule_for_merges_would_forbid_them_all() {
    // The parent's id below the ids of the neighbours: at analysis no merge had that, since ids grow.
    let (_, replay) = both_of(&generate::bumpy_sphere(3, 0.1, 3), &EdgeCollapse::FULL);
    let mut as_printed = 0;
    let mut view = View { front: Front::reference(replay.len()), mesh: replay.reference_mesh() };
    for m in (0..replay.len()).map(NodeId) {
        let ends = [replay.merge(m.0).center, replay.node(m).child];
        let ring: Vec<_> = ends.iter().flat_map(|&end| view.mesh.ring(end)).filter(|w| !ends.contains(w)).collect();
        as_printed += u32::from(ring.iter().all(|&w| replay.vertex(m) < w));
        replay.coarsen(m, &mut view.mesh, &mut ());
        view.front.set(m, false);
    }
    assert_eq!(as_printed, 0);
}

#[test]
fn cells_alone_are_looser_than_rings_on_half_edges() {
    let (explicit, replay) = both_of(&generate::bumpy_sphere(3, 0.15, 3), &EdgeCollapse::HALF);
    let ring = Stored::one_ring(&replay).order(&replay);
    let more = wishes(replay.len(), 8).into_iter().filter(|wish| {
        let (of_cells, of_ring) = (closed(explicit.order(), wish), closed(&ring, wish));
        assert!(of_cells.is_subset(&of_ring));
        of_cells.len() < of_ring.len()
    });
    assert!(more.count() > 5, "the two orders hardly differ");
    // And there are fronts of cells that are no cuts of the forest.
    let mut random = Random::new(1);
    let odd = (0..50).filter(|_| check::is_cut(&replay, &check::random_front(explicit.order(), &mut random)).is_err());
    assert!(odd.count() > 5, "fronts of cells are cuts of the forest");
}

#[test]
fn stored_ids_let_more_merge_than_current_ids() {
    let (_, replay) = both_of(&generate::bumpy_sphere(3, 0.15, 3), &EdgeCollapse::FULL);
    let current = Hierarchy { replay: Arc::clone(&replay), dependency: ImplicitIds };
    let stored = Hierarchy { dependency: StoredIds::new(&replay).unwrap(), replay: Arc::clone(&replay) };
    let (mut by_both, mut by_stored) = (0, 0);
    for wish in wishes(replay.len(), 5) {
        // Splits agree: an ancestor of a neighbour at analysis has a larger id than any neighbour had.
        let front = forced(&current, &wish);
        assert_eq!(front, forced(&stored, &wish));
        let mut state = State::new(&current, ());
        wish.iter().for_each(|&m| state.force(&current, m));
        for m in front.finest_first() {
            let mut out = Vec::new();
            let one = current.obstacles(m, &state.view, &mut out) == Coarsen::Now;
            out.clear();
            let other = stored.obstacles(m, &state.view, &mut out) == Coarsen::Now;
            assert!(!one || other, "node {m} may merge by current ids, not by stored ones");
            by_both += u32::from(one);
            by_stored += u32::from(other);
        }
    }
    assert!(by_both > 0 && by_stored > by_both, "{by_both} {by_stored}");
}

#[test]
fn an_order_of_ones_own_is_taken_when_sound() {
    let (_, replay) = both_of(&generate::bumpy_sphere(3, 0.2, 8), &EdgeCollapse::FULL);
    let dual = Stored::dual_piece(&replay).unwrap();
    assert!(dual.needs_rows().entry_count() > 0, "no node needs more than its parent: nothing to see");
    let entries: Vec<_> = dual.needs_rows().entries().collect();
    assert_eq!(Stored::of_user(&replay, entries.iter().copied()).unwrap(), dual);
    // The order by layers: everything needs the node after it. It is sound, and the least local of all.
    let chain = (0..replay.len() - 1).map(|m| (NodeId(m), NodeId(m + 1)));
    laws_hold("a chain", &replay, Stored::of_user(&replay, chain).unwrap(), 4, 20);
    // The parents alone are not enough, and there is a witness.
    let refused = Stored::of_user(&replay, []).unwrap_err().to_string();
    let (node, needed) = entries[0];
    assert!(refused.contains(&format!("node {node} must wait for node {needed}")), "{refused}");
    let backwards = Stored::of_user(&replay, [(NodeId(5), NodeId(2))]).unwrap_err().to_string();
    assert!(backwards.contains("not larger"), "{backwards}");
}

/// The forest and nothing else: what the schemes are there to prevent.
struct ForestAlone;

impl Dependency for ForestAlone {
    const RULE: Rule = Rule::Static;
    fn needs(&self, _: &Replay, _: NodeId, _: &mut Vec<NodeId>) {}
    fn prerequisites(&self, _: &Replay, _: NodeId, _: &View<VertexMesh>, _: &mut Vec<NodeId>) {}
    fn obstacles(&self, _: &Replay, _: NodeId, _: &View<VertexMesh>, _: &mut Vec<NodeId>) -> Coarsen {
        Coarsen::Now
    }
    fn bytes(&self) -> usize {
        0
    }
}

#[test]
fn an_order_that_is_refused_would_break_the_mesh() {
    let (_, replay) = both_of(&generate::bumpy_sphere(3, 0.2, 8), &EdgeCollapse::FULL);
    let model = Hierarchy { replay, dependency: ForestAlone };
    let options = verify::Options { fronts: 200, seed: 3, ..verify::Options::default() };
    let found = verify::hierarchy(&model, &options, &mut |_| true).expect_err("parents alone are unsound");
    assert!(matches!(found.breach.law, Law::CrackFree | Law::Partition), "{}", found.breach);
    // Small enough to look at.
    assert!(found.front.len() <= 60, "{} nodes, found at {}", found.front.len(), found.found.front);
}
