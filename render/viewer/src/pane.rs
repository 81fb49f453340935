//! A pane: a view of one of the models under one choice of operator and dependency, and the next one while it is made.

use crate::any_view::{AnyView, Picked};
use crate::ask::{Ask, Asked, Extent};
use glam::Vec3;
use mt_core::log::{Log, LogError};
use mt_core::{Camera, Cell, CellId};
use papers::study::DependencyKind;
use render::{Edges, Legend, Scene, Segment, Tint};
use selective::Outcome;
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// What a model is made by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What coarsens the input, by name; the model as it came where none is chosen.
    pub operator: Option<String>,
    /// What steps wait for.
    pub dependency: DependencyKind,
}

/// The words by which a command loads a model under a choice; none where none does.
pub type Words = Arc<dyn Fn(&Choice) -> Option<String> + Send + Sync>;

/// One of the models that the window is about.
#[derive(Clone)]
pub struct Subject {
    /// Its name.
    pub name: String,
    /// What criteria need to know of it.
    pub extent: Extent,
    /// What it was coarsened by, where that is known.
    pub made_by: String,
    /// How commands load it.
    pub words: Words,
}

/// Makes a view of a model under a choice, or says in one line why not. May take long; it is called on a thread of its own.
pub type Make = Arc<dyn Fn(usize, &Choice) -> Result<Box<dyn AnyView>, String> + Send + Sync>;

/// A view that is being made.
struct Waiting {
    choice: Choice,
    since: Instant,
    heard: Receiver<Result<Box<dyn AnyView>, String>>,
}

/// What a frame of a pane was.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameFacts {
    /// What adapting did.
    pub outcome: Outcome,
    /// How long it took.
    pub adapt: Duration,
    /// Triangles afterwards.
    pub triangles: u32,
}

/// Which view, and which of its meshes: no two panes, views or meshes have the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Version {
    /// Which view.
    pub view: u64,
    /// Which mesh of it.
    pub mesh: u64,
}

impl Version {
    fn of_new_view() -> Self {
        static VIEWS: AtomicU64 = AtomicU64::new(0);
        Self { view: VIEWS.fetch_add(1, Ordering::Relaxed), mesh: 0 }
    }
}

/// A pane.
pub struct Pane {
    /// Which of the models.
    pub model: usize,
    /// What the view that is shown was made by.
    pub choice: Choice,
    /// The view that is shown.
    pub view: Box<dyn AnyView>,
    waiting: Option<Waiting>,
    /// What was chosen last, whether it can be made or not: whoever asks for the next one gets beyond it.
    pub tried: Choice,
    /// The last frame.
    pub facts: FrameFacts,
    /// What was pointed at.
    pub picked: Option<Picked>,
    /// Whether the mesh is held somewhere in its log, instead of following the eye.
    pub is_held: bool,
    version: Version,
    /// What the mesh was last made for, with the eye of the frame before; nothing where it has to be made anew.
    made_for: Option<(Ask, Camera, Vec3)>,
    tinted: Option<(Tinted, Option<Legend>)>,
    pieces: Option<(Version, Option<Scene>)>,
    edges: Option<(Version, Vec<Segment>)>,
}

/// What colours depend on.
#[derive(Clone, PartialEq)]
struct Tinted {
    version: Version,
    tint: Tint,
    made_for: Option<(Ask, Camera, Vec3)>,
    picked: Option<CellId>,
}

impl Pane {
    /// Of a view that is there.
    pub fn new(model: usize, choice: Choice, view: Box<dyn AnyView>) -> Self {
        Self {
            model,
            tried: choice.clone(),
            choice,
            view,
            waiting: None,
            facts: FrameFacts::default(),
            picked: None,
            is_held: false,
            version: Version::of_new_view(),
            made_for: None,
            tinted: None,
            pieces: None,
            edges: None,
        }
    }

    /// Another pane of the same model.
    pub fn beside(&self) -> Self {
        Self::new(self.model, self.choice.clone(), self.view.beside())
    }

    /// Which mesh is shown.
    pub fn version(&self) -> Version {
        self.version
    }

    /// What was chosen, whether it is there already or not.
    pub fn chosen(&self) -> &Choice {
        self.waiting.as_ref().map_or(&self.choice, |waiting| &waiting.choice)
    }

    /// How long the next view has been in the making.
    pub fn waits(&self) -> Option<Duration> {
        self.waiting.as_ref().map(|waiting| waiting.since.elapsed())
    }

    /// Has the view of another choice made. What is being made already is forgotten when it is there.
    pub fn choose(&mut self, choice: Choice, make: &Make) {
        if *self.chosen() == choice {
            return;
        }
        self.tried = choice.clone();
        if self.choice == choice {
            self.waiting = None;
            return;
        }
        let (tell, heard) = channel();
        let (make, model, wanted) = (Arc::clone(make), self.model, choice.clone());
        // Nobody may hear it any more by then.
        std::thread::spawn(move || drop(tell.send(make(model, &wanted))));
        self.waiting = Some(Waiting { choice, since: Instant::now(), heard });
    }

