//! Hostile input: no bytes, however wrong, make a reader panic, hang or eat the machine.
//!
//! Laws: every input is answered by a clean mesh or by one clear line; what is read can be written
//! and read again. Broken files found in the wild are looked for under `MT_DATA`.

use glam::Vec3;
use mt_core::Mesh;
use mt_core::format::{Format, LoadOptions, NonManifold, read, write};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// Reads whatever it is and checks the answer; the line of the error, if it was refused.
fn survive(format: Format, bytes: &[u8]) -> Option<String> {
    let mut refusal = None;
    for (weld, non_manifold) in [(true, NonManifold::Keep), (false, NonManifold::Split)] {
        match read(format, bytes, &LoadOptions { weld, non_manifold }, &|_| None) {
            Ok((mesh, report)) => {
                check_clean(&mesh);
                assert_eq!(report.census.triangles, mesh.cells.len());
                assert_eq!(report.census.vertices, mesh.positions.len());
                assert!(non_manifold == NonManifold::Keep || report.census.is_manifold());
                assert!(!report.to_string().is_empty());
            }
            Err(error) => {
                let line = error.to_string();
                assert!(!line.contains('\n') && line.len() < 400, "{line}");
                refusal = Some(line);
            }
        }
    }
    refusal
}

fn check_clean(mesh: &Mesh<3>) {
    assert!(!mesh.cells.is_empty());
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    let mut used = vec![false; mesh.positions.len()];
    for &[a, b, c] in &mesh.cells {
        assert!(a != b && b != c && c != a);
        [a, b, c].into_iter().for_each(|v| used[v.index()] = true);
    }
    assert!(used.iter().all(|used| *used));
}

fn small_mesh() -> Mesh<3> {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.5, -1.25, 3.0)];
    Mesh::from_indices(positions, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [4, 1, 0], [4, 0, 3]])
}

