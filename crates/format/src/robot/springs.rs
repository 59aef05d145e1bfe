//! Springs normal to the joint axes, and what the compliances of a robot file stand for.

use super::file::{JointRow, RobotFile};
use crate::place::Place;
use crate::quantity::Quantity;
use crate::scalars::words;
use crate::toml_file::TomlFile;
use stead_disk::input::InputError;
use stead_model::robot::{MeasuredFrom, NormalSprings, Robot, SpringModel};

pub(super) const ORTHOGONAL_STIFFNESS: &str = "orthogonal_stiffness_mnm_per_rad";
pub(super) const ORTHOGONAL_COMPLIANCE: &str = "orthogonal_compliance_urad_per_nm";
const STIFFNESS_MODEL: &str = "stiffness_model";

words!(SpringModel, MeasuredFrom);

impl JointRow {
    /// Whether the row states springs normal to its axis.
    pub(super) fn has_normal_springs(&self) -> bool {
        self.orthogonal_stiffness_mnm_per_rad.is_some() || self.orthogonal_compliance_urad_per_nm.is_some()
    }

    /// The compliance about x and y that the row states, whichever key it does it by. rad/(N m)
    fn normal_compliance(&self) -> Option<[f64; 2]> {
        match (self.orthogonal_compliance_urad_per_nm, self.orthogonal_stiffness_mnm_per_rad) {
            (Some(compliance), _) => Some(compliance.both().map(Quantity::si)),
            (None, Some(stiffness)) => Some(stiffness.both().map(|stiffness| 1e-6 / stiffness.written())),
            (None, None) => None,
        }
    }

    /// Gives the row the springs of another, normal to its axis.
    pub(super) fn lent_normal_springs(&mut self, lender: &Self) {
        self.orthogonal_stiffness_mnm_per_rad = lender.orthogonal_stiffness_mnm_per_rad;
        self.orthogonal_compliance_urad_per_nm = lender.orthogonal_compliance_urad_per_nm;
        self.bearing_mm = lender.bearing_mm;
    }
}

/// The arm with the springs normal to its axes that the rows state, and with what its compliances stand for.
///
/// # Errors
/// [`InputError`] at a row that states springs by two keys, or none where another does; a full set without them.
pub(super) fn with_springs(robot: Robot, file: &RobotFile, at: &Place<'_>) -> Result<Robot, InputError> {
    let rows = at.key("joints");
    let model = file.stiffness_model.map(|word| word.0);
    let mut normal = Vec::with_capacity(6);
    for (row, number) in file.joints.iter().zip(1..) {
        let at = rows.element(number);
        if row.orthogonal_stiffness_mnm_per_rad.is_some() && row.orthogonal_compliance_urad_per_nm.is_some() {
            let problem = format!("is given beside {ORTHOGONAL_STIFFNESS}");
            return Err(at.key(ORTHOGONAL_COMPLIANCE).error(problem, "only one of the two"));
        }
        let bearing = row.bearing_mm.map_or(0.0, Quantity::si);
        normal.extend(row.normal_compliance().map(|compliance| NormalSprings { compliance, bearing }));
    }
    let normal: Option<[NormalSprings; 6]> = match normal.len() {
        0 if model == Some(SpringModel::Full) => {
            let allowed = format!(
                "{ORTHOGONAL_STIFFNESS} or {ORTHOGONAL_COMPLIANCE} in every [[joints]] beside it, or \"axes\" for a fit of \
                 springs about the axes alone"
            );
            return Err(at.key(STIFFNESS_MODEL).error("has no springs normal to the axes in its rows", allowed));
        }
        0 => None,
        _ => {
            let lacking = file.joints.iter().position(|row| !row.has_normal_springs());
            if let Some(row) = lacking {
                let at = rows.element(row + 1).key(ORTHOGONAL_STIFFNESS);
                let problem = "is missing: other rows state springs normal to their axes";
                let allowed = format!(
                    "{ORTHOGONAL_STIFFNESS} or {ORTHOGONAL_COMPLIANCE} in every [[joints]] (a compliance of 0 is rigid), or in none"
                );
                return Err(at.error(problem, allowed));
            }
            normal.try_into().ok()
        }
    };
    let robot = robot
        .with_normal_springs(normal)
        .map_err(|error| rows.error(error.to_string(), "finite numbers, compliances not below 0"))?;
    let robot = robot.with_spring_model(model);
    Ok(robot.with_stiffness_measured_from(file.stiffness_measured_from.map(|word| word.0)))
}

/// Refuses to score by a file that states springs normal to its axes, and that they are no part of its set.
///
/// # Errors
/// [`InputError`] at `stiffness_model` of the file.
pub fn checked_to_score(robot: &Robot, source: &TomlFile) -> Result<(), InputError> {
    let Some(model @ (SpringModel::Axes | SpringModel::AxialPart)) = robot.spring_model() else { return Ok(()) };
    if robot.stated_normal_springs().is_none() || robot.stiffness_like().is_some() {
        return Ok(());
    }
    let problem = format!(
        "is \"{}\", beside springs normal to the axes ({ORTHOGONAL_STIFFNESS}): scores cannot tell whether they count",
        model.word()
    );
    let allowed = "\"full\" where all springs are of one identification, or rows without springs normal to their axes";
    Err(source.parse()?.root().key(STIFFNESS_MODEL).error(problem, allowed))
}

#[cfg(test)]
mod tests {
    use super::super::robot_from;
    use super::*;
    use std::path::Path;

