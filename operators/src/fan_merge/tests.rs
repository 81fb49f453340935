//! Laws of fan-merge: a coarse step is a run of edge collapses, each of them legal, and models by fans keep all laws.

use super::{BelowStall, FanMerge, FanTally, LINK_MAX, Planes, Site};
use crate::edge_collapse::BoundaryRule;
use mt_core::analysis::{Draft, Listener, Operator, Options, Stopped, analyse, simplify};
use mt_core::explicit::HistoryError;
use mt_core::mesh::area_vector;
use mt_core::model::{Step, cells_of, take};
use mt_core::{Cell, Mesh, MultiTessellation, Plan, Refusal, Slot, VertexId, check, generate};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What a collapse of an edge must not change: the Euler characteristic and the number of boundary loops. `None` where
/// the cells are no manifold: three at an edge, two umbrellas at a vertex, the same cell twice. Written to be read.
fn topology(cells: &[Cell<3>]) -> Option<(i64, usize)> {
    let mut edges: BTreeMap<[VertexId; 2], usize> = BTreeMap::new();
    let mut around: BTreeMap<VertexId, Vec<[VertexId; 2]>> = BTreeMap::new();
    let mut seen = BTreeSet::new();
    for cell in cells {
        let mut sorted = *cell;
        sorted.sort_unstable();
        if !seen.insert(sorted) || sorted[0] == sorted[1] || sorted[1] == sorted[2] {
            return None;
        }
        for i in 0..3 {
            let [a, b] = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            around.entry(cell[i]).or_default().push([a, b]);
        }
    }
    let is_umbrella = |sides: &Vec<[VertexId; 2]>| pieces(sides) == 1;
    if edges.values().any(|&n| n > 2) || !around.values().all(is_umbrella) {
        return None;
    }
    let euler = around.len() as i64 - edges.len() as i64 + cells.len() as i64;
    let open: Vec<_> = edges.into_iter().filter(|(_, n)| *n == 1).map(|(edge, _)| edge).collect();
    Some((euler, pieces(&open)))
}

/// Connected pieces of a graph.
fn pieces(edges: &[[VertexId; 2]]) -> usize {
    let mut names: BTreeMap<VertexId, VertexId> = edges.iter().flatten().map(|&v| (v, v)).collect();
    for [a, b] in edges {
        let (old, new) = (names[a], names[b]);
        names.values_mut().filter(|name| **name == old).for_each(|name| *name = new);
    }
    names.values().collect::<BTreeSet<_>>().len()
}

/// The half-edge collapse of `u` into `v`, by the book.
fn collapse(cells: &[Cell<3>], u: VertexId, v: VertexId) -> Vec<Cell<3>> {
    let moved = cells.iter().map(|cell| cell.map(|w| if w == u { v } else { w }));
    moved.filter(|cell| cell.iter().filter(|&&w| w == v).count() < 2).collect()
}

fn cells_with(cells: &[Cell<3>], vertices: &[VertexId]) -> usize {
    cells.iter().filter(|cell| vertices.iter().all(|v| cell.contains(v))).count()
}

fn is_on_boundary(cells: &[Cell<3>], v: VertexId) -> bool {
    let others: BTreeSet<_> = cells.iter().filter(|cell| cell.contains(&v)).flatten().filter(|w| **w != v).collect();
    others.into_iter().any(|&w| cells_with(cells, &[v, w]) == 1)
}

/// Whether the collapse keeps the surface what it is, and the boundary rule.
fn is_legal(cells: &[Cell<3>], u: VertexId, v: VertexId) -> bool {
    let shared = cells_with(cells, &[u, v]);
    let by_rule = !is_on_boundary(cells, u) || (is_on_boundary(cells, v) && shared == 1);
    // A component may not vanish.
    let after = collapse(cells, u, v);
    let neighbours: BTreeSet<_> = cells.iter().filter(|c| c.contains(&v)).flatten().collect();
    let stays = cells_with(&after, &[v]) > 0 && neighbours.iter().all(|&&w| w == u || cells_with(&after, &[w]) > 0);
    shared > 0 && by_rule && stays && topology(&after).is_some_and(|t| Some(t) == topology(cells))
}

/// Replays every plan one collapse at a time on a copy.
struct Replay {
    cells: Vec<Cell<3>>,
    fold_cosine: f64,
    plans: usize,
    exact_fans: usize,
}

impl Replay {
    fn new(mesh: &Mesh<3>, fan: &FanMerge) -> Self {
        Self { cells: mesh.cells.clone(), fold_cosine: fan.fold_cosine, plans: 0, exact_fans: 0 }
    }

