//! What the window shows and what can be done to it, without the window.

use crate::ask::Ask;
use crate::keys::Action;
use crate::marks::add_picked;
use crate::pane::{Choice, FrameFacts, Make, Pane, Subject};
use crate::pick::pick;
use crate::pilot::{Flight, Pilot};
use glam::{Vec2, Vec3};
use mt_core::Camera;
use operators::AnyOperator;
use papers::study::{CriterionKind, DependencyKind, StrategyKind};
use render::{Edges, Scene, Tint, WIRE};
use std::collections::VecDeque;
use std::time::Duration;

/// Frames that the graph remembers.
pub const FRAMES_KEPT: usize = 240;
/// Factor of one step finer or coarser.
const PACE: f32 = 1.189_207;

/// What is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    /// The triangles' edges.
    pub wire: bool,
    /// What colours tell.
    pub tint: Tint,
    /// Boundary, edges of many triangles, cracks.
    pub edges: bool,
    /// The outline.
    pub outline: bool,
    /// The dual pieces over the input, instead of the mesh.
    pub pieces: bool,
}

/// A frame, for the graph.
#[derive(Clone, Copy, Debug, Default)]
pub struct Record {
    /// Of each pane; the second is empty where there is one.
    pub panes: [FrameFacts; 2],
    /// Bytes sent to the device.
    pub bytes: u64,
    /// From the frame before to this one, where that one asked for it; else 0.
    pub whole: Duration,
}

/// Everything but the window.
pub struct Viewer {
    /// The models.
    pub subjects: Vec<Subject>,
    make: Make,
    /// One or two.
    pub panes: Vec<Pane>,
    /// The one that choices are for.
    pub active: usize,
    /// The camera, which all panes share.
    pub pilot: Pilot,
    /// What is asked.
    pub ask: Ask,
    /// The eye that the mesh is made for, while the camera is elsewhere.
    pub frozen: Option<Camera>,
    /// What is drawn.
    pub shown: Shown,
    /// A camera path, recorded or loaded.
    pub path: Vec<Camera>,
    /// Where on the path the camera is, while it follows it.
    pub following: Option<usize>,
    /// Whether the log is played.
    pub is_log_played: bool,
    /// Whether the path is being recorded.
    pub is_recording: bool,
    /// The last frames.
    pub records: VecDeque<Record>,
    /// What there is to say.
    pub message: String,
    /// Whether the keys are shown.
    pub is_help_shown: bool,
    last_eye: Vec3,
    /// Whether the eye moved since the frame before: a criterion for motion asks again when it stopped.
    has_moved: bool,
    /// The pane that went when there was to be one only.
    parked: Option<Pane>,
}

/// What an action leaves to whoever has files and a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chore {
    /// Write the picture of the pane.
    Picture,
    /// Write a picture of the window.
    Window,
    /// Write the camera path.
    Path,
    /// Write the log.
    Log,
    /// Close the window.
    Close,
}

