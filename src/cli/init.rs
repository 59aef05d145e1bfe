//! `stead init`: a commented starter set of files that runs.

use super::arguments::{InitOptions, Starter};
use super::{Failure, print};
use stead_format::init::{StarterSet, init};

pub(super) fn run(options: &InitOptions) -> Result<(), Failure> {
    let (set, command) = match options.kind {
        Starter::Place => (StarterSet::Place, "place"),
        Starter::Assess => (StarterSet::Assess, "assess"),
        Starter::Identify => (StarterSet::Identify, "identify fit"),
        Starter::Simulate => (StarterSet::Simulate, "simulate"),
    };
    let files = init(set, &options.folder).map_err(stead::Error::from)?;
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let first = names.first().cloned().unwrap_or_default();
    print(format!("written: {}\nnow run: stead {command} {first}\n", names.join(", ")).as_bytes())
}
