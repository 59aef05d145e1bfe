//! Results that cannot be written to standard output.

use crate::common::Bench;
use std::fs::{File, OpenOptions};
use std::process::Stdio;

/// Commands whose results are quickly there, as JSON and as text.
const COMMANDS: [&[&str]; 4] = [
    &["identify", "fit", "configs/identify-example.toml", "--out", "out", "--json"],
    &["identify", "fit", "configs/identify-example.toml", "--out", "out"],
    &["circularity", "tasks/measured-groove.csv", "--json"],
    &["schema", "run"],
];

fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&["configs/identify-example.toml", "tasks/identify-example.csv", "tasks/measured-groove.csv"]);
    bench
}

/// A full disk loses the result: that is exit code 1, and what goes to files is there all the same.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_failure() {
    for arguments in COMMANDS {
        let bench = bench();
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let ended = bench.command(arguments).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let stderr = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{arguments:?}: {stderr}");
        assert!(stderr.contains("error: the result cannot be written to standard output: "), "{arguments:?}: {stderr}");
        assert_eq!(bench.path("out/report.json").exists(), arguments.contains(&"fit"), "{arguments:?}");
    }
}

/// A reader that has gone away is none: nobody is left to tell.
#[cfg(unix)]
#[test]
fn a_reader_that_has_gone_away_is_no_failure() {
    for arguments in COMMANDS {
        let bench = bench();
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let ended = bench.command(arguments).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((ended.status.code(), ended.stderr.as_slice()), (Some(0), &[][..]), "{arguments:?}");
    }
}

/// The same bytes to a file as to a pipe.
#[test]
fn a_file_is_as_good_as_a_pipe() {
    let bench = bench();
    let arguments = ["circularity", "tasks/measured-groove.csv", "--json"];
    let file = bench.path("document.json");
    let ended = bench.command(&arguments).stdout(File::create(&file).unwrap()).output().unwrap();
    assert_eq!(ended.status.code(), Some(0));
    assert_eq!(bench.read("document.json"), bench.stead(&arguments).stdout);
}