/// Small valid files of every format and flavour.
fn seeds() -> Vec<(Format, Vec<u8>)> {
    let mesh = small_mesh();
    let mut seeds: Vec<(Format, Vec<u8>)> = [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Glb]
        .map(|format| (format, write(format, &mesh).unwrap()))
        .to_vec();
    let ascii = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 1\n3 0 1 2\n4 0 1 2 3\n4 0 1 -1 2\n";
    seeds.push((Format::Ply, ascii.into()));
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\nendsolid a\n";
    seeds.push((Format::Stl, stl.into()));
    let obj = "\u{FEFF}# x\nmtllib a.mtl\no a\nv 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nvt 0 1\nvn 0 0 1\nv 1 1 0\nv 0 1 0\ng b\nusemtl c\nf 1/1/1 2//1 3/1 \\\n -1\nl 1 2\np 3\n";
    seeds.push((Format::Obj, obj.into()));
    seeds.push((
        Format::Off,
        "STCOFF # c\n4 2 5\n0 0 0 1 1\n1 0 0\n1 1 0\n0 1 0\n# d\n4 0 1 2 3\n3 0 1 2 255 0 0\n".into(),
    ));
    // 42 bytes: three positions and three indices of two bytes.
    let mut buffer: Vec<u8> =
        [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    buffer.extend([0, 0, 1, 0, 2, 0]);
    let gltf = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"children":[1],"rotation":[0,0,0,1]}},{{"mesh":0,"scale":[1,2,3]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":5}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,"indices":{{"bufferView":1,"componentType":5123}},"values":{{"bufferView":0}}}}}},{{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":36,"byteStride":12}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],"buffers":[{{"byteLength":42,"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
        base64(&buffer)
    );
    seeds.push((Format::Gltf, gltf.into()));
    seeds
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |group: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, i| (bits << 8) | u32::from(group.get(i).copied().unwrap_or(0)));
        (0..4).map(move |i| LETTERS[(bits >> (18 - 6 * i)) as usize & 63] as char).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

/// One way to spoil a file.
#[derive(Clone, Debug)]
enum Fault {
    Truncate(prop::sample::Index),
    Flip(prop::sample::Index, u8),
    Overwrite(prop::sample::Index, Vec<u8>),
    Remove(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
    Insert(prop::sample::Index, Vec<u8>),
}

fn fault() -> impl Strategy<Value = Fault> {
    let words = [
        "-1",
        "0",
        "4294967295",
        "99999999999999999999",
        "nan",
        "1e39",
        "\\\n",
        "#",
        "\r",
        "/",
        "f ",
        "v ",
        "\0\0\0\0",
        "[",
        "{}",
        "null",
        "-0.0",
    ];
    let word = prop_oneof![
        prop::sample::select(words.to_vec()).prop_map(|w| w.as_bytes().to_vec()),
        prop::collection::vec(any::<u8>(), 1..9),
        Just(vec![0xFF; 4]),
        Just(vec![0x7F, 0xFF, 0xFF, 0xFF]),
    ];
    let at = any::<prop::sample::Index>;
    prop_oneof![
        at().prop_map(Fault::Truncate),
        (at(), 1u8..).prop_map(|(at, bits)| Fault::Flip(at, bits)),
        (at(), word.clone()).prop_map(|(at, word)| Fault::Overwrite(at, word)),
        (at(), 1usize..40).prop_map(|(at, count)| Fault::Remove(at, count)),
        (at(), 1usize..40).prop_map(|(at, count)| Fault::Repeat(at, count)),
        (at(), word).prop_map(|(at, word)| Fault::Insert(at, word)),
    ]
}

fn spoil(bytes: &mut Vec<u8>, fault: &Fault) {
    let length = bytes.len();
    if length == 0 {
        return;
    }
    match fault {
        Fault::Truncate(at) => bytes.truncate(at.index(length)),
        Fault::Flip(at, bits) => bytes[at.index(length)] ^= bits,
        Fault::Overwrite(at, word) => {
            let start = at.index(length);
            for (byte, new) in bytes[start..].iter_mut().zip(word) {
                *byte = *new;
            }
        }
        Fault::Remove(at, count) => {
            let start = at.index(length);
            bytes.drain(start..(start + count).min(length));
        }
        Fault::Repeat(at, count) => {
            let start = at.index(length);
            let part = bytes[start..(start + count).min(length)].to_vec();
            bytes.splice(start..start, part);
        }
        Fault::Insert(at, word) => {
            let start = at.index(length);
            bytes.splice(start..start, word.iter().copied());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn spoilt_files_are_survived(which in 0usize..10, faults in prop::collection::vec(fault(), 1..5)) {
        let (format, mut bytes) = seeds().swap_remove(which);
        faults.iter().for_each(|fault| spoil(&mut bytes, fault));
        survive(format, &bytes);
    }

    #[test]
    fn random_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in Format::ALL {
            survive(format, &bytes);
        }
    }

    #[test]
    fn random_bytes_behind_a_head_are_survived(which in 0usize..10, keep in any::<prop::sample::Index>(), tail in prop::collection::vec(any::<u8>(), 0..200)) {
        let (format, mut bytes) = seeds().swap_remove(which);
        let length = keep.index(bytes.len());
        bytes.truncate(length);
        bytes.extend(tail);
        survive(format, &bytes);
    }
}

#[test]
fn the_seeds_are_valid() {
    assert_eq!(seeds().len(), 10);
    for (format, bytes) in seeds() {
        assert_eq!(survive(format, &bytes), None, "{}", String::from_utf8_lossy(&bytes));
    }
}

#[test]
fn every_truncation_is_survived() {
    for (format, bytes) in seeds() {
        (0..bytes.len()).for_each(|length| drop(survive(format, &bytes[..length])));
    }
}

#[test]
fn every_flipped_byte_is_survived() {
    for (format, bytes) in seeds() {
        for at in 0..bytes.len() {
            for bits in [0x01, 0x80, 0xFF] {
                let mut spoilt = bytes.clone();
                spoilt[at] ^= bits;
                survive(format, &spoilt);
            }
        }
    }
}

#[test]
fn promises_are_not_paid_for_in_advance() {
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    assert!(survive(Format::Ply, head.as_bytes()).unwrap().contains("4000000000 vertex elements are declared"));
    let nothing = "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\nend_header\n";
    assert!(survive(Format::Ply, nothing.as_bytes()).is_some());
    assert!(
        survive(Format::Off, b"OFF\n99999999999 99999999999 0\n")
            .unwrap()
            .contains("99999999999 vertices are declared")
    );
    assert!(survive(Format::Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n").unwrap().contains("corners"));
}

#[test]
fn deep_json_is_refused() {
    let text = "[".repeat(1_000_000);
    assert!(survive(Format::Gltf, text.as_bytes()).is_some());
}

#[test]
fn instances_of_instances_stay_in_proportion() {
    // One mesh of 300,000 triangles under 1,000 nodes: small to write, 300 million triangles to unfold.
    let primitives = vec![r#"{"attributes":{"POSITION":0},"indices":1}"#; 100].join(",");
    let nodes = vec![r#"{"mesh":0}"#; 1000].join(",");
    let roots = (0..1000).map(|n: u32| n.to_string()).collect::<Vec<_>>().join(",");
    let gltf = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{roots}]}}],"nodes":[{nodes}],"meshes":[{{"primitives":[{primitives}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},{{"bufferView":0,"componentType":5121,"count":9000,"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":9000}}],"buffers":[{{"byteLength":9000,"uri":"data:;base64,{}"}}]}}"#,
        base64(&vec![0; 9000])
    );
    assert!(survive(Format::Gltf, gltf.as_bytes()).unwrap().contains("unfold"));
}

/// A reader that looks back at the file for every face takes hours here.
#[test]
fn long_text_takes_linear_time() {
    let count = 300_000u32;
    let positions = (0..count + 2).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect();
    let cells: Vec<[u32; 3]> = (0..count).map(|i| [i, i + 1, i + 2]).collect();
    let mesh = Mesh::from_indices(positions, &cells);
    for format in [Format::Obj, Format::Off] {
        assert_eq!(survive(format, &write(format, &mesh).unwrap()), None);
    }
    let off = String::from_utf8(write(Format::Off, &mesh).unwrap()).unwrap();
    let body = off.splitn(3, '\n').nth(2).unwrap();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\n{body}",
        count + 2
    );
    assert_eq!(survive(Format::Ply, ply.as_bytes()), None);
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    assert_eq!(survive(Format::Stl, format!("solid a\n{}endsolid a\n", facet.repeat(30_000)).as_bytes()), None);
}

#[test]
fn a_polygon_with_many_corners_is_no_trouble() {
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 1 1 0\nf");
    (0..300_000).for_each(|i: u32| text.push_str([" 1", " 2", " 3"][i as usize % 3]));
    assert_eq!(survive(Format::Obj, text.as_bytes()), None);
}

/// The folder that `MT_DATA` names, or a plain word that the test did not run.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("MT_DATA").map(PathBuf::from);
    if folder.is_none() {
        println!("MT_DATA not set: skipped the test on real files");
    }
    folder
}

