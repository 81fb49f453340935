//! The window: input to actions, frames to textures, pictures to files.

use crate::keys::{Action, BINDINGS};
use crate::pane::Version;
use crate::pilot::Flight;
use crate::saved::{self, File, Save};
use crate::viewer::{Chore, Record, Viewer};
use crate::{graph, panels};
use eframe::egui::{
    self, Color32, FontId, Frame, Key, Panel, PointerButton, Pos2, Rect, Response, Sense, TextureId, Ui, vec2,
};
use eframe::egui_wgpu::RenderState;
use glam::{Vec2, Vec3};
use mt_core::Camera;
use render::{RenderError, Scene, Stage, Uploaded, wgpu};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Which of a stage's pictures is what the pane shows, and which the small one of the frozen eye.
const MAIN: usize = 0;
const INSET: usize = 1;
/// The small picture's share of the pane's height.
const INSET_SHARE: f32 = 0.28;

/// What outlives a window.
pub(crate) struct Held {
    pub(crate) viewer: Viewer,
    pub(crate) save: Save,
    pub(crate) is_to_close: fn() -> bool,
}

/// The device of a window, for whoever asks afterwards what became of it.
#[derive(Clone, Default)]
pub(crate) struct Watched {
    device: Rc<RefCell<Option<wgpu::Device>>>,
    told: Arc<AtomicBool>,
}

impl Watched {
    /// Whether there was one and it is lost.
    pub(crate) fn is_lost(&self) -> bool {
        // It tells of its loss when it is looked after; what else comes of that is no matter here.
        self.device.borrow().iter().for_each(|device| drop(device.poll(wgpu::PollType::Poll)));
        self.told.load(Ordering::Relaxed)
    }

    fn watch(&self, device: &wgpu::Device, wake: egui::Context) {
        let told = Arc::clone(&self.told);
        device.set_device_lost_callback(move |_, _| {
            told.store(true, Ordering::Relaxed);
            wake.request_repaint();
        });
        // What the window itself asks for in vain, such as a surface that is too large, ends it too: there is no drawing on.
        let told = Arc::clone(&self.told);
        device.on_uncaptured_error(Arc::new(move |_: wgpu::Error| told.store(true, Ordering::Relaxed)));
        *self.device.borrow_mut() = Some(device.clone());
    }
}

/// A pane on the device.
struct Screen {
    stage: Stage,
    /// The view whose triangles are there.
    view: Option<u64>,
    /// The mesh whose dual pieces are there.
    pieces: Option<Version>,
    /// The textures that the window knows.
    shown: [Option<(wgpu::Texture, TextureId)>; 2],
}

impl Screen {
    fn new(stage: Stage) -> Self {
        Self { stage, view: None, pieces: None, shown: [None, None] }
    }
}

/// A picture of the window, and the model that it is of.
type Shot = (usize, Arc<egui::ColorImage>);

/// A viewer in a window.
pub(crate) struct App {
    held: Rc<RefCell<Held>>,
    state: RenderState,
    screens: Vec<Screen>,
    watched: Watched,
    /// Pictures of the window, as they come.
    shots: (Sender<Shot>, Receiver<Shot>),
    last: Instant,
    /// Whether the frame before asked for this one.
    was_moving: bool,
    /// Frames until the device is destroyed, to see what comes of it.
    destroy_after: Option<u32>,
}

impl App {
    /// In a window that is there.
    pub(crate) fn new(
        context: &eframe::CreationContext<'_>,
        held: Rc<RefCell<Held>>,
        watched: Watched,
        destroy_after: Option<u32>,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let state = context.wgpu_render_state.clone().ok_or("the window has no device to draw with")?;
        let stage = Stage::on(&state.adapter, state.device.clone(), state.queue.clone())?;
        watched.watch(&state.device, context.egui_ctx.clone());
        Ok(Self {
            held,
            state,
            screens: vec![Screen::new(stage)],
            watched,
            shots: channel(),
            last: Instant::now(),
            was_moving: false,
            destroy_after,
        })
    }

