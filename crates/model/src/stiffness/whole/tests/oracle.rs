//! Figures that another program computed: see `data/README.md`.

use super::*;
use crate::robot::Joint;

fn numbers(value: &toml::Value) -> Vec<f64> {
    match value {
        toml::Value::Float(number) => vec![*number],
        toml::Value::Integer(number) => vec![*number as f64],
        toml::Value::Array(rows) => rows.iter().flat_map(numbers).collect(),
        other => panic!("{other}"),
    }
}

pub(in crate::stiffness) struct Oracle {
    robot: Robot,
    spindle: Spindle,
    base: BaseCompliance,
    mount: Matrix6<f64>,
    tip: Matrix3<f64>,
    part: Matrix3<f64>,
    normal: [NormalSprings; 6],
}

impl Oracle {
    fn read(arm: &toml::Value) -> Self {
        let list = |key: &str| numbers(&arm[key]);
        let (rows, springs, bearings) =
            (list("rows_alpha_deg_a_mm_d_mm"), list("compliance_xyz_urad_per_nm"), list("bearing_mm"));
        let joints = std::array::from_fn(|j| Joint {
            alpha: rows[3 * j].to_radians(),
            a: rows[3 * j + 1] * 1e-3,
            d: rows[3 * j + 2] * 1e-3,
            min: -6.0,
            max: 6.0,
            max_speed: None,
            max_acceleration: None,
            max_jerk: None,
            compliance: (springs[3 * j + 2] * 1e-6).into(),
        });
        let normal = std::array::from_fn(|j| NormalSprings {
            compliance: [springs[3 * j] * 1e-6, springs[3 * j + 1] * 1e-6],
            bearing: bearings[j] * 1e-3,
        });
        let vector = |key: &str| Vector3::from_vec(list(key)) * 1e-3;
        let six = |key: &str| Matrix6::from_row_slice(&list(key)) * 1e-6;
        let three = |key: &str| Matrix3::from_row_slice(&list(key)) * 1e-6;
        Self {
            robot: Robot::new("oracle", joints).unwrap(),
            spindle: Spindle::new(Matrix3::from_row_slice(&list("tool_rotation")), vector("tool_xyz_mm")).unwrap(),
            base: BaseCompliance::new(vector("base_point_mm"), six("base")).unwrap(),
            mount: six("flange"),
            tip: three("tip"),
            part: three("part"),
            normal,
        }
    }

    /// The arm with these springs: `axes`, `normal` (with those about the axes) or `all`.
    pub fn arm(&self, springs: &str) -> (Robot, Spindle) {
        let (mut robot, mut spindle) = (self.robot.clone(), self.spindle);
        if springs != "axes" {
            robot = robot.with_normal_springs(Some(self.normal)).unwrap().with_spring_model(Some(SpringModel::Full));
        }
        if springs == "all" {
            robot = robot.with_base_compliance(Some(self.base.clone()));
            spindle = spindle.with_mount(self.mount).unwrap().with_tip(self.tip).unwrap();
        }
        (robot, spindle)
    }

    /// What the part adds to the displacement with these springs. m
    pub fn of_part(&self, springs: &str, force: &Vector3<f64>) -> Vector3<f64> {
        if springs != "all" {
            return Vector3::zeros();
        }
        of_part(&self.part, &rotation_from_zyx([30_f64.to_radians(), 0.0, 0.0]), force)
    }
}

/// A row of the table.
pub(in crate::stiffness) struct Row {
    pub arm: Oracle,
    pub springs: String,
    pub theta: [f64; 6],
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
    /// Displacement (um) and turn (urad) of the tool against the part.
    pub moved: Vector6<f64>,
}

/// All rows.
pub(in crate::stiffness) fn rows() -> Vec<Row> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/data");
    let arms: toml::Table = std::fs::read_to_string(format!("{folder}/arm-oracle.toml")).unwrap().parse().unwrap();
    let arms = arms["arm"].as_array().unwrap();
    let table = std::fs::read_to_string(format!("{folder}/arm-oracle.csv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let arm = arms.iter().find(|arm| arm["name"].as_str() == Some(cells[0])).unwrap();
        let number = |k: usize| cells[k].parse::<f64>().unwrap();
        let vector = |k: usize| Vector3::new(number(k), number(k + 1), number(k + 2));
        Row {
            arm: Oracle::read(arm),
            springs: cells[3].to_owned(),
            theta: std::array::from_fn(|j| number(4 + j).to_radians()),
            force: vector(10),
            moment: vector(13),
            moved: Vector6::from_fn(|k, _| number(16 + k)),
        }
    };
    table.lines().skip(1).map(row).collect()
}

/// In um and urad.
pub(in crate::stiffness) fn micro(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::from_iterator(linear.iter().chain(angular.iter()).map(|value| value * 1e6))
}

#[test]
fn figures_of_another_program_come_out() {
    let rows = rows();
    assert_eq!(rows.len(), 54);
    for Row { arm, springs, theta, force, moment, moved: expected } in rows {
        let (robot, spindle) = arm.arm(&springs);
        let frames = Frames::new(&robot, &theta);
        let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
        let whole = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), tip);
        let moved = whole.displacement(&force, &moment);
        let found = micro(&(moved.linear + arm.of_part(&springs, &force)), &moved.angular);
        for (found, expected) in found.iter().zip(expected.iter()) {
            // Ten digits are printed of each.
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{springs} {theta:?}: {found}");
        }
    }
}
