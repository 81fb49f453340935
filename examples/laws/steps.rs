//! Laws of steps: there and back, by any way, from one end to the other, twice the same, and told as it is.

use crate::pen::{Drawing, Ink, Panel};
use crate::subject::Subject;
use multi_tessellation::mt_core::explicit::Alive;
use multi_tessellation::mt_core::model::{MultiTessellation, Step, View, take};
use multi_tessellation::mt_core::{CellId, NodeId};

fn mesh(subject: &Subject, panel: &mut Panel, view: &View<Alive>, spoken: &[CellId], ink: Ink) {
    subject.draw(panel, &subject.cells(view), |cell| spoken.contains(&cell).then_some(ink));
}

/// Refining and coarsening undo each other.
pub fn inverse(subject: &Subject) -> Drawing {
    let m = subject.inner_node();
    let fine = subject.just_refined(m);
    let mut coarse = fine.clone();
    take(&subject.model, Step::coarsen(m), &mut coarse, &mut ());
    let made: Vec<CellId> = subject.model.coarse_side(m).collect();
    Drawing::default()
        .panel("a mesh", Ink::Plain, |panel| mesh(subject, panel, &fine, subject.model.fine_side(m), Ink::Fine))
        .sign("→")
        .panel(&format!("−{m}: coarsened"), Ink::Coarse, |panel| mesh(subject, panel, &coarse, &made, Ink::Coarse))
        .sign("→")
        .panel(&format!("+{m}: the same mesh, bit for bit,\ncorners in the same turn"), Ink::Fine, |panel| {
            take(&subject.model, Step::refine(m), &mut coarse, &mut ());
            assert!(coarse == fine, "the law holds");
            mesh(subject, panel, &coarse, subject.model.fine_side(m), Ink::Fine);
        })
}

/// Two nodes that do not need each other, refined in either sequence.
fn independent(subject: &Subject) -> (View<Alive>, [NodeId; 2]) {
    let view = subject.view((subject.model.len() / 2..subject.model.len()).map(NodeId));
    let free = |&m: &NodeId| {
        let needs = subject.model.order().needs(m);
        !view.front.is_refined(m) && needs.iter().all(|&need| view.front.is_refined(need))
    };
    let free: Vec<NodeId> = (0..subject.model.len()).map(NodeId).filter(free).collect();
    let apart = |m: NodeId| subject.model.bound(m).center.x;
    let left = *free.iter().min_by(|a, b| apart(**a).total_cmp(&apart(**b))).expect("something is coarse");
    let right = *free.iter().max_by(|a, b| apart(**a).total_cmp(&apart(**b))).expect("something is coarse");
    (view, [left, right])
}

/// One front, reached in two ways.
pub fn front_determines_mesh(subject: &Subject) -> Drawing {
    let (view, [a, b]) = independent(subject);
    let after = |steps: &[NodeId]| {
        let mut view = view.clone();
        steps.iter().for_each(|&m| take(&subject.model, Step::refine(m), &mut view, &mut ()));
        view
    };
    assert!(after(&[a, b]) == after(&[b, a]), "the law holds");
    let spoken =
        |nodes: &[NodeId]| -> Vec<CellId> { nodes.iter().flat_map(|&m| subject.model.fine_side(m).to_vec()).collect() };
    Drawing::default()
        .panel("a front", Ink::Plain, |panel| mesh(subject, panel, &view, &[], Ink::Plain))
        .panel(&format!("by way of +{a}"), Ink::Fine, |panel| {
            mesh(subject, panel, &after(&[a]), &spoken(&[a]), Ink::Fine)
        })
        .panel(&format!("or by way of +{b}"), Ink::Coarse, |panel| {
            mesh(subject, panel, &after(&[b]), &spoken(&[b]), Ink::Coarse);
        })
        .panel("with both it is one mesh", Ink::Plain, |panel| {
            let [left, right] = [spoken(&[a]), spoken(&[b])];
            let both = after(&[a, b]);
            subject.draw(panel, &subject.cells(&both), |cell| {
                let ink = |side: &[CellId], ink| side.contains(&cell).then_some(ink);
                ink(&left, Ink::Fine).or(ink(&right, Ink::Coarse))
            });
        })
}

