//! Criteria with runs and with memory, as engines meet them: dual paths on a model whose nodes come in runs, hysteresis
//! under a trembling camera, and what outcomes count.

use mt_core::check::Random;
use mt_core::explicit::Alive;
use mt_core::model::{MultiTessellation, View};
use mt_core::{Bound, Camera, Coarsen, Explicit, Front, NodeId, generate};
use mt_tests::{Answering, Answers, model_of};
use operators::EdgeCollapse;
use selective::{
    Criterion, Facing, FeaturePoints, Hysteresis, InRegion, Limits, Measure, Moving, NormalChange, OnPath, Outcome,
    Pace, Path, Reading, Region, ScreenError, Silhouette, State, Strategy, Transfer, UniformError, VisualError, Wish,
    adapt, approach, extract, wish_closure, wish_closure_after,
};
use std::ops::RangeInclusive;

/// A history of half-edge collapses cut into runs, each node of which needs the next: the shape of a fan hierarchy. What
/// is discovered where stays as it was, so the nodes of a run hang under nodes outside of it, too.
type InRuns = Answering<Runs>;

/// The first and the last node of each node's run.
struct Runs(Vec<(NodeId, NodeId)>);

fn in_runs(model: Explicit<3>, random: &mut Random) -> InRuns {
    let mut runs = Vec::new();
    while runs.len() < model.len() as usize {
        let first = runs.len();
        let last = (first + random.below(6)).min(model.len() as usize - 1);
        runs.resize(last + 1, (NodeId::new(first), NodeId::new(last)));
    }
    InRuns { model, answers: Runs(runs) }
}

impl Runs {
    fn next(&self, m: NodeId) -> Option<NodeId> {
        (m < self.0[m.index()].1).then_some(NodeId(m.0 + 1))
    }

    fn all(&self) -> impl Iterator<Item = (NodeId, NodeId)> + '_ {
        self.0.iter().copied().enumerate().filter(|(i, run)| run.0.index() == *i).map(|(_, run)| run)
    }
}

impl Answers for Runs {
    fn needs(&self, model: &Explicit<3>, m: NodeId, out: &mut Vec<NodeId>) {
        model.needs(m, out);
        out.extend(self.next(m));
    }
    fn prerequisites(&self, model: &Explicit<3>, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) {
        model.prerequisites(m, view, out);
        out.extend(self.next(m).filter(|&next| !view.front.is_refined(next)));
    }
    fn obstacles(&self, model: &Explicit<3>, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) -> Coarsen {
        let before = out.len();
        model.obstacles(m, view, out);
        let inner = m > self.0[m.index()].0;
        out.extend(inner.then(|| NodeId(m.0 - 1)).filter(|&previous| view.front.is_refined(previous)));
        if out.len() == before { Coarsen::Now } else { Coarsen::After }
    }
    fn run(&self, m: NodeId) -> RangeInclusive<NodeId> {
        let (first, last) = self.0[m.index()];
        first..=last
    }
}

fn model() -> Explicit<3> {
    model_of(&generate::bumpy_sphere(4, 0.15, 9), &EdgeCollapse::HALF)
}

fn camera(model: &Explicit<3>, turn: f32) -> Camera {
    let (low, high) = model.reference().bounding_box().unwrap();
    Camera { near: 0.05, ..Camera::around(low, high, glam::Vec3::new(turn.sin(), 0.3, turn.cos())) }
}

/// What the last node of a run has to say, written down once more: who is asked for, and what that needs.
fn closure_by_hand(model: &InRuns, criterion: &impl Criterion<Bound>, before: &Front) -> Front {
    let asks = |m: NodeId| criterion.asks(&model.bound(m), before.is_refined(m));
    let mut front = Front::base(model.len());
    for m in (0..model.len()).map(NodeId) {
        let last = model.answers.0[m.index()].1;
        let whole = criterion.pace(&model.bound(last)) == Pace::Whole && asks(last);
        let mut open = if asks(m) || whole { vec![m] } else { vec![] };
        while let Some(m) = open.pop() {
            if front.set(m, true) {
                model.needs(m, &mut open);
            }
        }
    }
    front
}

/// A closed front with runs that are refined in part: what a few random nodes need.
fn random_front(model: &InRuns, random: &mut Random) -> Front {
    let mut front = Front::base(model.len());
    let mut open: Vec<NodeId> =
        (0..random.below(40)).map(|_| NodeId::new(random.below(model.answers.0.len()))).collect();
    while let Some(m) = open.pop() {
        if front.set(m, true) {
            model.needs(m, &mut open);
        }
    }
    front
}

