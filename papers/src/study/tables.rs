//! The tables of a report that sum up frames: schemes, strategies, fans against edge collapses.

use super::report::columns;
use super::results::{Built, Observation, Results};
use crate::html::Table;
use std::collections::BTreeMap;

/// What a criterion asks for in a study.
pub(super) fn meaning(criterion: &str, error_px: f32) -> String {
    match criterion {
        "uniform" => "the same error everywhere, from 2 % of the diagonal down to 0.01 % along the path".to_owned(),
        "region" => "0.02 % of the diagonal within a box that travels through the model, anything outside".to_owned(),
        "screen" => format!("{error_px} px of error on the screen, coarse outside the frustum"),
        "facing" => format!("{error_px} px of error on the screen where the surface faces the eye"),
        "silhouette" => format!("{error_px} px of error on the screen, a quarter of that at outlines"),
        "moving" => format!("{error_px} px of error on the screen, more the faster the camera moves"),
        "features" => "0.01 to 0.1 % of the diagonal at feature points, 1 % elsewhere".to_owned(),
        "visual" => "an error by distance, view and light: Eq. 3 of the fan paper, read as a tolerance".to_owned(),
        "budget" => "the least error on the screen that a tenth of the input's triangles allow".to_owned(),
        other => other.to_owned(),
    }
}

/// The frames of one combination.
pub(super) struct Group<'a> {
    frames: Vec<&'a Observation>,
}

impl<'a> Group<'a> {
    fn key(&self) -> &'a Observation {
        self.frames[0]
    }

    fn mean(&self, value: impl Fn(&Observation) -> f64) -> f64 {
        self.frames.iter().map(|o| value(o)).sum::<f64>() / self.frames.len() as f64
    }

    fn most(&self, value: impl Fn(&Observation) -> u32) -> u32 {
        self.frames.iter().map(|o| value(o)).max().unwrap_or(0)
    }

    /// The 95th percentile over the frames.
    fn p95(&self, value: impl Fn(&Observation) -> u32) -> u32 {
        let mut all: Vec<u32> = self.frames.iter().map(|o| value(o)).collect();
        all.sort_unstable();
        all[(all.len() - 1) * 95 / 100]
    }

    fn steps(&self) -> f64 {
        self.mean(|o| f64::from(o.refined + o.coarsened))
    }

    /// Frames after the first, which makes everything.
    fn moving(&self, value: impl Fn(&Observation) -> f64) -> f64 {
        let frames = &self.frames[1.min(self.frames.len() - 1)..];
        frames.iter().map(|o| value(o)).sum::<f64>() / frames.len() as f64
    }
}

/// Observations of one combination follow each other.
pub(super) fn groups<'a>(observations: &'a [Observation], chosen: impl Fn(&Observation) -> bool) -> Vec<Group<'a>> {
    let same = |a: &Observation, b: &Observation| {
        a.model == b.model
            && a.operator == b.operator
            && (a.dependency, a.criterion, a.strategy) == (b.dependency, b.criterion, b.strategy)
    };
    let runs = observations.chunk_by(same).map(|run| run.iter().collect::<Vec<_>>());
    runs.filter(|run| chosen(run[0])).map(|frames| Group { frames }).collect()
}