    /// Takes the next view, if it is there; why not, if it never will be.
    pub fn receive(&mut self) -> Result<(), String> {
        let Some(waiting) = &self.waiting else { return Ok(()) };
        let heard = match waiting.heard.try_recv() {
            Ok(heard) => heard,
            Err(TryRecvError::Empty) => return Ok(()),
            Err(TryRecvError::Disconnected) => Err("it could not be made".into()),
        };
        let choice = waiting.choice.clone();
        self.waiting = None;
        let view = heard?;
        *self = Self::new(self.model, choice, view);
        Ok(())
    }

    /// Brings the mesh to what is asked, unless it is there or held.
    pub fn adapt(&mut self, ask: &Ask, asked: &Asked, camera: &Camera, last: Vec3) {
        // What a criterion asks in motion is another question than at rest, so the eye of the frame before counts as well.
        let question = Some((*ask, *camera, last));
        let is_answered = self.made_for == question && self.facts.outcome.complete;
        if self.is_held || is_answered {
            self.facts.adapt = Duration::ZERO;
            self.facts.outcome = Outcome { complete: true, ..Outcome::default() };
            return;
        }
        let begun = Instant::now();
        let outcome = self.view.adapt(asked);
        let steps = outcome.refined + outcome.coarsened;
        if steps > 0 {
            self.changed();
        }
        // A budget that is used up is not complete and never will be.
        let outcome = Outcome { complete: outcome.complete || steps == 0, ..outcome };
        self.facts = FrameFacts { outcome, adapt: begun.elapsed(), ..self.facts };
        self.made_for = question;
    }

    /// The mesh is another one.
    fn changed(&mut self) {
        self.version.mesh += 1;
        self.picked = None;
        self.made_for = None;
        self.facts.triangles = self.view.places().triangle_count() as u32;
    }

    /// Goes to another place in the log, by so many steps.
    pub fn step(&mut self, by: isize) {
        self.seek(self.view.at().saturating_add_signed(by));
    }

    /// Goes to the end of the frame before, or of the next one.
    pub fn frame(&mut self, forward: bool) {
        let (at, ends) = (self.view.at(), &self.view.log().frame_ends);
        let to = if forward {
            ends.iter().copied().find(|&end| end > at).unwrap_or(at)
        } else {
            ends.iter().rev().copied().find(|&end| end < at).unwrap_or(0)
        };
        self.seek(to);
    }

    /// Goes to where so many steps of the log are taken, and is held there; stays as it is where it is there already.
    pub fn seek(&mut self, at: usize) {
        let before = self.view.at();
        self.view.seek(at);
        if self.view.at() != before {
            self.is_held = true;
            self.changed();
        }
    }

    /// Goes to the end of the log, and on with the eye.
    pub fn go_on(&mut self) {
        self.seek(usize::MAX);
        self.is_held = false;
        self.made_for = None;
    }

    /// Takes another log for its own, and is held at its beginning.
    pub fn take_log(&mut self, log: Log) -> Result<(), LogError> {
        self.view.take_log(log)?;
        self.is_held = true;
        self.changed();
        Ok(())
    }

    /// Colours the triangles, where they are not as they should be; the bar for numbers.
    pub fn tint(&mut self, tint: Tint) -> Option<Legend> {
        let wanted = Tinted {
            version: self.version,
            tint,
            made_for: self.made_for,
            picked: self.picked.as_ref().map(|picked| picked.placed.cell),
        };
        if let Some((tinted, legend)) = &self.tinted
            && *tinted == wanted
        {
            return *legend;
        }
        let nothing = HashSet::new();
        let marked = self.picked.as_ref().map_or(&nothing, |picked| &picked.replaced);
        let legend = self.view.tint(tint, marked);
        self.tinted = Some((wanted, legend));
        legend
    }

    /// The dual pieces of the mesh, found once for each mesh in O(input); none of explicit models.
    pub fn pieces(&mut self) -> Option<&Scene> {
        let version = self.version;
        if self.pieces.as_ref().is_none_or(|(of, _)| *of != version) {
            self.pieces = Some((version, self.view.pieces()));
        }
        self.pieces.as_ref().and_then(|(_, scene)| scene.as_ref())
    }

    /// Whether the pieces of the mesh are there; they are where they were shown.
    pub(crate) fn has_pieces(&self) -> bool {
        self.pieces.as_ref().is_some_and(|(_, scene)| scene.is_some())
    }

    /// Boundary, edges of many triangles and cracks, found once for each mesh in O(input).
    pub fn edges(&mut self) -> &[Segment] {
        let version = self.version;
        if self.edges.as_ref().is_none_or(|(of, _)| *of != version) {
            let boundary = self.view.boundary();
            let which = boundary.as_ref().map_or(Edges::Boundary, Edges::Cracks);
            let mut scene = Scene { origin: self.view.places().origin(), ..Scene::default() };
            scene.add_edges(self.view.positions(), &self.cells(), which);
            self.edges = Some((version, scene.marks));
        }
        self.edges.as_ref().map_or(&[], |(_, edges)| edges)
    }

    /// The triangles of the mesh.
    pub fn cells(&self) -> Vec<Cell<3>> {
        self.view.places().triangles().map(|(placed, _)| placed.corners).collect()
    }
}
