//! Values that take the place of those of the files.

use super::path::{FieldPath, PathError, Step, written};
use std::fmt;
use std::path::{Path, PathBuf};
use toml::de::DeValue;

/// A value that takes the place of that of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldOverride {
    /// From the run file on.
    path: FieldPath,
    /// Steps of the path that lead to the file that the value is put into.
    passed: usize,
    /// The value in TOML.
    value: String,
    /// The folder that names of files in the value are relative to; that of the file that is read where there is none.
    folder: Option<PathBuf>,
}

impl FieldOverride {
    /// A value in TOML for a field.
    ///
    /// # Errors
    /// [`PathError`] for a text that is no value in TOML.
    pub fn new(path: FieldPath, value: impl Into<String>) -> Result<Self, PathError> {
        let value = value.into().trim().to_owned();
        let refused = |problem: String| PathError { problem: format!("the value of {path} {problem}") };
        if value.contains(['\n', '\r']) {
            return Err(refused("is not on one line".to_owned()));
        }
        if let Err(error) = DeValue::parse(&value) {
            return Err(refused(format!("'{value}' is not readable as TOML: {}", error.message().trim())));
        }
        Ok(Self { path, passed: 0, value, folder: None })
    }

    /// The same, with names of files in the value relative to a folder.
    #[must_use]
    pub fn in_folder(self, folder: &Path) -> Self {
        Self { folder: Some(folder.to_owned()), ..self }
    }

    /// From `PATH=VALUE`. A value that begins like a word or the name of a file needs no quotes.
    ///
    /// # Errors
    /// [`PathError`] for a text without `=`, with no path before it or no value behind.
    ///
    /// ```
    /// use stead_format::field::FieldOverride;
    /// assert_eq!(FieldOverride::parse("robot=robots/a.toml")?.to_string(), "robot=\"robots/a.toml\"");
    /// assert_eq!(FieldOverride::parse("cell.z_mm = [-300, 0]")?.to_string(), "cell.z_mm=[-300, 0]");
    /// # Ok::<(), stead_format::field::PathError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, PathError> {
        let (path, value) = text
            .split_once('=')
            .ok_or_else(|| PathError { problem: format!("'{text}' has no '=' between path and value") })?;
        let (path, value): (FieldPath, _) = (path.trim().parse()?, value.trim());
        let is_word = value.starts_with(|c: char| c.is_alphabetic() || ['.', '/', '_'].contains(&c))
            && !value.contains(['"', '\'', '[', ']', '{', '}', '\\'])
            && DeValue::parse(value).is_err();
        if is_word { Self::new(path, format!("\"{value}\"")) } else { Self::new(path, value) }
    }

    /// The path of the field, from the run file on.
    pub fn path(&self) -> &FieldPath {
        &self.path
    }

    /// The value in TOML.
    pub fn value(&self) -> &str {
        &self.value
    }

    /// The steps within the file that the value is put into.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.path.0[self.passed..]
    }

    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The same value as that of the file that a field of this one names, where the path leads there.
    pub(crate) fn within(&self, field: &str) -> Option<Self> {
        let steps = self.steps();
        let passed = (1..steps.len()).find(|passed| written(&steps[..*passed]) == field)?;
        Some(Self { passed: self.passed + passed, ..self.clone() })
    }
}

impl fmt::Display for FieldOverride {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.path, self.value)
    }
}

/// Values that take the place of those of a file and the files that it names, later ones over earlier ones.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FieldOverrides(pub Vec<FieldOverride>);

impl FieldOverrides {
    /// The files as they are.
    pub fn none() -> Self {
        Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_names_of_files_need_no_quotes() {
        for (text, expected) in [
            ("robot=a.toml", "robot=\"a.toml\""),
            ("task=../tasks/a b.csv", "task=\"../tasks/a b.csv\""),
            ("search.postures=exact", "search.postures=\"exact\""),
            ("output.maps=false", "output.maps=false"),
            ("a=nan", "a=nan"),
            ("a='x = y'", "a='x = y'"),
            ("search.seed=7", "search.seed=7"),
        ] {
            assert_eq!(FieldOverride::parse(text).unwrap().to_string(), expected);
        }
    }

    #[test]
    fn what_is_no_value_is_refused() {
        for (text, part) in [
            ("cell.z_mm", "has no '='"),
            ("=3", "a key is empty"),
            ("cell.z_mm=[1, 2", "'[1, 2' is not readable as TOML"),
            ("cell.z_mm=", "'' is not readable as TOML"),
            ("cell.z_mm=1\n2", "is not on one line"),
        ] {
            let message = FieldOverride::parse(text).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("; allowed: "), "{part} in {message}");
        }
    }

    #[test]
    fn a_path_goes_on_in_the_file_that_it_leads_to() {
        let k1 = FieldOverride::parse("robot.joints[1].stiffness_mnm_per_rad=0.8").unwrap();
        let within = k1.within("robot").unwrap();
        assert_eq!(written(within.steps()), "joints[1].stiffness_mnm_per_rad");
        assert_eq!(within.to_string(), k1.to_string());
        assert_eq!((k1.within("task"), k1.within("robot.joints[1].stiffness_mnm_per_rad")), (None, None));
    }
}
