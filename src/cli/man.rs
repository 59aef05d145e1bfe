//! `stead man`: the manual, one page for the command line and one for each command.

use super::Failure;
use super::manual::Manual;
use super::output::{files_written, print};
use clap::Args;
use clap_mangen::Man;
use std::path::PathBuf;
use stead_report::output::Folder;

#[derive(Debug, Args)]
pub(super) struct ManOptions {
    /// Folder for the pages; it is created where it is missing
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &["stead man ~/.local/share/man/man1", "man stead-place"],
    written: "to the folder",
    files: "\
stead.1: the overview
stead-COMMAND.1: one page for every command",
    failed: "a page could not be written",
    refused: "wrong usage, or a folder that cannot be written to",
    ..Manual::NEW
};

pub(super) fn run(options: &ManOptions, mut command: clap::Command) -> Result<(), Failure> {
    command.build();
    let folder = Folder::create(&options.folder)?;
    let mut names = Vec::new();
    write_pages(&folder, command, &mut names)?;
    print(format!("{} pages in {}\n", names.len(), folder.path().display()).as_bytes())
}

/// Writes the page of a command, then those of the commands below it; `names` receives the files.
fn write_pages(folder: &Folder, command: clap::Command, names: &mut Vec<String>) -> Result<(), Failure> {
    for below in command.get_subcommands().filter(|below| below.get_name() != "help") {
        write_pages(folder, below.clone(), names)?;
    }
    let page = Man::new(command);
    let name = page.get_filename();
    let mut bytes = Vec::new();
    page.render(&mut bytes).map_err(|e| Failure::Job(format!("{name} cannot be made: {e}")))?;
    files_written(folder.write(&name, &bytes))?;
    names.push(name);
    Ok(())
}
