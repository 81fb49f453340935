//! Rows as Markdown, as CSV, and as a page with plots against size.

use super::row::Row;
use crate::html::{Align, Page, Table};
use crate::plot::{Axis, Lines, Series};

/// A column: its heading, and what a row has there, if anything, with so many digits behind the point.
struct Column {
    heading: &'static str,
    digits: usize,
    value: Value,
}

/// What there is of a figure in a row.
type Value = fn(&Row) -> Option<f64>;

const fn column(heading: &'static str, digits: usize, value: Value) -> Column {
    Column { heading, digits, value }
}

/// Of the distances at this share of the triangles, in hundred-thousandths of the diagonal.
fn at(row: &Row, share: f64, of: fn(&super::Quality) -> f64) -> Option<f64> {
    row.quality.iter().find(|quality| quality.share == share).map(|quality| of(quality) * 1e5)
}

const COLUMNS: [Column; 27] = [
    column("base triangles", 0, |row| Some(row.base as f64)),
    column("build, wall s", 3, |row| Some(row.built.wall_s)),
    column("build, CPU s", 3, |row| Some(row.built.cpu_s)),
    column("1000 triangles removed a CPU s", 0, |row| Some(row.rate())),
    column("peak MB", 0, |row| row.built.peak_bytes.map(|bytes| bytes as f64 / 1e6)),
    column("peak bytes a triangle", 0, Row::peak_per_triangle),
    column("bytes a vertex", 1, |row| Some(row.bytes_per_vertex())),
    column("file MB", 2, |row| Some(row.built.file_bytes as f64 / 1e6)),
    column("write, s", 3, |row| Some(row.built.write_s)),
    column("load, s", 3, |row| Some(row.built.load_s)),
    column("RMS at 50 %, 1e-5 of the diagonal", 2, |row| at(row, 0.5, |q| q.rms)),
    column("RMS at 10 %, 1e-5 of the diagonal", 2, |row| at(row, 0.1, |q| q.rms)),
    column("RMS at 1 %, 1e-5 of the diagonal", 1, |row| at(row, 0.01, |q| q.rms)),
    column("max at 50 %, 1e-5 of the diagonal", 1, |row| at(row, 0.5, |q| q.maximum)),
    column("max at 10 %, 1e-5 of the diagonal", 1, |row| at(row, 0.1, |q| q.maximum)),
    column("max at 1 %, 1e-5 of the diagonal", 0, |row| at(row, 0.01, |q| q.maximum)),
    column("million refine steps a s", 2, |row| row.steps.as_ref().map(|steps| steps.refine_per_s / 1e6)),
    column("million coarsen steps a s", 2, |row| row.steps.as_ref().map(|steps| steps.coarsen_per_s / 1e6)),
    column("ns a step", 0, |row| row.steps.as_ref().map(|steps| steps.ns)),
    column("ns a step with cells", 0, |row| row.steps.as_ref().map(|steps| steps.ns_with_cells)),
    column("frame, median ms", 3, |row| row.frames.as_ref().map(|frames| frames.median_ms)),
    column("frame, 95 % ms", 3, |row| row.frames.as_ref().map(|frames| frames.p95_ms)),
    column("steps a frame", 0, |row| row.frames.as_ref().map(|frames| frames.steps)),
    column("triangles a frame", 0, |row| row.frames.as_ref().map(|frames| frames.triangles)),
    column("two views at once, times faster", 2, |row| row.frames.as_ref().map(|frames| frames.two_views)),
    column("1 % changed, us", 0, |row| row.frames.as_ref().and_then(|frames| frames.small_change_us)),
    column("front of that, nodes", 0, |row| row.frames.as_ref().map(|frames| f64::from(frames.small_change_front))),
];

/// Rows that measure the same thing, in the order in which they first came.
fn again(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        match groups.iter_mut().find(|group| group[0].is_again(row)) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups
}

/// The middle of several runs, and where they differ how far the others are from it: `0.31 (0.29 to 0.35)`.
fn cell(column: &Column, runs: &[&Row]) -> String {
    let mut values: Vec<f64> = runs.iter().filter_map(|row| (column.value)(row)).collect();
    values.sort_by(f64::total_cmp);
    let text = |value: f64| format!("{value:.*}", column.digits);
    match values.as_slice() {
        [] => String::new(),
        [least, .., most] if text(*least) != text(*most) => {
            format!("{} ({} to {})", text(values[values.len() / 2]), text(*least), text(*most))
        }
        all => text(all[all.len() / 2]),
    }
}

