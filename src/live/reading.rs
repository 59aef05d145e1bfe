//! The run as it is read now, and a placement of it that a page asks about.

use super::place::Place;
use crate::Run;
use crate::files::FieldOverride;
use serde_json::Value;
use std::sync::Arc;
use stead_report::placement::Context;

/// A run as it is read with the values that were changed last.
#[derive(Debug)]
pub(super) struct Reading {
    /// Raised with every change.
    pub version: u64,
    pub run: Run,
    pub context: Context,
    /// Values in place of those of the file, changed in the session.
    pub edits: Vec<FieldOverride>,
}

impl Reading {
    pub fn new(version: u64, run: Run, edits: Vec<FieldOverride>) -> Self {
        let context = Context::new(&run.run);
        Self { version, run, context, edits }
    }
}

/// A placement that a page asks about.
#[derive(Debug)]
pub(super) struct Asked {
    /// The number that the page gives to the request.
    pub id: usize,
    pub place: Place,
    pub reading: Arc<Reading>,
}

impl Asked {
    /// An answer with what it is about.
    pub fn about(&self, mut answer: Value) -> Value {
        let problem = self.reading.run.problem();
        answer["id"] = self.id.into();
        answer["version"] = self.reading.version.into();
        answer["place"] = self.place.entry(problem);
        answer["outside_cell"] = self.reading.run.outside_cell(&self.place.placement).into();
        answer
    }
}
