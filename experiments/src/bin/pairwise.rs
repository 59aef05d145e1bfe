//! `cargo run --release -p stead-experiments --bin pairwise -- --runs 2000 [--from SEED] [--only 7,12] [--keep
//! FOLDER]`: runs over all options, pair by pair, held against the judge; with `--only`, those of these numbers alone.

#![allow(clippy::too_many_lines, reason = "an experiment is read from top to bottom")]
#![allow(clippy::print_stdout, reason = "an experiment prints what it finds")]

#[path = "../../../tests/drive/mod.rs"]
mod drive;

use drive::{Outcome, drive};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use stead_judge::cover::{cover, pairs, words};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut wanted, mut seed, mut keep) = (100_usize, 1_u64, None);
    let mut only: Option<BTreeSet<usize>> = None;
    let mut arguments = std::env::args().skip(1);
    while let (Some(name), Some(value)) = (arguments.next(), arguments.next()) {
        match name.as_str() {
            "--runs" => wanted = value.parse()?,
            "--from" => seed = value.parse()?,
            "--only" => only = Some(value.split(',').map(str::parse).collect::<Result<_, _>>()?),
            "--keep" => keep = Some(PathBuf::from(value)),
            _ => return Err(format!("{name}: not known; --runs, --from, --only, --keep").into()),
        }
    }
    let (mut judged, mut not_placed, mut failed, mut exported, mut not_exported, mut disagreeing) = (0, 0, 0, 0, 0, 0);
    let mut checks: BTreeMap<&str, usize> = BTreeMap::new();
    let mut number = 0;
    'all: loop {
        let choices = cover(seed);
        println!("seed {seed}: {} runs cover {} pairs", choices.len(), pairs().len());
        for choice in &choices {
            if number == wanted {
                break 'all;
            }
            number += 1;
            if only.as_ref().is_some_and(|only| !only.contains(&number)) {
                continue;
            }
            let temporary = tempfile::tempdir()?;
            let folder = keep.as_ref().map_or(temporary.path().to_path_buf(), |keep| keep.join(format!("{number:04}")));
            std::fs::create_dir_all(&folder)?;
            let requested = stead_judge::cover::value_of(choice, "program") != "none";
            let start = std::time::Instant::now();
            let outcome = drive(choice, seed.wrapping_mul(100_000) + number as u64, &folder);
            if start.elapsed().as_secs_f64() > 3.0 {
                println!("run {number}: {:.1} s: {}", start.elapsed().as_secs_f64(), words(choice));
            }
            match outcome {
                Outcome::Judged(verdict) => {
                    judged += 1;
                    exported += usize::from(requested && verdict.not_exported.is_empty());
                    not_exported += verdict.not_exported.len();
                    verdict.not_exported.iter().for_each(|line| println!("run {number}: no program: {line}"));
                    verdict.checks.iter().for_each(|(kind, count)| *checks.entry(kind).or_insert(0) += count);
                    if !verdict.disagreements.is_empty() {
                        disagreeing += 1;
                        println!("run {number}: {}\n  {}", words(choice), verdict.disagreements.join("\n  "));
                    }
                }
                Outcome::NotPlaced(why) => {
                    not_placed += 1;
                    println!("run {number}: not placed: {}\n    {}", why.lines().next().unwrap_or(""), words(choice));
                }
                Outcome::Failed(why) => {
                    failed += 1;
                    println!("run {number}: FAILED: {why}");
                }
            }
        }
        seed += 1;
    }
    checks.iter().for_each(|(kind, count)| println!("{count:10} {kind}"));
    println!(
        "{number} runs: {judged} judged, {not_placed} without a placement, {failed} failed; {exported} programs read, {not_exported} not \
         written; {disagreeing} runs with disagreements"
    );
    Ok(())
}
