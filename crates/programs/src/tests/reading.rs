//! Programs read back: the sound ones are sound, and no change of a number or a line is overlooked.

use super::super::check::{ReadBackOptions, check};
use super::super::{ExportError, ExportOptions, ProgramFormat};
use super::bench::{ARMS, Bench};
use proptest::prelude::*;
use std::path::Path;
use std::sync::OnceLock;
use stead_disk::Existing;
use stead_numerics::monitor::Monitor;

/// Whether a program is found to be another than the plan's.
fn is_found(bench: &Bench, main: &Path) -> bool {
    bench.check(main).map_or(true, |check| !check.is_sound())
}

#[test]
fn programs_are_those_of_their_plan() {
    for (arm, _, format) in ARMS {
        let bench = Bench::new(arm);
        for (folder, max_moves) in [("a", 5000), ("b", 4), ("c", 1)] {
            let program = bench.export(&ExportOptions { max_moves, ..bench.options() }).unwrap();
            let check = bench.check(&bench.written(&program, folder)).unwrap();
            assert!(check.is_sound(), "{arm}: {check:?}");
            assert_eq!((check.moves, check.joint_moves, check.expected_moves), (18, 4, 18));
            // Rounded to what is printed, also where B is a right angle.
            let [mm, deg] = [&check.position, &check.angle].map(|largest| largest.as_ref().unwrap().value);
            assert!(mm < 0.003 && deg < 5e-4, "{arm}: {mm} mm, {deg} deg");
        }
        let table = bench.export(&ExportOptions::new(ProgramFormat::Csv, "T")).unwrap();
        assert!(bench.check(&bench.written(&table, "t")).unwrap().is_sound());
        assert_eq!(bench.format, format);
    }
}

#[test]
fn other_feeds_and_other_ends_of_moves_are_found() {
    let changes: [(&str, &[(&str, &str)]); 3] = [
        (
            "kuka",
            &[
                ("$VEL.CP=0.066667", "$VEL.CP=0.060000"),
                ("$APO.CDIS=1.0000", "$APO.CDIS=1.1000"),
                ("} C_DIS\n", "}\n"),
                ("}\nLIN {X 33.333", "} C_DIS\nLIN {X 33.333"),
            ],
        ),
        (
            "abb",
            &[
                ("[66.667,500", "[66.067,500"),
                (",z_PART,", ",fine,"),
                ("],fine,t_PART\\WObj:=w_PART;\n    MoveL [[33", "],z_PART,t_PART\\WObj:=w_PART;\n    MoveL [[33"),
                ("zonedata z_PART:=[FALSE,1.000,", "zonedata z_PART:=[FALSE,1.100,"),
            ],
        ),
        (
            "fanuc",
            &[("67mm/sec", "68mm/sec"), ("CNT10", "CNT11"), ("CNT10", "FINE"), ("67mm/sec FINE", "67mm/sec CNT10")],
        ),
    ];
    for (arm, changes) in changes {
        let bench = Bench::new(arm);
        let program = bench.export(&bench.options()).unwrap();
        for (number, (from, to)) in changes.iter().enumerate() {
            let mut changed = program.clone();
            let file = changed.files.iter_mut().rfind(|file| file.text.contains(from));
            let file = file.unwrap_or_else(|| panic!("{from} in {program:?}"));
            file.text = file.text.replacen(from, to, 1);
            let found = bench.check(&bench.written(&changed, &format!("p{number}"))).unwrap();
            assert!(found.mismatch.is_some() && !found.is_sound(), "{arm}: {from} -> {to}");
        }
    }
    // As it was exported: with exact stops, or read back with another distance.
    let bench = Bench::new("kuka");
    let main = bench.written(&bench.export(&ExportOptions { blend: 0.0, ..bench.options() }).unwrap(), "exact");
    assert!(!bench.check(&main).unwrap().is_sound());
    let exact = ReadBackOptions { blend: 0.0, ..ReadBackOptions::default() };
    assert!(check(&bench.run, &bench.plan, &main, &exact, &Monitor::silent()).unwrap().is_sound());
    let table = bench.export(&ExportOptions::new(ProgramFormat::Csv, "T")).unwrap();
    let slower = table.files[0].text.replacen(",66.6670", ",66.0000", 1);
    let main = bench.written(&table, "t");
    std::fs::write(&main, slower).unwrap();
    assert!(bench.check(&main).unwrap().mismatch.unwrap().contains("the feed is 66 mm/s"));
}

