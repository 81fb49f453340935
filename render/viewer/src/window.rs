//! The window: input to actions, frames to textures, pictures to files.

use crate::keys::{Action, BINDINGS};
use crate::pilot::Flight;
use crate::saved::{self, File, Save};
use crate::viewer::{Record, Viewer};
use crate::{graph, panels};
use eframe::egui::{
    self, Color32, FontId, Frame, Key, Panel, PointerButton, Pos2, Rect, Response, Sense, TextureId, Ui, vec2,
};
use eframe::egui_wgpu::RenderState;
use glam::{Vec2, Vec3};
use mt_core::Camera;
use render::{RenderError, Scene, Stage, Uploaded, wgpu};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Which of a stage's pictures is what the pane shows, and which the small one of the frozen eye.
const MAIN: usize = 0;
const INSET: usize = 1;
/// The small picture's share of the pane.
const INSET_SHARE: f32 = 0.28;

/// Where a viewer waits while no window has it.
pub(crate) type Shelf = Rc<Cell<Option<Box<Held>>>>;

/// What outlives a window.
pub(crate) struct Held {
    pub(crate) viewer: Viewer,
    pub(crate) save: Save,
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
}

/// A pane on the device.
struct Screen {
    stage: Stage,
    /// The textures that the window knows.
    shown: [Option<(wgpu::Texture, TextureId)>; 2],
    /// The version of the pieces that are on the device.
    pieces: Option<u64>,
}

impl Screen {
    fn new(stage: Stage) -> Self {
        Self { stage, shown: [None, None], pieces: None }
    }
}

/// A viewer in a window.
pub(crate) struct App {
    held: Option<Box<Held>>,
    shelf: Shelf,
    state: RenderState,
    screens: Vec<Screen>,
    watched: Watched,
    /// Pictures of the window, as they come.
    shots: (Sender<Arc<egui::ColorImage>>, Receiver<Arc<egui::ColorImage>>),
    last: Instant,
    /// Whether the frame before asked for this one.
    was_moving: bool,
    size: [u32; 2],
    /// Frames until the device is destroyed, to see what comes of it.
    destroy_after: Option<u32>,
}

