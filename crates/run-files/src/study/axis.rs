//! Axes: what is varied, and the values it takes.

use super::file::{AxisTable, RangeTable, Spacing};
use super::value::{data, shown, toml};
use serde_json::Value;
use std::path::Path;
use stead_disk::input::InputError;
use stead_format::field::{FieldOverride, FieldPath};
use stead_format::place::Place;
use toml::de::DeValue;

/// One thing that is varied, in the order of the file.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    /// Name of its column.
    pub name: String,
    fields: Vec<FieldPath>,
    values: AxisValues,
}

#[derive(Debug, Clone)]
enum AxisValues {
    Listed(Vec<AxisPoint>),
    Range {
        from: f64,
        to: f64,
        count: Option<usize>,
        spacing: Spacing,
    },
    /// Numbers at equal differences, upwards or downwards.
    Steps {
        from: f64,
        step: f64,
        count: usize,
    },
}

/// One value of an axis: what it puts into the files, and what stands for it in the table of results.
#[derive(Debug, Clone)]
pub(crate) struct AxisPoint {
    pub overrides: Vec<FieldOverride>,
    /// The values of the fields, as data.
    pub data: Vec<(String, Value)>,
    /// What stands for it: a number, or a text.
    pub shown: Result<f64, String>,
}

impl Axis {
    /// # Errors
    /// [`InputError`] in the table: a path that is none, no values or both kinds, rows that do not fit the fields.
    pub fn of(table: &AxisTable, at: &Place<'_>, folder: &Path) -> Result<Self, InputError> {
        let fields = fields(table, at)?;
        let names: Vec<String> = fields.iter().map(ToString::to_string).collect();
        let name = table.name.clone().unwrap_or_else(|| names.join(" & "));
        let both = at.key("range").error("is there beside values", "values or a range");
        let none = || at.error("has no values", "values = [..] or range = { from = .., to = .., count = .. }");
        let values = match (&table.values, &table.range) {
            (Some(_), Some(_)) => return Err(both),
            (None, None) => return Err(none()),
            (Some(_), None) => AxisValues::Listed(listed(table, &fields, at, folder)?),
            (None, Some(range)) => {
                if fields.len() > 1 {
                    return Err(at.key("range").error("is for one field", "values with a row for each case"));
                }
                if table.labels.is_some() {
                    return Err(at.key("labels").error("is there beside a range", "labels beside values"));
                }
                range_of(range, &at.key("range"))?
            }
        };
        Ok(Self { name, fields, values })
    }

    /// The axis of the tasks.
    pub fn of_tasks(field: FieldPath, points: Vec<AxisPoint>) -> Self {
        Self { name: "task".to_owned(), fields: vec![field], values: AxisValues::Listed(points) }
    }

    /// The fields that it varies.
    pub fn fields(&self) -> &[FieldPath] {
        &self.fields
    }

    /// How many values it has by itself; none for a range without a count.
    pub fn count(&self) -> Option<usize> {
        match &self.values {
            AxisValues::Listed(points) => Some(points.len()),
            AxisValues::Range { count, .. } => *count,
            AxisValues::Steps { count, .. } => Some(*count),
        }
    }

    /// One of its values, from 0.
    pub fn point(&self, number: usize) -> AxisPoint {
        match &self.values {
            AxisValues::Listed(points) => points[number].clone(),
            AxisValues::Range { count, .. } => {
                let last = count.unwrap_or(1).max(2) - 1;
                self.number(number as f64 / last as f64)
            }
            AxisValues::Steps { from, step, .. } => self.point_of(from + step * number as f64),
        }
    }

    /// The value at a share of the axis, from 0 to below 1.
    pub fn at(&self, share: f64) -> AxisPoint {
        match &self.values {
            AxisValues::Listed(points) => {
                let number = (share * points.len() as f64) as usize;
                points[number.min(points.len() - 1)].clone()
            }
            AxisValues::Range { .. } => self.number(share),
            AxisValues::Steps { count, .. } => self.point(((share * *count as f64) as usize).min(count - 1)),
        }
    }

    /// A number of a range, at a share of it.
    fn number(&self, share: f64) -> AxisPoint {
        let AxisValues::Range { from, to, spacing, .. } = self.values else { return self.point(0) };
        let value = match spacing {
            _ if share <= 0.0 => from,
            _ if share >= 1.0 => to,
            Spacing::Linear => from + (to - from) * share,
            Spacing::Log => from * libm::pow(to / from, share),
        };
        self.point_of(value)
    }

    /// A number as a value of the axis.
    fn point_of(&self, value: f64) -> AxisPoint {
        // Twelve digits are enough for any field, and spare the table of results the noise of rounding.
        let value: f64 = format!("{value:.11e}").parse().unwrap_or(value);
        let field = &self.fields[0];
        let text = format!("{value}");
        AxisPoint {
            data: vec![(field.to_string(), Value::from(value))],
            overrides: FieldOverride::new(field.clone(), text).into_iter().collect(),
            shown: Ok(value),
        }
    }
}