    /// The shipped KR270 without its model, with lines above its rows, and a line in each row.
    fn text(head: &str, row: impl Fn(usize) -> String) -> String {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots/kuka-kr270-2.toml");
        let text = std::fs::read_to_string(file).unwrap().replace("stiffness_model = \"axes\"\n", "");
        let mut parts = text.split("[[joints]]\n");
        let mut made = format!("{head}\n{}", parts.next().unwrap());
        for (j, part) in parts.enumerate() {
            made += &format!("[[joints]]\n{}\n{part}", row(j));
        }
        made
    }

    fn source(text: &str) -> TomlFile {
        TomlFile::new(Path::new("arm.toml"), text.as_bytes().to_vec()).unwrap()
    }

    fn refused(text: &str, parts: &[&str]) {
        let message = robot_from(&source(text)).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
        assert!(message.contains("; allowed: "), "{message}");
    }

    #[test]
    fn springs_come_as_numbers_or_pairs_of_stiffness_or_compliance_without_masses() {
        let row = |j: usize| match j {
            0 => "orthogonal_stiffness_mnm_per_rad = [4.0, 2]\nbearing_mm = -750".to_owned(),
            1 => "orthogonal_compliance_urad_per_nm = [0, 0.3]".to_owned(),
            _ => "orthogonal_compliance_urad_per_nm = 0.2".to_owned(),
        };
        let robot =
            robot_from(&source(&text("stiffness_model = 'full'\nstiffness_measured_from = 'base'", row))).unwrap();
        let springs = robot.normal_springs().unwrap();
        assert_eq!(springs[0], NormalSprings { compliance: [1e-6 / 4.0, 1e-6 / 2.0], bearing: -0.75 });
        assert_eq!(springs[1].compliance, [0.0, 0.3 / 1e6]);
        assert_eq!((springs[5].compliance, springs[5].bearing), ([0.2 / 1e6; 2], 0.0));
        assert_eq!(robot.stiffness_measured_from(), Some(MeasuredFrom::Base));
        assert!(robot.dynamics().is_none());
        let unstated = robot_from(&source(&text("", row))).unwrap();
        assert!(unstated.stated_normal_springs().is_some() && unstated.normal_springs().is_none());
    }

    #[test]
    fn half_a_set_is_refused() {
        let some = |j: usize| if j == 2 { "" } else { "orthogonal_stiffness_mnm_per_rad = 4" }.to_owned();
        refused(&text("", some), &["joints[3].orthogonal_stiffness_mnm_per_rad: is missing", "in every [[joints]]"]);
        let both = |_| "orthogonal_stiffness_mnm_per_rad = 4\northogonal_compliance_urad_per_nm = 0.2".to_owned();
        refused(
            &text("", both),
            &["joints[1].orthogonal_compliance_urad_per_nm: is given beside", "only one of the two"],
        );
        let none = |_| String::new();
        refused(
            &text("stiffness_model = 'full'", none),
            &["arm.toml:1: stiffness_model: has no springs normal", "\"axes\""],
        );
        refused(&text("stiffness_model = 'all'", none), &["stiffness_model: ", "found 'all'", "\"axial_part\""]);
        let negative = |_| "orthogonal_compliance_urad_per_nm = [0.1, -0.2]".to_owned();
        refused(&text("", negative), &["orthogonal_compliance_urad_per_nm[2]: ", "found -0.2", "not below 0"]);
        let three = |_| "orthogonal_stiffness_mnm_per_rad = [1, 2, 3]".to_owned();
        refused(&text("", three), &["orthogonal_stiffness_mnm_per_rad: ", "3 elements and not 2"]);
        let zero = |_| "orthogonal_stiffness_mnm_per_rad = 0".to_owned();
        refused(&text("", zero), &["found 0", "above 0", "or two numbers [about x, about y] above 0"]);
    }

    #[test]
    fn a_set_that_says_that_its_normal_springs_are_not_of_it_is_not_scored() {
        let row = |_| "orthogonal_stiffness_mnm_per_rad = 4".to_owned();
        for model in ["axes", "axial_part"] {
            let source = source(&text(&format!("stiffness_model = '{model}'"), row));
            let robot = robot_from(&source).unwrap();
            let message = checked_to_score(&robot, &source).unwrap_err().to_string();
            assert!(message.starts_with(&format!("arm.toml:1: stiffness_model: is \"{model}\", beside")), "{message}");
            assert!(message.contains("; allowed: \"full\""), "{message}");
        }
        for head in ["", "stiffness_model = 'full'"] {
            let source = source(&text(head, row));
            assert!(checked_to_score(&robot_from(&source).unwrap(), &source).is_ok());
        }
    }

    #[test]
    fn a_full_arm_lends_all_of_its_springs() {
        let covariance =
            "[covariance]\nparameters = ['joints[3].orthogonal_compliance_urad_per_nm[2]']\nmatrix = [[0.04]]\n";
        let row = |_| "orthogonal_compliance_urad_per_nm = [0.1, 0.2]".to_owned();
        let with = text("stiffness_model = 'full'", row) + covariance;
        let known = robot_from(&source(&with)).unwrap();
        let known = known.uncertainty().unwrap();
        assert_eq!(known.parameters(), [stead_model::robot::Parameter::AboutY(2)]);
        assert!((known.covariance()[(0, 0)] - 0.04e-12).abs() < 1e-26);
        let without = text("", |_| String::new()) + covariance;
        refused(&without, &["covariance.parameters[1]: is of a spring normal to the axis, but joint 3 has none"]);
    }
}
