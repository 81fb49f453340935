//! All fronts that legal steps reach, and every step between two of them.

use mt_core::model::{MultiTessellation, Step, View, cells_of, take};
use mt_core::{Coarsen, Front, NodeId};
use mt_tests::truth::{Needs, Set, Truth};
use std::collections::HashMap;

/// A front as a set of bits.
pub type Mask = u32;

/// Every front that legal steps reach from the base mesh, with its mesh.
pub struct Lattice<X> {
    /// Meshes by front.
    pub meshes: HashMap<Mask, X>,
    /// Number of steps judged, both ways.
    pub steps: usize,
}

pub fn set_of(mask: Mask, count: u32) -> Set {
    (0..count).map(|m| mask >> m & 1 == 1).collect()
}

pub fn mask_of(front: &Front) -> Mask {
    front.finest_first().map(|m| 1 << m.0).sum()
}

pub fn front_of(mask: Mask, count: u32) -> Front {
    Front::from_nodes(count, (0..count).filter(|m| mask >> m & 1 == 1).map(NodeId))
}

/// All closed sets, straight from the definition.
pub fn closed_sets(order: &Needs, count: u32) -> Vec<Mask> {
    let needs: Vec<Mask> = order.needs.iter().map(|row| row.iter().fold(0, |mask, need| mask | 1 << need)).collect();
    let closed = |set: Mask| (0..count).all(|m| set >> m & 1 == 0 || needs[m as usize] & !set == 0);
    (0..1 << count).filter(|&set| closed(set)).collect()
}

/// Takes every legal step from every front that is reached. At each front the mesh is the definition's; each step is legal
/// for the model where it is by definition; it can be taken back, which leads back; and each front has one mesh, whichever
/// way it is reached.
pub fn explore<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    truth: &impl Truth<N>,
) -> Result<Lattice<M::Mesh>, String> {
    let base = model.base_view();
    let mut lattice = Lattice { meshes: HashMap::from([(0, base.mesh.clone())]), steps: 0 };
    let mut open = vec![base];
    while let Some(mut view) = open.pop() {
        let refined = set_of(mask_of(&view.front), model.len());
        let wanted = truth.mesh(&refined);
        hold(cells_of(model, &view.mesh) == wanted, || format!("at {refined:?} the mesh is not {wanted:?}"))?;
        hold(model.cell_count(&view.mesh) as usize == wanted.len(), || format!("at {refined:?} cells are miscounted"))?;
        for m in (0..model.len()).map(NodeId) {
            let step = Step { node: m, refined: !refined[m.index()] };
            let says = is_legal(model, step, &view);
            let told = truth.allows(&refined, step);
            hold(told.is_none_or(|told| told == says), || {
                format!("at {refined:?} {step:?} is legal: {told:?}; the model says {says}")
            })?;
            if says {
                open.extend(step_there_and_back(model, step, &mut view, &mut lattice)?);
            }
        }
    }
    Ok(lattice)
}

/// Takes a step and takes it back; the view beyond, if it is new.
fn step_there_and_back<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    step: Step,
    view: &mut View<M::Mesh>,
    lattice: &mut Lattice<M::Mesh>,
) -> Result<Option<View<M::Mesh>>, String> {
    let before = view.clone();
    lattice.steps += 1;
    take(model, step, view, &mut ());
    let beyond = view.clone();
    hold(is_legal(model, step.inverse(), &beyond), || {
        format!("{step:?} at {:?} leads where there is no way back", before.front)
    })?;
    take(model, step.inverse(), view, &mut ());
    hold(*view == before, || format!("{step:?} at {:?} is not undone by its inverse", before.front))?;
    match lattice.meshes.entry(mask_of(&beyond.front)) {
        std::collections::hash_map::Entry::Occupied(known) => {
            hold(*known.get() == beyond.mesh, || format!("{:?} has two meshes", beyond.front))?;
            Ok(None)
        }
        std::collections::hash_map::Entry::Vacant(new) => {
            new.insert(beyond.mesh.clone());
            Ok(Some(beyond))
        }
    }
}

/// Whether the model itself says that a step is legal.
fn is_legal<const N: usize, M: MultiTessellation<N>>(model: &M, step: Step, view: &View<M::Mesh>) -> bool {
    let mut out = Vec::new();
    if step.refined {
        model.prerequisites(step.node, view, &mut out);
        return out.is_empty();
    }
    model.obstacles(step.node, view, &mut out) == Coarsen::Now
}

pub fn hold(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}
