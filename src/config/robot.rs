//! Robot files.

use super::reader::{Field, Table};
use super::source::Source;
use crate::input::InputError;
use crate::robot::{Joint, Robot, RobotError};
use std::path::Path;

/// Reads a robot file: `name`, `source` (where its numbers come from), and six rows `[[joints]]`, base first, each with
/// `alpha_deg`, `a_mm`, `d_mm`, `min_deg`, `max_deg`, either `stiffness_mnm_per_rad` (in MN m/rad) or
/// `compliance_urad_per_nm`, and where known `max_speed_deg_per_s`, `max_acceleration_deg_per_s2` and
/// `max_jerk_deg_per_s3`.
///
/// # Errors
/// [`InputError`] with line and field: a file that cannot be read or is no TOML, a missing or unknown key, a value of
/// the wrong kind, or an arm that [`Robot::new`] refuses.
pub fn read_robot(file: &Path) -> Result<Robot, InputError> {
    robot_from(&Source::read(file)?)
}

/// As [`read_robot`], from a file already read.
pub(super) fn robot_from(source: &Source) -> Result<Robot, InputError> {
    let document = source.parse()?;
    let [name, origin, joints] = Table::root(&document).fields(["name", "source", "joints"])?;
    let name = name.string()?;
    origin.string()?;
    let rows = joints.tables()?;
    let count = rows.len();
    let rows: [Table<'_>; 6] = rows.try_into().map_err(|_| {
        joints.error("does not make a six-axis arm", "six tables [[joints]], base first").found(format!("{count} rows"))
    })?;
    let mut arm = Vec::with_capacity(6);
    for row in &rows {
        arm.push(joint_from(row)?);
    }
    let arm: [Joint; 6] = arm.try_into().map_err(|_| joints.error("does not make a six-axis arm", "six rows"))?;
    Robot::new(name, arm).map_err(|error| locate(&rows, &error))
}

fn joint_from(row: &Table<'_>) -> Result<Joint, InputError> {
    let [alpha, a, d, min, max, stiffness, compliance, speed, acceleration, jerk] = row.fields([
        "alpha_deg",
        "a_mm",
        "d_mm",
        "min_deg",
        "max_deg",
        STIFFNESS,
        COMPLIANCE,
        "max_speed_deg_per_s",
        "max_acceleration_deg_per_s2",
        "max_jerk_deg_per_s3",
    ])?;
    let angle = |field: &Field<'_>| field.positive().map(f64::to_radians);
    Ok(Joint {
        alpha: alpha.number()?.to_radians(),
        a: a.number()? / 1e3,
        d: d.number()? / 1e3,
        min: min.number()?.to_radians(),
        max: max.number()?.to_radians(),
        max_speed: speed.optional(angle)?,
        max_acceleration: acceleration.optional(angle)?,
        max_jerk: jerk.optional(angle)?,
        compliance: match (stiffness.is_given(), compliance.is_given()) {
            (true, false) => 1e-6 / stiffness.positive()?,
            (false, true) => compliance.positive()? / 1e6,
            (true, true) => {
                return Err(compliance.error(format!("is given beside {STIFFNESS}"), "only one of the two"));
            }
            (false, false) => {
                return Err(stiffness.error("is missing", format!("{STIFFNESS} or {COMPLIANCE}, a number above 0")));
            }
        },
    })
}

const STIFFNESS: &str = "stiffness_mnm_per_rad";
const COMPLIANCE: &str = "compliance_urad_per_nm";

