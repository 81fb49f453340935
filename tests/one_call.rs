//! One call judges what anybody writes: right operators, orders, models, criteria and strategies pass; wrong ones come back
//! as examples of a few triangles, also from models of seventy thousand.

use mt_core::check::Law;
use mt_core::hierarchy::{Dependency, HierarchyError, VertexMesh};
use mt_core::model::View;
use mt_core::{Bound, Coarsen, Explicit, Mesh, NodeId, Replay, Rule, generate};
use mt_tests::{Careless, VertexIntoNeighbour, model_of};
use multi_tessellation::verify::{self, Finding, Topology, Trial};
use operators::order::{ImplicitIds, Stored};
use operators::{EdgeCollapse, FanMerge, VertexPair};
use selective::{Criterion, Limits, ScreenError, UniformError, adapt, wish_closure};
use std::time::{Duration, Instant};

/// Findings of these tests are not for keeping.
fn trial() -> Trial {
    Trial { folder: Some(std::env::temp_dir().join("mt-one-call")), keep_seeds: false, ..Trial::default() }
}

// What is right passes

#[test]
fn our_operators_pass() {
    for operator in [EdgeCollapse::FULL, EdgeCollapse::HALF] {
        let tally = verify::operator(&operator);
        assert!(tally.judged > 20 && tally.merging == tally.judged, "{tally}");
        for law in [Law::Conformity, Law::CrackFree, Law::Quotient, Law::Minimality, Law::Partition, Law::Determinism] {
            assert!(tally.checks[&law] > 20, "{law}: {tally}");
        }
    }
    assert!(verify::operator(&FanMerge::PARTIAL).merging > 20);
    let coarsened = Trial { topology: Topology::Coarsened, ..trial() };
    assert!(verify::operator_in(&coarsened, &VertexPair::default()).unwrap().judged > 20);
    // Tetrahedra have no hierarchies of merges here, and say so by their count.
    let tally = verify::operator::<4, _>(&VertexIntoNeighbour);
    assert!(tally.judged > 20 && tally.merging == 0, "{tally}");
}

#[test]
fn our_orders_pass_and_dynamic_ones_by_the_weaker_laws() {
    let tally = verify::order("four-face", |replay| Stored::four_face(replay));
    assert!(tally.checks.contains_key(&Law::Closure) && tally.checks.contains_key(&Law::Partition));
    let tally = verify::order("implicit-ids", |_| Ok(ImplicitIds));
    assert!(!tally.checks.contains_key(&Law::Closure) && tally.checks.contains_key(&Law::Quotient));
}

#[test]
fn a_model_of_ones_own_passes() {
    let tally =
        verify::models::<3, Explicit<3>>(&trial(), "edge collapses", |mesh| Ok(model_of(mesh, &EdgeCollapse::FULL)));
    assert!(tally.judged > 20 && tally.checks[&Law::CrackFree] > 100, "{tally}");
}

#[test]
fn criteria_and_strategies_pass() {
    let tally = verify::criterion("screen", |model, random| {
        let (low, high) = model.reference().bounding_box().unwrap();
        let from = glam::Vec3::new(random.unit() as f32, 0.5, 1.0);
        ScreenError::new(&mt_core::Camera::around(low, high, from), (8.0 * random.unit()) as f32)
    });
    assert!(tally.judged > 20, "{tally}");
    let tally = verify::strategy("adapt", |model, wish, state| {
        adapt(model, wish, &Limits::NONE, state);
    });
    assert!(tally.judged > 20, "{tally}");
}

// What is wrong is found, and comes back small

fn found(finding: Result<verify::Tally, Box<Finding>>) -> Finding {
    let finding = *finding.expect_err("the fault was not seen");
    for (file, text) in finding.files.iter().zip([&finding.obj, &finding.log, &finding.test]) {
        assert_eq!(std::fs::read_to_string(file).unwrap(), *text);
    }
    assert_eq!(finding.files.len(), 3);
    assert!(finding.to_string().contains(&finding.test) && finding.test.contains("#[test]"), "{finding}");
    finding
}