impl Viewer {
    /// Of models with a view each: one or two.
    pub fn new(subjects: Vec<Subject>, panes: Vec<Pane>, make: Make, path: Vec<Camera>) -> Self {
        let (low, high) = subjects
            .iter()
            .map(|subject| (subject.extent.low, subject.extent.high))
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (a, b)| (low.min(a), high.max(b)));
        let pilot = Pilot::around(low, high);
        let last_eye = pilot.camera([1, 1]).eye;
        Self {
            ask: Ask::usual(subjects[0].extent.cells),
            subjects,
            make,
            panes,
            active: 0,
            pilot,
            frozen: None,
            shown: Shown::default(),
            path,
            following: None,
            is_log_played: false,
            is_recording: false,
            records: VecDeque::new(),
            message: String::new(),
            is_help_shown: false,
            last_eye,
            has_moved: false,
            parked: None,
        }
    }

    /// What a pane is about.
    pub fn subject(&self, pane: &Pane) -> &Subject {
        &self.subjects[pane.model]
    }

    /// Takes what is ready, moves along path and log, and brings all panes to what is asked for a picture of this size. Two
    /// panes work side by side.
    pub fn frame(&mut self, size: [u32; 2]) {
        for pane in &mut self.panes {
            if let Err(why) = pane.receive() {
                self.message = format!("{why}; the view stays as it is");
            }
        }
        self.follow();
        if self.is_log_played {
            self.panes.iter_mut().for_each(|pane| pane.frame(true));
            self.is_log_played = self.panes.iter().any(|pane| pane.view.is_past());
        }
        let camera = self.camera(size);
        if self.is_recording {
            self.path.push(camera);
        }
        let eye = self.frozen.unwrap_or(camera);
        let (ask, last) = (self.ask, self.last_eye);
        (self.last_eye, self.has_moved) = (eye.eye, last != eye.eye);
        let subjects = &self.subjects;
        let work = |pane: &mut Pane| {
            let asked = ask.of(&subjects[pane.model].extent, &eye, last);
            pane.adapt(&ask, &asked, &eye, last);
        };
        match &mut self.panes[..] {
            [one, other] => std::thread::scope(|scope| {
                let beside = scope.spawn(|| work(other));
                work(one);
                beside.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            }),
            panes => panes.iter_mut().for_each(work),
        }
    }

    /// The camera that is looked through.
    pub fn camera(&self, size: [u32; 2]) -> Camera {
        if self.frozen.is_some() { self.pilot.camera_outside(size) } else { self.pilot.camera(size) }
    }

    fn follow(&mut self) {
        let Some(at) = self.following else { return };
        match self.path.get(at) {
            Some(camera) => {
                self.pilot.set(camera);
                self.following = Some(at + 1);
            }
            None => self.following = None,
        }
    }

    /// Colours the triangles of a pane, and gives what else is drawn of it as `camera` sees it. Dual pieces are for
    /// [`Pane::pieces`] to tell, but for their lines.
    pub fn scene(&mut self, pane: usize, camera: &Camera) -> Scene {
        let (shown, frozen) = (self.shown, self.frozen);
        let pane = &mut self.panes[pane];
        let extent = &self.subjects[pane.model].extent;
        let legend = pane.tint(shown.tint);
        let lines = if shown.pieces { pane.pieces().map(|pieces| pieces.marks.clone()) } else { None };
        let origin = pane.view.places().origin();
        // Pieces have colours of their own, and their triangles are no cells.
        let mut scene = match lines {
            Some(marks) => Scene { origin, marks, ..Scene::default() },
            None => Scene { origin, wire: shown.wire.then_some(WIRE), legend, ..Scene::default() },
        };
        if shown.outline {
            scene.add_edges(pane.view.positions(), &pane.cells(), Edges::Outline(camera.eye));
        }
        if shown.edges {
            scene.marks.extend_from_slice(pane.edges());
        }
        if let Some(frozen) = frozen {
            scene.add_frustum(&frozen, extent.low, extent.high);
        }
        if let Some(picked) = &pane.picked {
            add_picked(&mut scene, picked);
        }
        scene
    }

    /// Points at what lies under a pixel of a pane.
    pub fn pick(&mut self, pane: usize, camera: &Camera, pixel: Vec2) {
        self.active = pane;
        let Pane { view, picked, .. } = &mut self.panes[pane];
        *picked = pick(view.places(), camera, pixel).map(|hit| view.pick(hit.placed, hit.corner));
        self.message = if picked.is_none() { "nothing is there".into() } else { String::new() };
    }

    /// Does what needs neither window nor file, in a picture of this size; what is left to do.
    pub fn act(&mut self, action: Action, size: [u32; 2]) -> Option<Chore> {
        // A picture of the window has what stands in it.
        if action != Action::SaveWindow {
            self.message.clear();
        }
        let each = |panes: &mut [Pane], go: fn(&mut Pane)| panes.iter_mut().for_each(go);
        match action {
            Action::Help => self.is_help_shown ^= true,
            Action::Freeze => self.freeze(size),
            Action::Flight => {
                let orbits = self.pilot.flight == Flight::Orbit;
                self.pilot.flight = if orbits { Flight::Fly } else { Flight::Orbit };
            }
            Action::Fit => self.pilot.fit(),
            Action::Wire => self.shown.wire ^= true,
            Action::NextTint => self.next_tint(),
            Action::Edges => self.shown.edges ^= true,
            Action::Outline => self.shown.outline ^= true,
            Action::Pieces => self.show_pieces(),
            Action::NextScheme => self.next_scheme(1),
            Action::LastScheme => self.next_scheme(-1),
            Action::NextOperator => self.next_operator(),
            Action::NextCriterion => self.ask.criterion = next(CriterionKind::ALL, self.ask.criterion, 1),
            Action::NextStrategy => self.ask.strategy = next(StrategyKind::ALL, self.ask.strategy, 1),
            Action::Finer => self.pace(1.0 / PACE),
            Action::Coarser => self.pace(PACE),
            Action::Split => self.split(),
            Action::OtherPane => self.active = (self.active + 1) % self.panes.len(),
            Action::StepBack => each(&mut self.panes, |pane| pane.step(-1)),
            Action::StepForward => each(&mut self.panes, |pane| pane.step(1)),
            Action::FrameBack => each(&mut self.panes, |pane| pane.frame(false)),
            Action::FrameForward => each(&mut self.panes, |pane| pane.frame(true)),
            Action::PlayLog => self.play_log(),
            Action::Now => each(&mut self.panes, Pane::go_on),
            Action::Record => self.record(),
            Action::Follow => self.follow_path(),
            Action::Unpick if self.is_help_shown => self.is_help_shown = false,
            Action::Unpick => each(&mut self.panes, |pane| pane.picked = None),
            Action::Pick => {
                let camera = self.camera(size);
                self.pick(self.active, &camera, Vec2::new(size[0] as f32, size[1] as f32) * 0.5);
            }
            Action::SavePicture => return Some(Chore::Picture),
            Action::SaveWindow => return Some(Chore::Window),
            Action::SavePath => return Some(Chore::Path),
            Action::SaveLog => return Some(Chore::Log),
            Action::Quit => return Some(Chore::Close),
        }
        None
    }

    fn next_tint(&mut self) {
        self.shown.tint = next(&Tint::ALL, self.shown.tint, 1);
        if self.shown.tint == Tint::Fans
            && self.panes.iter().all(|pane| pane.choice.dependency == DependencyKind::Cells)
        {
            self.message = "cells know a fan as one node: choose another scheme to see which are whole".into();
        }
    }

    fn show_pieces(&mut self) {
        self.shown.pieces ^= true;
        if self.shown.pieces && self.panes.iter_mut().all(|pane| pane.pieces().is_none()) {
            self.shown.pieces = false;
            self.message = "dual pieces are of vertex hierarchies: choose another scheme than cells".into();
        }
    }

    fn freeze(&mut self, size: [u32; 2]) {
        match self.frozen.take() {
            // Back to where the mesh was made for.
            Some(camera) => self.pilot.set(&camera),
            None => self.frozen = Some(self.pilot.camera(size)),
        }
    }

    fn next_scheme(&mut self, by: isize) {
        let all: Vec<DependencyKind> = DependencyKind::all().collect();
        let chosen = self.panes[self.active].tried.clone();
        self.choose(self.active, Choice { dependency: next(&all, chosen.dependency, by), ..chosen });
    }

    fn next_operator(&mut self) {
        let chosen = self.panes[self.active].tried.clone();
        self.choose(self.active, Choice { operator: next(&operators(), chosen.operator.clone(), 1), ..chosen });
    }

    /// Has another view made for a pane.
    pub fn choose(&mut self, pane: usize, choice: Choice) {
        self.panes[pane].choose(choice, &self.make);
    }

    fn pace(&mut self, factor: f32) {
        let ask = &mut self.ask;
        if ask.criterion == CriterionKind::Budget {
            ask.cells = ((ask.cells as f32 / factor) as u32).max(1);
        } else if ask.is_spatial() {
            ask.error_share = (ask.error_share * factor).clamp(*Ask::SHARES.start(), *Ask::SHARES.end());
        } else {
            ask.error_px = (ask.error_px * factor).clamp(*Ask::PIXELS.start(), *Ask::PIXELS.end());
        }
    }

    /// One pane, or the one that went before beside it again, or else another view of the same model.
    fn split(&mut self) {
        if self.panes.len() == 2 {
            self.parked = self.panes.pop();
        } else {
            let other = self.parked.take().unwrap_or_else(|| self.panes[0].beside());
            self.panes.push(other);
        }
        self.active = self.panes.len() - 1;
    }

    fn record(&mut self) {
        self.is_recording ^= true;
        if self.is_recording {
            self.path.clear();
            self.following = None;
        }
    }

    /// From where the panes are, or from the beginning where all are at the end.
    fn play_log(&mut self) {
        self.is_log_played ^= true;
        if self.is_log_played && self.panes.iter().all(|pane| !pane.view.is_past()) {
            self.panes.iter_mut().for_each(|pane| pane.seek(0));
        }
    }

    fn follow_path(&mut self) {
        self.is_recording = false;
        self.following = match self.following {
            Some(_) => None,
            None if self.path.is_empty() => {
                self.message = "there is no path: record one".into();
                None
            }
            None => Some(0),
        };
    }

    /// Whether the next frame will differ from this one without anybody's doing.
    pub fn is_moving(&self) -> bool {
        self.following.is_some()
            || self.is_recording
            || self.is_log_played
            || self.has_moved
            || self.panes.iter().any(|pane| pane.waits().is_some() || !pane.facts.outcome.complete)
    }

    /// Remembers a frame.
    pub fn remember(&mut self, record: Record) {
        if self.records.len() == FRAMES_KEPT {
            self.records.pop_front();
        }
        self.records.push_back(record);
    }
}

/// The one after another in a list, or before it; the first where it is not there.
fn next<T: PartialEq + Clone>(all: &[T], at: T, by: isize) -> T {
    let place = all.iter().position(|one| *one == at).map_or(0, |place| place as isize + by);
    all[place.rem_euclid(all.len() as isize) as usize].clone()
}

/// The operators there are; none stands for the model as it came.
pub(crate) fn operators() -> Vec<Option<String>> {
    std::iter::once(None).chain(AnyOperator::NAMES.map(|name| Some(name.to_owned()))).collect()
}
