//! The report: one page with tables, plots and pictures, for somebody who was not there.

use super::results::{Built, Observation, Results};
use crate::html::{Align, Page, Table};
use crate::plot::{Axis, Lines, Series};
use std::collections::BTreeMap;

/// The page, with everything in it.
pub fn page(results: &Results) -> String {
    let mut page = Page::new("Study of Multi-Tessellations");
    page.paragraph(&format!("Made by mtess {}.", env!("CARGO_PKG_VERSION")));
    page.paragraph(&format!(
        "Each model was coarsened to the end by each operator and every step was kept. A camera then went once around it \
         in {} frames, from afar to close by and back, and each criterion was answered by each strategy: from the base \
         mesh (top-down, priority) or from the mesh of the last frame (incremental). All numbers are in results.csv, one \
         observation a row. Times are wall seconds of one run on one machine; compare them within this page.",
        results.frames
    ));
    page.list([
        "uniform: the same error everywhere, from 2 % of the diagonal down to 0.01 % along the path".to_owned(),
        "region: 0.02 % of the diagonal within a box that travels through the model, anything outside".to_owned(),
        format!("screen: {} px of error on the screen, coarse outside the frustum", results.error_px),
        "budget: the least error on the screen that a tenth of the input's triangles allow".to_owned(),
    ]);
    page.heading(2, "Models");
    page.table(&built_table(&results.built));
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
    page.heading(2, "Along the path");
    page.paragraph(
        "Means over the frames, under the explicit order. \"Forced\" are modifications that the criterion did not ask for, but that others need. \
         Minimality makes the sizes of all strategies equal where no budget is set; what differs is the work.",
    );
    page.table(&frames_table(&results.observations));
    for model in names(results) {
        page.heading(3, model);
        page.figure_svg(&triangles_plot(results, model).svg(), "Triangles of each frame, by criterion (incremental).");
        page.figure_svg(
            &time_plot(results, model).svg(),
            "Milliseconds of each frame for the screen criterion, by strategy.",
        );
        let pictures = results.pictures.iter().filter(|p| p.name.starts_with(&format!("{model}-")));
        page.gallery_png(pictures.map(|p| (p.png.as_slice(), p.caption.as_str())));
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

fn names(results: &Results) -> Vec<&str> {
    let mut names: Vec<&str> = results.built.iter().map(|b| b.model.as_str()).collect();
    names.dedup();
    names
}

fn columns(titles: &[&str], texts: usize) -> Vec<(String, Align)> {
    let align = |i| if i < texts { Align::Text } else { Align::Number };
    titles.iter().enumerate().map(|(i, title)| ((*title).to_owned(), align(i))).collect()
}

fn built_table(built: &[Built]) -> Table {
    let titles = [
        "model",
        "operator",
        "refused plans",
        "vertices",
        "triangles",
        "base",
        "modifications",
        "arcs each",
        "depth",
        "bytes a vertex",
        "seconds",
    ];
    let row = |b: &Built| {
        let refusals: Vec<_> = b.refusals.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
        vec![
            b.model.clone(),
            b.operator.clone(),
            if refusals.is_empty() { "none".into() } else { refusals.join(", ") },
            b.vertices_in.to_string(),
            b.triangles_in.to_string(),
            b.triangles_base.to_string(),
            b.modifications.to_string(),
            format!("{:.2}", b.arcs as f64 / f64::from(b.modifications.max(1))),
            b.depth.to_string(),
            format!("{:.0}", b.bytes_per_vertex),
            format!("{:.3}", b.seconds),
        ]
    };
    Table { caption: String::new(), columns: columns(&titles, 3), rows: built.iter().map(row).collect() }
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

fn frames_table(observations: &[Observation]) -> Table {
    let titles =
        ["model", "operator", "criterion", "strategy", "triangles", "vertices", "refined", "coarsened", "forced", "ms"];
    type Key<'a> = (&'a str, &'a str, &'a str, &'a str, &'a str);
    // Observations of one combination follow each other.
    let mut groups: Vec<(Key<'_>, Vec<&Observation>)> = Vec::new();
    for o in observations {
        let key: Key<'_> = (&o.model, &o.operator, o.dependency, o.criterion, o.strategy);
        match groups.last_mut().filter(|(last, _)| *last == key) {
            Some((_, group)) => group.push(o),
            None => groups.push((key, vec![o])),
        }
    }
    let row = |((model, operator, _, criterion, strategy), group): (Key<'_>, Vec<&Observation>)| {
        let mean = |value: fn(&Observation) -> f64| group.iter().map(|o| value(o)).sum::<f64>() / group.len() as f64;
        let mut row: Vec<String> = [model, operator, criterion, strategy].map(str::to_owned).to_vec();
        row.push(format!("{:.0}", mean(|o| f64::from(o.triangles))));
        row.push(format!("{:.0}", mean(|o| o.vertices as f64)));
        row.push(format!("{:.0}", mean(|o| f64::from(o.refined))));
        row.push(format!("{:.0}", mean(|o| f64::from(o.coarsened))));
        row.push(format!("{:.0}", mean(|o| f64::from(o.forced))));
        row.push(format!("{:.2}", mean(|o| o.seconds * 1e3)));
        row
    };
    Table { caption: String::new(), columns: columns(&titles, 4), rows: groups.into_iter().map(row).collect() }
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

fn triangles_plot(results: &Results, model: &str) -> Lines {
    let chosen = |o: &&Observation| o.model == model && o.strategy == "incremental";
    per_frame(
        results,
        chosen,
        |o| format!("{}, {}", o.criterion, o.operator),
        |o| f64::from(o.triangles),
        Axis::logarithmic("triangles"),
    )
}

fn time_plot(results: &Results, model: &str) -> Lines {
    let chosen = |o: &&Observation| o.model == model && o.criterion == "screen";
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
