//! What can be done in a window, without one: views of every kind of model go where they are told and back, colours and picks
//! say what is so, and nothing that keys ask for in any sequence breaks a view.

use glam::Vec3;
use mt_core::analysis::{Options, analyse, simplify};
use mt_core::check::Random;
use mt_core::{Mesh, MultiTessellation, Replay, Sequence, generate};
use mt_viewer::{Action, AnyView, Ask, BINDINGS, Choice, Extent, Make, Pane, Subject, ViewFrom, Viewer, view_of};
use operators::order::Scheme;
use operators::{AnyOperator, EdgeCollapse};
use papers::study::{CriterionKind, DependencyKind, StrategyKind};
use render::Tint;
use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

const SIZE: [u32; 2] = [320, 240];

fn surface() -> Mesh<3> {
    generate::genus_surface(2, 6, 0.02, 3)
}

fn replay(operator: &str) -> Arc<Replay> {
    let (mesh, operator) = (surface(), operator.parse::<AnyOperator>().unwrap());
    let mut sequence = Sequence::new(&mesh);
    operator.analyse(&mesh, &Options::default(), &mut sequence, &mut |_| true).unwrap();
    Arc::new(Replay::new(&mesh, &operator.links(&mesh), &sequence).unwrap())
}

fn made(choice: &Choice) -> Result<Box<dyn AnyView>, String> {
    let operator = choice.operator.as_deref().unwrap_or("edge-collapse");
    match choice.dependency {
        DependencyKind::Scheme(scheme) => {
            scheme.visit(&replay(operator), ViewFrom(Vec3::ZERO)).map_err(|error| error.to_string())
        }
        DependencyKind::Cells => {
            let analysis = simplify(&surface(), &EdgeCollapse::FULL, &Options::default(), &mut |_| true);
            Ok(view_of(Arc::new(analysis.map_err(|error| error.to_string())?.model), Vec3::ZERO))
        }
    }
}

/// A viewer of the surface, of which the first pane has this choice.
fn viewer(operator: Option<&str>, dependency: DependencyKind) -> Viewer {
    let choice = Choice { operator: operator.map(str::to_owned), dependency };
    let subject = Subject {
        name: "surface".into(),
        extent: Extent::of(&surface()),
        made_by: "edge-collapse".into(),
        words: Arc::new(|_| None),
    };
    let pane = Pane::new(0, choice.clone(), made(&choice).unwrap());
    let make: Make = Arc::new(|_, choice| made(choice));
    let mut viewer = Viewer::new(vec![subject], vec![pane], make, Vec::new());
    viewer.ask.error_px = 0.3;
    viewer
}

/// The mesh as triangles of positions, in any sequence.
fn triangles(play: &dyn AnyView) -> BTreeSet<[[u32; 3]; 3]> {
    let mesh = play.mesh();
    let mut triangles = BTreeSet::new();
    for cell in &mesh.cells {
        let mut at = cell.map(|v| mesh.positions[v.index()].to_array().map(f32::to_bits));
        let least = (0..3).min_by_key(|&i| at[i]).unwrap();
        at.rotate_left(least);
        triangles.insert(at);
    }
    triangles
}

/// The places hold the mesh and nothing else.
fn places_are_the_mesh(play: &dyn AnyView) {
    let mut placed: Vec<[[f32; 3]; 3]> = play.places().triangles().map(|(_, at)| at.map(|c| c.position)).collect();
    let mesh = play.mesh();
    let mut cells: Vec<[[f32; 3]; 3]> =
        mesh.cells.iter().map(|cell| cell.map(|v| mesh.positions[v.index()].to_array())).collect();
    let key = |triangle: &[[f32; 3]; 3]| triangle.map(|p| p.map(f32::to_bits));
    placed.sort_by_key(key);
    cells.sort_by_key(key);
    assert!(placed == cells);
}

