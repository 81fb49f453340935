//! The container: bit for bit, and nothing damaged gets through.

use mt_core::analysis::{Options, analyse};
use mt_core::container::{self, Archive, Container, ContainerError, Meta, Storage};
use mt_core::hierarchy::{Story, grid_step};
use mt_core::{Explicit, Mesh, MultiTessellation, Sequence, generate};
use mt_tests::{chew, model_of};
use operators::EdgeCollapse;
use operators::{AnyOperator, FanMerge};
use proptest::prelude::*;
use std::io::Cursor;

fn bytes_of(model: &Explicit<3>) -> Vec<u8> {
    let meta = Meta { operator: "edge-collapse".into(), source: "test".into(), ..Meta::default() };
    let mut bytes = Vec::new();
    container::write(model, &meta, &mut bytes).expect("writing to memory cannot fail");
    bytes
}

fn small() -> Vec<u8> {
    bytes_of(&model_of(&generate::bumpy_sphere(2, 0.1, 1), &EdgeCollapse::FULL))
}

#[test]
fn a_round_trip_is_bit_for_bit() {
    for seed in 0..40 {
        let model = model_of(&generate::random_mesh(seed).mesh, &EdgeCollapse::FULL);
        let bytes = bytes_of(&model);
        let (again, meta) = container::read::<3>(&bytes).unwrap();
        assert_eq!(again, model);
        let mut rewritten = Vec::new();
        container::write(&again, &meta, &mut rewritten).unwrap();
        assert!(rewritten == bytes, "writing again gives other bytes");
    }
}

#[test]
fn every_truncation_is_refused() {
    let bytes = small();
    for length in 0..bytes.len() {
        assert!(
            container::read::<3>(&bytes[..length]).is_err(),
            "{length} of {} bytes are taken for a model",
            bytes.len()
        );
    }
    // What is missing is told: of the table, and of the file.
    let told = |length: usize| container::read::<3>(&bytes[..length]).unwrap_err().to_string();
    assert!(told(40).contains("220 bytes expected, 40 found"), "{}", told(40));
    assert!(told(bytes.len() - 1).contains(&format!("{} bytes expected", bytes.len())));
    let mut longer = bytes;
    longer.push(0);
    assert!(container::read::<3>(&longer).is_err());
}

#[test]
fn every_flipped_byte_is_refused() {
    let mut bytes = small();
    assert!(bytes.len() > 10_000, "thousands of positions are wanted");
    for at in 0..bytes.len() {
        for mask in [0x01, 0x80, 0xff] {
            bytes[at] ^= mask;
            assert!(container::read::<3>(&bytes).is_err(), "byte {at} of {} can be flipped by {mask:#x}", bytes.len());
            bytes[at] ^= mask;
        }
    }
}

fn packed(model: &Explicit<3>) -> Vec<u8> {
    let mut bytes = Vec::new();
    container::write_as(model, &Meta::default(), Storage::Packed, &mut bytes).expect("writing to memory cannot fail");
    bytes
}

#[test]
fn what_is_packed_is_smaller_and_the_same() {
    for seed in 0..20 {
        let model = model_of(&generate::random_mesh(seed).mesh, &EdgeCollapse::FULL);
        assert_eq!(container::read::<3>(&packed(&model)).unwrap().0, model);
    }
    let model = model_of(&generate::bumpy_sphere(4, 0.1, 1), &EdgeCollapse::FULL);
    let (plain, packed) = (bytes_of(&model).len(), packed(&model).len());
    assert!(10 * packed < 7 * plain, "{packed} of {plain} bytes");
}

#[test]
fn damage_to_what_is_packed_is_refused() {
    let mut bytes = packed(&model_of(&generate::bumpy_sphere(1, 0.1, 1), &EdgeCollapse::FULL));
    for length in 0..bytes.len() {
        assert!(container::read::<3>(&bytes[..length]).is_err(), "{length} of {} bytes", bytes.len());
    }
    for at in 0..bytes.len() {
        for mask in [0x01, 0xff] {
            bytes[at] ^= mask;
            assert!(container::read::<3>(&bytes).is_err(), "byte {at} can be flipped by {mask:#x}");
            bytes[at] ^= mask;
        }
    }
}

fn story(mesh: &Mesh<3>, operator: &AnyOperator) -> Story {
    let mut sequence = Sequence::new(mesh);
    analyse_any(mesh, operator, &mut sequence);
    // As it is read again, without what only an analysis needs.
    let sequence = Sequence::from_bytes(&sequence.to_bytes()).unwrap();
    Story { mesh: mesh.clone(), links: operator.links(mesh), sequence }
}

fn analyse_any(mesh: &Mesh<3>, operator: &AnyOperator, sequence: &mut Sequence) {
    operator.analyse(mesh, &Options::default(), sequence, &mut |_| true).unwrap();
}

