//! What a job has to say about its result beside the numbers.

use serde::Serialize;
use std::fmt;

/// A reason why a result may not be what was wanted, though the job has not failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// What it is about, for programs: the same for all warnings of a kind, in kebab case.
    pub kind: &'static str,
    /// A sentence for people, without a full stop.
    pub message: String,
}

impl Warning {
    /// A warning of a kind.
    pub fn new(kind: &'static str, message: impl Into<String>) -> Self {
        Self { kind, message: message.into() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