fn orbit(viewer: &mut Viewer, frames: u32) {
    for _ in 0..frames {
        viewer.pilot.turn(glam::Vec2::new(0.2, 0.03));
        viewer.frame(SIZE);
    }
}

#[test]
fn time_goes_both_ways() {
    let kinds =
        [DependencyKind::Cells, DependencyKind::Scheme(Scheme::DualPiece), DependencyKind::Scheme(Scheme::ImplicitIds)];
    for kind in kinds {
        let mut viewer = viewer(None, kind);
        viewer.pilot.zoom(0.5);
        orbit(&mut viewer, 6);
        let pane = &mut viewer.panes[0];
        let (now, steps) = (triangles(&*pane.view), pane.view.log().steps.len());
        assert!(steps > 50 && pane.view.is_log_whole());
        let ends = pane.view.log().frame_ends.clone();
        pane.frame(false);
        assert_eq!(pane.view.at(), ends[ends.len() - 2]);
        pane.step(-1);
        let between = triangles(&*pane.view);
        assert!(between != now);
        places_are_the_mesh(&*pane.view);
        pane.seek(0);
        assert_eq!(pane.view.nodes()[0], 0);
        pane.step(-1);
        assert_eq!(pane.view.at(), 0);
        // A view in the past does not adapt.
        viewer.frame(SIZE);
        assert_eq!(viewer.panes[0].view.at(), 0);
        let pane = &mut viewer.panes[0];
        pane.seek(ends[ends.len() - 2] - 1);
        assert!(triangles(&*pane.view) == between);
        pane.seek(usize::MAX);
        assert!(triangles(&*pane.view) == now);
        is_followed(pane);
        // Another view takes the log, and comes to the same meshes by it, played as by one leap.
        let log = pane.view.log().clone();
        let mut again = self::viewer(None, kind);
        again.frame(SIZE);
        again.panes[0].take_log(log.clone()).unwrap();
        assert!(again.panes[0].view.is_past() && again.panes[0].view.nodes()[0] == 0);
        again.act(Action::PlayLog, SIZE);
        let mut frames = 0;
        while again.is_log_played {
            again.frame(SIZE);
            frames += 1;
        }
        assert_eq!(frames, log.frame_ends.len());
        assert!(triangles(&*again.panes[0].view) == now);
        let other = mt_core::log::Log::new(3);
        assert!(again.panes[0].take_log(other).is_err());
        assert!(triangles(&*again.panes[0].view) == now);
    }
}

/// A log is text that another view of the model can follow, step by legal step.
fn is_followed(pane: &Pane) {
    let mut text = Vec::new();
    pane.view.log().write(&mut text).unwrap();
    let read = mt_core::log::Log::read(text.as_slice()).unwrap();
    assert_eq!(&read, pane.view.log());
    let mut other = pane.beside();
    other.take_log(read).unwrap();
    other.go_on();
    assert!(triangles(&*other.view) == triangles(&*pane.view));
}

#[test]
fn every_strategy_comes_to_the_same_mesh_and_leaves_a_log() {
    let mut dynamic = BTreeSet::new();
    for kind in [
        DependencyKind::Cells,
        DependencyKind::Scheme(Scheme::DualPiece),
        DependencyKind::Scheme(Scheme::DualPieceFree),
    ] {
        let mut seen: Option<BTreeSet<_>> = None;
        for strategy in [StrategyKind::Incremental, StrategyKind::TopDown, StrategyKind::Priority] {
            let mut viewer = viewer(None, kind);
            viewer.ask.strategy = strategy;
            orbit(&mut viewer, 3);
            let pane = &viewer.panes[0];
            let found = triangles(&*pane.view);
            places_are_the_mesh(&*pane.view);
            is_followed(pane);
            if kind == DependencyKind::Scheme(Scheme::DualPieceFree) {
                // There the mesh may depend on the way.
                dynamic.insert(found.len());
                continue;
            }
            assert!(*seen.get_or_insert_with(|| found.clone()) == found, "{strategy} {}", kind.name());
        }
    }
    assert!(dynamic.iter().all(|&count| count > 100));
}

