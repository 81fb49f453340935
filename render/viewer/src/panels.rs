//! The panels: what is chosen, what is asked, what is shown, time, and what was pointed at.

use crate::any_view::{NodeFacts, Picked};
use crate::ask::Ask;
use crate::keys::{Action, BINDINGS, HELD, written};
use crate::pane::Choice;
use crate::pilot::Flight;
use crate::viewer::{Viewer, operators};
use eframe::egui::{Align2, ComboBox, Grid, Response, ScrollArea, Slider, SliderClamping, Ui, Window};
use mt_core::NodeId;
use papers::study::{CriterionKind, DependencyKind, StrategyKind};
use render::Tint;

/// The panel of controls; what was pressed is done by the caller, who has files and window.
pub fn controls(ui: &mut Ui, viewer: &mut Viewer) -> Vec<Action> {
    let mut pressed = Vec::new();
    ScrollArea::vertical().show(ui, |ui| {
        choice(ui, viewer, &mut pressed);
        ui.separator();
        question(ui, viewer);
        ui.separator();
        camera(ui, viewer, &mut pressed);
        ui.separator();
        shown(ui, viewer);
        ui.separator();
        time(ui, viewer, &mut pressed);
        ui.separator();
        if let Some(picked) = &viewer.panes[viewer.active].picked {
            told(ui, picked);
        } else {
            ui.weak("Click a triangle, or press I, to see what made it.");
        }
        if !viewer.message.is_empty() {
            ui.separator();
            ui.label(&viewer.message);
        }
        ui.separator();
        button(ui, "Keys (H or ?)", Action::Help, &mut pressed);
    });
    pressed
}

fn button(ui: &mut Ui, text: &str, action: Action, pressed: &mut Vec<Action>) -> Response {
    let key = BINDINGS.iter().find(|binding| binding.action == action);
    let response = ui.button(text);
    if response.clicked() {
        pressed.push(action);
    }
    match key {
        Some(binding) => response.on_hover_text(format!("{} ({})", binding.told, written(binding))),
        None => response,
    }
}

/// A list to choose from; what was chosen, if anything was.
fn list<T: PartialEq + Clone>(ui: &mut Ui, label: &str, all: &[T], at: &T, name: impl Fn(&T) -> String) -> Option<T> {
    let mut chosen = at.clone();
    ui.horizontal(|ui| {
        ui.label(label);
        ComboBox::from_id_salt(label).width(150.0).selected_text(name(at)).show_ui(ui, |ui| {
            all.iter().for_each(|one| _ = ui.selectable_value(&mut chosen, one.clone(), name(one)));
        });
    });
    (chosen != *at).then_some(chosen)
}

fn choice(ui: &mut Ui, viewer: &mut Viewer, pressed: &mut Vec<Action>) {
    let pane = &viewer.panes[viewer.active];
    let subject = viewer.subject(pane);
    ui.strong(&subject.name);
    let (made_by, chosen) = (subject.made_by.clone(), pane.chosen().clone());
    ui.weak(format!("{} triangles, pane {} of {}", subject.extent.cells, viewer.active + 1, viewer.panes.len()));
    let as_it_came = |operator: &Option<String>| operator.clone().unwrap_or_else(|| format!("{made_by} (as it came)"));
    let operators = operators();
    if let Some(operator) = list(ui, "operator", &operators, &chosen.operator, as_it_came) {
        viewer.choose(viewer.active, Choice { operator, ..chosen.clone() });
    }
    let schemes: Vec<DependencyKind> = DependencyKind::all().collect();
    if let Some(dependency) = list(ui, "scheme", &schemes, &chosen.dependency, |scheme| scheme.name().to_owned()) {
        viewer.choose(viewer.active, Choice { dependency, ..chosen });
    }
    if let Some(since) = viewer.panes[viewer.active].waits() {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("being made, {:.0} s", since.as_secs_f32()));
        });
    }
    ui.horizontal(|ui| {
        let two = viewer.panes.len() == 2;
        button(ui, if two { "One pane" } else { "Two panes" }, Action::Split, pressed);
        if two {
            button(ui, "Other pane", Action::OtherPane, pressed);
        }
    });
}

fn question(ui: &mut Ui, viewer: &mut Viewer) {
    let cells = viewer.subjects.iter().map(|subject| subject.extent.cells).max().unwrap_or(1).max(2);
    let ask = &mut viewer.ask;
    if let Some(criterion) = list(ui, "criterion", CriterionKind::ALL, &ask.criterion, |kind| kind.name().to_owned()) {
        ask.criterion = criterion;
    }
    if let Some(strategy) = list(ui, "strategy", StrategyKind::ALL, &ask.strategy, |kind| kind.name().to_owned()) {
        ask.strategy = strategy;
    }
    ui.spacing_mut().slider_width = 130.0;
    // What came from a key or an option is left as it is.
    let slider = |value, range| Slider::new(value, range).logarithmic(true).clamping(SliderClamping::Edits);
    if ask.criterion == CriterionKind::Budget {
        ui.add(Slider::new(&mut ask.cells, 1..=cells).logarithmic(true).text("triangles"));
    } else if ask.is_spatial() {
        ui.add(slider(&mut ask.error_share, Ask::SHARES).text("of diagonal"));
        if ask.criterion == CriterionKind::Region {
            ui.add(slider(&mut ask.region_share, 1e-3..=1.0).text("half side"));
        }
    } else {
        ui.add(slider(&mut ask.error_px, Ask::PIXELS).text("pixels"));
    }
}

