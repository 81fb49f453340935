//! One planted fault for each law: the law must see it. A checker that cannot fail proves nothing.

use mt_core::analysis::{Draft, Operator, Options, Unfit, simplify};
use mt_core::check::{self, Law, Random};
use mt_core::explicit::{Alive, Parts};
use mt_core::model::{MultiTessellation, View, take};
use mt_core::{
    Bound, Cell, CellId, Coarsen, Complex, Explicit, Front, NodeId, Plan, Refusal, Rule, Sink, Step, VertexId, generate,
};
use mt_tests::model_of;
use multi_tessellation::verify;
use operators::EdgeCollapse;
use selective::{State, approach};

fn good() -> Explicit<3> {
    model_of(&generate::bumpy_sphere(2, 0.1, 3), &EdgeCollapse::FULL)
}

fn broken(change: impl FnOnce(&mut Parts<3>)) -> Explicit<3> {
    let mut parts = good().parts().clone();
    change(&mut parts);
    Explicit::from_parts(parts).expect("the fault is none that shape checks see")
}

/// The law that verification names, and the size of the counterexample.
fn verdict(model: &Explicit<3>) -> Option<(Law, u32)> {
    let options = verify::Options { fronts: 60, seed: 5, ..verify::Options::default() };
    verify::explicit(model, &options, &mut |_| true).err().map(|found| (found.breach.law, found.front.len()))
}

#[test]
fn nothing_is_found_where_nothing_is_wrong() {
    assert_eq!(verdict(&good()), None);
}

#[test]
fn conformity_sees_a_corner_moved_to_another_vertex() {
    let model = broken(|parts| {
        let made = parts.coarse_start[10] as usize;
        let stranger = (0..).map(VertexId).find(|v| !parts.corners[made].contains(v)).unwrap();
        parts.corners[made][0] = stranger;
    });
    assert_eq!(verdict(&model).map(|v| v.0), Some(Law::Conformity));
}

#[test]
fn conformity_sees_a_bad_plan_before_it_is_applied() {
    // An ear of a strip goes, and nothing is made of the triangle behind it.
    let strip = generate::strip(4);
    let complex = Complex::new(strip.positions.len(), &strip.cells);
    let ear = Plan { kills: vec![0], ..Plan::default() };
    assert_eq!(check::plan(&complex, &ear).unwrap_err().law, Law::Conformity);
    let both = Plan { kills: vec![0, 1], makes: vec![strip.cells[1]], ..Plan::default() };
    assert_eq!(check::plan(&complex, &both), Ok(()));
}

#[test]
fn conformity_sees_a_patch_turned_inside_out() {
    let model = broken(|parts| {
        let (from, to) = (parts.coarse_start[10] as usize, parts.coarse_start[11] as usize);
        parts.corners[from..to].iter_mut().for_each(|cell| cell.swap(0, 1));
    });
    assert_eq!(verdict(&model).map(|v| v.0), Some(Law::Conformity));
}

#[test]
fn cells_sees_a_cell_that_is_never_killed() {
    // The last entry of a fine side is dropped: the cell stays in every coarser mesh, on top of its successors.
    let model = broken(|parts| {
        let last = parts.fine.pop().expect("there are fine sides");
        assert!(last.index() < parts.corners.len());
        *parts.fine_start.last_mut().unwrap() -= 1;
    });
    assert!(matches!(verdict(&model), Some((Law::Conformity | Law::Cells, _))));
}

#[test]
fn crack_freeness_sees_a_missing_cell() {
    let model = good();
    let domain = check::conformity(&model).unwrap();
    let mut cells = model.reference().cells;
    check::crack_free(&cells, model.positions(), &domain, &domain.base_boundary).unwrap();
    let lost = cells.pop().unwrap();
    assert_eq!(
        check::crack_free(&cells, model.positions(), &domain, &domain.base_boundary).unwrap_err().law,
        Law::CrackFree
    );
    cells.extend([lost, lost]);
    assert_eq!(
        check::crack_free(&cells, model.positions(), &domain, &domain.base_boundary).unwrap_err().law,
        Law::CrackFree
    );
}

