//! Engines that go wrong: fronts, logs, views, budgets. The state machine finds each in a few operations.

use crate::catalogue::{Caught, Fault, fault, hunt};
use mt_core::generate;
use mt_tests::machine::{self, Engine, Op, found, on_cells, on_merges};
use operators::order::Scheme;

/// How many operations a fault needs at the most, once shrunk.
const OPS_MAX: usize = 6;

fn judged(play: impl Fn(&[Op]) -> Result<(), String>) -> Result<(), Caught> {
    let Some((ops, why)) = found(play) else { return Ok(()) };
    assert!(ops.len() <= OPS_MAX, "{} operations are left: {ops:?}: {why}", ops.len());
    let acts: Vec<_> = ops.iter().map(|op| op.act).collect();
    Err(Caught::by("the state machine", format!("{acts:?}: {}", why.get(..160).unwrap_or(&why))))
}

#[test]
fn engine_and_budget() {
    use machine::Fault as Wrong;
    let mesh = generate::bumpy_grid(5, 4, 0.5, 8);
    let planted = |what, wrong: Wrong| -> Fault {
        let mesh = &mesh;
        fault(what, move |planted: bool| {
            let engine = Engine(planted.then_some(wrong));
            judged(|ops| on_cells(mesh, "edge-collapse", engine, ops))
        })
    };
    hunt(
        "engine and budget",
        &[
            planted("rolling back stops a step too early", Wrong::RollsBackOneTooFew),
            planted("rolling back goes a step too far", Wrong::RollsBackOneTooMany),
            planted("adapting forgets to tell the sink one thing", Wrong::ForgetsTheSink),
            planted("a view goes over to another model with old scratch memory", Wrong::KeepsScratch),
            planted("what one view adapts, the other has too", Wrong::SharesTheView),
            planted("what a criterion asks for at a tie is refined", Wrong::AsksAtTies),
            planted("a criterion with memory is not told what is refined", Wrong::ForgetsMemory),
            planted("a budget is overshot by two cells", Wrong::Overshoots),
            planted("two steps are logged the wrong way round", Wrong::SwapsTheLog),
            planted("coarsening does not ask what is in its way", Wrong::CoarsensUnasked),
        ],
    );
}

#[test]
fn the_machine_sees_on_merges_what_it_sees_on_cells() {
    let mesh = generate::bumpy_grid(5, 4, 0.5, 8);
    // A dynamic rule does not say which front is right, so to ask for too much is no fault there.
    let unsaid = [machine::Fault::AsksAtTies];
    for (scheme, unseen) in [(Scheme::DualPiece, &[][..]), (Scheme::DualPieceFree, &unsaid)] {
        let play = |engine| judged(|ops| on_merges(&mesh, "edge-collapse", scheme, engine, ops).expect("a manifold"));
        play(Engine::default()).expect("nothing is wrong");
        for wrong in machine::Fault::ALL {
            assert_eq!(play(Engine(Some(wrong))).is_ok(), unseen.contains(&wrong), "{scheme} {wrong:?}");
        }
    }
}
