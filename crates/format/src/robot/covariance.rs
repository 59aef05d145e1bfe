//! How well the compliances of a robot file are known: the table `[covariance]`.
//!
//! A parameter is named like its field, joints and elements counted from 1. The compliance of a joint is
//! `joints[1].compliance_urad_per_nm`, in urad/(N m), even where its row gives the stiffness; the ends of a range are
//! `joints[3].compliance_urad_per_nm[1]`, at `min_deg`, and `[2]`, at `max_deg`; a compensator has
//! `joints[2].compensator.spring_stiffness_n_per_mm` and `joints[2].compensator.free_length_mm`. Springs normal to an
//! axis are `joints[3].orthogonal_compliance_urad_per_nm[1]`, about x, and `[2]`, about y, in urad/(N m).

use super::compliance::{COMPENSATOR, COMPLIANCE};
use super::file::CovarianceTable;
use super::springs::ORTHOGONAL_COMPLIANCE;
use crate::place::Place;
use nalgebra::DMatrix;
use stead_disk::input::InputError;
use stead_model::robot::{Parameter, Robot, Uncertainty, UncertaintyError};

pub(super) const COVARIANCE: &str = "covariance";
const PARAMETERS: &str = "parameters";
const MATRIX: &str = "matrix";

/// The name of a parameter in a robot file, without a quote.
pub fn parameter_name(parameter: Parameter) -> String {
    let joint = parameter.joint() + 1;
    match parameter {
        Parameter::Compliance(_) => format!("joints[{joint}].{COMPLIANCE}"),
        Parameter::ComplianceAtMin(_) => format!("joints[{joint}].{COMPLIANCE}[1]"),
        Parameter::ComplianceAtMax(_) => format!("joints[{joint}].{COMPLIANCE}[2]"),
        Parameter::SpringStiffness(_) => format!("joints[{joint}].{COMPENSATOR}.spring_stiffness_n_per_mm"),
        Parameter::FreeLength(_) => format!("joints[{joint}].{COMPENSATOR}.free_length_mm"),
        Parameter::AboutX(_) => format!("joints[{joint}].{ORTHOGONAL_COMPLIANCE}[1]"),
        Parameter::AboutY(_) => format!("joints[{joint}].{ORTHOGONAL_COMPLIANCE}[2]"),
    }
}

/// The unit of a parameter in a robot file, in SI units.
pub fn parameter_unit(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Compliance(_) | Parameter::ComplianceAtMin(_) | Parameter::ComplianceAtMax(_) => 1e-6,
        Parameter::AboutX(_) | Parameter::AboutY(_) => 1e-6,
        Parameter::SpringStiffness(_) => 1e3,
        Parameter::FreeLength(_) => 1e-3,
    }
}

/// The same arm with the covariance of its file.
pub(super) fn with_covariance(robot: Robot, table: &CovarianceTable, at: &Place<'_>) -> Result<Robot, InputError> {
    let known = names_of(&robot);
    let mut found = Vec::new();
    for (name, number) in table.parameters.0.iter().zip(1..) {
        found.push(parameter_from(name, &at.key(PARAMETERS).element(number), &robot, &known)?);
    }
    let (count, matrix, rows) = (found.len(), at.key(MATRIX), &table.matrix.0);
    let allowed =
        format!("{count} rows of {count} finite numbers, in the order of parameters and the products of their units");
    if let Some((row, number)) = rows.iter().zip(1..).find(|(row, _)| row.0.len() != count) {
        let problem = format!("has {} numbers and not {count}", row.0.len());
        return Err(matrix.element(number).error(problem, allowed));
    }
    if rows.len() != count {
        return Err(matrix.error(format!("has {} rows and not {count}", rows.len()), allowed));
    }
    let units: Vec<f64> = found.iter().map(|parameter| parameter_unit(*parameter)).collect();
    let covariance = DMatrix::from_fn(count, count, |j, k| rows[j].0[k].written() * units[j] * units[k]);
    Uncertainty::new(found, covariance)
        .and_then(|uncertainty| robot.with_uncertainty(uncertainty))
        .map_err(|error| locate(at, &error))
}

/// The names of all parameters that the laws of an arm have.
fn names_of(robot: &Robot) -> String {
    let all = (0..6).flat_map(Parameter::of_joint);
    all.filter(|parameter| robot.has_parameter(*parameter)).map(parameter_name).collect::<Vec<_>>().join(", ")
}