#[test]
fn crack_freeness_sees_an_ear_that_floats() {
    // A triangle of a strip without those behind it: its edges are boundary in one mesh or another, but not in this one.
    let strip = generate::strip(8);
    let model = model_of(&strip, &EdgeCollapse::HALF);
    let domain = check::conformity(&model).unwrap();
    let boundary = domain.boundary_at(&Front::reference(model.len()));
    check::crack_free(&strip.cells, &strip.positions, &domain, &boundary).unwrap();
    for gone in 0..strip.cells.len() {
        let mut cells = strip.cells.clone();
        cells.remove(gone);
        let breach = check::crack_free(&cells, &strip.positions, &domain, &boundary).unwrap_err();
        assert_eq!(breach.law, Law::CrackFree);
    }
}

#[test]
fn crack_freeness_sees_a_pinch_by_umbrellas() {
    // Two spheres that share a vertex: every edge has two triangles, and still it is no manifold.
    let ball = generate::sphere(1);
    let domain = check::conformity(&model_of(&ball, &EdgeCollapse::FULL)).unwrap();
    let shift = ball.positions.len() as u32 - 1;
    let other = ball.cells.iter().map(|cell| cell.map(|v| if v.0 == 0 { v } else { VertexId(v.0 + shift) }));
    let cells: Vec<_> = ball.cells.iter().copied().chain(other).collect();
    let positions = [ball.positions.as_slice(), &ball.positions[1..]].concat();
    let breach = check::crack_free(&cells, &positions, &domain, &domain.base_boundary).unwrap_err();
    assert!(breach.what.contains("umbrella"), "{breach}");
}

#[test]
fn crack_freeness_sees_a_planar_fold() {
    let flat = generate::grid(6, 6);
    let model = model_of(&flat, &EdgeCollapse::FULL);
    let domain = check::conformity(&model).unwrap();
    assert!(domain.content.is_some());
    let boundary = domain.boundary_at(&Front::reference(model.len()));
    let judge = |cells: &[Cell<3>], positions: &[glam::Vec3]| check::crack_free(cells, positions, &domain, &boundary);
    judge(&flat.cells, &flat.positions).unwrap();
    let mut positions = flat.positions.clone();
    positions[3 * 7 + 3].x += 50.0;
    assert_eq!(judge(&flat.cells, &positions).unwrap_err().law, Law::CrackFree);
    // The whole sheet turned over is the same for every test that looks at neighbours only.
    let turned: Vec<Cell<3>> = flat.cells.iter().map(|cell| [cell[1], cell[0], cell[2]]).collect();
    assert!(judge(&turned, &flat.positions).unwrap_err().what.contains("turned over"));
    // Boundary that is missing is a crack too.
    assert!(judge(&[], &flat.positions).unwrap_err().what.contains("not there"));
}

#[test]
fn saturation_sees_a_bound_that_shrank() {
    for change in [(|b: &mut Bound| b.radius *= 0.5) as fn(&mut Bound), |b| b.error *= 0.5, |b| b.center.x += b.radius]
    {
        let model = broken(|parts| change(parts.bounds.last_mut().unwrap()));
        assert_eq!(verdict(&model).map(|v| v.0), Some(Law::Saturation));
    }
}

#[test]
fn ends_sees_a_vertex_that_moved() {
    let model = good();
    let mut input = model.reference();
    check::ends(&model, &input).unwrap();
    input.positions[5].y = f32::from_bits(input.positions[5].y.to_bits() ^ 1);
    assert_eq!(check::ends(&model, &input).unwrap_err().law, Law::Ends);
}

#[test]
fn closure_sees_a_front_that_is_not_closed() {
    let model = good();
    let mut front = Front::reference(model.len());
    front.set(NodeId(model.len() - 1), false);
    let breach = check::closure(model.order(), &front, &Front::base(model.len())).unwrap_err();
    assert_eq!(breach.law, Law::Closure);
}