/// Runs of more than one node that one front has wholly and the other not at all, where they may count as one; and the
/// nodes in them.
fn runs_between(model: &InRuns, criterion: &impl Criterion<Bound>, one: &Front, other: &Front) -> (u32, u32) {
    let full = |front: &Front, run: (NodeId, NodeId)| (run.0.0..=run.1.0).all(|m| front.is_refined(NodeId(m)));
    let none = |front: &Front, run: (NodeId, NodeId)| (run.0.0..=run.1.0).all(|m| !front.is_refined(NodeId(m)));
    let whole = model.answers.all().filter(|&run| {
        run.0 < run.1
            && criterion.pace(&model.bound(run.1)) != Pace::Single
            && (full(one, run) && none(other, run) || none(one, run) && full(other, run))
    });
    whole.fold((0, 0), |(runs, nodes), run| (runs + 1, nodes + run.1.0 - run.0.0 + 1))
}

fn paths(eye: glam::Vec3) -> [Path; 4] {
    [Path::Fine, Path::Difference, Path::Distance { eye, beyond: eye.length() }, Path::Coarse]
}

/// Goes from `before` to `criterion` in every way there is; the front, and what extract did.
fn every_way(model: &InRuns, criterion: &impl Criterion<Bound>, before: &Front) -> (Front, Outcome) {
    let wanted = closure_by_hand(model, criterion, &Front::base(model.len()));
    assert_eq!(wanted, wish_closure(model, criterion));
    let mut extracted = Outcome::default();
    for strategy in [Strategy::TopDown, Strategy::Priority] {
        let (state, outcome) = extract(model, criterion, &Limits::NONE, strategy, ());
        extracted = outcome;
        assert_eq!(*state.front(), wanted, "{strategy:?}");
        assert_eq!(outcome.runs, runs_between(model, criterion, &Front::base(model.len()), &wanted).0);
        let asked = (0..model.len()).map(NodeId).filter(|&m| {
            let last = model.bound(model.answers.0[m.index()].1);
            criterion.asks(&model.bound(m), false)
                || criterion.pace(&last) == Pace::Whole && criterion.asks(&last, false)
        });
        assert_eq!(outcome.forced, wanted.len() - asked.count() as u32);
    }
    let mut state = State::new(model, ());
    approach(model, before, &mut state);
    let outcome = adapt(model, criterion, &Limits::NONE, &mut state);
    assert_eq!(*state.front(), wanted);
    let net = wanted.difference(before).count() + before.difference(&wanted).count();
    let (runs, nodes) = runs_between(model, criterion, before, &wanted);
    if net as u32 == outcome.refined + outcome.coarsened {
        assert_eq!((outcome.runs, outcome.singles), (runs, net as u32 - nodes));
    }
    assert!(adapt(model, criterion, &Limits::NONE, &mut state).singles == 0);
    (wanted, extracted)
}

#[test]
fn every_path_ends_in_its_least_closure_from_wherever_it_comes() {
    let mut random = Random::new(7);
    let plain = model();
    let model = in_runs(plain.clone(), &mut random);
    let (mut between, mut runs) = (0, (0, 0));
    for i in 0..24 {
        let camera = camera(&plain, i as f32);
        let screen = ScreenError::new(&camera, 1.0 + 12.0 * random.unit() as f32);
        let before = random_front(&model, &mut random);
        let on = |path| every_way(&model, &OnPath { criterion: screen.clone(), path }, &before);
        let [(fine, single), (difference, together), (distance, _), (coarse, whole)] = paths(camera.eye).map(on);
        assert_eq!(fine, difference);
        assert!(fine.is_subset(&distance) && distance.is_subset(&coarse));
        between += u32::from(fine != distance && distance != coarse);
        runs = (runs.0 + together.runs, runs.1 + whole.runs);
        assert_eq!(single.runs, 0);
        assert_eq!(single.refined, single.singles);
        assert_eq!(fine, *extract(&model, &screen, &Limits::NONE, Strategy::TopDown, ()).0.front());
    }
    assert!(between > 0, "distance never told runs apart");
    assert!(0 < runs.0 && runs.0 < runs.1, "{runs:?} runs changed as one");
}

/// Here the last node of a run is often asked for and refined while what its other nodes hang under is neither, so that
/// they are come upon by their run alone.
#[test]
fn runs_in_a_region_are_completed() {
    let mut random = Random::new(1);
    let model = in_runs(model(), &mut random);
    for _ in 0..60 {
        let mut node = || model.bound(NodeId::new(random.below(model.answers.0.len())));
        let (at, error_max) = (node().center, node().error);
        let region = Region { low: at - 0.05, high: at + 0.05 };
        let criterion = OnPath { criterion: InRegion { region, error_max }, path: Path::Coarse };
        let before = random_front(&model, &mut random);
        every_way(&model, &criterion, &before);
    }
}

