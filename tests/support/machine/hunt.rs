//! Looks for a sequence of operations after which something is wrong, and makes it short.

use super::ops::{Op, ops};
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};

/// How many random sequences may pass before the fault is seen.
const CASES: u32 = 600;

fn runner() -> TestRunner {
    let config = Config { cases: CASES, max_shrink_iters: 50_000, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

/// The shortest sequence of operations found after which something is wrong, and what.
pub fn found(play: impl Fn(&[Op]) -> Result<(), String>) -> Option<(Vec<Op>, String)> {
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
