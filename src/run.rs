//! Placement runs: a robot, a spindle, a tool path and a cell, read from a run file.

use crate::monitor::Warning;
use crate::result::{Report, result};
use crate::score::{Explanations, PlacementScore};
use crate::{Error, Monitor};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use stead_certify as certify;
use stead_certify::{self, Certificate};
use stead_format::field::{FieldOverride, FieldOverrides};
use stead_numerics::message::Note;
use stead_placement::outcome::{Cases, Outcome};
use stead_placement::place::{Infeasible, setup_at};
use stead_planning::feasibility;
use stead_problem::problem::{Placement, Problem};
use stead_problem::settings::CertificateSettings;
use stead_problem::setup::Setup;
use stead_removal::cut::CutFigures;
use stead_report::certificate::{
    certificate_files, certificate_json, certificate_text, has_certificate, write_certificate,
};
use stead_report::document::Timing;
use stead_report::page::put_page;
use stead_report::placement::{
    Context, Summary, evaluation, place_json, placement_files, placement_summary, placement_text, write_placement,
};
use stead_report::{Files, Folder};
use stead_run_files as run_files;
use stead_study::{self as study, Placed, Scored};

/// A run file with the robot and the task that it names, read and checked.
///
/// ```
/// let run = stead::Run::read("configs/caro-2013.toml")?;
/// assert_eq!(run.problem().robot.name(), "KUKA KR270-2");
/// assert_eq!(run.problem().task.points().len(), 105);
/// # Ok::<(), stead::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Run {
    pub(crate) run: Arc<stead_runs::Run>,
    /// Whether the positions of the external axes are those of a result, and not to be looked for.
    pub(crate) is_set_up: bool,
}

impl Run {
    /// The relative size of the force error of `stead place --sensitivity`.
    pub const FORCE_ERROR: f64 = stead_problem::settings::SearchSettings::FORCE_ERROR;

    pub(crate) fn of(run: stead_runs::Run) -> Self {
        Self { run: Arc::new(run), is_set_up: false }
    }

