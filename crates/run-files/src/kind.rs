//! Files that ask for a job, told from others that are given in their place.

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use stead_disk::input::InputError;
use stead_format::document::Document;
use stead_format::file_kind::FileKind;
use stead_format::toml_file::TomlFile;

/// What a file states, as the type that declares it.
///
/// # Errors
/// [`InputError`] for a file of one of these other kinds, with the command that takes it, and for what is wrong in it.
pub(crate) fn read_unless<T: DeserializeOwned + JsonSchema>(
    others: &[FileKind],
    source: &TomlFile,
    document: &Document<'_>,
) -> Result<T, InputError> {
    document.read().map_err(|error| match FileKind::of(source.text().as_bytes()) {
        Some(kind) if others.contains(&kind) => kind.refused(source.file()),
        _ => at_the_top::<T>(error),
    })
}

/// An unknown key of a table, where the file itself has a key of this name: that it stands above the first table.
fn at_the_top<T: JsonSchema>(error: InputError) -> InputError {
    let key = error.field.as_deref().and_then(|field| field.rsplit_once('.')).map(|(_, key)| key.to_owned());
    let Some(key) = key.filter(|_| error.problem.starts_with("unknown key")) else { return error };
    let file = schemars::schema_for!(T);
    let is_known = file.get("properties").and_then(|keys| keys.get(&key)).is_some();
    if !is_known {
        return error;
    }
    let allowed = format!("{key} at the top of the file, above its first table");
    InputError { problem: "is a key of the file, not of this table".into(), allowed: Some(allowed.into()), ..error }
}