/// Programs of all forms with their main files.
fn all() -> Vec<(Bench, std::path::PathBuf, Vec<std::path::PathBuf>)> {
    let mut all = Vec::new();
    for (arm, _, format) in ARMS {
        for format in [format, ProgramFormat::Csv] {
            if format == ProgramFormat::Csv && arm != "fanuc" {
                continue;
            }
            let bench = Bench::new(arm);
            let program = bench.export(&ExportOptions::new(format, "PART")).unwrap();
            let paths = program.write(&bench.path("p"), Existing::Kept).unwrap().files;
            all.push((bench, paths[0].clone(), paths));
        }
    }
    all
}

/// Whether a line moves the robot, or says in which frames it moves.
fn counts(line: &str) -> bool {
    let text = line.trim();
    let starts = ["$BASE={", "$TOOL={", "PTP ", "LIN ", "PERS ", "MoveAbsJ ", "MoveL ", "J1=", "J4=", "X =", "W ="];
    starts.iter().any(|start| text.starts_with(start))
        || text.contains(":  !UFRAME ")
        || text.contains(":  !UTOOL ")
        || text.contains(",joint,")
        || text.contains(",linear,")
}

/// The places of the numbers of a line, with a decimal point, from byte to byte; not those that say how fast, how near
/// or how heavy.
fn numbers(line: &str) -> Vec<(usize, usize)> {
    let mut places = Vec::new();
    let end =
        line.find("],[66").or_else(|| line.find(",fine")).or_else(|| line.find("]],[1.000,")).unwrap_or(line.len());
    let end = if line.contains(",linear,") { line.rfind(',').unwrap() } else { end };
    let mut start = None;
    for (at, c) in line.char_indices().chain([(line.len(), ' ')]) {
        if c.is_ascii_digit() || c == '.' || c == '-' {
            start = start.or(Some(at));
        } else if let Some(from) = start.take()
            && line[from..at].contains('.')
            && at <= end + 1
        {
            places.push((from, at));
        }
    }
    places
}

#[test]
fn no_change_of_a_number_is_overlooked() {
    for (bench, main, files) in all() {
        let (mut changes, mut overlooked) = (0, Vec::new());
        for file in &files {
            let original = std::fs::read_to_string(file).unwrap();
            let lines: Vec<&str> = original.lines().collect();
            for (index, line) in lines.iter().enumerate().filter(|(_, line)| counts(line)) {
                for (from, to) in numbers(line) {
                    let value: f64 = line[from..to].parse().unwrap();
                    // A twentieth of a millimetre or a degree; in a quaternion as much as 0.06 deg.
                    let by = if line[from..to].len() > 10 && value.abs() <= 1.0 { 5e-4 } else { 0.05 };
                    let changed = format!("{}{:.9}{}", &line[..from], value + by, &line[to..]);
                    let mut mutant = lines.clone();
                    mutant[index] = &changed;
                    std::fs::write(file, mutant.join("\n") + "\n").unwrap();
                    changes += 1;
                    if !is_found(&bench, &main) {
                        overlooked.push(changed);
                    }
                }
            }
            std::fs::write(file, original).unwrap();
        }
        assert!(changes > 100, "{changes} in {}", main.display());
        assert!(overlooked.is_empty(), "{overlooked:#?}");
        assert!(!is_found(&bench, &main));
    }
}

#[test]
fn no_line_that_is_missing_or_twice_is_overlooked() {
    for (bench, main, files) in all() {
        let mut overlooked = Vec::new();
        for file in &files {
            let original = std::fs::read_to_string(file).unwrap();
            let lines: Vec<&str> = original.lines().collect();
            // Also calls of parts, and moves of TP programs, which stand apart from their positions.
            let wanted =
                |line: &&str| counts(line) || line.contains("PART_01") && !line.contains("DEF") || line.contains("P[");
            for (index, line) in lines.iter().enumerate().filter(|(_, line)| wanted(line)) {
                let is_name = ["MODULE", "PROC", "/PROG"].iter().any(|word| line.contains(word));
                if is_name || line.starts_with("; $") {
                    continue;
                }
                let mut without = lines.clone();
                without.remove(index);
                std::fs::write(file, without.join("\n") + "\n").unwrap();
                if !is_found(&bench, &main) {
                    overlooked.push(format!("without {line}"));
                }
                let is_move = ["PTP ", "LIN ", "Move"].iter().any(|word| line.trim().starts_with(word))
                    || line.contains(":J P[")
                    || line.contains(":L P[")
                    || line.contains(",linear,");
                if is_move {
                    let mut twice = lines.clone();
                    twice.insert(index, line);
                    std::fs::write(file, twice.join("\n") + "\n").unwrap();
                    if !is_found(&bench, &main) {
                        overlooked.push(format!("twice {line}"));
                    }
                }
            }
            std::fs::write(file, original).unwrap();
        }
        assert!(overlooked.is_empty(), "{overlooked:#?}");
    }
}