    /// As many screens as panes.
    fn set_screens(&mut self, count: usize) {
        while self.screens.len() < count {
            let stage = self.screens[0].stage.beside();
            self.screens.push(Screen::new(stage));
        }
        while self.screens.len() > count {
            let Some(screen) = self.screens.pop() else { break };
            let mut renderer = self.state.renderer.write();
            screen.shown.iter().flatten().for_each(|(_, id)| renderer.free_texture(id));
        }
    }

    /// All panes, side by side: what was asked for, then the frame, then what is to be written of it.
    fn panes(&mut self, ui: &mut Ui, mut actions: Vec<Action>) {
        let held = Rc::clone(&self.held);
        let mut held = held.borrow_mut();
        let Held { viewer, save, .. } = &mut *held;
        let all = ui.available_rect_before_wrap();
        let scale = ui.ctx().pixels_per_point();
        let size_of = |count: usize| {
            [all.width() / count as f32, all.height()].map(|side| ((side * scale).round() as u32).clamp(1, 8192))
        };
        actions.extend(keyed(ui));
        let is_moved = hold(ui, viewer);
        let chores: Vec<Chore> = actions
            .into_iter()
            .filter_map(|action| {
                let size = size_of(viewer.panes.len());
                viewer.act(action, size)
            })
            .collect();
        let count = viewer.panes.len();
        let size = size_of(count);
        let width = all.width() / count as f32;
        let areas: Vec<Rect> = (0..count)
            .map(|pane| Rect::from_min_size(all.left_top() + vec2(width * pane as f32, 0.0), vec2(width, all.height())))
            .collect();
        for (pane, area) in areas.iter().enumerate() {
            let response = ui.allocate_rect(*area, Sense::click_and_drag());
            steer(ui, viewer, &response, pane, *area, size);
        }
        viewer.frame(size);
        self.set_screens(count);
        let mut bytes = 0;
        for (pane, area) in areas.iter().enumerate() {
            match self.show(ui, viewer, pane, *area, size) {
                Ok(sent) => bytes += sent.bytes,
                Err(error) => viewer.message = error.to_string(),
            }
            caption(ui, viewer, pane, *area);
        }
        for chore in chores {
            self.write(ui, viewer, save, chore, size);
        }
        self.remember(viewer, bytes);
        self.was_moving = is_moved || viewer.is_moving();
        if self.was_moving {
            ui.ctx().request_repaint();
        }
    }

    /// Draws a pane into a texture and shows it.
    fn show(
        &mut self,
        ui: &Ui,
        viewer: &mut Viewer,
        pane: usize,
        area: Rect,
        size: [u32; 2],
    ) -> Result<Uploaded, RenderError> {
        let camera = viewer.camera(size);
        let scene = viewer.scene(pane, &camera);
        let screen = &mut self.screens[pane];
        let sent = send(screen, viewer, pane)?;
        let Screen { stage, shown, .. } = screen;
        let id = known(&self.state, stage.show(&scene, &camera, MAIN)?, &mut shown[MAIN]);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(id, area, whole, Color32::WHITE);
        if let Some((small, eye)) = inset(viewer, area, ui.ctx().pixels_per_point()) {
            // The same triangles as the frozen eye sees them, without lines that are for the eye outside.
            let plain = Scene { segments: Vec::new(), marks: Vec::new(), legend: None, ..scene };
            let id = known(&self.state, stage.show(&plain, &eye, INSET)?, &mut shown[INSET]);
            ui.painter().rect_filled(small.expand(2.0), 2.0, Color32::from_gray(60));
            ui.painter().image(id, small, whole, Color32::WHITE);
        }
        Ok(sent)
    }

