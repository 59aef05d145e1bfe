//! The path of a field: keys and entries of arrays.

use std::fmt::{self, Write};
use std::str::FromStr;

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Step {
    /// A key of a table, or of the file that a key names.
    Key(String),
    /// An entry of an array, from 1.
    Entry(usize),
}

/// The path of a field: `cell.z_mm`, `robot.joints[1].stiffness_mnm_per_rad`, `spindle.xyz_mm[3]`. Entries count
/// from 1.
///
/// ```
/// use stead_format::field::FieldPath;
/// let path: FieldPath = "robot.joints[1].stiffness_mnm_per_rad".parse()?;
/// assert_eq!(path.to_string(), "robot.joints[1].stiffness_mnm_per_rad");
/// assert_eq!("cell.z_mm[0]".parse::<FieldPath>().unwrap_err().to_string(),
///     "is no path of a field: '0' is no entry; \
///      allowed: keys joined by dots and entries from 1, as in robot.joints[1].min_deg");
/// # Ok::<(), stead_format::field::PathError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FieldPath(pub(crate) Vec<Step>);

/// A text is no path of a field.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("is no path of a field: {problem}; allowed: {}", PathError::ALLOWED)]
pub struct PathError {
    /// What is wrong.
    pub problem: String,
}

impl PathError {
    /// What a path looks like.
    pub const ALLOWED: &'static str = "keys joined by dots and entries from 1, as in robot.joints[1].min_deg";

    fn new(problem: impl Into<String>) -> Self {
        Self { problem: problem.into() }
    }
}

impl FromStr for FieldPath {
    type Err = PathError;

    fn from_str(text: &str) -> Result<Self, PathError> {
        let mut steps = Vec::new();
        for part in text.split('.') {
            let (key, mut entries) = part.split_at(part.find('[').unwrap_or(part.len()));
            if key.is_empty() {
                return Err(PathError::new("a key is empty"));
            }
            if let Some(bad) = key.chars().find(|c| !(c.is_ascii_alphanumeric() || *c == '_' || *c == '-')) {
                return Err(PathError::new(format!("'{bad}' is in no key")));
            }
            steps.push(Step::Key(key.to_owned()));
            while !entries.is_empty() {
                let inside = entries.strip_prefix('[').and_then(|rest| rest.split_once(']'));
                let (number, rest) = inside.ok_or_else(|| PathError::new(format!("'{entries}' is no entry [1]")))?;
                let entry = number.parse().ok().filter(|entry| *entry > 0 && !number.starts_with('+'));
                steps.push(Step::Entry(entry.ok_or_else(|| PathError::new(format!("'{number}' is no entry")))?));
                entries = rest;
            }
        }
        Ok(Self(steps))
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&written(&self.0))
    }
}

/// Steps as a path is written.
pub(crate) fn written(steps: &[Step]) -> String {
    steps.iter().fold(String::new(), |mut text, step| {
        // Writing to a string cannot fail.
        let _ = match step {
            Step::Key(key) if text.is_empty() => text.write_str(key),
            Step::Key(key) => write!(text, ".{key}"),
            Step::Entry(entry) => write!(text, "[{entry}]"),
        };
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_written_as_they_are_read() {
        for text in ["robot", "cell.z_mm", "spindle.xyz_mm[3]", "robot.joints[1].k-2", "spindle.rotation[1][2]"] {
            assert_eq!(text.parse::<FieldPath>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_is_no_path_is_refused_with_the_reason() {
        for (text, part) in [
            ("", "a key is empty"),
            ("cell.", "a key is empty"),
            (".z_mm", "a key is empty"),
            ("[1]", "a key is empty"),
            ("cell z", "' ' is in no key"),
            ("a[0]", "'0' is no entry"),
            ("a[-1]", "'-1' is no entry"),
            ("a[+1]", "'+1' is no entry"),
            ("a[x]", "'x' is no entry"),
            ("a[1", "'[1' is no entry [1]"),
            ("a[1]b", "'b' is no entry [1]"),
            ("a]", "']' is in no key"),
        ] {
            let message = text.parse::<FieldPath>().unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("; allowed: "), "{part} in {message}");
        }
    }
}
