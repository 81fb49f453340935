//! Orders that ask for too little, and rules that let too much be done.

use crate::catalogue::{Caught, fault, hunt};
use mt_core::hierarchy::{Dependency, VertexMesh};
use mt_core::model::View;
use mt_core::{Coarsen, NodeId, Replay, Rule, generate};
use mt_tests::replay_of;
use multi_tessellation::verify;
use operators::order::{DualPieceFree, ImplicitIds, Scheme, Stored};
use std::sync::Arc;

/// A scheme with some of its answers left out.
struct Lax<D> {
    scheme: D,
    lax: Option<Laxity>,
}

#[derive(Clone, Copy, PartialEq)]
enum Laxity {
    RefinesAnywhere,
    CoarsensAnywhere,
    ForgetsTheLastNeed,
    WaitsForever,
}

impl<D: Dependency> Dependency for Lax<D> {
    const RULE: Rule = D::RULE;

    fn needs(&self, replay: &Replay, m: NodeId, out: &mut Vec<NodeId>) {
        let before = out.len();
        self.scheme.needs(replay, m, out);
        if self.lax == Some(Laxity::ForgetsTheLastNeed) && out.len() > before {
            out.pop();
        }
    }
    fn prerequisites(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        match self.lax {
            Some(Laxity::RefinesAnywhere) => {}
            Some(Laxity::WaitsForever) if m.0 % 8 == 3 => out.push(NodeId(replay.len() - 1)),
            _ => self.scheme.prerequisites(replay, m, view, out),
        }
    }
    fn obstacles(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) -> Coarsen {
        match self.lax {
            Some(Laxity::CoarsensAnywhere) => Coarsen::Now,
            _ => self.scheme.obstacles(replay, m, view, out),
        }
    }
    fn bytes(&self) -> usize {
        self.scheme.bytes()
    }
}

fn judge<D: Dependency + Send>(
    replay: &Arc<Replay>,
    lax: Option<Laxity>,
    derive: impl Fn(&Arc<Replay>) -> D,
) -> Result<(), Caught> {
    let options = verify::Options { fronts: 200, seed: 5, ..verify::Options::default() };
    verify::order_on(replay, "lax", |replay| Ok(Lax { scheme: derive(replay), lax }), &options)?;
    Ok(())
}

#[test]
fn schemes() {
    let replay = replay_of(&generate::bumpy_sphere(3, 0.15, 9), &"edge-collapse".parse().expect("an operator"));
    let stored = |scheme: Scheme| {
        move |replay: &Arc<Replay>| -> Stored { scheme.stored(replay).expect("a manifold").expect("a static scheme") }
    };
    let planted = |what, scheme: Scheme, lax| {
        let replay = &replay;
        fault(what, move |planted: bool| judge(replay, planted.then_some(lax), stored(scheme)))
    };
    let replay = &replay;
    hunt(
        "schemes",
        &[
            planted("dual-piece forgets the cut vertices", Scheme::DualPiece, Laxity::ForgetsTheLastNeed),
            planted("one-ring forgets a neighbour", Scheme::OneRing, Laxity::ForgetsTheLastNeed),
            planted("cut-pair forgets one of the pair", Scheme::CutPair, Laxity::ForgetsTheLastNeed),
            planted("explicit forgets a cell", Scheme::Explicit, Laxity::ForgetsTheLastNeed),
            planted("four-face refines without asking", Scheme::FourFace, Laxity::RefinesAnywhere),
            planted("four-face coarsens without asking", Scheme::FourFace, Laxity::CoarsensAnywhere),
            planted("one-ring waits for what it does not need", Scheme::OneRing, Laxity::WaitsForever),
            fault("implicit ids split beside older neighbours", |planted| {
                judge(replay, planted.then_some(Laxity::RefinesAnywhere), |_| ImplicitIds)
            }),
            fault("implicit ids merge beside younger neighbours", |planted| {
                judge(replay, planted.then_some(Laxity::CoarsensAnywhere), |_| ImplicitIds)
            }),
            fault("free dual pieces split a vertex that is its own cut", |planted| {
                judge(replay, planted.then_some(Laxity::RefinesAnywhere), |replay| {
                    DualPieceFree::new(replay).expect("a manifold")
                })
            }),
            fault("free dual pieces merge what shares a neighbour", |planted| {
                judge(replay, planted.then_some(Laxity::CoarsensAnywhere), |replay| {
                    DualPieceFree::new(replay).expect("a manifold")
                })
            }),
        ],
    );
}
