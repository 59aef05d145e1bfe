//! Study files: a run, what is varied of it, and the cases that this makes.

mod axis;
mod cases;
mod condition;
mod file;
mod tasks;
#[cfg(test)]
mod tests;
mod value;

pub use cases::{AxisValue, StudyCase};
pub use file::{AxisTable, Combine, RangeTable, Spacing, StudyFile, TaskPlacement, TaskTable, Values};

use crate::ReadError;
use crate::run::{Run, read_run_tables};
use axis::Axis;
use cases::cases;
use serde_json::Value;
use std::path::{Path, PathBuf};
use stead_format::document::Document;
use stead_format::field::FieldOverrides;
use stead_format::input::{InputError, InputFile, sha256};
use stead_format::place::Place;
use stead_format::sources::Sources;
use stead_format::surroundings::MESH;
use stead_format::toml_file::TomlFile;
use stead_numerics::monitor::Monitor;
use tasks::Tasks;

/// Which cases leave their files in a folder of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// None.
    None,
    /// Those with the smallest objective, so many.
    Best(usize),
    /// All that have a placement.
    All,
}

/// A study file, read and checked: the cases, each a run that can be read ([`Study::case`]).
#[derive(Debug, Clone)]
pub struct Study {
    file: PathBuf,
    base: PathBuf,
    base_bytes: Vec<u8>,
    sources: Sources,
    is_certified: bool,
    /// Which cases leave their files.
    pub keep: Keep,
    /// Names of the axes, the tasks last where the file has tasks.
    pub axes: Vec<String>,
    /// All cases, in the order of their numbers.
    pub cases: Vec<StudyCase>,
    /// The study file and its base.
    pub inputs: Vec<InputFile>,
}

/// A case of a study as a run, with its digest.
#[derive(Debug, Clone)]
pub struct CaseRun {
    /// What is to be done.
    pub run: Run,
    /// SHA-256 digest, in lower-case hexadecimal, of all that the result depends on: the run file with the values of
    /// the case in place, the bytes of every file that it names, whether it is certified, and the version of the
    /// results.
    pub id: String,
    /// The task, as the run file or the study file names it.
    pub task: String,
}

/// Version of the results of a study: with another one, finished cases are computed anew.
const RESULT_VERSION: &str = concat!("stead study 1, stead ", env!("CARGO_PKG_VERSION"));

/// Reads a study file, the keys of [`StudyFile`], and what its cases are. The runs of the cases are not read yet.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, a path that is none, an axis without values, a condition that is none, no case left.
pub fn read_study(file: &Path) -> Result<Study, InputError> {
    let source = TomlFile::read(file)?.with_overrides(&FieldOverrides::none(), Sources::shared());
    let document = source.parse()?;
    let at = document.root();
    let study: StudyFile = document.read()?;
    let folder = file.parent().map_or_else(PathBuf::new, Path::to_owned);
    let base = at.key("base").named_file()?;
    let sources = source.sources.clone();
    let base_source = base.toml()?;
    let base_document = base_source.parse()?;
    let is_certified = study.certify.unwrap_or(false);
    let keep = keep_of(study.keep.as_deref(), &at.key("keep"))?;
    let mut axes = Vec::new();
    for (table, number) in study.axis.iter().flatten().zip(1..) {
        axes.push(Axis::of(table, &at.key("axis").element(number), &folder)?);
    }
    let tasks = Tasks::of(&study, &base_document, &at, &folder, &sources)?;
    let cases = cases(&study, &axes, &tasks, &at)?;
    let mut names: Vec<String> = axes.into_iter().map(|axis| axis.name).collect();
    names.extend(tasks.axis().map(|axis| axis.name.clone()));
    let mut inputs = vec![source.as_config()];
    inputs.push(stead_format::input::input_file("base", base.name, base_source.bytes()));
    let base_bytes = base_source.bytes().to_vec();
    let file = file.to_owned();
    Ok(Study { file, base: base.file, base_bytes, sources, is_certified, keep, axes: names, cases, inputs })
}

impl Study {
    /// The study file as the user named it.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Whether cases are certified.
    pub fn is_certified(&self) -> bool {
        self.is_certified
    }