impl App {
    /// Takes the viewer from the shelf.
    pub(crate) fn new(
        context: &eframe::CreationContext<'_>,
        shelf: &Shelf,
        watched: &Watched,
        destroy_after: Option<u32>,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let state = context.wgpu_render_state.clone().ok_or("the window has no device to draw with")?;
        let stage = Stage::on(&state.adapter, state.device.clone(), state.queue.clone())?;
        let flag = Arc::clone(&watched.told);
        *watched.device.borrow_mut() = Some(state.device.clone());
        let wake = context.egui_ctx.clone();
        state.device.set_device_lost_callback(move |_, _| {
            flag.store(true, Ordering::Relaxed);
            wake.request_repaint();
        });
        let held = shelf.take().ok_or("there is nothing to show")?;
        Ok(Self {
            held: Some(held),
            shelf: Rc::clone(shelf),
            state,
            screens: vec![Screen::new(stage)],
            watched: watched.clone(),
            shots: channel(),
            last: Instant::now(),
            was_moving: false,
            size: [1, 1],
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

    /// What keys ask for, where no field takes them.
    fn keyed(ui: &Ui) -> Vec<Action> {
        if ui.ctx().egui_wants_keyboard_input() {
            return Vec::new();
        }
        let busy = ui.memory(|memory| memory.focused().is_some());
        ui.input(|input| {
            let pressed = |key, shift: bool| {
                input.events.iter().any(|event| {
                    matches!(event, egui::Event::Key { key: k, pressed: true, repeat, modifiers, .. }
                        if *k == key && modifiers.shift == shift && !modifiers.command && !modifiers.alt
                            && (!repeat || matches!(key, Key::Comma | Key::Period | Key::OpenBracket | Key::CloseBracket)))
                })
            };
            // A widget that has the focus takes these.
            let taken = |key| busy && matches!(key, Key::Space | Key::Enter);
            let bound = BINDINGS.iter().filter(|b| pressed(b.key, b.shift) && !taken(b.key)).map(|b| b.action);
            let asked = input.key_pressed(Key::Questionmark).then_some(Action::Help);
            bound.chain(asked).collect()
        })
    }

    fn act(&mut self, ui: &Ui, action: Action) {
        let Some(held) = &mut self.held else { return };
        let Held { viewer, save } = &mut **held;
        if viewer.act(action, self.size) {
            return;
        }
        let active = viewer.active;
        let log = viewer.panes[active].play.log();
        let written = match action {
            Action::SavePicture => self.picture().and_then(|files| self.write("picture", &files)),
            Action::SavePath if viewer.path.is_empty() => Err("there is no path: record one".into()),
            Action::SavePath => {
                let text = serde_json::to_string_pretty(&viewer.path).map_err(|error| error.to_string());
                text.and_then(|text| save("path", &[("json", text.into_bytes())]))
            }
            Action::SaveLog if !viewer.panes[active].play.is_log_whole() => {
                Err("the log is so long that its beginning is gone".into())
            }
            Action::SaveLog => {
                let mut text = Vec::new();
                let done = log.write(&mut text).map_err(|error| error.to_string());
                done.and_then(|()| save("log", &[("log", text)]))
            }
            Action::SaveWindow => {
                let tell = self.shots.0.clone();
                // Whoever closes the window meanwhile wants no picture.
                ui.ctx().request_screenshot(move |image| drop(tell.send(image)));
                return;
            }
            _ => return ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close),
        };
        self.say(written);
    }

    fn write(&mut self, what: &str, files: &[File]) -> Result<String, String> {
        self.held.as_mut().map_or_else(|| Err("nothing is shown".into()), |held| (held.save)(what, files))
    }

    fn say(&mut self, written: Result<String, String>) {
        let Some(held) = &mut self.held else { return };
        held.viewer.message = match written {
            Ok(name) => format!("written: {name}"),
            Err(why) => why,
        };
    }

    /// The picture of the pane in use, read back, and what goes with it.
    fn picture(&mut self) -> Result<Vec<File>, String> {
        let Some(held) = &mut self.held else { return Err("nothing is shown".into()) };
        let viewer = &mut held.viewer;
        let (active, camera) = (viewer.active, viewer.camera(self.size));
        let scene = viewer.scene(active, &camera);
        let screen = &mut self.screens[active];
        let sent = send(screen, viewer, active);
        let picture = sent.and_then(|_| screen.stage.paint(&scene, &camera)).map_err(|error| error.to_string())?;
        Ok(saved::picture(viewer, &viewer.panes[active], &camera, picture.to_png()))
    }

    /// Pictures of the window that have come.
    fn take_shots(&mut self) {
        while let Ok(image) = self.shots.1.try_recv() {
            let [width, height] = image.size.map(|side| side as u32);
            let rgba = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
            let png = render::Picture { width, height, rgba }.to_png();
            let written = self.write("window", &[("png", png)]);
            self.say(written);
        }
    }

    /// Draws a pane into a texture and shows it.
    fn show(&mut self, ui: &mut Ui, pane: usize, area: Rect) -> Result<Uploaded, RenderError> {
        let Some(held) = &mut self.held else { return Ok(Uploaded::default()) };
        let viewer = &mut held.viewer;
        let camera = viewer.camera(self.size);
        let scene = viewer.scene(pane, &camera);
        let screen = &mut self.screens[pane];
        let sent = send(screen, viewer, pane)?;
        let Screen { stage, shown, .. } = screen;
        let id = known(&self.state, stage.show(&scene, &camera, MAIN)?, &mut shown[MAIN]);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(id, area, whole, Color32::WHITE);
        if let Some(eye) = viewer.frozen {
            // The same triangles as the frozen eye sees them, without the lines that are for the eye outside.
            let size = area.size() * INSET_SHARE;
            let pixels = self.size.map(|side| ((side as f32 * INSET_SHARE) as u32).max(1));
            let eye = Camera { width_px: pixels[0], height_px: pixels[1], ..eye };
            let plain = Scene { segments: Vec::new(), ..scene };
            let id = known(&self.state, stage.show(&plain, &eye, INSET)?, &mut shown[INSET]);
            let small = Rect::from_min_size(area.right_bottom() - size - vec2(10.0, 10.0), size);
            ui.painter().rect_filled(small.expand(2.0), 2.0, Color32::from_gray(60));
            ui.painter().image(id, small, whole, Color32::WHITE);
        }
        Ok(sent)
    }

    /// Both panes, side by side.
    fn panes(&mut self, ui: &mut Ui) {
        let all = ui.available_rect_before_wrap();
        let Some(held) = &mut self.held else { return };
        let count = held.viewer.panes.len();
        let scale = ui.ctx().pixels_per_point();
        let width = all.width() / count as f32;
        self.size = [width, all.height()].map(|side| ((side * scale).round() as u32).clamp(1, 8192));
        held.viewer.frame(self.size);
        self.set_screens(held_count(&self.held));
        let mut bytes = 0;
        for pane in 0..count {
            let corner = all.left_top() + vec2(width * pane as f32, 0.0);
            let area = Rect::from_min_size(corner, vec2(width, all.height()));
            let response = ui.allocate_rect(area, Sense::click_and_drag());
            self.steer(ui, &response, pane, area);
            match self.show(ui, pane, area) {
                Ok(sent) => bytes += sent.bytes,
                Err(error) => self.say(Err(error.to_string())),
            }
            self.caption(ui, pane, area);
        }
        self.remember(bytes);
    }

    fn caption(&self, ui: &Ui, pane: usize, area: Rect) {
        let Some(held) = &self.held else { return };
        let viewer = &held.viewer;
        let shown = &viewer.panes[pane];
        let subject = viewer.subject(shown);
        let operator = shown.choice.operator.as_ref().unwrap_or(&subject.made_by);
        let state = match (viewer.frozen, shown.is_held, viewer.is_recording) {
            (_, true, _) => "  held in time",
            (Some(_), ..) => "  frozen",
            (.., true) => "  recording",
            _ => "",
        };
        let triangles = shown.play.places().triangle_count();
        let text = format!("{operator}, {}\n{triangles} triangles{state}", shown.choice.dependency.name());
        let at = area.left_top() + vec2(10.0, 8.0);
        let active = viewer.panes.len() == 2 && pane == viewer.active;
        let colour = if active { Color32::from_rgb(170, 60, 20) } else { Color32::from_gray(60) };
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(13.0), colour);
        let behind = Rect::from_min_size(at, galley.size()).expand2(vec2(6.0, 3.0));
        ui.painter().rect_filled(behind, 4.0, Color32::from_white_alpha(190));
        ui.painter().galley(at, galley, colour);
    }

    /// The camera by mouse and by keys that are held.
    fn steer(&mut self, ui: &Ui, response: &Response, pane: usize, area: Rect) {
        let Some(held) = &mut self.held else { return };
        let viewer = &mut held.viewer;
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
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            let scale = ui.ctx().pixels_per_point();
            let pixel = Vec2::new(at.x - area.left(), at.y - area.top()) * scale;
            let camera = viewer.camera(self.size);
            viewer.pick(pane, &camera, pixel);
        }
    }

