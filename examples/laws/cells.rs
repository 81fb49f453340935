//! Laws of cells: what a modification is, what it keeps, and what meshes come of it.

use crate::pen::{At, Drawing, Ink, Panel};
use crate::subject::{Named, Subject};
use multi_tessellation::mt_core::model::{MultiTessellation, Step, take};
use multi_tessellation::mt_core::{CellId, Explicit, NodeId};
use multi_tessellation::verify;

/// A base mesh, a front in between, the input.
pub fn model(subject: &Subject) -> Drawing {
    let halfway = subject.view((subject.model.len() * 2 / 3..subject.model.len()).map(NodeId));
    let left = subject.view((0..subject.model.len()).map(NodeId).filter(|&m| {
        let bound = subject.model.bound(m);
        bound.center.x < 1.6 && bound.radius < 3.0
    }));
    let input = subject.view((0..subject.model.len()).map(NodeId));
    Drawing::default()
        .panel("the empty front:\nthe base mesh", Ink::Plain, |panel| {
            subject.draw(panel, &subject.cells(&subject.model.base_view()), |_| None);
        })
        .panel("a front: coarse everywhere", Ink::Plain, |panel| {
            subject.draw(panel, &subject.cells(&halfway), |_| None)
        })
        .panel("a front: fine at the left", Ink::Plain, |panel| subject.draw(panel, &subject.cells(&left), |_| None))
        .panel("the full front:\nthe input", Ink::Plain, |panel| subject.draw(panel, &subject.cells(&input), |_| None))
}

fn patch_in_its_mesh(subject: &Subject, panel: &mut Panel, m: NodeId, refined: bool) {
    let mut view = subject.just_refined(m);
    if !refined {
        take(&subject.model, Step::coarsen(m), &mut view, &mut ());
    }
    let side = if refined { subject.fine(m) } else { subject.coarse(m) };
    let ink = if refined { Ink::Fine } else { Ink::Coarse };
    subject.draw(panel, &subject.cells(&view), |cell| side.iter().any(|(id, _)| *id == cell).then_some(ink));
    subject.boundary(&side).iter().for_each(|[a, b]| panel.line(*a, *b, Ink::Plain, 2.2));
}

/// Both sides of a modification within the mesh, and one that forgets a cell.
pub fn conformity(subject: &Subject) -> Drawing {
    let m = subject.inner_node();
    Drawing::default()
        .panel("the fine side of a node,\nand its boundary", Ink::Fine, |panel| {
            patch_in_its_mesh(subject, panel, m, true)
        })
        .sign("⇄")
        .panel("its coarse side has\nthe same boundary", Ink::Coarse, |panel| {
            patch_in_its_mesh(subject, panel, m, false)
        })
        .panel("broken: a cell too few\nopens edges of the patch", Ink::Wrong, |panel| {
            let mut view = subject.just_refined(m);
            take(&subject.model, Step::coarsen(m), &mut view, &mut ());
            let side = subject.coarse(m);
            let forgotten = side[side.len() / 2];
            let cells: Vec<Named> = subject.cells(&view).into_iter().filter(|(id, _)| *id != forgotten.0).collect();
            subject.draw(panel, &cells, |cell| side.iter().any(|(id, _)| *id == cell).then_some(Ink::Coarse));
            subject.boundary(&[forgotten]).iter().for_each(|[a, b]| panel.line(*a, *b, Ink::Wrong, 2.4));
        })
}

/// The life of a cell: made by one node, killed by another.
pub fn cells(subject: &Subject) -> Drawing {
    let model = &subject.model;
    // The largest cell that is made and killed.
    let size = |cell: CellId| doubled_area(subject.corners(model.corners(cell)));
    let killed = (0..model.len() / 2).map(NodeId).flat_map(|m| model.fine_side(m).iter().map(move |&cell| (m, cell)));
    let (killer, cell) = killed
        .filter(|(_, cell)| cell.0 >= model.input_cell_count())
        .max_by(|one, other| size(one.1).total_cmp(&size(other.1)))
        .expect("some node kills a made cell");
    let maker = model.refined_by(cell).expect("it was made");
    let stage = |panel: &mut Panel, from: u32, ink: Ink| {
        let view = subject.view((from..model.len()).map(NodeId));
        subject.draw(panel, &subject.cells(&view), |id| (id == cell).then_some(ink));
        if !view.mesh.contains(cell.0) {
            subject
                .boundary(&[(cell, *model.corners(cell))])
                .iter()
                .for_each(|[a, b]| panel.line(*a, *b, Ink::Faint, 2.0));
        }
    };
    Drawing::default()
        .panel("coarsening: not yet made", Ink::Plain, |panel| stage(panel, maker.0, Ink::Fine))
        .sign("→")
        .panel(&format!("node {maker} makes the cell"), Ink::Fine, |panel| stage(panel, maker.0 + 1, Ink::Fine))
        .sign("→")
        .panel(&format!("node {killer} kills it, for good"), Ink::Coarse, |panel| stage(panel, killer.0 + 1, Ink::Fine))
}

