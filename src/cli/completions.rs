//! `stead completions`: the completion script of a shell, to standard output.

use super::arguments::CompletionsOptions;
use super::{Failure, print};

pub(super) fn run(options: &CompletionsOptions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut super::command(), "stead", &mut script);
    print(&script)
}