/// From the base mesh to the input.
pub fn ends(subject: &Subject) -> Drawing {
    let count = subject.model.len();
    let stage = |coarse: u32| subject.view((coarse..count).map(NodeId));
    let input = stage(0);
    assert_eq!(subject.cells(&input).len(), subject.model.input_cell_count() as usize);
    Drawing::default()
        .panel("no node refined:\nthe base mesh", Ink::Plain, |panel| {
            mesh(subject, panel, &stage(count), &[], Ink::Plain)
        })
        .sign("→")
        .panel(&format!("{} of {count} nodes", count / 3), Ink::Plain, |panel| {
            mesh(subject, panel, &stage(count - count / 3), &[], Ink::Plain);
        })
        .sign("→")
        .panel("all of them: the input,\nbit for bit", Ink::Fine, |panel| mesh(subject, panel, &input, &[], Ink::Plain))
        .sign("→")
        .panel("and all the way back", Ink::Plain, |panel| mesh(subject, panel, &stage(count), &[], Ink::Plain))
}

/// Twice the same input: the bytes of two containers.
pub fn determinism(subject: &Subject) -> Drawing {
    let count = subject.model.len();
    let bytes = |model: &multi_tessellation::mt_core::Explicit<3>| {
        let mut bytes = Vec::new();
        multi_tessellation::mt_core::container::write(model, &Default::default(), &mut bytes).expect("memory takes it");
        bytes
    };
    let (one, other) = (bytes(&subject.model), bytes(&Subject::new().model));
    assert!(one == other, "the law holds");
    let lines = |panel: &mut Panel, bytes: &[u8]| {
        for (i, row) in bytes[bytes.len() / 2..].chunks(8).take(7).enumerate() {
            let row: Vec<String> = row.iter().map(|byte| format!("{byte:02x}")).collect();
            panel.word([0.5, 0.92 - 0.14 * i as f32], Ink::Plain, &row.join(" "));
        }
    };
    let input = subject.view((0..count).map(NodeId));
    Drawing::default()
        .panel("an input", Ink::Plain, |panel| mesh(subject, panel, &input, &[], Ink::Plain))
        .sign("→")
        .panel("its model, as bytes", Ink::Plain, |panel| lines(panel, &one))
        .sign("=")
        .panel("and another time", Ink::Plain, |panel| lines(panel, &other))
}

/// What a node says of itself, and what is so.
pub fn conduct(subject: &Subject) -> Drawing {
    let m = subject.inner_node();
    let (fine, coarse) = (subject.fine(m), subject.coarse(m));
    let gain = subject.model.gain(m).expect("cells say what they win");
    assert_eq!(gain, fine.len() as i32 - coarse.len() as i32);
    Drawing::default()
        .panel(&format!("node {m} says: refined,\nI win {gain} cells"), Ink::Plain, |panel| {
            subject.draw(panel, &coarse, |_| Some(Ink::Coarse));
        })
        .sign("→")
        .panel(&format!("{} cells, then {}: it is so", coarse.len(), fine.len()), Ink::Fine, |panel| {
            subject.draw(panel, &fine, |_| Some(Ink::Fine));
        })
        .panel("broken: a plan that makes\na cell at a vertex that is gone", Ink::Wrong, |panel| {
            subject.draw(panel, &coarse, |_| Some(Ink::Coarse));
            let gone =
                fine.iter().flat_map(|(_, cell)| *cell).find(|v| coarse.iter().all(|(_, cell)| !cell.contains(v)));
            let gone = subject.at(gone.expect("a collapse takes a vertex away"));
            let edge = subject.boundary(&coarse)[0];
            panel.area(&[edge[0], edge[1], gone], Ink::Wrong, 0.25);
            panel.dot(gone, Ink::Wrong, 4.0, false);
        })
}
