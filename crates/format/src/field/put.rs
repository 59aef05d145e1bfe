//! A value put into the parse tree of a file.

use super::path::{Step, written};
use crate::shipped;
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Why a value cannot be put where a path leads.
pub(crate) struct Misfit {
    /// The part of the path that there is.
    pub field: String,
    /// What is wrong with it.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
}

/// The value with its places in the text moved on.
pub(crate) fn shifted(value: Spanned<DeValue<'_>>, by: usize) -> Spanned<DeValue<'_>> {
    let span = moved(value.span(), by);
    let value = match value.into_inner() {
        DeValue::Array(array) => DeValue::Array(array.into_iter().map(|entry| shifted(entry, by)).collect()),
        DeValue::Table(table) => {
            let entry = |(key, value): (Spanned<Cow<'_, str>>, _)| {
                let span = moved(key.span(), by);
                (Spanned::new(span, Cow::Owned(key.into_inner().into_owned())), shifted(value, by))
            };
            DeValue::Table(table.into_iter().map(entry).collect())
        }
        other => other,
    };
    Spanned::new(span, value)
}

fn moved(span: Range<usize>, by: usize) -> Range<usize> {
    span.start + by..span.end + by
}

/// Puts a value where a path leads, making the tables on the way that are not there; leaves everything as it is where
/// the path leads on into a file that is named on the way.
pub(crate) fn put<'a>(
    root: &mut Spanned<DeValue<'a>>,
    steps: &'a [Step],
    value: Spanned<DeValue<'a>>,
) -> Result<(), Misfit> {
    let span = value.span();
    let mut at = root;
    for (number, step) in steps.iter().enumerate() {
        let misfit = |problem: String, allowed: &str| {
            Err(Misfit { field: written(&steps[..number]), problem, allowed: allowed.to_owned() })
        };
        at = match (step, at.get_mut()) {
            (_, DeValue::String(name)) if names_a_file(name) => return Ok(()),
            (Step::Key(key), DeValue::Table(table)) => {
                if !table.contains_key(key.as_str()) {
                    let empty = Spanned::new(span.clone(), DeValue::Table(DeTable::new()));
                    table.insert(Spanned::new(span.clone(), Cow::Borrowed(key.as_str())), empty);
                }
                match table.get_mut(key.as_str()) {
                    Some(value) => value,
                    None => return Ok(()),
                }
            }
            (Step::Entry(entry), DeValue::Array(array)) => {
                let count = array.len();
                match array.get_mut(entry - 1) {
                    Some(value) => value,
                    None => return misfit(format!("has no entry [{entry}]"), &format!("entries from 1 to {count}")),
                }
            }
            (Step::Entry(entry), DeValue::Table(table)) if table.is_empty() => {
                return misfit(format!("is not there, so that it has no entry [{entry}]"), "a value for all of it");
            }
            (Step::Key(key), _) => {
                let problem = format!("is no table and names no TOML file, so that it has no key {key}");
                return misfit(problem, "the path of a field");
            }
            (Step::Entry(entry), _) => {
                return misfit(format!("is no array, so that it has no entry [{entry}]"), "the path of a field");
            }
        };
    }
    *at = value;
    Ok(())
}

/// Whether a text may be the name of a file that a path can go on in, one of a shipped arm among them.
fn names_a_file(text: &str) -> bool {
    let is_toml = text.len() > ".toml".len() && text.to_ascii_lowercase().ends_with(".toml");
    is_toml || shipped::text(Path::new(text)).is_some()
}
