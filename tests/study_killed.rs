//! Studies that are killed at any moment, and disks that fill up.
//!
//! A process ends inside a write where it meets a limit on the size of files: the system writes up to the limit, at a
//! byte that the test chooses and however fast the machine is, and what is torn there stays.

use crate::common::{Bench, Ended};
use crate::study::{STUDY, bench, results, run};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Cases of the study.
const CASES: usize = 6;
/// Bytes of a block of `ulimit -f`.
const BLOCK: u64 = 512;

/// The command under a limit on the size of files, in blocks.
fn limited(bench: &Bench, arguments: &[&str], blocks: u64) -> Command {
    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("ulimit -c 0; ulimit -f {blocks}; exec \"$0\" \"$@\""));
    command.arg(bench.command(&[]).get_program()).args(arguments).current_dir(bench.path(""));
    command
}

/// Kills in the default suite; more by the environment.
fn kills() -> usize {
    std::env::var("STEAD_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(20)
}

/// How often a study was killed, and how often of that inside a write.
#[derive(Debug, Default)]
struct Killed {
    all: usize,
    writing: usize,
}

impl Killed {
    /// Whether three of ten were inside a write so far, or less.
    fn wants_write(&self) -> bool {
        10 * self.writing <= 3 * self.all
    }
}

/// Sends SIGKILL to the group of a process.
fn kill_group(child: &Child) {
    assert!(Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status().unwrap().success());
}

/// What the tests of one study have in common.
struct Study {
    bench: Bench,
    expected: Vec<u8>,
    /// What it takes when nobody disturbs it.
    whole: Duration,
    /// Blocks of its largest file.
    blocks: u64,
    random: ChaCha8Rng,
}

impl Study {
    fn new() -> Self {
        let bench = bench();
        let begun = Instant::now();
        run(&bench, "whole", &[]);
        let whole = begun.elapsed();
        let expected = results(&bench, "whole");
        let largest = expected.len();
        Self { bench, expected, whole, blocks: largest as u64 / BLOCK, random: ChaCha8Rng::seed_from_u64(15) }
    }

    /// Runs a shard, which is killed at a moment uniform over the time of the whole study or at a byte uniform over its
    /// largest file, unless it ends before. Says whether it came to its end.
    fn attempt(&mut self, out: &str, shard: &str, killed: &mut Killed) -> bool {
        let threads = ["1", "2"][self.random.random_range(0..2)];
        let arguments = ["study", "run", STUDY, "--out", out, "--shard", shard, "--threads", threads];
        let in_write = killed.wants_write();
        let mut command = if in_write {
            limited(&self.bench, &arguments, self.random.random_range(1..=self.blocks))
        } else {
            self.bench.command(&arguments)
        };
        let mut child = command.process_group(0).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        if !in_write {
            std::thread::sleep(self.whole.mul_f64(self.random.random_range(0.0..1.0)));
            // It is not waited for yet, so its group is there even where it has ended.
            kill_group(&child);
        }
        let status = child.wait().unwrap();
        if status.success() {
            return true;
        }
        let expected = if in_write { (Some(1), None) } else { (None, Some(9)) };
        assert_eq!((status.code(), status.signal()), expected, "{status}");
        killed.all += 1;
        killed.writing += usize::from(in_write);
        false
    }

    fn done(&self, out: &str) -> usize {
        let said = self.bench.stead(&["study", "status", STUDY, "--out", out, "--json"]);
        assert_eq!(said.stderr, "");
        said.json()["done"].as_u64().unwrap() as usize
    }

    /// Asserts that a study that is done has all and nothing else.
    fn assert_whole(&self, out: &str) {
        assert!(results(&self.bench, out) == self.expected, "not the bytes of an undisturbed run");
        assert_eq!(self.bench.read(&format!("{out}/mine.txt")), "the user's own\n");
        let stray = self.bench.names(out).into_iter().find(|name| name.ends_with(".tmp"));
        assert_eq!(stray, None);
        let report = self.bench.stead(&["study", "report", STUDY, "--out", out, "--json"]);
        assert_eq!(report.code, Some(0), "{}", report.stderr);
    }
}

#[test]
fn a_study_that_is_killed_again_and_again_ends_with_the_same_bytes() {
    let mut study = Study::new();
    let (count, mut killed, mut round) = (kills(), Killed::default(), 0);
    while killed.all < count {
        round += 1;
        let out = format!("out-{round}");
        study.bench.write(&format!("{out}/mine.txt"), "the user's own\n");
        let shards = study.random.random_range(1..=3);
        let mut order: Vec<usize> = (1..=shards).collect();
        order.shuffle(&mut study.random);
        let mut before = 0;
        for shard in order {
            let shard = format!("{shard}/{shards}");
            while killed.all < count && !study.attempt(&out, &shard, &mut killed) {
                let done = study.done(&out);
                assert!(done >= before, "{} cases are lost", before - done);
                before = done;
            }
            // What is left of it, undisturbed: nothing that was done is done again.
            let before = study.done(&out);
            let ended = run(&study.bench, &out, &["--shard", &shard]);
            let now = ended.stdout.split_once("cases done, ").unwrap().1.split(' ').next().unwrap();
            assert_eq!(study.done(&out), before + now.parse::<usize>().unwrap(), "{}", ended.stdout);
        }
        let ended = run(&study.bench, &out, &[]);
        assert!(ended.stdout.contains(&format!("{CASES} of {CASES} cases done, 0 of them now")), "{}", ended.stdout);
        study.assert_whole(&out);
    }
    assert!(10 * killed.writing >= 3 * count, "{killed:?}");
    println!("{killed:?} in {round} studies");
}

/// The limit stands for the end of the disk; with it gone there is room again.
#[test]
fn a_disk_that_fills_up_stops_a_study_which_goes_on_when_there_is_room() {
    let study = Study::new();
    for threads in ["1", "2"] {
        let out = format!("full-{threads}");
        study.bench.write(&format!("{out}/mine.txt"), "the user's own\n");
        let arguments = ["study", "run", STUDY, "--out", &out, "--threads", threads];
        let mut before = 0;
        for blocks in (1..=study.blocks).step_by(3) {
            let ended = Ended::from(limited(&study.bench, &arguments, blocks).output().unwrap());
            assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""), "{blocks} blocks: {}", ended.stderr);
            let errors: Vec<&str> = ended.stderr.lines().filter(|line| !line.starts_with("progress: ")).collect();
            let is_said = errors.len() == 1 && errors[0].starts_with(&format!("error: {out}/"));
            assert!(is_said && errors[0].contains(": cannot be written: "), "{blocks} blocks: {}", ended.stderr);
            assert!(errors[0].ends_with("; finished cases are kept"), "{}", ended.stderr);
            let done = study.done(&out);
            assert!(done >= before, "{before} cases, then {done}");
            before = done;
        }
        assert!(before > 0);
        let ended = run(&study.bench, &out, &[]);
        assert!(ended.stdout.contains(&format!("{} of them now", CASES - before)), "{}", ended.stdout);
        study.assert_whole(&out);
    }
}
