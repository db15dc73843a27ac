//! The fuzzers' targets on their corpora and on some thousand inputs derived from them.
//!
//! `cargo +nightly fuzz run mesh` (or `landmarks`, `pair`) goes on from here; what it finds becomes a file of its corpus.

#[path = "../fuzz/targets.rs"]
mod targets;

use homeo::shape::SplitMix;
use std::panic::catch_unwind;
use std::path::Path;

/// Bytes that mean something in one format or another.
const TELLING: [&[u8]; 16] = [
    b"\n",
    b" ",
    b"-1",
    b"0",
    b"nan",
    b"1e999",
    b"4294967295",
    b"#",
    b"\\\n",
    b"/",
    b"\"",
    b",",
    b"{",
    b"]",
    b"\xff\xfe",
    b"\xff\xff\xff\xff",
];

/// The files of a corpus, in order.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let entries = std::fs::read_dir(&folder).expect("the corpus is there");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("and readable").path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    paths.iter().map(|path| std::fs::read(path).expect("and readable")).collect()
}

/// A few random changes: bytes set, removed, repeated, replaced by telling ones, or the tail of another input.
fn mutated(seeds: &[Vec<u8>], random: &mut SplitMix) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len() + 1);
        let end = bytes.len().min(at + random.below(9));
        match random.below(6) {
            0 if at < bytes.len() => bytes[at] = random.next_bits() as u8,
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            4 => {
                let other = &seeds[random.below(seeds.len())];
                bytes.truncate(at);
                bytes.extend(&other[other.len().min(at)..]);
            }
            _ => drop(bytes.splice(at..end, TELLING[random.below(TELLING.len())].iter().copied())),
        }
    }
    bytes
}

fn try_all(name: &str, target: fn(&[u8]), count: usize) {
    let seeds = corpus(name);
    let mut random = SplitMix::new(1);
    let derived = (0..count).map(|_| mutated(&seeds, &mut random));
    for bytes in seeds.iter().cloned().chain(derived) {
        assert!(catch_unwind(|| target(&bytes)).is_ok(), "{name}: {}", bytes.escape_ascii());
    }
}

#[test]
fn mesh_files() {
    try_all("mesh", targets::mesh, 4000);
}

#[test]
fn landmark_files() {
    try_all("landmarks", targets::landmarks, 4000);
}

#[test]
fn small_pairs() {
    try_all("pair", targets::pair, 600);
}
