//! `stead init`: a commented starter set of files that runs.

use super::Failure;
use super::given::Force;
use super::manual::Manual;
use super::output::print;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use stead::files::{StarterSet, init, init_forces, init_run};

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
    /// With forces: tool path (CLDATA, G-code or CSV) that a forces file is written for
    #[arg(long, value_name = "FILE", requires = "out", conflicts_with_all = ["robot", "task"])]
    pub path: Option<PathBuf>,
    /// With forces: closed mesh (STL, OBJ, DAE) of the stock
    #[arg(long, value_name = "FILE", requires = "path")]
    pub stock: Option<PathBuf>,
    /// The file (TOML) to write: for --robot and --task, or for --path
    #[arg(long, value_name = "FILE")]
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
    Forces,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead init place my-cell",
        "stead init simulate my-arm",
        "stead init place --robot my/kr210.toml --task my/part.csv --out my/run.toml",
        "stead init forces --path my/part.nc --out my/forces.toml",
    ],
    written: "to the folder",
    files: "\
place: run.toml, robot.toml, task.csv, cell.toml
assess: assess.toml, robot.toml
identify: identify.toml, robot.toml, sheet.csv
simulate: simulate.toml, robot.toml (for stead stability too)
study: study.toml and the files of place; beside a run.toml that is there, study.toml alone
compensate: compensate.toml, likewise
forces: forces.toml, part.nc",
    remarks: "With --robot, --task and --out: one run file for files that are there, with the shapes (ROBOT-cell.toml) \
              and the cutter (TASK-tool.toml) that stead import has left beside them. With --path and --out: one \
              forces file for that path. What they do not say is a guess, named in `guesses`.",
    refused: "wrong usage, or one of the files exists already (--force replaces it): nothing is written and nothing is changed",
    ..Manual::NEW
};

pub(super) fn run(options: &InitOptions) -> Result<(), Failure> {
    if let (Some(robot), Some(task), Some(out)) = (&options.robot, &options.task, &options.out) {
        return run_file(options, robot, task, out);
    }
    if let (Some(path), Some(out)) = (&options.path, &options.out) {
        if options.kind != Starter::Forces {
            return Err(Failure::Usage("--path goes with `stead init forces`".to_owned()));
        }
        init_forces(path, options.stock.as_deref(), out, options.force.existing()).map_err(stead::Error::from)?;
        let name = out.display();
        let text = format!("written: {name}\nnow edit it, and run: stead forces {name} --out TASK.csv\n");
        return print(text.as_bytes());
    }
    if options.out.is_some() {
        let allowed = "--out goes with --robot and --task, or for `stead init forces` with --path";
        return Err(Failure::Usage(allowed.to_owned()));
    }
    let folder = options.folder.as_deref().unwrap_or(Path::new("."));
    let (set, command) = match options.kind {
        Starter::Place => (StarterSet::Place, "place"),
        Starter::Assess => (StarterSet::Assess, "assess"),
        Starter::Identify => (StarterSet::Identify, "identify fit"),
        Starter::Simulate => (StarterSet::Simulate, "simulate"),
        Starter::Study => (StarterSet::Study, "study run"),
        Starter::Compensate => (StarterSet::Compensate, "compensate"),
        Starter::Forces => (StarterSet::Forces, "forces"),
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
    let after = match options.kind {
        Starter::Forces => format!(" --out {}", folder.join("task.csv").display()),
        _ => String::new(),
    };
    print(format!("written: {}\nnow run: {before}stead {command} {first}{after}\n", names.join(", ")).as_bytes())
}

/// A run file for a robot and a task that are there.
fn run_file(options: &InitOptions, robot: &Path, task: &Path, out: &Path) -> Result<(), Failure> {
    if options.kind != Starter::Place {
        return Err(Failure::Usage("--robot, --task and --out go with `stead init place`".to_owned()));
    }
    init_run(robot, task, out, options.force.existing()).map_err(stead::Error::from)?;
    let name = out.display();
    print(format!("written: {name}\nnow edit it, and run: stead check {name}\n").as_bytes())
}
