//! Models of one's own that answer wrongly, or do.

use crate::catalogue::{fault, hunt};
use mt_core::explicit::Alive;
use mt_core::model::{MultiTessellation, View};
use mt_core::{Bound, Coarsen, Explicit, NodeId, Sink, generate};
use mt_tests::{Answering, Answers, model_of};
use multi_tessellation::verify;
use operators::EdgeCollapse;

/// What is wrong.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Wrong {
    Nothing,
    RefineForgetsACell,
    RefineLooksAtTheMesh,
    RefineTellsTooLittle,
    CoarsenSwapsCells,
    CountIsOff,
    GainIsOff,
    ChildrenForgetOne,
    ErrorIsNoNumber,
    NeedsPointBackwards,
    NeedsForgetSome,
    PrerequisitesForgetSome,
    PrerequisitesNameTheRefined,
    ObstaclesAreNeverThere,
    ObstaclesAlwaysAre,
}

impl Answers for Wrong {
    fn cell_count(&self, model: &Explicit<3>, mesh: &Alive) -> u32 {
        let count = model.cell_count(mesh);
        if *self == Wrong::CountIsOff && count.is_multiple_of(3) { count + 1 } else { count }
    }
    fn children(&self, model: &Explicit<3>, m: NodeId, out: &mut Vec<NodeId>) {
        model.children(m, out);
        if *self == Wrong::ChildrenForgetOne && m.0 % 4 == 1 {
            out.pop();
        }
    }
    fn bound(&self, model: &Explicit<3>, m: NodeId) -> Bound {
        let bound = model.bound(m);
        let wrong = *self == Wrong::ErrorIsNoNumber && m.0 == 7;
        if wrong { Bound { error: f32::NAN, ..bound } } else { bound }
    }
    fn gain(&self, model: &Explicit<3>, m: NodeId) -> Option<i32> {
        let off = i32::from(*self == Wrong::GainIsOff && m.0.is_multiple_of(5));
        model.gain(m).map(|gain| gain - off)
    }
    fn needs(&self, model: &Explicit<3>, m: NodeId, out: &mut Vec<NodeId>) {
        let before = out.len();
        model.needs(m, out);
        match self {
            Wrong::NeedsPointBackwards if m.0 == 9 => out.push(NodeId(2)),
            Wrong::NeedsForgetSome if m.0.is_multiple_of(3) => out.truncate(before),
            _ => {}
        }
    }
    fn prerequisites(&self, model: &Explicit<3>, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) {
        let before = out.len();
        model.prerequisites(m, view, out);
        match self {
            Wrong::PrerequisitesForgetSome if m.0.is_multiple_of(3) => out.truncate(before),
            Wrong::PrerequisitesNameTheRefined => out.extend(view.front.finest_first().last().filter(|&n| n > m)),
            _ => {}
        }
    }
    fn obstacles(&self, model: &Explicit<3>, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) -> Coarsen {
        match self {
            Wrong::ObstaclesAreNeverThere => Coarsen::Now,
            Wrong::ObstaclesAlwaysAre if m.0 == 0 => Coarsen::Not,
            _ => model.obstacles(m, view, out),
        }
    }
    fn refine(&self, model: &Explicit<3>, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        let odd = mesh.count() % 4 < 2;
        if *self == Wrong::RefineTellsTooLittle {
            model.refine(m, mesh, &mut ());
            model.coarse_side(m).for_each(|cell| sink.kill(cell));
            model.fine_side(m).iter().skip(1).for_each(|&cell| sink.make(cell, *model.corners(cell)));
            return;
        }
        model.refine(m, mesh, sink);
        let loses = *self == Wrong::RefineForgetsACell && m.0.is_multiple_of(2)
            || *self == Wrong::RefineLooksAtTheMesh && m.0.is_multiple_of(7) && odd;
        if loses {
            mesh.remove(model.fine_side(m)[0].0);
        }
    }
    fn coarsen(&self, model: &Explicit<3>, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        model.coarsen(m, mesh, sink);
        if *self == Wrong::CoarsenSwapsCells && m.0.is_multiple_of(2) {
            let cell = model.coarse_side(m).next().expect("a collapse leaves cells");
            mesh.remove(cell.0);
            mesh.insert(model.fine_side(m)[0].0);
        }
    }
}

#[test]
fn models_and_their_steps() {
    let model = model_of(&generate::bumpy_sphere(2, 0.1, 3), &EdgeCollapse::FULL);
    let planted = |what, wrong: Wrong| {
        let model = &model;
        fault(what, move |planted| {
            let answers = if planted { wrong } else { Wrong::Nothing };
            let model = Answering { model: model.clone(), answers };
            let options = verify::Options { fronts: 60, seed: 5, ..verify::Options::default() };
            verify::model(&model, &options, &mut |_| true)?;
            Ok(())
        })
    };
    hunt(
        "models and their steps",
        &[
            planted("refining forgets a cell", Wrong::RefineForgetsACell),
            planted("refining depends on the mesh that it finds", Wrong::RefineLooksAtTheMesh),
            planted("refining tells its sink too little", Wrong::RefineTellsTooLittle),
            planted("coarsening takes the wrong cells", Wrong::CoarsenSwapsCells),
            planted("cells are miscounted now and then", Wrong::CountIsOff),
            planted("what a node wins is told one too low", Wrong::GainIsOff),
            planted("a node is discovered under nobody", Wrong::ChildrenForgetOne),
            planted("an error is not a number", Wrong::ErrorIsNoNumber),
            planted("a node needs one of smaller rank", Wrong::NeedsPointBackwards),
            planted("needs are forgotten", Wrong::NeedsForgetSome),
            planted("prerequisites are forgotten", Wrong::PrerequisitesForgetSome),
            planted("a prerequisite is refined already", Wrong::PrerequisitesNameTheRefined),
            planted("nothing is ever in the way of coarsening", Wrong::ObstaclesAreNeverThere),
            planted("a node cannot be coarsened", Wrong::ObstaclesAlwaysAre),
        ],
    );
}
