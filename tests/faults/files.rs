//! Files that say something else than what was written: containers, histories, sequences, logs, certificates.

use crate::catalogue::{Caught, Fault, Verdict, fault, hunt};
use mt_core::check::{Witness, is_least};
use mt_core::container::{self, Meta};
use mt_core::log::Log;
use mt_core::model::MultiTessellation;
use mt_core::{Explicit, Mesh, NodeId, Replay, Sequence, Step, VertexId, check, generate, history};
use mt_tests::{History, chew, model_of};
use multi_tessellation::verify;
use operators::EdgeCollapse;
use selective::{UniformError, certify, wish_closure};

fn input() -> Mesh<3> {
    generate::bumpy_sphere(2, 0.1, 3)
}

fn model() -> Explicit<3> {
    model_of(&input(), &EdgeCollapse::FULL)
}

/// What a reader gives is held to every law, and to be what was written.
fn judge(read: Explicit<3>) -> Verdict {
    let options = verify::Options { fronts: 30, seed: 5, ..verify::Options::default() };
    verify::explicit(&read, &options, &mut |_| true)?;
    check::ends(&read, &input())?;
    Ok(())
}

/// Where a section begins and ends, by the container's own table.
fn section(bytes: &[u8], name: &[u8; 4]) -> std::ops::Range<usize> {
    let entry = (24..).step_by(24).find(|&at| bytes[at..at + 4] == *name).expect("there is such a section");
    let long = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes")) as usize;
    long(entry + 8)..long(entry + 8) + long(entry + 16)
}

