//! `mtess bisect`: the first step at which something goes wrong, along a log of steps or a camera path.

use super::{CommandError, print_json, print_text};
use crate::files::{self, FileError, Model};
use crate::progress::{Progress, interrupted};
use crate::selection;
use crate::subject::Subject;
use clap::Args;
use mt_core::check::{Breach, Law, Random};
use mt_core::log::{Log, Timeline, bisect};
use mt_core::mesh::area_vector;
use mt_core::model::{MultiTessellation, cells_of, mesh_of};
use mt_core::{Bound, CellId, Mesh, cell};
use multi_tessellation::verify::{self, Summary};
use selective::{Limits, ScreenError, State, adapt};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;

#[derive(Args)]
pub struct Bisect {
    #[command(flatten)]
    subject: Subject,
    /// What must hold: `crack` (no cracks), `fold` or `fold=DEGREES` (no edge folded by more, 160 by default), `law` (every
    /// law at that front), `cells=N` (at most so many cells)
    #[arg(long, value_name = "WHAT", default_value = "crack")]
    holds: Predicate,
    /// The log to walk along
    #[arg(long, value_name = "FILE.steps", conflicts_with_all = ["cameras", "frames"])]
    log: Option<PathBuf>,
    /// The cameras to adapt to, one frame each: a JSON list of cameras
    #[arg(long, value_name = "FILE.json", conflicts_with = "frames")]
    cameras: Option<PathBuf>,
    /// Without --log and --cameras: frames of a path once around the model
    #[arg(long, value_name = "N", default_value_t = 60)]
    frames: u32,
    /// Largest error on the screen along a camera path, in pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    pixels: f32,
    /// Look after every step, not only after frames and by halving: slow, and sure to find the first
    #[arg(long)]
    every: bool,
    /// Write the log of the camera path here
    #[arg(long, value_name = "FILE.steps", conflicts_with = "log")]
    record: Option<PathBuf>,
    /// Write the mesh before and after the step here, as NAME-before.obj and NAME-after.obj
    #[arg(short, long, value_name = "NAME")]
    output: Option<PathBuf>,
    /// As JSON
    #[arg(long)]
    json: bool,
}

/// What must hold.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Predicate {
    Crack,
    Fold { degrees: f64 },
    Law,
    Cells { most: u32 },
}

impl FromStr for Predicate {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').map_or((text, None), |(name, value)| (name, Some(value)));
        let number = |value: &str| value.parse::<f64>().map_err(|_| format!("'{value}' is not a number"));
        match (name, value) {
            ("crack", None) => Ok(Self::Crack),
            ("law", None) => Ok(Self::Law),
            ("fold", None) => Ok(Self::Fold { degrees: 160.0 }),
            ("fold", Some(value)) => match number(value)? {
                degrees if (0.0..180.0).contains(&degrees) => Ok(Self::Fold { degrees }),
                degrees => Err(format!("{degrees} is no angle of a fold: 0 is flat, 180 folded back")),
            },
            ("cells", Some(value)) => {
                value.parse().map(|most| Self::Cells { most }).map_err(|_| format!("'{value}' is no number of cells"))
            }
            _ => Err(format!("there is no `{text}`; there are crack, fold, fold=DEGREES, law and cells=N")),
        }
    }
}

/// A step after which something does not hold.
struct Fault {
    /// Steps taken by then.
    at: usize,
    breach: Breach,
    before: Option<Mesh<3>>,
    after: Mesh<3>,
}