    /// No triangle that stays turns by more than is allowed.
    fn judge_turns(&self, draft: &Draft<3>, u: VertexId, v: VertexId) {
        if self.fold_cosine <= -1.0 {
            return;
        }
        let area = |cell: Cell<3>| area_vector(cell.map(|w| draft.positions[w.index()].as_dvec3()));
        for cell in self.cells.iter().filter(|cell| cell.contains(&u) && !cell.contains(&v)) {
            let (old, new) = (area(*cell), area(cell.map(|w| if w == u { v } else { w })));
            let cosine = old.normalize_or_zero().dot(new.normalize_or_zero());
            assert!(old.length() == 0.0 || cosine >= self.fold_cosine - 1e-9, "{u} into {v} turns {cell:?}: {cosine}");
        }
    }

    /// A full fan inside a closed patch takes two triangles for each vertex around; where the triangles adjacent to it
    /// are as many as it has edges, it takes those and its own, as the paper says.
    fn judge_count(&mut self, draft: &Draft<3>, plan: &Plan<3>, hub: VertexId) {
        let mut around = Vec::new();
        draft.complex.neighbours(hub, &mut around);
        let gone = plan.kills.len() - plan.makes.len();
        if around.len() != plan.retired.len() || around.iter().any(|&u| is_on_boundary(&self.cells, u)) {
            return;
        }
        assert_eq!(gone, 2 * around.len(), "a fan of {} vertices", around.len());
        let fan: BTreeSet<Slot> = draft.complex.star(hub).map(|(slot, _)| slot).collect();
        let edges: Vec<[VertexId; 2]> = fan
            .iter()
            .map(|&slot| {
                let others: Vec<_> = draft.complex.cell(slot).iter().copied().filter(|w| *w != hub).collect();
                [others[0], others[1]]
            })
            .collect();
        let adjacent = draft.complex.cells().filter(|(slot, _)| !fan.contains(slot));
        let adjacent = adjacent.filter(|(_, cell)| edges.iter().any(|edge| edge.iter().all(|v| cell.contains(v))));
        let paper: BTreeSet<Slot> = fan.iter().copied().chain(adjacent.map(|(slot, _)| slot)).collect();
        if paper.len() == 2 * around.len() {
            let dying: BTreeSet<Slot> = plan.kills[plan.makes.len()..].iter().copied().collect();
            assert_eq!(dying, paper);
            self.exact_fans += 1;
        }
    }
}

impl Listener<3> for Replay {
    fn applying(&mut self, draft: &Draft<3>, plan: &Plan<3>) -> Result<(), HistoryError> {
        let hub = plan.kept.expect("fans keep a vertex");
        assert!((1..=LINK_MAX).contains(&plan.retired.len()) && plan.errors.len() == plan.retired.len());
        assert!(plan.errors.is_sorted() && plan.errors.last() == Some(&plan.error));
        assert!(plan.retired.iter().all(|&u| u != hub && cells_with(&self.cells, &[u, hub]) > 0), "not around the hub");
        self.judge_count(draft, plan, hub);
        for &u in &plan.retired {
            assert!(is_legal(&self.cells, u, hub), "{u} may not go into {hub} in {:?}", plan.retired);
            self.judge_turns(draft, u, hub);
            self.cells = collapse(&self.cells, u, hub);
        }
        self.plans += 1;
        Ok(())
    }

    fn applied(&mut self, draft: &mut Draft<3>, _: &Plan<3>, _: &[Slot]) -> Result<(), HistoryError> {
        let mut now: Vec<_> = draft.complex.cells().map(|(_, cell)| *cell).collect();
        let mut replayed = self.cells.clone();
        now.sort_unstable();
        replayed.sort_unstable();
        assert_eq!(now, replayed, "the run ends in another mesh than the whole step");
        Ok(())
    }
}

fn replay(mesh: &Mesh<3>, fan: &FanMerge) -> (Replay, FanTally) {
    let mut both = (Replay::new(mesh, fan), FanTally::new(mesh));
    analyse(mesh, fan, &Options::default(), &mut both, &mut |_| true).expect("a manifold");
    assert_eq!(both.1.vertices, both.0.cells.iter().flatten().collect::<BTreeSet<_>>().len());
    both
}