/// A model with a fault in one of its answers.
struct Faulty {
    model: Explicit<3>,
    fault: Fault,
}

#[derive(PartialEq)]
enum Fault {
    RefineForgetsOneCell,
    CoarsenSwapsCells,
    RefineLooksAtTheMesh,
    RefineTellsOfOneCellTooFew,
    PrerequisitesNameTheRefined,
    PrerequisitesForgetSome,
    ObstaclesAlwaysNow,
    NeedsPointBackwards,
    NeedsForgetSome,
}

impl MultiTessellation<3> for Faulty {
    type Mesh = Alive;
    type Bound = Bound;
    const RULE: Rule = Rule::Static;

    fn len(&self) -> u32 {
        self.model.len()
    }
    fn base(&self) -> Alive {
        self.model.base()
    }
    fn cells(&self, mesh: &Alive, each: impl FnMut(CellId, Cell<3>)) {
        self.model.cells(mesh, each);
    }
    fn cell_count(&self, mesh: &Alive) -> u32 {
        self.model.cell_count(mesh)
    }
    fn positions(&self) -> &[glam::Vec3] {
        self.model.positions()
    }
    fn roots(&self, out: &mut Vec<NodeId>) {
        self.model.roots(out);
    }
    fn children(&self, m: NodeId, out: &mut Vec<NodeId>) {
        self.model.children(m, out);
    }
    fn bound(&self, m: NodeId) -> Bound {
        self.model.bound(m)
    }
    fn gain(&self, m: NodeId) -> Option<i32> {
        self.model.gain(m)
    }
    fn needs(&self, m: NodeId, out: &mut Vec<NodeId>) {
        let before = out.len();
        self.model.needs(m, out);
        match self.fault {
            Fault::NeedsPointBackwards if m.0 == 9 => out.push(NodeId(2)),
            Fault::NeedsForgetSome if m.0.is_multiple_of(3) => out.truncate(before),
            _ => {}
        }
    }
    fn prerequisites(&self, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) {
        let before = out.len();
        self.model.prerequisites(m, view, out);
        match self.fault {
            Fault::PrerequisitesForgetSome if m.0.is_multiple_of(3) => out.truncate(before),
            Fault::PrerequisitesNameTheRefined => out.extend(view.front.finest_first().last()),
            _ => {}
        }
    }
    fn obstacles(&self, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) -> Coarsen {
        if self.fault == Fault::ObstaclesAlwaysNow { Coarsen::Now } else { self.model.obstacles(m, view, out) }
    }
    fn refine(&self, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        let odd = mesh.count() % 4 < 2;
        if self.fault == Fault::RefineTellsOfOneCellTooFew {
            self.model.refine(m, mesh, &mut ());
            self.model.coarse_side(m).for_each(|cell| sink.kill(cell));
            self.model.fine_side(m).iter().skip(1).for_each(|&cell| sink.make(cell, *self.model.corners(cell)));
            return;
        }
        self.model.refine(m, mesh, sink);
        if self.fault == Fault::RefineLooksAtTheMesh && m.0.is_multiple_of(7) && odd {
            mesh.remove(self.model.fine_side(m)[0].0);
        }
        if self.fault == Fault::RefineForgetsOneCell && m.0.is_multiple_of(2) {
            mesh.remove(self.model.fine_side(m)[0].0);
        }
    }
    fn coarsen(&self, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        self.model.coarsen(m, mesh, sink);
        if self.fault == Fault::CoarsenSwapsCells && m.0.is_multiple_of(2) {
            let cell = self.model.coarse_side(m).next().expect("a collapse leaves cells");
            mesh.remove(cell.0);
            mesh.insert(self.model.fine_side(m)[0].0);
        }
    }
}

fn faulty(fault: Fault) -> (Faulty, View<Alive>) {
    let model = good();
    let mut state = State::new(&model, ());
    // The upper half by rank is closed, and both refined and coarse nodes are next to it.
    let front = Front::from_nodes(model.len(), (model.len() / 2..model.len()).map(NodeId));
    approach(&model, &front, &mut state);
    let view = state.view;
    (Faulty { model, fault }, view)
}