/// Motion asks for less than rest; when the eye stands still the mesh becomes what it is at rest.
#[test]
fn a_moving_eye_comes_to_rest() {
    let mut viewer = viewer(None, DependencyKind::Scheme(Scheme::DualPiece));
    viewer.ask.criterion = CriterionKind::Moving;
    viewer.frame(SIZE);
    viewer.frame(SIZE);
    let at_rest = viewer.panes[0].facts.triangles;
    viewer.pilot.turn(glam::Vec2::new(0.4, 0.0));
    viewer.frame(SIZE);
    let in_motion = viewer.panes[0].facts.triangles;
    assert!(in_motion < at_rest && viewer.is_moving());
    let mut frames = 0;
    while viewer.is_moving() {
        viewer.frame(SIZE);
        frames += 1;
        assert!(frames < 9);
    }
    assert!(viewer.panes[0].facts.triangles > in_motion);
}

#[test]
fn a_frozen_front_stays_until_another_is_asked_for() {
    let mut viewer = viewer(None, DependencyKind::Scheme(Scheme::DualPiece));
    viewer.frame(SIZE);
    let camera = viewer.camera(SIZE);
    assert_eq!(viewer.act(Action::Freeze, SIZE), None);
    let before = triangles(&*viewer.panes[0].view);
    orbit(&mut viewer, 5);
    assert!(triangles(&*viewer.panes[0].view) == before);
    let scene = viewer.scene(0, &camera);
    assert!(!scene.segments.is_empty(), "the frustum is drawn");
    viewer.act(Action::Finer, SIZE);
    viewer.act(Action::Finer, SIZE);
    viewer.frame(SIZE);
    assert!(triangles(&*viewer.panes[0].view).len() > before.len());
    viewer.act(Action::Freeze, SIZE);
    assert_eq!(viewer.camera(SIZE).eye, camera.eye);
}

