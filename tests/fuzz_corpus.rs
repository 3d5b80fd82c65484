//! The fuzz targets as ordinary tests: the seed corpus, and pseudo-random bytes.
//!
//! `cargo +nightly fuzz run TARGET` searches; this shows that what was found stays found.

use std::path::Path;

#[path = "../fuzz/targets/mod.rs"]
mod targets;

/// Pseudo-random inputs per target.
const INPUTS: u64 = 4_000;

/// What a fuzz target does.
type Target = fn(&[u8]);

/// The fuzz targets by name.
const TARGETS: &[(&str, Target)] = &[
    ("arcos_frame", targets::arcos::frame),
    ("arcos_information", targets::arcos::information),
    ("avoid", targets::avoid::run),
    ("controller", targets::controller::run),
    ("decide", targets::decide::run),
    ("edge", targets::edge::run),
    ("laser", targets::laser::run),
    ("gesture", targets::gesture::run),
    ("interact", targets::interact::run),
    ("shield", targets::shield::run),
    ("valley", targets::valley::run),
];

/// Numbers that are the same in every run (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Up to 600 bytes: random ones, then as many with three of four zero, which leave more of a
    /// world in order.
    fn bytes(&mut self) -> Vec<u8> {
        let sparse = self.next().is_multiple_of(2);
        let length = self.next() % 600;
        (0..length)
            .map(|_| {
                let byte = self.next();
                if sparse && !byte.is_multiple_of(4) {
                    0
                } else {
                    (byte >> 8) as u8
                }
            })
            .collect()
    }
}

fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut files: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    files.sort();
    files
}

#[test]
fn corpus_is_replayed() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let folders: Vec<_> = files(&corpus)
        .iter()
        .map(|folder| {
            folder
                .file_name()
                .expect("a name")
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    let mut names: Vec<_> = TARGETS.iter().map(|(name, _)| (*name).to_owned()).collect();
    names.sort();
    assert_eq!(folders, names, "a folder of seeds for every target");
    for (name, target) in TARGETS {
        let seeds = files(&corpus.join(name));
        assert!(!seeds.is_empty(), "no seeds for {name}");
        for seed in &seeds {
            let bytes = std::fs::read(seed).expect("a seed");
            let outcome = std::panic::catch_unwind(|| target(&bytes));
            assert!(outcome.is_ok(), "{}", seed.display());
        }
        println!("{name}: {} seeds", seeds.len());
    }
}

#[test]
fn random_bytes_break_nothing() {
    for (name, target) in TARGETS {
        let mut random = Random(0);
        for input in 0..INPUTS {
            let bytes = random.bytes();
            let outcome = std::panic::catch_unwind(|| target(&bytes));
            assert!(outcome.is_ok(), "{name}, input {input}: {bytes:02x?}");
        }
    }
}
