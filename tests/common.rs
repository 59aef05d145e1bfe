//! A folder with a run of its own, and the command run in it.

use assert_cmd::cargo::cargo_bin;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The run file of a [`Bench`], from its folder.
pub const RUN: &str = "configs/run.toml";

/// A temporary folder with the published case in it: run file, robot and task as in the crate, and a search so small
/// that it takes seconds. The command runs in this folder.
pub struct Bench {
    folder: TempDir,
}

/// How the command ended and what it said.
pub struct Ended {
    /// Exit code; none after a signal.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Bench {
    /// Copies the files.
    pub fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        bench.copy("configs/caro-2013.toml", RUN);
        bench.copy_all(&["configs/robots/kuka-kr270-2.toml", "tasks/five-segments.csv"]);
        bench.replace(RUN, "population = 120\n", "population = 16\n");
        bench.replace(RUN, "generations = 51\n", "generations = 3\nbasins = 2\n");
        bench.replace(RUN, "beta_step_deg = 3.0", "beta_step_deg = 7.2");
        bench
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// What is in a file.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Writes a file as the result of an earlier run of a command: with a manifest that lists it.
    pub fn write_result(&self, command: &str, file: &str, text: &str) {
        self.write(file, text);
        let (folder, name) = file.rsplit_once('/').unwrap();
        let set = stead_disk::manifest::ResultSet {
            command: command.to_owned(),
            version: "0.1.0".to_owned(),
            complete: true,
            interrupted: false,
            inputs: Vec::new(),
            files: vec![stead_disk::manifest::ResultFile::of(name, text.as_bytes())],
        };
        let manifest = stead_disk::manifest::Manifest::default().with(set).to_bytes().unwrap();
        self.write(&format!("{folder}/manifest.json"), std::str::from_utf8(&manifest).unwrap());
    }

    /// Writes a file, and the folders to it.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Writes a shipped file, by its path in the crate, under another name.
    pub fn copy(&self, from: &str, to: &str) {
        self.write(to, &std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(from)).unwrap());
    }

    /// Writes shipped files under their own names.
    pub fn copy_all(&self, names: &[&str]) {
        names.iter().for_each(|name| self.copy(name, name));
    }

    /// Replaces the first place where a text stands in a file, which must be there. Returns its line, from 1.
    pub fn replace(&self, name: &str, from: &str, to: &str) -> usize {
        let text = self.read(name);
        let at = text.find(from).unwrap_or_else(|| panic!("{from} is not in {name}"));
        self.write(name, &text.replacen(from, to, 1));
        1 + text[..at].matches('\n').count()
    }

    /// The command in this folder, not started yet.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(cargo_bin!("stead"));
        command.current_dir(self.folder.path()).args(arguments);
        command
    }

    /// Runs the command to its end; neither output is a terminal. `place` and `score` are asked for all that there is
    /// to say in place of the summary.
    pub fn stead(&self, arguments: &[&str]) -> Ended {
        let is_asked = matches!(arguments, ["place" | "score", _, ..]) && !arguments.contains(&"--help");
        let all: &[&str] = if is_asked { &["--notes"] } else { &[] };
        self.stead_in_short(&[arguments, all].concat())
    }

    /// Runs the command to its end as it is given.
    pub fn stead_in_short(&self, arguments: &[&str]) -> Ended {
        Ended::from(self.command(arguments).output().unwrap())
    }

    /// The names of everything below a folder.
    pub fn names(&self, below: &str) -> Vec<String> {
        self.tree(below).into_keys().collect()
    }

    /// Every file and folder below a folder of this one, by its path from there; folders have no content.
    pub fn tree(&self, below: &str) -> BTreeMap<String, Option<Vec<u8>>> {
        let root = self.path(below);
        let mut tree = BTreeMap::new();
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                let name = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
                if path.is_dir() {
                    tree.insert(name, None);
                    folders.push(path);
                } else {
                    tree.insert(name, Some(std::fs::read(path).unwrap()));
                }
            }
        }
        tree
    }
}

impl From<std::process::Output> for Ended {
    fn from(output: std::process::Output) -> Self {
        // Names of files with slashes, whatever the system writes between folders.
        let text = |bytes| {
            let text = String::from_utf8(bytes).unwrap();
            if cfg!(windows) && !text.starts_with('{') { text.replace('\\', "/") } else { text }
        };
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

impl Ended {
    /// Standard error but for notes that the published case may have: that the scored part is small beside the whole
    /// deflection, that collisions were not checked, that it goes over the back of the robot, and how calm its plan is.
    pub fn said(&self) -> String {
        let expected = [
            "note: the scored part of the deflection, ",
            "note: collisions were not checked: nothing stands around",
            "note: the best plan goes over the back of the robot",
            "note: a calmer plan costs little: ",
            "note: axis ",
        ];
        let lines = self.stderr.lines().filter(|line| !expected.iter().any(|note| line.starts_with(note)));
        lines.map(|line| format!("{line}\n")).collect()
    }

    /// The one JSON document that is all of standard output. It states what every document of stead states.
    pub fn json(&self) -> serde_json::Value {
        let document: serde_json::Value =
            serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e} in {} and {}", self.stdout, self.stderr));
        assert_states_its_origin(&document);
        document
    }

    /// Asserts that standard error has each of some parts.
    pub fn assert_says(&self, parts: &[&str]) {
        for part in parts {
            let part = if cfg!(windows) { part.replace('\\', "/") } else { (*part).to_owned() };
            assert!(self.stderr.contains(&part), "{part} is not in {}", self.stderr);
        }
    }
}

/// Asserts that a JSON document has the layout's number, the version, the inputs with their digests, and notes and
/// warnings.
pub fn assert_states_its_origin(document: &serde_json::Value) {
    assert_eq!(document["format"], 1, "{document}");
    assert_eq!(document["version"], env!("CARGO_PKG_VERSION"));
    let inputs = document["inputs"].as_array().unwrap();
    assert!(
        !inputs.is_empty() && inputs.iter().all(|input| input["sha256"].as_str().unwrap().len() == 64),
        "{inputs:?}"
    );
    for key in ["notes", "warnings"] {
        assert!(document[key].as_array().unwrap().iter().all(|message| message.is_string()), "{key}");
    }
}

/// The files of the repository whose names end so, without what is built or fetched.
pub fn files_with(ending: &str) -> Vec<PathBuf> {
    let (mut folders, mut found) = (vec![PathBuf::from(env!("CARGO_MANIFEST_DIR"))], Vec::new());
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir()
                && !name.starts_with('.')
                && !["target", "node_modules", "results"].contains(&name.as_str())
            {
                folders.push(path);
            } else if name.ends_with(ending) {
                found.push(path);
            }
        }
    }
    found
}