fn camera(ui: &mut Ui, viewer: &mut Viewer, pressed: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let flies = viewer.pilot.flight == Flight::Fly;
        button(ui, if flies { "Orbit" } else { "Fly" }, Action::Flight, pressed);
        button(ui, "See all", Action::Fit, pressed);
        let frozen = viewer.frozen.is_some();
        button(ui, if frozen { "Come back" } else { "Freeze" }, Action::Freeze, pressed);
    });
    ui.horizontal(|ui| {
        let label = if viewer.is_recording { "Stop" } else { "Record" };
        button(ui, label, Action::Record, pressed);
        let label = if viewer.following.is_some() { "Stop following" } else { "Follow" };
        button(ui, label, Action::Follow, pressed);
        button(ui, "Save path", Action::SavePath, pressed);
    });
    if !viewer.path.is_empty() {
        let at = viewer.following.map_or(String::new(), |at| format!("{at} of "));
        ui.weak(format!("path: {at}{} cameras", viewer.path.len()));
    }
}

fn shown(ui: &mut Ui, viewer: &mut Viewer) {
    let shown = &mut viewer.shown;
    if let Some(tint) = list(ui, "colours", &Tint::ALL, &shown.tint, |tint| tint.name().to_owned()) {
        shown.tint = tint;
    }
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut shown.wire, "edges");
        ui.checkbox(&mut shown.edges, "boundary, cracks");
        ui.checkbox(&mut shown.outline, "outline");
        ui.checkbox(&mut shown.pieces, "dual pieces");
    });
}

fn time(ui: &mut Ui, viewer: &mut Viewer, pressed: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        button(ui, "|<", Action::FrameBack, pressed);
        button(ui, "<", Action::StepBack, pressed);
        button(ui, ">", Action::StepForward, pressed);
        button(ui, ">|", Action::FrameForward, pressed);
        button(ui, if viewer.is_log_played { "Pause" } else { "Play" }, Action::PlayLog, pressed);
        button(ui, "Now", Action::Now, pressed);
    });
    let pane = &mut viewer.panes[viewer.active];
    let (mut at, count) = (pane.view.at(), pane.view.log().steps.len());
    let slider = Slider::new(&mut at, 0..=count).text(format!("of {count} steps"));
    if ui.add(slider).changed() {
        pane.seek(at);
    }
    let past = if pane.is_held { "held in time; Now (Enter) goes on" } else { "in the present" };
    ui.weak(past);
    ui.horizontal(|ui| {
        button(ui, "Save picture", Action::SavePicture, pressed);
        button(ui, "Window", Action::SaveWindow, pressed);
        button(ui, "Log", Action::SaveLog, pressed);
    });
}

fn told(ui: &mut Ui, picked: &Picked) {
    ui.strong(format!("triangle {}, vertex {}", picked.placed.cell, picked.corner));
    let [x, y, z] = picked.position.to_array();
    ui.weak(format!("at {x:.4}, {y:.4}, {z:.4}"));
    Grid::new("picked").num_columns(2).show(ui, |ui| {
        node(ui, "came with", picked.came_with.as_ref(), "the base mesh");
        ui.label("needed for it");
        let names = written_nodes(picked.ancestors.iter().copied(), picked.ancestor_count);
        ui.label(format!("{} nodes, the longest chain {}\n{names}", picked.ancestor_count, picked.level));
        ui.end_row();
        node(ui, "refined by", picked.refined_by.as_ref(), "nothing: it is the input's");
    });
    if picked.chain_length > 0 {
        let length = picked.chain_length;
        ui.label(format!("forced chain of {length} (yellow: {} triangles)", picked.replaced.len()));
        ui.weak(written_nodes(picked.chain.iter().rev().map(|facts| facts.node), length));
    }
}

/// The first nodes of so many, by their numbers.
fn written_nodes(nodes: impl Iterator<Item = NodeId>, count: usize) -> String {
    let names: Vec<String> = nodes.take(6).map(|node| node.to_string()).collect();
    let more = if count > names.len() { ", .." } else { "" };
    format!("{}{more}", names.join(", "))
}

fn node(ui: &mut Ui, label: &str, facts: Option<&NodeFacts>, none: &str) {
    ui.label(label);
    match facts {
        None => _ = ui.label(none),
        Some(NodeFacts { node, bound, gain }) => {
            let gain = gain.map_or(String::new(), |gain| format!(", {gain:+} triangles"));
            ui.label(format!("node {node}{gain}\nerror {:.3e}, sphere {:.3e}", bound.error, bound.radius));
        }
    }
    ui.end_row();
}

/// The keys, as a window of its own.
pub fn help(ui: &mut Ui, viewer: &mut Viewer) {
    let mut open = viewer.is_help_shown;
    let bound = BINDINGS.iter().map(|binding| (written(binding), binding.told.to_owned()));
    let held = HELD.iter().map(|(keys, told)| ((*keys).to_owned(), (*told).to_owned()));
    let all: Vec<(String, String)> = held.chain(bound).collect();
    let window = Window::new("Keys").open(&mut open).anchor(Align2::CENTER_CENTER, [0.0, 0.0]).auto_sized();
    let height = ui.ctx().content_rect().height() - 90.0;
    window.show(ui.ctx(), |ui| {
        ScrollArea::vertical().max_height(height).show(ui, |ui| {
            Grid::new("keys").num_columns(4).striped(true).show(ui, |ui| {
                let half = all.len().div_ceil(2);
                for row in 0..half {
                    for (keys, told) in [all.get(row), all.get(half + row)].into_iter().flatten() {
                        ui.monospace(keys);
                        ui.label(told);
                    }
                    ui.end_row();
                }
            });
        });
    });
    viewer.is_help_shown = open;
}
