//! What stands for the models of Table 2, and what is wished of each.

use super::wish::Wished;
use crate::ledger::{
    BUNNY, COW, Coding, Grid, HORSE, LedgerError, Raster, Role, Size, Subject, Workshop, edge_collapse, fuji,
};
use glam::Vec3;
use mt_core::generate::terrain;
use mt_core::mesh::area_vector;
use mt_core::{Bound, Camera, Mesh, NodeId, Replay, VertexId};
use operators::metric::{AnyMetric, QuadricAttributes};
use operators::{AnyOperator, EdgeCollapse};
use selective::{Criterion, Facing, Frustum, InView, UniformError};
use std::sync::Arc;

/// A difference from black to white is worth this share of the diagonal of an image.
const GREY_WEIGHT: f64 = 0.1;
/// Times that an interval is halved to find a camera or a threshold.
const HALVINGS: u32 = 14;

/// The criterion of a column.
pub(super) enum Asked {
    /// Feature points of an image.
    Features(Image),
    /// Everything in the frustum of a camera.
    InView(Camera),
    /// The same where the surface may face the eye.
    Facing(Camera),
}

/// An image with its feature points.
#[derive(Clone)]
pub(super) struct Image {
    pub(super) raster: Raster,
    pub(super) features: Vec<VertexId>,
}

/// A column of Table 2.
pub(super) struct Column {
    pub(super) subject: Arc<Subject>,
    pub(super) asked: Asked,
}

/// The names of the columns, as printed.
pub(super) const NAMES: [&str; 8] = ["Lena", "Female", "Terrain1", "Terrain2", "Terrain3", "Cow", "Horse", "Bunny"];

const IMAGES: [(&str, [usize; 4]); 2] = [("Lena", [160, 70, 128, 128]), ("Female", [340, 110, 128, 86])];

const TERRAINS: [Role; 3] = [
    Role {
        name: "Terrain1",
        file: "terrain/gcanyon.png",
        grid: Some(Grid { coding: Coding::Grey, part: Some([500, 500, 173, 173]) }),
        stand_in: |size| hills(size, 1),
    },
    Role {
        name: "Terrain2",
        file: "terrain/fuji.png",
        grid: fuji(Some([170, 170, 173, 173])),
        stand_in: |size| hills(size, 2),
    },
    Role {
        name: "Terrain3",
        file: "terrain/N42E001.hgt",
        grid: Some(Grid { coding: Coding::Srtm, part: Some([600, 300, 173, 173]) }),
        stand_in: |size| hills(size, 3),
    },
];

fn hills(size: Size, seed: u64) -> Mesh<3> {
    terrain(if size == Size::Small { 24 } else { 172 }, 0.5, seed)
}

/// A column by its name, and what it asks of its sequence. How much is asked for, by the angle of a camera or the number
/// of feature points, is set so that the wish has about the share of the vertices that the paper's answer has.
pub(super) fn column(workshop: &mut Workshop<'_>, name: &str, share: f64) -> Result<(Column, Wished), LedgerError> {
    if let Some((name, part)) = IMAGES.into_iter().find(|(other, _)| *other == name) {
        return image(workshop, name, part, share);
    }
    let terrain = TERRAINS.iter().find(|role| role.name == name);
    let role = terrain.unwrap_or(match name {
        "Cow" => &COW,
        "Horse" => &HORSE,
        _ => &BUNNY,
    });
    let subject = workshop.subject(role)?;
    let replay = workshop.sequence(&subject, &edge_collapse())?.replay;
    let asked = |fov_y_degrees: f32| match (terrain, name) {
        (Some(_), _) => Asked::InView(over(&subject.mesh, fov_y_degrees)),
        (None, "Cow") => {
            Asked::Facing(near(&subject.mesh, Vec3::new(0.5, 0.2, 1.0), Vec3::ZERO, Vec3::Y, fov_y_degrees))
        }
        (None, "Horse") => {
            Asked::Facing(near(&subject.mesh, Vec3::new(1.0, 0.3, 0.2), Vec3::ZERO, Vec3::Z, fov_y_degrees))
        }
        _ => Asked::Facing(near(
            &subject.mesh,
            Vec3::new(-0.4, 0.15, 1.0),
            Vec3::new(-0.25, 0.1, 0.2),
            Vec3::Y,
            fov_y_degrees,
        )),
    };
    let wished = |fov: f32| Wished::new(Arc::clone(&replay), asked(fov).nodes(&replay));
    let fov = halve(1.0, 120.0, |fov| wished(fov).share() < share);
    let column = Column { subject: Arc::clone(&subject), asked: asked(fov) };
    Ok((column, wished(fov)))
}

/// Where something stops being too small, between two bounds.
fn halve(mut low: f32, mut high: f32, is_small: impl Fn(f32) -> bool) -> f32 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_small(middle) { low = middle } else { high = middle }
    }
    high
}

