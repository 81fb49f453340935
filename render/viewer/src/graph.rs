//! The last frames as a graph: what adapting took, steps to finer and coarser, triangles.

use crate::viewer::{FRAMES_KEPT, Record, Viewer};
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, vec2};

const ADAPT: Color32 = Color32::from_rgb(232, 150, 60);
const FINER: Color32 = Color32::from_rgb(96, 168, 232);
const COARSER: Color32 = Color32::from_rgb(120, 190, 120);
const TRIANGLES: Color32 = Color32::from_rgb(200, 120, 200);
const HEIGHT: f32 = 84.0;

/// One curve: name, colour, its value of a frame, and how a value is written.
struct Curve {
    name: &'static str,
    colour: Color32,
    value: fn(&Record) -> f64,
    written: fn(f64) -> String,
}

const CURVES: [Curve; 4] = [
    Curve {
        name: "adapt",
        colour: ADAPT,
        value: |record| record.panes.iter().map(|pane| pane.adapt.as_secs_f64()).fold(0.0, f64::max) * 1e3,
        written: |value| format!("{value:.2} ms"),
    },
    Curve {
        name: "finer",
        colour: FINER,
        value: |record| record.panes.iter().map(|pane| f64::from(pane.outcome.refined)).sum(),
        written: |value| format!("{value:.0} steps"),
    },
    Curve {
        name: "coarser",
        colour: COARSER,
        value: |record| record.panes.iter().map(|pane| f64::from(pane.outcome.coarsened)).sum(),
        written: |value| format!("{value:.0} steps"),
    },
    Curve {
        name: "triangles",
        colour: TRIANGLES,
        value: |record| record.panes.iter().map(|pane| f64::from(pane.triangles)).sum(),
        written: |value| format!("{value:.0}"),
    },
];

/// Draws the graph in what is left of the width.
pub fn show(ui: &mut Ui, viewer: &Viewer) {
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let painter = ui.painter_at(area);
    painter.rect_filled(area, 3.0, ui.visuals().extreme_bg_color);
    let last = viewer.records.back().copied().unwrap_or_default();
    let width = area.width() / CURVES.len() as f32;
    for (i, curve) in CURVES.iter().enumerate() {
        let corner = area.left_top() + vec2(width * i as f32, 0.0);
        let part = Rect::from_min_size(corner, vec2(width, HEIGHT)).shrink(6.0);
        let all = if viewer.panes.len() == 2 && curve.name != "adapt" { ", both" } else { "" };
        let most = viewer.records.iter().map(curve.value).fold(0.0, f64::max);
        bars(&painter, part, viewer, curve, most);
        let text =
            format!("{}{all}  {}  (most {})", curve.name, (curve.written)((curve.value)(&last)), (curve.written)(most));
        painter.text(part.left_top(), Align2::LEFT_TOP, text, FontId::proportional(11.0), curve.colour);
    }
}

fn bars(painter: &Painter, part: Rect, viewer: &Viewer, curve: &Curve, most: f64) {
    if most <= 0.0 {
        return;
    }
    let step = part.width() / FRAMES_KEPT as f32;
    let room = part.height() - 16.0;
    for (i, record) in viewer.records.iter().enumerate() {
        let height = (curve.value)(record) / most * f64::from(room);
        let x = part.right() - step * (viewer.records.len() - i) as f32;
        let foot = Pos2::new(x, part.bottom());
        painter.line_segment([foot, foot - vec2(0.0, height as f32)], Stroke::new(step.max(1.0), curve.colour));
    }
}