#[test]
fn careless_operators_are_found_out() {
    for (careless, laws) in [
        (Careless::Link, &[Law::Conformity, Law::CrackFree][..]),
        (Careless::Cell, &[Law::Conformity]),
        (Careless::Panic, &[Law::Conduct]),
        (Careless::Gone, &[Law::Conduct, Law::Conformity, Law::CrackFree]),
        (Careless::Ever, &[Law::Conduct]),
    ] {
        let finding = found(verify::operator_in(&trial(), &careless));
        println!("{careless:?}: {finding}");
        assert!(laws.contains(&finding.breach.law), "{careless:?}: {}", finding.breach);
        assert!(finding.cells <= 36, "{careless:?}: {} cells\n{}", finding.cells, finding.sizes);
    }
}

#[test]
fn of_seventy_thousand_triangles_a_few_dozen_are_left_within_a_minute() {
    for careless in [Careless::Link, Careless::Cell, Careless::Panic] {
        // A closed surface with handles, on which a missing link condition shows early.
        let mesh = generate::torus(350, 100);
        assert_eq!(mesh.cell_count(), 70_000);
        let clock = Instant::now();
        let options = verify::Options { fronts: 4, ..verify::Options::default() };
        let finding = verify::operator_on(&mesh, &careless, &options).unwrap_err();
        println!("{careless:?}: {} in {:?}: {}", finding.sizes, clock.elapsed(), finding.breach);
        assert!(finding.cells <= 48, "{careless:?}: {}", finding.sizes);
        assert!(clock.elapsed() < Duration::from_secs(60), "{careless:?} took {:?}", clock.elapsed());
    }
}

#[test]
fn a_wrong_cell_in_a_large_history_is_left_by_itself() {
    // Somebody else's simplifier, told as text: one cell of seventy thousand is turned over.
    let mesh = generate::torus(350, 100);
    let model = model_of(&mesh, &EdgeCollapse::FULL);
    let mut parts = model.parts().clone();
    let node = model.order().len() / 3;
    let made = parts.coarse_start[node as usize] as usize;
    parts.corners[made].swap(0, 1);
    let broken = Explicit::from_parts(parts).unwrap();
    let clock = Instant::now();
    let found = verify::explicit(&broken, &verify::Options::default(), &mut |_| true).unwrap_err();
    println!("{} in {:?}: {}", found.sizes(), clock.elapsed(), found.breach);
    assert_eq!((found.breach.law, found.found.breach.node), (Law::Conformity, Some(NodeId(node))));
    let verify::Case::Cells(small) = &found.case else { panic!("no part was found") };
    assert!(small.order().len() == 1 && small.input_cell_count() <= 16, "{}", found.sizes());
    assert!(clock.elapsed() < Duration::from_secs(60));
    assert!(found.test("history", "", &verify::Options::default()).contains("history::read"));
}

// Orders

/// The forest and nothing else.
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

/// The same under a rule that claims less.
struct Anything;

impl Dependency for Anything {
    const RULE: Rule = Rule::Dynamic;
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
fn unsound_orders_come_with_a_witness() {
    let finding = found(verify::order_in(&trial(), "forest", |_| Ok(ForestAlone)));
    println!("{finding}");
    assert_eq!(finding.breach.law, Law::Order);
    assert!(finding.breach.what.contains("must wait for node") && finding.cells <= 24, "{finding}");
    let finding = found(verify::order_in(&trial(), "anything", |_| Ok(Anything)));
    println!("{finding}");
    assert!(matches!(finding.breach.law, Law::CrackFree | Law::Inverse), "{finding}");
    assert!(finding.cells <= 48, "{finding}");
    let finding = found(verify::order_in(&trial(), "of a user", |replay| {
        // One need too few: the last of the sound order's.
        let sound = Stored::dual_piece(replay)?;
        let entries: Vec<_> = sound.needs_rows().entries().collect();
        Stored::of_user(replay, entries.iter().copied().skip(1))
    }));
    assert!(finding.breach.what.contains("unsound"), "{finding}");
}

#[test]
fn an_order_that_takes_nothing_is_no_success() {
    let refusing = || {
        verify::order_in(&trial(), "refusing", |_| {
            Err::<ImplicitIds, _>(HierarchyError::Unfit { scheme: "refusing", why: "it is Monday".into() })
        })
    };
    let told = std::panic::catch_unwind(refusing).unwrap_err();
    assert!(told.downcast_ref::<String>().unwrap().contains("it is Monday"));
}

#[test]
fn of_a_large_sequence_a_few_triangles_are_left() {
    let mesh = generate::torus(350, 100);
    let replay = mt_tests::replay_of(&mesh, &"edge-collapse".parse().unwrap());
    let options = verify::Options { fronts: 4, ..verify::Options::default() };
    let clock = Instant::now();
    for (name, finding) in [
        ("forest", verify::order_on(&replay, "forest", |_| Ok(ForestAlone), &options)),
        ("anything", verify::order_on(&replay, "anything", |_| Ok(Anything), &options)),
    ] {
        let finding = finding.unwrap_err();
        println!("{name}: {}: {}", finding.sizes, finding.breach);
        assert!(finding.cells <= 48, "{name}: {}", finding.sizes);
    }
    assert!(clock.elapsed() < Duration::from_secs(60), "{:?}", clock.elapsed());
}

// Criteria and strategies

/// Asks below and not above: bounds that are small are looked at more closely.
struct Upside(f32);

impl Criterion<Bound> for Upside {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        self.0 - bound.error
    }
}

