//! Files as the system gives them: disks that are full, pipes, devices, links, and names that garble the text around
//! them.

use crate::common::{Bench, Ended, RUN};
use std::os::unix::fs::symlink;
use std::process::Command;

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";

/// Runs a command under a limit of so many blocks on the size of files, in place of a full disk.
fn limited(bench: &Bench, arguments: &[&str], blocks: u64) -> Ended {
    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("ulimit -f {blocks}; exec \"$0\" \"$@\""));
    command.arg(bench.command(&[]).get_program()).args(arguments).current_dir(bench.path(""));
    Ended::from(command.output().unwrap())
}

/// Every command that leaves files: exit code 1, and nothing left of them.
#[test]
fn a_disk_that_is_full_is_exit_code_1_everywhere() {
    let bench = Bench::new();
    bench.copy("results/caro-2013/best.csv", "plan/best.csv");
    bench.copy("crates/format/src/urdf/fixtures/kuka.urdf", "kuka.urdf");
    bench.copy("crates/format/src/cam/fixtures/pocket.cls", "pocket.cls");
    bench.copy_all(&["configs/identify-example.toml", "configs/identify-plan-example.toml"]);
    bench.copy_all(&[
        "configs/robots/kuka-kr270-r2700.toml",
        "tasks/identify-example.csv",
        "tasks/measured-groove.csv",
    ]);
    let commands: [&[&str]; 12] = [
        &["init", "place", "new/starter"],
        &["init", "place", "--robot", "name:kuka-kr500", "--task", "tasks/five-segments.csv", "--out", "new/run.toml"],
        &["import", "robot", "kuka.urdf", "--out", "new/arm.toml"],
        &["import", "path", "pocket.cls", "--out", "new/task.csv"],
        &["export", RUN, "plan/best.csv", "--format", "csv", "--out", "new/PART"],
        &["check", RUN, "--out", "new/check"],
        &[
            "score",
            RUN,
            "--x-mm",
            "2.2",
            "--y-mm",
            "-1643.5",
            "--z-mm",
            "-556.4",
            "--q4",
            "0.9258",
            "--out",
            "new/score",
        ],
        &["identify", "fit", "configs/identify-example.toml", "--out", "new/fit"],
        &["identify", "plan", "configs/identify-plan-example.toml", "--out", "new/plan"],
        &["circularity", "tasks/measured-groove.csv", "--out", "new/circle"],
        &["man", "new/man"],
        &["place", RUN, "--out", "new/place"],
    ];
    let before = bench.tree("");
    for arguments in commands {
        for blocks in [0, 1] {
            let ended = limited(&bench, arguments, blocks);
            if blocks == 1 && ended.code == Some(0) {
                // What it writes is that small.
                std::fs::remove_dir_all(bench.path("new")).unwrap();
                continue;
            }
            let errors: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("error: ")).collect();
            assert_eq!((ended.code, errors.len()), (Some(1), 1), "{arguments:?}, {blocks} blocks: {}", ended.stderr);
            assert!(errors[0].contains("cannot be written: "), "{arguments:?}: {}", ended.stderr);
            let files: Vec<String> = bench
                .tree("")
                .into_iter()
                .filter(|(name, file)| file.is_some() && !before.contains_key(name))
                .map(|(name, _)| name)
                .collect();
            assert_eq!(files, [""; 0], "{arguments:?}, {blocks} blocks");
        }
    }
}

/// The help too.
#[cfg(target_os = "linux")]
#[test]
fn help_that_cannot_be_shown_is_a_failure() {
    let bench = Bench::new();
    for arguments in [&["--help"][..], &["place", "--help"], &["--version"]] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        assert_eq!(bench.command(arguments).stdout(full).status().unwrap().code(), Some(1), "{arguments:?}");
        assert_eq!(bench.stead(arguments).code, Some(0), "{arguments:?}");
    }
    assert_eq!(bench.stead(&["--nonsense"]).code, Some(2));
}

