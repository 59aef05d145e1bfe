//! Runs from code: a problem in memory in place of a run file.

use crate::monitor::Note;
use crate::{Error, Run};
use serde_json::Value;
use std::fmt::Display;
use std::ops::Bound::{Excluded, Included};
use std::ops::RangeBounds;
use stead_model::published::Published;
use stead_problem::problem::Problem;
use stead_problem::settings::{CertificateSettings, LookupUse, PostureSearch, SearchSettings, TransferSettings};
use stead_problem::table_shape::Shape;

/// What [`Run::place`] does with a problem, and how hard it tries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceOptions {
    /// How hard to search.
    pub search: SearchSettings,
    /// Limits of the moves between segments.
    pub transfer: TransferSettings,
    /// The certificate, where one is wanted.
    pub certificate: Option<CertificateSettings>,
    /// Whether deflection maps are made.
    pub maps: bool,
    /// Whether a page is left with the files.
    pub page: bool,
}

impl Default for PlaceOptions {
    /// As of a run file that states none of it.
    fn default() -> Self {
        let (search, transfer) = (SearchSettings::default(), TransferSettings::default());
        Self { search, transfer, certificate: None, maps: true, page: true }
    }
}

impl PlaceOptions {
    /// Checks the numbers, which are within the same ranges as in a run file.
    ///
    /// # Errors
    /// [`Error::Argument`] with the first that is out of range, what it is and what is allowed.
    pub fn check(&self) -> Result<(), Error> {
        let SearchSettings { population, generations, basins, path_points, sensitivity, .. } = self.search;
        let TransferSettings { acceleration_time, jerk_time, blend } = self.transfer;
        let whole = [
            ("search.population", Some(population), 4..=100_000),
            ("search.generations", Some(generations), 0..=100_000),
            ("search.basins", Some(basins), 1..=64),
            ("search.path_points", path_points, 1..=1_000_000_000),
        ];
        for (what, found, allowed) in whole {
            if let Some(found) = found.filter(|found| !allowed.contains(found)) {
                return Err(refused(what, found, format!("{} to {}", allowed.start(), allowed.end())));
            }
        }
        let certificate = |value: fn(CertificateSettings) -> Option<f64>| self.certificate.and_then(value);
        let (gap, memory) =
            (certificate(|requested| Some(requested.gap)), certificate(|requested| Some(requested.memory as f64)));
        let time_limit = certificate(|requested| requested.time_limit);
        let positive = (Excluded(0.0), Excluded(f64::INFINITY));
        let gaps = (Included(CertificateSettings::MIN_GAP), Excluded(1.0));
        let numbers = [
            ("search.sensitivity", sensitivity, (Excluded(0.0), Excluded(1.0)), "above 0 and below 1, or none"),
            ("transfer.acceleration_time", Some(acceleration_time), positive, "a finite time above 0 s"),
            ("transfer.jerk_time", Some(jerk_time), positive, "a finite time above 0 s"),
            ("transfer.blend", Some(blend), (Included(0.0), Included(1.0)), "0 to 1 m"),
            ("certificate.gap", gap, gaps, "1e-6 to below 1"),
            ("certificate.time_limit", time_limit, positive, "a finite time above 0 s, or none"),
            ("certificate.memory", memory, (Included(1e6), Included(1e15)), "1e6 to 1e15 bytes"),
        ];
        for (what, found, range, allowed) in numbers {
            if let Some(found) = found.filter(|found| !range.contains(found)) {
                return Err(refused(what, found, allowed));
            }
        }
        Ok(())
    }

    /// Checks what depends on the problem.
    fn check_for(&self, problem: &Problem) -> Result<(), Error> {
        let (points, segments) = (problem.task.points().len(), problem.task.segments().len());
        if let Some(requested) = self.search.path_points.filter(|requested| !(segments..=points).contains(requested)) {
            return Err(refused(
                "search.path_points",
                requested,
                format!("{segments} (segments) to {points} (points)"),
            ));
        }
        if self.search.tables == LookupUse::Always
            && let Err(unsuited) = Shape::of(problem)
        {
            return Err(refused("search.tables", "Always", format!("Auto or Never: there can be none, {unsuited}")));
        }
        self.search.check_for(problem).map_err(|unfit| Error::Argument(format!("search of PlaceOptions: {unfit}")))?;
        if self.search.postures == PostureSearch::Genetic && !problem.postures.may_change {
            return Err(refused("search.postures", "Genetic", "Exact, where postures may not change"));
        }
        Ok(())
    }
}

/// What of the options is out of range.
fn refused(what: &str, found: impl Display, allowed: impl Display) -> Error {
    Error::Argument(format!("{what} of PlaceOptions is {found}; allowed: {allowed}"))
}

/// A run that is made of a problem.
#[derive(Debug, Clone)]
pub struct RunBuilder {
    problem: Problem,
    options: PlaceOptions,
    reference: Option<Published<[f64; 4]>>,
}

impl RunBuilder {
    /// With published figures to print beside ours: the mean deflections of the four cases. mm
    #[must_use]
    pub fn reference(self, reference: Published<[f64; 4]>) -> Self {
        Self { reference: Some(reference), ..self }
    }

    /// With these options in place of the usual ones.
    #[must_use]
    pub fn options(self, options: PlaceOptions) -> Self {
        Self { options, ..self }
    }

    /// The run. Its results name no input files, which is among its notes.
    ///
    /// # Errors
    /// As of [`PlaceOptions::check`], and for options that the problem does not allow.
    pub fn build(self) -> Result<Run, Error> {
        self.options.check()?;
        self.options.check_for(&self.problem)?;
        let Self { problem, options: PlaceOptions { search, transfer, certificate, maps, page }, reference } = self;
        let text = "the problem comes from a program, not from files: these results name no inputs";
        let mut notes = vec![Note::from(text.to_owned())];
        notes.extend(problem.notes());
        notes.extend(problem.unchecked_collisions());
        let (inputs, stated, path_stability) = (Vec::new(), Value::Null, None);
        let run = stead_runs::Run {
            problem,
            search,
            transfer,
            certificate,
            maps,
            page,
            inputs,
            stated,
            reference,
            path_stability,
            removal: None,
            notes,
            warnings: Vec::new(),
        };
        Ok(Run::of(run))
    }
}

impl Run {
    /// A run of a problem that was built in code ([`Problem::builder`]).
    ///
    /// ```
    /// use stead::placement::{Cell, Interval, Problem, Redundancy};
    /// use stead::{Monitor, PlaceOptions, Run};
    /// # let shipped = stead::Run::read("configs/caro-2013.toml")?;
    /// # let shipped = shipped.problem();
    /// # let (robot, spindle, task) = (shipped.robot.clone(), shipped.spindle, shipped.task.clone());
    /// // A robot, a spindle and a task, from code or from files.
    /// let range = |min, max| Interval { min, max };
    /// let position = [range(-0.3, 0.3), range(-2.2, -1.7), range(-0.5, -0.5)];
    /// let cell = Cell { position, yaw: range(-3.2, 3.2) };
    /// let problem = Problem::builder(robot, spindle, task, cell, Redundancy::new(60, 0.05)).build()?;
    /// let mut options = PlaceOptions::default();
    /// (options.search.population, options.search.generations, options.search.worst) = (16, 4, false);
    /// let placements = Run::builder(problem).options(options).build()?.place(&Monitor::silent())?;
    /// assert!(placements.cases().best.plan.mean < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn builder(problem: Problem) -> RunBuilder {
        RunBuilder { problem, options: PlaceOptions::default(), reference: None }
    }
}