/// One row for each operator and dependency: vertices against dual-piece, forced nodes, bytes and time, over all models.
/// None where dual-piece was not run.
pub(super) fn in_short(results: &Results) -> Option<Table> {
    let titles = [
        "operator",
        "dependency",
        "vertices / dual-piece",
        "forced a frame",
        "longest chain",
        "bytes a vertex",
        "ns a bare step",
    ];
    let local = |o: &Observation| o.strategy == "incremental" && matches!(o.criterion, "region" | "screen");
    let all = groups(&results.observations, local);
    let vertices = |group: &Group<'_>| group.mean(|o| o.vertices as f64);
    let mut rows = Vec::new();
    let mut seen: Vec<(&str, &str)> = Vec::new();
    for group in &all {
        let (operator, dependency) = (group.key().operator.as_str(), group.key().dependency);
        if seen.contains(&(operator, dependency)) {
            continue;
        }
        seen.push((operator, dependency));
        let same =
            |other: &&Group<'_>| (other.key().operator.as_str(), other.key().dependency) == (operator, dependency);
        let mine: Vec<&Group<'_>> = all.iter().filter(same).collect();
        let ratio = |group: &&Group<'_>| {
            let k = group.key();
            let dual = all.iter().find(|other| {
                let o = other.key();
                (&o.model, &o.operator, o.criterion, o.dependency) == (&k.model, &k.operator, k.criterion, "dual-piece")
            })?;
            Some(vertices(group) / vertices(dual).max(1.0))
        };
        let ratios: Vec<f64> = mine.iter().filter_map(ratio).collect();
        let orders = results.ordered.iter().filter(|o| (o.operator.as_str(), o.dependency) == (operator, dependency));
        if ratios.is_empty() {
            continue;
        }
        rows.push(vec![
            operator.to_owned(),
            dependency.to_owned(),
            format!("{:.2}", mean(ratios)),
            format!("{:.1}", mean(mine.iter().map(|group| group.mean(|o| f64::from(o.forced))))),
            mine.iter().map(|group| group.most(|o| o.chain_max)).max().unwrap_or(0).to_string(),
            format!("{:.1}", mean(orders.clone().map(|o| o.bytes_per_vertex))),
            format!("{:.0}", mean(orders.map(|o| o.nanoseconds_a_step))),
        ]);
    }
    (!rows.is_empty()).then(|| Table { caption: String::new(), columns: columns(&titles, 2), rows })
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// One row for each model, operator, criterion and dependency, the dependencies next to each other.
pub(super) fn schemes(groups: &[Group<'_>]) -> Table {
    let titles = [
        "model",
        "operator",
        "criterion",
        "dependency",
        "vertices",
        "ratio",
        "triangles",
        "forced",
        "forced p95",
        "chain p95",
        "longest chain",
        "refined",
        "coarsened",
        "folds",
        "ms",
        "ns a step, in all",
    ];
    let mut by_wish: BTreeMap<(&str, &str, &str), Vec<&Group<'_>>> = BTreeMap::new();
    let mut order: Vec<(&str, &str, &str)> = Vec::new();
    for group in groups {
        let key = (group.key().model.as_str(), group.key().operator.as_str(), group.key().criterion);
        if !order.contains(&key) {
            order.push(key);
        }
        by_wish.entry(key).or_default().push(group);
    }
    let vertices = |group: &Group<'_>| group.mean(|o| o.vertices as f64);
    let mut rows = Vec::new();
    for key in order {
        let of_wish = &by_wish[&key];
        let dual = of_wish.iter().find(|group| group.key().dependency == "dual-piece").map(|group| vertices(group));
        let unit = dual.unwrap_or_else(|| of_wish.iter().map(|group| vertices(group)).fold(f64::INFINITY, f64::min));
        for group in of_wish {
            let mut row: Vec<String> = [key.0, key.1, key.2, group.key().dependency].map(str::to_owned).to_vec();
            row.push(format!("{:.0}", vertices(group)));
            row.push(format!("{:.2}", vertices(group) / unit.max(1.0)));
            row.push(format!("{:.0}", group.mean(|o| f64::from(o.triangles))));
            row.push(format!("{:.1}", group.mean(|o| f64::from(o.forced))));
            row.push(group.p95(|o| o.forced).to_string());
            row.push(format!("{:.1}", group.mean(|o| f64::from(o.chain_p95))));
            row.push(group.most(|o| o.chain_max).to_string());
            row.push(format!("{:.0}", group.mean(|o| f64::from(o.refined))));
            row.push(format!("{:.0}", group.mean(|o| f64::from(o.coarsened))));
            let folds: Vec<u32> = group.frames.iter().filter_map(|o| o.folds).collect();
            row.push(format!("{:.1}", f64::from(folds.iter().sum::<u32>()) / folds.len().max(1) as f64));
            row.push(format!("{:.3}", group.mean(|o| o.seconds * 1e3)));
            row.push(format!("{:.0}", group.mean(|o| o.seconds * 1e9) / group.steps().max(1.0)));
            rows.push(row);
        }
    }
    Table { caption: String::new(), columns: columns(&titles, 4), rows }
}

/// One row for each model, operator, criterion and strategy.
pub(super) fn strategies(groups: &[Group<'_>]) -> Table {
    let titles = [
        "model",
        "operator",
        "criterion",
        "strategy",
        "triangles",
        "refined",
        "coarsened",
        "nodes turned",
        "fan steps",
        "edge steps",
        "triangles touched",
        "ms",
    ];
    let row = |group: &Group<'_>| {
        let key = group.key();
        let mut row: Vec<String> =
            [key.model.as_str(), key.operator.as_str(), key.criterion, key.strategy].map(str::to_owned).to_vec();
        let counts: [fn(&Observation) -> f64; 7] = [
            |o| f64::from(o.triangles),
            |o| f64::from(o.refined),
            |o| f64::from(o.coarsened),
            |o| f64::from(o.changed),
            |o| f64::from(o.fan_steps),
            |o| f64::from(o.edge_steps),
            |o| f64::from(o.touched),
        ];
        row.extend(counts.map(|count| format!("{:.0}", group.mean(count))));
        row.push(format!("{:.3}", group.mean(|o| o.seconds * 1e3)));
        row
    };
    Table { caption: String::new(), columns: columns(&titles, 4), rows: groups.iter().map(row).collect() }
}

/// Fan-merge against edge collapse under the screen criterion: build, nodes, bytes, operations.
pub(super) fn fans(results: &Results) -> Option<Table> {
    let titles = [
        "model",
        "hierarchy",
        "analysis s",
        "merges",
        "bytes a vertex",
        "operations a frame",
        "fan : edge",
        "touched an operation",
        "triangles",
        "operations / 1000",
        "ms a frame",
    ];
    let built = |model: &str, operator: &str| results.built.iter().find(|b| b.model == model && b.operator == operator);
    let mut rows = Vec::new();
    for fan in results.built.iter().filter(|b| b.operator == "fan-merge") {
        // The paper's rival merges pairs; where pairs were not studied, edges stand in.
        let rivals = ["vertex-pair", "edge-collapse"].map(|operator| built(&fan.model, operator));
        let of_rivals = rivals.into_iter().flatten().map(|b| (b, "incremental", TREE));
        let of_fans = ["incremental", "dual", "dual-distance", "coarse"].map(|strategy| (fan, strategy, TREE));
        // The explicit model knows a fan as one node: nothing but fan steps.
        let whole = [(fan, "incremental", ["cells"].as_slice())];
        let all = of_rivals.chain(of_fans).chain(whole);
        rows.extend(all.filter_map(|(b, strategy, dependencies)| fan_row(results, b, strategy, dependencies)));
    }
    (!rows.is_empty()).then(|| Table { caption: String::new(), columns: columns(&titles, 2), rows })
}

/// The rival of the paper is the view-dependence tree, under implicit ids; other schemes stand in.
const TREE: &[&str] = &["implicit-ids", "one-ring", "dual-piece"];

fn fan_row(results: &Results, b: &Built, strategy: &str, dependencies: &[&str]) -> Option<Vec<String>> {
    let under = |dependency: &str| {
        let of = |o: &Observation| {
            o.model == b.model
                && o.operator == b.operator
                && o.criterion == "screen"
                && o.strategy == strategy
                && o.dependency == dependency
        };
        groups(&results.observations, of).into_iter().next()
    };
    let (dependency, group) = dependencies.iter().find_map(|d| Some((*d, under(d)?)))?;
    let whole = dependency == "cells";
    let fans = group.moving(|o| f64::from(if whole { o.refined + o.coarsened } else { o.fan_steps }));
    let edges = group.moving(|o| f64::from(if whole { 0 } else { o.edge_steps }));
    let operations = fans + edges;
    let bytes = if whole { b.explicit_bytes_per_vertex } else { b.bytes_per_vertex };
    Some(vec![
        b.model.clone(),
        format!("{}, {strategy}, {dependency}", b.operator),
        format!("{:.3}", b.seconds),
        b.merges.to_string(),
        format!("{bytes:.1}"),
        format!("{operations:.0}"),
        format!("{fans:.0} : {edges:.0}"),
        format!("{:.1}", group.moving(|o| f64::from(o.touched)) / operations.max(1.0)),
        format!("{:.0}", group.mean(|o| f64::from(o.triangles))),
        format!("{:.1}", 1e3 * operations / group.mean(|o| f64::from(o.triangles)).max(1.0)),
        format!("{:.3}", group.moving(|o| o.seconds * 1e3)),
    ])
}