/// A broken rule of the arm, at its line of the file.
fn locate(rows: &[Table<'_>; 6], error: &RobotError) -> InputError {
    let row = |joint: usize| &rows[joint.clamp(1, 6) - 1];
    let (joint, name, problem, allowed) = match error {
        RobotError::NotFinite { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number that is finite in SI units")
        }
        RobotError::NotPositive { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number above 0 in SI units")
        }
        RobotError::Limits { joint, .. } => {
            let max = row(*joint).field("max_deg").written();
            (*joint, "min", format!("is not below max_deg = {max}"), "a lower limit below the upper limit")
        }
        RobotError::Geometry { joint, field, reason } => {
            (*joint, *field, reason.clone(), "an elbow arm whose last three axes meet at right angles in one point")
        }
    };
    let row = row(joint);
    let key = match name {
        "alpha" => "alpha_deg",
        "a" => "a_mm",
        "d" => "d_mm",
        "min" => "min_deg",
        "max" => "max_deg",
        "max_speed" => "max_speed_deg_per_s",
        "max_acceleration" => "max_acceleration_deg_per_s2",
        "max_jerk" => "max_jerk_deg_per_s3",
        "compliance" if row.field(COMPLIANCE).is_given() => COMPLIANCE,
        "compliance" => STIFFNESS,
        other => other,
    };
    row.field(key).error(problem, allowed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::testing::kr270;
    use std::path::PathBuf;

    /// A robot file: name on line 1, source on line 2, and joint j in the eight lines from 8 j - 5, its header first.
    fn text() -> String {
        let rows = [
            (0, 0, 0, -185, 185, "stiffness_mnm_per_rad = 0.237"),
            (90, 350, 0, 0, 146, "stiffness_mnm_per_rad = 3.32"),
            (0, 1250, 0, -245, 29, "compliance_urad_per_nm = 0.4"),
            (-90, 55, 1100, -350, 350, "stiffness_mnm_per_rad = 0.486"),
            (90, 0, 0, -125, 125, "stiffness_mnm_per_rad = 0.521"),
            (-90, 0, 0, -350, 350, "stiffness_mnm_per_rad = 0.38"),
        ];
        let mut text = "name = 'arm'\nsource = 'a test'\n".to_owned();
        for (alpha, a, d, min, max, yielding) in rows {
            text += &format!("[[joints]]\nalpha_deg = {alpha}\na_mm = {a}\nd_mm = {d}\nmin_deg = {min}\n");
            text += &format!("max_deg = {max}\nmax_speed_deg_per_s = 180\n{yielding}\n");
        }
        text
    }

    fn read(text: &str) -> Result<Robot, InputError> {
        robot_from(&Source::new(Path::new("arm.toml"), text.as_bytes().to_vec())?)
    }

    /// The file with one line (from 1) replaced.
    fn with_line(number: usize, line: &str) -> String {
        let mut lines: Vec<String> = text().lines().map(str::to_owned).collect();
        lines[number - 1] = line.to_owned();
        lines.join("\n")
    }

    fn shipped(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/robots").join(name)
    }

    #[test]
    fn units_become_si() {
        let robot = read(&text()).unwrap();
        assert_eq!(robot.name(), "arm");
        let [_, second, third, ..] = robot.joints();
        assert_eq!((second.alpha, second.a, second.max), (90_f64.to_radians(), 0.35, 146_f64.to_radians()));
        assert_eq!((second.max_speed, second.max_jerk), (Some(std::f64::consts::PI), None));
        assert_eq!((second.compliance, third.compliance), (1e-6 / 3.32, 0.4 / 1e6));
    }

    #[test]
    fn shipped_robots_are_the_paper_and_its_sensitivity() {
        let printed = read_robot(&shipped("kuka-kr270-2.toml")).unwrap();
        let paper = kr270();
        for (joint, expected) in printed.joints().iter().zip(paper.joints()) {
            let speed = joint.max_speed;
            assert!(speed.is_some_and(|speed| (1.7..3.6).contains(&speed)));
            let difference = [
                joint.alpha - expected.alpha,
                joint.a - expected.a,
                joint.d - expected.d,
                joint.min - expected.min,
                joint.max - expected.max,
                joint.compliance * 1e6 - expected.compliance * 1e6,
            ];
            assert!(difference.iter().all(|difference| difference.abs() < 1e-12), "{joint:?}");
        }
        let softer = read_robot(&shipped("kuka-kr270-2-k1-0.8.toml")).unwrap();
        let mut compliances = printed.compliances();
        compliances[0] = 1e-6 / 0.8;
        assert_eq!(softer.joints(), printed.with_compliances(compliances).unwrap().joints());
        assert_ne!(softer.name(), printed.name());
    }

    #[test]
    fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
        // Joint 3 stands in lines 19 to 26, joint 5 in 35 to 42.
        for (text, parts) in [
            (with_line(1, "name = 3"), ["arm.toml:1: name: ", "not a text", "found 3", "text in quotes"]),
            (with_line(2, ""), ["arm.toml:1: source: ", "missing", "", "text in quotes"]),
            (with_line(2, "sorce = 'x'"), ["arm.toml:2: sorce: ", "nearest known one: source", "found 'x'", "joints"]),
            (with_line(21, "a_m = 3"), ["arm.toml:21: joints[3].a_m: ", "nearest known one: a_mm", "found 3", "d_mm"]),
            (with_line(21, ""), ["arm.toml:19: joints[3].a_mm: ", "missing", "", "a finite number"]),
            (with_line(21, "a_mm = nan"), ["arm.toml:21: joints[3].a_mm: ", "not a finite", "found nan", "a finite"]),
            (
                with_line(23, "min_deg = 29"),
                ["arm.toml:23: joints[3].min_deg: ", "below max_deg = 29", "found 29", "lower"],
            ),
            (
                with_line(25, "max_speed_deg_per_s = 0"),
                [":25: joints[3].max_speed_deg_per_s: ", "", "found 0", "above 0"],
            ),
            (with_line(18, "stiffness_mnm_per_rad = 0"), [":18: joints[2].stiffness", "range", "found 0", "above 0"]),
            (with_line(18, "stiffness_mnm_per_rad = -1.0"), [":18: joints[2].stiffness", "", "found -1.0", "above 0"]),
            (with_line(26, "compliance_urad_per_nm = 0.0"), [":26: joints[3].compliance", "", "found 0.0", "above 0"]),
            (with_line(26, "compliance_urad_per_nm = 1e-320"), [":26: joints[3].compliance", "", "1e-320", "above 0"]),
            (with_line(18, "stiffness_mnm_per_rad = 1e-320"), [":18: joints[2].stiffness", "inf", "1e-320", "finite"]),
            (
                with_line(25, "stiffness_mnm_per_rad = 2.5"),
                [":26: joints[3].compliance_urad_per_nm: ", "beside stiffness_mnm", "found 0.4", "only one"],
            ),
            (with_line(26, ""), [":19: joints[3].stiffness_mnm_per_rad: ", "missing", "", "or compliance_urad_per_nm"]),
            (with_line(38, "d_mm = 12.5"), [":38: joints[5].d_mm: ", "not spherical", "found 12.5;", "one point"]),
            (
                with_line(36, "alpha_deg = 60"),
                [":36: joints[5].alpha_deg: ", "orthogonal", "found 60;", "right angles"],
            ),
            (with_line(3, "[joints]"), ["arm.toml:", "TOML", "found", "a TOML file"]),
        ] {
            let message = read(&text).unwrap_err().to_string();
            for part in parts.iter().chain(&["; allowed: "]) {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }

    #[test]
    fn an_arm_has_six_rows() {
        let lines: Vec<String> = text().lines().map(str::to_owned).collect();
        let message = read(&lines[..42].join("\n")).unwrap_err().to_string();
        assert_eq!(
            message,
            "arm.toml:3: joints: does not make a six-axis arm, found 5 rows; allowed: six tables [[joints]], base first"
        );
        let seven = format!("{}{}", text(), lines[34..42].join("\n"));
        assert!(read(&seven).unwrap_err().to_string().contains("found 7 rows"));
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = read_robot(Path::new("nowhere/arm.toml")).unwrap_err().to_string();
        for part in ["nowhere/arm.toml: ", "cannot be read", "allowed: "] {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}