#[test]
fn inverse_sees_steps_that_do_not_undo_each_other() {
    for fault in [Fault::RefineForgetsOneCell, Fault::CoarsenSwapsCells] {
        let (model, mut view) = faulty(fault);
        let breach = check::inverse(&model, &mut view, &mut Random::new(1), 400).unwrap_err();
        assert!(matches!(breach.law, Law::Inverse | Law::Conduct), "{breach}");
    }
}

#[test]
fn front_determines_mesh_sees_a_step_that_depends_on_the_way() {
    let (model, _) = faulty(Fault::RefineLooksAtTheMesh);
    let mut view = model.base_view();
    for m in (0..model.len()).rev().map(NodeId) {
        take(&model, Step::refine(m), &mut view, &mut ());
    }
    let breach = check::front_determines_mesh(&model, &view, &mut Random::new(1)).unwrap_err();
    assert_eq!(breach.law, Law::FrontDeterminesMesh);
}

#[test]
fn front_determines_mesh_sees_a_sink_that_is_told_something_else() {
    let (model, view) = faulty(Fault::RefineTellsOfOneCellTooFew);
    let breach = check::front_determines_mesh(&model, &view, &mut Random::new(1)).unwrap_err();
    assert!(breach.what.contains("sink"), "{breach}");
}

#[test]
fn order_sees_a_model_that_waits_for_what_is_there() {
    // An engine that believed it would never end.
    let (model, view) = faulty(Fault::PrerequisitesNameTheRefined);
    let breach = check::front_determines_mesh(&model, &view, &mut Random::new(1)).unwrap_err();
    assert_eq!(breach.law, Law::Order);
    let breach = check::inverse(&model, &mut view.clone(), &mut Random::new(1), 50).unwrap_err();
    assert!(matches!(breach.law, Law::Order | Law::Inverse));
}

#[test]
fn order_from_cells_agrees_where_nothing_is_wrong() {
    for seed in 0..20 {
        check::order_from_cells(&model_of(&generate::random_mesh(seed).mesh, &EdgeCollapse::HALF)).unwrap();
    }
}

#[test]
fn order_sees_prerequisites_and_obstacles_that_lie() {
    for fault in [Fault::PrerequisitesForgetSome, Fault::ObstaclesAlwaysNow] {
        let (model, view) = faulty(fault);
        let order = check::order_of(&model).unwrap();
        let breach = check::order(&model, &order, &view, &mut Random::new(1), 2000).unwrap_err();
        assert_eq!(breach.law, Law::Order);
    }
}

#[test]
fn order_sees_needs_that_are_no_rank_or_not_all() {
    let (model, _) = faulty(Fault::NeedsPointBackwards);
    assert_eq!(check::order_of(&model).unwrap_err().law, Law::Order);
    let (model, view) = faulty(Fault::NeedsForgetSome);
    let order = check::order_of(&model).unwrap();
    assert!(check::order(&model, &order, &view, &mut Random::new(1), 2000).is_err());
}

#[test]
fn minimality_sees_bounds_that_do_not_grow_towards_the_roots() {
    // A large error below a small one: extraction from the top does not find it, the wish has it.
    let model = broken(|parts| parts.bounds[0].error = 1e3);
    let mut random = Random::new(1);
    let view = model.base_view();
    let breach = (0..200).find_map(|_| verify::minimality(&model, model.order(), &view, &mut random).err());
    assert_eq!(breach.map(|b| b.law), Some(Law::Minimality));
}

/// An operator with the classic fault: it tests no link condition.
struct WithoutLinkCondition;

impl Operator<3> for WithoutLinkCondition {
    type Site = (VertexId, VertexId);
    type Aux = ();

