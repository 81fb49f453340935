//! A sequence of merges by its definition: each vertex of the input stands under the last of its ancestors that is there,
//! and the mesh is what is left of the input's triangles.

use mt_core::{Cell, CellId, Mesh, Sequence, VertexId};

/// A sequence of merges of a mesh, vertex by vertex.
#[derive(Clone, Debug, Default)]
pub struct Merges {
    /// The input's triangles.
    pub cells: Vec<Cell<3>>,
    /// The edges by which vertices are neighbours besides triangles.
    pub links: Vec<Cell<2>>,
    /// Number of vertices of the input.
    pub leaves: usize,
    /// Of each vertex of the forest: the node at which it stops being one of its own.
    pub merged_at: Vec<Option<usize>>,
    /// Of each node: the vertex that it makes.
    pub vertex: Vec<usize>,
    /// Of each node: the two vertices that it makes one, the one that stays first.
    pub ends: Vec<[usize; 2]>,
    /// Of each node: whether the one that stays keeps its place and its own cells.
    pub kept: Vec<bool>,
    /// Of each node: the first and the last of its run.
    pub runs: Vec<(usize, usize)>,
    /// Of each node: the one above it.
    pub parent: Vec<Option<usize>>,
    /// Of each node: the triangles that die when it is coarsened, which appear when it is refined.
    pub born: Vec<Vec<usize>>,
}

impl Merges {
    /// Reads the sequence; what dies where is found by coarsening node after node.
    pub fn new(mesh: &Mesh<3>, links: &[Cell<2>], sequence: &Sequence) -> Self {
        let leaves = mesh.vertex_count();
        let count = sequence.node_count() as usize;
        let mut merges = Self {
            cells: mesh.cells.clone(),
            links: links.to_vec(),
            leaves,
            merged_at: vec![None; leaves + sequence.merge_count() as usize],
            ..Self::default()
        };
        for f in 0..sequence.merge_count() as usize {
            let (first, end) = (sequence.starts[f] as usize, sequence.starts[f + 1] as usize);
            let center = sequence.centers[f].index();
            merges.merged_at[center] = Some(first);
            for m in first..end {
                let child = sequence.children[m].index();
                merges.merged_at[child] = Some(m);
                merges.vertex.push(leaves + f);
                merges.ends.push([if m == first { center } else { leaves + f }, child]);
                merges.kept.push((f as u32) < sequence.kept.capacity() && sequence.kept.contains(f as u32));
                merges.runs.push((first, end - 1));
            }
        }
        let above = |m: usize| if m < merges.runs[m].1 { Some(m + 1) } else { merges.merged_at[merges.vertex[m]] };
        merges.parent = (0..count).map(above).collect();
        merges.born = vec![Vec::new(); count];
        let mut refined = vec![true; count];
        let mut before: Vec<usize> = (0..mesh.cells.len()).collect();
        for m in 0..count {
            refined[m] = false;
            let after: Vec<usize> = merges.at(&refined).cells.iter().map(|(cell, _)| *cell).collect();
            merges.born[m] = before.iter().copied().filter(|cell| !after.contains(cell)).collect();
            before = after;
        }
        merges
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.vertex.len()
    }

    /// Whether nothing is merged.
    pub fn is_empty(&self) -> bool {
        self.vertex.is_empty()
    }

    /// The nodes above a vertex of the input, lowest first.
    pub fn path(&self, leaf: usize) -> Vec<usize> {
        let mut path: Vec<usize> = self.merged_at[leaf].into_iter().collect();
        while let Some(next) = path.last().and_then(|&m| self.parent[m]) {
            path.push(next);
        }
        path
    }

    /// The mesh of a front, which has to have the parent of each of its nodes.
    pub fn at<'a>(&'a self, refined: &'a [bool]) -> Moment<'a> {
        let mut above: Vec<usize> = (0..self.leaves).collect();
        for v in &mut above {
            while let Some(m) = self.merged_at[*v].filter(|&m| !refined[m]) {
                *v = self.vertex[m];
            }
        }
        let cells = self.cells.iter().enumerate();
        let cells = cells.map(|(i, cell)| (i, cell.map(|leaf| above[leaf.index()])));
        let cells = cells.filter(|(_, [a, b, c])| a != b && b != c && c != a).collect();
        let links = self.links.iter().map(|link| link.map(|leaf| above[leaf.index()]));
        let links = links.filter(|[a, b]| a != b).collect();
        Moment { merges: self, refined, above, cells, links }
    }
}

/// The mesh of a front.
#[derive(Clone, Debug)]
pub struct Moment<'a> {
    merges: &'a Merges,
    refined: &'a [bool],
    /// Of each vertex of the input: which one stands for it.
    pub above: Vec<usize>,
    /// The triangles that are left, by number.
    pub cells: Vec<(usize, [usize; 3])>,
    /// The links that are left.
    pub links: Vec<[usize; 2]>,
}

impl Moment<'_> {
    /// The triangles, in the library's words.
    pub fn mesh(&self) -> Vec<(CellId, Cell<3>)> {
        self.cells.iter().map(|(cell, corners)| (CellId::new(*cell), corners.map(VertexId::new))).collect()
    }

    /// Who shares a triangle or a link with `v`; some more than once.
    pub fn ring(&self, v: usize) -> Vec<usize> {
        let faces = self.cells.iter().filter(|(_, corners)| corners.contains(&v)).flat_map(|(_, corners)| *corners);
        let links = self.links.iter().filter(|ends| ends.contains(&v)).flatten().copied();
        faces.chain(links).filter(|&w| w != v).collect()
    }

    /// Who is around the two ends of a node, themselves left out.
    pub fn around(&self, m: usize) -> Vec<usize> {
        let ends = self.merges.ends[m];
        ends.iter().flat_map(|&end| self.ring(end)).filter(|w| !ends.contains(w)).collect()
    }

    /// The nodes that made `v`: all of a merge, or the first few of a fan that is merged in part.
    fn makers(&self, v: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.merges.len()).filter(move |&m| self.merges.vertex[m] == v)
    }

    /// The last node that made `v` what it is; `None` for vertices of the input.
    pub fn latest(&self, v: usize) -> Option<usize> {
        self.makers(v).filter(|&m| !self.refined[m]).max()
    }

    /// The node at which `v` changes next when coarsening: the rest of its fan, or where it is merged.
    pub fn next(&self, v: usize) -> Option<usize> {
        self.makers(v).find(|&m| self.refined[m]).or(self.merges.merged_at[v])
    }
}
