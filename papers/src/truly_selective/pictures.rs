//! Figures 4 and 8 to 11: meshes, what the camera saw, and the dual pieces over the input.

use super::models::{Asked, Column, HORSE, asking, column, quadric};
use super::table_2::printed_share;
use super::wish::{SCHEMES, Wished};
use crate::ledger::{Brush, Claim, Entry, Figure, LedgerError, Published, Workshop, close_up, dual_pieces};
use glam::Vec3;
use mt_core::check;
use mt_core::model::mesh_of;
use mt_core::{Camera, Front, Mesh, NodeId, Replay};
use operators::order::Scheme;
use render::{Corner, Look, Scene, Segment, encode, outside};
use selective::Silhouette;
use std::sync::Arc;

const WIRE: Look<'static> =
    Look { material: [222, 214, 202, 255], wireframe: true, smooth: false, overlay: render::Overlay::None };

/// The mesh of a wish under a scheme, and its front.
fn mesh(wished: &Wished, scheme: Scheme) -> Result<(Mesh<3>, Front), LedgerError> {
    let (model, state) = wished.state(scheme)?;
    Ok((mesh_of(&model, &state.view.mesh), state.front().clone()))
}

/// The dual pieces of a front over the input.
fn pieces(replay: &Replay, front: &Front) -> Scene {
    let above = check::active_ancestors(replay, front);
    // Lines as wide as pieces would hide them.
    let width_px = if front.len() > 1000 { 0.5 } else { 1.2 };
    dual_pieces(&replay.reference(), width_px, |v| above[v.index()])
}

pub(super) fn figure_4(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&HORSE)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &quadric())?.replay;
    let (brush, camera) = (Brush::new()?, close_up(&subject.mesh, Vec3::new(1.0, 0.35, 0.2), Vec3::Z));
    let mut whole = true;
    for vertices in [2000, 400, 80] {
        // The coarsest nodes come last by rank, so a tail of the ranks is closed under every order.
        let count = (vertices + replay.len()).saturating_sub(replay.leaf_count()).min(replay.len());
        let wished = Wished::new(Arc::clone(&replay), (replay.len() - count..replay.len()).map(NodeId));
        let (mesh, front) = mesh(&wished, Scheme::DualPiece)?;
        whole &= front == wished.nodes && check::dual_pieces(&replay, &front).is_ok();
        let name = |part: &str| format!("truly-selective-figure-4-{vertices}{part}.png");
        let told = format!("{} at {} triangles", subject.name, mesh.cell_count());
        entry.figures.push(brush.paint(&name("a"), &told, &encode(&mesh, &WIRE), &camera)?);
        let caption =
            format!("the dual pieces of its vertices over the input of {} triangles", subject.mesh.cell_count());
        entry.figures.push(brush.paint(&name("b"), &caption, &pieces(&replay, &front), &camera)?);
    }
    entry.claims.push(Claim::check(
        "the dual pieces of a mesh's vertices cover the input without overlaps and holes, each in one piece",
        whole,
        "checked at each level by the law on partitions (`mt_core::check::dual_pieces`)",
        "",
    ));
    Ok(())
}

pub(super) fn figure_8(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let (column, wished) = column(workshop, "Terrain1", printed_share(published, "Terrain1")?)?;
    entry.models.push(column.subject.told());
    let Some(camera) = column.camera() else { return Ok(()) };
    let brush = Brush::new()?;
    let input = &column.subject.mesh;
    let (low, high) = input.bounding_box().unwrap_or_default();
    let view = above(input);
    let mut show = |mesh: &Mesh<3>, part: &str, what: &str, wire: bool| -> Result<(), LedgerError> {
        let mut scene = encode(mesh, &Look { wireframe: wire, smooth: !wire, ..Look::default() });
        scene.add_frustum(camera, low, high);
        let caption = format!("{what}: {} triangles", mesh.cell_count());
        entry.figures.push(brush.paint(&format!("truly-selective-figure-8{part}.png"), &caption, &scene, &view)?);
        Ok(())
    };
    show(input, "a", "the terrain, with the view frustum", false)?;
    let mut counts = Vec::new();
    for ((name, scheme), part) in SCHEMES.into_iter().zip(["b", "c", "d"]) {
        let (mesh, _) = mesh(&wished, scheme)?;
        show(&mesh, part, name, true)?;
        counts.push(mesh.cell_count());
    }
    entry.claims.push(Claim::check(
        "the proposed scheme has fewer faces than the others",
        counts.windows(2).all(|pair| pair[1] <= pair[0]),
        format!("{counts:?} triangles, in the order of the pictures"),
        "",
    ));
    Ok(())
}

/// A camera above a terrain.
fn above(mesh: &Mesh<3>) -> Camera {
    close_up(mesh, Vec3::new(0.0, 1.0, 0.55), Vec3::Y)
}

