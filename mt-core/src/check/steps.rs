//! Laws on any model: inverse, ends, order and closure.

use super::{Breach, Law, Random, ensure};
use crate::front::Front;
use crate::id::NodeId;
use crate::mesh::Mesh;
use crate::model::{Coarsen, MultiTessellation, Step, View, cells_of, take};
use crate::order::{Order, Rows};

/// The order of a model, copied row by row from its `needs`; fails where they are not an order by rank.
pub fn order_of<const N: usize, M: MultiTessellation<N>>(model: &M) -> Result<Order, Breach> {
    let mut rows = Rows::default();
    let mut row = Vec::new();
    for m in (0..model.len()).map(NodeId) {
        row.clear();
        model.needs(m, &mut row);
        row.sort_unstable();
        rows.push(row.iter().copied());
    }
    Order::from_needs(rows).map_err(|error| Breach::new(Law::Order, None, error.to_string()))
}

/// Law 4: at most `tries` random legal steps from `view`, each undone; the view must be what it was, corners included.
pub fn inverse<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    view: &mut View<M::Mesh>,
    random: &mut Random,
    tries: u32,
) -> Result<(), Breach> {
    let before = cells_of(model, &view.mesh);
    let mesh = view.mesh.clone();
    let mut blocking = Vec::new();
    for _ in 0..tries.min(model.len()) {
        let m = NodeId::new(random.below(model.len() as usize));
        let step = Step { node: m, refined: !view.front.is_refined(m) };
        if !is_legal(model, step, view, &mut blocking) {
            continue;
        }
        take(model, step, view, &mut ());
        let back = is_legal(model, step.inverse(), view, &mut blocking);
        ensure!(back, Law::Inverse, m, "after {step:?} its inverse is not legal");
        take(model, step.inverse(), view, &mut ());
        ensure!(view.mesh == mesh, Law::Inverse, m, "{step:?} and its inverse leave another mesh");
    }
    ensure!(cells_of(model, &view.mesh) == before, Law::Inverse, None, "steps and their inverses leave other cells");
    Ok(())
}

fn is_legal<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    step: Step,
    view: &View<M::Mesh>,
    out: &mut Vec<NodeId>,
) -> bool {
    out.clear();
    if step.refined {
        model.prerequisites(step.node, view, out);
        out.is_empty()
    } else {
        model.obstacles(step.node, view, out) == Coarsen::Now
    }
}

/// Law 6: from the base mesh all steps lead to `input`, bit for bit, and all the way back. O(model).
pub fn ends<const N: usize, M: MultiTessellation<N>>(model: &M, input: &Mesh<N>) -> Result<(), Breach> {
    let mut view = model.base_view();
    let base = cells_of(model, &view.mesh);
    for m in (0..model.len()).rev().map(NodeId) {
        take(model, Step::refine(m), &mut view, &mut ());
    }
    let cells: Vec<_> = cells_of(model, &view.mesh).into_iter().map(|(_, corners)| corners).collect();
    ensure!(
        cells == input.cells,
        Law::Ends,
        None,
        "the full front has {} cells that are not the input's {}",
        cells.len(),
        input.cells.len()
    );
    let bits = |p: &glam::Vec3| p.to_array().map(f32::to_bits);
    let same = model.positions().len() >= input.positions.len()
        && model.positions().iter().zip(&input.positions).all(|(a, b)| bits(a) == bits(b));
    ensure!(same, Law::Ends, None, "a vertex of the input has moved");
    for m in (0..model.len()).map(NodeId) {
        take(model, Step::coarsen(m), &mut view, &mut ());
    }
    ensure!(
        cells_of(model, &view.mesh) == base,
        Law::Ends,
        None,
        "coarsening everything does not lead back to the base mesh"
    );
    Ok(())
}

/// Law 8 at a front, for static orders: prerequisites are the unmet needs; obstacles says Now exactly when no refined
/// node needs it. Checks `tries` random nodes. O(tries × row).
pub fn order<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    order: &Order,
    view: &View<M::Mesh>,
    random: &mut Random,
    tries: u32,
) -> Result<(), Breach> {
    let mut told = Vec::new();
    for _ in 0..tries.min(model.len()) {
        let m = NodeId::new(random.below(model.len() as usize));
        told.clear();
        if view.front.is_refined(m) {
            let answer = model.obstacles(m, view, &mut told);
            let free = !order.dependents(m).iter().any(|&d| view.front.is_refined(d));
            ensure!(
                (answer == Coarsen::Now) == free,
                Law::Order,
                m,
                "coarsening node {m}: the model says {answer:?}, its order says {}",
                if free { "now" } else { "not yet" }
            );
        } else {
            model.prerequisites(m, view, &mut told);
            told.sort_unstable();
            let unmet: Vec<_> = order.needs(m).iter().copied().filter(|&n| !view.front.is_refined(n)).collect();
            ensure!(
                told.is_empty() == unmet.is_empty(),
                Law::Order,
                m,
                "refining node {m}: the model asks for {told:?}, its order for {unmet:?}"
            );
        }
    }
    Ok(())
}

/// Law 9: the front is closed, and so are its meet and join with another closed front. O(arcs).
pub fn closure(order: &Order, front: &Front, other: &Front) -> Result<(), Breach> {
    let meet = Front::from_nodes(order.len(), front.finest_first().filter(|&m| other.is_refined(m)));
    let join = Front::from_nodes(order.len(), front.finest_first().chain(other.finest_first()));
    for (what, set) in [
        ("the front", front),
        ("the other front", other),
        ("the meet of two fronts", &meet),
        ("the join of two fronts", &join),
    ] {
        if let Some((m, need)) = order.unmet(set) {
            return Err(Breach::new(
                Law::Closure,
                m,
                format!("{what} has node {m}, but not node {need}, which it needs"),
            ));
        }
    }
    Ok(())
}
