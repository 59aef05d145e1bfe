//! The tasks of a study: each with its own placement, or joined to one path.

use super::axis::{Axis, AxisPoint};
use super::file::{StudyFile, TaskPlacement};
use super::value::quoted;
use serde_json::Value;
use std::path::Path;
use stead_disk::input::InputError;
use stead_format::document::Document;
use stead_format::field::{FieldOverride, FieldPath};
use stead_format::place::Place;
use stead_format::sources::Sources;
use stead_format::task::{Imported, PointLean};
use stead_model::task::ToolPath;

/// What takes the place of the task of the run file.
pub(super) enum Tasks {
    /// Nothing.
    OfBase,
    /// Each of several, with its weight.
    Each(Axis, Vec<(String, f64)>),
    /// All of them as one path.
    One(Vec<FieldOverride>, String),
}

/// A task of the study file.
struct Listed {
    name: String,
    label: String,
    weight: f64,
}

impl Tasks {
    /// # Errors
    /// [`InputError`]: a task file that cannot be read, tasks that cannot be joined.
    pub fn of(
        study: &StudyFile,
        base: &Document<'_>,
        at: &Place<'_>,
        folder: &Path,
        sources: &Sources,
    ) -> Result<Self, InputError> {
        let Some(tables) = &study.task else {
            return match study.placement {
                Some(_) => Err(at.key("placement").error("is there without tasks", "tables [[task]] beside it")),
                None => Ok(Self::OfBase),
            };
        };
        let listed: Vec<Listed> = tables
            .iter()
            .map(|table| Listed {
                name: table.file.clone(),
                label: table.label.clone().unwrap_or_else(|| table.file.replace('\\', "/")),
                weight: table.weight.map_or(1.0, |weight| weight.si()),
            })
            .collect();
        if let Some(number) = (1..listed.len()).find(|n| listed[..*n].iter().any(|task| task.label == listed[*n].label))
        {
            let at = at.key("task").element(number + 1);
            return Err(at.error("has the label of another task", "a label of its own").found(&*listed[number].label));
        }
        match study.placement.map_or(TaskPlacement::Each, |word| word.0) {
            TaskPlacement::Each => Self::each(&listed, at, folder),
            TaskPlacement::One => Self::one(&listed, base, at, folder, sources),
        }
    }

    fn each(listed: &[Listed], at: &Place<'_>, folder: &Path) -> Result<Self, InputError> {
        let field = task_field(at)?;
        let mut points = Vec::with_capacity(listed.len());
        for task in listed {
            let name =
                FieldOverride::new(field.clone(), quoted(&task.name)).map_err(|e| at.error(e.problem, "a name"))?;
            points.push(AxisPoint {
                overrides: vec![name.in_folder(folder)],
                data: vec![("task".to_owned(), Value::from(task.name.as_str()))],
                shown: Err(task.label.clone()),
            });
        }
        let tasks = listed.iter().map(|task| (task.label.clone(), task.weight)).collect();
        Ok(Self::Each(Axis::of_tasks(field, points), tasks))
    }

    /// Joins the tasks to one path, whose segments have the weights of their tasks.
    fn one(
        listed: &[Listed],
        base: &Document<'_>,
        at: &Place<'_>,
        folder: &Path,
        sources: &Sources,
    ) -> Result<Self, InputError> {
        if base.at("segment").is_given() {
            let problem = "joins the tasks, but the run file has tables [[segment]], which are those of its own task";
            return Err(at.key("placement").error(problem, "\"each\", or a run file without [[segment]]"));
        }
        let (mut parts, mut bytes, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for (task, number) in listed.iter().zip(1..) {
            let file = at.key("task").element(number).key("file").named_file()?;
            let part = sources.task(&file.file, &file.bytes)?;
            weights.extend(part.path.segments().iter().map(|_| task.weight));
            bytes.extend_from_slice(&file.bytes);
            bytes.push(0);
            parts.push(part);
        }
        let label = listed.iter().map(|task| task.label.as_str()).collect::<Vec<_>>().join(" + ");
        let joined = joined(parts).map_err(|problem| {
            at.key("task")
                .error(problem, "tasks that all have forces, normals, or compliances of the part, or none of them")
                .found(&*label)
        })?;
        sources.offer(&folder.join(&label), bytes, joined);
        let value = |path: FieldPath, value: String| {
            FieldOverride::new(path, value).map_err(|error| at.key("task").error(error.problem, "other names"))
        };
        let mut overrides = vec![value(task_field(at)?, quoted(&label))?.in_folder(folder)];
        if weights.iter().any(|weight| *weight != 1.0) {
            let rows =
                weights.iter().zip(1..).map(|(weight, number)| format!("{{ number = {number}, weight = {weight} }}"));
            let segment = "segment".parse().map_err(|_| at.error("has no segments", "tasks"))?;
            overrides.push(value(segment, format!("[{}]", rows.collect::<Vec<_>>().join(", ")))?);
        }
        Ok(Self::One(overrides, label))
    }

    /// The axis that the tasks are on.
    pub fn axis(&self) -> Option<&Axis> {
        match self {
            Self::Each(axis, _) => Some(axis),
            _ => None,
        }
    }
}

fn task_field(at: &Place<'_>) -> Result<FieldPath, InputError> {
    "task".parse().map_err(|_| at.error("has no task", "tasks"))
}

/// Several tasks as one path, the segments of each behind those of the one before.
fn joined(parts: Vec<Imported>) -> Result<Imported, String> {
    let all = |has: fn(&Imported) -> bool| parts.iter().all(has) || !parts.iter().any(has);
    if !all(|part| part.wrenches.is_some()) {
        return Err("have forces in some files and none in others".to_owned());
    }
    if !all(|part| part.path.surface_normals().is_some()) {
        return Err("have normals of the surface in some files and none in others".to_owned());
    }
    if !all(|part| part.part.is_some()) {
        return Err("have compliances of the part in some files and none in others".to_owned());
    }
    let (mut points, mut wrenches, mut normals, mut lines) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut compliances, mut leans) = (Vec::new(), Vec::new());
    let mut segments = 0;
    for part in &parts {
        let numbered = |index: usize| part.path.segment_of(index) as u32 + 1 + segments;
        points.extend(part.path.points().iter().enumerate().map(|(index, point)| (numbered(index), *point)));
        wrenches.extend(part.wrenches.iter().flatten().copied());
        normals.extend(part.path.surface_normals().into_iter().flatten().copied());
        compliances.extend(part.part.iter().flatten().copied());
        match &part.leans {
            Some(own) => leans.extend(own),
            None => leans.extend(part.lines.iter().map(|_| PointLean::default())),
        }
        lines.extend(&part.lines);
        segments += part.path.segments().len() as u32;
    }
    let path = ToolPath::new(points).map_err(|error| error.to_string())?;
    let path = if normals.is_empty() { Ok(path) } else { path.with_surface_normals(normals) };
    let path = path.map_err(|error| error.to_string())?;
    let part = (!compliances.is_empty()).then_some(compliances);
    let leans = parts.iter().any(|part| part.leans.is_some()).then_some(leans);
    Ok(Imported { path, wrenches: (!wrenches.is_empty()).then_some(wrenches), part, leans, lines })
}