pub(super) fn figure_9(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let (column, wished) = column(workshop, "Lena", printed_share(published, "Lena")?)?;
    entry.models.push(column.subject.told());
    let Asked::Features(image) = &column.asked else { return Ok(()) };
    let brush = Brush::new()?;
    let camera = flat(&column);
    let grey = |p: Vec3| {
        let grey = (image.raster.between(p.x, p.z) * 255.0) as u8;
        [grey, grey, grey, 255]
    };
    let mut scene = gouraud(&column.subject.mesh, grey);
    for v in &image.features {
        let at = (column.subject.mesh.positions[v.index()] - scene.origin).to_array();
        scene.segments.push(Segment { from: at, to: at, colour: [220, 60, 30, 255], width_px: 2.2 });
    }
    let caption = format!("the image, and its {} feature points", image.features.len());
    entry.figures.push(brush.paint("truly-selective-figure-9a.png", &caption, &scene, &camera)?);
    let mut counts = Vec::new();
    let mut bottom = Vec::new();
    for ((name, scheme), part) in SCHEMES.into_iter().zip(["b", "c", "d"]) {
        let (mesh, _) = mesh(&wished, scheme)?;
        let told = format!("{name}: {} triangles", mesh.cell_count());
        let paint = |suffix: &str, what: &str, scene: &Scene| -> Result<Figure, LedgerError> {
            brush.paint(
                &format!("truly-selective-figure-9{part}{suffix}.png"),
                &format!("{told}, {what}"),
                scene,
                &camera,
            )
        };
        entry.figures.push(paint("", "shaded", &gouraud(&mesh, grey))?);
        bottom.push(paint("-mesh", "its mesh", &encode(&mesh, &WIRE))?);
        counts.push(mesh.cell_count());
    }
    entry.figures.extend(bottom);
    entry.claims.push(Claim::check(
        "all schemes look alike, and the proposed one has the most local mesh",
        counts.windows(2).all(|pair| pair[1] <= pair[0]),
        format!("{counts:?} triangles for the same feature points; compare the pictures"),
        "",
    ));
    entry.note("A vertex of a coarse mesh lies between pixels; its grey is that of the image there, since models carry positions only.");
    Ok(())
}

/// A camera that looks straight down on a plane mesh.
fn flat(column: &Column) -> Camera {
    let (low, high) = column.subject.mesh.bounding_box().unwrap_or_default();
    Camera { up: -Vec3::Z, fov_y_degrees: 30.0, ..Camera::around(low, high, Vec3::Y) }
}

/// A mesh whose corners have the colours of their places.
fn gouraud(mesh: &Mesh<3>, colour: impl Fn(Vec3) -> render::Rgba) -> Scene {
    let mut scene = encode(mesh, &Look::default());
    let origin = scene.origin;
    for Corner { position, colour: own, .. } in &mut scene.corners {
        *own = colour(Vec3::from_array(*position) + origin);
    }
    scene
}

pub(super) fn figure_10(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let (column, wished) = column(workshop, "Bunny", printed_share(published, "Bunny")?)?;
    entry.models.push(column.subject.told());
    let Some(camera) = column.camera() else { return Ok(()) };
    let (mesh, front) = mesh(&wished, Scheme::DualPiece)?;
    let brush = Brush::new()?;
    let (low, high) = column.subject.mesh.bounding_box().unwrap_or_default();
    let told = format!("{} of {} triangles", mesh.cell_count(), column.subject.mesh.cell_count());
    let near = brush.paint(
        "truly-selective-figure-10a.png",
        &format!("{told}, as the camera sees it"),
        &encode(&mesh, &WIRE),
        camera,
    )?;
    let mut scene = encode(&mesh, &WIRE);
    scene.add_frustum(camera, low, high);
    let view = outside(camera, low, high);
    let far = brush.paint(
        "truly-selective-figure-10b.png",
        &format!("{told}, from outside with the frustum"),
        &scene,
        &view,
    )?;
    let mut scene = pieces(&wished.replay, &front);
    scene.add_frustum(camera, low, high);
    let dual = brush.paint("truly-selective-figure-10c.png", "its dual pieces over the input", &scene, &view)?;
    entry.figures.extend([near, far, dual]);
    entry.claims.push(Claim::check(
        "the mesh is fine within the frustum where it faces the eye, and coarse elsewhere",
        mesh.cell_count() < column.subject.mesh.cell_count() / 2,
        told,
        "the camera sees most of this model",
    ));
    Ok(())
}

pub(super) fn figure_11(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&HORSE)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &quadric())?.replay;
    let camera = close_up(&subject.mesh, Vec3::new(1.0, 0.15, 0.1), Vec3::Z);
    let outline = Silhouette::new(&camera, 1.0, 1.0);
    let wished = Wished::new(Arc::clone(&replay), asking(&replay, |bound| outline.is_outline(bound)));
    let (mesh, front) = mesh(&wished, Scheme::DualPiece)?;
    let brush = Brush::new()?;
    let told = format!("{} of {} triangles", mesh.cell_count(), subject.mesh.cell_count());
    let turned = close_up(&subject.mesh, Vec3::new(0.6, 1.0, 0.4), Vec3::Z);
    let paint = |part: &str, what: &str, scene: &Scene, camera: &Camera| {
        brush.paint(&format!("truly-selective-figure-11{part}.png"), &format!("{told}; {what}"), scene, camera)
    };
    let figures = [
        paint("a", "as the camera sees it", &encode(&mesh, &WIRE), &camera)?,
        paint("b", "from another direction", &encode(&mesh, &WIRE), &turned)?,
        paint("c", "its dual pieces over the input", &pieces(&replay, &front), &turned)?,
    ];
    entry.figures.extend(figures);
    let sizes = wished.sizes(&front);
    entry.claims.push(Claim::check(
        "the mesh is refined around the silhouette alone",
        sizes.triangles * 2 < subject.mesh.cell_count(),
        told,
        "wide cones near the root of the forest hold a silhouette from everywhere, and small models have no others",
    ));
    Ok(())
}