    /// Reads a run file and the files that it names. Forces of a table `[stock]` are computed at once, which may take
    /// long: [`Run::read_with`] shows how far it is.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self::of(run_files::read_run(file.as_ref())?))
    }

    /// Reads a run file with values that take the place of its own, or of those of the files that it names: each by its
    /// path from the run file on.
    ///
    /// # Errors
    /// As [`Run::read`]; an error in such a value says which it is. [`Error::Stopped`] when the monitor asked to stop
    /// before the forces of a table `[stock]` were computed.
    ///
    /// ```
    /// use stead::Monitor;
    /// use stead::files::FieldOverride;
    /// let values = ["cell.z_mm=[-602, -402]", "robot.joints[1].stiffness_mnm_per_rad=0.8"];
    /// let values = values.map(FieldOverride::parse).into_iter().collect::<Result<Vec<_>, _>>()?;
    /// let run = stead::Run::read_with("configs/caro-2013.toml", values, &Monitor::silent())?;
    /// assert_eq!(run.problem().cell.position[2].max, -0.402);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read_with(file: impl AsRef<Path>, values: Vec<FieldOverride>, monitor: &Monitor) -> Result<Self, Error> {
        Ok(Self::of(run_files::read_run_with(file.as_ref(), &FieldOverrides(values), monitor)?))
    }

    /// The same run with a certificate of this gap (relative), whatever the file says of one.
    #[must_use]
    pub fn with_certificate(mut self, gap: f64) -> Self {
        let run = Arc::make_mut(&mut self.run);
        let settings = run.certificate.unwrap_or(CertificateSettings::new(gap));
        run.certificate = Some(CertificateSettings { gap, ..settings });
        self
    }

    /// The same run with a certificate that ends after so many seconds, with the bound that it has by then.
    ///
    /// # Errors
    /// [`Error::Argument`] where the run has no certificate.
    pub fn with_time_limit(mut self, seconds: f64) -> Result<Self, Error> {
        let Some(settings) = &mut Arc::make_mut(&mut self.run).certificate else {
            let problem = "a time limit without a certificate; allowed: --certify or a table [certificate] beside it";
            return Err(Error::Argument(problem.to_owned()));
        };
        settings.time_limit = Some(seconds);
        Ok(self)
    }

    /// What its path cuts of its stock, in a few figures, where it has one.
    pub fn cut(&self) -> Option<CutFigures> {
        self.run.removal.as_ref().and_then(|removal| removal.cut)
    }

    /// Whether it asks for a certificate.
    pub fn is_certified(&self) -> bool {
        self.run.certificate.is_some()
    }

    /// The gap of a certificate from per cent, for [`Run::with_certificate`].
    ///
    /// # Errors
    /// [`Error::Argument`] with the gaps that are allowed.
    pub fn gap(per_cent: f64) -> Result<f64, Error> {
        let wrong =
            || Error::Argument(format!("no such gap, found {per_cent} %; allowed: {}", run_files::GAPS_ALLOWED));
        CertificateSettings::gap(per_cent).ok_or_else(wrong)
    }

    /// The same run with another seed of the random numbers.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        Arc::make_mut(&mut self.run).search.seed = seed;
        self
    }

    /// The same run with the basins of the best placement refined once more where scores have to cover force errors of
    /// a relative size, to see how far the optimum moves.
    ///
    /// # Errors
    /// [`Error::Argument`] where the problem has none ([`SearchSettings::check_for`]).
    ///
    /// [`SearchSettings::check_for`]: stead_problem::settings::SearchSettings::check_for
    pub fn with_sensitivity(mut self, force_error: f64) -> Result<Self, Error> {
        let run = Arc::make_mut(&mut self.run);
        run.search.sensitivity = Some(force_error);
        run.search.check_for(&run.problem).map_err(|unfit| Error::Argument(format!("--sensitivity: {unfit}")))?;
        Ok(self)
    }

    /// The same run with the part in one of its orientations, by name.
    ///
    /// # Errors
    /// [`Error::Argument`] with the names that are allowed.
    pub fn in_orientation(mut self, name: &str) -> Result<Self, Error> {
        let problem = &self.run.problem;
        let Some(orientation) = problem.orientations.iter().position(|known| known.name == name) else {
            let names: Vec<&str> = problem.orientations.iter().map(|known| known.name.as_str()).collect();
            let allowed =
                if names.is_empty() { "none: the run has no [cell] orientations".to_owned() } else { names.join(", ") };
            return Err(Error::Argument(format!("no such orientation, found {name}; allowed: {allowed}")));
        };
        let setup = Setup { orientation, ..problem.setup.clone() };
        let problem = problem.in_setup(&setup).into_owned();
        Arc::make_mut(&mut self.run).problem = problem;
        Ok(self)
    }

    /// The same run without a search for the worst placement, whatever the file says of one: it takes half of the time.
    #[must_use]
    pub fn without_worst(mut self) -> Self {
        Arc::make_mut(&mut self.run).search.worst = false;
        self
    }

    /// The same run with part and external axes set up as for case 1 (the best) or 3 (the worst) in a results folder
    /// that `stead place` has written from the same files; with the exact placement of the case. A search that was
    /// interrupted, and a run file that has changed since in keys on which no score depends, are notes of the run.
    ///
    /// # Errors
    /// [`Error::Input`] for a folder that is no such result, or one of other files.
    pub fn set_up_as_in(mut self, results: impl AsRef<Path>, case: u8) -> Result<(Self, Placement), Error> {
        let (placement, setup, notes) = stead_runs::read_setup_of(results.as_ref(), case, &self.run)?;
        let problem = self.run.problem.in_setup(&setup).into_owned();
        let run = Arc::make_mut(&mut self.run);
        run.problem = problem;
        run.notes.extend(notes.into_iter().map(Note::from));
        self.is_set_up = true;
        Ok((self, placement))
    }

    /// The run with external axes and leaning tool as a given placement is best, unless they are set up already.
    fn set_up_at(&self, placement: &Placement, monitor: &Monitor) -> Arc<stead_runs::Run> {
        let problem = &self.run.problem;
        if self.is_set_up || (problem.external_axes.is_empty() && problem.lean.is_none()) {
            return Arc::clone(&self.run);
        }
        let problem = problem.in_setup(&setup_at(problem, placement, monitor)).into_owned();
        Arc::new(stead_runs::Run { problem, ..(*self.run).clone() })
    }

    /// The same run without a page among its files, whatever the file says of one.
    #[must_use]
    pub fn without_page(mut self) -> Self {
        Arc::make_mut(&mut self.run).page = false;
        self
    }

    /// What is to be solved.
    pub fn problem(&self) -> &Problem {
        &self.run.problem
    }

    /// The files that were read.
    pub fn inputs(&self) -> &[crate::files::InputFile] {
        &self.run.inputs
    }

    /// What the user should know about the input though it is not wrong, in sentences.
    pub fn notes(&self) -> &[Note] {
        &self.run.notes
    }

    /// What the user should see to in the input.
    pub fn warnings(&self) -> &[Warning] {
        &self.run.warnings
    }
}

impl Run {
    /// Searches for the best and the worst placement ([`Run::without_worst`]: the best alone), each with its best and
    /// its worst redundancy plan; with the certificate, where the run file asks for one. A stop that the monitor asks
    /// for leaves the best found so far.
    ///
    /// # Errors
    /// [`Error::Infeasible`] when no placement met satisfies the constraints.
    pub fn place(&self, monitor: &Monitor) -> Result<Placements, Error> {
        let mut placements = self.search(monitor)?;
        placements.certify(monitor);
        Ok(placements)
    }

