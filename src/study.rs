//! Studies: many cases of one run.

pub use stead_runs::study::{AxisValue, StudyCase};
pub use stead_study::analysis::{Analysis as StudyAnalysis, Question as StudyQuestion, SEARCH_NOISE};
pub use stead_study::cases::{
    Column, ColumnKind, Finished, PlannedCase, Shard, ShardStatus, StudyError, StudyStatus, Table, TableCell,
    slurm_script,
};

use crate::result::result;
use crate::{Error, Monitor};
use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use stead_certify::Certificate;
use stead_disk::files;
use stead_disk::input::{InputFile, input_file};
use stead_disk::manifest::{self, Unlisted};
use stead_report::Folder;
use stead_report::certificate::write_certificate;
use stead_report::placement::{CaseOfStudy, Context, placement_files, write_placement};
use stead_report::study::{CasePages, status_json, study_files, study_json, study_text};
use stead_run_files as run_files;
use stead_study::Placed;
use stead_study::analysis::{Analysis, Question};
use stead_study::cases::{self, Keeping, Plan, RunSettings};

/// A study file with all its cases, read and checked.
///
/// ```
/// let study = stead::Study::read("configs/study-example.toml")?;
/// assert_eq!(study.cases().len(), 12);
/// # Ok::<(), stead::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Study {
    plan: Arc<Plan>,
}

