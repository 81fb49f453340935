//! Reads glTF 2.0, as JSON or binary: the triangles of the default scene, in world positions.
//!
//! The schema is `gltf`'s; the traversal and every access to a buffer are ours, since that crate
//! checks neither cycles of nodes nor the arithmetic of offsets, and rejects names it does not know.

mod accessor;
mod container;

use super::error::{Place, Problem, Refusal};
use super::soup::{Soup, index_of};
use accessor::Buffers;
use container::Container;
use glam::{Affine3A, Mat4, Quat, Vec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Root, scene::Node};
use rustc_hash::FxHashMap;

/// Finds the bytes of a buffer that lies in a file of its own, by the name that the model gives it.
pub(super) type Resolve<'a> = dyn Fn(&str) -> Option<Vec<u8>> + 'a;

/// Instances may repeat a mesh; beyond this many triangles a small file is refused instead of unfolded.
const FREE_TRIANGLES: usize = 1 << 20;
/// And beyond this many for each byte of the file and its buffers.
const TRIANGLES_PER_BYTE: usize = 4;

pub(super) fn read(bytes: &[u8], resolve: &Resolve<'_>) -> Result<Soup, Refusal> {
    let Container { json, binary } = container::split(bytes)?;
    let root: Root = gltf::json::deserialize::from_slice(json)
        .map_err(|error| Refusal::malformed(Place::Line(error.line()), format!("the JSON is not glTF: {error}")))?;
    refuse_extensions(&root)?;
    let mut reader = Reader {
        buffers: Buffers::new(&root, binary, resolve),
        root: &root,
        soup: Soup::default(),
        other_modes: 0,
        file_bytes: bytes.len(),
    };
    for (node, world) in placed_nodes(&root)? {
        reader.read_node(node, world)?;
    }
    let Reader { mut soup, other_modes, .. } = reader;
    if other_modes > 0 {
        soup.left.other_elements += other_modes;
        soup.notes.push(format!("{other_modes} primitives of points or lines left out"));
    }
    note_ignored(&root, &mut soup);
    Ok(soup)
}

/// Required extensions that say nothing about where triangles are.
fn harmless(extension: &str) -> bool {
    const PREFIXES: [&str; 6] =
        ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "KHR_xmp"];
    extension == "KHR_mesh_quantization" || PREFIXES.iter().any(|prefix| extension.starts_with(prefix))
}

fn refuse_extensions(root: &Root) -> Result<(), Refusal> {
    match root.extensions_required.iter().find(|name| !harmless(name)) {
        Some(name) => Err(Refusal::new(Place::File, Problem::Unsupported(format!("the required extension {name}")))),
        None => Ok(()),
    }
}

fn note_ignored(root: &Root, soup: &mut Soup) {
    let morphs = root.meshes.iter().flat_map(|mesh| &mesh.primitives).filter(|p| p.targets.is_some()).count();
    let ignored =
        [(root.skins.len(), "skins"), (morphs, "primitives' morph targets"), (root.animations.len(), "animations")];
    for (count, what) in ignored.into_iter().filter(|ignored| ignored.0 > 0) {
        soup.notes.push(format!("{count} {what} ignored: the mesh is in its rest pose"));
    }
}

/// The nodes of the default scene (the first if none is named, all roots if there is no scene) and their places in the world.
fn placed_nodes(root: &Root) -> Result<Vec<(usize, Affine3A)>, Refusal> {
    let scene = root.scene.map_or(0, |scene| scene.value());
    let roots: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        None if root.scene.is_some() => return Err(missing("scene", scene)),
        None => top_nodes(root),
    };
    let mut stack: Vec<(usize, Affine3A)> = roots.into_iter().rev().map(|node| (node, Affine3A::IDENTITY)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((index, parent)) = stack.pop() {
        let node = root.nodes.get(index).ok_or_else(|| missing("node", index))?;
        if std::mem::replace(&mut seen[index], true) {
            return Err(Refusal::malformed(
                Place::Item("node", index),
                "the node has two parents or is its own ancestor",
            ));
        }
        let world = parent * local_transform(node);
        placed.push((index, world));
        let children = node.children.as_deref().unwrap_or_default();
        stack.extend(children.iter().rev().map(|child| (child.value(), world)));
    }
    Ok(placed)
}

fn top_nodes(root: &Root) -> Vec<usize> {
    let mut top = vec![true; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(top) = top.get_mut(child.value()) {
            *top = false;
        }
    }
    (0..root.nodes.len()).filter(|&node| top[node]).collect()
}

