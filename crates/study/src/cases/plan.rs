//! All cases of a study in a fixed order.

use super::StudyError;
use super::row::result_columns;
use super::table::{Column, ColumnKind, TableCell};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_disk::input::{InputError, sha256};
use stead_numerics::message::Note;
use stead_numerics::monitor::{Monitor, Progress};
use stead_runs::ReadError;
use stead_runs::study::{AxisValue, Study, StudyCase};

/// A case with what its result is found by.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedCase {
    /// The case.
    pub case: StudyCase,
    /// The digest of all that its result depends on.
    pub id: String,
    /// Its task.
    pub task: String,
}

/// All cases of a study, each read once and found sound.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The study file.
    pub study: Study,
    /// The cases, in the order of their numbers.
    pub cases: Vec<PlannedCase>,
    /// What its results do not say, in sentences.
    pub notes: Vec<Note>,
}

impl Plan {
    /// Reads every case of a study, side by side, and computes its digest.
    ///
    /// # Errors
    /// [`StudyError::Input`] at the first case that cannot be read, with its combination of values; and for an axis
    /// that has the name of a column of the results. [`StudyError::Stopped`] when the monitor asked to stop before the
    /// last case, each of which may have forces to compute.
    pub fn of(study: Study, monitor: &Monitor) -> Result<Self, StudyError> {
        let taken =
            |name: &&String| fixed_columns().iter().chain(&result_columns()).any(|column| column.name == **name);
        if let Some(name) = study.axes.iter().filter(|name| *name != TASK).find(taken) {
            let error =
                InputError::new(&study.file, "an axis has the name of a column of the results").in_field("axis");
            return Err(error.found(name).allowed("a name of its own").into());
        }
        let (count, done) = (study.cases.len(), AtomicUsize::new(0));
        // Cases side by side would report over each other.
        let quiet = Monitor::silent().with_stop(monitor.stop_handle()).with_deadline(monitor.deadline());
        let read = |case: &StudyCase| {
            quiet.go_on()?;
            let read = study.case(case, &quiet)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            monitor.report(Progress::Steps { stage: "reading cases", done, total: count });
            let arm = &read.run.problem.robot;
            let arm = (arm.name().to_owned(), arm.stiffness_like().is_some());
            Ok((PlannedCase { case: case.clone(), id: read.id, task: read.task }, arm))
        };
        let cases: Vec<Result<_, ReadError>> = study.cases.par_iter().map(read).collect();
        let (cases, arms): (Vec<PlannedCase>, BTreeSet<(String, bool)>) =
            cases.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        let notes = borrowed_stiffness(&arms).map(Note::from).into_iter().collect();
        Ok(Self { study, cases, notes })
    }

    /// The name of the study: that of its file.
    pub fn name(&self) -> String {
        self.study.file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The digest of the plan: of all its cases.
    pub fn digest(&self) -> String {
        let ids: String = self.cases.iter().map(|case| format!("{}\n", case.id)).collect();
        sha256(ids.as_bytes())
    }

    /// The columns of the table of results that come from the plan.
    pub(super) fn columns(&self) -> Vec<Column> {
        let mut columns = fixed_columns();
        for (index, name) in self.study.axes.iter().enumerate().filter(|(_, name)| *name != TASK) {
            let is_number = |case: &PlannedCase| matches!(case.case.values[index], AxisValue::Number(_));
            let kind = if self.cases.iter().all(is_number) { ColumnKind::Number } else { ColumnKind::Text };
            columns.push(Column::new(name, kind));
        }
        columns
    }

    /// The values under [`Plan::columns`].
    pub(super) fn cells(&self, planned: &PlannedCase, columns: &[Column]) -> Vec<TableCell> {
        let PlannedCase { case, id, task } = planned;
        let mut cells = vec![
            TableCell::Count(case.number as i64),
            TableCell::Text(id.clone()),
            TableCell::Text(task.clone()),
            TableCell::Number(case.weight),
        ];
        let values = self.study.axes.iter().zip(&case.values).filter(|(name, _)| *name != TASK);
        let kinds = columns[cells.len()..].iter().map(|column| column.kind);
        let values: Vec<TableCell> = values
            .zip(kinds)
            .map(|((_, value), kind)| match (value, kind) {
                (AxisValue::Number(number), ColumnKind::Number) => TableCell::Number(*number),
                (AxisValue::Number(number), _) => TableCell::Text(number.to_string()),
                (AxisValue::Text(text), _) => TableCell::Text(text.clone()),
            })
            .collect();
        cells.extend(values);
        cells
    }
}

/// What a comparison cannot say of arms, by their names, that have the stiffness of another one.
fn borrowed_stiffness(arms: &BTreeSet<(String, bool)>) -> Option<String> {
    let names: Vec<&str> = arms.iter().filter(|(_, is_borrowed)| *is_borrowed).map(|(name, _)| name.as_str()).collect();
    let arms =
        if arms.len() > 1 { "does not rank how stiff the arms are" } else { "does not say how stiff the arm is" };
    (!names.is_empty()).then(|| {
        format!(
            "borrowed stiffness: {}. This study compares placements and where such arms reach; it {arms}, and predicts no millimetres",
            names.join(", ")
        )
    })
}

/// The axis of the tasks has a column in any case.
const TASK: &str = "task";

/// The columns that every table of results begins with.
fn fixed_columns() -> Vec<Column> {
    vec![
        Column::new("case", ColumnKind::Count),
        Column::new("id", ColumnKind::Text),
        Column::new(TASK, ColumnKind::Text),
        Column::new("task_weight", ColumnKind::Number),
    ]
}