/// No command waits for a pipe, or reads a device to its end.
#[test]
fn pipes_devices_and_very_large_files_are_refused() {
    let bench = Bench::new();
    assert!(Command::new("mkfifo").arg(bench.path("pipe")).status().unwrap().success());
    let large = std::fs::File::create(bench.path("large")).unwrap();
    large.set_len(1_000_000_001).unwrap();
    let commands: [&[&str]; 8] = [
        &["place", "FILE"],
        &["check", "FILE"],
        &["import", "robot", "FILE", "--out", "a.toml"],
        &["import", "path", "FILE", "--out", "a.csv"],
        &["circularity", "FILE"],
        &["study", "run", "FILE"],
        &["export", RUN, "FILE", "--format", "csv", "--out", "PART"],
        &["export", RUN, "FILE", "--check", "FILE"],
    ];
    for (file, problem) in [
        ("pipe", "cannot be read: it is a pipe, a socket or a device, and no file"),
        ("/dev/zero", "cannot be read: it is a pipe, a socket or a device, and no file"),
        ("large", "cannot be read: it is larger than the 1 GB of the largest file that is read: 1.00 GB"),
    ] {
        for arguments in commands {
            let arguments: Vec<&str> =
                arguments.iter().map(|word| if *word == "FILE" { file } else { *word }).collect();
            let ended = bench.stead(&arguments);
            assert_eq!((ended.code, ended.said().lines().count()), (Some(2), 1), "{arguments:?}: {}", ended.stderr);
            ended.assert_says(&[problem]);
        }
    }
    for (key, at) in [(RUN, "task = \"../tasks/five-segments.csv\""), (RUN, "robot = \"robots/kuka-kr270-2.toml\"")] {
        let bench = Bench::new();
        let name = at.split(' ').next().unwrap();
        bench.replace(key, at, &format!("{name} = \"/dev/zero\""));
        let ended = bench.stead(&["place", RUN]);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        ended.assert_says(&["/dev/zero: it is a pipe, a socket or a device, and no file"]);
    }
}

/// A user who can write to a folder of results cannot have files elsewhere written by putting a link there.
#[test]
fn links_in_place_of_locks_and_journals_are_not_followed() {
    let bench = crate::study::bench();
    let mine = "the user's own\n";
    bench.write("mine.txt", mine);
    for link in
        ["place/.stead.lock", "study/study.lock", "study/shards/0001-of-0001.lock", "study/shards/0001-of-0001.jsonl"]
    {
        let path = bench.path(link);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        symlink(bench.path("mine.txt"), &path).unwrap();
        let ended = match link.starts_with("place") {
            true => bench.stead(&["place", RUN, "--out", "place"]),
            false => bench.stead(&["study", "run", crate::study::STUDY, "--out", "study"]),
        };
        assert!(matches!(ended.code, Some(1 | 2)), "{link}: {}", ended.stderr);
        assert!(ended.stderr.contains("error: "), "{link}: {}", ended.stderr);
        assert_eq!(bench.read("mine.txt"), mine, "{link}");
        std::fs::remove_file(path).unwrap();
    }
}

#[test]
fn names_that_garble_a_line_are_refused() {
    for name in ["arm\\u0007", "arm\\u001b[31m", "a\\u202Emra", "a\u{2066}rm", "arm\\nb"] {
        let bench = Bench::new();
        let robot = bench.read(ROBOT);
        let line = robot.lines().position(|line| line.starts_with("name = ")).unwrap();
        let named: Vec<String> = robot
            .lines()
            .enumerate()
            .map(|(number, text)| if number == line { format!("name = \"{name}\"") } else { text.to_owned() })
            .collect();
        bench.write(ROBOT, &named.join("\n"));
        let ended = bench.stead(&["place", RUN]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{name}: {}", ended.stderr);
        assert!(ended.stderr.contains(": name: ") && ended.stderr.contains("; allowed: "), "{name}: {}", ended.stderr);
        assert!(!ended.stderr.contains(['\u{7}', '\u{1b}', '\u{202e}', '\u{2066}']), "{name}: {}", ended.stderr);
    }
    let bench = Bench::new();
    bench.replace(RUN, "[cell]", "[cell]\norientations = [{ name = \"up\\u200F\", rpy_deg = [0, 0, 0] }]");
    let ended = bench.stead(&["place", RUN]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["name: holds a control character or a mark of writing direction"]);
}
