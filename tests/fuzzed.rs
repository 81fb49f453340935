//! What fuzzers chew on, in a plain test: seeds changed at random, broken files, and whatever was found before.

use mt_tests::chew;
use proptest::prelude::*;
use proptest::sample::Index;

#[test]
fn seeds_are_taken() {
    for (name, bytes) in chew::seeds() {
        chew::by_name(name)(&bytes);
    }
    let named = |target: &&str| chew::seeds().iter().any(|(name, _)| name == target);
    assert!(chew::TARGETS.iter().all(named), "a target without a seed");
}

/// One change of some bytes.
#[derive(Clone, Debug)]
enum Change {
    Flip(Index, u8),
    Write(Index, Vec<u8>),
    Cut(Index, Index),
    Repeat(Index, Index),
    Number(Index, u32),
}

fn change() -> impl Strategy<Value = Change> {
    let telling = prop_oneof![Just(0u32), Just(1), Just(u32::MAX), Just(1 << 31), Just(0x7fc0_0000), 0u32..40];
    let words = prop_oneof![
        prop::collection::vec(any::<u8>(), 1..6),
        prop::sample::select(vec!["-1", "1e39", "nan", "0", " ", "\n", "4294967296", "{", "\"", "/", "f 1 2 3\n"])
            .prop_map(|word| word.as_bytes().to_vec()),
    ];
    prop_oneof![
        (any::<Index>(), any::<u8>()).prop_map(|(at, mask)| Change::Flip(at, mask)),
        (any::<Index>(), words).prop_map(|(at, bytes)| Change::Write(at, bytes)),
        (any::<Index>(), any::<Index>()).prop_map(|(from, to)| Change::Cut(from, to)),
        (any::<Index>(), any::<Index>()).prop_map(|(from, to)| Change::Repeat(from, to)),
        (any::<Index>(), telling).prop_map(|(at, number)| Change::Number(at, number)),
    ]
}

fn changed(bytes: &[u8], change: &Change) -> Vec<u8> {
    let mut out = bytes.to_vec();
    if bytes.is_empty() {
        return out;
    }
    let at = |index: &Index| index.index(bytes.len());
    match change {
        Change::Flip(i, mask) => out[at(i)] ^= mask,
        Change::Write(i, word) => {
            let (from, end) = (at(i), (at(i) + word.len()).min(out.len()));
            out.splice(from..end, word.iter().copied());
        }
        Change::Cut(i, j) => drop(out.drain(at(i).min(at(j))..at(i).max(at(j)))),
        Change::Repeat(i, j) => {
            let part = bytes[at(i).min(at(j))..at(i).max(at(j))].to_vec();
            out.splice(at(i)..at(i), part);
        }
        Change::Number(i, number) => {
            let from = at(i) & !3;
            out.iter_mut().skip(from).zip(number.to_le_bytes()).for_each(|(byte, new)| *byte = new);
        }
    }
    out
}

proptest! {
    #[test]
    fn changed_seeds_are_refused_or_hold_together(which in any::<Index>(), changes in prop::collection::vec(change(), 1..5)) {
        let seeds = chew::seeds();
        let (name, bytes) = &seeds[which.index(seeds.len())];
        chew::by_name(name)(&changes.iter().fold(bytes.clone(), |bytes, change| changed(&bytes, change)));
    }

    #[test]
    fn bytes_of_any_kind_are_refused_or_hold_together(which in 0..chew::TARGETS.len(), bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        chew::by_name(chew::TARGETS[which])(&bytes);
    }
}

#[test]
fn broken_files_are_refused_or_hold_together() {
    let Some(data) = std::env::var_os("MT_DATA") else { return println!("skipped: MT_DATA names no folder of models") };
    let mut seen = 0;
    for entry in std::fs::read_dir(std::path::Path::new(&data).join("bad")).expect("a folder of broken files") {
        let path = entry.expect("an entry").path();
        let bytes = std::fs::read(&path).expect("a file");
        for target in chew::TARGETS {
            chew::by_name(target)(&bytes);
            seen += 1;
        }
    }
    assert!(seen > 100, "only {seen} pairs of file and reader");
}
