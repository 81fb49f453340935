//! The report: one page with tables, plots and pictures, for somebody who was not there.

use super::choices::LEFT_OUT;
use super::results::{Built, Observation, Ordered, Results};
use super::tables;
use crate::html::{Align, Page, Shot, Table};
use crate::plot::{Axis, Lines, Series};
use std::collections::BTreeMap;

/// The page, with everything in it.
pub fn page(results: &Results) -> String {
    let mut page = Page::new("Study of Multi-Tessellations");
    page.paragraph(&format!("Made by mtess {}.", env!("CARGO_PKG_VERSION")));
    introduction(&mut page, results);
    for model in names(results) {
        let pictures = results.pictures.iter().filter(|p| p.model == model);
        page.gallery(pictures.map(|p| Shot { png: &p.png, caption: &p.caption, command: &p.command }));
    }
    page.heading(2, "Models");
    page.paragraph(
        "One analysis for each model and operator. Bytes are those of the vertex hierarchy alone, without the input mesh \
         and without dependencies; and of the explicit model with all its cells and arcs. \"Stall\" is the share of the \
         vertices that were left when the first fan came that could not be merged whole.",
    );
    page.table(&built_table(&results.built));
    page.paragraph("Plans refused, by reason; a place may be refused more than once:");
    page.list(results.built.iter().map(refusals));
    page.paragraph("Where the bytes of the hierarchies go, for each vertex of the input:");
    page.table(&bytes_table(&results.built));
    for model in names(results) {
        page.figure_svg(
            &degree_plot(results, model).svg(),
            &format!("{model}: triangles at a vertex, the most and the mean, by size."),
        );
    }
    page.heading(2, "Dependencies");
    page.paragraph(
        "What steps wait for, on the same sequence. \"Beyond the forest\" are needs that the parents do not imply, which is \
         all that a static scheme stores; for dual-piece these are the nodes whose cut vertices could coincide. \"cells\" is \
         the explicit model: its nodes are whole fans, its bounds are spheres of their own, and it asks for no parents, so its \
         meshes differ from those of \"explicit\", which is the same relation on the hierarchy. \"ns a bare step\" is that of \
         refining everything and coarsening it again with every check, the best of three rounds.",
    );
    page.table(&ordered_table(&results.ordered));
    schemes(&mut page, results);
    strategies(&mut page, results);
    page.heading(2, "Error by size");
    page.paragraph(
        "Sampled distance between the extracted mesh and the input, both ways, the larger; relative to the diagonal of \
         the bounding box. \"Stated\" is the largest error among the modifications that were not refined, as the model \
         itself says.",
    );
    page.table(&quality_table(results));
    for model in names(results) {
        page.figure_svg(&quality_plot(results, model).svg(), &format!("{model}: root mean square distance by size."));
    }
    if !results.notes.is_empty() {
        page.heading(2, "What could not be done");
        page.list(&results.notes);
    }
    if let Some(picture) = results.pictures.first() {
        page.paragraph(&format!("Pictures were drawn by {}.", picture.painter));
    }
    page.finish()
}

fn introduction(page: &mut Page, results: &Results) {
    page.paragraph(&format!(
        "Each model was coarsened to the end by each operator and every step was kept. A camera then went once around it \
         in {} frames, from afar to close by and back, and criteria were answered by strategies under dependencies in every \
         combination that says something of its own. All numbers are in results.csv, one observation a row. Counts are \
         exact. Times are wall seconds of one run on one machine: rows that differ by less than a factor of two need not \
         differ at all.",
        results.frames
    ));
    let asked: BTreeMap<&str, String> =
        results.observations.iter().map(|o| (o.criterion, tables::meaning(o.criterion, results.error_px))).collect();
    page.list(asked.iter().map(|(name, meaning)| format!("{name}: {meaning}")));
    page.paragraph("Left out:");
    page.list(LEFT_OUT);
}

