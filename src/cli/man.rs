//! `stead man`: the manual, one page for the command line and one for each command.

use super::arguments::ManOptions;
use super::{Failure, files_written, print};
use clap_mangen::Man;
use stead_report::output::Folder;

pub(super) fn run(options: &ManOptions) -> Result<(), Failure> {
    let mut command = super::command();
    command.build();
    let folder = Folder::create(&options.folder).map_err(Failure::Output)?;
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