#[test]
fn on_the_coarse_path_the_last_node_decides_for_its_run() {
    let mut random = Random::new(3);
    let model = in_runs(model(), &mut random);
    for _ in 0..10 {
        let error_max = model.bound(NodeId::new(random.below(model.answers.0.len()))).error;
        let criterion = OnPath { criterion: UniformError { error_max }, path: Path::Coarse };
        let (state, _) = extract(&model, &criterion, &Limits::NONE, Strategy::TopDown, ());
        for (first, last) in model.answers.all() {
            if criterion.asks(&model.bound(last), false) {
                assert!(state.front().is_refined(first));
            }
        }
    }
}

#[test]
fn budgets_hold_on_every_path_and_come_to_rest() {
    let mut random = Random::new(5);
    let plain = model();
    let model = in_runs(plain.clone(), &mut random);
    let camera = camera(&plain, 1.0);
    for path in paths(camera.eye) {
        let mut state = State::new(&model, ());
        for cells in [20, 333, 90, 2000, 50] {
            let criterion = OnPath { criterion: ScreenError::new(&camera, 0.5), path };
            let limits = Limits { cells: Some(cells), time: None };
            let outcome = adapt(&model, &criterion, &limits, &mut state);
            assert!(state.cell_count(&model) <= cells && outcome.refined + outcome.coarsened > 0);
            assert_eq!(*state.front(), *extract(&model, &criterion, &limits, Strategy::Priority, ()).0.front());
            let rested = adapt(&model, &criterion, &limits, &mut state);
            assert_eq!((rested.refined, rested.coarsened, rested.runs, rested.singles), (0, 0, 0, 0));
        }
    }
}

/// A camera that goes to and fro by a hair.
fn trembling(model: &Explicit<3>, frame: u32) -> Camera {
    let camera = camera(model, 0.4);
    let step = camera.direction() * if frame.is_multiple_of(2) { 0.0 } else { 0.02 };
    Camera { eye: camera.eye + step, target: camera.target + step, ..camera }
}

#[test]
fn hysteresis_does_not_flicker_where_the_plain_criterion_does() {
    let model = model();
    let flips = |margin: f32| {
        let mut state = State::new(&model, ());
        let mut flips = Vec::new();
        for frame in 0..20 {
            let criterion = Hysteresis { criterion: ScreenError::new(&trembling(&model, frame), 4.0), margin };
            let outcome = adapt(&model, &criterion, &Limits::NONE, &mut state);
            flips.push(outcome.refined + outcome.coarsened);
        }
        // Both have to get there; then the camera only trembles.
        flips[2..].iter().sum::<u32>()
    };
    assert!(flips(0.0) > 18, "{}", flips(0.0));
    assert_eq!(flips(0.5), 0);
}

#[test]
fn memory_ends_in_the_least_closure_of_what_it_remembers() {
    let mut random = Random::new(11);
    let plain = model();
    let model = in_runs(plain.clone(), &mut random);
    let mut kept = 0;
    for path in paths(camera(&plain, 0.0).eye) {
        let (mut state, mut wide) = (State::new(&model, ()), State::new(&model, ()));
        for i in 0..12 {
            let screen = ScreenError::new(&camera(&plain, 0.3 * i as f32), 3.0 + 4.0 * random.unit() as f32);
            let criterion = OnPath { criterion: Hysteresis { criterion: screen.clone(), margin: 2.0 }, path };
            let wanted = closure_by_hand(&model, &criterion, state.front());
            assert_eq!(wanted, wish_closure_after(&model, &criterion, state.front()));
            adapt(&model, &criterion, &Limits::NONE, &mut state);
            assert_eq!(*state.front(), wanted);
            let plain = OnPath { criterion: screen, path };
            kept += wanted.difference(&wish_closure(&model, &plain)).count();
            // A budget that does not bind changes nothing, so the search remembers too.
            adapt(&model, &criterion, &Limits { cells: Some(u32::MAX), time: None }, &mut wide);
            assert_eq!(*wide.front(), wanted);
        }
    }
    assert!(kept > 0, "hysteresis never kept anything");
}

