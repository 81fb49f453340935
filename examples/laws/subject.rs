//! What is drawn: a small flat sheet that is not too regular, its half-edge collapses, and views of them.

use crate::pen::{At, Ink, Panel};
use multi_tessellation::mt_core::analysis::{Options, analyse};
use multi_tessellation::mt_core::explicit::Alive;
use multi_tessellation::mt_core::model::{MultiTessellation, Step, View, cells_of, take};
use multi_tessellation::mt_core::random::Random;
use multi_tessellation::mt_core::{
    Cell, CellId, Explicit, Front, Mesh, NodeId, Recorder, Replay, Sequence, VertexId, generate,
};
use multi_tessellation::operators::EdgeCollapse;

/// A model of a sheet, told in both ways.
pub struct Subject {
    /// With cells.
    pub model: Explicit<3>,
    /// With merges.
    pub replay: Replay,
}

/// A cell with its id.
pub type Named = (CellId, Cell<3>);

/// Squares of the sheet, across and up.
const SQUARES: [usize; 2] = [5, 4];

fn sheet() -> Mesh<3> {
    let mut mesh = generate::grid(SQUARES[0], SQUARES[1]);
    let (low, high) = mesh.bounding_box().expect("a sheet");
    let mut random = Random::new(11);
    for p in &mut mesh.positions {
        // Sides stay straight: points on them slide.
        let free = [p.x > low.x && p.x < high.x, p.y > low.y && p.y < high.y];
        let step = (high - low) / glam::Vec3::new(SQUARES[0] as f32, SQUARES[1] as f32, 1.0);
        p.x += f32::from(free[0]) * step.x * random.between(-0.28, 0.28) as f32;
        p.y += f32::from(free[1]) * step.y * random.between(-0.28, 0.28) as f32;
    }
    mesh
}

impl Subject {
    /// Coarsens the sheet as far as it goes.
    pub fn new() -> Self {
        let mesh = sheet();
        // The last cells would leave a corner of the sheet uncovered.
        let options = Options { until_cells: Some(4), ..Options::default() };
        let mut listener = (Recorder::new(&mesh).expect("a mesh"), Sequence::new(&mesh));
        analyse(&mesh, &EdgeCollapse::HALF, &options, &mut listener, &mut |_| true).expect("a manifold");
        let model = listener.0.finish(Default::default()).expect("a history");
        let replay = Replay::new(&mesh, &[], &listener.1).expect("merges");
        Self { model, replay }
    }

    /// Where a vertex is drawn.
    pub fn at(&self, v: VertexId) -> At {
        place(self.model.positions()[v.index()])
    }

    /// The corners of a cell as they are drawn.
    pub fn corners(&self, cell: &Cell<3>) -> [At; 3] {
        cell.map(|v| self.at(v))
    }

    /// The view of a front: the least closed one with these nodes.
    pub fn view(&self, nodes: impl IntoIterator<Item = NodeId>) -> View<Alive> {
        let mut front = Front::from_nodes(self.model.len(), nodes);
        self.model.order().close(&mut front);
        let mut view = self.model.base_view();
        let finest_first: Vec<NodeId> = front.finest_first().collect();
        finest_first.iter().rev().for_each(|&m| take(&self.model, Step::refine(m), &mut view, &mut ()));
        view
    }

    /// The cells of a view.
    pub fn cells(&self, view: &View<Alive>) -> Vec<Named> {
        cells_of(&self.model, &view.mesh)
    }

    /// A node in the middle of the sheet, with many cells around it: the first with most of them.
    pub fn inner_node(&self) -> NodeId {
        let nodes = (0..self.model.len()).map(NodeId);
        nodes.min_by_key(|&m| (usize::MAX - self.model.fine_side(m).len().min(6), m)).expect("a sheet has nodes")
    }

    /// The view in which the fine side of a node is there: everything is refined that comes before it.
    pub fn just_refined(&self, m: NodeId) -> View<Alive> {
        self.view((m.0..self.model.len()).map(NodeId))
    }

    /// Cells of the coarse side, as they are told.
    pub fn coarse(&self, m: NodeId) -> Vec<Named> {
        self.model.coarse_side(m).map(|cell| (cell, *self.model.corners(cell))).collect()
    }

    /// Cells of the fine side.
    pub fn fine(&self, m: NodeId) -> Vec<Named> {
        self.model.fine_side(m).iter().map(|&cell| (cell, *self.model.corners(cell))).collect()
    }

    /// Draws cells; those that `spoken` names in their own ink.
    pub fn draw(&self, panel: &mut Panel, cells: &[Named], spoken: impl Fn(CellId) -> Option<Ink>) {
        for (id, cell) in cells {
            match spoken(*id) {
                Some(ink) => panel.area(&self.corners(cell), ink, 0.28),
                None => panel.area(&self.corners(cell), Ink::Plain, 0.04),
            }
        }
    }

    /// The edges that a set of cells has but once: its boundary.
    pub fn boundary(&self, cells: &[Named]) -> Vec<[At; 2]> {
        let edges = |cell: &Cell<3>| (0..3).map(|i| [cell[i], cell[(i + 1) % 3]]).collect::<Vec<_>>();
        let all: Vec<[VertexId; 2]> = cells.iter().flat_map(|(_, cell)| edges(cell)).collect();
        let once = all.iter().filter(|[a, b]| !all.contains(&[*b, *a]));
        once.map(|edge| edge.map(|v| self.at(v))).collect()
    }
}

/// A point of the sheet in a panel.
pub fn place(p: glam::Vec3) -> At {
    [p.x / SQUARES[0] as f32, p.y / SQUARES[1] as f32]
}

/// A length on the sheet in a panel, across and up.
pub fn length(length: f32) -> At {
    SQUARES.map(|squares| length / squares as f32)
}
