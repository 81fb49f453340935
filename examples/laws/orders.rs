//! Laws of the order, drawn on the order itself: the finest nodes at the bottom, what they need above them.

use crate::pen::{At, Drawing, Ink, Panel};
use crate::subject::Subject;
use multi_tessellation::mt_core::model::MultiTessellation;
use multi_tessellation::mt_core::{Front, NodeId};

/// Where nodes stand: by the longest chain above them, side by side.
struct Chart<'a> {
    subject: &'a Subject,
    places: Vec<At>,
}

impl<'a> Chart<'a> {
    fn new(subject: &'a Subject) -> Self {
        let order = subject.model.order();
        let mut level = vec![0usize; order.len() as usize];
        for m in (0..order.len()).rev().map(NodeId) {
            level[m.index()] = order.needs(m).iter().map(|need| level[need.index()] + 1).max().unwrap_or(0);
        }
        let deepest = level.iter().copied().max().unwrap_or(0).max(1);
        let place = |m: usize| {
            let mut row: Vec<usize> = (0..level.len()).filter(|&other| level[other] == level[m]).collect();
            // Side by side as they lie in the sheet, so that arcs seldom cross.
            let across = |m: usize| subject.model.bound(NodeId::new(m)).center.x;
            row.sort_by(|a, b| across(*a).total_cmp(&across(*b)).then(a.cmp(b)));
            let rank = row.iter().position(|&other| other == m).expect("it is in its row");
            [(rank as f32 + 0.5) / row.len() as f32, 1.0 - (level[m] as f32 + 0.3) / (deepest as f32 + 0.6)]
        };
        Self { subject, places: (0..level.len()).map(place).collect() }
    }

    fn draw(
        &self,
        panel: &mut Panel,
        ink: impl Fn(NodeId) -> (Ink, bool),
        arc: impl Fn(NodeId, NodeId) -> Option<Ink>,
    ) {
        let order = self.subject.model.order();
        for m in (0..order.len()).map(NodeId) {
            for &need in order.needs(m) {
                let (from, to) = (self.places[m.index()], self.places[need.index()]);
                match arc(m, need) {
                    Some(ink) => panel.arrow(from, to, ink),
                    None => panel.line(from, to, Ink::Faint, 0.8),
                }
            }
        }
        for (m, place) in self.places.iter().enumerate() {
            let (ink, filled) = ink(NodeId::new(m));
            panel.dot(*place, ink, 4.0, filled);
        }
    }
}

/// The node with the longest way up, and a front that has a part of that way.
fn deep_node(subject: &Subject) -> NodeId {
    let order = subject.model.order();
    let above = |m: NodeId| {
        let mut front = Front::from_nodes(order.len(), [m]);
        order.close(&mut front);
        front.len()
    };
    (0..order.len()).map(NodeId).filter(|&m| above(m) <= 9).max_by_key(|&m| (above(m), m)).expect("a node")
}

fn closed(subject: &Subject, nodes: impl IntoIterator<Item = NodeId>) -> Front {
    let mut front = Front::from_nodes(subject.model.len(), nodes);
    subject.model.order().close(&mut front);
    front
}

/// A node, what it needs, and what is in the way of its coarsening.
pub fn order(subject: &Subject) -> Drawing {
    let (chart, order) = (Chart::new(subject), subject.model.order());
    let m =
        (0..order.len()).map(NodeId).max_by_key(|&m| order.needs(m).len().min(2) + order.dependents(m).len().min(3));
    let m = m.expect("a node");
    let needs = |n: NodeId| order.needs(m).contains(&n);
    let dependents = |n: NodeId| order.dependents(m).contains(&n);
    Drawing::default()
        .panel("the order: arrows say needs,\nids fall from top to bottom", Ink::Plain, |panel| {
            chart.draw(panel, |_| (Ink::Plain, true), |_, _| Some(Ink::Plain));
        })
        .panel("before a node is refined:\nits prerequisites", Ink::Fine, |panel| {
            let ink = |n| {
                if n == m {
                    (Ink::Fine, true)
                } else if needs(n) {
                    (Ink::Fine, false)
                } else {
                    (Ink::Faint, false)
                }
            };
            chart.draw(panel, ink, |from, to| (from == m && needs(to)).then_some(Ink::Fine));
        })
        .panel("before it is coarsened:\nits obstacles", Ink::Coarse, |panel| {
            let ink = |n| {
                if n == m {
                    (Ink::Coarse, true)
                } else if dependents(n) {
                    (Ink::Coarse, false)
                } else {
                    (Ink::Faint, false)
                }
            };
            chart.draw(panel, ink, |from, to| (to == m && dependents(from)).then_some(Ink::Coarse));
        })
}

