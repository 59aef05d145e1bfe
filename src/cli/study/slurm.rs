//! `stead study slurm`: the script of a Slurm array.

use super::read::{folder, read};
use crate::cli::Failure;
use crate::cli::manual::Manual;
use crate::cli::output::print;
use crate::cli::progress::Terminal;
use crate::cli::values::{input_file, shards, threads};
use clap::Args;
use std::path::{Path, PathBuf};
use stead::study::slurm_script;

#[derive(Debug, Args)]
pub(in crate::cli) struct StudySlurmOptions {
    /// Study file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Elements of the array, each with one shard of the study
    #[arg(long, value_name = "N", value_parser = shards, allow_negative_numbers = true)]
    pub shards: usize,
    /// Processors and threads of each element
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Folder for the results, which all nodes see [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &["stead study slurm big.toml --shards 40 --threads 4 > big.sh && sbatch big.sh"],
    written: "none; the script goes to standard output",
    remarks: "An element of the array that is killed or requeued goes on where it was; the last one writes the table.",
    refused: "wrong usage, or bad input",
    ..Manual::NEW
};

pub(super) fn run(options: &StudySlurmOptions, program: &Path) -> Result<(), Failure> {
    // What is wrong in the study is better said here than by every element.
    read(&options.config, None, &Terminal::start(None))?;
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    // Where this program lies, for all nodes. The one that runs may be an interpreter of Python.
    let stead = match program.components().count() {
        0 | 1 => std::env::current_exe().unwrap_or_else(|_| "stead".into()),
        _ => absolute(program),
    };
    let folder = folder(options.out.as_deref(), &options.config);
    let script = slurm_script(&stead, &absolute(&options.config), &absolute(&folder), options.shards, options.threads);
    print(script.as_bytes())
}
