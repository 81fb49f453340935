//! Where the models of the ledger come from, and the sequences that are made of them, each once.

use super::{Coding, LedgerError, Raster};
use mt_core::analysis::{Listener, Options, Stopped};
use mt_core::format::{self, Format, LoadOptions, NonManifold};
use mt_core::hierarchy::HierarchyError;
use mt_core::{Explicit, Mesh, MultiTessellation, Recorder, Replay, Sequence};
use operators::AnyOperator;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Where files of models are kept. Names are relative: `surfaces/horse.ply`.
pub trait Shelf {
    /// The bytes of a file; `None` where there is none. One that is there and cannot be read is an error.
    fn bytes(&mut self, file: &str) -> Result<Option<Vec<u8>>, LedgerError>;
}

/// Has nothing: everything is generated.
pub struct Bare;

impl Shelf for Bare {
    fn bytes(&mut self, _: &str) -> Result<Option<Vec<u8>>, LedgerError> {
        Ok(None)
    }
}

/// How large models may be.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Size {
    /// As they are.
    #[default]
    Full,
    /// Small generated ones, for tests.
    Small,
}

/// A model of a paper, and what stands for it here.
pub struct Role {
    /// What the paper calls it.
    pub name: &'static str,
    /// The file that stands for it.
    pub file: &'static str,
    /// How samples are read, where it is a grid of them.
    pub grid: Option<Grid>,
    /// What is generated where the file is not at hand; of two sizes.
    pub stand_in: fn(Size) -> Mesh<3>,
}

/// A grid of samples in a file.
#[derive(Copy, Clone, Debug)]
pub struct Grid {
    /// How they are told.
    pub coding: Coding,
    /// The part that is taken, as column, row, columns and rows.
    pub part: Option<[usize; 4]>,
}

/// A model as it is studied.
#[derive(Clone, Debug)]
pub struct Subject {
    /// What the paper calls it.
    pub name: &'static str,
    /// The file it is from, or that it is generated.
    pub from: String,
    /// The mesh.
    pub mesh: Mesh<3>,
}

impl Subject {
    /// One line for the ledger.
    pub fn told(&self) -> String {
        format!(
            "{}: {}, {} vertices, {} triangles",
            self.name,
            self.from,
            self.mesh.vertex_count(),
            self.mesh.cell_count()
        )
    }

    /// Without a modification there is nothing to measure.
    fn check_coarsened(&self, empty: bool) -> Result<(), LedgerError> {
        if empty {
            Err(LedgerError::Model(self.from.clone(), "there is nothing to coarsen in it".to_owned()))
        } else {
            Ok(())
        }
    }
}

/// A sequence of merges, and what making it took.
#[derive(Clone, Debug)]
pub struct Sequenced {
    /// The merges.
    pub replay: Arc<Replay>,
    /// Wall seconds of the analysis.
    pub seconds: f64,
    /// Wall seconds of deriving the replay.
    pub seconds_replay: f64,
}

/// Gives out models and sequences, and hears whether to go on.
pub struct Workshop<'a> {
    /// How large generated models are.
    pub size: Size,
    shelf: &'a mut dyn Shelf,
    watch: &'a mut dyn FnMut(&str, f32) -> bool,
    share: f32,
    subjects: BTreeMap<String, Arc<Subject>>,
    sequences: BTreeMap<String, Sequenced>,
    explicit: BTreeMap<String, Arc<Explicit<3>>>,
}

impl<'a> Workshop<'a> {
    /// An empty workshop. `watch` hears what is being done and how much of the whole is, and answers whether to go on.
    pub fn new(size: Size, shelf: &'a mut dyn Shelf, watch: &'a mut dyn FnMut(&str, f32) -> bool) -> Self {
        let (subjects, sequences, explicit) = Default::default();
        Self { size, shelf, watch, share: 0.0, subjects, sequences, explicit }
    }

    /// So much of the whole is done.
    pub(super) fn at(&mut self, share: f32) {
        self.share = share;
    }

    /// Forgets what was made of models, which is most of the memory.
    pub(super) fn clear(&mut self) {
        self.subjects.clear();
        self.sequences.clear();
        self.explicit.clear();
    }

    /// Goes on, unless somebody asked to stop.
    pub fn go_on(&mut self, what: &str) -> Result<(), LedgerError> {
        if (self.watch)(what, self.share) { Ok(()) } else { Err(LedgerError::Cancelled) }
    }

    /// Of two numbers the one for this size.
    pub fn pick<T>(&self, full: T, small: T) -> T {
        if self.size == Size::Small { small } else { full }
    }

    /// The grid of samples in a file, if it is at hand, and where it is from.
    pub fn raster(&mut self, file: &str, grid: &Grid) -> Result<Option<(Raster, String)>, LedgerError> {
        let Some(bytes) = self.file(file)? else { return Ok(None) };
        let wrong = |error| LedgerError::Model(file.to_owned(), format!("{error}"));
        let whole = Raster::read(&bytes, grid.coding).map_err(wrong)?;
        Ok(Some(match grid.part {
            None => (whole, file.to_owned()),
            Some([x, y, columns, rows]) => {
                (whole.crop(x, y, columns, rows), format!("{columns} x {rows} samples of {file} from {x}, {y}"))
            }
        }))
    }

