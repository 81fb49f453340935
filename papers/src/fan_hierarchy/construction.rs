//! Tables 1 and 2, and what the text says of depth: making both hierarchies, and what they are made of.

use super::{Both, ROLES, both, ends, exponent, range};
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop};
use crate::table::Table;
use mt_core::hierarchy::Replay;
use mt_core::{NodeId, VertexId};

/// Adds the models to an entry and gives the hierarchies.
fn each(workshop: &mut Workshop<'_>, entry: &mut Entry, mut visit: impl FnMut(&Both)) -> Result<(), LedgerError> {
    for role in &ROLES {
        let both = both(workshop, role)?;
        entry.models.push(both.subject.told());
        visit(&both);
    }
    Ok(())
}

pub(super) fn table_1(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let mut table = Table::new(
        "Measured: wall seconds of analysis and replay, whatever else the machine did.",
        "dataset | #vertices | #FH, s | #VDT, s | #VDT / FH | #printed | #FH, us a vertex | #printed, us | #VDT, us a vertex | #printed, us",
    );
    let printed = published.table("table-1")?;
    let faster = printed.quotients("VDT, min:s", "FH, min:s")?;
    let [slow, fast] = ["VDT, min:s", "FH, min:s"].map(|time| printed.quotients(time, "vertices, K"));
    let (slow, fast) = (slow?, fast?);
    let (mut ratios, mut points, mut rival) = (Vec::new(), Vec::new(), Vec::new());
    each(workshop, entry, |both| {
        let i = ratios.len();
        let vertices = both.subject.mesh.vertex_count() as f64;
        let [fan, tree] = both.seconds;
        ratios.push(tree / fan);
        points.push((vertices, fan));
        rival.push(tree * 1e6 / vertices);
        let times =
            [format!("{fan:.2}"), format!("{tree:.2}"), format!("{:.2}", tree / fan), format!("{:.1}", faster[i])];
        let each = [fan * 1e6 / vertices, fast[i] * 1e3, tree * 1e6 / vertices, slow[i] * 1e3];
        let head = [both.subject.name.to_owned(), format!("{vertices}")];
        table.row(head.into_iter().chain(times).chain(each.map(|us| format!("{us:.1}"))));
    })?;
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "preprocessing of fans runs more than 10 times faster",
        ends(&ratios).0 > 10.0,
        format!("VDT / FH is {}", range(&ratios, 2)),
        &format!(
            "both operators go through one loop here (price, plan, apply, record) and remove as many vertices. The paper does \
             not say what its rival spends {} ms a vertex on; ours takes {} us",
            range(&slow, 1),
            range(&rival, 1)
        ),
    ));
    let by_size: Vec<(f64, f64)> =
        printed.column("vertices, K")?.into_iter().zip(printed.column("FH, min:s")?).collect();
    let (ours, theirs) = (exponent(&points), exponent(&by_size));
    entry.claims.push(Claim::check(
        "it runs in nearly linear time with respect to the number of vertices",
        (ours - 1.0).abs() < 0.15,
        format!("the time grows as the number of vertices to the power of {ours:.2}; by the printed table {theirs:.2}"),
        "the models differ by more than their sizes, in how many fans merge whole and in what fits into the caches",
    ));
    entry.note(
        "The rival does without virtual edges here; with them its preprocessing also has a Delaunay triangulation.",
    );
    Ok(())
}