/// Fronts are closed; so are what two of them share and what they have together.
pub fn closure(subject: &Subject) -> Drawing {
    let chart = Chart::new(subject);
    let deep = deep_node(subject);
    let one = closed(subject, [deep]);
    let other = closed(
        subject,
        (0..subject.model.len()).map(NodeId).filter(|&m| subject.model.bound(m).center.x > 3.2).take(3),
    );
    let shown =
        |front: &Front, m: NodeId, ink: Ink| if front.is_refined(m) { (ink, true) } else { (Ink::Faint, false) };
    let join = |m: NodeId| match (one.is_refined(m), other.is_refined(m)) {
        (true, true) => (Ink::Plain, true),
        (true, false) => (Ink::Fine, true),
        (false, true) => (Ink::Coarse, true),
        _ => (Ink::Faint, false),
    };
    let gap = subject.model.order().needs(deep).first().copied();
    Drawing::default()
        .panel("a front is closed: with a node\nit has what the node needs", Ink::Fine, |panel| {
            chart.draw(panel, |m| shown(&one, m, Ink::Fine), |m, _| one.is_refined(m).then_some(Ink::Fine));
        })
        .panel("another; together, and what\nboth have, are closed too", Ink::Plain, |panel| {
            chart.draw(panel, join, |_, _| None);
        })
        .panel("broken: a need is missing", Ink::Wrong, |panel| {
            let ink = |m| if Some(m) == gap { (Ink::Wrong, false) } else { shown(&one, m, Ink::Fine) };
            chart.draw(panel, ink, |m, need| {
                let missing = one.is_refined(m) && Some(m) != gap && Some(need) == gap;
                missing.then_some(Ink::Wrong)
            });
        })
}

/// What is asked for, and what that forces.
pub fn minimality(subject: &Subject) -> Drawing {
    let chart = Chart::new(subject);
    let asked = [deep_node(subject)];
    let least = closed(subject, asked);
    let extra = (0..subject.model.len())
        .rev()
        .map(NodeId)
        .find(|&m| !least.is_refined(m) && subject.model.order().needs(m).iter().all(|&need| least.is_refined(need)));
    let ink = |m: NodeId| match (asked.contains(&m), least.is_refined(m)) {
        (true, _) => (Ink::Coarse, true),
        (false, true) => (Ink::Fine, true),
        _ => (Ink::Faint, false),
    };
    let arc = |from: NodeId, _| least.is_refined(from).then_some(Ink::Fine);
    Drawing::default()
        .panel("a wish asks for a node", Ink::Coarse, |panel| {
            let ink = |m| if asked.contains(&m) { (Ink::Coarse, true) } else { (Ink::Faint, false) };
            chart.draw(panel, ink, |_, _| None);
        })
        .panel("its least closure: each other node\nis forced by a chain", Ink::Fine, |panel| {
            chart.draw(panel, ink, arc)
        })
        .panel("broken: nobody asks for this one,\nand nothing needs it", Ink::Wrong, |panel| {
            let ink = |m| if Some(m) == extra { (Ink::Wrong, true) } else { ink(m) };
            chart.draw(panel, ink, arc);
        })
}
