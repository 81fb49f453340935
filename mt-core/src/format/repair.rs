//! From the faces of a file to a clean mesh: weld, drop what is no triangle, drop what nobody uses.

use super::report::Dropped;
use super::soup::{Soup, same_triangles};
use crate::id::VertexId;
use crate::mesh::Mesh;
use glam::Vec3;

/// What [`repair`] did, for the report.
#[derive(Debug, Default)]
pub(super) struct Repairs {
    pub(super) welded: usize,
    pub(super) degenerate: Dropped,
    pub(super) duplicate: Dropped,
    pub(super) unused: usize,
    pub(super) unused_not_finite: usize,
}

/// Cleans a soup. The order of vertices and triangles stays; a welded vertex keeps the place of its first.
///
/// Requires: indices and positions checked. O(n log n) for the weld, else linear; about 24 bytes a vertex and 12 a triangle beside the result.
pub(super) fn repair(soup: Soup, weld: bool) -> (Mesh<3>, Repairs) {
    let mut repairs = Repairs::default();
    // Until the last step, vertices keep the numbers of the file, so that messages can name them.
    let same = weld.then(|| first_at_position(&soup.positions));
    let mut triangles = proper_triangles(&soup, same.as_deref(), &mut repairs);
    drop_duplicates(&soup, &mut triangles, &mut repairs);
    if let Some(same) = &same {
        repairs.welded = same.iter().enumerate().filter(|&(v, first)| v as u32 != *first).count();
    }
    let kept: Vec<[u32; 3]> = triangles.into_iter().map(|(corners, _)| corners).collect();
    let mesh = compact(&soup, kept, same.as_deref(), &mut repairs);
    (mesh, repairs)
}

/// For each vertex the first one at bit-equal coordinates (with -0 = 0).
///
/// Sorting instead of hashing: no file can make it quadratic.
fn first_at_position(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero turns -0 into 0 and changes no other number.
    let bits = |x: f32| u128::from((x + 0.0).to_bits());
    let mut keys: Vec<u128> = positions
        .iter()
        .enumerate()
        .map(|(v, p)| (bits(p.x) << 96) | (bits(p.y) << 64) | (bits(p.z) << 32) | v as u128)
        .collect();
    keys.sort_unstable();
    let mut first = vec![0; positions.len()];
    for run in keys.chunk_by(|a, b| a >> 32 == b >> 32) {
        for &key in run {
            first[key as u32 as usize] = run[0] as u32;
        }
    }
    first
}

/// A triangle after welding, with the number it had in the soup.
type Numbered = ([u32; 3], u32);

fn proper_triangles(soup: &Soup, same: Option<&[u32]>, repairs: &mut Repairs) -> Vec<Numbered> {
    let mut proper = Vec::with_capacity(soup.triangles.len());
    for (t, corners) in soup.triangles.iter().enumerate() {
        let [a, b, c] = same.map_or(*corners, |same| corners.map(|v| same[v as usize]));
        if a == b || b == c || c == a {
            repairs.degenerate.add(|| soup.face_of(t));
        } else {
            proper.push(([a, b, c], t as u32));
        }
    }
    proper
}

fn drop_duplicates(soup: &Soup, triangles: &mut Vec<Numbered>, repairs: &mut Repairs) {
    let groups = same_triangles(soup.positions.len(), triangles.iter().map(|(corners, _)| *corners));
    let mut repeated: Vec<u32> = groups.iter().flat_map(|group| &group[1..]).copied().collect();
    repeated.sort_unstable();
    for &t in &repeated {
        repairs.duplicate.add(|| soup.face_of(triangles[t as usize].1 as usize));
    }
    let (mut t, mut repeated) = (0, repeated.into_iter().peekable());
    triangles.retain(|_| {
        t += 1;
        repeated.next_if_eq(&(t - 1)).is_none()
    });
}

/// Renumbers the vertices that are used, and drops the others.
fn compact(soup: &Soup, mut triangles: Vec<[u32; 3]>, same: Option<&[u32]>, repairs: &mut Repairs) -> Mesh<3> {
    let mut renamed = vec![u32::MAX; soup.positions.len()];
    triangles.iter().flatten().for_each(|&v| renamed[v as usize] = 0);
    let mut positions = Vec::with_capacity(soup.positions.len());
    for (v, name) in renamed.iter_mut().enumerate() {
        let position = soup.positions[v];
        if *name == 0 {
            *name = positions.len() as u32;
            positions.push(position);
        } else if same.is_none_or(|same| same[v] as usize == v) {
            repairs.unused += 1;
            repairs.unused_not_finite += usize::from(!position.is_finite());
        }
    }
    positions.shrink_to_fit();
    for corner in triangles.iter_mut().flatten() {
        *corner = renamed[*corner as usize];
    }
    let cells = triangles.into_iter().map(|corners| corners.map(VertexId)).collect();
    Mesh { positions, cells }
}