    /// As [`Run::place`], without a certificate.
    ///
    /// # Errors
    /// As [`Run::place`].
    pub fn search(&self, monitor: &Monitor) -> Result<Placements, Error> {
        let started = Instant::now();
        let Placed { mut outcome, stability } = study::place(&self.run, monitor)?;
        if self.run.page {
            outcome.make_sheet(&self.run.problem, monitor);
        }
        outcome.interrupted |= monitor.should_stop();
        let timing = Timing { wall: started.elapsed().as_secs_f64(), threads: rayon::current_num_threads() };
        let mut context = Context { stability, ..Context::new(&self.run) };
        context.warnings.extend(outcome.warnings.iter().cloned());
        context.notes.extend(outcome.notes.iter().cloned());
        Ok(Placements { run: Arc::clone(&self.run), outcome, context, timing, certificate: None })
    }

    /// Why the run cannot be certified, where it asks for a certificate and that is so: to be said before a long
    /// search.
    pub fn certificate_warning(&self) -> Option<Warning> {
        let settings = self.run.certificate?;
        certify::certifiable(self.problem(), settings.memory).err().map(|reason| certify::no_certificate(&reason))
    }

    /// What the certificate costs more than others, where the run asks for one and can be certified: to be said before
    /// a long search.
    pub fn certificate_note(&self) -> Option<String> {
        self.run.certificate.filter(|_| self.certificate_warning().is_none())?;
        certify::expected_cost(self.problem())
    }

    /// A note on a placement outside the cell, which is evaluated all the same.
    pub fn outside_cell(&self, placement: &Placement) -> Option<String> {
        study::outside_cell(&self.run, placement)
    }

    /// The JSON document in place of a result where no placement satisfies the constraints: which constraint fails at
    /// which points.
    pub fn infeasible_json(&self, nothing: &Infeasible) -> Value {
        evaluation::infeasible_json(nothing, &Context::new(&self.run))
    }

    /// The exact placement of case 1 (the best) or 3 (the worst) in a results folder that `stead place` has written
    /// from the same files.
    ///
    /// # Errors
    /// [`Error::Input`] for a folder that is no such result, or one of other files.
    pub fn placement_of(&self, results: impl AsRef<Path>, case: u8) -> Result<Placement, Error> {
        Ok(stead_runs::read_placement_of(results.as_ref(), case, &self.run)?)
    }

    /// Plans a given placement, best and worst: external axes stand where it is best, unless a result says where
    /// ([`Run::set_up_as_in`]). A stop that the monitor asks for leaves out the critical depths.
    ///
    /// # Errors
    /// [`Error::Infeasible`] with the constraint that fails at which points; [`Error::Argument`] for a placement that
    /// is not of finite numbers.
    pub fn score(&self, placement: &Placement, monitor: &Monitor) -> Result<PlacementScore, Error> {
        finite(placement)?;
        let run = self.set_up_at(placement, monitor);
        let Scored { score, stability, notes } = study::score(&run, placement, monitor)?;
        let mut context = Context { stability, ..Context::new(&self.run) };
        context.warnings.extend(score.warnings.iter().cloned());
        context.notes.extend(notes);
        context.notes.extend(score.notes.iter().cloned());
        Ok(PlacementScore { run, score, map: None, context })
    }

    /// What each of the eight postures gives at a path point (from 0) and a free angle beta (rad).
    ///
    /// # Errors
    /// [`Error::Argument`] for a point that the path does not have, and for a placement that is not of finite numbers.
    pub fn explain(&self, placement: &Placement, point: usize, beta: f64) -> Result<Explanations, Error> {
        finite(placement)?;
        let last = self.problem().task.points().len() - 1;
        if point > last {
            return Err(Error::Argument(format!("no such path point, found {point}; allowed: 0 to {last}")));
        }
        let postures = feasibility::explain(self.problem(), placement, point, beta);
        let mut context = Context::new(&self.run);
        let computed = [
            study::outside_cell(&self.run, placement),
            feasibility::standing_axes(self.problem(), point, self.is_set_up),
            feasibility::unscored(self.problem(), point),
        ];
        context.notes.extend(computed.into_iter().flatten().map(Note::from));
        Ok(Explanations { placement: *placement, point, beta, postures, context })
    }
}

/// Refuses a placement that is not of finite numbers.
fn finite(placement: &Placement) -> Result<(), Error> {
    let Placement { x, y, z, yaw } = *placement;
    if [x, y, z, yaw].into_iter().all(f64::is_finite) {
        return Ok(());
    }
    Err(Error::Argument(format!("no such placement, found {x}, {y}, {z} m, {yaw} rad; allowed: finite numbers")))
}

