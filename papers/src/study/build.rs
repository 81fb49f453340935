//! Building: each sequence once, by one analysis that is heard by the recorder and the sequence at the same time; kept
//! between runs by a cache that the caller provides.

use super::{Built, Degrees, Results, Steps, StudyError, Subject};
use mt_core::analysis::{Options, Stopped};
use mt_core::container::{self, Meta};
use mt_core::hierarchy::HierarchyError;
use mt_core::{Explicit, MultiTessellation, Recorder, Replay, Sequence, VertexId};
use operators::AnyOperator;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

/// Where built models are kept between runs. What comes back is checked, and built anew when it is damaged.
pub trait Cache {
    /// The bytes that were kept under this key.
    fn load(&mut self, key: &str) -> Option<Vec<u8>>;
    /// Keeps bytes; a failure is no reason to stop.
    fn store(&mut self, key: &str, bytes: &[u8]);
}

/// Keeps nothing.
pub struct NoCache;

impl Cache for NoCache {
    fn load(&mut self, _: &str) -> Option<Vec<u8>> {
        None
    }
    fn store(&mut self, _: &str, _: &[u8]) {}
}

/// A sequence in both forms.
pub(super) struct Pair {
    pub(super) explicit: Explicit<3>,
    pub(super) replay: Arc<Replay>,
}

/// What is kept beside the arrays.
#[derive(Serialize, Deserialize)]
struct Kept {
    refusals: Vec<(String, u64)>,
    seconds: f64,
    seconds_replay: f64,
    container_len: usize,
}

/// What an analysis made, or the cache had.
type Found = (Explicit<3>, Sequence, Replay, Kept);

/// A key that changes with the input, the operator with all its options, and the version of the software.
fn key(subject: &Subject, operator: &AnyOperator) -> String {
    let mut bytes = Vec::with_capacity(12 * (subject.mesh.positions.len() + subject.mesh.cells.len()));
    for p in &subject.mesh.positions {
        p.to_array().iter().for_each(|x| bytes.extend_from_slice(&x.to_bits().to_le_bytes()));
    }
    for v in subject.mesh.cells.iter().flatten() {
        bytes.extend_from_slice(&v.0.to_le_bytes());
    }
    let counts = [subject.mesh.positions.len(), subject.mesh.cells.len()];
    let what = format!("{} {operator:?} {counts:?}", env!("CARGO_PKG_VERSION"));
    // Two sums over the mesh in two orders, so that one of 32 bits does not decide alone.
    let (one, two) = (crc32fast::hash(&bytes), {
        bytes.reverse();
        crc32fast::hash(&bytes)
    });
    format!("{}-{one:08x}{two:08x}{:08x}", operator.name().replace('/', "-"), crc32fast::hash(what.as_bytes()))
}

/// Builds, or takes from the cache, and notes what came out.
pub(super) fn build(
    subject: &Subject,
    operator: &AnyOperator,
    cache: &mut dyn Cache,
    results: &mut Results,
    steps: &mut Steps<'_>,
) -> Result<Pair, StudyError> {
    let key = key(subject, operator);
    let links = operator.links(&subject.mesh);
    let kept = cache.load(&key).and_then(|bytes| unpack(&bytes, &key, subject, &links));
    let is_new = kept.is_none();
    let (explicit, sequence, replay, note) = match kept {
        Some(kept) => kept,
        None => analyse(subject, operator, &links, steps)?,
    };
    if is_new && let Some(bytes) = pack(&key, &explicit, &sequence, &note) {
        cache.store(&key, &bytes);
    }
    let vertices = subject.mesh.vertex_count().max(1) as f64;
    results.built.push(Built {
        model: subject.name.clone(),
        operator: operator.name(),
        vertices_in: subject.mesh.vertex_count(),
        triangles_in: subject.mesh.cell_count(),
        triangles_base: explicit.base_cells().len(),
        merges: replay.merge_count(),
        modifications: replay.len(),
        links: links.len(),
        bytes_per_vertex: replay.bytes() as f64 / vertices,
        bytes_of: replay.bytes_table().into_iter().map(|(name, bytes)| (name, bytes as f64 / vertices)).collect(),
        explicit_bytes_per_vertex: explicit.bytes() as f64 / vertices,
        refusals: note.refusals.into_iter().collect(),
        stall: stall(&replay),
        seconds: note.seconds,
        seconds_replay: note.seconds_replay,
        from_cache: !is_new,
    });
    degrees(subject, operator, &replay, results);
    Ok(Pair { explicit, replay: Arc::new(replay) })
}