    /// Reads the run of a case. Files that several cases have in common are read and parsed once.
    ///
    /// # Errors
    /// Those of [`read_run_with`](crate::read_run_with), with the case.
    pub fn case(&self, case: &StudyCase, monitor: &Monitor) -> Result<CaseRun, ReadError> {
        let mut read = self.read_case(case, monitor).map_err(|error| {
            let name = self.file.file_name().unwrap_or_default().to_string_lossy();
            error.set_by(format!("case {} of {name}{}", case.number, case.combination(&self.axes)))
        })?;
        if let Some(task) = &case.task {
            read.task.clone_from(task);
        }
        Ok(read)
    }

    fn read_case(&self, case: &StudyCase, monitor: &Monitor) -> Result<CaseRun, ReadError> {
        let source = TomlFile::new(&self.base, self.base_bytes.clone())?;
        let source = source.with_overrides(&case.overrides, self.sources.clone());
        let document = source.parse()?;
        let mut run = read_run_tables(&source, &document, monitor)?;
        if self.is_certified {
            check_certificate(&document.root().key("certificate"))?;
        } else {
            run.certificate = None;
        }
        let id = self.id(&document, &run.inputs);
        let task = run.inputs.iter().find(|input| input.role == "task").map(|input| file_name(&input.name));
        Ok(CaseRun { run, id, task: task.unwrap_or_default() })
    }

    /// The digest of a case.
    fn id(&self, document: &Document<'_>, inputs: &[InputFile]) -> String {
        let mut root = document.root().value.map_or(Value::Null, |root| value::data(root.get_ref()));
        if let (Value::Object(table), false) = (&mut root, self.is_certified) {
            table.remove("certificate");
        }
        // The first is the run file itself.
        by_digest(&mut root, inputs.get(1..).unwrap_or_default());
        let mut text = format!("{RESULT_VERSION}\ncertified {}\n{root}\n", self.is_certified);
        // Files that the file of the surroundings names are not in the run file.
        inputs
            .iter()
            .filter(|input| input.role == MESH)
            .for_each(|input| text.push_str(&format!("{}\n", input.sha256)));
        sha256(text.as_bytes())
    }
}

/// Puts the digests of files in place of their names.
fn by_digest(value: &mut Value, inputs: &[InputFile]) {
    match value {
        Value::String(text) => {
            let name = text.replace('\\', "/");
            let digests: Vec<&str> =
                inputs.iter().filter(|input| input.name == name).map(|input| input.sha256.as_str()).collect();
            if !digests.is_empty() {
                *text = digests.join(" ");
            }
        }
        Value::Array(entries) => entries.iter_mut().for_each(|entry| by_digest(entry, inputs)),
        Value::Object(table) => table.values_mut().for_each(|entry| by_digest(entry, inputs)),
        _ => {}
    }
}

/// Refuses a case that asks for no certificate though the study does, or for one that would depend on the machine.
fn check_certificate(at: &Place<'_>) -> Result<(), InputError> {
    let allowed = "a table [certificate] with gap_percent and without time_limit_s, where memory_gb is the limit and the same on every \
                   machine, or certify = false in the study file";
    if !at.is_given() {
        return Err(at.error("is missing, but the study asks for certificates", allowed));
    }
    let limit = at.key("time_limit_s");
    let problem = "ends certificates by the clock, so that the results of the study would depend on the machine";
    if limit.is_given() { Err(limit.error(problem, allowed)) } else { Ok(()) }
}

fn keep_of(keep: Option<&str>, at: &Place<'_>) -> Result<Keep, InputError> {
    match keep.map(|keep| keep.split_whitespace().collect::<Vec<_>>()).as_deref() {
        None | Some(["none"]) => Ok(Keep::None),
        Some(["all"]) => Ok(Keep::All),
        Some(["best", count]) if count.parse().is_ok_and(|count: usize| count > 0) => {
            Ok(Keep::Best(count.parse().unwrap_or(1)))
        }
        _ => Err(at.error("is unknown", "\"none\", \"all\", or as in \"best 20\"")),
    }
}

/// The name of a file without its folders, which say nothing of what is in it.
fn file_name(name: &str) -> String {
    name.rsplit('/').next().unwrap_or(name).to_owned()
}