fn image(
    workshop: &mut Workshop<'_>,
    name: &'static str,
    part: [usize; 4],
    share: f64,
) -> Result<(Column, Wished), LedgerError> {
    let [_, _, width, height] = part;
    let (width, height) = workshop.pick((width, height), (24, 20));
    let found = workshop.raster("images/camera.png", &Grid { coding: Coding::Grey, part: Some(part) })?;
    let (raster, from) = found.unwrap_or_else(|| (rings(width, height), "generated".to_owned()));
    let mut strength: Vec<(f32, usize)> = raster.sobel().into_iter().enumerate().map(|(i, s)| (s, i)).collect();
    strength.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let grey: Arc<[[f32; 3]]> = raster.values.iter().map(|&grey| [grey, 0.0, 0.0]).collect();
    let metric = QuadricAttributes { attributes: Some(grey), weight: GREY_WEIGHT };
    let operator = AnyOperator::EdgeCollapse(EdgeCollapse::FULL.with(AnyMetric::QuadricAttributes(metric)));
    let subject = Arc::new(Subject { name, from: format!("{from}, grey"), mesh: raster.plane() });
    let replay = workshop.sequence(&subject, &operator)?.replay;
    let features = |part: f32| -> Vec<VertexId> {
        let count = (strength.len() as f32 * part) as usize;
        strength[..count].iter().map(|&(_, i)| VertexId::new(i)).collect()
    };
    let wished = |part: f32| Wished::new(Arc::clone(&replay), above(&replay, &features(part)));
    let part = halve(0.0, 1.0, |part| wished(part).share() < share);
    let column = Column { subject, asked: Asked::Features(Image { raster, features: features(part) }) };
    Ok((column, wished(part)))
}

/// Rings around a corner and a bar: edges of all directions.
fn rings(width: usize, height: usize) -> Raster {
    Raster::sampled(width, height, |x, y| {
        let ring = ((x * x + y * y).sqrt() * 0.18).sin() * 0.35 + 0.5;
        if (x - width as f32 * 0.7).abs() < width as f32 * 0.06 { 0.05 } else { ring }
    })
}

/// A camera at the south side of a terrain, looking north and down.
fn over(mesh: &Mesh<3>, fov_y_degrees: f32) -> Camera {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let (middle, side) = ((low + high) * 0.5, high - low);
    let eye = Vec3::new(middle.x, high.y + 0.1 * side.x, high.z - 0.1 * side.z);
    let target = Vec3::new(middle.x, low.y, middle.z - 0.2 * side.z);
    Camera { eye, target, fov_y_degrees, near: side.x * 0.01, far: side.x * 3.0, ..VIEW }
}

/// A camera around a mesh that looks at a place off its middle, in sides of its box.
fn near(mesh: &Mesh<3>, from: Vec3, off: Vec3, up: Vec3, fov_y_degrees: f32) -> Camera {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let camera = Camera::around(low, high, from);
    let off = off * (high - low);
    Camera {
        eye: camera.eye + off,
        target: camera.target + off,
        up,
        fov_y_degrees,
        near: camera.near,
        far: camera.far,
        ..VIEW
    }
}

const VIEW: Camera = Camera {
    eye: Vec3::ZERO,
    target: Vec3::NEG_Z,
    up: Vec3::Y,
    fov_y_degrees: 45.0,
    near: 0.1,
    far: 100.0,
    width_px: 800,
    height_px: 600,
};

impl Column {
    /// The camera, where there is one.
    pub(super) fn camera(&self) -> Option<&Camera> {
        match &self.asked {
            Asked::Features(_) => None,
            Asked::InView(camera) | Asked::Facing(camera) => Some(camera),
        }
    }

    /// The vertices of the input that are asked for, one by one: feature points, and those within the frustum, where a
    /// column asks for that with a normal towards the eye.
    pub(super) fn vertices(&self) -> Vec<VertexId> {
        let mesh = &self.subject.mesh;
        let within = |camera: &Camera| {
            let planes = camera.frustum();
            move |v: &VertexId| planes.iter().all(|plane| plane.dot(mesh.positions[v.index()].extend(1.0)) >= 0.0)
        };
        let all = (0..mesh.positions.len()).map(VertexId::new);
        match &self.asked {
            Asked::Features(image) => image.features.clone(),
            Asked::InView(camera) => all.filter(within(camera)).collect(),
            Asked::Facing(camera) => {
                let towards = facing(mesh, camera.eye);
                all.filter(within(camera)).filter(|v| towards[v.index()][0]).collect()
            }
        }
    }
}

impl Asked {
    /// The nodes that are asked for.
    fn nodes(&self, replay: &Replay) -> Vec<NodeId> {
        let everything = UniformError { error_max: -1.0 };
        match self {
            Asked::Features(image) => above(replay, &image.features),
            Asked::InView(camera) => {
                let criterion = InView { frustum: Frustum::new(camera), criterion: everything };
                asking(replay, |bound| criterion.asks(bound, false))
            }
            Asked::Facing(camera) => {
                let in_view = InView { frustum: Frustum::new(camera), criterion: everything };
                let criterion = Facing { eye: camera.eye, criterion: in_view };
                asking(replay, |bound| criterion.asks(bound, false))
            }
        }
    }
}

/// Of each vertex, whether a triangle around it faces the eye, and whether one faces away.
pub(super) fn facing(mesh: &Mesh<3>, eye: Vec3) -> Vec<[bool; 2]> {
    let mut sides = vec![[false; 2]; mesh.positions.len()];
    for cell in &mesh.cells {
        let corners = cell.map(|v| mesh.positions[v.index()].as_dvec3());
        let towards = area_vector(corners).dot(eye.as_dvec3() - corners[0]) > 0.0;
        cell.iter().for_each(|v| sides[v.index()][usize::from(!towards)] = true);
    }
    sides
}

/// The nodes whose bound is asked for.
pub(super) fn asking(replay: &Replay, asks: impl Fn(&Bound) -> bool) -> Vec<NodeId> {
    (0..replay.len()).map(NodeId).filter(|&m| asks(&replay.bound(m))).collect()
}

/// The nodes that have to be refined before these input vertices are there.
pub(super) fn above(replay: &Replay, leaves: &[VertexId]) -> Vec<NodeId> {
    let mut found = Vec::new();
    for &leaf in leaves {
        let first = replay.merged_at(leaf);
        let mut next = (!first.is_none()).then_some(first);
        while let Some(m) = next {
            found.push(m);
            next = replay.parent(m);
        }
    }
    found
}
