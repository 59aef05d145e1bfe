//! Study files: a run, what is varied of it, and the cases that this makes.

mod axis;
mod cases;
mod condition;
mod file;
mod tasks;
#[cfg(test)]
mod tests;
mod value;

pub use file::{AxisTable, Combine, RangeTable, Spacing, StudyFile, TaskPlacement, TaskTable, Values};

use crate::run::read_run_tables;
use axis::Axis;
use cases::cases;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stead_disk::input::{InputError, InputFile, sha256};
use stead_format::document::Document;
use stead_format::field::FieldOverrides;
use stead_format::mesh::MESH;
use stead_format::place::Place;
use stead_format::sources::Sources;
use stead_format::toml_file::TomlFile;
use stead_numerics::monitor::Monitor;
use stead_runs::ReadError;
use stead_runs::study::{CaseRun, Keep, ReadCase, Study, StudyCase};
use tasks::Tasks;

/// What the cases of a study file are read from. Files that several cases have in common are read and parsed once.
#[derive(Debug)]
struct Cases {
    base: PathBuf,
    base_bytes: Vec<u8>,
    sources: Sources,
    is_certified: bool,
    /// By case, the values that take the place of those of the base.
    overrides: Vec<FieldOverrides>,
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
    inputs.push(stead_disk::input::input_file("base", base.name, base_source.bytes()));
    let (cases, overrides) = cases.into_iter().unzip();
    let base_bytes = base_source.bytes().to_vec();
    let reader = Arc::new(Cases { base: base.file, base_bytes, sources, is_certified, overrides });
    Ok(Study { file: file.to_owned(), is_certified, keep, axes: names, cases, inputs, reader })
}

impl ReadCase for Cases {
    fn read(&self, case: &StudyCase, monitor: &Monitor) -> Result<CaseRun, ReadError> {
        let source = TomlFile::new(&self.base, self.base_bytes.clone())?;
        let Some(overrides) = case.number.checked_sub(1).and_then(|index| self.overrides.get(index)) else {
            return Err(InputError::new(&self.base, format!("there is no case {} of it", case.number)).into());
        };
        let source = source.with_overrides(overrides, self.sources.clone());
        let document = source.parse()?;
        let mut run = read_run_tables(&source, &document, monitor)?;
        if self.is_certified {
            check_certificate(&document.root().key("certificate"))?;
        } else {
            run.certificate = None;
        }
        let id = self.id(&document, &run.inputs);
        let read = run.inputs.iter().find(|input| input.role == "task").map(|input| file_name(&input.name));
        let task = case.task.clone().or(read).unwrap_or_default();
        Ok(CaseRun { run, id, task })
    }
}

impl Cases {
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