impl Study {
    /// Reads a study file, the run file that it varies, and every case once.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed, and where a case is wrong with its
    /// combination of values.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(file, &Monitor::silent())
    }

    /// As [`Study::read`], with a monitor: where the run file has a table `[stock]`, the forces of every case are
    /// computed at once, which may take long.
    ///
    /// # Errors
    /// As [`Study::read`]; [`Error::Stopped`] when the monitor asked to stop before the last case was read.
    pub fn read_with(file: impl AsRef<Path>, monitor: &Monitor) -> Result<Self, Error> {
        Ok(Self { plan: Arc::new(Plan::of(run_files::read_study(file.as_ref())?, monitor)?) })
    }

    /// All cases, in the order of their numbers.
    pub fn cases(&self) -> &[PlannedCase] {
        &self.plan.cases
    }

    /// The names of the axes, in the order of the values of a case.
    pub fn axes(&self) -> &[String] {
        &self.plan.study.axes
    }

    /// Does what is left to do of a shard, on the threads of the rayon pool that it is called in, and writes the table
    /// of results once every case is done. It may be killed at any moment and goes on where it was; a stop that the
    /// monitor asks for is answered soon.
    ///
    /// # Errors
    /// [`Error::Study`]: the folder of another study, a shard that another process works on, a disk that is full;
    /// finished cases are kept.
    ///
    /// ```no_run
    /// use stead::{Monitor, Study};
    /// use stead::study::Shard;
    /// let study = Study::read("configs/study-example.toml")?;
    /// let finished = study.run("results/study-example", Shard::WHOLE, &Monitor::silent())?;
    /// assert!(finished.is_complete);
    /// # Ok::<(), stead::Error>(())
    /// ```
    pub fn run(&self, folder: impl AsRef<Path>, shard: Shard, monitor: &Monitor) -> Result<Finished, Error> {
        let folder = folder.as_ref();
        let keeping = self.folder(folder);
        let threads = rayon::current_num_threads();
        Ok(cases::run(&self.plan, &RunSettings { folder, shard, threads, keeping: &keeping }, monitor)?)
    }

    /// How far the study is in a folder, which need not be there.
    ///
    /// # Errors
    /// [`Error::Study`]: the folder of another study, or a file that cannot be read.
    pub fn status(&self, folder: impl AsRef<Path>) -> Result<StudyStatus, Error> {
        let folder = folder.as_ref();
        Ok(StudyStatus { stale: self.folder(folder).stale(), ..cases::status(&self.plan, folder)? })
    }

    /// Removes the kept cases in a folder that the study as it is now has not: those of values that an edit has
    /// changed. Only what `manifest.json` lists is removed; a folder that something else is in stays. Returns the
    /// folders that are gone.
    ///
    /// # Errors
    /// As [`Study::status`], and [`Error::Output`] for a case that another process writes, or one that cannot be
    /// removed.
    pub fn prune(&self, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let folder = folder.as_ref();
        let stale = self.status(folder)?.stale;
        let mut gone = Vec::new();
        for path in stale.into_iter().map(|name| folder.join(CASES).join(name)) {
            Folder::create(&path)?.clear()?;
            // It stays where something of the user's is in it.
            if std::fs::remove_dir(&path).is_ok() {
                gone.push(path);
            }
        }
        Ok(gone)
    }

    /// What `stead study status --json` prints.
    pub fn status_json(&self, status: &StudyStatus) -> Value {
        status_json(&self.plan.name(), status, &self.plan.study.inputs)
    }

    /// The table of results, one row for each case; nothing as long as cases are missing.
    ///
    /// # Errors
    /// As [`Study::status`]; [`Error::Input`] too where `study.csv` is there and not as its run has left it, by
    /// `manifest.json`: cut short or changed.
    pub fn results(&self, folder: impl AsRef<Path>) -> Result<Option<Table>, Error> {
        let folder = folder.as_ref();
        let file = folder.join(cases::TABLE);
        if let Ok(bytes) = files::read(&file) {
            manifest::check(&file, &bytes, Unlisted::Refused)?;
        }
        Ok(cases::merged(&self.plan, folder)?)
    }

    /// Writes `study.csv` and `study-timing.csv` from the shards where every case is done, and says whether it is so.
    ///
    /// # Errors
    /// As [`Study::status`], and where a file cannot be written.
    pub fn merge(&self, folder: impl AsRef<Path>) -> Result<bool, Error> {
        let folder = folder.as_ref();
        Ok(cases::merge(&self.plan, folder, &self.folder(folder))?)
    }

    /// What a study that is done says: which layout is best, which compromises there are, what each axis does, and what
    /// failed and why.
    ///
    /// # Errors
    /// As [`Study::results`]; [`Error::Study`] too where cases are missing; [`Error::Argument`] for a column or an axis
    /// that is not there, or a column without numbers.
    ///
    /// ```no_run
    /// use stead::Study;
    /// use stead::study::StudyQuestion;
    /// let study = Study::read("configs/study-example.toml")?;
    /// let question = StudyQuestion { by: Some("best_max_total_mm".to_owned()), ..StudyQuestion::default() };
    /// let report = study.report("results/study-example", &question)?;
    /// println!("{report}");
    /// report.write("results/study-example")?;
    /// # Ok::<(), stead::Error>(())
    /// ```
    pub fn report(&self, folder: impl AsRef<Path>, question: &Question) -> Result<StudyReport, Error> {
        let folder = folder.as_ref();
        let Some(table) = self.results(folder)? else {
            let StudyStatus { done, planned, .. } = self.status(folder)?;
            return Err(Error::Study(StudyError::Folder {
                path: folder.to_owned(),
                problem: format!("only {done} of {planned} cases of the study are done"),
                allowed: "the folder of a study that is done (stead study run)".to_owned(),
            }));
        };
        let mut analysis = Analysis::of(&table, question).map_err(|error| Error::Argument(error.to_string()))?;
        analysis.notes.clone_from(&self.plan.notes);
        let csv = input_file("table", cases::TABLE, &table.to_csv()?);
        let inputs = self.plan.study.inputs.iter().cloned().chain([csv]).collect();
        Ok(StudyReport { plan: Arc::clone(&self.plan), analysis, inputs, pages: self.pages(folder) })
    }

    /// The pages of the cases that are kept in a folder of results.
    fn pages(&self, folder: &Path) -> CasePages {
        let results = self.folder(folder);
        let page = |case: &PlannedCase| {
            let name = results.name_of_case(case);
            let is_there = results.of_case(case).join("report.html").is_file() && results.is_kept(case);
            is_there.then(|| (case.case.number as i64, format!("{CASES}/{name}/report.html")))
        };
        self.plan.cases.iter().filter_map(page).collect()
    }

    /// The folder of results as cases and tables are put into it.
    fn folder<'s>(&'s self, path: &'s Path) -> StudyFolder<'s> {
        StudyFolder { path, plan: &self.plan }
    }
}

/// What a study says.
#[derive(Debug, Clone)]
pub struct StudyReport {
    plan: Arc<Plan>,
    analysis: Analysis,
    /// The files of the study, and its table.
    inputs: Vec<InputFile>,
    /// The pages of the cases that are kept.
    pages: CasePages,
}

impl StudyReport {
    /// Ranking, front, effects, map and failures.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }
}