/// One of each criterion for a camera.
fn wishes(model: &Explicit<3>, camera: &Camera) -> Vec<Wish> {
    let eye = camera.eye;
    let screen = |error_px| Wish::Screen(Box::new(ScreenError::new(camera, error_px)));
    let positions = &model.positions()[..model.input_vertex_count() as usize];
    let visual =
        |reading, scale| VisualError { eye, light: glam::Vec3::Y, epsilon: 0.1, scale, error_min: 1e-3, reading };
    let knots = vec![(2.0, 0.001), (3.0, 0.01), (4.0, 0.1)];
    vec![
        screen(4.0),
        Wish::Facing(Box::new(Facing { eye, criterion: screen(2.0) })),
        Wish::Silhouette(Box::new(Silhouette { eye, outline: screen(1.0), elsewhere: screen(9.0) })),
        Wish::Features(Box::new(FeaturePoints::pick(positions, |i| i % 97 == 5, 0.0, 0.05))),
        Wish::Any(vec![screen(9.0), Wish::Normals(NormalChange { angle_max: 1.2 })]),
        Wish::Visual(Box::new(visual(Reading::Tolerance, 0.1))),
        Wish::Visual(Box::new(visual(Reading::Error, 0.02))),
        Wish::Transfer(Box::new(Transfer::new(eye, Measure::Distance, knots).unwrap())),
        Wish::Moving(Box::new(Moving::new(screen(2.0), 5.0, 0.3, 3.0))),
    ]
}

#[test]
fn every_criterion_ends_in_its_least_closure() {
    let model = model();
    let mut state = State::new(&model, ());
    for turn in [0.0, 0.1, 2.0] {
        for wish in wishes(&model, &camera(&model, turn)) {
            let wanted = wish_closure(&model, &wish);
            let name = wish.name();
            assert!(!wanted.is_empty() && wanted.len() < model.len(), "{name} asks for {} nodes", wanted.len());
            for strategy in [Strategy::TopDown, Strategy::Priority] {
                assert_eq!(*extract(&model, &wish, &Limits::NONE, strategy, ()).0.front(), wanted, "{name}");
            }
            adapt(&model, &wish, &Limits::NONE, &mut state);
            assert_eq!(*state.front(), wanted, "{name}");
        }
    }
}

#[test]
fn back_faces_and_outlines_change_a_mesh_as_they_should() {
    let model = model();
    let camera = camera(&model, 0.0);
    let nodes = |wish: &dyn Fn() -> Wish| wish_closure(&model, &wish());
    let screen = |error_px| Wish::Screen(Box::new(ScreenError::new(&camera, error_px)));
    let all = nodes(&|| screen(1.0));
    let facing = nodes(&|| Wish::Facing(Box::new(Facing { eye: camera.eye, criterion: screen(1.0) })));
    // Half of a closed surface faces away, but coarse patches have wide cones, and what is seen needs some of the rest.
    assert!(facing.is_subset(&all) && facing.len() * 10 < all.len() * 9, "{} of {}", facing.len(), all.len());
    let outlined = nodes(&|| {
        Wish::Silhouette(Box::new(Silhouette { eye: camera.eye, outline: screen(1.0), elsewhere: screen(30.0) }))
    });
    assert!(outlined.is_subset(&all) && nodes(&|| screen(30.0)).is_subset(&outlined));
    assert!(outlined.len() < all.len(), "{} of {}", outlined.len(), all.len());
}

#[test]
fn chains_say_what_each_forcing_took() {
    let model = model();
    let criterion = ScreenError::new(&camera(&model, 0.0), 2.0);
    for strategy in [Strategy::TopDown, Strategy::Priority] {
        let (mut state, outcome) = extract(&model, &criterion, &Limits::NONE, strategy, ());
        let chains = state.chains();
        assert_eq!(chains.iter().sum::<u32>(), outcome.refined);
        assert_eq!(chains.iter().copied().max(), Some(outcome.chain_max));
        assert!(outcome.chain_max > 1 && outcome.forced <= outcome.refined - chains.len() as u32);
        let rested = adapt(&model, &criterion, &Limits::NONE, &mut state);
        assert!(state.chains().is_empty() && rested.chain_max == 0);
    }
    // Under a budget, of the chains that fitted.
    let limits = Limits { cells: Some(200), time: None };
    let (extracted, one) = extract(&model, &criterion, &limits, Strategy::Priority, ());
    let mut adapted = State::new(&model, ());
    let other = adapt(&model, &criterion, &limits, &mut adapted);
    assert_eq!((one, extracted.chains()), (other, adapted.chains()));
    assert_eq!(one.refined, extracted.chains().iter().sum::<u32>());
}