/// Not a number at the middle of the world.
struct Nan;

impl Criterion<Bound> for Nan {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        f32::NAN * bound.error
    }
}

#[test]
fn wrong_criteria_are_found_out() {
    let upside = |model: &Explicit<3>, _: &mut mt_core::check::Random| Upside(model.bound_error_middle());
    let finding = found(verify::criterion_in(&trial(), "upside", upside));
    println!("{finding}");
    assert!(finding.breach.what.contains("not monotone") && finding.cells <= 40, "{finding}");
    let finding = found(verify::criterion_in(&trial(), "nan", |_, _| Nan));
    assert!(finding.breach.what.contains("not a number"), "{finding}");
    let vacuous = || verify::criterion_in(&trial(), "never", |_, _| UniformError { error_max: f32::MAX });
    let told = std::panic::catch_unwind(vacuous).unwrap_err();
    assert!(told.downcast_ref::<String>().unwrap().contains("nothing was seen"));
}

trait Middle {
    fn bound_error_middle(&self) -> f32;
}

impl Middle for Explicit<3> {
    /// The median of the errors.
    fn bound_error_middle(&self) -> f32 {
        use mt_core::MultiTessellation;
        let mut errors: Vec<f32> = (0..self.len()).map(|m| self.bound(NodeId(m)).error).collect();
        errors.sort_by(f32::total_cmp);
        errors.get(errors.len() / 2).copied().unwrap_or(0.0)
    }
}

#[test]
fn wrong_strategies_are_found_out() {
    // It never coarsens.
    let finding = found(verify::strategy_in(&trial(), "greedy", |model, wish, state| {
        let target = wish_closure(model, wish);
        let missing: Vec<NodeId> = target.difference(state.front()).collect();
        missing.iter().rev().for_each(|&m| state.force(model, m));
    }));
    println!("{finding}");
    assert!(finding.breach.law == Law::Minimality && finding.cells <= 40, "{finding}");
    // It changes the mesh behind the log's back.
    let finding = found(verify::strategy_in(&trial(), "secretive", |model, wish, state| {
        adapt(model, wish, &Limits::NONE, state);
        state.steps.clear();
    }));
    assert_eq!(finding.breach.law, Law::FrontDeterminesMesh);
}

// A finding can be pasted

#[test]
fn a_finding_is_seen_again_on_its_own_mesh() {
    let finding = found(verify::operator_in(&trial(), &Careless::Cell));
    let mesh: Mesh<3> = mt_core::format::read(
        mt_core::format::Format::Obj,
        finding.log.split("the smallest mesh found:\n").nth(1).unwrap().split("\n\n").next().unwrap().as_bytes(),
        &Default::default(),
        &|_| None,
    )
    .unwrap()
    .0;
    assert_eq!(mesh.cell_count(), finding.cells);
    let again = verify::operator_on(&mesh, &Careless::Cell, &verify::Options::default()).unwrap_err();
    assert_eq!(again.breach.law, finding.breach.law);
}