    fn file(&mut self, file: &str) -> Result<Option<Vec<u8>>, LedgerError> {
        if self.size == Size::Small { Ok(None) } else { self.shelf.bytes(file) }
    }

    /// The model that stands for one of a paper, its sheets separated where it is no manifold.
    pub fn subject(&mut self, role: &Role) -> Result<Arc<Subject>, LedgerError> {
        self.load(role, NonManifold::Split)
    }

    /// The same, as it is.
    pub fn subject_unsplit(&mut self, role: &Role) -> Result<Arc<Subject>, LedgerError> {
        self.load(role, NonManifold::Keep)
    }

    fn load(&mut self, role: &Role, non_manifold: NonManifold) -> Result<Arc<Subject>, LedgerError> {
        let key = format!("{} {} {:?} {non_manifold:?}", role.name, role.file, role.grid);
        if let Some(subject) = self.subjects.get(&key) {
            return Ok(Arc::clone(subject));
        }
        self.go_on(role.name)?;
        let (mesh, from) = self.mesh(role, non_manifold)?;
        let subject = Arc::new(Subject { name: role.name, from, mesh });
        self.subjects.insert(key, Arc::clone(&subject));
        Ok(subject)
    }

    fn mesh(&mut self, role: &Role, non_manifold: NonManifold) -> Result<(Mesh<3>, String), LedgerError> {
        let generated = |size| ((role.stand_in)(size), "generated".to_owned());
        if let Some(grid) = &role.grid {
            let found = self.raster(role.file, grid)?;
            return Ok(found.map_or_else(|| generated(self.size), |(raster, from)| (raster.terrain(), from)));
        }
        let ending = role.file.rsplit('.').next().unwrap_or("");
        let format = Format::from_extension(ending)
            .ok_or_else(|| LedgerError::Data(format!("{}: no format of meshes", role.file)))?;
        let Some(bytes) = self.file(role.file)? else { return Ok(generated(self.size)) };
        let options = LoadOptions { non_manifold, ..LoadOptions::default() };
        let (mesh, _) = format::read(format, &bytes, &options, &|_| None)
            .map_err(|error| LedgerError::Model(role.file.to_owned(), error.to_string()))?;
        Ok((mesh, role.file.to_owned()))
    }

    /// The sequence that an operator makes of a model, to the end; made once.
    pub fn sequence(&mut self, subject: &Subject, operator: &AnyOperator) -> Result<Sequenced, LedgerError> {
        let key = key(subject, operator);
        if let Some(sequence) = self.sequences.get(&key) {
            return Ok(sequence.clone());
        }
        let mut sequence = Sequence::new(&subject.mesh);
        let seconds = self.analyse(subject, operator, &mut sequence)?;
        let begun = Instant::now();
        let replay = Replay::new(&subject.mesh, &operator.links(&subject.mesh), &sequence)
            .map_err(|error| LedgerError::Hierarchy(subject.name.to_owned(), HierarchyError::from(error)))?;
        subject.check_coarsened(replay.is_empty())?;
        let made = Sequenced { replay: Arc::new(replay), seconds, seconds_replay: begun.elapsed().as_secs_f64() };
        self.sequences.insert(key, made.clone());
        Ok(made)
    }

    /// The explicit model that an operator makes of a model; made once.
    pub fn explicit(&mut self, subject: &Subject, operator: &AnyOperator) -> Result<Arc<Explicit<3>>, LedgerError> {
        let key = key(subject, operator);
        if let Some(model) = self.explicit.get(&key) {
            return Ok(Arc::clone(model));
        }
        let failed = |error| LedgerError::Analysis(subject.name.to_owned(), error);
        let mut recorder = Recorder::new(&subject.mesh).map_err(|error| failed(error.into()))?;
        self.analyse(subject, operator, &mut recorder)?;
        let model = Arc::new(recorder.finish(Default::default()).map_err(|error| failed(error.into()))?);
        subject.check_coarsened(model.is_empty())?;
        self.explicit.insert(key, Arc::clone(&model));
        Ok(model)
    }

    /// Tells `listener` of an analysis; the seconds that it took.
    fn analyse(
        &mut self,
        subject: &Subject,
        operator: &AnyOperator,
        listener: &mut impl Listener<3>,
    ) -> Result<f64, LedgerError> {
        let what = format!("{}: {}", subject.name, operator.name());
        self.go_on(&what)?;
        let begun = Instant::now();
        let ended = operator
            .analyse(&subject.mesh, &Options::default(), listener, &mut |_| (self.watch)(&what, self.share))
            .map_err(|error| LedgerError::Analysis(subject.name.to_owned(), error))?;
        if ended.stopped == Stopped::Cancelled {
            Err(LedgerError::Cancelled)
        } else {
            Ok(begun.elapsed().as_secs_f64())
        }
    }
}

fn key(subject: &Subject, operator: &AnyOperator) -> String {
    format!("{} {} {} {operator:?}", subject.name, subject.from, subject.mesh.cell_count())
}