    /// Writes what was asked for, and says what came of it.
    fn write(&mut self, ui: &Ui, viewer: &mut Viewer, save: &mut Save, chore: Chore, size: [u32; 2]) {
        let active = viewer.active;
        let pane = &viewer.panes[active];
        let model = pane.model;
        let written = match chore {
            Chore::Picture => self.picture(viewer, size).and_then(|files| save(model, "picture", &files)),
            Chore::Path if viewer.path.is_empty() => Err("there is no path: record one".into()),
            Chore::Path => {
                let text = serde_json::to_vec_pretty(&viewer.path).map_err(|error| error.to_string());
                text.and_then(|text| save(model, "path", &[("json", text)]))
            }
            Chore::Log if !pane.view.is_log_whole() => Err("the log is so long that its beginning is gone".into()),
            Chore::Log => {
                let mut text = Vec::new();
                let done = pane.view.log().write(&mut text).map_err(|error| error.to_string());
                done.and_then(|()| save(model, "log", &[("steps", text)]))
            }
            Chore::Window => {
                let tell = self.shots.0.clone();
                // Whoever closes the window meanwhile wants no picture.
                return ui.ctx().request_screenshot(move |image| drop(tell.send((model, image))));
            }
            Chore::Close => return ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close),
        };
        say(viewer, written);
        ui.ctx().request_repaint();
    }

    /// The picture of the pane in use, read back, and what goes with it.
    fn picture(&mut self, viewer: &mut Viewer, size: [u32; 2]) -> Result<Vec<File>, String> {
        let (active, camera) = (viewer.active, viewer.camera(size));
        let scene = viewer.scene(active, &camera);
        let picture = self.screens[active].stage.paint(&scene, &camera).map_err(|error| error.to_string())?;
        Ok(saved::picture(viewer, &viewer.panes[active], &camera, picture.to_png()))
    }

    /// Pictures of the window that have come.
    fn take_shots(&mut self) {
        while let Ok((model, image)) = self.shots.1.try_recv() {
            let [width, height] = image.size.map(|side| side as u32);
            let rgba = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
            let png = render::Picture { width, height, rgba }.to_png();
            let Held { viewer, save, .. } = &mut *self.held.borrow_mut();
            say(viewer, save(model, "window", &[("png", png)]));
        }
    }

    fn remember(&mut self, viewer: &mut Viewer, bytes: u64) {
        let now = Instant::now();
        let since = now - std::mem::replace(&mut self.last, now);
        // A window at rest draws when it is touched: nothing is to be learned from how long nobody did.
        let whole = if self.was_moving { since } else { Duration::ZERO };
        let mut record = Record { bytes, whole, ..Record::default() };
        viewer.panes.iter().zip(&mut record.panes).for_each(|(pane, facts)| *facts = pane.facts);
        viewer.remember(record);
    }

    /// Whether the window is to close: its device is gone, or somebody says so.
    fn is_to_close(&mut self) -> bool {
        if let Some(frames) = &mut self.destroy_after {
            *frames = frames.saturating_sub(1);
            if *frames == 0 {
                self.destroy_after = None;
                self.state.device.destroy();
            }
        }
        self.watched.is_lost() || (self.held.borrow().is_to_close)()
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        if self.destroy_after.is_some() {
            ui.ctx().request_repaint();
        }
        if self.is_to_close() {
            return ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        self.take_shots();
        let mut pressed = Vec::new();
        {
            let Held { viewer, .. } = &mut *self.held.borrow_mut();
            Panel::left("controls").default_size(286.0).show(ui, |ui| pressed = panels::controls(ui, viewer));
            Panel::bottom("frames").resizable(false).show(ui, |ui| {
                summary(ui, viewer);
                graph::show(ui, viewer);
            });
            panels::help(ui, viewer);
        }
        egui::CentralPanel::default().frame(Frame::NONE).show(ui, |ui| self.panes(ui, pressed));
    }
}

fn say(viewer: &mut Viewer, written: Result<String, String>) {
    viewer.message = match written {
        Ok(name) => format!("written: {name}"),
        Err(why) => why,
    };
}

/// What keys ask for, in their order, where no field takes them.
fn keyed(ui: &Ui) -> Vec<Action> {
    if ui.ctx().text_edit_focused() {
        return Vec::new();
    }
    let is_busy = ui.memory(|memory| memory.focused().is_some());
    let asked = |event: &egui::Event| {
        let &egui::Event::Key { key, pressed: true, repeat, modifiers, .. } = event else { return None };
        let repeats = matches!(key, Key::Comma | Key::Period | Key::OpenBracket | Key::CloseBracket);
        // A widget that has the focus takes these.
        let is_taken = is_busy && matches!(key, Key::Space | Key::Enter);
        if is_taken || modifiers.command || modifiers.alt {
            return None;
        }
        // Some keyboards tell of the key, some of what is written on it. Where shift goes up first another key is let go than was
        // pressed, and every later press passes for a repeated one.
        if key == Key::Questionmark || key == Key::Slash && modifiers.shift {
            return Some(Action::Help);
        }
        if repeat && !repeats {
            return None;
        }
        BINDINGS.iter().find(|binding| (binding.key, binding.shift) == (key, modifiers.shift)).map(|found| found.action)
    };
    ui.input(|input| input.events.iter().filter_map(asked).collect())
}

