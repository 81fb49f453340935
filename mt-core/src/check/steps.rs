//! Laws on any model: inverse, ends, order and closure.

use super::{Breach, Law, Random, ensure};
use crate::explicit::Explicit;
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

/// Law 4: `tries` legal steps from `view`, from random nodes, each undone; the view must be what it was, corners included,
/// and in between the mesh has as many cells as the node says.
/// Gives the number of steps taken, which is smaller only where a model has no node. O(tries × (chain + cells / 64)).
pub fn inverse<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    view: &mut View<M::Mesh>,
    random: &mut Random,
    tries: u32,
) -> Result<u32, Breach> {
    let before = cells_of(model, &view.mesh);
    let mesh = view.mesh.clone();
    let count = i64::from(model.cell_count(&mesh));
    let mut scratch = Vec::new();
    let mut taken = 0;
    for _ in 0..tries {
        let Some(step) = legal_step(model, view, random, &mut scratch)? else { continue };
        let m = step.node;
        take(model, step, view, &mut ());
        let won = if step.refined { 1 } else { -1 } * (i64::from(model.cell_count(&view.mesh)) - count);
        let back = is_legal(model, step.inverse(), view, &mut scratch);
        ensure!(back, Law::Inverse, m, "after {step:?} its inverse is not legal");
        take(model, step.inverse(), view, &mut ());
        ensure!(view.mesh == mesh, Law::Inverse, m, "{step:?} and its inverse leave another mesh");
        let told = model.gain(m).is_none_or(|gain| i64::from(gain) == won);
        ensure!(told, Law::Conduct, m, "refining node {m} wins {won} cells, it says {:?}", model.gain(m));
        taken += 1;
    }
    let same = cells_of(model, &view.mesh) == before;
    ensure!(same, Law::Inverse, None, "steps and their inverses leave other cells");
    Ok(taken)
}

/// A legal step: from a random node up its unmet prerequisites, or down those that need it, until nothing is in the way.
fn legal_step<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    view: &View<M::Mesh>,
    random: &mut Random,
    scratch: &mut Vec<NodeId>,
) -> Result<Option<Step>, Breach> {
    if model.is_empty() {
        return Ok(None);
    }
    let mut m = NodeId::new(random.below(model.len() as usize));
    let refined = view.front.is_refined(m);
    // Ranks rise on the way up and fall on the way down, or the walk would not end.
    for _ in 0..model.len() {
        scratch.clear();
        if refined {
            match model.obstacles(m, view, scratch) {
                Coarsen::Now => return Ok(Some(Step::coarsen(m))),
                Coarsen::Not => return Ok(None),
                Coarsen::After => {}
            }
        } else {
            model.prerequisites(m, view, scratch);
            if scratch.is_empty() {
                return Ok(Some(Step::refine(m)));
            }
        }
        let Some(&next) = scratch.get(random.below(scratch.len())) else { break };
        let ranked = if refined { next < m } else { next > m };
        let sound = ranked && next.0 < model.len() && view.front.is_refined(next) == refined;
        ensure!(sound, Law::Order, m, "node {m} waits for node {next}, which is not in its way");
        m = next;
    }
    Err(Breach::new(Law::Order, m, format!("node {m} has something in its way, but nothing is named")))
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

/// Law 8 at a front, for static orders: prerequisites are unmet needs or needs of those, and empty exactly when needs are
/// met; obstacles says Now exactly when no refined node needs it. Judges `tries` random nodes, and as many near the front.
/// O(tries × (chain + row)).
pub fn order<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    order: &Order,
    view: &View<M::Mesh>,
    random: &mut Random,
    tries: u32,
) -> Result<(), Breach> {
    let mut told = Vec::new();
    for _ in 0..tries.min(model.len()) {
        judge_node(model, order, view, NodeId::new(random.below(model.len() as usize)), &mut told)?;
        if let Some(step) = legal_step(model, view, random, &mut told)? {
            judge_node(model, order, view, step.node, &mut told)?;
        }
    }
    Ok(())
}

fn judge_node<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    order: &Order,
    view: &View<M::Mesh>,
    m: NodeId,
    told: &mut Vec<NodeId>,
) -> Result<(), Breach> {
    told.clear();
    if view.front.is_refined(m) {
        let answer = model.obstacles(m, view, told);
        let free = !order.dependents(m).iter().any(|&d| view.front.is_refined(d));
        let says = if free { "now" } else { "not yet" };
        let agree = (answer == Coarsen::Now) == free;
        ensure!(agree, Law::Order, m, "coarsening node {m}: the model says {answer:?}, its order says {says}");
        return Ok(());
    }
    model.prerequisites(m, view, told);
    let unmet = || order.needs(m).iter().copied().filter(|&n| !view.front.is_refined(n));
    let agree = told.is_empty() == (unmet().next().is_none());
    let needs: Vec<_> = unmet().collect();
    ensure!(agree, Law::Order, m, "refining node {m}: the model asks for {told:?}, its order for {needs:?}");
    let stray = told.iter().find(|&&n| n <= m || n.0 >= model.len() || view.front.is_refined(n));
    ensure!(stray.is_none(), Law::Order, m, "refining node {m}: the model asks for {stray:?}, which is not in its way");
    Ok(())
}

/// Law 8 on an explicit model: the order is what the cells say. A node needs exactly those whose fine side has a cell of
/// its coarse side. Shares no code with the derivation of the order. O(cells + arcs).
pub fn order_from_cells<const N: usize>(model: &Explicit<N>) -> Result<(), Breach> {
    let mut killer = vec![NodeId::NONE; model.total_cell_count() as usize];
    for p in (0..model.len()).map(NodeId) {
        model.fine_side(p).iter().for_each(|cell| killer[cell.index()] = p);
    }
    for m in (0..model.len()).map(NodeId) {
        let killers = model.coarse_side(m).map(|cell| killer[cell.index()]).filter(|p| !p.is_none());
        let needs: std::collections::BTreeSet<NodeId> = killers.collect();
        let told = model.order().needs(m);
        ensure!(needs.iter().eq(told), Law::Order, m, "node {m} needs {needs:?} by its cells, {told:?} by its order");
        let found = |p: &NodeId| model.order().dependents(*p).contains(&m);
        ensure!(needs.iter().all(found), Law::Order, m, "node {m} is not among the dependents of all that it needs");
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