#[test]
fn stories_come_back_whatever_tells_them() {
    let mesh = generate::bumpy_sphere(2, 0.1, 3);
    for name in ["edge-collapse", "half-edge-collapse", "vertex-pair", "fan-merge"] {
        let story = story(&mesh, &name.parse().unwrap());
        for storage in [Storage::Plain, Storage::Packed] {
            let mut bytes = Vec::new();
            container::write_story(&story, "one-ring", &Meta::default(), storage, &mut bytes).unwrap();
            let (again, meta) = container::open(&bytes).and_then(Container::story).unwrap();
            assert!(again == story, "{name} {storage:?}");
            assert_eq!(
                (meta.dependency.as_deref(), meta.modifications),
                (Some("one-ring"), story.sequence.node_count())
            );
            assert!(matches!(container::read::<3>(&bytes), Err(ContainerError::Kind(_))));
        }
    }
    let explicit = small();
    assert!(matches!(container::open(&explicit).and_then(Container::story), Err(ContainerError::Kind(_))));
}

#[test]
fn stories_on_a_grid_come_back_to_the_bit() {
    let mesh = generate::bumpy_sphere(3, 0.1, 3);
    for name in ["edge-collapse", "half-edge-collapse", "fan-merge"] {
        let story = story(&mesh, &name.parse().unwrap());
        let step = grid_step(&mesh.positions, 12).unwrap();
        let meta = Meta { grid_step: Some(step), ..Meta::default() };
        let write = |story: &Story, storage| {
            let mut bytes = Vec::new();
            container::write_story(story, "one-ring", &meta, storage, &mut bytes).map(|()| bytes)
        };
        assert!(write(&story, Storage::Plain).is_err(), "its vertices are not on the grid");
        let snapped = story.on_grid(step);
        assert!(snapped.replay().is_ok() && snapped != story && snapped.on_grid(step) == snapped);
        for storage in [Storage::Plain, Storage::Packed] {
            let bytes = write(&snapped, storage).unwrap();
            let (again, meta) = container::open(&bytes).and_then(Container::story).unwrap();
            assert!(again == snapped && meta.grid_step == Some(step), "{name} {storage:?}");
        }
    }
}

#[test]
fn a_fan_is_kept_as_a_fan() {
    let mesh = generate::grid(12, 12);
    let mut sequence = Sequence::new(&mesh);
    analyse(&mesh, &FanMerge::PARTIAL, &Options::default(), &mut sequence, &mut |_| true).unwrap();
    assert!(sequence.node_count() > sequence.merge_count(), "fans have several nodes");
    let story = Story { mesh, links: Vec::new(), sequence };
    let mut bytes = Vec::new();
    container::write_story(&story, "explicit", &Meta::default(), Storage::Packed, &mut bytes).unwrap();
    let again = container::open(&bytes).and_then(Container::story).unwrap().0;
    assert!(again.replay().unwrap() == story.replay().unwrap());
}

#[test]
fn a_section_can_be_had_without_the_others() {
    let model = model_of(&generate::bumpy_sphere(2, 0.1, 1), &EdgeCollapse::FULL);
    for mut bytes in [bytes_of(&model), packed(&model)] {
        let mut archive = Archive::open(Cursor::new(&bytes)).unwrap();
        assert_eq!(archive.meta().modifications, model.len());
        let positions: &[u8] = bytemuck::cast_slice(&model.parts().positions);
        assert_eq!(archive.section(b"POSI").unwrap(), positions);
        assert!(matches!(archive.section(b"NONE"), Err(ContainerError::Layout(_))));
        let told: Vec<u64> = archive.sections().filter(|s| s.name == "POSI").map(|s| s.length).collect();
        assert_eq!(told, [positions.len() as u64]);
        // What is damaged elsewhere does not matter here, and does there.
        let at = bytes.len() - 1000;
        bytes[at] ^= 0x10;
        let mut archive = Archive::open(Cursor::new(&bytes)).unwrap();
        assert!(archive.section(b"POSI").is_ok() && archive.section(b"BNDS").is_err());
    }
}

/// A file of one section, all zeros, which claims to be so long when it is unpacked.
fn bomb(name: &[u8; 4], kind: u8, length: u64) -> Vec<u8> {
    // A frame of Zstandard that says a megabyte of zeros, over and over: `28 b5 2f fd`, no size, then blocks of one byte each.
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x38];
    for block in 0..64u32 {
        let header = (128 * 1024) << 3 | 1 << 1 | u32::from(block == 63);
        frame.extend_from_slice(&header.to_le_bytes()[..3]);
        frame.push(0);
    }
    let mut file = b"\x89MT\r\n\x1a\n\0".to_vec();
    let total = 128 + frame.len().next_multiple_of(64);
    file.extend_from_slice(&2u32.to_le_bytes());
    file.extend_from_slice(&1u32.to_le_bytes());
    file.extend_from_slice(&(total as u64).to_le_bytes());
    file.extend_from_slice(name);
    file.extend_from_slice(&crc32fast::hash(&frame).to_le_bytes());
    for number in [128, frame.len() as u64, length] {
        file.extend_from_slice(&number.to_le_bytes());
    }
    file.extend_from_slice(&[kind, 0, 0, 0, 0, 0, 0, 0]);
    let sum = crc32fast::hash(&file);
    file.extend_from_slice(&sum.to_le_bytes());
    file.resize(128, 0);
    file.extend_from_slice(&frame);
    file.resize(total, 0);
    file
}

