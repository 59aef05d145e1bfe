//! Fixtures with random mutations: whatever comes, an answer and no panic.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::testing::tried;

/// What stands in place of a piece of the text.
const PIECES: [&str; 20] = [
    "",
    "0",
    "-1",
    "1e308",
    "-0.0",
    "nan",
    "inf",
    "1e-320",
    "0 0 0",
    "0 0 1",
    "\"",
    "<",
    "/>",
    "link_1",
    "tool0",
    "base_link",
    "<link name=\"link_1\"/>",
    "prismatic",
    "${x}",
    "\u{e9}",
];

/// The text with one to four mutations: pieces cut out, doubled, moved or replaced.
fn mutated(text: &str, random: &mut ChaCha8Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..random.random_range(1..5) {
        let from = random.random_range(0..=bytes.len());
        let to = (from + random.random_range(0..40)).min(bytes.len());
        let piece = bytes[from..to].to_vec();
        let at = random.random_range(0..=bytes.len());
        match random.random_range(0..5) {
            0 => drop(bytes.drain(from..to)),
            1 => drop(bytes.splice(at..at, piece)),
            2 => bytes.iter_mut().skip(from).take(1).for_each(|byte| *byte = random.random()),
            // The next number, name or tag after a place, as a whole.
            _ => {
                let is_edge = |byte: &u8| b"\" <>=".contains(byte);
                let from = bytes[from..].iter().position(is_edge).map_or(from, |k| from + k + 1).min(bytes.len());
                let to = bytes[from..].iter().position(is_edge).map_or(from, |k| from + k);
                let new = PIECES[random.random_range(0..PIECES.len())];
                drop(bytes.splice(from..to, new.bytes()));
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn mutated_files_are_imported_or_refused() {
    let mut random = ChaCha8Rng::seed_from_u64(2013);
    let (mut taken, mut refused) = (0, 0);
    let all = tried(20_000);
    for case in 0..all {
        let text = mutated(FIXTURES[case % FIXTURES.len()].1, &mut random);
        match import(&text) {
            Ok(imported) => {
                taken += 1;
                assert!(imported.deviation.position_mm <= REFUSED_MM);
                if taken % 20 == 0 {
                    filled(&imported);
                }
            }
            Err(error) => {
                refused += 1;
                let message = error.to_string();
                assert!(message.starts_with("arm.urdf") && message.contains("; allowed: "), "{message}");
                assert_eq!(message.lines().count(), 1, "{message}");
            }
        }
    }
    assert!(taken > all / 10 && refused > all / 4, "{taken} taken, {refused} refused");
}
