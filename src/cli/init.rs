//! `stead init`: a commented starter set of files that runs.

use super::given::Force;
use super::{Failure, print};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use stead::{Existing, StarterSet, init, init_run};

#[derive(Debug, Args)]
pub(super) struct InitOptions {
    /// Command that the files are for
    pub kind: Starter,
    /// Folder for the files; it is created where it is missing
    #[arg(value_name = "DIR", required_unless_present = "out", conflicts_with = "out")]
    pub folder: Option<PathBuf>,
    /// With place: robot file, or a shipped arm as name:kuka-kr500, that a run file is written for
    #[arg(long, value_name = "FILE", requires = "out")]
    pub robot: Option<PathBuf>,
    /// With place: tool path (CSV) that a run file is written for
    #[arg(long, value_name = "FILE", requires = "out")]
    pub task: Option<PathBuf>,
    /// With place: the run file (TOML) to write for --robot and --task
    #[arg(long, value_name = "FILE", requires_all = ["robot", "task"])]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

/// The commands that there is a starter set for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Starter {
    Place,
    Assess,
    Identify,
    Simulate,
    Study,
    Compensate,
}

pub(super) fn run(options: &InitOptions) -> Result<(), Failure> {
    if let (Some(robot), Some(task), Some(out)) = (&options.robot, &options.task, &options.out) {
        return run_file(options.kind, [robot, task, out], options.force.existing());
    }
    let folder = options.folder.as_deref().unwrap_or(Path::new("."));
    let (set, command) = match options.kind {
        Starter::Place => (StarterSet::Place, "place"),
        Starter::Assess => (StarterSet::Assess, "assess"),
        Starter::Identify => (StarterSet::Identify, "identify fit"),
        Starter::Simulate => (StarterSet::Simulate, "simulate"),
        Starter::Study => (StarterSet::Study, "study run"),
        Starter::Compensate => (StarterSet::Compensate, "compensate"),
    };
    let files = init(set, folder, options.force.existing()).map_err(stead::Error::from)?;
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let first = names.first().cloned().unwrap_or_default();
    let before = match options.kind {
        Starter::Compensate => {
            let [run, results] = ["run.toml", "results"].map(|name| folder.join(name));
            format!("stead place {} --out {}\n         ", run.display(), results.display())
        }
        _ => String::new(),
    };
    print(format!("written: {}\nnow run: {before}stead {command} {first}\n", names.join(", ")).as_bytes())
}

/// A run file for a robot and a task that are there.
fn run_file(kind: Starter, [robot, task, out]: [&Path; 3], existing: Existing) -> Result<(), Failure> {
    if kind != Starter::Place {
        return Err(Failure::Usage("--robot, --task and --out go with `stead init place`".to_owned()));
    }
    init_run(robot, task, out, existing).map_err(stead::Error::from)?;
    let name = out.display();
    print(format!("written: {name}\nnow edit it, and run: stead check {name}\n").as_bytes())
}