impl Bisect {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        if self.pixels.is_nan() || self.pixels < 0.0 {
            return Err(CommandError::Other("--pixels must be a number, 0 or more".into()));
        }
        for place in self.record.iter().chain(&self.output) {
            files::check_place(place)?;
        }
        match self.subject.load()? {
            Model::Triangles(model) => self.on(&*model),
            Model::Tetrahedra(_) => Err(files::no_triangles(self.subject.path()).into()),
            Model::Hierarchy { replay, scheme } => scheme
                .visit(&replay, Walk(&self))
                .map_err(|error| CommandError::File(FileError::new(self.subject.path(), error)))?,
        }
    }

    fn on<M: MultiTessellation<3, Bound = Bound>>(&self, model: &M) -> Result<ExitCode, CommandError> {
        let log = match &self.log {
            Some(path) => {
                let log = Log::read(files::open_lines(path)?).map_err(|error| FileError::new(path, error))?;
                log.follow(model).map_err(|error| FileError::new(path, error))?;
                log
            }
            None => self.recorded(model)?,
        };
        if let Some(path) = &self.record {
            let mut text = Vec::new();
            log.write(&mut text).expect("memory takes it");
            files::write_bytes(path, &text)?;
        }
        let fault = self.first_fault(model, &log)?;
        if let (Some(stem), Some(fault)) = (&self.output, &fault) {
            let path = |what: &str| PathBuf::from(format!("{}-{what}.obj", stem.display()));
            if let Some(before) = &fault.before {
                files::write_mesh(&path("before"), before)?;
            }
            files::write_mesh(&path("after"), &fault.after)?;
        }
        Ok(self.tell(&log, fault.as_ref()))
    }

    /// The log of a camera path.
    fn recorded<M: MultiTessellation<3, Bound = Bound>>(&self, model: &M) -> Result<Log, CommandError> {
        let cameras = selection::cameras(self.cameras.as_deref(), self.frames, model.positions())?;
        let mut log = Log::new(model.len());
        let mut state = State::new(model, ());
        let mut progress = Progress::new("adapting", cameras.len() as u64);
        for (i, camera) in cameras.iter().enumerate() {
            if !progress.at(i as u64) {
                return Err(CommandError::Interrupted);
            }
            adapt(model, &ScreenError::new(camera, self.pixels), &Limits::NONE, &mut state);
            log.push(&state.steps);
            state.steps.clear();
        }
        Ok(log)
    }

    /// The first frame after which something does not hold, and of its steps the first; or every step, as asked.
    fn first_fault<M: MultiTessellation<3, Bound = Bound>>(
        &self,
        model: &M,
        log: &Log,
    ) -> Result<Option<Fault>, CommandError> {
        let judge = Judge::new(model, self.holds)?;
        let mut timeline = Timeline::new(model, &log.steps);
        let mut progress = Progress::new("looking", log.steps.len() as u64);
        let mut begun = 0;
        let looks: Vec<usize> = match self.every {
            true => (0..=log.steps.len()).collect(),
            false => std::iter::once(0).chain(log.frame_ends.iter().copied()).collect(),
        };
        for end in looks {
            if !progress.at(end as u64) || interrupted() {
                return Err(CommandError::Interrupted);
            }
            timeline.seek(end, &mut ());
            if judge.breach(&mut timeline).is_some() {
                let at = bisect(begun, end, |at| {
                    timeline.seek(at, &mut ());
                    judge.breach(&mut timeline).is_none()
                });
                let at = at.expect("it does not hold at the end");
                timeline.seek(at, &mut ());
                let breach = judge.breach(&mut timeline).expect("the same place gives the same answer");
                let after = mesh_of(model, &timeline.view().mesh);
                let before = (at > 0).then(|| {
                    timeline.seek(at - 1, &mut ());
                    mesh_of(model, &timeline.view().mesh)
                });
                return Ok(Some(Fault { at, breach, before, after }));
            }
            begun = end;
        }
        Ok(None)
    }

    fn tell(&self, log: &Log, fault: Option<&Fault>) -> ExitCode {
        let (steps, frames) = (log.steps.len(), log.frame_ends.len());
        let Some(fault) = fault else {
            if self.json {
                print_json(&json!({ "holds": true, "steps": steps, "frames": frames, "every": self.every }));
            } else {
                let looked = if self.every { "step" } else { "frame" };
                print_text(&format!("holds after every {looked}: {steps} steps in {frames} frames"));
            }
            return ExitCode::SUCCESS;
        };
        let step = fault.at.checked_sub(1).map(|at| (log.steps[at], log.frame_of(at)));
        if self.json {
            print_json(&json!({
                "holds": false, "steps": steps, "frames": frames, "every": self.every, "at": fault.at,
                "node": step.map(|(step, _)| step.node), "refined": step.map(|(step, _)| step.refined),
                "frame": step.map(|(_, frame)| frame), "law": fault.breach.law, "what": fault.breach.what,
                "cells": fault.after.cell_count(),
            }));
        }
        let place = match step {
            Some((step, frame)) => {
                let what = if step.refined { "refining" } else { "coarsening" };
                format!("step {} of {steps}, {what} node {} in frame {frame}", fault.at - 1, step.node)
            }
            None => "the base mesh, before any step".to_owned(),
        };
        eprintln!("error: {}: {place}: {}", self.subject.path().display(), fault.breach.what);
        ExitCode::FAILURE
    }
}