pub(super) fn table_2(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let mut table = Table::new(
        "Measured: internal nodes are merged vertices; bytes are those of the hierarchies in memory, without the input.",
        "dataset | #FH internal | #VDT internal | #VDT / FH | #printed | #FH, bytes a vertex | #VDT, bytes a vertex | #saving | #printed | #from printed sizes",
    );
    let mut whole = Table::new(
        "Measured: fans that take the whole link of their centre and fans that take a part of it; vertices that join, on the average.",
        "dataset | #whole fans | #join | #partial fans | #join",
    );
    let printed = published.table("table-2")?;
    let internal = printed.quotients("VDT internal nodes, K", "FH internal nodes, K")?;
    let (factors, sizes) = (printed.column("saving factor")?, printed.quotients("VDT size, KB", "FH size, KB")?);
    let (mut nodes, mut savings, mut joins) = (Vec::new(), Vec::new(), Vec::new());
    each(workshop, entry, |both| {
        let i = nodes.len();
        let vertices = both.subject.mesh.vertex_count() as f64;
        let [fan, tree] = [&both.fan.replay, &both.tree.replay].map(|replay| f64::from(replay.merge_count()));
        let [fan_bytes, tree_bytes] = [&both.fan, &both.tree].map(|hierarchy| hierarchy.bytes() as f64 / vertices);
        nodes.push(tree / fan);
        savings.push(tree_bytes / fan_bytes);
        let head = [both.subject.name.to_owned(), format!("{fan}"), format!("{tree}")];
        let numbers = [tree / fan, internal[i], fan_bytes, tree_bytes, savings[i], factors[i], sizes[i]];
        table.row(head.into_iter().chain(numbers.map(|number| format!("{number:.2}"))));
        let [all, part] = fans_of(&both.fan.replay);
        joins.push(all.1);
        let told = [(all.0.to_string(), all.1), (part.0.to_string(), part.1)];
        whole.row(
            [both.subject.name.to_owned()]
                .into_iter()
                .chain(told.into_iter().flat_map(|(count, mean)| [count, format!("{mean:.2}")])),
        );
    })?;
    entry.measured.extend([table, whole]);
    entry.claims.push(Claim::check(
        "the view-dependence tree has 4 to 6 times as many internal nodes (5.0 to 7.0 by the printed table)",
        nodes.iter().all(|ratio| (4.0..=7.1).contains(ratio)),
        format!("{} times", range(&nodes, 2)),
        &format!(
            "whole fans are small, {} vertices join one: the sum of errors over a link puts centres of few neighbours first; and \
             a fan that would sew sheets together or fold over is merged in part, which makes smaller ones",
            range(&joins, 1)
        ),
    ));
    entry.claims.push(Claim::check(
        "the tree is 1.3 to 1.7 times the size of the fan hierarchy",
        savings.iter().all(|saving| (1.3..=1.7).contains(saving)),
        format!("{} times", range(&savings, 2)),
        "smaller fans save less, and both are compact here: a fan needs a table of its children, which an edge does without",
    ));
    entry.note(
        "Sizes are of our data structures: arrays of four-byte ids, error, radius and normal cone a node; the paper's have \
         pointers and lists of triangles. Ours stores implicit ids as the numbering.",
    );
    Ok(())
}

/// Fans that take the whole link of their centre, and those that take a part: how many, and how many vertices join each.
fn fans_of(replay: &Replay) -> [(u32, f64); 2] {
    let mut found = [(0u32, 0u32); 2];
    replay.sweep(|m, view| {
        let merge = replay.merge_of(m);
        let run = replay.run_of(merge);
        if m == *run.start() {
            let mut ring: Vec<VertexId> = view.mesh.ring(replay.merge(merge).center).collect();
            ring.sort_unstable();
            ring.dedup();
            let joining = run.end().0 - run.start().0 + 1;
            let kind = &mut found[usize::from((joining as usize) < ring.len())];
            *kind = (kind.0 + 1, kind.1 + joining);
        }
    });
    found.map(|(fans, joining)| (fans, f64::from(joining) / f64::from(fans.max(1))))
}