fn parameter_from(text: &str, name: &Place<'_>, robot: &Robot, known: &str) -> Result<Parameter, InputError> {
    let meant = (0..6).flat_map(Parameter::of_joint).find(|parameter| parameter_name(*parameter) == text);
    let Some(parameter) = meant else {
        return Err(name.error("is no parameter of a compliance", known));
    };
    if robot.has_parameter(parameter) {
        return Ok(parameter);
    }
    let joint = parameter.joint() + 1;
    let problem = match parameter {
        Parameter::Compliance(_) => format!("is one number, but joint {joint} has a range"),
        Parameter::ComplianceAtMin(_) | Parameter::ComplianceAtMax(_) => {
            format!("is an end of a range, but joint {joint} has none")
        }
        Parameter::SpringStiffness(_) | Parameter::FreeLength(_) => {
            format!("is of a compensator, but joint {joint} has none")
        }
        Parameter::AboutX(_) | Parameter::AboutY(_) => {
            format!("is of a spring normal to the axis, but joint {joint} has none")
        }
    };
    Err(name.error(problem, known))
}

/// A broken rule of the covariance, at its line of the file.
fn locate(at: &Place<'_>, error: &UncertaintyError) -> InputError {
    const SEMIDEFINITE: &str = "a positive semidefinite matrix: no combination of parameters with a variance below 0";
    let matrix = at.key(MATRIX);
    let name = |index: usize| at.key(PARAMETERS).element(index + 1);
    let entry = |row: usize, column: usize| matrix.element(row + 1).element(column + 1);
    match error {
        UncertaintyError::Size { parameters, .. } => {
            matrix.error(error.to_string(), format!("{parameters} rows of {parameters} numbers"))
        }
        UncertaintyError::Repeated { place, .. } => name(*place).error("is named twice", "each parameter once"),
        UncertaintyError::NotOfLaw { place, .. } => {
            name(*place).error("is of a law that its joint does not have", "a parameter of the law of its joint")
        }
        UncertaintyError::NotFinite { row, column, value } => {
            entry(*row, *column).error(format!("is {value} in SI units"), "a number that is finite in SI units")
        }
        UncertaintyError::NegativeVariance { row, .. } => {
            entry(*row, *row).error("is a variance below 0", "a number not below 0 on the diagonal")
        }
        UncertaintyError::NotSymmetric { row, column, .. } => {
            let mirror = entry(*column, *row);
            let mirrored = format!("{} = {}", mirror.path, mirror.written());
            let problem = format!("makes the matrix unsymmetric, against {mirrored}");
            entry(*row, *column).error(problem, "the same number on both sides of the diagonal, up to 1e-9")
        }
        UncertaintyError::Correlation { row, column, correlation } => {
            entry(*row, *column).error(format!("makes a correlation of {correlation}"), "a correlation from -1 to 1")
        }
        UncertaintyError::Indefinite(eigenvalue) => {
            matrix.error(format!("has correlations with an eigenvalue of {eigenvalue:.3e}"), SEMIDEFINITE)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::robot_from;
    use super::*;
    use crate::toml_file::TomlFile;
    use std::path::Path;

    /// The shipped KR270 (72 lines) with a compensator at joint 2 and a covariance behind.
    fn text(covariance: &str) -> String {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots/kuka-kr270-2.toml");
        let text = std::fs::read_to_string(file).unwrap();
        let compensator = "stiffness_mnm_per_rad = 3.32\n[joints.compensator]\nspring_stiffness_n_per_mm = 140\n\
                           a_mm = 700\nl_mm = 180\nalpha_deg = 11.5\nfree_length_mm = 460\n";
        let text = text.replace("stiffness_mnm_per_rad = 3.32\n", compensator);
        let text = text.replace("stiffness_mnm_per_rad = 2.79", "compliance_urad_per_nm = [0.3, 0.4]");
        assert!(text.contains("[0.3, 0.4]") && text.contains("[joints.compensator]"));
        format!("{text}{covariance}")
    }

    fn read(covariance: &str) -> Result<Robot, InputError> {
        robot_from(&TomlFile::new(Path::new("arm.toml"), text(covariance).into_bytes())?)
    }

    const GOOD: &str = "[covariance]
parameters = ['joints[1].compliance_urad_per_nm', 'joints[2].compensator.free_length_mm', 'joints[3].compliance_urad_per_nm[2]']
matrix = [
    [0.04, 0.1, 0.0],
    [0.1, 4, -0.02],
    [0.0, -0.02, 0.0009],
]
";

    #[test]
    fn a_covariance_becomes_si() {
        let robot = read(GOOD).unwrap();
        let uncertainty = robot.uncertainty().unwrap();
        let parameters = [Parameter::Compliance(0), Parameter::FreeLength(1), Parameter::ComplianceAtMax(2)];
        assert_eq!(uncertainty.parameters(), parameters);
        let expected = [[0.04e-12, 0.1e-9, 0.0], [0.1e-9, 4e-6, -0.02e-9], [0.0, -0.02e-9, 0.0009e-12]];
        for (j, row) in expected.iter().enumerate() {
            for (k, expected) in row.iter().enumerate() {
                let found = uncertainty.covariance()[(j, k)];
                assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{found} {expected}");
            }
        }
        assert_eq!(read("").unwrap().uncertainty(), None);
    }

    #[test]
    fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
        let start = text("").lines().count();
        let first = "'joints[1].compliance_urad_per_nm'";
        let ranged = "joints[3].compliance_urad_per_nm[1], joints[3].compliance_urad_per_nm[2]";
        for (line, field, from, to, parts) in [
            (
                2,
                "parameters[1]",
                first,
                "'joints[1].compliance'",
                ["no parameter", "found 'joints[1].compliance'", ranged],
            ),
            (2, "parameters[1]", first, "'joints[7].compliance_urad_per_nm'", ["no parameter", "joints[7]", ranged]),
            (2, "parameters[1]", first, "'joints[3].compliance_urad_per_nm'", ["joint 3 has a range", "found", ranged]),
            (2, "parameters[1]", first, "'joints[1].compliance_urad_per_nm[2]'", ["of a range", "joint 1", ranged]),
            (
                2,
                "parameters[1]",
                first,
                "'joints[1].compensator.free_length_mm'",
                ["compensator, but joint 1", "", ranged],
            ),
            (2, "parameters[1]", first, "3", ["not a text", "found 3", "text in quotes"]),
            (
                2,
                "parameters[3]",
                "joints[3].compliance_urad_per_nm[2]",
                "joints[1].compliance_urad_per_nm",
                ["twice", "found 'joints[1]", "once"],
            ),
            (
                4,
                "matrix[1]",
                "[0.04, 0.1, 0.0]",
                "[0.04, 0.1]",
                ["2 numbers and not 3", "found [0.04, 0.1]", "3 rows of 3"],
            ),
            (3, "matrix", "    [0.0, -0.02, 0.0009],\n", "", ["2 rows and not 3", "found [ [0.04", "3 rows of 3"]),
            (4, "matrix[1][2]", "[0.04, 0.1", "[0.04, nan", ["finite", "found nan", "rows of finite numbers"]),
            (5, "matrix[2][2]", "0.1, 4,", "0.1, 1e313,", ["finite", "found 1e313", "rows of finite numbers"]),
            (5, "matrix[2][2]", "0.1, 4,", "0.1, -4,", ["below 0", "found -4", "not below 0"]),
            (
                5,
                "matrix[2][1]",
                "[0.1,",
                "[0.11,",
                ["against covariance.matrix[1][2] = 0.1", "found 0.11", "both sides"],
            ),
            (6, "matrix[3][2]", "0.0009", "0.00009", ["correlation of -1.05", "found -0.02", "from -1 to 1"]),
            (
                3,
                "matrix",
                "[0.0, -0.02, 0.0009]",
                "[0.0, -0.02, 0.000105]",
                ["eigenvalue of -", "found [ [0.04", "semidefinite"],
            ),
            (1, "matrix", &GOOD[GOOD.find("matrix").unwrap()..], "", ["missing", "", "rows of finite numbers"]),
            (2, "parameter", "parameters", "parameter", ["nearest known one: parameters", "", "matrix"]),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let message = read(&GOOD.replacen(from, to, 1)).unwrap_err().to_string();
            let place = format!("arm.toml:{}: covariance.{field}: ", start + line);
            assert!(message.starts_with(&place), "{place} at the start of {message}");
            for part in parts.iter().chain(&["; allowed: "]) {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }
}