/// Walks along a hierarchy, whatever its dependencies.
struct Walk<'a>(&'a Bisect);

impl operators::order::Visit for Walk<'_> {
    type Output = Result<ExitCode, CommandError>;
    fn visit<D: mt_core::hierarchy::Dependency + Send>(self, model: &mt_core::Hierarchy<D>) -> Self::Output {
        self.0.on(model)
    }
}

/// Judges views of a model by a predicate.
struct Judge<'a, M> {
    model: &'a M,
    predicate: Predicate,
    laws: Option<verify::Laws<'a, 3, M>>,
}

impl<'a, M: MultiTessellation<3, Bound = Bound>> Judge<'a, M> {
    fn new(model: &'a M, predicate: Predicate) -> Result<Self, CommandError> {
        let wanted = matches!(predicate, Predicate::Crack | Predicate::Law);
        let laws = wanted.then(|| verify::Laws::new(model, &verify::Options::default(), &mut Summary::new()));
        let laws = laws.transpose().map_err(|breach| {
            CommandError::Other(format!("the model as a whole is wrong, at no step in particular: {breach}"))
        })?;
        Ok(Self { model, predicate, laws })
    }

    fn breach(&self, timeline: &mut Timeline<3, M>) -> Option<Breach> {
        let breach = |what: String| Breach { law: Law::CrackFree, what, node: None };
        match (self.predicate, &self.laws) {
            (Predicate::Crack, Some(laws)) => laws.is_a_mesh(timeline.view()).err(),
            (Predicate::Law, Some(laws)) => {
                let mut random = Random::new(timeline.at() as u64);
                laws.at(timeline.view_mut(), &mut random, &mut Summary::new()).err()
            }
            (Predicate::Cells { most }, _) => {
                let count = self.model.cell_count(&timeline.view().mesh);
                (count > most).then(|| breach(format!("{count} cells, more than {most}")))
            }
            (Predicate::Fold { degrees }, _) => {
                let (edge, angle) = sharpest_fold(self.model, timeline)?;
                let what =
                    || format!("the edge of vertices {} and {} is folded by {angle:.1} degrees", edge[0], edge[1]);
                (angle > degrees).then(|| breach(what()))
            }
            _ => None,
        }
    }
}

/// The edge of two triangles at which the normals differ most, and the angle between them in degrees.
fn sharpest_fold<M: MultiTessellation<3, Bound = Bound>>(
    model: &M,
    timeline: &Timeline<3, M>,
) -> Option<([u32; 2], f64)> {
    let cells: Vec<(CellId, cell::Cell<3>)> = cells_of(model, &timeline.view().mesh);
    let mut sides: BTreeMap<[u32; 2], Vec<glam::DVec3>> = BTreeMap::new();
    for (_, corners) in &cells {
        let normal = area_vector(corners.map(|v| model.positions()[v.index()].as_dvec3()));
        // Without an area there is no way it faces.
        let Some(normal) = normal.try_normalize() else { continue };
        for (facet, _) in cell::facets(corners) {
            let ends = facet.vertices();
            sides.entry([ends[0].0, ends[1].0]).or_default().push(normal);
        }
    }
    let folds = sides.into_iter().filter_map(|(edge, normals)| match normals[..] {
        [a, b] => Some((edge, a.angle_between(b).to_degrees())),
        _ => None,
    });
    folds.max_by(|a, b| a.1.total_cmp(&b.1))
}
