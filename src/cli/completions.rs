//! `stead completions`: the completion script of a shell, to standard output.

use super::Failure;
use super::manual::Manual;
use super::output::print;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap_complete::Shell;

#[derive(Debug, Args)]
pub(super) struct CompletionsOptions {
    /// Shell that the script is for
    #[arg(value_parser = PossibleValuesParser::new(["bash", "zsh", "fish"]).try_map(|name| name.parse::<Shell>()))]
    pub shell: Shell,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead completions bash > ~/.local/share/bash-completion/completions/stead",
        "stead completions zsh > ~/.zfunc/_stead",
        "stead completions fish > ~/.config/fish/completions/stead.fish",
    ],
    written: "none; the script goes to standard output",
    refused: "wrong usage",
    ..Manual::NEW
};

pub(super) fn run(options: &CompletionsOptions, mut command: clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut command, "stead", &mut script);
    print(&script)
}