pub(super) fn depth(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let mut table = Table::new(
        "Measured: merges above an input vertex, mean and most. A forest of as many trees as the base mesh has vertices can be \
         no deeper on the average than its trees, so n / trees stands in the logarithms. Children count the centre.",
        "dataset | #FH trees | #FH mean depth | #FH depth | #log6 | #VDT trees | #VDT mean depth | #VDT depth | #log2 | #children | #pointers a node",
    );
    let (mut fans, mut trees, mut pointers, mut shallower) = (Vec::new(), Vec::new(), Vec::new(), true);
    let mut depths_by = Vec::new();
    each(workshop, entry, |both| {
        let n = both.subject.mesh.vertex_count() as f64;
        let [fan, tree] = [&both.fan.replay, &both.tree.replay].map(|replay| depths(replay));
        let replay = &both.fan.replay;
        let children = 1.0 + f64::from(replay.len()) / f64::from(replay.merge_count().max(1));
        let [by_six, by_two] = [(n / fan.roots).log(6.0), (n / tree.roots).log2()];
        fans.push(fan.mean / by_six);
        trees.push(tree.mean / by_two);
        pointers.push(1.0 + 1.0 / children);
        shallower &= fan.mean < tree.mean;
        depths_by.push(fan.mean / tree.mean);
        let of = |depths: &Depths, log: f64| {
            [format!("{}", depths.roots), format!("{:.1}", depths.mean), depths.most.to_string(), format!("{log:.1}")]
        };
        let row = [both.subject.name.to_owned()].into_iter().chain(of(&fan, by_six)).chain(of(&tree, by_two));
        table.row(row.chain([format!("{children:.2}"), format!("{:.2}", 1.0 + 1.0 / children)]));
    })?;
    entry.measured.push(table);
    let near = |ratios: &[f64]| ends(ratios).0 > 0.75 && ends(ratios).1 < 1.25;
    let why =
        "a logarithm needs a balanced forest and as many children at every node, and the order of errors makes neither";
    entry.claims.push(Claim::check(
        "the average depth of fans is log6 n",
        near(&fans),
        format!("{} times log6", range(&fans, 2)),
        why,
    ));
    entry.claims.push(Claim::check(
        "that of edge collapses is log2 n",
        near(&trees),
        format!("{} times log2", range(&trees, 2)),
        why,
    ));
    entry.claims.push(Claim::check(
        "the depth of fan hierarchies is usually smaller (the mean depth)",
        shallower,
        format!("{} times the mean depth of the trees; the largest depth is in the table", range(&depths_by, 2)),
        "",
    ));
    entry.claims.push(Claim::check(
        "7/6 pointers a node instead of 3",
        ends(&pointers).1 < 1.3,
        format!("1 + 1 / children is {}", range(&pointers, 2)),
        "fans have fewer children than six",
    ));
    Ok(())
}

/// How deep a forest is.
struct Depths {
    /// Merges above an input vertex, on the average and at most.
    mean: f64,
    most: u32,
    /// Vertices of the base mesh.
    roots: f64,
}

/// Merges above a leaf: the mean over leaves, and the most.
fn depths(replay: &Replay) -> Depths {
    let leaves = replay.leaf_count();
    let mut depth = vec![0u32; replay.vertex_count() as usize];
    // The vertex of a merge was made before the merge that takes it, so a descending sweep meets parents first.
    for merge in (0..replay.merge_count()).rev() {
        let below = depth[(leaves + merge) as usize] + 1;
        depth[replay.merge(merge).center.index()] = below;
        let run = replay.run_of(merge);
        for m in (run.start().0..=run.end().0).map(NodeId) {
            depth[replay.node(m).child.index()] = below;
        }
    }
    let leaves = &depth[..leaves as usize];
    let sum: f64 = leaves.iter().copied().map(f64::from).sum();
    let mean = sum / leaves.len().max(1) as f64;
    let roots = f64::from((replay.leaf_count() - replay.len()).max(1));
    Depths { mean, most: leaves.iter().copied().max().unwrap_or(0), roots }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::{Bare, Size};

    #[test]
    fn depths_agree_with_climbing() {
        let (mut bare, mut watch) = (Bare, |_: &str, _: f32| true);
        let mut workshop = Workshop::new(Size::Small, &mut bare, &mut watch);
        let both = both(&mut workshop, &ROLES[0]).unwrap();
        for replay in [&both.fan.replay, &both.tree.replay] {
            let climbs = |leaf: u32| {
                let (mut v, mut merges) = (VertexId(leaf), 0u32);
                while !replay.merged_at(v).is_none() {
                    v = replay.vertex(replay.merged_at(v));
                    merges += 1;
                }
                // The centre of a merge goes on under the merged vertex's name.
                merges
            };
            let all: Vec<u32> = (0..replay.leaf_count()).map(climbs).collect();
            let mean = all.iter().copied().map(f64::from).sum::<f64>() / all.len() as f64;
            let found = depths(replay);
            assert_eq!((Some(&found.most), found.mean), (all.iter().max(), mean));
        }
    }
}
