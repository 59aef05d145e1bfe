//! The cases that axes make up.

use super::axis::{Axis, AxisPoint};
use super::condition::Condition;
use super::file::{Combine, StudyFile};
use super::tasks::Tasks;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use stead_disk::input::InputError;
use stead_format::field::FieldOverrides;
use stead_format::place::Place;
use stead_runs::study::{AxisValue, StudyCase};

/// More cases than this are a mistake.
const MAX_CASES: usize = 1_000_000;

/// All cases that no condition excludes, each with the values that take the place of those of the base.
///
/// # Errors
/// [`InputError`]: axes that cannot be combined like this, a condition that is none, no case or too many.
pub(super) fn cases(
    study: &StudyFile,
    axes: &[Axis],
    tasks: &Tasks,
    at: &Place<'_>,
) -> Result<Vec<(StudyCase, FieldOverrides)>, InputError> {
    check_names(axes, tasks, at)?;
    let conditions = conditions(study, axes, tasks, at)?;
    let rows = rows(study, axes, at)?;
    let of_tasks: Vec<Option<(AxisPoint, f64)>> = match tasks {
        Tasks::Each(axis, tasks) => {
            tasks.iter().enumerate().map(|(number, (_, weight))| Some((axis.point(number), *weight))).collect()
        }
        _ => vec![None],
    };
    let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).chain(["task"]).collect();
    let mut cases = Vec::new();
    for row in rows {
        for task in &of_tasks {
            let points: Vec<&AxisPoint> = row.iter().chain(task.iter().map(|(point, _)| point)).collect();
            if is_excluded(&conditions, &names, &points, at)? {
                continue;
            }
            if cases.len() == MAX_CASES {
                return Err(too_many(at));
            }
            let mut overrides: Vec<_> = points.iter().flat_map(|point| point.overrides.clone()).collect();
            let mut label = task.as_ref().and_then(|(point, _)| point.shown.clone().err());
            if let Tasks::One(fields, name) = tasks {
                overrides.extend(fields.iter().cloned());
                label = Some(name.clone());
            }
            let value = |point: &&AxisPoint| point.shown.clone().map_or_else(AxisValue::Text, AxisValue::Number);
            let case = StudyCase {
                number: cases.len() + 1,
                values: points.iter().map(value).collect(),
                task: label,
                weight: task.as_ref().map_or(1.0, |(_, weight)| *weight),
            };
            cases.push((case, FieldOverrides(overrides)));
        }
    }
    if cases.is_empty() {
        Err(at.key("exclude").error("leaves no case", "conditions that leave some"))
    } else {
        Ok(cases)
    }
}

fn too_many(at: &Place<'_>) -> InputError {
    at.key("axis").error(format!("make more than {MAX_CASES} cases"), "fewer values, or combine = \"latin\"")
}

/// Refuses two axes of one name, or two that vary the same field.
fn check_names(axes: &[Axis], tasks: &Tasks, at: &Place<'_>) -> Result<(), InputError> {
    let place = |number: usize| at.key("axis").element(number + 1);
    for (number, axis) in axes.iter().enumerate() {
        let others = || axes[..number].iter().chain(tasks.axis());
        if others().any(|other| other.name == axis.name) {
            return Err(place(number).error("has the name of another axis", "a name of its own").found(&*axis.name));
        }
        if let Some(field) = axis.fields().iter().find(|field| others().any(|other| other.fields().contains(field))) {
            let problem = format!("varies {field}, as another axis does");
            return Err(place(number).error(problem, "each field on one axis").found_if(None));
        }
    }
    Ok(())
}

/// The values of the axes, before any case is excluded.
fn rows(study: &StudyFile, axes: &[Axis], at: &Place<'_>) -> Result<Vec<Vec<AxisPoint>>, InputError> {
    let combine = study.combine.map_or(Combine::Grid, |word| word.0);
    if combine != Combine::Latin {
        for key in ["samples", "seed"] {
            if at.key(key).is_given() {
                return Err(at.key(key).error("is for a Latin hypercube", "combine = \"latin\" beside it"));
            }
        }
        if let Some(number) = axes.iter().position(|axis| axis.count().is_none()) {
            return Err(at.key("axis").element(number + 1).key("range").key("count").missing("a whole number from 2"));
        }
    }
    let counts: Vec<usize> = axes.iter().filter_map(Axis::count).collect();
    match combine {
        Combine::Grid => grid(axes, &counts).ok_or_else(|| too_many(at)),
        Combine::Zipped => {
            if let Some(number) = counts.iter().position(|count| *count != counts[0]) {
                let problem = format!("has {} values, and the first axis {}", counts[number], counts[0]);
                let at = at.key("axis").element(number + 1);
                return Err(at.error(problem, "as many values on each axis, or combine = \"grid\"").found_if(None));
            }
            let count = counts.first().copied().unwrap_or(1);
            Ok((0..count).map(|row| axes.iter().map(|axis| axis.point(row)).collect()).collect())
        }
        Combine::Latin => {
            let samples = study.samples.ok_or_else(|| at.key("samples").missing("a whole number from 1 to 1000000"))?;
            Ok(latin(axes, samples.count(), study.seed.map_or(1, |seed| seed.get())))
        }
    }
}