/// The schemes on the same frames: the heart of the page.
fn schemes(page: &mut Page, results: &Results) {
    page.heading(2, "Schemes compared");
    page.paragraph(
        "Means over the same frames, incrementally. \"Forced\" are modifications that the criterion did not ask for, but that \
         others need; a chain is what refining one node took; \"chain p95\" is the mean over the frames of each frame's 95th percentile, 0 \
         where nothing was refined. \"Ratio\" compares vertices with those of dual-piece where that was run, else with the \
         fewest. \"Folds\" are inner edges whose triangles nearly face each other. \"ns a step, in all\" is the time of a frame \
         by its steps, so it holds the judging of all nodes that stay as they are.",
    );
    if let Some(table) = tables::in_short(results) {
        page.paragraph(
            "In short: means over all models, criteria region and screen, against dual-piece on the same frames.",
        );
        page.table(&table);
        page.paragraph("And one by one:");
    }
    let groups = tables::groups(&results.observations, |o| o.strategy == "incremental");
    page.table(&tables::schemes(&groups));
    for model in names(results) {
        page.heading(3, model);
        for criterion in ["region", "screen"] {
            let chosen = |o: &&Observation| {
                o.model == model
                    && o.strategy == "incremental"
                    && o.criterion == criterion
                    && o.operator == first_operator(results)
            };
            let plot = per_frame(
                results,
                chosen,
                |o| o.dependency.to_owned(),
                |o| o.vertices as f64,
                Axis::logarithmic("vertices"),
            );
            if !plot.series.is_empty() {
                page.figure_svg(
                    &plot.svg(),
                    &format!("Vertices of each frame, {criterion}, by dependency ({}).", first_operator(results)),
                );
            }
        }
        page.figure_svg(
            &time_plot(results, model).svg(),
            &format!(
                "Milliseconds of each frame for the screen criterion, by strategy ({}).",
                shown_dependency(results)
            ),
        );
    }
}

/// The strategies under one dependency, and fans against edge collapses.
fn strategies(page: &mut Page, results: &Results) {
    page.heading(2, "Strategies compared");
    let dependency = shown_dependency(results);
    page.paragraph(&format!(
        "The same criterion answered from the base mesh (top-down, priority) or from the mesh of the last frame, under \
         {dependency}. Minimality makes the sizes of all strategies equal where no budget is set and nothing is remembered; \
         what differs is the work. \"Nodes turned\" are refined now and were not in the last frame, or the reverse.",
    ));
    page.table(&tables::strategies(&tables::groups(&results.observations, |o| o.dependency == dependency)));
    if let Some(table) = tables::fans(results) {
        page.heading(2, "Fans against edge collapses");
        page.paragraph(
            "The comparison of Livny, Sokolovsky and El-Sana (2006), Tables 1 to 3, for the same model and path, the screen \
             criterion, and implicit ids where they were run; in \"cells\" each fan is one node of the explicit model. A fan step \
             counts as one operation. Triangles touched say what an operation is worth. The published tables compare meshes of \
             the same size; a fan leaves its centre where it is, so it takes more triangles for the same error, and \
             operations for a thousand triangles are what compares with them.",
        );
        page.table(&table);
    }
}

/// The dependency under which strategies are shown: the last static one that was run, as good as any.
fn shown_dependency(results: &Results) -> &'static str {
    results.ordered.iter().rev().find(|o| o.is_static).map_or("", |o| o.dependency)
}

fn first_operator(results: &Results) -> &str {
    results.built.first().map_or("", |b| &b.operator)
}

fn names(results: &Results) -> Vec<&str> {
    let mut names: Vec<&str> = results.built.iter().map(|b| b.model.as_str()).collect();
    names.dedup();
    names
}

pub(super) fn columns(titles: &[&str], texts: usize) -> Vec<(String, Align)> {
    let align = |i| if i < texts { Align::Text } else { Align::Number };
    titles.iter().enumerate().map(|(i, title)| ((*title).to_owned(), align(i))).collect()
}

fn refusals(built: &Built) -> String {
    let counts: Vec<_> = built.refusals.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let counts = if counts.is_empty() { "none".to_owned() } else { counts.join(", ") };
    format!("{}, {}: {counts}", built.model, built.operator)
}

fn built_table(built: &[Built]) -> Table {
    let titles = [
        "model",
        "operator",
        "vertices",
        "triangles",
        "base",
        "merges",
        "nodes",
        "branching",
        "links",
        "stall",
        "bytes a vertex",
        "explicit bytes",
        "analysis s",
        "replay s",
    ];
    let row = |b: &Built| {
        vec![
            b.model.clone(),
            b.operator.clone(),
            b.vertices_in.to_string(),
            b.triangles_in.to_string(),
            b.triangles_base.to_string(),
            b.merges.to_string(),
            b.modifications.to_string(),
            format!("{:.2}", 1.0 + f64::from(b.modifications) / f64::from(b.merges.max(1))),
            b.links.to_string(),
            b.stall.map_or("-".into(), |share| format!("{:.1} %", share * 100.0)),
            format!("{:.1}", b.bytes_per_vertex),
            format!("{:.0}", b.explicit_bytes_per_vertex),
            format!("{:.3}", b.seconds),
            format!("{:.3}", b.seconds_replay),
        ]
    };
    Table { caption: String::new(), columns: columns(&titles, 2), rows: built.iter().map(row).collect() }
}