/// The camera by keys that are held; whether any is.
fn hold(ui: &Ui, viewer: &mut Viewer) -> bool {
    if ui.ctx().text_edit_focused() {
        return false;
    }
    let is_busy = ui.memory(|memory| memory.focused().is_some());
    let (time, way, turn, zoom) = ui.input(|input| {
        // Between two slow frames a key may be pressed and let go, and what was held with it as well.
        let is_down = |key| input.key_down(key) || input.key_pressed(key);
        let is_pressed = |event: &egui::Event, wanted| {
            matches!(event, &egui::Event::Key { key, pressed: true, modifiers, .. } if key == wanted && !modifiers.any())
        };
        let is_held = |key| input.key_down(key) && !input.modifiers.any();
        let one = |key| f32::from(is_held(key) || input.events.iter().any(|event| is_pressed(event, key)));
        let way = Vec3::new(one(Key::D) - one(Key::A), one(Key::E) - one(Key::Q), one(Key::W) - one(Key::S));
        // A widget that has the focus takes the arrows.
        let arrow = |key| if is_busy { 0.0 } else { one(key) };
        let turn =
            Vec2::new(arrow(Key::ArrowRight) - arrow(Key::ArrowLeft), arrow(Key::ArrowDown) - arrow(Key::ArrowUp));
        let nearer = (is_down(Key::Plus) || is_down(Key::Equals)) && !input.modifiers.command;
        let farther = is_down(Key::Minus) && !input.modifiers.command;
        (input.stable_dt.min(0.1), way, turn, f32::from(farther) - f32::from(nearer))
    });
    let pilot = &mut viewer.pilot;
    if way != Vec3::ZERO {
        pilot.slide(way * (0.6 * time));
    }
    if turn != Vec2::ZERO {
        // In flight arrows turn the head; in orbit they move the camera, which is what a drag the other way does.
        let turn = if pilot.flight == Flight::Orbit { -turn } else { turn };
        pilot.turn(turn * (1.2 * time));
    }
    if zoom != 0.0 {
        pilot.zoom((1.2 * time * zoom).exp());
    }
    way != Vec3::ZERO || turn != Vec2::ZERO || zoom != 0.0
}

/// The camera by mouse, and what is pointed at.
fn steer(ui: &Ui, viewer: &mut Viewer, response: &Response, pane: usize, area: Rect, size: [u32; 2]) {
    let drag = Vec2::new(response.drag_delta().x, response.drag_delta().y);
    if response.dragged_by(PointerButton::Primary) {
        viewer.pilot.turn(drag * 0.007);
    } else if response.dragged() {
        viewer.pilot.slide(Vec3::new(-drag.x, drag.y, 0.0) * (0.8 / area.height().max(1.0)));
    }
    if response.hovered() {
        let wheel = ui.input(|input| input.smooth_scroll_delta().y);
        if wheel != 0.0 {
            viewer.pilot.zoom((-0.002 * wheel).exp());
        }
    }
    let scale = ui.ctx().pixels_per_point();
    let is_free = |at: &Pos2| inset(viewer, area, scale).is_none_or(|(small, _)| !small.contains(*at));
    if response.clicked()
        && let Some(at) = response.interact_pointer_pos().filter(is_free)
    {
        let pixel = Vec2::new(at.x - area.left(), at.y - area.top()) * scale;
        let camera = viewer.camera(size);
        viewer.pick(pane, &camera, pixel);
    }
}