/// The closure of the needs of a node less what is refined, by looking at all of them; what is refined is read off the log.
#[test]
fn a_pick_tells_the_chain_that_the_order_forces() {
    let model = simplify(&surface(), &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap().model;
    let mut viewer = viewer(None, DependencyKind::Cells);
    viewer.ask.error_px = 2.0;
    viewer.frame(SIZE);
    let play = &viewer.panes[0].view;
    let mut refined = HashSet::new();
    for step in &play.log().steps {
        assert!(if step.refined { refined.insert(step.node) } else { refined.remove(&step.node) });
    }
    let mut lengths = BTreeSet::new();
    let present: HashSet<_> = play.places().triangles().map(|(placed, _)| placed.cell).collect();
    for (placed, _) in play.places().triangles() {
        let picked = play.pick(placed, placed.corners[0]);
        let came_with = picked.came_with.map(|facts| facts.node);
        assert!(came_with.is_none_or(|m| refined.contains(&m) && model.fine_side(m).contains(&placed.cell)));
        // All that the node it came with needs, by closing from above; all of it is refined.
        if let Some(came_with) = came_with {
            let (mut open, mut above, mut needs) = (vec![came_with], BTreeSet::new(), Vec::new());
            while let Some(m) = open.pop() {
                if above.insert(m) {
                    needs.clear();
                    model.needs(m, &mut needs);
                    open.extend(&needs);
                }
            }
            assert!(above.len() == picked.ancestor_count && above.is_subset(&refined.iter().copied().collect()));
            assert!(picked.ancestors.iter().all(|m| above.contains(m)) && picked.level <= above.len());
        }
        let Some(facts) = picked.refined_by else { continue };
        assert!(model.coarse_side(facts.node).any(|cell| cell == placed.cell));
        let (mut open, mut closure, mut needs) = (vec![facts.node], BTreeSet::new(), Vec::new());
        while let Some(m) = open.pop() {
            if !refined.contains(&m) && closure.insert(m) {
                needs.clear();
                model.needs(m, &mut needs);
                open.extend(&needs);
            }
        }
        let chain: BTreeSet<_> = picked.chain.iter().map(|facts| facts.node).collect();
        assert_eq!((&chain, picked.chain_length), (&closure, closure.len()));
        // The triangles of the mesh that go are the coarse sides of these nodes, as far as they are there.
        let gone: HashSet<_> =
            chain.iter().flat_map(|&m| model.coarse_side(m)).filter(|c| present.contains(c)).collect();
        assert_eq!(picked.replaced.intersection(&present).copied().collect::<HashSet<_>>(), gone);
        lengths.insert(picked.chain_length);
    }
    assert!(lengths.len() > 1, "chains of one length only are no test: {lengths:?}");
}

#[test]
fn what_is_picked_is_marked() {
    for kind in
        [DependencyKind::Cells, DependencyKind::Scheme(Scheme::OneRing), DependencyKind::Scheme(Scheme::DualPieceFree)]
    {
        let mut viewer = viewer(None, kind);
        viewer.ask.error_px = 2.0;
        viewer.frame(SIZE);
        let camera = viewer.camera(SIZE);
        let middle = glam::Vec2::new(160.0, 120.0);
        let spots =
            [0.0f32, 0.2, 0.4, 0.6, 0.8, 1.0].map(|turn| glam::Vec2::from_angle(turn * std::f32::consts::TAU) * 60.0);
        let found = spots.into_iter().find(|&spot| {
            viewer.pick(0, &camera, middle + spot);
            viewer.panes[0].picked.is_some()
        });
        assert!(found.is_some(), "{}", kind.name());
        let picked = viewer.panes[0].picked.clone().unwrap();
        let scene = viewer.scene(0, &camera);
        assert!(!scene.segments.is_empty());
        let yellow = viewer.panes[0].view.places().triangles().filter(|(_, at)| at[0].colour[0] > 240).count();
        let replaced = viewer.panes[0].view.places().triangles().filter(|(one, _)| picked.replaced.contains(&one.cell));
        assert_eq!(yellow, replaced.count());
        viewer.act(Action::Unpick, SIZE);
        assert!(viewer.scene(0, &camera).segments.is_empty());
    }
}

#[test]
fn colours_tell_what_is_so() {
    let mut viewer = viewer(Some("fan-merge"), DependencyKind::Scheme(Scheme::ImplicitIds));
    viewer.ask.error_px = 1.0;
    viewer.ask.strategy = StrategyKind::Coarse;
    orbit(&mut viewer, 2);
    let camera = viewer.camera(SIZE);
    let mut colours = |tint| {
        viewer.shown.tint = tint;
        let scene = viewer.scene(0, &camera);
        let places = viewer.panes[0].view.places();
        let seen: BTreeSet<[u8; 4]> = places.triangles().map(|(_, at)| at[0].colour).collect();
        (seen, scene.legend)
    };
    let (plain, legend) = colours(Tint::Plain);
    assert_eq!((plain.len(), legend), (1, None));
    for tint in [Tint::Error, Tint::Level] {
        let (seen, legend) = colours(tint);
        assert!(seen.len() > 3 && legend.is_some_and(|legend| legend.range.1 > 0.0), "{tint:?}");
    }
    // Along the coarse path fans are whole but where others need a part.
    assert!(colours(Tint::Fans).0.len() >= 2);
    assert!(colours(Tint::Operations).0.len() >= 2);
    assert!(colours(Tint::Plain).0 == plain);
}

/// A scheme that forces more shows more red; what asks for everything forces nothing.
#[test]
fn forced_triangles_are_red() {
    let red = |kind, error_px, strategy| {
        let mut viewer = viewer(None, kind);
        viewer.ask.error_px = error_px;
        viewer.ask.strategy = strategy;
        viewer.pilot.zoom(0.4);
        viewer.shown.tint = Tint::Forced;
        viewer.frame(SIZE);
        let camera = viewer.camera(SIZE);
        viewer.scene(0, &camera);
        let triangles = viewer.panes[0].view.places().triangles();
        triangles.filter(|(_, at)| at[0].colour[0] > 210).count()
    };
    let [ring, piece] = [Scheme::OneRing, Scheme::DualPiece].map(DependencyKind::Scheme);
    let usual = StrategyKind::Incremental;
    assert!(red(ring, 0.5, usual) > red(piece, 0.5, usual));
    assert!(red(ring, 0.5, StrategyKind::Hysteresis) > 0);
    assert_eq!(red(piece, 1e3, usual), 0);
}

/// Red is for cracks and for edges of many triangles, blue for a boundary that must be there.
#[test]
fn boundaries_are_blue_and_no_crack_is_ever_drawn() {
    let is_red = |segment: &&render::Segment| segment.colour[0] > 150;
    for kind in [DependencyKind::Cells, DependencyKind::Scheme(Scheme::FourFace)] {
        let mut closed = viewer(None, kind);
        closed.shown.edges = true;
        for _ in 0..4 {
            orbit(&mut closed, 1);
            let camera = closed.camera(SIZE);
            assert!(closed.scene(0, &camera).marks.is_empty());
        }
    }
    let terrain = generate::terrain(12, 0.5, 3);
    let model = simplify(&terrain, &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap().model;
    let mut sequence = Sequence::new(&terrain);
    analyse(&terrain, &EdgeCollapse::FULL, &Options::default(), &mut sequence, &mut |_| true).unwrap();
    let replay = Arc::new(Replay::new(&terrain, &[], &sequence).unwrap());
    let views = [view_of(Arc::new(model), Vec3::ZERO), Scheme::OneRing.visit(&replay, ViewFrom(Vec3::ZERO)).unwrap()];
    for view in views {
        let mut pane = Pane::new(0, Choice { operator: None, dependency: DependencyKind::Cells }, view);
        let (low, high) = terrain.bounding_box().unwrap();
        let extent = Extent::of(&terrain);
        for share in [1e-2, 1e-3, 1e-4] {
            let ask = Ask { criterion: CriterionKind::Uniform, error_share: share, ..Ask::usual(extent.cells) };
            let camera = mt_viewer::Pilot::around(low, high).camera(SIZE);
            pane.adapt(&ask, &ask.of(&extent, &camera, camera.eye), &camera, camera.eye);
            assert!(pane.view.boundary().is_some());
            let edges = pane.edges();
            assert!(edges.len() > 8 && !edges.iter().any(|edge| is_red(&edge)));
        }
    }
}

/// Keys in any sequence, as a cat would press them.
#[test]
fn whatever_is_pressed_the_views_hold() {
    let mut random = Random::new(7);
    for _ in 0..3 {
        let mut viewer = viewer(None, DependencyKind::Scheme(Scheme::DualPiece));
        for _ in 0..60 {
            let binding = &BINDINGS[random.below(BINDINGS.len())];
            viewer.act(binding.action, SIZE);
            viewer.pilot.turn(glam::Vec2::new(random.unit() as f32 - 0.5, 0.1));
            viewer.pilot.zoom(0.8 + 0.4 * random.unit() as f32);
            viewer.frame(SIZE);
            let camera = viewer.camera(SIZE);
            assert_eq!(camera.check(), Ok(()));
            for pane in 0..viewer.panes.len() {
                viewer.scene(pane, &camera);
                places_are_the_mesh(&*viewer.panes[pane].view);
            }
        }
        settle(&mut viewer);
        assert!((1..=2).contains(&viewer.panes.len()));
    }
}

/// Waits until nothing is being made.
fn settle(viewer: &mut Viewer) {
    let begun = Instant::now();
    while viewer.panes.iter().any(|pane| pane.waits().is_some()) {
        viewer.frame(SIZE);
        std::thread::sleep(Duration::from_millis(5));
        assert!(begun.elapsed() < Duration::from_secs(60));
    }
}

#[test]
fn another_choice_comes_when_it_is_made_and_what_cannot_be_made_is_told() {
    let mut viewer = viewer(None, DependencyKind::Scheme(Scheme::DualPiece));
    viewer.frame(SIZE);
    let camera = viewer.camera(SIZE);
    for scheme in Scheme::ALL {
        let choice = Choice { operator: None, dependency: DependencyKind::Scheme(scheme) };
        viewer.choose(0, choice.clone());
        settle(&mut viewer);
        viewer.frame(SIZE);
        assert_eq!((&viewer.panes[0].choice, viewer.camera(SIZE)), (&choice, camera));
        assert!(viewer.panes[0].facts.triangles > 4);
    }
    let kept = viewer.panes[0].choice.clone();
    // Schemes that cut a vertex along two edges refuse links.
    viewer.choose(
        0,
        Choice { operator: Some("vertex-pair".into()), dependency: DependencyKind::Scheme(Scheme::CutPair) },
    );
    settle(&mut viewer);
    assert_eq!(viewer.panes[0].choice, kept);
    assert!(viewer.message.contains("stays as it is"), "{}", viewer.message);
}

#[test]
fn every_question_can_be_put() {
    let mesh = surface();
    let extent = Extent::of(&mesh);
    let model = simplify(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap().model;
    let mut view = view_of(Arc::new(model.clone()), Vec3::ZERO);
    let pilot = mt_viewer::Pilot::around(extent.low, extent.high);
    for &criterion in CriterionKind::ALL {
        for &strategy in StrategyKind::ALL {
            let ask = Ask { criterion, strategy, ..Ask::usual(extent.cells) };
            let camera = pilot.camera(SIZE);
            let asked = ask.of(&extent, &camera, camera.eye);
            view.adapt(&asked);
            if criterion == CriterionKind::Budget {
                assert!(view.places().triangle_count() as u32 <= ask.cells.max(model.cell_count(&model.base())));
            }
            assert!(ask.told().contains(criterion.name()));
        }
    }
    places_are_the_mesh(&*view);
}

#[test]
fn two_panes_become_one_and_two_again() {
    let mut viewer = viewer(None, DependencyKind::Scheme(Scheme::DualPiece));
    viewer.frame(SIZE);
    viewer.act(Action::Split, SIZE);
    viewer.frame(SIZE);
    assert_eq!((viewer.panes.len(), viewer.active), (2, 1));
    assert!(triangles(&*viewer.panes[0].view) == triangles(&*viewer.panes[1].view));
    viewer.choose(1, Choice { operator: None, dependency: DependencyKind::Scheme(Scheme::OneRing) });
    settle(&mut viewer);
    viewer.act(Action::Split, SIZE);
    assert_eq!((viewer.panes.len(), viewer.active), (1, 0));
    viewer.act(Action::Split, SIZE);
    // The one that went is the one that comes.
    assert_eq!(viewer.panes[1].choice.dependency, DependencyKind::Scheme(Scheme::OneRing));
    assert_ne!(viewer.panes[0].version().view, viewer.panes[1].version().view);
}

#[test]
fn a_step_beyond_the_end_of_the_log_holds_nothing() {
    let mut viewer = viewer(None, DependencyKind::Cells);
    viewer.frame(SIZE);
    viewer.act(Action::StepForward, SIZE);
    viewer.act(Action::FrameForward, SIZE);
    assert!(!viewer.panes[0].is_held);
    viewer.act(Action::StepBack, SIZE);
    assert!(viewer.panes[0].is_held && viewer.panes[0].view.is_past());
    let held = triangles(&*viewer.panes[0].view);
    orbit(&mut viewer, 3);
    assert!(triangles(&*viewer.panes[0].view) == held);
    viewer.act(Action::Now, SIZE);
    viewer.frame(SIZE);
    assert!(!viewer.panes[0].is_held && triangles(&*viewer.panes[0].view) != held);
}
