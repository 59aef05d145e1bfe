//! Studies: a study file with its cases, and what becomes of them in a folder.

use crate::errors::raised;
use crate::inputs::read_or_stopped;
use crate::jobs::{Options, run_stoppable};
use crate::results::{Kind, Outcome};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use stead::Error;
use stead::study::{AxisValue, ColumnKind, Finished, Shard, StudyQuestion, StudyStatus};

/// A case: the values of its axes in their order, each a number or a text.
#[derive(IntoPyObject)]
struct Case {
    number: usize,
    id: String,
    task: String,
    weight: f64,
    values: Vec<Value>,
}

#[derive(IntoPyObject)]
enum Value {
    Number(f64),
    Text(String),
}

impl From<&AxisValue> for Value {
    fn from(value: &AxisValue) -> Self {
        match value {
            AxisValue::Number(number) => Self::Number(*number),
            AxisValue::Text(text) => Self::Text(text.clone()),
        }
    }
}

/// How the run of a shard ended.
#[derive(IntoPyObject)]
struct Ended {
    planned: usize,
    before: usize,
    now: usize,
    interrupted: bool,
    is_complete: bool,
    problems: Vec<String>,
}

impl From<Finished> for Ended {
    fn from(finished: Finished) -> Self {
        let Finished { planned, before, now, interrupted, is_complete, problems } = finished;
        Self { planned, before, now, interrupted, is_complete, problems }
    }
}

/// How far a study is.
#[derive(IntoPyObject)]
struct Status {
    planned: usize,
    done: usize,
    infeasible: usize,
    failed: usize,
    shards: Vec<ShardStatus>,
    problems: Vec<String>,
    stale: Vec<String>,
}

#[derive(IntoPyObject)]
struct ShardStatus {
    shard: (usize, usize),
    planned: usize,
    done: usize,
    without_placement: usize,
    is_running: bool,
}

impl From<StudyStatus> for Status {
    fn from(status: StudyStatus) -> Self {
        let StudyStatus { planned, done, infeasible, failed, shards, problems, stale } = status;
        let shards = shards.into_iter().map(ShardStatus::from).collect();
        Self { planned, done, infeasible, failed, shards, problems, stale }
    }
}

impl From<stead::study::ShardStatus> for ShardStatus {
    fn from(status: stead::study::ShardStatus) -> Self {
        let stead::study::ShardStatus { shard, planned, done, without, is_running } = status;
        Self { shard: (shard.index, shard.count), planned, done, without_placement: without, is_running }
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct Study(stead::Study);

#[pymethods]
impl Study {
    #[staticmethod]
    fn read(py: Python<'_>, file: PathBuf, options: Options) -> PyResult<(Option<Self>, bool)> {
        let read = move |monitor: &stead::Monitor| stead::Study::read_with(&file, monitor);
        let (result, was_stopped) = run_stoppable(py, &options, read)?;
        read_or_stopped(py, result.map(Self), was_stopped)
    }

    fn axes(&self) -> Vec<String> {
        self.0.axes().to_vec()
    }

    fn cases(&self) -> Vec<Case> {
        let case = |planned: &stead::study::PlannedCase| Case {
            number: planned.case.number,
            id: planned.id.clone(),
            task: planned.task.clone(),
            weight: planned.case.weight,
            values: planned.case.values.iter().map(Value::from).collect(),
        };
        self.0.cases().iter().map(case).collect()
    }

    fn run(&self, py: Python<'_>, folder: PathBuf, shard: &str, options: Options) -> PyResult<(Option<Ended>, bool)> {
        let shard = Shard::parse(shard).ok_or_else(|| {
            let problem = format!("no such shard, found {shard}; allowed: {}", Shard::ALLOWED);
            raised(py, Error::Argument(problem))
        })?;
        let study = self.0.clone();
        let job = move |monitor: &stead::Monitor| study.run(&folder, shard, monitor);
        let (result, was_stopped) = run_stoppable(py, &options, job)?;
        match result {
            Ok(finished) => Ok((Some(finished.into()), was_stopped)),
            Err(_) if was_stopped => Ok((None, true)),
            Err(error) => Err(raised(py, error)),
        }
    }

    fn status(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Status> {
        py.detach(|| self.0.status(&folder)).map(Status::from).map_err(|error| raised(py, error))
    }

    fn prune(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
        py.detach(|| self.0.prune(&folder)).map_err(|error| raised(py, error))
    }

    fn merge(&self, py: Python<'_>, folder: PathBuf) -> PyResult<bool> {
        py.detach(|| self.0.merge(&folder)).map_err(|error| raised(py, error))
    }

    /// The table of results as CSV, and the names of its columns of texts; nothing as long as cases are missing.
    fn results<'py>(&self, py: Python<'py>, folder: PathBuf) -> PyResult<Option<(Bound<'py, PyBytes>, Vec<String>)>> {
        let read = || {
            let Some(table) = self.0.results(&folder)? else { return Ok(None) };
            let texts = table.columns.iter().filter(|column| column.kind == ColumnKind::Text);
            Ok(Some((table.to_csv().map_err(Error::from)?, texts.map(|column| column.name.clone()).collect())))
        };
        let found: Option<(Vec<u8>, Vec<String>)> = py.detach(read).map_err(|error| raised(py, error))?;
        Ok(found.map(|(csv, texts)| (PyBytes::new(py, &csv), texts)))
    }

    fn report(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        by: Option<String>,
        front: Option<Vec<String>>,
        map: Option<[String; 2]>,
        noise: Option<f64>,
    ) -> PyResult<Outcome> {
        let usual = StudyQuestion::default();
        let question = StudyQuestion { by, front, map, noise: noise.unwrap_or(usual.noise) };
        let report = py.detach(|| self.0.report(&folder, &question));
        report.map(|report| Outcome(Kind::Study(report))).map_err(|error| raised(py, error))
    }
}