    /// The camera by keys that are held; whether any is.
    fn hold(&mut self, ui: &Ui) -> bool {
        let Some(held) = &mut self.held else { return false };
        if ui.ctx().egui_wants_keyboard_input() {
            return false;
        }
        let busy = ui.memory(|memory| memory.focused().is_some());
        let pilot = &mut held.viewer.pilot;
        let (time, down) = ui.input(|input| {
            // Between two slow frames a key may be pressed and let go.
            let is_down = |key| input.key_down(key) || input.key_pressed(key);
            let down = |key| f32::from(is_down(key) && !input.modifiers.any());
            let letters = [Key::D, Key::A, Key::E, Key::Q, Key::W, Key::S].map(down);
            // A widget that has the focus takes the arrows.
            let arrows = [Key::ArrowRight, Key::ArrowLeft, Key::ArrowDown, Key::ArrowUp];
            let arrows = arrows.map(|key| if busy { 0.0 } else { down(key) });
            let zoom = [Key::Minus, Key::Plus].map(|key| f32::from(is_down(key) && !input.modifiers.command));
            let equals = f32::from(is_down(Key::Equals) && !input.modifiers.command);
            (input.stable_dt.min(0.1), (letters, arrows, zoom[0] - zoom[1].max(equals)))
        });
        let (letters, arrows, zoom) = down;
        let way = Vec3::new(letters[0] - letters[1], letters[2] - letters[3], letters[4] - letters[5]);
        let turn = Vec2::new(arrows[0] - arrows[1], arrows[2] - arrows[3]);
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

    fn remember(&mut self, bytes: u64) {
        let now = Instant::now();
        let since = now - std::mem::replace(&mut self.last, now);
        // A window at rest draws when it is touched: nothing is to be learned from how long nobody did.
        let whole = if self.was_moving { since } else { Duration::ZERO };
        let Some(held) = &mut self.held else { return };
        let viewer = &mut held.viewer;
        let mut record = Record { bytes, whole, ..Record::default() };
        viewer.panes.iter().zip(&mut record.panes).for_each(|(pane, facts)| *facts = pane.facts);
        viewer.remember(record);
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        if let Some(frames) = &mut self.destroy_after {
            *frames = frames.saturating_sub(1);
            if *frames == 0 {
                self.destroy_after = None;
                self.state.device.destroy();
            }
            ui.ctx().request_repaint();
        }
        if self.watched.is_lost() {
            return ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        self.take_shots();
        let mut actions = Self::keyed(ui);
        let is_held = self.hold(ui);
        if let Some(held) = &mut self.held {
            let viewer = &mut held.viewer;
            Panel::left("controls").default_size(286.0).show(ui, |ui| actions.extend(panels::controls(ui, viewer)));
            Panel::bottom("frames").resizable(false).show(ui, |ui| {
                summary(ui, viewer);
                graph::show(ui, viewer);
            });
            panels::help(ui, viewer);
        }
        for action in actions {
            self.act(ui, action);
        }
        egui::CentralPanel::default().frame(Frame::NONE).show(ui, |ui| self.panes(ui));
        let moves = self.held.as_ref().is_some_and(|held| held.viewer.is_moving());
        self.was_moving = moves || is_held;
        if self.was_moving {
            ui.ctx().request_repaint();
        }
    }
}

impl Drop for App {
    /// What was seen is there for the next window.
    fn drop(&mut self) {
        if let Some(mut held) = self.held.take() {
            // Another device has nothing of it.
            held.viewer.panes.iter_mut().for_each(|pane| pane.is_fresh = true);
            self.shelf.set(Some(held));
        }
    }
}

fn held_count(held: &Option<Box<Held>>) -> usize {
    held.as_ref().map_or(1, |held| held.viewer.panes.len())
}

/// Sends what changed of a pane, and its dual pieces where they are shown and are others than before.
fn send(screen: &mut Screen, viewer: &mut Viewer, pane: usize) -> Result<Uploaded, RenderError> {
    let shows_pieces = viewer.shown.pieces;
    let pane = &mut viewer.panes[pane];
    let stage = &mut screen.stage;
    if std::mem::take(&mut pane.is_fresh) {
        stage.clear();
        screen.pieces = None;
    }
    let mut sent = stage.update(pane.play.places_mut())?;
    let pieces = if shows_pieces { Some(pane.pieces()) } else { None };
    match pieces.and_then(|pieces| Some((pieces.version, pieces.scene.as_ref()?))) {
        None => {
            stage.show_view();
            screen.pieces = None;
        }
        Some((version, _)) if screen.pieces == Some(version) => {}
        Some((version, scene)) => {
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
