//! `stead schema`: the JSON Schema of a kind of file or document, to standard output.

use super::Failure;
use super::manual::Manual;
use super::output::print;
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct SchemaOptions {
    /// Kind of input file, as run, robot or study, or of document, as place-summary or score-result; a wrong name lists
    /// all
    pub name: String,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &["stead schema run > run.schema.json", "stead schema robot", "stead schema place-summary"],
    written: "none; the schema goes to standard output",
    remarks: "An editor that knows TOML completes and checks the keys of a file whose first line is `#:schema` and the \
              path of its schema. The schema of a document that a command writes states unit (x-unit) and decimals \
              (x-decimals) of its figures.",
    refused: "wrong usage, or there is no schema of this name",
    ..Manual::NEW
};

pub(super) fn run(options: &SchemaOptions) -> Result<(), Failure> {
    let schema = stead::files::schema(&options.name).map_err(|error| Failure::Usage(error.to_string()))?;
    print(schema.as_bytes())
}
