//! Figures 4 and 8 to 11: meshes, what the camera saw, and the dual pieces over the input.

use super::models::{Asked, Column, asking, column, facing};
use super::table_2::printed_share;
use super::wish::{SCHEMES, Wished};
use crate::ledger::{Brush, Claim, Entry, Figure, HORSE, LedgerError, Published, Workshop, close_up, edge_collapse};
use glam::Vec3;
use mt_core::check;
use mt_core::model::mesh_of;
use mt_core::{Camera, Front, Mesh, NodeId, Replay, VertexId};
use operators::order::Scheme;
use render::{Corner, Look, Picture, Scene, Segment, encode, outside};
use selective::Silhouette;
use std::sync::Arc;

const WIRE: Look<'static> =
    Look { material: [222, 214, 202, 255], wireframe: true, smooth: false, overlay: render::Overlay::None };

/// The mesh of a wish under a scheme, and its front.
fn mesh(wished: &Wished, scheme: Scheme) -> Result<(Mesh<3>, Front), LedgerError> {
    let (model, state) = wished.state(scheme)?;
    Ok((mesh_of(&model, &state.view.mesh), state.front().clone()))
}

/// Of the vertices of the input that are concerned and of all others: the share that a front has as they are.
fn kept(replay: &Replay, front: &Front, is_concerned: impl Fn(VertexId) -> bool) -> [f64; 2] {
    let (mut all, mut active) = ([0u32; 2], [0u32; 2]);
    for v in (0..replay.leaf_count()).map(VertexId) {
        let kind = usize::from(!is_concerned(v));
        let merged = replay.merged_at(v);
        all[kind] += 1;
        active[kind] += u32::from(merged.is_none() || front.is_refined(merged));
    }
    [0, 1].map(|kind| f64::from(active[kind]) / f64::from(all[kind].max(1)))
}

/// The dual pieces of a front over the input.
fn pieces(replay: &Replay, front: &Front) -> Scene {
    let above = check::active_ancestors(replay, front);
    let input = replay.reference();
    let (low, high) = input.bounding_box().unwrap_or_default();
    render::dual_pieces(&input, (low + high) * 0.5, |v| above[v.index()])
}

pub(super) fn figure_4(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&HORSE)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &edge_collapse())?.replay;
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
        format!("{} triangles, in the order of the pictures", told(&counts)),
        "",
    ));
    Ok(())
}

fn told(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
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
    let whole = brush.picture("truly-selective-figure-9a.png", &scene, &camera)?;
    let mut differences = Vec::new();
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
        let shaded = gouraud(&mesh, grey);
        differences.push(difference(&whole, &brush.picture("truly-selective-figure-9.png", &shaded, &camera)?));
        entry.figures.push(paint("", "shaded", &shaded)?);
        bottom.push(paint("-mesh", "its mesh", &encode(&mesh, &WIRE))?);
        counts.push(mesh.cell_count());
    }
    entry.figures.extend(bottom);
    entry.claims.push(Claim::check(
        "all schemes have a visual quality similar to the original",
        differences.iter().all(|rms| *rms < 12.0),
        format!(
            "between the pictures and that of the input {} of 255 grey levels, root mean square",
            differences.iter().map(|rms| format!("{rms:.1}")).collect::<Vec<_>>().join(", ")
        ),
        "",
    ));
    entry.claims.push(Claim::check(
        "the proposed scheme has the maximum locality of finally refined vertices",
        counts.windows(2).all(|pair| pair[1] < pair[0]),
        format!("{} triangles, in the order of the pictures", told(&counts)),
        "",
    ));
    entry.note("A vertex of a coarse mesh lies between pixels; its grey is that of the image there, since models carry positions only.");
    Ok(())
}

/// The root mean square difference of the red channels of two pictures, where either is not the background.
fn difference(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4)).filter(|(a, b)| is_grey(a) || is_grey(b));
    let (sum, count) = pairs.fold((0.0, 0u32), |(sum, count), (a, b)| {
        let apart = f64::from(a[0]) - f64::from(b[0]);
        (sum + apart * apart, count + 1)
    });
    (sum / f64::from(count.max(1))).sqrt()
}

/// The background is bluish everywhere.
fn is_grey(pixel: &[u8]) -> bool {
    pixel[0] == pixel[1] && pixel[1] == pixel[2]
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
    let mut seen = vec![false; wished.replay.leaf_count() as usize];
    column.vertices().into_iter().for_each(|v| seen[v.index()] = true);
    let [inside, outside] = kept(&wished.replay, &front, |v| seen[v.index()]);
    entry.claims.push(Claim::check(
        "the mesh is fine within the frustum where it faces the eye, and coarse elsewhere",
        inside > 0.99 && outside < 0.2,
        format!(
            "of the input's vertices in the frustum that face the eye {:.1} % are there as they are, of all others {:.1} %",
            100.0 * inside,
            100.0 * outside
        ),
        "spheres and cones of nodes reach further than their vertices",
    ));
    Ok(())
}

pub(super) fn figure_11(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&HORSE)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &edge_collapse())?.replay;
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
    let sides = facing(&subject.mesh, camera.eye);
    let [outline, elsewhere] = kept(&replay, &front, |v| sides[v.index()] == [true, true]);
    entry.claims.push(Claim::check(
        "selective refinement around the silhouette (and coarse elsewhere)",
        outline > 0.99 && elsewhere < 0.3,
        format!(
            "of the input's vertices between triangles that face the eye and triangles that face away {:.1} % are there as they \
             are, of all others {:.1} %",
            100.0 * outline,
            100.0 * elsewhere
        ),
        "small models are silhouettes for the most part",
    ));
    Ok(())
}
