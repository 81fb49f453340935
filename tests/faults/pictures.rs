//! The renderer's buffers: triangles that are lost, doubled, moved or turned on the way to the painter.

use crate::catalogue::{Caught, Fault, Verdict, fault, hunt};
use glam::Vec3;
use mt_core::{Camera, Mesh, generate};
use render::{Corner, Look, Picture, Prefer, Scene, encode, paint};

fn subject() -> (Mesh<3>, Camera) {
    let mesh = generate::bumpy_sphere(3, 0.1, 3);
    let (low, high) = mesh.bounding_box().expect("a mesh");
    (mesh, Camera { width_px: 160, height_px: 160, ..Camera::around(low, high, Vec3::new(0.4, 0.5, 1.0)) })
}

fn picture(scene: &Scene, camera: &Camera) -> Picture {
    paint(scene, camera, Prefer::Cpu).expect("the CPU paints").0
}

/// The triangles of a scene in model units, sorted: what lies in the buffer.
fn triangles(corners: &[Corner], origin: Vec3) -> Vec<[[u32; 3]; 3]> {
    let point = |corner: &Corner| (Vec3::from(corner.position) + origin).to_array().map(f32::to_bits);
    let mut all: Vec<[[u32; 3]; 3]> =
        corners.as_chunks::<3>().0.iter().map(|triangle| triangle.each_ref().map(point)).collect();
    all.sort_unstable();
    all
}

/// The buffer holds the mesh, lit as it faces, and its picture has no hole.
fn judge(scene: &Scene) -> Verdict {
    let (mesh, camera) = subject();
    let wanted = encode(&mesh, &Look::default());
    if !scene.corners.len().is_multiple_of(3) {
        return Err(Caught::by("buffer against mesh", "the last triangle has too few corners"));
    }
    let (have, want) = (triangles(&scene.corners, scene.origin), triangles(&wanted.corners, wanted.origin));
    if have != want {
        let holes = holes(&picture(scene, &camera), &picture(&wanted, &camera));
        return Err(Caught::by(
            "buffer against mesh",
            format!("{} triangles, not {}; {holes} pixels differ", have.len(), want.len()),
        ));
    }
    let dark = holes(&picture(scene, &camera), &picture(&wanted, &camera));
    if dark > 0 {
        return Err(Caught::by("picture against picture", format!("{dark} pixels differ")));
    }
    Ok(())
}

/// Pixels that differ.
fn holes(one: &Picture, other: &Picture) -> usize {
    let pixels = (0..160).flat_map(|y| (0..160).map(move |x| (x, y)));
    pixels.filter(|&(x, y)| one.pixel(x, y) != other.pixel(x, y)).count()
}

#[test]
fn renderers_buffers() {
    let planted = |what, change: fn(&mut Scene)| -> Fault {
        fault(what, move |planted| {
            let mut scene = encode(&subject().0, &Look::default());
            if planted {
                change(&mut scene);
            }
            judge(&scene)
        })
    };
    hunt(
        "renderer's buffers",
        &[
            planted("a triangle is lost", |scene| _ = scene.corners.drain(30..33)),
            planted("a triangle is there twice", |scene| scene.corners.extend_from_within(30..33)),
            planted("the buffer ends a corner too early", |scene| _ = scene.corners.pop()),
            planted("a corner is shared with the wrong triangle", |scene| scene.corners[31] = scene.corners[300]),
            planted("a triangle is turned over", |scene| scene.corners.swap(30, 31)),
            planted("a slot keeps the triangle that was there before", |scene| {
                let old: Vec<Corner> = scene.corners[60..63].to_vec();
                scene.corners[30..33].copy_from_slice(&old);
            }),
            planted("the origin is left out", |scene| scene.origin += 0.01),
            planted("normals point inwards", |scene| {
                scene.corners.iter_mut().for_each(|corner| corner.normal = corner.normal.map(|x| -x));
            }),
            planted("colours are those of the slots before", |scene| {
                let first = scene.corners.len() / 2;
                scene.corners[first..].iter_mut().for_each(|corner| corner.colour = [9, 9, 9, 255]);
            }),
        ],
    );
}
