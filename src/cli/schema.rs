//! `stead schema`: the JSON Schema of a kind of file, to standard output.

use super::arguments::SchemaOptions;
use super::{Failure, print};

pub(super) fn run(options: &SchemaOptions) -> Result<(), Failure> {
    let schema = stead_format::schema::schema(&options.name).map_err(|error| Failure::Usage(error.to_string()))?;
    print(schema.as_bytes())
}
