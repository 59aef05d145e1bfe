//! States in the program from which commit, for which target and with which profile it was built.

use std::path::Path;
use std::process::Command;

fn main() {
    let variable = |name| std::env::var(name).unwrap_or_default();
    // target/[TARGET/]PROFILE/build/stead-HASH/out: the variable `PROFILE` knows `debug` and `release` alone.
    let out = variable("OUT_DIR");
    let folder = Path::new(&out).ancestors().nth(3).and_then(|folder| folder.file_name()?.to_str());
    let profile = folder.unwrap_or("unknown");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=STEAD_COMMIT");
    println!("cargo::rustc-env=STEAD_TARGET={}", variable("TARGET"));
    println!("cargo::rustc-env=STEAD_PROFILE={profile}");
    println!("cargo::rustc-env=STEAD_COMMIT={}", commit(profile).as_deref().unwrap_or("unknown"));
}

/// The commit: that of a variable, of the repository, or of the package that cargo has made of it. Builds for tests do
/// not state it, so that a commit makes none of them anew.
fn commit(profile: &str) -> Option<String> {
    let given = std::env::var("STEAD_COMMIT").ok().filter(|given| !given.is_empty());
    if given.is_some() || profile == "debug" {
        return given;
    }
    if let Ok(packaged) = std::fs::read_to_string(".cargo_vcs_info.json") {
        return packaged.split('"').find(|word| word.len() == 40).map(|commit| commit[..12].to_owned());
    }
    // Where it is no clone of its own, a repository above is somebody else's.
    if !Path::new(".git").exists() {
        return None;
    }
    if Path::new(".git/logs/HEAD").exists() {
        println!("cargo::rerun-if-changed=.git/logs/HEAD");
    }
    let output = |arguments: &[&str]| {
        let run = Command::new("git").args(arguments).output().ok().filter(|run| run.status.success());
        run.and_then(|run| String::from_utf8(run.stdout).ok())
    };
    let commit = output(&["rev-parse", "--short=12", "HEAD"])?;
    let changed = output(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(format!("{}{}", commit.trim(), if changed.is_empty() { "" } else { " with changes" }))
}