fn names(row: &Row) -> [String; 5] {
    let threads = match row.built.threads {
        0 => "all cores".to_owned(),
        1 => "1 thread".to_owned(),
        threads => format!("{threads} threads"),
    };
    let by = match row.built.region_vertices {
        0 => "whole".to_owned(),
        vertices => format!("regions of {vertices}, {threads}"),
    };
    [row.model.clone(), row.triangles.to_string(), row.operator.clone(), row.dependency.clone(), by]
}

const NAMES: [&str; 5] = ["model", "triangles", "operator", "kept as", "coarsened by"];

/// All figures as Markdown tables: one row per operator, model and form, the columns in four tables. Several runs are told
/// as their middle and their ends.
pub fn markdown(rows: &[Row]) -> String {
    let groups = again(rows);
    let shown = |columns: &[Column]| {
        let used: Vec<&Column> =
            columns.iter().filter(|column| rows.iter().any(|row| (column.value)(row).is_some())).collect();
        if used.is_empty() {
            return String::new();
        }
        let headings = NAMES.into_iter().chain(used.iter().map(|column| column.heading)).collect::<Vec<_>>();
        let mut text = format!("| {} |\n|{}\n", headings.join(" | "), " --- |".repeat(headings.len()));
        for runs in &groups {
            let cells: Vec<String> =
                names(runs[0]).into_iter().chain(used.iter().map(|column| cell(column, runs))).collect();
            text.push_str(&format!("| {} |\n", cells.join(" | ")));
        }
        text
    };
    let parts = [&COLUMNS[..10], &COLUMNS[10..16], &COLUMNS[16..20], &COLUMNS[20..]];
    parts.map(shown).into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

/// Every run as a row of CSV, with a header.
pub fn csv(rows: &[Row]) -> String {
    let headings = ["run", "vertices"].into_iter().chain(NAMES).chain(COLUMNS.iter().map(|column| column.heading));
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = headings.map(quoted).collect::<Vec<_>>().join(",") + "\n";
    for (i, row) in rows.iter().enumerate() {
        let run = rows[..i].iter().filter(|other| other.is_again(row)).count() + 1;
        text += &format!("{run},{},", row.vertices);
        let values = COLUMNS.iter().map(|column| (column.value)(row).map_or(String::new(), |value| value.to_string()));
        text += &names(row).iter().map(|name| quoted(name)).chain(values).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

/// What is plotted against the number of triangles.
const PLOTS: [(&str, &str, Value); 6] = [
    ("Building", "wall seconds", |row| Some(row.built.wall_s)),
    ("Peak memory of building", "bytes", |row| row.built.peak_bytes.map(|bytes| bytes as f64)),
    ("Loading", "wall seconds", |row| Some(row.built.load_s)),
    ("Bytes of the model", "bytes", |row| Some(row.built.bytes as f64)),
    ("A frame", "milliseconds, median", |row| row.frames.as_ref().map(|frames| frames.median_ms)),
    ("Adapting, a hundredth of the front changed", "microseconds", |row| {
        row.frames.as_ref().and_then(|frames| frames.small_change_us)
    }),
];

/// The report: what was measured on what, all figures, and where a model comes in several sizes plots against size.
pub fn page(rows: &[Row], machine: &str, notes: &[String]) -> String {
    let mut page = Page::new("Benchmark");
    page.paragraph(machine);
    page.paragraph(
        "A row is one operator on one model, kept as all cells or as a vertex hierarchy under a scheme, and measured in a \
         process of its own; of several runs the middle figure is told, each column by itself, and the least and the most \
         behind it. Building is coarsening and all that follows from it, up to a model that can be asked; the input is in \
         the peak of memory, and some ten megabytes of the program itself. Bytes a vertex are those in memory, of a \
         hierarchy without its input. Steps: everything refined and coarsened again, checks included, as nobody or as \
         somebody hears of the cells; a step of all cells of a fan-merge is a whole fan. Frames: once around the model, one \
         pixel of error, culled by frustum and back faces, refined incrementally; two views at once, against one after the \
         other. A hundredth changed: to and fro between two errors everywhere whose fronts of some twenty thousand nodes \
         differ in a hundredth of them, with the look at all of the front that this takes. Figures of small models are short \
         times on what may be a busy machine.",
    );
    if !notes.is_empty() {
        page.list(notes);
    }
    for (caption, columns) in [
        ("Building and keeping", &COLUMNS[..10]),
        ("Distance from the input", &COLUMNS[10..16]),
        ("Steps", &COLUMNS[16..20]),
        ("Frames", &COLUMNS[20..]),
    ] {
        page.table(&table(caption, columns, rows));
    }
    let series = lines_by_size(rows);
    if series.iter().any(|(_, sizes)| sizes.len() > 1) {
        page.heading(2, "Against size");
        for (title, unit, value) in PLOTS {
            let lines = Lines {
                title: title.into(),
                x: Axis::logarithmic("triangles of the input"),
                y: Axis::logarithmic(unit),
                series: series.iter().map(|(name, sizes)| line(name, sizes, value)).collect(),
            };
            page.figure_svg(&lines.svg(), title);
        }
    }
    page.finish()
}

fn table(caption: &str, columns: &[Column], rows: &[Row]) -> Table {
    let names_of = NAMES.iter().map(|name| ((*name).to_owned(), Align::Text));
    let headings = names_of.chain(columns.iter().map(|column| (column.heading.to_owned(), Align::Number)));
    let told = again(rows)
        .into_iter()
        .map(|runs| names(runs[0]).into_iter().chain(columns.iter().map(|column| cell(column, &runs))).collect());
    Table { caption: caption.into(), columns: headings.collect(), rows: told.collect() }
}

/// Runs of generated models that differ in size alone, by what they share.
fn lines_by_size(rows: &[Row]) -> Vec<(String, Vec<Vec<&Row>>)> {
    let mut lines: Vec<(String, Vec<Vec<&Row>>)> = Vec::new();
    for runs in again(rows) {
        let row = runs[0];
        let Some(shape) = &row.shape else { continue };
        let [.., by] = names(row);
        let name = format!("{shape}, {}, {}, {by}", row.operator, row.dependency);
        match lines.iter_mut().find(|(other, _)| *other == name) {
            Some((_, sizes)) => sizes.push(runs),
            None => lines.push((name, vec![runs])),
        }
    }
    lines.iter_mut().for_each(|(_, sizes)| sizes.sort_by_key(|runs| runs[0].triangles));
    lines
}

/// The middle run of each size.
fn line(name: &str, sizes: &[Vec<&Row>], value: Value) -> Series {
    let middle = |runs: &Vec<&Row>| {
        let mut values: Vec<f64> = runs.iter().filter_map(|row| value(row)).collect();
        values.sort_by(f64::total_cmp);
        Some([runs[0].triangles as f64, *values.get(values.len() / 2)?])
    };
    Series { name: name.into(), points: sizes.iter().filter_map(middle).collect() }
}

#[cfg(test)]
mod tests {
    use super::super::Built;
    use super::*;

    fn row(model: &str, triangles: usize, cpu_s: f64) -> Row {
        let built = Built { wall_s: cpu_s, cpu_s, bytes: 100 * triangles, ..Built::default() };
        let names = ["edge-collapse", "cells"].map(str::to_owned);
        let [operator, dependency] = names;
        let shape = model.split_once('-').map(|(shape, _)| shape.to_owned());
        Row {
            model: model.into(),
            shape,
            operator,
            dependency,
            vertices: triangles / 2,
            triangles,
            built,
            ..Row::default()
        }
    }

    #[test]
    fn runs_of_one_thing_are_one_row_with_its_spread() {
        let rows = [row("a-1000", 1000, 0.5), row("a-1000", 1000, 0.25), row("a-1000", 1000, 1.0), row("b", 10, 1.0)];
        let text = markdown(&rows);
        assert!(text.contains("| 0.500 (0.250 to 1.000) | 2 (1 to 4) |"), "{text}");
        assert_eq!(text.lines().filter(|line| line.starts_with("| a-1000")).count(), 1, "{text}");
        // Nothing was measured of steps and frames, so there is no table of them.
        assert!(!text.contains("a step") && !text.contains("frame"), "{text}");
        assert_eq!(csv(&rows).lines().count(), 1 + rows.len());
    }

    #[test]
    fn sizes_of_one_model_are_one_line() {
        let rows =
            [row("a-4000", 4000, 2.0), row("a-1000", 1000, 9.0), row("a-1000", 1000, 0.1), row("a-1000", 1000, 0.5)];
        let files = [row("scan1", 7, 1.0), row("scan2", 8, 1.0)];
        assert!(lines_by_size(&files).is_empty(), "files are no sizes of one thing");
        let lines = lines_by_size(&rows);
        assert_eq!(lines.len(), 1);
        assert_eq!(line("a", &lines[0].1, |row| Some(row.built.cpu_s)).points, [[1000.0, 0.5], [4000.0, 2.0]]);
        assert!(page(&rows, "here", &[]).contains("Against size"));
        assert!(!page(&rows[1..], "here", &[]).contains("Against size"), "three runs of one size");
    }
}