    fn name(&self) -> &'static str {
        "without-link-condition"
    }
    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Self::Site>) -> Result<(), Unfit> {
        for (_, cell) in draft.complex.cells() {
            sites.extend((0..3).map(|i| (cell[i], cell[(i + 1) % 3])));
        }
        Ok(())
    }
    fn price(&self, draft: &Draft<3>, (): &(), (u, v): Self::Site) -> Option<f64> {
        (draft.complex.edge_degree(u, v) > 0)
            .then(|| f64::from(draft.positions[u.index()].distance(draft.positions[v.index()])))
    }
    fn plan(&self, draft: &Draft<3>, (): &(), (u, v): Self::Site, plan: &mut Plan<3>) -> Result<(), Refusal> {
        let mut dying = Vec::new();
        for (slot, i) in draft.complex.star(u) {
            let mut cell = *draft.complex.cell(slot);
            if cell.contains(&v) {
                dying.push(slot);
            } else {
                cell[i] = v;
                plan.kills.push(slot);
                plan.makes.push(cell);
            }
        }
        if dying.is_empty() {
            return Err(Refusal::Stale);
        }
        plan.kills.extend(dying);
        plan.retired.push(u);
        plan.kept = Some(v);
        Ok(())
    }
    fn applied(&self, draft: &Draft<3>, (): &mut (), plan: &Plan<3>, again: &mut Vec<Self::Site>) {
        let v = plan.kept.unwrap();
        let mut around = Vec::new();
        draft.complex.neighbours(v, &mut around);
        again.extend(around.into_iter().map(|u| (u, v)));
    }
}

#[test]
fn an_operator_without_the_link_condition_is_found_out_with_a_small_counterexample() {
    let mesh = generate::torus(16, 8);
    let options = Options { until_cells: Some(8), ..Options::default() };
    let model = simplify(&mesh, &WithoutLinkCondition, &options, &mut |_| true).unwrap().model;
    let (law, size) = verdict(&model).expect("the torus was pinched");
    assert!(matches!(law, Law::CrackFree | Law::Conformity), "{law}");
    assert!(size < model.len() / 2, "{size} of {} nodes", model.len());
}

/// An operator that answers differently from one run to the next.
struct Moody(std::sync::atomic::AtomicU32);

impl Operator<3> for Moody {
    type Site = <EdgeCollapse as Operator<3>>::Site;
    type Aux = <EdgeCollapse as Operator<3>>::Aux;

    fn name(&self) -> &'static str {
        "moody"
    }
    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Self::Site>) -> Result<Self::Aux, Unfit> {
        EdgeCollapse::FULL.prepare(draft, sites)
    }
    fn price(&self, draft: &Draft<3>, aux: &Self::Aux, site: Self::Site) -> Option<f64> {
        let mood = self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed) % 7;
        Some(EdgeCollapse::FULL.price(draft, aux, site)? * f64::from(1 + mood))
    }
    fn plan(&self, draft: &Draft<3>, aux: &Self::Aux, site: Self::Site, plan: &mut Plan<3>) -> Result<(), Refusal> {
        EdgeCollapse::FULL.plan(draft, aux, site, plan)
    }
    fn applied(&self, draft: &Draft<3>, aux: &mut Self::Aux, plan: &Plan<3>, again: &mut Vec<Self::Site>) {
        EdgeCollapse::FULL.applied(draft, aux, plan, again);
    }
}

#[test]
fn determinism_sees_an_operator_with_moods() {
    let mesh = generate::bumpy_sphere(2, 0.1, 4);
    assert_eq!(verify::determinism(&mesh, &EdgeCollapse::FULL), Ok(()));
    let breach = verify::determinism(&mesh, &Moody(Default::default())).unwrap_err();
    assert_eq!(breach.law, Law::Determinism);
}

#[test]
fn half_edge_collapses_conform_where_orientations_do_not_agree() {
    // On a Möbius strip no orientation can count; the facets of a patch's boundary still do.
    let strip = generate::moebius(12);
    let model = model_of(&strip, &EdgeCollapse::HALF);
    assert!(!check::conformity(&model).unwrap().oriented);
    assert_eq!(verdict(&model), None);
}