fn containers(what: &'static str, change: fn(&mut Vec<u8>)) -> Fault<'static> {
    fault(what, move |planted| {
        let mut bytes = Vec::new();
        container::write(&model(), &Meta::default(), &mut bytes).expect("memory takes it");
        if planted {
            change(&mut bytes);
        }
        judge(container::read::<3>(&bytes).map_err(Caught::refused)?.0)
    })
}

/// Changes a word of a section, and mends the checksums as a wrong writer would.
fn forge(bytes: &mut Vec<u8>, name: &[u8; 4], word: usize, change: impl Fn(u32) -> u32) {
    let at = section(bytes, name).start + 4 * word;
    let old = u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    bytes[at..at + 4].copy_from_slice(&change(old).to_le_bytes());
    *bytes = chew::resealed(bytes);
}

#[test]
fn containers_on_disk() {
    hunt(
        "containers",
        &[
            containers("a bit is flipped", |bytes| {
                let at = section(bytes, b"POSI").start;
                bytes[at] ^= 1;
            }),
            containers("the end is cut off", |bytes| bytes.truncate(bytes.len() - 9)),
            containers("something stands behind the end", |bytes| bytes.push(0)),
            containers("a cell has another corner, with a right checksum", |bytes| {
                let last = section(bytes, b"CORN").len() / 4 - 1;
                forge(bytes, b"CORN", last, |v| v ^ 1);
            }),
            containers("a corner is no vertex, with a right checksum", |bytes| forge(bytes, b"CORN", 7, |_| u32::MAX)),
            containers("a node kills another cell, with a right checksum", |bytes| {
                forge(bytes, b"FINE", 3, |cell| cell + 1);
            }),
            containers("sides do not ascend, with a right checksum", |bytes| forge(bytes, b"CSTA", 3, |_| 0)),
            containers("an error shrank, with a right checksum", |bytes| {
                let nodes = model().len() as usize;
                let words = section(bytes, b"BNDS").len() / 4 / nodes;
                // The last node is a root; its largest number is its error, its radius or its place.
                (0..words).for_each(|word| {
                    forge(bytes, b"BNDS", words * (nodes - 1) + word, |old| (f32::from_bits(old) * 0.25).to_bits());
                });
            }),
            containers("a vertex of the input moved by a bit, with a right checksum", |bytes| {
                forge(bytes, b"POSI", 4, |old| old ^ 1);
            }),
            containers("two sections are exchanged, with right checksums", |bytes| {
                let one: Vec<u8> = bytes[48..72].to_vec();
                bytes.copy_within(72..96, 48);
                bytes[72..96].copy_from_slice(&one);
                *bytes = chew::resealed(bytes);
            }),
        ],
    );
}

fn texts(what: &'static str, change: fn(&mut Vec<String>)) -> Fault<'static> {
    fault(what, move |planted| {
        let mut text = Vec::new();
        history::write(&model(), &mut text).expect("memory takes it");
        let mut lines: Vec<String> = String::from_utf8(text).expect("text").lines().map(str::to_owned).collect();
        if planted {
            change(&mut lines);
        }
        judge(history::read(&input(), lines.join("\n").as_bytes()).map_err(Caught::refused)?)
    })
}

fn logs(what: &'static str, change: fn(&mut Vec<Step>)) -> Fault<'static> {
    fault(what, move |planted| {
        let model = model();
        let mut steps: Vec<Step> = (0..model.len()).rev().map(|m| Step::refine(NodeId(m))).collect();
        if planted {
            change(&mut steps);
        }
        let mut log = Log::new(model.len());
        log.push(&steps);
        log.follow(&model).map_err(Caught::refused)
    })
}

#[test]
fn histories_and_logs_as_text() {
    hunt(
        "histories and logs as text",
        &[
            texts("a line is missing", |lines| _ = lines.remove(5)),
            texts("two lines are exchanged", |lines| lines.swap(1, 40)),
            texts("a line is there twice", |lines| lines.insert(5, lines[5].clone())),
            logs("a step is missing", |steps| _ = steps.remove(0)),
            logs("a step is there twice", |steps| steps.insert(3, steps[3])),
            logs("steps go the wrong way", |steps| steps.iter_mut().for_each(|step| *step = step.inverse())),
        ],
    );
}

fn merges(what: &'static str, change: fn(&mut Sequence)) -> Fault<'static> {
    fault(what, move |planted| {
        let operator = "edge-collapse".parse().expect("an operator");
        let history = History::new(&input(), &operator, &Default::default()).expect("a manifold");
        let mut sequence = history.sequence.clone();
        if planted {
            change(&mut sequence);
        }
        let sequence = Sequence::from_bytes(&sequence.to_bytes()).map_err(Caught::refused)?;
        let replay = Replay::new(&history.mesh, &history.links, &sequence).map_err(Caught::refused)?;
        // What was heard as cells is what the merges say.
        let front = check::random_front(history.explicit.order(), &mut check::Random::new(1));
        let cells = check::set_algebra(&history.explicit, &front).expect("the front is closed").len();
        let merged = check::quotient(&replay, &front).len();
        if cells != merged {
            return Err(Caught::by("quotient", format!("{cells} cells by set algebra, {merged} by the quotient")));
        }
        Ok(())
    })
}

fn certificates(what: &'static str, change: fn(&mut Vec<(NodeId, Witness)>)) -> Fault<'static> {
    fault(what, move |planted| {
        let model = model();
        let mut errors: Vec<f32> = (0..model.len()).map(|m| model.bound(NodeId(m)).error).collect();
        errors.sort_by(f32::total_cmp);
        let wish = UniformError { error_max: errors[errors.len() * 2 / 3] };
        let asked = |m: NodeId| model.bound(m).error > wish.error_max;
        let mut certificate = certify(model.order(), &asked, &wish_closure(&model, &wish))?;
        if planted {
            change(&mut certificate.entries);
        }
        Ok(is_least(model.order(), &asked, &certificate)?)
    })
}

#[test]
fn merges_and_certificates() {
    hunt(
        "merges and certificates",
        &[
            merges("a vertex is merged twice", |sequence| sequence.children[5] = sequence.children[4]),
            merges("a vertex is merged into itself", |sequence| sequence.children[5] = sequence.centers[5]),
            merges("a vertex is merged before it is made", |sequence| {
                sequence.children[5] = VertexId(sequence.input_vertex_count + 9);
            }),
            merges("two children are exchanged", |sequence| sequence.children.swap(3, 50)),
            certificates("a node is missing", |entries| _ = entries.remove(entries.len() / 2)),
            certificates("a node too many is said to be asked for", |entries| {
                let gap = (0..).map(NodeId).find(|m| entries.iter().all(|entry| entry.0 != *m)).expect("a gap");
                entries.insert(entries.partition_point(|entry| entry.0 < gap), (gap, Witness::Asked));
            }),
            certificates("nodes need each other in a circle", |entries| {
                let last = entries.len() - 1;
                entries[last].1 = Witness::NeededBy(entries[last].0);
            }),
        ],
    );
}
