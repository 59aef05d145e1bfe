//! Inputs: one class for each kind of file, with its jobs. A job returns its result; one that can be stopped also
//! whether Ctrl-C did that.

use crate::errors::{raised, raised_with};
use crate::jobs::{Options, run_stoppable};
use crate::results::{Kind, Outcome};
use pyo3::prelude::*;
use std::path::PathBuf;
use stead::circularity::Sector;
use stead::{Error, Placement};

/// A result, and whether Ctrl-C stopped its job.
type Done = PyResult<(Option<Outcome>, bool)>;

/// What a job has left. One that was stopped before it had a result is no error.
fn done<T>(
    result: Result<T, Error>,
    was_stopped: bool,
    kind: fn(T) -> Kind,
    raise: impl FnOnce(Error) -> PyErr,
) -> Done {
    match result {
        Ok(result) => Ok((Some(Outcome(kind(result))), was_stopped)),
        Err(_) if was_stopped => Ok((None, true)),
        Err(error) => Err(raise(error)),
    }
}

/// What was read, and whether Ctrl-C stopped what had to be computed for it.
pub fn read_or_stopped<T>(py: Python<'_>, result: Result<T, Error>, was_stopped: bool) -> PyResult<(Option<T>, bool)> {
    match result {
        Ok(read) => Ok((Some(read), was_stopped)),
        Err(_) if was_stopped => Ok((None, true)),
        Err(error) => Err(raised(py, error)),
    }
}

/// x, y, z in mm, and yaw in degrees.
type PlaceMm = (f64, f64, f64, f64);

fn placement((x, y, z, yaw): PlaceMm) -> Placement {
    Placement::from_mm_deg([x, y, z], yaw)
}

