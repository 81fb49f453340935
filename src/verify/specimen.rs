//! Meshes that trials are made on, drawn and shrunk by proptest.

use glam::Vec3;
use mt_core::analysis::{Operator, Options};
use mt_core::check::Random;
use mt_core::model::{MultiTessellation, Step, mesh_of, take};
use mt_core::{Mesh, generate};
use operators::EdgeCollapse;
use proptest::prelude::*;
use std::fmt;

/// What a generated mesh is made from; shrinks to the first kind, the smallest sizes and seed 0.
#[derive(Copy, Clone, PartialEq, Eq)]
pub struct Spec<const N: usize> {
    /// Which generator, modulo their number.
    pub kind: u8,
    /// Sizes, where the generator takes any.
    pub sizes: [u8; 2],
    /// Seed of noise, and of whatever is drawn for the case besides the mesh.
    pub seed: u16,
}

/// A generated mesh and its name.
#[derive(Clone, Debug)]
pub struct Specimen<const N: usize> {
    /// The generator with its sizes.
    pub name: String,
    /// The mesh.
    pub mesh: Mesh<N>,
}

/// Cells of which there are generators: triangles and tetrahedra.
pub trait Generated<const N: usize>: Sized {
    /// The mesh of a spec.
    fn specimen(spec: &Spec<N>) -> Specimen<N>;

    /// The same shape with about so many cells, for each of these numbers, by an operator that is trusted; nothing where
    /// there is no such, or it does not take the mesh.
    fn coarser(&self, cells: &[usize]) -> Vec<Self>;

    /// What is particular to this kind of cell: where the operator merges vertices, its hierarchies are judged.
    fn judge_merges<O: Operator<N>>(
        &self,
        operator: &O,
        options: &super::Options,
        tally: &mut super::Tally,
    ) -> Result<(), super::operators::Trouble<N>>;
}

/// A value that proptest draws: it says what it is, since files of seeds do.
pub(super) trait Drawn: fmt::Debug + Clone {}
impl<V: fmt::Debug + Clone> Drawn for V {}

/// Specs of meshes, for trials of one's own.
pub fn specimens<const N: usize>() -> impl Strategy<Value = Spec<N>> {
    // Small ones come up more often than a uniform draw would have it, and shrinking goes to 0.
    let size = || prop_oneof![3 => 0u8..6, 1 => 6u8..16];
    (0u8..18, size(), size(), any::<u16>()).prop_map(|(kind, m, n, seed)| Spec { kind, sizes: [m, n], seed })
}

impl<const N: usize> Spec<N> {
    /// The mesh of this spec.
    pub fn mesh(&self) -> Specimen<N>
    where
        Mesh<N>: Generated<N>,
    {
        Mesh::specimen(self)
    }
}

impl<const N: usize> fmt::Debug for Spec<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([m, n], corners) = (self.sizes, if N == 3 { "triangles" } else { "cells" });
        write!(f, "Spec {{ kind: {}, sizes: [{m}, {n}], seed: {} }} of {corners}", self.kind, self.seed)
    }
}