fn local_transform(node: &Node) -> Affine3A {
    if let Some(matrix) = &node.matrix {
        return Affine3A::from_mat4(Mat4::from_cols_array(matrix));
    }
    let scale = Vec3::from_array(node.scale.unwrap_or([1.0; 3]));
    let rotation = node.rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_array(rotation.0));
    let translation = Vec3::from_array(node.translation.unwrap_or_default());
    // Files round their quaternions, and hostile ones hold none: make it a rotation first.
    let length = rotation.length();
    let rotation = if length > 0.0 && length.is_finite() { rotation / length } else { Quat::IDENTITY };
    Affine3A::from_scale_rotation_translation(scale, rotation, translation)
}

fn missing(kind: &'static str, index: usize) -> Refusal {
    Refusal::malformed(Place::Item(kind, index), format!("the file names this {kind} but has none of that number"))
}

struct Reader<'a> {
    root: &'a Root,
    buffers: Buffers<'a>,
    soup: Soup,
    /// Primitives that are no triangles.
    other_modes: usize,
    file_bytes: usize,
}

impl Reader<'_> {
    fn read_node(&mut self, node: usize, world: Affine3A) -> Result<(), Refusal> {
        let Some(mesh) = self.root.nodes[node].mesh else { return Ok(()) };
        let mesh = self.root.meshes.get(mesh.value()).ok_or_else(|| missing("mesh", mesh.value()))?;
        // Primitives of one mesh often share their positions: place them once.
        let mut placed = FxHashMap::default();
        for primitive in &mesh.primitives {
            self.read_primitive(primitive, world, &mut placed)?;
        }
        Ok(())
    }

    fn read_primitive(
        &mut self,
        primitive: &Primitive,
        world: Affine3A,
        placed: &mut FxHashMap<usize, (u32, usize)>,
    ) -> Result<(), Refusal> {
        let mode = match &primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => *mode,
            _ => {
                self.other_modes += 1;
                return Ok(());
            }
        };
        let Some(positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.soup.notes.push("a primitive without positions left out".into());
            return Ok(());
        };
        let positions = positions.value();
        let (base, count) = match placed.get(&positions) {
            Some(known) => *known,
            None => {
                let known = self.place_positions(positions, world)?;
                placed.insert(positions, known);
                known
            }
        };
        let indices = match primitive.indices {
            Some(accessor) => self.buffers.indices(accessor.value())?,
            None => (0..count as u32).collect(),
        };
        if let Some(&index) = indices.iter().find(|index| **index as usize >= count) {
            let place = primitive.indices.map_or(Place::File, |accessor| Place::Item("accessor", accessor.value()));
            return Err(Refusal::new(place, Problem::IndexOutOfRange { index: index.into(), count }));
        }
        let mirrored = world.matrix3.determinant() < 0.0;
        self.push_triangles(&indices, mode, base, mirrored);
        self.check_size()
    }

    /// Appends an accessor's positions; their first number and how many.
    fn place_positions(&mut self, accessor: usize, world: Affine3A) -> Result<(u32, usize), Refusal> {
        let positions = self.buffers.positions(accessor)?;
        let base = index_of(self.soup.positions.len() as i64, self.soup.faces, usize::MAX)?;
        let count = positions.len();
        // The identity is applied by leaving the bits alone.
        if world == Affine3A::IDENTITY {
            self.soup.positions.extend(positions);
        } else {
            self.soup.positions.extend(positions.into_iter().map(|p| world.transform_point3(p)));
        }
        self.check_size()?;
        Ok((base, count))
    }

    /// Adds the triangles of one primitive; a mirroring node turns them round, so that outside stays outside.
    fn push_triangles(&mut self, indices: &[u32], mode: Mode, base: u32, mirrored: bool) {
        let soup = &mut self.soup;
        let whole = indices.len() - indices.len() % 3;
        if matches!(mode, Mode::Triangles) && whole < indices.len() {
            soup.notes.push("indices after the last whole triangle of a primitive ignored".into());
        }
        let mut push = |[a, b, c]: [u32; 3]| {
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            soup.push_face(&corners.map(|corner| base + corner));
        };
        match (mode, indices.split_first()) {
            (Mode::TriangleStrip, _) => {
                for (turn, w) in indices.windows(3).enumerate() {
                    push(if turn % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] });
                }
            }
            (Mode::TriangleFan, Some((&hub, rim))) => rim.windows(2).for_each(|w| push([hub, w[0], w[1]])),
            _ => indices[..whole].chunks_exact(3).for_each(|w| push([w[0], w[1], w[2]])),
        }
    }

    /// Refuses what instancing makes of a small file when it no longer is in proportion.
    fn check_size(&self) -> Result<(), Refusal> {
        let limit = FREE_TRIANGLES
            .saturating_add(TRIANGLES_PER_BYTE.saturating_mul(self.file_bytes + self.buffers.loaded_bytes()));
        if self.soup.triangles.len().max(self.soup.positions.len()) > limit {
            let what = format!("its instances unfold to more than {limit} triangles or vertices");
            return Err(Refusal::new(Place::File, Problem::TooLarge(what)));
        }
        Ok(())
    }
}