/// The JSON document in place of a result of a run.
fn infeasible(run: &stead::Run, error: &Error) -> Option<String> {
    match error {
        Error::Infeasible(nothing) => Some(run.infeasible_json(nothing).to_string()),
        _ => None,
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct Run(stead::Run);

#[pymethods]
impl Run {
    #[staticmethod]
    fn read(
        py: Python<'_>,
        file: PathBuf,
        values: Vec<String>,
        certify: Option<f64>,
        seed: Option<u64>,
        sensitivity: bool,
        options: Options,
    ) -> PyResult<(Option<Self>, bool)> {
        let values = values.iter().map(|value| stead::files::FieldOverride::parse(value));
        let values = values.collect::<Result<Vec<_>, _>>();
        let values = values.map_err(|problem| raised(py, Error::Argument(format!("set: {problem}"))))?;
        let read = move |monitor: &stead::Monitor| {
            let gap = certify.map(stead::Run::gap).transpose()?;
            let run = stead::Run::read_with(&file, values, monitor)?;
            let run = if let Some(gap) = gap { run.with_certificate(gap) } else { run };
            let run = if let Some(seed) = seed { run.with_seed(seed) } else { run };
            if sensitivity { run.with_sensitivity(stead::Run::FORCE_ERROR) } else { Ok(run) }
        };
        let (result, was_stopped) = run_stoppable(py, &options, read)?;
        read_or_stopped(py, result.map(Self), was_stopped)
    }

    /// Name and digest of each file that was read.
    fn inputs(&self) -> Vec<(String, String)> {
        self.0.inputs().iter().map(|input| (input.name.clone(), input.sha256.clone())).collect()
    }

    fn with_seed(&self, seed: u64) -> Self {
        Self(self.0.clone().with_seed(seed))
    }

    fn with_sensitivity(&self, py: Python<'_>, force_error: f64) -> PyResult<Self> {
        self.0.clone().with_sensitivity(force_error).map(Self).map_err(|error| raised(py, error))
    }

    fn without_worst(&self) -> Self {
        Self(self.0.clone().without_worst())
    }

    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }

    fn warnings(&self) -> Vec<(&'static str, String)> {
        self.0.warnings().iter().map(|warning| (warning.kind, warning.message.clone())).collect()
    }

    fn robot(&self) -> &str {
        self.0.problem().robot.name()
    }

    fn points(&self) -> usize {
        self.0.problem().task.points().len()
    }

    fn certificate_warning(&self) -> Option<(&'static str, String)> {
        self.0.certificate_warning().map(|warning| (warning.kind, warning.message))
    }

    fn outside_cell(&self, place: PlaceMm) -> Option<String> {
        self.0.outside_cell(&placement(place))
    }

    fn placement_of(&self, py: Python<'_>, results: PathBuf, case: u8) -> PyResult<PlaceMm> {
        let Placement { x, y, z, yaw } = self.0.placement_of(results, case).map_err(|error| raised(py, error))?;
        Ok((x * 1e3, y * 1e3, z * 1e3, yaw.to_degrees()))
    }

    fn place(&self, py: Python<'_>, options: Options, certify: bool) -> Done {
        let run = self.0.clone();
        let job = move |monitor: &stead::Monitor| if certify { run.place(monitor) } else { run.search(monitor) };
        let (result, was_stopped) = run_stoppable(py, &options, job)?;
        let raise = |error| raised_with(py, error, |error| infeasible(&self.0, error));
        done(result, was_stopped, Kind::Placements, raise)
    }

    fn score(&self, py: Python<'_>, place: PlaceMm, options: Options) -> Done {
        let (run, place) = (self.0.clone(), placement(place));
        let (result, was_stopped) = run_stoppable(py, &options, move |monitor| run.score(&place, monitor))?;
        let raise = |error| raised_with(py, error, |error| infeasible(&self.0, error));
        done(result, was_stopped, Kind::Score, raise)
    }

    /// As `score`, of the exact placement of a case in a results folder.
    fn score_of(&self, py: Python<'_>, results: PathBuf, case: u8, options: Options) -> Done {
        let (run, place) = self.0.clone().set_up_as_in(results, case).map_err(|error| raised(py, error))?;
        let (result, was_stopped) = run_stoppable(py, &options, move |monitor| run.score(&place, monitor))?;
        let raise = |error| raised_with(py, error, |error| infeasible(&self.0, error));
        done(result, was_stopped, Kind::Score, raise)
    }

    fn explain(&self, py: Python<'_>, place: PlaceMm, point: usize, beta_deg: f64) -> PyResult<Outcome> {
        let explained = py.detach(|| self.0.explain(&placement(place), point, beta_deg.to_radians()));
        explained.map(|result| Outcome(Kind::Explanations(result))).map_err(|error| raised(py, error))
    }

    /// As `explain`, at the exact placement of a case in a results folder.
    fn explain_of(&self, py: Python<'_>, results: PathBuf, case: u8, point: usize, beta_deg: f64) -> PyResult<Outcome> {
        let (run, place) = self.0.clone().set_up_as_in(results, case).map_err(|error| raised(py, error))?;
        let explained = py.detach(|| run.explain(&place, point, beta_deg.to_radians()));
        explained.map(|result| Outcome(Kind::Explanations(result))).map_err(|error| raised(py, error))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct AssessmentRun(stead::AssessmentRun);

#[pymethods]
impl AssessmentRun {
    #[staticmethod]
    fn read(py: Python<'_>, file: PathBuf, accuracy_mm: Option<f64>, force_n: Option<f64>) -> PyResult<Self> {
        let read = || stead::AssessmentRun::read(&file)?.selecting(accuracy_mm.map(|mm| mm / 1e3), force_n);
        py.detach(read).map(Self).map_err(|error| raised(py, error))
    }

    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }

    fn assess(&self, py: Python<'_>, options: Options) -> Done {
        let run = self.0.clone();
        let (result, was_stopped) = run_stoppable(py, &options, move |monitor| run.assess(monitor))?;
        done(result, was_stopped, Kind::Assessment, |error| raised(py, error))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct FitRun(stead::FitRun);

#[pymethods]
impl FitRun {
    #[staticmethod]
    fn read(py: Python<'_>, file: PathBuf) -> PyResult<Self> {
        py.detach(|| stead::FitRun::read(&file)).map(Self).map_err(|error| raised(py, error))
    }

    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }

    fn fit(&self, py: Python<'_>, options: Options) -> Done {
        let input = self.0.clone();
        let (result, was_stopped) = run_stoppable(py, &options, move |monitor| input.fit(monitor))?;
        done(result, was_stopped, Kind::Identified, |error| raised(py, error))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct DesignRun(stead::DesignRun);

#[pymethods]
impl DesignRun {
    #[staticmethod]
    fn read(py: Python<'_>, file: PathBuf, seed: Option<u64>) -> PyResult<Self> {
        py.detach(|| stead::DesignRun::read_with(&file, seed)).map(Self).map_err(|error| raised(py, error))
    }

    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }

    fn check_folder(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        self.0.check_folder(folder).map_err(|error| raised(py, error))
    }

    fn plan(&self, py: Python<'_>, options: Options) -> Done {
        let input = self.0.clone();
        let (result, was_stopped) = run_stoppable(py, &options, move |monitor| input.plan(monitor))?;
        done(result, was_stopped, Kind::Design, |error| raised(py, error))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct CompensationRun(stead::CompensationRun);

#[pymethods]
impl CompensationRun {
    #[staticmethod]
    fn read(
        py: Python<'_>,
        file: PathBuf,
        reality: Option<PathBuf>,
        options: Options,
    ) -> PyResult<(Option<Self>, bool)> {
        let read =
            move |monitor: &stead::Monitor| stead::CompensationRun::read_with(&file, reality.as_deref(), monitor);
        let (result, was_stopped) = run_stoppable(py, &options, read)?;
        read_or_stopped(py, result.map(Self), was_stopped)
    }

    fn notes(&self) -> Vec<String> {
        self.0.notes().iter().map(ToString::to_string).collect()
    }

    fn compensate(&self, py: Python<'_>, all_or_nothing: bool, options: Options) -> Done {
        let input = self.0.clone();
        let job = move |monitor: &stead::Monitor| {
            if all_or_nothing { input.compensate_all(monitor) } else { input.compensate(monitor) }
        };
        let document = |error: &Error| match error {
            Error::NotCompensated(failure) => Some(self.0.not_compensated_json(failure).to_string()),
            _ => None,
        };
        let (result, was_stopped) = run_stoppable(py, &options, job)?;
        done(result, was_stopped, Kind::Compensated, |error| raised_with(py, error, document))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct SimulationRun(stead::SimulationRun);

#[pymethods]
impl SimulationRun {
    #[staticmethod]
    fn read(
        py: Python<'_>,
        file: PathBuf,
        variant: Option<&str>,
        damping_scale: Option<f64>,
        spindle_rpm: Option<f64>,
    ) -> PyResult<Self> {
        let overrides = stead::simulation::overrides(variant, damping_scale, spindle_rpm);
        let read = overrides.and_then(|overrides| stead::SimulationRun::read_with(&file, &overrides));
        read.map(Self).map_err(|error| raised(py, error))
    }

    fn simulate(&self, py: Python<'_>, options: Options) -> Done {
        let input = self.0.clone();
        let job = move |monitor: &stead::Monitor| input.simulate(monitor);
        let (result, was_stopped) = run_stoppable(py, &options, job)?;
        done(result, was_stopped, Kind::Simulated, |error| raised(py, error))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct StabilityRun(stead::StabilityRun);

#[pymethods]
impl StabilityRun {
    #[staticmethod]
    fn read(
        py: Python<'_>,
        file: PathBuf,
        variant: Option<&str>,
        damping_scale: Option<f64>,
        spindle_rpm: Option<f64>,
    ) -> PyResult<Self> {
        let overrides = stead::simulation::overrides(variant, damping_scale, spindle_rpm);
        let read = overrides.and_then(|overrides| stead::StabilityRun::read_with(&file, &overrides));
        read.map(Self).map_err(|error| raised(py, error))
    }

    fn analyse(&self, py: Python<'_>, options: Options) -> Done {
        let input = self.0.clone();
        let (result, was_stopped) = run_stoppable(py, &options, move |monitor| input.analyse(monitor))?;
        done(result, was_stopped, Kind::Stability, |error| raised(py, error))
    }
}

#[pyclass(frozen, module = "stead._stead")]
pub struct Profile(stead::circularity::Profile);

#[pymethods]
impl Profile {
    #[staticmethod]
    fn read(py: Python<'_>, file: PathBuf) -> PyResult<Self> {
        py.detach(|| stead::circularity::Profile::read(&file)).map(Self).map_err(|error| raised(py, error))
    }

    fn circularity(&self, py: Python<'_>, exclude_deg: Vec<(f64, f64)>) -> PyResult<Outcome> {
        let sector = |(from, to): (f64, f64)| {
            let problem = || format!("no such sector, found ({from}, {to}); allowed: two angles from -360 to 360 deg");
            Sector::between_deg(from, to).ok_or_else(|| Error::Argument(problem()))
        };
        let found = py.detach(|| {
            let sectors = exclude_deg.into_iter().map(sector).collect::<Result<Vec<_>, _>>()?;
            self.0.circularity(&sectors)
        });
        found.map(|result| Outcome(Kind::Circularity(result))).map_err(|error| raised(py, error))
    }
}