fn analyse(
    subject: &Subject,
    operator: &AnyOperator,
    links: &[[VertexId; 2]],
    steps: &mut Steps<'_>,
) -> Result<Found, StudyError> {
    let failed = |error| StudyError::Analysis(subject.name.clone(), error);
    let recorder = Recorder::new(&subject.mesh).map_err(|error| failed(error.into()))?;
    let mut listener = (recorder, Sequence::new(&subject.mesh));
    let begun = Instant::now();
    let ended = operator
        .analyse(&subject.mesh, &Options::default(), &mut listener, &mut |_| steps.go_on(&subject.name).is_ok())
        .map_err(failed)?;
    let seconds = begun.elapsed().as_secs_f64();
    if ended.stopped == Stopped::Cancelled {
        return Err(StudyError::Cancelled);
    }
    let refusals = ended.refusals.iter().map(|(reason, count)| (reason.name().to_owned(), count)).collect();
    let explicit = listener.0.finish(Default::default()).map_err(|error| failed(error.into()))?;
    let begun = Instant::now();
    let replay = Replay::new(&subject.mesh, links, &listener.1)
        .map_err(|error| StudyError::Hierarchy(subject.name.clone(), HierarchyError::from(error)))?;
    let seconds_replay = begun.elapsed().as_secs_f64();
    Ok((explicit, listener.1, replay, Kept { refusals, seconds, seconds_replay, container_len: 0 }))
}

/// The key, the note, the explicit model and the sequence, one after the other, and a checksum over all of it.
fn pack(key: &str, explicit: &Explicit<3>, sequence: &Sequence, note: &Kept) -> Option<Vec<u8>> {
    let mut model = Vec::new();
    container::write(explicit, &Meta::default(), &mut model).ok()?;
    let note = Kept {
        refusals: note.refusals.clone(),
        seconds: note.seconds,
        seconds_replay: note.seconds_replay,
        container_len: model.len(),
    };
    let mut bytes = format!("{key}\n").into_bytes();
    bytes.extend(serde_json::to_vec(&note).ok()?);
    bytes.push(b'\n');
    bytes.append(&mut model);
    bytes.extend(sequence.to_bytes());
    let sum = crc32fast::hash(&bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    Some(bytes)
}

/// What was packed under this key, if it is sound and of this mesh.
fn unpack(bytes: &[u8], key: &str, subject: &Subject, links: &[[VertexId; 2]]) -> Option<Found> {
    let (bytes, sum) = bytes.split_last_chunk::<4>()?;
    let bytes = (crc32fast::hash(bytes).to_le_bytes() == *sum).then_some(bytes)?;
    let bytes = bytes.strip_prefix(key.as_bytes())?.strip_prefix(b"\n")?;
    let end = bytes.iter().position(|&byte| byte == b'\n')?;
    let note: Kept = serde_json::from_slice(&bytes[..end]).ok()?;
    let rest = &bytes[end + 1..];
    let (model, sequence) = rest.split_at_checked(note.container_len)?;
    let (explicit, _) = container::read::<3>(model).ok()?;
    let sequence = Sequence::from_bytes(sequence).ok()?;
    let replay = Replay::new(&subject.mesh, links, &sequence).ok()?;
    // The two are of one analysis: as many merges as modifications, of the same positions.
    let made = &explicit.parts().positions[explicit.input_vertex_count() as usize..];
    let alike = sequence.merge_count() == explicit.len() && (made.is_empty() || made == sequence.positions);
    (alike && explicit.reference() == subject.mesh).then_some((explicit, sequence, replay, note))
}

/// For fans: the share of vertices that were left when the first merge came that did not take the whole link of its
/// centre. `None` where every merge is of one child.
fn stall(replay: &Replay) -> Option<f64> {
    if replay.is_single() {
        return None;
    }
    let leaves = f64::from(replay.leaf_count().max(1));
    let mut stalled = None;
    replay.sweep(|m, view| {
        let merge = replay.merge_of(m);
        let run = replay.run_of(merge);
        if stalled.is_none() && m == *run.start() {
            let mut ring: Vec<_> = view.mesh.ring(replay.merge(merge).center).collect();
            ring.sort_unstable();
            ring.dedup();
            let children = (run.end().0 - run.start().0 + 1) as usize;
            if children < ring.len() {
                stalled = Some(f64::from(view.mesh.active.count()) / leaves);
            }
        }
    });
    stalled
}

/// Shares of the vertices at which degrees are counted.
const SHARES: [f64; 7] = [1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01];

/// The largest and the mean number of triangles at a vertex along the simplification.
fn degrees(subject: &Subject, operator: &AnyOperator, replay: &Replay, results: &mut Results) {
    let leaves = f64::from(replay.leaf_count().max(1));
    let mut wanted = SHARES.iter().peekable();
    replay.sweep(|_, view| {
        while let Some(&&share) = wanted.peek()
            && f64::from(view.mesh.active.count()) <= share * leaves
        {
            wanted.next();
            let degree = |v: u32| view.mesh.faces.star(mt_core::VertexId(v)).count();
            let all = view.mesh.active.iter().map(degree);
            let (most, sum) = all.fold((0, 0), |(most, sum), degree| (degree.max(most), sum + degree));
            results.degrees.push(Degrees {
                model: subject.name.clone(),
                operator: operator.name(),
                share,
                maximum: most,
                mean: sum as f64 / f64::from(view.mesh.active.count().max(1)),
            });
        }
    });
}
