//! What the command line says of itself: long help, the overview, completion scripts, manual pages.

use crate::common::{Bench, files_with};
use std::path::Path;

/// Every command that does something, as it is typed.
fn commands(bench: &Bench) -> Vec<Vec<String>> {
    let overview = bench.stead(&["--help"]).stdout;
    let mut all = Vec::new();
    for name in overview.lines().filter_map(|line| line.strip_prefix("  ")).filter_map(|line| line.split(' ').next()) {
        match name {
            "" | "help" | "-h," | "-V," => {}
            "study" => {
                ["run", "status", "report", "slurm"]
                    .iter()
                    .for_each(|below| all.push(vec![name.to_owned(), (*below).to_owned()]));
            }
            "import" => ["path", "robot"].iter().for_each(|below| all.push(vec![name.to_owned(), (*below).to_owned()])),
            "identify" => ["fit", "plan"].iter().for_each(|below| all.push(vec![name.to_owned(), (*below).to_owned()])),
            _ => all.push(vec![name.to_owned()]),
        }
    }
    all
}

fn long_help(bench: &Bench, command: &[String]) -> String {
    let mut arguments: Vec<&str> = command.iter().map(String::as_str).collect();
    arguments.push("--help");
    let ended = bench.stead(&arguments);
    assert_eq!(ended.code, Some(0), "{command:?}");
    ended.stdout
}

#[test]
fn the_overview_groups_every_command_by_its_question() {
    let bench = Bench::new();
    let overview = bench.stead(&["--help"]).stdout;
    for heading in [
        "Where to put the workpiece:",
        "How good a robot is",
        "What the cut does to the tool, and the tool to the part:",
        "What the robot is to run:",
        "Exit codes:",
    ] {
        assert!(overview.contains(heading), "{heading} in {overview}");
    }
    // The parser's own list, which no group can leave a command out of.
    let listed = bench.stead(&["nonsense"]).stderr;
    assert!(listed.contains("unrecognized subcommand"), "{listed}");
    let names = commands(&bench);
    let expected =
        ["place", "score", "explain", "assess", "fit", "plan", "compensate", "simulate", "stability", "page"];
    for name in expected.into_iter().chain([
        "circularity",
        "forces",
        "export",
        "robot",
        "robots",
        "pose",
        "check",
        "init",
        "schema",
        "completions",
        "man",
    ]) {
        assert_eq!(names.iter().filter(|command| command.last().is_some_and(|last| last == name)).count(), 1, "{name}");
    }
}

#[test]
fn every_command_shows_examples_files_and_exit_codes() {
    let bench = Bench::new();
    for command in commands(&bench) {
        let help = long_help(&bench, &command);
        let typed = format!("  stead {} ", command.join(" "));
        for part in ["Example", &typed, "Files written", "Exit codes:\n  0  done", "\n  2  wrong usage"] {
            assert!(help.contains(part), "{part} in the help of {command:?}: {help}");
        }
        assert!(help.lines().all(|line| line.len() <= 130), "{help}");
    }
}

#[test]
fn completions_know_every_command_and_its_options() {
    let bench = Bench::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = bench.stead(&["completions", shell]);
        assert_eq!(script.code, Some(0), "{}", script.stderr);
        for name in commands(&bench).iter().filter_map(|command| command.last()) {
            assert!(script.stdout.contains(name.as_str()), "{name} in the script of {shell}");
        }
        assert!(script.stdout.contains("certify"), "{shell}");
    }
    let refused = bench.stead(&["completions", "tcsh"]);
    assert_eq!(refused.code, Some(2));
    refused.assert_says(&["tcsh", "bash", "zsh", "fish"]);
}

#[test]
fn the_manual_has_a_page_for_every_command() {
    let bench = Bench::new();
    let ended = bench.stead(&["man", "pages/man1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let groups = ["", "-identify", "-import", "-study"];
    let mut expected: Vec<String> = groups.iter().map(|group| format!("stead{group}.1")).collect();
    expected.extend(commands(&bench).iter().map(|command| format!("stead-{}.1", command.join("-"))));
    let mut written: Vec<String> = bench.tree("pages/man1").into_keys().collect();
    expected.sort();
    written.sort();
    assert_eq!(written, expected);
    let page = bench.read("pages/man1/stead-place.1");
    for part in [".TH", "certify", "placements.csv", "Exit codes"] {
        assert!(page.contains(part), "{part} in {page}");
    }
}

#[test]
fn a_manual_that_cannot_be_written_is_refused_at_its_folder() {
    let bench = Bench::new();
    bench.write("pages", "a file");
    let ended = bench.stead(&["man", "pages"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["error: pages: results cannot be written here"]);
    assert_eq!(bench.read("pages"), "a file");
}

/// What ARCHITECTURE.md names is there: paths, tests, and all crates.
#[test]
fn the_architecture_names_what_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let code: String = files_with(".rs").iter().map(|file| std::fs::read_to_string(file).unwrap()).collect();
    let names: Vec<&str> = text.split('`').skip(1).step_by(2).filter(|name| !name.contains([' ', '\n', '!'])).collect();
    let (paths, others): (Vec<&str>, Vec<&str>) =
        names.into_iter().partition(|name| name.contains('/') || name.ends_with(".toml"));
    let is_test = |name: &&str| name.matches('_').count() >= 2 && !name.contains([':', '.']);
    let tests: Vec<&str> = others.into_iter().filter(is_test).collect();
    let missing: Vec<&&str> = (paths.iter().filter(|path| !root.join(path).exists()))
        .chain(tests.iter().filter(|name| !code.contains(&format!("fn {name}("))))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert!(paths.len() >= 10 && tests.len() >= 20, "{} paths, {} tests", paths.len(), tests.len());
    for entry in std::fs::read_dir(root.join("crates")).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(text.contains(&format!("\n| `{name}` |")), "{name} has no row in the table of crates");
    }
}

/// Every key of every input file, as the kept schemas have them, has its place in the guide.
#[test]
fn the_guide_names_every_key_of_every_input_file() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = |folder: &str, ending: &str| -> Vec<String> {
        let entries = std::fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path());
        entries
            .filter(|path| path.to_string_lossy().ends_with(ending))
            .map(|path| std::fs::read_to_string(path).unwrap())
            .collect()
    };
    let guide = files("src/guide", ".md").concat();
    let quoted: std::collections::BTreeSet<&str> = guide.split(['`', '.', ' ', '\n', '[', ']']).collect();
    let mut missing = std::collections::BTreeSet::new();
    let mut count = 0;
    for text in files("configs/schema", ".json") {
        let mut open = vec![serde_json::from_str::<serde_json::Value>(&text).unwrap()];
        while let Some(value) = open.pop() {
            if let Some(keys) = value.get("properties").and_then(serde_json::Value::as_object) {
                count += keys.len();
                missing.extend(keys.keys().filter(|key| !quoted.contains(key.as_str())).cloned());
            }
            match value {
                serde_json::Value::Object(entries) => open.extend(entries.into_iter().map(|(_, value)| value)),
                serde_json::Value::Array(elements) => open.extend(elements),
                _ => {}
            }
        }
    }
    assert!(missing.is_empty(), "{missing:?}");
    assert!(count > 100, "{count}");
}