/// The best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table III.
#[derive(Debug, Clone)]
pub struct Placements {
    run: Arc<stead_runs::Run>,
    outcome: Outcome,
    context: Context,
    timing: Timing,
    certificate: Option<Certificate>,
}

impl Placements {
    /// How the search went and what it found, in SI units.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// The four cases: best placement with best and worst plan, worst placement with best and worst plan; the first two
    /// where the worst placement was not looked for.
    pub fn cases(&self) -> &Cases {
        &self.outcome.cases
    }

    /// How long it took.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Bounds how far these placements are from the best and the worst possible, as the run file asks, or within the
    /// gap given when it was read; does nothing where neither asks for it. What falls short is among the certificate's
    /// warnings.
    pub fn certify(&mut self, monitor: &Monitor) -> Option<&Certificate> {
        let settings = self.run.certificate?;
        let Cases { best, worst, .. } = &self.outcome.cases;
        let worst = worst.as_ref().map(|worst| &worst.best.placement);
        self.certificate =
            Some(certify::certify(&self.run.problem, &best.placement, best.plan.objective, worst, settings, monitor));
        self.certificate.as_ref()
    }

    /// The result in a few lines, without the certificate.
    pub fn summary(&self) -> Summary {
        placement_summary(&self.run.problem, &self.outcome, &self.context)
    }

    /// What the command prints of the certificate, if there is one.
    pub fn certificate_text(&self) -> Option<String> {
        self.certificate.as_ref().map(certificate_text)
    }

    /// Writes the files of the certificate alone, if there is one, to the files of these placements or where there are
    /// no results.
    ///
    /// # Errors
    /// [`Error::Output`]: the folder or a file cannot be written, or has results of another run.
    pub fn write_certificate(&self, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        self.write_certificate_in(&Folder::create(folder.as_ref())?)
    }

    /// As [`write_certificate`](Self::write_certificate), into a folder that this process holds already.
    ///
    /// # Errors
    /// As [`write_certificate`](Self::write_certificate).
    pub fn write_certificate_in(&self, folder: &Folder) -> Result<Vec<PathBuf>, Error> {
        let Some(certificate) = &self.certificate else { return Ok(Vec::new()) };
        let problem = &self.run.problem;
        let files = placement_files(problem, &self.outcome, &self.context)?;
        Ok(write_certificate(folder, problem, certificate, &self.run.inputs, (files, self.outcome.interrupted))?)
    }

    /// Whether a certificate is requested and a folder has finished results with one, which stay there until the new
    /// one is there, too: then nothing is to be written before [`certify`](Self::certify), and all with
    /// [`write_in`](Self::write_in) after it.
    ///
    /// # Errors
    /// [`Error::Output`]: the manifest of the folder cannot be read.
    pub fn waits_for_certificate(&self, folder: &Folder) -> Result<bool, Error> {
        Ok(self.run.certificate.is_some() && has_certificate(folder)?)
    }

    /// How far from the best and the worst possible these placements are, where that was requested.
    pub fn certificate(&self) -> Option<&Certificate> {
        self.certificate.as_ref()
    }
}

impl Report for Placements {
    fn write_files(&self, folder: &Folder) -> Result<Vec<PathBuf>, Error> {
        let is_interrupted = self.certificate.as_ref().is_some_and(Certificate::is_interrupted);
        // An interrupted certificate leaves a finished one, with the results that it is of, where they are.
        let beside = if is_interrupted && has_certificate(folder)? { Some(folder.beside()?) } else { None };
        let folder = beside.as_ref().unwrap_or(folder);
        let mut files = write_placement(folder, &self.run.problem, &self.outcome, &self.context)?;
        // The page is written again, with the certificate in it.
        let more = self.write_certificate_in(folder)?;
        files.retain(|path| !more.contains(path));
        files.extend(more);
        Ok(files)
    }

    fn files(&self) -> Result<Files, Error> {
        let mut files = placement_files(&self.run.problem, &self.outcome, &self.context)?;
        if let Some(certificate) = &self.certificate {
            files.extend(certificate_files(&self.run.problem, certificate, &self.run.inputs)?);
            put_page(&mut files)?;
        }
        Ok(files)
    }

    fn document(&self) -> Value {
        let mut document = place_json(&self.run.problem, &self.outcome, &self.context, &self.timing);
        if let (Some(certificate), Value::Object(entries)) = (&self.certificate, &mut document) {
            entries.insert("certificate".to_owned(), certificate_json(certificate, &self.run.inputs));
        }
        document
    }

    fn table(&self) -> String {
        let table = placement_text(&self.run.problem, &self.outcome, &self.context);
        match self.certificate_text() {
            Some(certificate) => format!("{table}\n{certificate}"),
            None => table,
        }
    }

    fn notes(&self) -> &[Note] {
        &self.context.notes
    }

    fn warnings(&self) -> &[Warning] {
        &self.context.warnings
    }
}

result!(Placements);
