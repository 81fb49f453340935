//! Laws of bounds, and of hierarchies of vertices: which part of the input each vertex stands for.

use crate::pen::{At, Drawing, Ink, Panel};
use crate::subject::{Subject, length, place};
use multi_tessellation::mt_core::check;
use multi_tessellation::mt_core::model::MultiTessellation;
use multi_tessellation::mt_core::{Cell, Front, NodeId, VertexId};

/// The bounds of a node and of those discovered under it.
pub fn saturation(subject: &Subject) -> Drawing {
    let model = &subject.model;
    let children = |m: NodeId| {
        let mut out = Vec::new();
        model.children(m, &mut out);
        out
    };
    // Of those with several under them the one that is nearest to being seen as a whole.
    let margin = |m: NodeId| {
        let bound = model.bound(m);
        let [low, high] = [bound.center - bound.radius, bound.center + bound.radius];
        low.min(glam::Vec3::new(5.0, 4.0, 0.0) - high).truncate().min_element()
    };
    let parents = (0..model.len()).map(NodeId).filter(|&m| children(m).len() > 1);
    let parent = parents.max_by(|&one, &other| margin(one).total_cmp(&margin(other))).expect("a forest");
    // Drawn smaller, since bounds reach beyond the sheet.
    let shown = |[x, y]: At| [0.1 + 0.6 * x, 0.02 + 0.6 * y];
    let circle = |panel: &mut Panel, m: NodeId, factor: f32, ink: Ink| {
        let bound = model.bound(m);
        panel.circle(shown(place(bound.center)), length(0.6 * factor * bound.radius), ink);
    };
    let draw = |panel: &mut Panel, shrunk: bool| {
        let input = subject.view((0..model.len()).map(NodeId));
        for (_, cell) in subject.cells(&input) {
            panel.area(&subject.corners(&cell).map(shown), Ink::Faint, 0.0);
        }
        children(parent).into_iter().for_each(|m| circle(panel, m, 1.0, Ink::Fine));
        let (factor, ink) = if shrunk { (0.62, Ink::Wrong) } else { (1.0, Ink::Coarse) };
        circle(panel, parent, factor, ink);
    };
    Drawing::default()
        .panel("the bound of a node holds those of\nthe nodes discovered under it", Ink::Coarse, |panel| {
            draw(panel, false)
        })
        .panel("broken: a criterion may say no to it,\nand yes to one that nobody comes to", Ink::Wrong, |panel| {
            draw(panel, true)
        })
}

/// A front of the hierarchy: a cut of the forest, rather coarse.
fn cut(subject: &Subject) -> Front {
    let count = subject.replay.len();
    let mut front = Front::base(count);
    for m in (count * 3 / 4..count).map(NodeId) {
        let mut above = Some(m);
        while let Some(node) = above {
            front.set(node, true);
            above = subject.replay.parent(node);
        }
    }
    front
}

/// The colour of each active vertex, by turns.
fn hues(ancestors: &[VertexId]) -> impl Fn(VertexId) -> Ink + '_ {
    let mut known: Vec<VertexId> = ancestors.to_vec();
    known.sort_unstable();
    known.dedup();
    move |v| Ink::Hue(known.iter().position(|&other| other == v).unwrap_or(0))
}

fn at(subject: &Subject, v: VertexId) -> At {
    place(subject.replay.positions()[v.index()])
}

/// The input with its vertices in the colours of those that stand for them, and what is left of its triangles.
fn merged(subject: &Subject) -> (Vec<VertexId>, Vec<Cell<3>>) {
    let front = cut(subject);
    let ancestors = check::active_ancestors(&subject.replay, &front);
    (ancestors, check::quotient(&subject.replay, &front).into_iter().map(|(_, cell)| cell).collect())
}

/// The quotient: which triangles are left when vertices are one.
pub fn quotient(subject: &Subject) -> Drawing {
    let (ancestors, left) = merged(subject);
    let hue = hues(&ancestors);
    let input = subject.replay.reference();
    Drawing::default()
        .panel("each vertex of the input has one\nthat stands for it, in its colour", Ink::Plain, |panel| {
            for cell in &input.cells {
                let kept = (0..3).all(|i| ancestors[cell[i].index()] != ancestors[cell[(i + 1) % 3].index()]);
                panel.area(
                    &cell.map(|v| at(subject, v)),
                    if kept { Ink::Plain } else { Ink::Faint },
                    if kept { 0.22 } else { 0.0 },
                );
            }
            for v in (0..input.vertex_count()).map(VertexId::new) {
                panel.dot(at(subject, v), hue(ancestors[v.index()]), 3.6, true);
            }
        })
        .sign("→")
        .panel("the mesh of the front: triangles\nwhose corners are still three", Ink::Plain, |panel| {
            for cell in &left {
                panel.area(&cell.map(|v| at(subject, v)), Ink::Plain, 0.22);
            }
            let mut seen: Vec<VertexId> = left.iter().flatten().copied().collect();
            seen.sort_unstable();
            seen.dedup();
            seen.iter().for_each(|&v| panel.dot(at(subject, v), hue(v), 4.6, true));
        })
}

/// The pieces of the dual that belong to active vertices.
pub fn partition(subject: &Subject) -> Drawing {
    let (ancestors, left) = merged(subject);
    let hue = hues(&ancestors);
    let input = subject.replay.reference();
    let thirds = |cell: &Cell<3>| {
        let corner = cell.map(|v| at(subject, v));
        let middle = [0, 1].map(|k| corner.iter().map(|p| p[k]).sum::<f32>() / 3.0);
        let between = |i: usize, j: usize| [0, 1].map(|k| (corner[i][k] + corner[j][k]) / 2.0);
        [0, 1, 2].map(|i| [corner[i], between(i, (i + 1) % 3), middle, between(i, (i + 2) % 3)])
    };
    Drawing::default()
        .panel("each vertex of the input has its\npiece of the dual", Ink::Plain, |panel| {
            for cell in &input.cells {
                thirds(cell).iter().for_each(|quad| {
                    panel.line(quad[1], quad[2], Ink::Fine, 1.2);
                });
                panel.area(&cell.map(|v| at(subject, v)), Ink::Faint, 0.0);
            }
        })
        .sign("→")
        .panel("the pieces of those that are one\nare one; they cover and do not overlap", Ink::Plain, |panel| {
            for cell in &input.cells {
                for (quad, v) in thirds(cell).iter().zip(cell) {
                    panel.area(quad, hue(ancestors[v.index()]), 0.45);
                }
            }
        })
        .sign("→")
        .panel("where two touch along one portion,\nthe mesh has an edge", Ink::Plain, |panel| {
            for cell in &input.cells {
                for (quad, v) in thirds(cell).iter().zip(cell) {
                    panel.area(quad, hue(ancestors[v.index()]), 0.18);
                }
            }
            for cell in &left {
                let corner = cell.map(|v| at(subject, v));
                (0..3).for_each(|i| panel.line(corner[i], corner[(i + 1) % 3], Ink::Plain, 1.8));
            }
        })
}