fn bytes_table(built: &[Built]) -> Table {
    let arrays: Vec<&str> = built.first().map_or(Vec::new(), |b| b.bytes_of.iter().map(|(name, _)| *name).collect());
    let titles: Vec<&str> = ["model", "operator"].into_iter().chain(arrays).chain(["in all"]).collect();
    let row = |b: &Built| {
        let mut row = vec![b.model.clone(), b.operator.clone()];
        row.extend(b.bytes_of.iter().map(|(_, bytes)| format!("{bytes:.2}")));
        row.push(format!("{:.2}", b.bytes_per_vertex));
        row
    };
    Table { caption: String::new(), columns: columns(&titles, 2), rows: built.iter().map(row).collect() }
}

fn ordered_table(ordered: &[Ordered]) -> Table {
    let titles = [
        "model",
        "operator",
        "dependency",
        "kind",
        "arcs",
        "beyond the forest",
        "depth",
        "bytes a vertex",
        "derived in s",
        "ns a bare step",
    ];
    let row = |o: &Ordered| {
        vec![
            o.model.clone(),
            o.operator.clone(),
            o.dependency.to_owned(),
            if o.is_static { "static" } else { "dynamic" }.to_owned(),
            o.arcs.to_string(),
            o.beyond_forest.map_or("-".into(), |needs| needs.to_string()),
            o.depth.to_string(),
            format!("{:.1}", o.bytes_per_vertex),
            format!("{:.3}", o.seconds),
            format!("{:.0}", o.nanoseconds_a_step),
        ]
    };
    Table { caption: String::new(), columns: columns(&titles, 4), rows: ordered.iter().map(row).collect() }
}

fn degree_plot(results: &Results, model: &str) -> Lines {
    let mut series: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for d in results.degrees.iter().filter(|d| d.model == model) {
        let share = d.share * 100.0;
        series.entry(d.operator.clone()).or_default().push([share, d.maximum as f64]);
        series.entry(format!("{}, mean", d.operator)).or_default().push([share, d.mean]);
    }
    Lines {
        title: String::new(),
        x: Axis::logarithmic("vertices left, %"),
        y: Axis::logarithmic("triangles at a vertex"),
        series: series.into_iter().map(|(name, points)| Series { name, points }).collect(),
    }
}

fn quality_table(results: &Results) -> Table {
    let titles = ["model", "operator", "share", "triangles", "RMS", "maximum", "stated"];
    let row = |q: &super::Quality| {
        vec![
            q.model.clone(),
            q.operator.clone(),
            format!("{} %", q.share * 100.0),
            q.triangles.to_string(),
            format!("{:.2e}", q.rms),
            format!("{:.2e}", q.max),
            format!("{:.2e}", q.stated),
        ]
    };
    Table { caption: String::new(), columns: columns(&titles, 2), rows: results.qualities.iter().map(row).collect() }
}

fn quality_plot(results: &Results, model: &str) -> Lines {
    let mut series: BTreeMap<&str, Vec<[f64; 2]>> = BTreeMap::new();
    for q in results.qualities.iter().filter(|q| q.model == model) {
        series.entry(&q.operator).or_default().push([f64::from(q.triangles), q.rms]);
    }
    Lines {
        title: String::new(),
        x: Axis::logarithmic("triangles"),
        y: Axis::logarithmic("RMS distance / diagonal"),
        series: series.into_iter().map(|(name, points)| Series { name: name.to_owned(), points }).collect(),
    }
}

fn time_plot(results: &Results, model: &str) -> Lines {
    let dependency = shown_dependency(results);
    let chosen = |o: &&Observation| o.model == model && o.criterion == "screen" && o.dependency == dependency;
    per_frame(results, chosen, |o| format!("{}, {}", o.strategy, o.operator), |o| o.seconds * 1e3, Axis::linear("ms"))
}

fn per_frame(
    results: &Results,
    chosen: impl Fn(&&Observation) -> bool,
    name: impl Fn(&Observation) -> String,
    value: impl Fn(&Observation) -> f64,
    y: Axis,
) -> Lines {
    let mut series: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for o in results.observations.iter().filter(chosen) {
        series.entry(name(o)).or_default().push([f64::from(o.frame), value(o)]);
    }
    Lines {
        title: String::new(),
        x: Axis::linear("frame"),
        y,
        series: series.into_iter().map(|(name, points)| Series { name, points }).collect(),
    }
}
