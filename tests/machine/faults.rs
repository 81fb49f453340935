//! The machine sees: each fault planted in the engine is found, and shrinks to a few operations.

use crate::cases::{on_cells, on_merges};
use crate::engine::{Engine, Fault};
use crate::ops::{Op, ops};
use mt_core::generate;
use operators::order::Scheme;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};

/// How many random sequences may pass before the fault is seen.
const CASES: u32 = 600;

fn runner() -> TestRunner {
    let config = Config { cases: CASES, max_shrink_iters: 50_000, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

/// The shortest sequence of operations found after which something is wrong, and what.
fn found(play: impl Fn(&[Op]) -> Result<(), String>) -> Option<(Vec<Op>, String)> {
    let judge = |ops: &[Op]| play(ops).map_err(TestCaseError::fail);
    match runner().run(&ops(30), |ops| judge(&ops)) {
        Ok(()) => None,
        Err(TestError::Fail(why, ops)) => Some(without_idle(&play, ops, why.message().to_owned())),
        Err(TestError::Abort(why)) => panic!("{why}"),
    }
}

/// The same without the operations that are not needed: shrinking leaves some where one that goes moves another's mark.
fn without_idle(play: impl Fn(&[Op]) -> Result<(), String>, mut ops: Vec<Op>, mut why: String) -> (Vec<Op>, String) {
    let mut at = 0;
    while at < ops.len() {
        let mut fewer = ops.clone();
        fewer.remove(at);
        // A fault may as well be seen by an assertion of the library.
        let played = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| play(&fewer)));
        match played.unwrap_or_else(|_| Err("an assertion fails".into())) {
            Ok(()) => at += 1,
            Err(what) => (ops, why, at) = (fewer, what, 0),
        }
    }
    (ops, why)
}

/// How many operations a fault needs at the most, once shrunk.
const OPS_MAX: usize = 4;

/// Plants each fault; what is seen is told, and short.
fn plant(name: &str, unseen: &[Fault], play: impl Fn(Engine, &[Op]) -> Result<(), String>) {
    assert_eq!(found(|ops| play(Engine::default(), ops)), None, "{name} without a fault");
    for fault in Fault::ALL {
        let seen = found(|ops| play(Engine(Some(fault)), ops));
        assert_eq!(seen.is_none(), unseen.contains(&fault), "{name} {fault:?}: {seen:?}");
        let Some((ops, why)) = seen else { continue };
        let acts: Vec<_> = ops.iter().map(|op| op.act).collect();
        println!("{name} {fault:?}: {acts:?}: {}", why.get(..140).unwrap_or(&why));
        assert!(ops.len() <= OPS_MAX, "{name} {fault:?} needs {} operations: {ops:?}", ops.len());
    }
}

#[test]
fn every_planted_fault_is_seen_in_a_few_operations_on_cells() {
    let mesh = generate::bumpy_grid(5, 4, 0.5, 8);
    plant("cells", &[], |engine, ops| on_cells(&mesh, "edge-collapse", engine, ops));
}

#[test]
fn every_planted_fault_is_seen_in_a_few_operations_on_merges() {
    let mesh = generate::bumpy_grid(5, 4, 0.5, 8);
    // A dynamic rule does not say which front is right, so to ask for too much is no fault there.
    let unsaid = [Fault::AsksAtTies, Fault::ForgetsMemory];
    for (scheme, unseen) in [(Scheme::DualPiece, &[][..]), (Scheme::DualPieceFree, &unsaid)] {
        let play = |engine, ops: &[Op]| on_merges(&mesh, "edge-collapse", scheme, engine, ops).expect("a manifold");
        plant(scheme.name(), unseen, play);
    }
}