impl Generated<3> for Mesh<3> {
    fn specimen(spec: &Spec<3>) -> Specimen<3> {
        let ([m, n], seed) = (spec.sizes.map(usize::from), u64::from(spec.seed));
        let (name, mesh) = match spec.kind % 18 {
            0 => ("octahedron".to_owned(), generate::octahedron()),
            1 => ("icosahedron".to_owned(), generate::icosahedron()),
            2 => (format!("strip({})", m + 1), generate::strip(m + 1)),
            3 => (format!("grid({}, {})", m + 1, n + 1), generate::grid(m + 1, n + 1)),
            4 => ("triangle".to_owned(), generate::triangle()),
            5 => (format!("sphere({})", m / 6), generate::sphere(m as u32 / 6)),
            6 => (format!("annulus({}, {})", m + 3, n / 3 + 1), generate::annulus(m + 3, n / 3 + 1)),
            7 => (format!("cylinder({}, {})", m + 3, n + 1), generate::cylinder(m + 3, n + 1)),
            8 => (format!("sharp_box({})", m / 2 + 1), generate::sharp_box(m / 2 + 1)),
            9 => (format!("torus({}, {})", m + 3, n + 3), generate::torus(m + 3, n + 3)),
            10 => (format!("bumpy_grid({}, {})", m + 1, n + 1), generate::bumpy_grid(m + 1, n + 1, 1.5, seed)),
            11 => (format!("bumpy_sphere({})", 1 + m / 6), generate::bumpy_sphere(1 + m as u32 / 6, 0.3, seed)),
            12 => (format!("terrain({})", m + 1), generate::terrain(m + 1, 0.7, seed)),
            13 => ("slivers".to_owned(), generate::slivers(seed)),
            14 => (format!("genus_surface({}, 2)", m % 4), generate::genus_surface(m % 4, 2, 0.08, seed)),
            15 => {
                let parts = [generate::octahedron(), generate::grid(m + 1, n + 1)];
                (format!("octahedron + grid({}, {})", m + 1, n + 1), generate::components(&parts))
            }
            16 => ("tetrahedron".to_owned(), generate::tetrahedron()),
            _ => {
                let generate::Named { name, mesh } = generate::random_mesh(seed);
                (name, mesh)
            }
        };
        Specimen { name, mesh }
    }

    fn coarser(&self, cells: &[usize]) -> Vec<Self> {
        let analysis = mt_core::analysis::simplify(self, &EdgeCollapse::HALF, &Options::default(), &mut |_| true);
        let Ok(model) = analysis.map(|analysis| analysis.model) else { return Vec::new() };
        let mut view = model.base_view();
        let mut coarsest_first = (0..model.len()).rev().map(mt_core::NodeId).peekable();
        let mut meshes = Vec::new();
        for &wanted in cells {
            while model.cell_count(&view.mesh) < wanted as u32
                && let Some(m) = coarsest_first.next()
            {
                take(&model, Step::refine(m), &mut view, &mut ());
            }
            meshes.push(mesh_of(&model, &view.mesh));
        }
        meshes
    }

    fn judge_merges<O: Operator<3>>(
        &self,
        operator: &O,
        options: &super::Options,
        tally: &mut super::Tally,
    ) -> Result<(), super::operators::Trouble<3>> {
        super::operators::judge_merges(self, operator, options, tally)
    }
}

impl Generated<4> for Mesh<4> {
    fn specimen(spec: &Spec<4>) -> Specimen<4> {
        let n = 1 + usize::from(spec.sizes[0]) / 4;
        let mut mesh = generate::tetrahedral_box(n);
        if spec.kind.is_multiple_of(2) {
            return Specimen { name: format!("tetrahedral_box({n})"), mesh };
        }
        // Inner vertices move by less than turns any cell over.
        let (low, high) = mesh.bounding_box().expect("a box has vertices");
        let mut random = Random::new(u64::from(spec.seed));
        let reach = 0.1 * (high - low) / n as f32;
        for p in &mut mesh.positions {
            let inside = p.cmpgt(low).all() && p.cmplt(high).all();
            let way = Vec3::from_array([0; 3].map(|_: i32| random.between(-1.0, 1.0) as f32));
            *p += if inside { reach * way } else { Vec3::ZERO };
        }
        Specimen { name: format!("tetrahedral_box({n}), shaken"), mesh }
    }

    fn coarser(&self, _: &[usize]) -> Vec<Self> {
        Vec::new()
    }

    fn judge_merges<O: Operator<4>>(
        &self,
        _: &O,
        _: &super::Options,
        _: &mut super::Tally,
    ) -> Result<(), super::operators::Trouble<4>> {
        Ok(())
    }
}