fn answer(folder: &Path, name: &str) -> String {
    let bytes = std::fs::read(folder.join(name)).unwrap();
    let format = Format::from_extension(name.rsplit('.').next().unwrap()).unwrap();
    match read(format, &bytes, &LoadOptions::default(), &|buffer| std::fs::read(folder.join(buffer)).ok()) {
        Ok((mesh, report)) => {
            check_clean(&mesh);
            report.to_string()
        }
        Err(error) => error.to_string(),
    }
}

#[test]
fn broken_files_from_the_wild() {
    let Some(folder) = data().map(|data| data.join("bad")) else { return };
    let expected = [
        ("BoxWithInfinites.glb", "not finite"),
        ("IndexOutOfRange.gltf", "out of range"),
        ("OutOfMemory.off", "OFF, line 2: 353535235358 vertices are declared"),
        ("box_UTF16BE.obj", "UTF-16"),
        ("box_longline.obj", "6 polygons triangulated"),
        ("doubled-teapot.obj", "dropped as duplicates"),
        ("dragon_vrip_res4.ply", "502 triangles dropped as duplicates"),
        ("empty.obj", "the file is empty"),
        ("fan3.obj", "1 edges of more than two triangles"),
        ("flamingo-mangled.glb", "declares 77428 bytes"),
        ("hourglass_ico.obj", "1 vertices of more than one umbrella"),
        ("invalid-face-definition.obj", "no triangles"),
        ("invalid-relative-vertex-index.obj", "OBJ, line 1: vertex index -4 is out of range"),
        ("invalid.off", "OFF, line"),
        ("issue-140-zero-face-idx.obj", "vertex index 0 is out of range"),
        ("malformed.obj", "vertex index 12 is out of range"),
        ("moebius.obj", "not orientable"),
        ("nancolor.obj", "genus 0"),
        ("notenoughindices.obj", "1 faces of fewer than three corners"),
        ("obj_points.obj", "no triangles"),
        ("ply_empty_header.ply", "no triangles"),
        ("test-nan.obj", "OBJ, line 14"),
        ("triple_vierbein.obj", "20 edges of more than two triangles"),
        ("truncated-header.ply", "PLY, line"),
    ];
    for (name, part) in expected {
        let answer = answer(&folder, name);
        println!("{name}: {answer}");
        assert!(answer.contains(part), "{name}: {answer}");
    }
}
