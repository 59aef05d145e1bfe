//! The user's robot file with the identified numbers in it, everything else as it was.

use super::super::output::ReportError;
use super::json::{is_full, key};
use std::fmt::Display;
use stead_calibration::identification::Identified;
use stead_calibration::identification::law::Quantity;
use stead_calibration::identification::model::Parameter;
use stead_model::robot::{About, Compliance, MeasuredFrom, Spring, SpringModel};
use toml_edit::{Array, DocumentMut, Item, Key, Table, TableLike, Value};

const STIFFNESS: &str = "stiffness_mnm_per_rad";
const COMPLIANCE: &str = "compliance_urad_per_nm";
const COMPENSATOR: &str = "compensator";
const COVARIANCE: &str = "covariance";
const NORMAL_STIFFNESS: &str = "orthogonal_stiffness_mnm_per_rad";
const NORMAL_COMPLIANCE: &str = "orthogonal_compliance_urad_per_nm";

/// The text of the robot file with new compliances, compensator and `[covariance]`; comments and all else are kept. A
/// joint that was given by its stiffness is given by its compliance, in the same place. The covariance is in the
/// products of the units of its parameters.
///
/// # Errors
/// [`ReportError::Format`] when the text is not that of a robot file.
pub fn robot_file(text: &str, found: &Identified) -> Result<String, ReportError> {
    let mut document: DocumentMut = text.parse().map_err(fail)?;
    let joints = document.get_mut("joints").ok_or_else(|| fail("it has no joints"))?;
    for estimate in found.arm.iter().filter(|estimate| estimate.parameter.spring().about == About::Z) {
        let index = estimate.parameter.joint;
        let row = row(joints, index).ok_or_else(|| fail("its joints are no tables"))?;
        let (_, factor) = key(&estimate.parameter);
        if estimate.parameter.quantity == Quantity::Compliance {
            set_compliance(row, estimate.value * factor);
        }
        let Compliance::Compensated { compensator, .. } = found.robot.joints()[index].compliance else {
            // A spring that the readings do not tell of is left out.
            row.remove(COMPENSATOR);
            continue;
        };
        let spring = row.entry(COMPENSATOR).or_insert_with(|| Item::Table(Table::new()));
        let spring = spring.as_table_like_mut().ok_or_else(|| fail("its compensator is no table"))?;
        for (name, value) in [
            ("spring_stiffness_n_per_mm", compensator.spring_stiffness / 1e3),
            ("a_mm", compensator.a * 1e3),
            ("l_mm", compensator.l * 1e3),
            ("alpha_deg", compensator.alpha.to_degrees()),
            ("free_length_mm", compensator.free_length * 1e3),
        ] {
            // The geometry is given: it changes only where the config says otherwise than the robot file.
            let old = spring.get(name).and_then(number);
            if old.is_none_or(|old| (old - value).abs() > 1e-9 * value.abs().max(1.0)) {
                set(spring, name, value);
            }
        }
    }
    if is_full(found) {
        for index in 0..6 {
            let row = row(joints, index).ok_or_else(|| fail("its joints are no tables"))?;
            set_normal(row, found, index);
        }
    }
    for (name, word) in [
        ("stiffness_model", found.robot.spring_model().map(SpringModel::word)),
        ("stiffness_measured_from", found.robot.stiffness_measured_from().map(MeasuredFrom::word)),
    ] {
        if let Some(word) = word {
            set(document.as_table_mut(), name, word);
        }
    }
    if found.robot.stiffness_like().is_none() {
        // What is measured is the arm's own.
        document.remove("stiffness_like");
    }
    document.remove(COVARIANCE);
    document.insert(COVARIANCE, Item::Table(covariance(found)));
    Ok(document.to_string())
}

fn fail(cause: impl Display) -> ReportError {
    ReportError::Format { what: "the identified robot file", cause: cause.to_string() }
}

/// One row of the arm, however the file writes them.
fn row(joints: &mut Item, index: usize) -> Option<&mut dyn TableLike> {
    match joints {
        Item::ArrayOfTables(rows) => rows.get_mut(index).map(|row| row as &mut dyn TableLike),
        Item::Value(Value::Array(rows)) => match rows.get_mut(index) {
            Some(Value::InlineTable(row)) => Some(row),
            _ => None,
        },
        _ => None,
    }
}

fn number(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| item.as_integer().map(|integer| integer as f64))
}