/// A mesh that is fine on one side and coarse on the other, and one whose middle was not told.
pub fn crack_freeness(subject: &Subject) -> Drawing {
    let m = subject.inner_node();
    let view = subject.view([NodeId(0), m]);
    let cells = subject.cells(&view);
    // As if a node had been refined before what it needs: its coarse side is not there to be taken away.
    let early = (0..subject.model.len()).map(NodeId).find(|&node| {
        !view.front.is_refined(node)
            && subject.model.order().needs(node).iter().any(|&need| !view.front.is_refined(need))
            && subject.fine(node).len() > 4
    });
    Drawing::default()
        .panel("a mesh, whatever the front:\nedges meet edges", Ink::Plain, |panel| {
            subject.draw(panel, &cells, |_| None)
        })
        .panel("broken: a node refined too early\nlies on what is still there", Ink::Wrong, |panel| {
            let fine = subject.fine(early.expect("something is coarse"));
            subject.draw(panel, &cells, |_| None);
            subject.draw(panel, &fine, |_| Some(Ink::Wrong));
        })
        .panel("broken: a vertex within an edge,\na crack once it moves", Ink::Wrong, |panel| {
            let (a, b, c, d) = ([0.5, 0.05], [0.5, 0.95], [0.06, 0.5], [0.94, 0.5]);
            let middle = [0.5, 0.5];
            panel.area(&[a, d, b], Ink::Plain, 0.04);
            panel.area(&[a, middle, c], Ink::Fine, 0.2);
            panel.area(&[c, middle, b], Ink::Fine, 0.2);
            panel.dot(middle, Ink::Wrong, 4.0, true);
        })
}

/// What is left of a wrong history: before and after it is made small.
pub fn counterexample() -> Drawing {
    let model = Subject::new().model;
    let mut parts = model.parts().clone();
    let node = model.len() / 2;
    let made = parts.coarse_start[node as usize] as usize;
    parts.corners[made].swap(0, 1);
    let broken = Explicit::from_parts(parts).expect("its shape is right");
    let found =
        verify::explicit(&broken, &verify::Options::default(), &mut |_| true).expect_err("a cell is turned over");
    let verify::Case::Cells(small) = &found.case else { panic!("a part was found") };
    let subject = Subject { model: broken, replay: Subject::new().replay };
    let whole = subject.view((node + 1..subject.model.len()).map(NodeId));
    let turned = CellId::new(made);
    let part = Subject { model: (**small).clone(), replay: Subject::new().replay };
    let input = part.view((0..part.model.len()).map(NodeId));
    let sizes = [subject.model.input_cell_count(), part.model.input_cell_count()];
    Drawing::default()
        .panel(
            &format!("found: {} cells, {} nodes,\none made cell turned over", sizes[0], subject.model.len()),
            Ink::Wrong,
            |panel| {
                subject.draw(panel, &subject.cells(&whole), |id| (id == turned).then_some(Ink::Wrong));
            },
        )
        .sign("→")
        .panel(&format!("made small: the input, {} cells", sizes[1]), Ink::Plain, |panel| {
            part.draw(panel, &part.cells(&input), |_| None);
        })
        .sign("→")
        .panel(&format!("and its {} node: the base,\nwith the cell", part.model.len()), Ink::Wrong, |panel| {
            let base = part.cells(&part.model.base_view());
            part.draw(panel, &base, |id| {
                (doubled_area(part.corners(part.model.corners(id))) < 0.0).then_some(Ink::Wrong)
            });
        })
}

/// Twice the area of a triangle, below 0 where it is turned over.
fn doubled_area([a, b, c]: [At; 3]) -> f32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}