result! { StudyReport, self {
    write(folder) = folder.results("study report", &self.inputs).write(&self.files()?);
    files = study_files(&self.plan.name(), &self.analysis, &self.inputs, &self.pages);
    document = study_json(&self.plan.name(), &self.analysis, &self.inputs);
    table = study_text(&self.plan.name(), &self.analysis);
    notes = self.analysis.notes;
} }

/// The command in whose name the table is written, and that of what is derived from it.
const RUN: &str = "study run";
const REPORT: &str = "study report";
/// The folder of kept cases in that of a study.
const CASES: &str = "cases";
/// How long a table waits for a report that is just being written to the same folder.
const PATIENCE: Duration = Duration::from_secs(60);

/// The folder of a study: its table, and the folders of cases, each with what `stead place` leaves.
struct StudyFolder<'s> {
    path: &'s Path,
    plan: &'s Plan,
}

impl StudyFolder<'_> {
    fn name_of_case(&self, case: &PlannedCase) -> String {
        format!("{:04}-{}", case.case.number, case.id.get(..8).unwrap_or_default())
    }

    /// The names of folders of kept cases that are none of the study as it is now, in their order.
    fn stale(&self) -> Vec<String> {
        let known: HashSet<String> = self.plan.cases.iter().map(|case| self.name_of_case(case)).collect();
        let entries = std::fs::read_dir(self.path.join(CASES)).into_iter().flatten().flatten();
        let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
        let names = folders.filter_map(|entry| entry.file_name().into_string().ok());
        let mut stale: Vec<String> = names.filter(|name| is_of_case(name) && !known.contains(name)).collect();
        stale.sort();
        stale
    }

    fn of_case(&self, case: &PlannedCase) -> PathBuf {
        self.path.join(CASES).join(self.name_of_case(case))
    }

    /// Which case it is, as its page says.
    fn case_of_page(&self, case: &PlannedCase) -> CaseOfStudy {
        let values = self.plan.study.axes.iter().zip(&case.case.values);
        CaseOfStudy {
            study: self.plan.name(),
            number: case.case.number,
            values: values.map(|(axis, value)| [axis.clone(), value.to_string()]).collect(),
            report: "../../report.html",
        }
    }
}

/// Whether a name is one that a kept case of some study has.
fn is_of_case(name: &str) -> bool {
    name.split_once('-').is_some_and(|(number, id)| {
        let is_digest = id.len() == 8 && id.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_digest && number.len() >= 4 && number.bytes().all(|byte| byte.is_ascii_digit())
    })
}

impl Keeping for StudyFolder<'_> {
    fn publish(&self, files: &[(&str, Vec<u8>)]) -> Result<(), String> {
        let folder = Folder::create_within(self.path, PATIENCE).map_err(|error| error.to_string())?;
        let results = folder.results(RUN, &self.plan.study.inputs).without_derived(REPORT);
        results.write(files).map(drop).map_err(|error| error.to_string())
    }

    fn is_kept(&self, case: &PlannedCase) -> bool {
        let file = self.of_case(case).join("placements.csv");
        files::read(&file).is_ok_and(|bytes| manifest::check(&file, &bytes, Unlisted::Refused).is_ok())
    }

    fn keep(
        &self,
        case: &PlannedCase,
        run: &stead_runs::Run,
        placed: Placed,
        certificate: Option<Certificate>,
    ) -> Result<(), String> {
        let Placed { mut outcome, stability } = placed;
        if run.page {
            // Whole in any case: the files of a case are the same however its study is stopped and goes on.
            outcome.make_sheet(&run.problem, &Monitor::silent());
        }
        let study_case = Some(self.case_of_page(case));
        let mut context = Context { stability, study_case, ..Context::new(run) };
        context.warnings.extend(outcome.warnings.iter().cloned());
        context.notes.extend(outcome.notes.iter().cloned());
        let folder = Folder::create(&self.of_case(case)).map_err(|error| error.to_string())?;
        write_placement(&folder, &run.problem, &outcome, &context).map_err(|error| error.to_string())?;
        if let Some(certificate) = &certificate {
            let files = placement_files(&run.problem, &outcome, &context).map_err(|error| error.to_string())?;
            write_certificate(&folder, &run.problem, certificate, &run.inputs, (files, outcome.interrupted))
                .map_err(|error| error.to_string())?;
        }
        Ok(())
    }
}