#[test]
fn metadata_that_swells_is_not_unpacked() {
    for length in [64 << 17, 1 << 40, u64::MAX] {
        let bytes = bomb(b"META", 1, length);
        let told = [container::open(&bytes).err(), Archive::open(Cursor::new(&bytes)).err()];
        for error in told {
            let error = error.expect("that is no model").to_string();
            let seen = error.contains("bytes of metadata")
                || error.contains("packed in no known way")
                || error.contains("metadata:");
            assert!(seen, "{length}: {error}");
        }
    }
}

#[test]
fn sections_beyond_the_file_are_refused_at_the_head() {
    for (at, number) in [(32usize, 1u64 << 60), (40, 1 << 60), (40, u64::MAX), (32, 3)] {
        let mut bytes = bomb(b"META", 1, 100);
        bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
        let sum = crc32fast::hash(&bytes[..64]);
        bytes[64..68].copy_from_slice(&sum.to_le_bytes());
        assert!(matches!(container::open(&bytes).err(), Some(ContainerError::Layout(_))), "{at} {number}");
        assert!(matches!(Archive::open(Cursor::new(&bytes)).err(), Some(ContainerError::Layout(_))), "{at} {number}");
    }
}

#[test]
fn nothing_is_not_packed_in_any_way() {
    let mesh = generate::octahedron();
    let story = story(&mesh, &"edge-collapse".parse().unwrap());
    let mut bytes = Vec::new();
    container::write_story(&story, "one-ring", &Meta::default(), Storage::Plain, &mut bytes).unwrap();
    // The empty section says that it is packed as text.
    let links = bytes.windows(4).position(|name| name == b"LINK").unwrap();
    assert_eq!(bytes[links + 16..links + 34], [0; 18], "no bytes of no packing");
    bytes[links + 32] = 1;
    let bytes = chew::resealed(&bytes);
    assert!(matches!(container::open(&bytes).err(), Some(ContainerError::Layout(_))));
    assert!(matches!(Archive::open(Cursor::new(&bytes)).err(), Some(ContainerError::Layout(_))));
}

#[test]
fn a_newer_version_is_refused_by_number() {
    let mut bytes = small();
    bytes[8] = 9;
    assert_eq!(container::open(&bytes).err(), Some(ContainerError::Newer(9)));
}

/// Bytes whose checksums fit, but whose arrays are nonsense: the checksum is no proof of good will.
fn forged(change: impl FnOnce(&mut mt_core::explicit::Parts<3>)) -> Result<Explicit<3>, mt_core::explicit::Invalid> {
    let model = model_of(&generate::sphere(2), &EdgeCollapse::FULL);
    let mut parts = model.parts().clone();
    change(&mut parts);
    Explicit::from_parts(parts)
}

#[test]
fn forged_arrays_are_refused() {
    assert!(forged(|_| {}).is_ok());
    assert!(forged(|p| p.corners[3][0].0 = 1 << 30).is_err());
    assert!(forged(|p| p.corners[3][0] = p.corners[3][1]).is_err());
    assert!(forged(|p| p.fine[0].0 = u32::MAX).is_err());
    assert!(forged(|p| p.fine[1] = p.fine[0]).is_err());
    assert!(forged(|p| p.coarse_start[1] = u32::MAX).is_err());
    assert!(forged(|p| p.coarse_start.truncate(0)).is_err());
    assert!(forged(|p| p.fine_start.reverse()).is_err());
    assert!(forged(|p| p.fine_start[0] = 1).is_err());
    assert!(forged(|p| p.positions.truncate(5)).is_err());
    assert!(forged(|p| p.positions[0].x = f32::NAN).is_err());
    assert!(forged(|p| p.bounds[0].radius = f32::INFINITY).is_err());
    assert!(forged(|p| p.bounds[0].error = -1.0).is_err());
    assert!(forged(|p| p.bounds.truncate(1)).is_err());
    assert!(forged(|p| p.parents[0] = mt_core::NodeId(0)).is_err());
    assert!(forged(|p| p.parents[0] = mt_core::NodeId::NONE).is_err());
    assert!(forged(|p| p.parents.truncate(1)).is_err());
    assert!(forged(|p| p.input_vertex_count = u32::MAX).is_err());
    assert!(forged(|p| p.input_vertex_count -= 1).is_err());
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(container::read::<3>(&bytes).is_err());
    }

    #[test]
    fn random_bytes_behind_a_good_head_never_panic(at in 0usize..4000, noise in prop::collection::vec(any::<u8>(), 1..64)) {
        let mut bytes = small();
        let at = at % (bytes.len() - noise.len());
        let before = bytes.clone();
        bytes[at..at + noise.len()].copy_from_slice(&noise);
        prop_assume!(bytes != before);
        prop_assert!(container::read::<3>(&bytes).is_err());
    }
}

#[test]
fn an_empty_model_round_trips() {
    let model = model_of(&generate::triangle(), &EdgeCollapse::FULL);
    assert!(model.is_empty());
    assert_eq!(container::read::<3>(&bytes_of(&model)).unwrap().0, model);
}