/// Where the small picture of the frozen eye is, and its camera.
fn inset(viewer: &Viewer, area: Rect, scale: f32) -> Option<(Rect, Camera)> {
    let eye = viewer.frozen?;
    let height = area.height() * INSET_SHARE;
    let size = vec2((height * eye.aspect()).min(area.width() * 0.5), height);
    let pixels = |side: f32| ((side * scale) as u32).max(1);
    let eye = Camera { width_px: pixels(size.x), height_px: pixels(size.y), ..eye };
    Some((Rect::from_min_size(area.right_bottom() - size - vec2(10.0, 10.0), size), eye))
}

/// What a pane shows, in its corner.
fn caption(ui: &Ui, viewer: &Viewer, pane: usize, area: Rect) {
    let shown = &viewer.panes[pane];
    let subject = viewer.subject(shown);
    let operator = shown.choice.operator.as_ref().unwrap_or(&subject.made_by);
    let state = match (viewer.frozen, shown.is_held, viewer.is_recording) {
        (_, true, _) => "  held in time",
        (Some(_), ..) => "  frozen",
        (.., true) => "  recording",
        _ => "",
    };
    let name = if viewer.subjects.len() > 1 { format!("{}\n", subject.name) } else { String::new() };
    let triangles = shown.view.places().triangle_count();
    let text = format!("{name}{operator}, {}\n{triangles} triangles{state}", shown.choice.dependency.name());
    let at = area.left_top() + vec2(10.0, 8.0);
    let is_active = viewer.panes.len() == 2 && pane == viewer.active;
    let colour = if is_active { Color32::from_rgb(170, 60, 20) } else { Color32::from_gray(60) };
    let galley = ui.painter().layout_no_wrap(text, FontId::proportional(13.0), colour);
    let behind = Rect::from_min_size(at, galley.size()).expand2(vec2(6.0, 3.0));
    ui.painter().rect_filled(behind, 4.0, Color32::from_white_alpha(190));
    ui.painter().galley(at, galley, colour);
}

/// Sends what changed of a pane, and its dual pieces where they are shown and are others than before.
fn send(screen: &mut Screen, viewer: &mut Viewer, pane: usize) -> Result<Uploaded, RenderError> {
    let shows_pieces = viewer.shown.pieces;
    let pane = &mut viewer.panes[pane];
    let (stage, version) = (&mut screen.stage, pane.version());
    if screen.view != Some(version.view) {
        stage.clear();
        (screen.view, screen.pieces) = (Some(version.view), None);
    }
    let mut sent = stage.update(pane.view.places_mut())?;
    let pieces = if shows_pieces { pane.pieces() } else { None };
    match pieces {
        None => {
            stage.show_view();
            screen.pieces = None;
        }
        Some(_) if screen.pieces == Some(version) => {}
        Some(scene) => {
            stage.show_instead(&scene.corners)?;
            screen.pieces = Some(version);
            sent.bytes += size_of_val(scene.corners.as_slice()) as u64;
        }
    }
    Ok(sent)
}

/// The name under which the window knows a texture.
fn known(state: &RenderState, texture: &wgpu::Texture, shown: &mut Option<(wgpu::Texture, TextureId)>) -> TextureId {
    if let Some((same, id)) = shown
        && same == texture
    {
        return *id;
    }
    let view = texture.create_view(&Default::default());
    let mut renderer = state.renderer.write();
    let id = match shown.take() {
        Some((_, id)) => {
            renderer.update_egui_texture_from_wgpu_texture(&state.device, &view, wgpu::FilterMode::Linear, id);
            id
        }
        None => renderer.register_native_texture(&state.device, &view, wgpu::FilterMode::Linear),
    };
    *shown = Some((texture.clone(), id));
    id
}

/// A line on the last frame.
fn summary(ui: &mut Ui, viewer: &Viewer) {
    let last = viewer.records.back().copied().unwrap_or_default();
    let forced: u32 = last.panes.iter().map(|pane| pane.outcome.forced).sum();
    let fans: u32 = last.panes.iter().map(|pane| pane.outcome.runs).sum();
    let text = format!(
        "{}   forced {forced}   fan steps {fans}   sent {:.1} kB   frame {:.1} ms",
        viewer.ask.told(),
        last.bytes as f64 / 1e3,
        last.whole.as_secs_f64() * 1e3,
    );
    ui.label(text);
}