/// The fields that a table names.
fn fields(table: &AxisTable, at: &Place<'_>) -> Result<Vec<FieldPath>, InputError> {
    let path = |text: &str, at: Place<'_>| {
        text.parse::<FieldPath>().map_err(|error| {
            at.error(format!("is no path of a field: {}", error.problem), stead_format::field::PathError::ALLOWED)
        })
    };
    match (&table.field, &table.fields) {
        (Some(field), None) => Ok(vec![path(field, at.key("field"))?]),
        (None, Some(fields)) => {
            let places = (1..).map(|entry| at.key("fields").element(entry));
            fields.0.iter().zip(places).map(|(field, at)| path(field, at)).collect()
        }
        (None, None) => Err(at.error("has no field", "field = \"..\" or fields = [..]")),
        (Some(_), Some(_)) => Err(at.key("fields").error("is there beside field", "one of the two")),
    }
}

/// The values that a table lists.
fn listed(
    table: &AxisTable,
    fields: &[FieldPath],
    at: &Place<'_>,
    folder: &Path,
) -> Result<Vec<AxisPoint>, InputError> {
    let at_values = at.key("values");
    let array = at_values.value.and_then(|value| value.get_ref().as_array());
    let array = array.filter(|array| !array.is_empty());
    let array = array.ok_or_else(|| at_values.error("has no values", "one value or more in brackets"))?;
    if let Some(labels) = table.labels.as_ref().filter(|labels| labels.0.len() != array.len()) {
        let problem = format!("has {} labels for {} values", labels.0.len(), array.len());
        return Err(at.key("labels").error(problem, "as many labels as values"));
    }
    let mut points = Vec::with_capacity(array.len());
    for (number, value) in array.iter().enumerate() {
        let at = at_values.element(number + 1);
        let row: Vec<&DeValue<'_>> = match value.get_ref() {
            value if fields.len() == 1 => vec![value],
            DeValue::Array(row) if row.len() == fields.len() => row.iter().map(|value| value.get_ref()).collect(),
            _ => {
                let allowed = format!("rows of {} values, one for each field", fields.len());
                return Err(at.error("is no value for each field", allowed));
            }
        };
        let mut overrides = Vec::with_capacity(row.len());
        for (field, value) in fields.iter().zip(&row) {
            let field = FieldOverride::new(field.clone(), toml(value)).map_err(|e| at.error(e.problem, "a value"))?;
            overrides.push(field.in_folder(folder));
        }
        let all = || row.iter().map(|value| shown(value)).collect::<Vec<_>>().join(" & ");
        let shown = match (&table.labels, &row[..], data(row[0])) {
            (Some(labels), ..) => Err(labels.0[number].clone()),
            (None, [_], Value::Number(number)) => number.as_f64().ok_or_else(all),
            _ => Err(all()),
        };
        let data = fields.iter().map(ToString::to_string).zip(row.iter().map(|value| data(value))).collect();
        points.push(AxisPoint { overrides, data, shown });
    }
    Ok(points)
}

fn range_of(range: &RangeTable, at: &Place<'_>) -> Result<AxisValues, InputError> {
    let (from, to) = (range.from.si(), range.to.si());
    let spacing = range.spacing.map_or(Spacing::Linear, |word| word.0);
    if let Some(step) = range.step {
        return steps_of(range, step.si(), at);
    }
    if spacing == Spacing::Log && !(from > 0.0 && to > 0.0) {
        return Err(at.key("spacing").error("has no ratios, for an end is not above 0", "\"linear\", or ends above 0"));
    }
    if from == to {
        return Err(at.key("to").error("is equal to from", "another number"));
    }
    Ok(AxisValues::Range { from, to, count: range.count.map(|count| count.count()), spacing })
}

/// The most values that a step may make of a range.
const MAX_STEPS: f64 = 1e6;

/// A step that misses the end by less than this share of itself meets it.
const ROUNDING: f64 = 1e-9;

fn steps_of(range: &RangeTable, step: f64, at: &Place<'_>) -> Result<AxisValues, InputError> {
    if range.count.is_some() {
        return Err(at.key("step").error("is there beside count", "one of count and step"));
    }
    if range.spacing.is_some_and(|word| word.0 == Spacing::Log) {
        return Err(at.key("step").error("is there beside ratios", "spacing = \"linear\", or a count"));
    }
    let (from, to) = (range.from.si(), range.to.si());
    let steps = libm::floor((to - from).abs() / step + ROUNDING);
    if !(1.0..MAX_STEPS).contains(&steps) {
        let allowed =
            format!("a step of at most {}, the length of the range, and at least a millionth of it", (to - from).abs());
        return Err(at.key("step").error("leaves one value, or more than a million", allowed));
    }
    Ok(AxisValues::Steps { from, step: step.copysign(to - from), count: steps as usize + 1 })
}
