//! A pane: a view of one of the models under one choice of operator and dependency, and the next one while it is made.

use crate::ask::{Ask, Asked, Extent};
use crate::play::{Picked, Play};
use mt_core::Camera;
use mt_core::log::{Log, LogError};
use papers::study::DependencyKind;
use render::Scene;
use selective::Outcome;
use std::sync::Arc;
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

/// One of the models that the window is about.
#[derive(Clone)]
pub struct Subject {
    /// Its name.
    pub name: String,
    /// What criteria need to know of it.
    pub extent: Extent,
    /// How it came.
    pub choice: Choice,
    /// What it was coarsened by, where that is known.
    pub made_by: String,
}

/// Makes a view of a model under a choice, or says in one line why not. May take long; it is called on a thread of its own.
pub type Make = Arc<dyn Fn(usize, &Choice) -> Result<Box<dyn Play>, String> + Send + Sync>;

/// A view that is being made.
struct Waiting {
    choice: Choice,
    since: Instant,
    heard: Receiver<Result<Box<dyn Play>, String>>,
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

/// A pane.
pub struct Pane {
    /// Which of the models.
    pub model: usize,
    /// What the view that is shown was made by.
    pub choice: Choice,
    /// The view that is shown.
    pub play: Box<dyn Play>,
    waiting: Option<Waiting>,
    /// The last frame.
    pub facts: FrameFacts,
    /// What was pointed at.
    pub picked: Option<Picked>,
    /// Whether the mesh is held somewhere in its log, instead of following the eye.
    pub is_held: bool,
    /// Whether the view is another one than in the last frame.
    pub is_fresh: bool,
    /// What the mesh was last made for; nothing where it has to be made anew.
    made_for: Option<(Ask, Camera)>,
    /// Goes up whenever the mesh changes.
    version: u64,
    pieces: Option<Pieces>,
}

/// The dual pieces of one mesh of a pane.
pub struct Pieces {
    /// The version of the mesh that they are of.
    pub version: u64,
    /// Their triangles and lines; nothing where the model has no pieces.
    pub scene: Option<Scene>,
}

impl Pane {
    /// Of a view that is there.
    pub fn new(model: usize, choice: Choice, play: Box<dyn Play>) -> Self {
        Self {
            model,
            choice,
            play,
            waiting: None,
            facts: FrameFacts::default(),
            picked: None,
            is_held: false,
            is_fresh: true,
            made_for: None,
            version: 0,
            pieces: None,
        }
    }

    /// The dual pieces of the mesh as it is, found once for each mesh. O(input).
    pub fn pieces(&mut self) -> &Pieces {
        let Self { play, version, pieces, .. } = self;
        if pieces.as_ref().is_none_or(|pieces| pieces.version != *version) {
            *pieces = None;
        }
        pieces.get_or_insert_with(|| Pieces { version: *version, scene: play.pieces() })
    }

    /// What was chosen, whether it is there already or not.
    pub fn chosen(&self) -> &Choice {
        self.waiting.as_ref().map_or(&self.choice, |waiting| &waiting.choice)
    }

    /// How long the next view has been in the making.
    pub fn waits(&self) -> Option<Duration> {
        self.waiting.as_ref().map(|waiting| waiting.since.elapsed())
    }

    /// Has the view of another choice made. What is being made already is forgotten.
    pub fn choose(&mut self, choice: Choice, make: &Make) {
        if *self.chosen() == choice {
            return;
        }
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
        (self.play, self.choice) = (heard?, choice);
        (self.is_fresh, self.is_held, self.made_for, self.picked) = (true, false, None, None);
        self.version += 1;
        Ok(())
    }

    /// Brings the mesh to what is asked, unless it is there or held; whether anything was done.
    pub fn adapt(&mut self, ask: &Ask, asked: &Asked, camera: &Camera) -> bool {
        // A moving camera asks for less than one at rest, and what ran out of time goes on.
        let is_still = self.made_for == Some((*ask, *camera)) && self.facts.outcome.complete;
        if self.is_held || is_still {
            self.facts.adapt = Duration::ZERO;
            self.facts.outcome = Outcome { complete: true, ..Outcome::default() };
            return false;
        }
        let begun = Instant::now();
        let outcome = self.play.adapt(asked);
        // A budget that is used up is not complete and never will be.
        let complete = outcome.complete || outcome.refined + outcome.coarsened == 0;
        self.version += u64::from(outcome.refined + outcome.coarsened > 0);
        let triangles = self.play.places().triangle_count() as u32;
        self.facts = FrameFacts { outcome: Outcome { complete, ..outcome }, adapt: begun.elapsed(), triangles };
        self.made_for = Some((*ask, *camera));
        true
    }

    /// Goes to another place in the log, by so many steps.
    pub fn step(&mut self, by: isize) {
        let at = self.play.at().saturating_add_signed(by);
        self.seek(at);
    }

    /// Goes to the end of the frame before, or of the next one.
    pub fn frame(&mut self, forward: bool) {
        let (at, ends) = (self.play.at(), &self.play.log().frame_ends);
        let to = if forward {
            ends.iter().copied().find(|&end| end > at).unwrap_or(at)
        } else {
            ends.iter().rev().copied().find(|&end| end < at).unwrap_or(0)
        };
        self.seek(to);
    }

    /// Goes to the end of the log, and on with the eye.
    pub fn go_on(&mut self) {
        self.seek(usize::MAX);
        self.is_held = false;
    }

    /// Takes another log for its own, and is held at its beginning.
    pub fn take_log(&mut self, log: Log) -> Result<(), LogError> {
        self.play.take_log(log)?;
        self.seek(0);
        Ok(())
    }

    /// Goes to where so many steps of the log are taken, and is held there.
    pub fn seek(&mut self, at: usize) {
        self.play.seek(at);
        self.is_held = true;
        self.facts.triangles = self.play.places().triangle_count() as u32;
        self.picked = None;
        self.made_for = None;
        self.version += 1;
    }
}