#[test]
fn a_joint_that_is_a_turn_away_and_a_move_of_the_other_kind_are_found() {
    let bench = Bench::new("kuka");
    let program = bench.export(&bench.options()).unwrap();
    let main = bench.written(&program, "p");
    let file = bench.path("p/PART_01.src");
    let original = std::fs::read_to_string(&file).unwrap();
    let joint = original.lines().find(|line| line.starts_with("PTP")).unwrap();
    let (head, last) = joint.trim_end_matches('}').rsplit_once(' ').unwrap();
    let angle: f64 = last.parse().unwrap();
    for turned in [angle + 360.0, angle - 360.0] {
        std::fs::write(&file, original.replace(joint, &format!("{head} {turned:.5}}}"))).unwrap();
        let check = bench.check(&main).unwrap();
        assert!(check.mismatch.as_ref().is_some_and(|text| text.contains("axis 6 is a turn away")), "{check:?}");
    }
    for (from, to) in
        [("LIN {", "CIRC {"), ("PTP {A1", "SPTP {A1"), ("\nEND\n", "\nFOR I=1 TO 3\nEND\n"), ("$TOOL={", "$TOOL.Z={")]
    {
        std::fs::write(&file, original.replacen(from, to, 1)).unwrap();
        let message = bench.check(&main).unwrap_err().to_string();
        assert!(message.contains("PART_01.src:") && message.contains("not understood"), "{message}");
    }
    let statement = bench.check(&bench.path("p/PART.txt")).unwrap_err().to_string();
    assert!(statement.contains("cannot be read"), "{statement}");
    std::fs::write(bench.path("p/PART.txt"), "").unwrap();
    assert!(bench.check(&bench.path("p/PART.txt")).unwrap_err().to_string().contains("allowed: a main program"));
    std::fs::remove_file(&file).unwrap();
    assert!(bench.check(&main).unwrap_err().to_string().contains("the part PART_01 is not beside this file"));
}

#[test]
fn a_program_of_another_approach_is_found() {
    let bench = Bench::new("kuka");
    let program = bench.export(&ExportOptions { approach: 0.04, ..bench.options() }).unwrap();
    let check = bench.check(&bench.written(&program, "p")).unwrap();
    let largest = check.position.as_ref().unwrap();
    assert!((largest.value - 10.0).abs() < 0.01 && largest.at.is_retracted && !check.is_sound());
}

/// Programs that stay for damage.
fn lasting() -> &'static Vec<(Bench, std::path::PathBuf, Vec<std::path::PathBuf>)> {
    static ALL: OnceLock<Vec<(Bench, std::path::PathBuf, Vec<std::path::PathBuf>)>> = OnceLock::new();
    ALL.get_or_init(all)
}

proptest! {
    #[test]
    fn a_damaged_program_is_read_or_refused(
        which in 0..4_usize, at in 0.0..1.0_f64, cut in 0..40_usize, put in "[ -~\n\u{e4}]{0,6}"
    ) {
        let (bench, _, files) = &lasting()[which];
        let file = files.last().unwrap();
        let mut bytes = std::fs::read(file).unwrap();
        let at = (at * bytes.len() as f64) as usize;
        let end = (at + cut).min(bytes.len());
        bytes.splice(at..end, put.bytes());
        // Beside the others, under a name of its own.
        let damaged = file.with_file_name("DAMAGED").with_extension(file.extension().unwrap());
        std::fs::write(&damaged, bytes).unwrap();
        if let Err(error) = bench.check(&damaged) {
            let ExportError::Input(error) = error else { panic!("{error}") };
            prop_assert!(error.allowed.is_some(), "{}", error);
        }
    }
}