fn fan() -> impl Strategy<Value = FanMerge> {
    let below = prop_oneof![Just(BelowStall::Partial), Just(BelowStall::Collapse), Just(BelowStall::Stop)];
    let planes = prop_oneof![2 => Just(Planes::Accumulated), 1 => Just(Planes::Current)];
    let boundary = prop_oneof![3 => Just(BoundaryRule::Weighted), 1 => Just(BoundaryRule::Locked)];
    let cosine = prop_oneof![2 => Just(0.2), 1 => Just(-1.0)];
    (below, planes, boundary, cosine, any::<bool>()).prop_map(
        |(below_stall, planes, boundary, fold_cosine, weigh_degree)| FanMerge {
            below_stall,
            planes,
            boundary,
            fold_cosine,
            weigh_degree,
            ..FanMerge::PARTIAL
        },
    )
}

/// Meshes small enough for oracles that look at all cells again and again.
fn small() -> impl Strategy<Value = Mesh<3>> {
    let drawn = any::<u64>().prop_map(|seed| generate::random_mesh(seed).mesh);
    let drawn = drawn.prop_filter("few cells", |mesh| mesh.cell_count() <= 400);
    prop_oneof![
        6 => drawn,
        1 => (3usize..8, 1usize..6).prop_map(|(n, rings)| generate::cylinder(n, rings)),
        1 => (3usize..8, 3usize..6).prop_map(|(m, n)| generate::torus(m, n)),
        1 => (5usize..12).prop_map(generate::moebius),
        1 => (1usize..9).prop_map(generate::strip),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn a_coarse_step_is_a_run_of_legal_collapses(mesh in small(), fan in fan()) {
        replay(&mesh, &fan);
    }

    #[test]
    fn models_by_fans_keep_the_laws(mesh in small(), fan in fan(), seed in any::<u64>()) {
        // Where triangles may turn over, planar meshes do, as they should.
        let fan = FanMerge { fold_cosine: 0.2, ..fan };
        let model = simplify(&mesh, &fan, &Options::default(), &mut |_| true).expect("a manifold").model;
        prop_assert_eq!(check::cells(&model), Ok(()));
        prop_assert_eq!(check::saturation(&model), Ok(()));
        prop_assert_eq!(check::ends(&model, &mesh), Ok(()));
        prop_assert_eq!(check::order_from_cells(&model), Ok(()));
        let order = check::order_of(&model).expect("an order");
        let domain = check::conformity(&model).map_err(|breach| TestCaseError::fail(breach.to_string()))?;
        let mut random = check::Random::new(seed);
        for _ in 0..12 {
            let front = check::random_front(&order, &mut random);
            let mut view = model.base_view();
            let nodes: Vec<_> = front.finest_first().collect();
            for &m in nodes.iter().rev() {
                take(&model, Step::refine(m), &mut view, &mut ());
            }
            let cells: Vec<_> = cells_of(&model, &view.mesh).into_iter().map(|(_, corners)| corners).collect();
            let judged = check::crack_free(&cells, model.positions(), &domain, &domain.boundary_at(&front));
            prop_assert_eq!(judged, Ok(()));
            prop_assert_eq!(check::front_determines_mesh(&model, &view, &mut random), Ok(()));
        }
        if fan.boundary == BoundaryRule::Locked {
            prop_assert!(domain.boundary_fixed);
        }
    }

    #[test]
    fn all_that_is_refused_at_first_is_illegal_in_every_sequence(mesh in small()) {
        // Refusals of full fans by their links, judged by trying all sequences; only of small fans.
        let fan = FanMerge { fold_cosine: -1.0, ..FanMerge::STOP };
        let draft = Draft::new(&mesh);
        let (mut sites, mut plan) = (Vec::new(), Plan::default());
        let aux = fan.prepare(&draft, &mut sites).expect("a manifold");
        for site in sites.into_iter().take(12) {
            let mut around = Vec::new();
            draft.complex.neighbours(site.hub, &mut around);
            plan.clear();
            if around.len() <= 5 && fan.plan(&draft, &aux, site, &mut plan).is_err() {
                prop_assert!(!some_sequence(&mesh.cells, site.hub, &around), "{} at {around:?}", site.hub);
            }
        }
    }
}

fn some_sequence(cells: &[Cell<3>], hub: VertexId, left: &[VertexId]) -> bool {
    left.is_empty()
        || left.iter().any(|&u| {
            let rest: Vec<_> = left.iter().copied().filter(|&w| w != u).collect();
            is_legal(cells, u, hub) && some_sequence(&collapse(cells, u, hub), hub, &rest)
        })
}

#[test]
fn the_smallest_closed_meshes_stay_closed() {
    for kind in [FanMerge::PARTIAL, FanMerge::COLLAPSE, FanMerge::STOP] {
        for fold_cosine in [-1.0, 0.2] {
            let fan = FanMerge { fold_cosine, ..kind };
            assert_eq!(replay(&generate::tetrahedron(), &fan).0.plans, 0);
            assert_eq!(replay(&generate::triangle(), &fan).0.plans, 0);
            for mesh in [generate::octahedron(), generate::icosahedron()] {
                let (replayed, tally) = replay(&mesh, &fan);
                assert!(replayed.cells.len() >= 4 && topology(&replayed.cells) == topology(&mesh.cells));
                // A fan of an octahedron would leave two triangles.
                assert!(mesh.cell_count() > 8 || tally.full == 0);
                assert!(fold_cosine > -1.0 || fan.below_stall == BelowStall::Stop || replayed.cells.len() == 4);
            }
        }
    }
}

#[test]
fn full_fans_take_what_the_paper_says() {
    let (replayed, tally) = replay(&generate::bumpy_sphere(3, 0.1, 4), &FanMerge::STOP);
    assert!(tally.partial + tally.single == 0 && tally.stalled_at.is_none());
    assert!(replayed.exact_fans > 50, "only {} fans were of the common kind", replayed.exact_fans);
}

#[test]
fn closed_surfaces_reach_a_handful_of_triangles() {
    for kind in [FanMerge::PARTIAL, FanMerge::COLLAPSE] {
        for (mesh, most) in [(generate::bumpy_sphere(4, 0.1, 3), 12), (generate::torus(24, 16), 60)] {
            let mut tally = FanTally::new(&mesh);
            let options = Options::default();
            let analysis = simplify(&mesh, &kind, &options, &mut |_| true).expect("a manifold");
            analyse(&mesh, &kind, &options, &mut tally, &mut |_| true).expect("a manifold");
            assert_eq!(analysis.stopped, Stopped::Exhausted);
            let left = analysis.model.base_cells().len();
            assert!(left <= most, "{left} triangles are left of {}", mesh.cell_count());
            let at = tally.stalled_at.expect("full fans stall") as f64 / mesh.vertex_count() as f64;
            assert!((0.02..0.4).contains(&at), "stalled at {at}");
        }
    }
}

/// Two cones over one circle.
fn spindle(n: u32) -> Mesh<3> {
    let on_circle = |i: u32| glam::Vec2::from_angle(i as f32 / n as f32 * std::f32::consts::TAU).extend(0.0);
    let positions = (0..n).map(on_circle).chain([glam::Vec3::Z, glam::Vec3::NEG_Z]).collect();
    let cells: Vec<_> = (0..n).flat_map(|i| [[i, (i + 1) % n, n], [(i + 1) % n, i, n + 1]]).collect();
    Mesh::from_indices(positions, &cells)
}

#[test]
fn more_than_a_byte_counts_is_refused() {
    let mesh = spindle(300);
    let plan_at = |hub: usize| {
        let fan = FanMerge { fold_cosine: -1.0, ..FanMerge::STOP };
        let draft = Draft::new(&mesh);
        let (mut sites, mut plan) = (Vec::new(), Plan::default());
        let aux = fan.prepare(&draft, &mut sites).expect("a manifold");
        fan.plan(&draft, &aux, sites[hub], &mut plan)
    };
    assert_eq!(plan_at(300), Err(Refusal::Limit));
    for kind in [FanMerge::PARTIAL, FanMerge::COLLAPSE] {
        let fan = FanMerge { fold_cosine: -1.0, ..kind };
        let mut both = (Replay::new(&mesh, &fan), FanTally::new(&mesh));
        let ended = analyse(&mesh, &fan, &Options::default(), &mut both, &mut |_| true).expect("a manifold");
        assert!(ended.refusals.of(Refusal::Limit) > 0 && both.1.children_max <= LINK_MAX);
        assert_eq!(both.0.cells.len(), 4);
    }
}

#[test]
fn an_edge_across_the_fan_is_in_the_way() {
    // Each vertex of a tube of three columns has the other two of its ring around it, and no triangle has all three.
    let mesh = generate::torus(12, 3);
    let fan = FanMerge { fold_cosine: -1.0, ..FanMerge::STOP };
    let mut tally = FanTally::new(&mesh);
    let ended = analyse(&mesh, &fan, &Options::default(), &mut tally, &mut |_| true).expect("a manifold");
    assert!(tally.full == 0 && ended.refusals.of(Refusal::Link) >= 36);
    let (replayed, tally) = replay(&mesh, &FanMerge { below_stall: BelowStall::Partial, ..fan });
    assert!(tally.partial > 0 && replayed.cells.len() < mesh.cell_count() / 2);
}

#[test]
fn the_boundary_goes_along_the_boundary() {
    let mesh = generate::grid(8, 8);
    let draft = Draft::new(&mesh);
    let (mut sites, mut plan) = (Vec::new(), Plan::default());
    let aux = FanMerge::STOP.prepare(&draft, &mut sites).expect("a manifold");
    let beside: Vec<Site> = sites
        .iter()
        .copied()
        .filter(|site| !is_on_boundary(&mesh.cells, site.hub))
        .filter(|site| {
            draft
                .complex
                .star(site.hub)
                .flat_map(|(slot, _)| draft.complex.cell(slot))
                .any(|&u| is_on_boundary(&mesh.cells, u))
        })
        .collect();
    assert_eq!(beside.len(), 24);
    for site in beside {
        plan.clear();
        assert_eq!(FanMerge::STOP.plan(&draft, &aux, site, &mut plan), Err(Refusal::Boundary));
    }
    for kind in [FanMerge::PARTIAL, FanMerge::COLLAPSE] {
        // As dear as cutting off a corner is, nothing forbids it.
        assert!(replay(&mesh, &kind).0.cells.len() <= 2);
    }
}

#[test]
fn open_meshes_keep_the_laws_whatever_wedge_they_lose() {
    // A partial fan may take all triangles between an edge and the boundary; the one behind has to know.
    for seed in 0..150 {
        let mesh = generate::bumpy_grid(3 + seed % 5, 8 + seed % 7, 1.5, seed as u64);
        let fan = FanMerge { planes: Planes::Current, weigh_degree: seed % 2 == 0, ..FanMerge::PARTIAL };
        for fan in [fan, FanMerge::PARTIAL] {
            let model = simplify(&mesh, &fan, &Options::default(), &mut |_| true).expect("a manifold").model;
            assert!(check::conformity(&model).is_ok());
        }
    }
}

#[test]
fn what_lies_in_a_plane_costs_nothing() {
    let mesh = generate::grid(9, 9);
    let options = Options { until_cells: Some(100), ..Options::default() };
    let model = simplify(&mesh, &FanMerge::PARTIAL, &options, &mut |_| true).expect("a manifold").model;
    assert!(model.base_cells().len() <= 100);
    for m in 0..model.len() {
        assert!(model.bound(mt_core::NodeId(m)).error < 1e-3);
    }
}

#[test]
fn only_manifolds_are_taken() {
    for mesh in [generate::hourglass(), generate::fan3()] {
        assert!(simplify(&mesh, &FanMerge::PARTIAL, &Options::default(), &mut |_| true).is_err());
    }
}

#[test]
fn sums_are_kept_as_if_added_up() {
    for mesh in [generate::bumpy_grid(12, 9, 0.8, 3), generate::bumpy_sphere(3, 0.2, 8), generate::moebius(12)] {
        let fan = FanMerge::STOP;
        let mut draft = Draft::new(&mesh);
        let (mut sites, mut plan, mut slots) = (Vec::new(), Plan::default(), Vec::new());
        let mut aux = fan.prepare(&draft, &mut sites).expect("a manifold");
        aux.judge_sums(&fan, &draft);
        for site in sites {
            plan.clear();
            if fan.plan(&draft, &aux, site, &mut plan).is_ok() {
                draft.apply(&plan, &mut slots);
                fan.applied(&draft, &mut aux, &plan, &mut Vec::new());
                aux.judge_sums(&fan, &draft);
            }
        }
    }
}

#[test]
fn rounds_do_not_overlap() {
    let mesh = generate::bumpy_sphere(3, 0.1, 4);
    let draft = Draft::new(&mesh);
    let mut sites = Vec::new();
    let aux = FanMerge::PARTIAL.prepare(&draft, &mut sites).expect("a manifold");
    let prices = |round| {
        let price = |&site: &Site| FanMerge::PARTIAL.price(&draft, &aux, Site { round, ..site }).expect("a fresh site");
        sites.iter().map(price).fold((f64::INFINITY, 0.0f64), |(low, high), p| (low.min(p), high.max(p)))
    };
    use super::Round::*;
    let all = [Full, Again, Partial, Single].map(prices);
    assert!(all.windows(2).all(|pair| pair[0].1 < pair[1].0) && all[3].1 < f64::from(f32::MAX), "{all:?}");
}