/// Every value with every other, the last axis the fastest; none where they are too many.
fn grid(axes: &[Axis], counts: &[usize]) -> Option<Vec<Vec<AxisPoint>>> {
    let all = counts.iter().try_fold(1_usize, |product, count| product.checked_mul(*count));
    let all = all.filter(|all| *all <= MAX_CASES)?;
    let point = |row: usize, axis: usize| {
        let faster: usize = counts[axis + 1..].iter().product();
        axes[axis].point(row / faster % counts[axis])
    };
    Some((0..all).map(|row| (0..axes.len()).map(|axis| point(row, axis)).collect()).collect())
}

/// A Latin hypercube: on each axis one sample in each stratum, at random within it.
fn latin(axes: &[Axis], samples: usize, seed: u64) -> Vec<Vec<AxisPoint>> {
    let columns = axes.iter().enumerate().map(|(number, axis)| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(number as u64);
        let mut strata: Vec<usize> = (0..samples).collect();
        for last in (1..samples).rev() {
            strata.swap(last, (random.next_u64() % (last as u64 + 1)) as usize);
        }
        let share = |random: &mut ChaCha8Rng| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let points: Vec<AxisPoint> =
            strata.into_iter().map(|stratum| axis.at((stratum as f64 + share(&mut random)) / samples as f64)).collect();
        points
    });
    let columns: Vec<Vec<AxisPoint>> = columns.collect();
    (0..samples).map(|row| columns.iter().map(|column| column[row].clone()).collect()).collect()
}

/// The conditions that exclude cases.
fn conditions(study: &StudyFile, axes: &[Axis], tasks: &Tasks, at: &Place<'_>) -> Result<Vec<Condition>, InputError> {
    let known: Vec<String> = axes
        .iter()
        .chain(tasks.axis())
        .flat_map(|axis| axis.fields().iter().map(ToString::to_string).chain([axis.name.clone()]))
        .collect();
    let mut conditions = Vec::new();
    for (text, number) in study.exclude.iter().flat_map(|list| &list.0).zip(1..) {
        let at = at.key("exclude").element(number);
        let condition = Condition::parse(text).map_err(|problem| at.error(problem, Condition::ALLOWED))?;
        for name in condition.names() {
            let rest = |field: &String| name.strip_prefix(field.as_str()).map(|rest| rest.to_owned());
            if known.iter().filter_map(rest).all(|rest| !rest.is_empty() && !rest.starts_with(['[', '.'])) {
                let near = |known: &String| strsim::jaro(known, name);
                let nearest = known.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
                let hint = nearest.map(|known| format!(" (nearest one: {known})")).unwrap_or_default();
                return Err(at.error(format!("names {name}, which is on no axis{hint}"), known.join(", ")));
            }
        }
        conditions.push(condition);
    }
    Ok(conditions)
}

/// Whether a condition excludes a case.
fn is_excluded(
    conditions: &[Condition],
    names: &[&str],
    points: &[&AxisPoint],
    at: &Place<'_>,
) -> Result<bool, InputError> {
    let value = |name: &str| {
        let of_field = points.iter().flat_map(|point| &point.data).find_map(|(field, value)| {
            let rest = name.strip_prefix(field.as_str())?;
            within(value, rest)
        });
        let of_axis = || {
            let number = names.iter().position(|axis| *axis == name)?;
            Some(points.get(number)?.shown.clone().map_or_else(Value::from, Value::from))
        };
        of_field.or_else(of_axis)
    };
    for (condition, number) in conditions.iter().zip(1..) {
        let holds = condition.holds(&value);
        if holds.map_err(|problem| at.key("exclude").element(number).error(problem, Condition::ALLOWED))? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// What the rest of a path leads to in a value.
fn within(value: &Value, rest: &str) -> Option<Value> {
    if rest.is_empty() {
        return Some(value.clone());
    }
    if let Some(rest) = rest.strip_prefix('[') {
        let (entry, rest) = rest.split_once(']')?;
        return within(value.as_array()?.get(entry.parse::<usize>().ok()?.checked_sub(1)?)?, rest);
    }
    let rest = rest.strip_prefix('.')?;
    let (key, rest) = rest.split_at(rest.find(['.', '[']).unwrap_or(rest.len()));
    within(value.as_object()?.get(key)?, rest)
}
