//! Slow oracles: what the mesh of a front is by set algebra, and by another way of getting there.

use super::{Breach, Law, Mirror, Random, ensure};
use crate::bits::Bits;
use crate::explicit::Explicit;
use crate::front::Front;
use crate::id::{CellId, NodeId};
use crate::model::{MultiTessellation, Sink, Step, View, cells_of, take};

/// Base cells, plus fine cells of the front, minus coarse cells of the front, by id. O(cells).
pub fn set_algebra<const N: usize>(model: &Explicit<N>, front: &Front) -> Result<Vec<CellId>, Breach> {
    let mut count = vec![0i32; model.total_cell_count() as usize];
    for cell in model.base_cells() {
        count[cell.index()] += 1;
    }
    for m in front.finest_first() {
        model.fine_side(m).iter().for_each(|cell| count[cell.index()] += 1);
        model.coarse_side(m).for_each(|cell| count[cell.index()] -= 1);
    }
    let odd = count.iter().position(|&n| n != 0 && n != 1);
    ensure!(odd.is_none(), Law::CrackFree, None, "cell {:?} is there {} times", odd, count[odd.unwrap_or(0)]);
    Ok(count.iter().enumerate().filter(|(_, n)| **n == 1).map(|(cell, _)| CellId::new(cell)).collect())
}

/// Law 5: reaching a closed front in another sequence of legal steps, with detours, gives the same mesh.
///
/// `view` is at the front; the other way starts from the base mesh, refines members in random order as they become
/// legal, and now and then takes a step back. What the sink was told on the way must be that mesh too. O(nodes of the
/// front × their needs).
pub fn front_determines_mesh<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    view: &View<M::Mesh>,
    random: &mut Random,
) -> Result<(), Breach> {
    let mut other = model.base_view();
    let mut mirror = Mirror::default();
    model.cells(&other.mesh, |cell, corners| mirror.make(cell, corners));
    let mut waiting: Vec<NodeId> = view.front.finest_first().collect();
    let mut seen = Bits::new(model.len());
    let mut unmet = Vec::new();
    for i in (1..waiting.len()).rev() {
        waiting.swap(i, random.below(i + 1));
    }
    while let Some(&m) = waiting.last() {
        if other.front.is_refined(m) {
            waiting.pop();
            continue;
        }
        unmet.clear();
        model.prerequisites(m, &other, &mut unmet);
        if let Some(stranger) = unmet.iter().find(|need| !view.front.is_refined(**need)) {
            return Err(Breach::new(
                Law::Closure,
                m,
                format!("node {m} asks for node {stranger}, which its closed front lacks"),
            ));
        }
        if let Some(stray) = unmet.iter().find(|need| **need <= m || other.front.is_refined(**need)) {
            return Err(Breach::new(Law::Order, m, format!("node {m} asks for node {stray}, which is not in its way")));
        }
        if unmet.is_empty() {
            take(model, Step::refine(m), &mut other, &mut mirror);
            if seen.insert(m.0) && random.below(16) == 0 {
                // A detour: undo the step at once and take it again.
                take(model, Step::coarsen(m), &mut other, &mut mirror);
            }
        } else {
            waiting.append(&mut unmet);
        }
    }
    let cells = cells_of(model, &view.mesh);
    let same = other == *view && cells_of(model, &other.mesh) == cells;
    let size = view.front.len();
    ensure!(same, Law::FrontDeterminesMesh, None, "two ways to one front of {size} nodes end in different meshes");
    let told = mirror
        .cells()
        .map_err(|fault| Breach::new(Law::FrontDeterminesMesh, None, format!("the sink was told that {fault}")))?;
    let mut cells = cells;
    cells.sort_unstable();
    ensure!(told == cells, Law::FrontDeterminesMesh, None, "the sink was told another mesh than that of the front");
    Ok(())
}
