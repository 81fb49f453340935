//! How commands coarsen a mesh: as a whole, or a large one region by region, with a bar and an ear for Ctrl-C.

use crate::commands::CommandError;
use crate::files::FileError;
use crate::memory;
use crate::progress::{Progress, interrupted, spinning};
use mt_core::analysis::{AnalysisError, Ended, Options, RegionListener, Regions, Stopped, Unfit};
use mt_core::{ErrorKind, Mesh, Replay, Sequence};
use operators::AnyOperator;
use std::path::Path;

/// What coarsens a mesh, and how.
pub struct Coarsening {
    pub operator: AnyOperator,
    pub options: Options,
    /// The regions it goes by, if it does.
    pub regions: Option<Regions>,
}

impl Coarsening {
    /// To the end, by `operator`, as is usual for such a mesh.
    pub fn usual(mesh: &Mesh<3>, operator: &AnyOperator) -> Self {
        let options = Options::default();
        let regions = usual_regions(mesh, operator, &options, 0);
        Self { operator: operator.clone(), options, regions }
    }

    /// Refuses to begin what is expected to take more memory than there is; `keeps_cells` as an explicit model does.
    pub fn check_memory(&self, path: &Path, mesh: &Mesh<3>, keeps_cells: bool) -> Result<(), CommandError> {
        let bytes = memory::of_coarsening(mesh.cell_count(), self.regions.is_some(), keeps_cells);
        let what = format!("coarsening {} triangles", mesh.cell_count());
        memory::allow(&what, bytes).map_err(|error| FileError::new(path, error).into())
    }

    /// Coarsens the mesh in this file, and tells `listener`.
    pub fn run(
        &self,
        path: &Path,
        mesh: &Mesh<3>,
        listener: &mut impl RegionListener<3>,
    ) -> Result<Ended, CommandError> {
        let Self { operator, options, regions } = self;
        let mut progress = Progress::new("coarsening", mesh.cell_count() as u64);
        let mut watch = |at: mt_core::analysis::Progress| progress.at((at.cells_in - at.cells) as u64);
        let ended = match regions {
            Some(regions) => operator.analyse_by_regions(mesh, options, regions, listener, &mut watch),
            None => operator.analyse(mesh, options, listener, &mut watch),
        };
        let ended = ended.map_err(|error| explain(path, error))?;
        let cut_short = ended.stopped == Stopped::Cancelled || interrupted();
        if cut_short { Err(CommandError::Interrupted) } else { Ok(ended) }
    }
}

/// From here on this process works on so many threads, 0 for as many as there are cores.
pub fn use_threads(threads: usize) -> Result<(), CommandError> {
    let made = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    made.map_err(|error| CommandError::Other(format!("no threads: {error}")))
}

/// Meshes of so many triangles are coarsened region by region, if nothing else is said. On the armadillo, of twice as many, that
/// takes two thirds to four fifths of the time, by quadrics as by the metric of Lindstrom and Turk, at the same root mean square.
const LARGE: usize = 40_000;

/// Whether a mesh of so many triangles is usually coarsened by regions.
pub fn go_by_regions(operator: &AnyOperator, triangles: usize) -> bool {
    triangles >= LARGE && operator.works_by_regions()
}

/// The regions that such a mesh is usually coarsened by, if any.
pub fn usual_regions(mesh: &Mesh<3>, operator: &AnyOperator, options: &Options, threads: usize) -> Option<Regions> {
    let measured = options.error_kind == ErrorKind::Measured;
    (go_by_regions(operator, mesh.cell_count()) && !measured).then(|| Regions { threads, ..Regions::default() })
}

/// An analysis of this file that failed, with the way out where there is one.
pub fn explain(path: &Path, error: AnalysisError) -> CommandError {
    let way_out = match error {
        AnalysisError::Unfit(Unfit::NonManifold { .. }) => {
            "; --non-manifold split separates the sheets, --operator vertex-pair takes the mesh as it is"
        }
        _ => "",
    };
    FileError::new(path, format!("{error}{way_out}")).into()
}

/// Coarsens a mesh and keeps its merges; with the input numbered as it came.
pub fn replay_of(path: &Path, mesh: &Mesh<3>, operator: &AnyOperator) -> Result<Replay, CommandError> {
    let mut sequence = Sequence::new(mesh);
    let coarsening = Coarsening::usual(mesh, operator);
    coarsening.check_memory(path, mesh, false)?;
    coarsening.run(path, mesh, &mut sequence)?;
    let replay = spinning("replaying", || Replay::new(mesh, &operator.links(mesh), &sequence));
    replay.map_err(|error| FileError::new(path, error).into())
}