/// Sets a value, keeping blanks and comment around it.
fn set(table: &mut dyn TableLike, name: &str, value: impl Into<Value>) {
    let mut value = value.into();
    if let Some(old) = table.get(name).and_then(Item::as_value) {
        *value.decor_mut() = old.decor().clone();
    }
    match table.get_mut(name) {
        Some(slot) => *slot = Item::Value(value),
        None => drop(table.insert(name, Item::Value(value))),
    }
}

/// Sets the compliances normal to the axis of a joint, unless both are held as the row states them.
fn set_normal(row: &mut dyn TableLike, found: &Identified, joint: usize) {
    let is_stated = row.contains_key(NORMAL_STIFFNESS) || row.contains_key(NORMAL_COMPLIANCE);
    let is_held = |about: About| {
        let parameter = Parameter::Normal(Spring { joint, about });
        found.held.iter().any(|held| held.parameter == parameter)
    };
    if is_stated && is_held(About::X) && is_held(About::Y) {
        return;
    }
    row.remove(NORMAL_STIFFNESS);
    let normal = found.robot.stated_normal_springs().map_or([0.0; 2], |all| all[joint].compliance);
    set(row, NORMAL_COMPLIANCE, normal.map(|value| value * 1e6).into_iter().collect::<Array>());
}

/// Puts a compliance in the place of compliance or stiffness.
fn set_compliance(row: &mut dyn TableLike, compliance: f64) {
    if !row.contains_key(STIFFNESS) {
        return set(row, COMPLIANCE, compliance);
    }
    // The only way to another key in the same place is to take everything out and put it back in order.
    let names: Vec<String> = row.iter().map(|(name, _)| name.to_owned()).collect();
    let mut entries: Vec<(Key, Item)> = Vec::with_capacity(names.len());
    for name in names {
        let decorated = row.key(&name).cloned();
        if let (Some(key), Some(item)) = (decorated, row.remove(&name)) {
            entries.push((key, item));
        }
    }
    for (key, item) in entries {
        let is_stiffness = key.get() == STIFFNESS;
        let new = if is_stiffness { renamed(&key) } else { key };
        let name = new.get().to_owned();
        row.entry_format(&new).or_insert(item);
        if is_stiffness {
            set(row, &name, compliance);
        }
    }
}

fn renamed(key: &Key) -> Key {
    Key::new(COMPLIANCE).with_leaf_decor(key.leaf_decor().clone()).with_dotted_decor(key.dotted_decor().clone())
}

/// The table `[covariance]`: names of the parameters, and the matrix row by row.
fn covariance(found: &Identified) -> Table {
    let keys: Vec<(String, f64)> = found.arm.iter().map(|estimate| key(&estimate.parameter)).collect();
    let mut names = Array::new();
    let mut matrix = Array::new();
    for (i, (name, row_factor)) in keys.iter().enumerate() {
        let mut name = Value::from(name.as_str());
        name.decor_mut().set_prefix("\n    ");
        names.push_formatted(name);
        let mut row = Array::new();
        for (j, (_, column_factor)) in keys.iter().enumerate() {
            // Symmetric to the last digit.
            let (low, high) = (i.min(j), i.max(j));
            row.push(found.covariance[(low, high)] * row_factor.min(*column_factor) * row_factor.max(*column_factor));
        }
        let mut row = Value::from(row);
        row.decor_mut().set_prefix("\n    ");
        matrix.push_formatted(row);
    }
    for array in [&mut names, &mut matrix] {
        array.set_trailing("\n");
        array.set_trailing_comma(true);
    }
    let mut table = Table::new();
    table.decor_mut().set_prefix(format!(
        "\n# The compliances above are identified by stead {} from measurements, with this covariance.\n{}",
        env!("CARGO_PKG_VERSION"),
        told_together(found)
    ));
    table.insert("parameters", Item::Value(Value::from(names)));
    table.insert("matrix", Item::Value(Value::from(matrix)));
    table
}

/// Lines of comment on springs that cannot be told apart.
fn told_together(found: &Identified) -> String {
    if found.gauge.replaced.is_empty() {
        return String::new();
    }
    let sums = found.compliances.iter().map(|estimate| found.spring(estimate.parameter));
    let sums = sums.filter(|spring| !found.gauge.others(*spring).is_empty());
    let lines: String =
        sums.map(|spring| format!("#     {}\n", found.gauge.sum_name(spring, spring.to_string()))).collect();
    format!(
        "# Told together only, whatever is measured, and split such that none is below zero and the sum of squares is least; the\n\
         # covariance is that of the sums, as if the first spring of each had all of it:\n{lines}"
    )
}
