//! `stead study slurm`: the script of a Slurm array.

use super::folder;
use crate::cli::arguments::StudySlurmOptions;
use crate::cli::{Failure, on_threads, print};
use std::path::Path;
use stead::{Study, slurm_script};

pub(super) fn run(options: &StudySlurmOptions) -> Result<(), Failure> {
    // What is wrong in the study is better said here than by every element.
    on_threads(None, || Study::read(&options.config))??;
    // Where this program lies, for all nodes.
    let stead = std::env::current_exe().unwrap_or_else(|_| "stead".into());
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = folder(options.out.as_deref(), &options.config);
    let script = slurm_script(&stead, &absolute(&options.config), &absolute(&folder), options.shards, options.threads);
    print(script.as_bytes())
}
