//! An arm from the rows of its file: frames, Jacobian, compliance. Craig's Denavit-Hartenberg parameters, multiplied
//! out.

use crate::values::{Answer, list, number, plain, pose, required, section, sections, text, texts};
use crate::yielding::{Normal, normal};
use nalgebra::{DMatrix, Isometry3, Matrix6, Rotation3, Translation3, Vector3, Vector6};
use std::path::Path;
use toml::{Table, Value};

/// How a joint yields.
#[derive(Debug, Clone)]
pub(crate) enum Law {
    /// rad/(N m)
    Constant(f64),
    /// At both limits, linear between them. rad/(N m)
    Range(f64, f64),
    /// Without the spring (rad/(N m)), stiffness of the spring (N/m), its two levers and its free length (m), its angle
    /// (rad).
    Spring { alone: f64, stiffness: f64, levers: [f64; 2], angle: f64, free: f64 },
}

#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub alpha: f64,
    pub a: f64,
    pub d: f64,
    pub min: f64,
    pub max: f64,
    pub speed: Option<f64>,
    pub acceleration: Option<f64>,
    pub jerk: Option<f64>,
    pub law: Law,
}

/// How the controller counts angles: `theta = sign A + offset`.
#[derive(Debug, Clone)]
pub(crate) struct Counting {
    pub sign: [f64; 6],
    pub offset: [f64; 6],
    pub is_j3_level: bool,
    pub root_from_base: Isometry3<f64>,
}

#[derive(Debug, Clone)]
pub(crate) struct Arm {
    pub rows: Vec<Row>,
    /// Springs normal to the axes, where they count.
    pub normal: Option<Vec<Normal>>,
    pub covariance: Option<(Vec<String>, DMatrix<f64>)>,
    pub counting: Option<Counting>,
    /// How far the mounting flange is beyond the last row. m
    pub flange: f64,
    /// From where to where the forearm may be turned against the base. rad
    pub sum: Option<[f64; 2]>,
    /// Whether a parallelogram drives axis 3.
    pub linkage: bool,
}

fn six(values: Option<Vec<f64>>) -> Option<[f64; 6]> {
    values?.try_into().ok()
}

impl Arm {
    pub(crate) fn read(file: &Path) -> Answer<Self> {
        let told = |error: String| format!("{}: {error}", file.display());
        let content = std::fs::read_to_string(file).map_err(|error| told(error.to_string()))?;
        let table: Table = content.parse().map_err(|error: toml::de::Error| told(error.to_string()))?;
        let rows = sections(&table, "joints").into_iter().map(row).collect::<Answer<Vec<_>>>().map_err(told)?;
        if rows.len() != 6 {
            return Err(told("an arm has six rows".to_owned()));
        }
        let is_full = text(&table, "stiffness_model") == Some("full");
        let normal: Option<Vec<Normal>> =
            is_full.then(|| sections(&table, "joints").into_iter().filter_map(normal).collect());
        if normal.as_ref().is_some_and(|all| all.len() != 6) {
            return Err(told("a full arm has springs normal to the axis in six rows".to_owned()));
        }
        let covariance = section(&table, "covariance").and_then(|table| {
            let names = texts(table, "parameters")?;
            let rows = table.get("matrix")?.as_array()?;
            let entries: Vec<f64> = rows.iter().filter_map(Value::as_array).flatten().filter_map(plain).collect();
            (entries.len() == names.len() * names.len())
                .then(|| (names.clone(), DMatrix::from_row_slice(names.len(), names.len(), &entries)))
        });
        let counting = match section(&table, "controller") {
            None => None,
            Some(controller) => {
                let kind = text(controller, "kind");
                let is_j3_level =
                    controller.get("is_j3_level").and_then(Value::as_bool).unwrap_or(kind == Some("fanuc"));
                let sign = six(list(controller, "sign")).ok_or_else(|| told("controller.sign".to_owned()))?;
                let offset =
                    six(list(controller, "offset_deg")).ok_or_else(|| told("controller.offset_deg".to_owned()))?;
                let root_from_base = section(&table, "root").map_or(Ok(Isometry3::identity()), pose)?;
                Some(Counting { sign, offset: offset.map(f64::to_radians), is_j3_level, root_from_base })
            }
        };
        let joined = section(&table, "axes_2_3");
        let sum = joined.map(|joined| {
            let end = |key: &str| required(joined, key).map(f64::to_radians).map_err(told);
            Ok::<_, String>([end("sum_min_deg")?, end("sum_max_deg")?])
        });
        let linkage = joined.and_then(|joined| joined.get("linkage")?.as_bool()).unwrap_or(false);
        let flange = table.get("flange_mm").and_then(plain).map_or(0.0, |mm| mm * 1e-3);
        Ok(Self { rows, normal, covariance, counting, flange, sum: sum.transpose()?, linkage })
    }

    /// The base and the frames of the six rows, where the base has this pose.
    pub(crate) fn frames(&self, base: &Isometry3<f64>, joints: &[f64; 6]) -> [Isometry3<f64>; 7] {
        let mut frames = [*base; 7];
        for (j, row) in self.rows.iter().enumerate() {
            let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), row.alpha);
            let spun = Rotation3::from_axis_angle(&Vector3::z_axis(), joints[j]);
            let step = Isometry3::from_parts(Translation3::identity(), turned.into())
                * Translation3::new(row.a, 0.0, 0.0)
                * Isometry3::from_parts(Translation3::new(0.0, 0.0, row.d), spun.into());
            frames[j + 1] = frames[j] * step;
        }
        frames
    }

    /// Where the last three axes meet: on the axis of row 5 and of row 6.
    pub(crate) fn wrist(&self, frames: &[Isometry3<f64>; 7]) -> Vector3<f64> {
        frames[5].translation.vector
    }

    /// The angles of a controller as those of the rows.
    pub(crate) fn joints_of(&self, angles: &[f64; 6]) -> Option<[f64; 6]> {
        let counting = self.counting.as_ref()?;
        let mut joints: [f64; 6] = std::array::from_fn(|j| counting.sign[j] * angles[j] + counting.offset[j]);
        if counting.is_j3_level {
            // What axis 2 turns, axis 3 turns back.
            joints[2] -= self.third() * counting.sign[1] * angles[1];
        }
        Some(joints)
    }

    /// 1 where axis 3 turns as axis 2 does, -1 where against it.
    fn third(&self) -> f64 {
        self.rows[2].alpha.cos().signum()
    }

    /// How far the forearm is turned against the base. rad
    pub(crate) fn forearm(&self, joints: &[f64; 6]) -> f64 {
        joints[1] + self.third() * joints[2]
    }

    /// What the motors have turned: that of axis 3 the forearm against the base, where a parallelogram drives it.
    pub(crate) fn motors(&self, joints: &[f64; 6]) -> [f64; 6] {
        let mut motors = *joints;
        if self.linkage {
            motors[2] = self.forearm(joints);
        }
        motors
    }

    /// rad/(N m)
    pub(crate) fn compliances(&self, joints: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|j| self.rows[j].compliance(joints[j]))
    }

    /// Displacement of a point (m) by a force (N) and a moment (N m) there, of the springs about the axes.
    pub(crate) fn deflection(
        &self,
        frames: &[Isometry3<f64>; 7],
        joints: &[f64; 6],
        at: &Vector3<f64>,
        force: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> Vector3<f64> {
        let mut jacobian = jacobian(frames, at);
        if self.linkage {
            // The spring of joint 2 turns the upper arm alone: elbow and forearm are shifted, and not turned.
            let [shoulder, elbow] = [2, 3].map(|k| frames[k].translation.vector);
            let shift = (frames[2].rotation * Vector3::z()).cross(&(elbow - shoulder));
            for k in 0..3 {
                (jacobian[(k, 1)], jacobian[(k + 3, 1)]) = (shift[k], 0.0);
            }
        }
        let wrench = Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        let torques = jacobian.transpose() * wrench;
        let compliances = self.compliances(joints);
        let turns = Vector6::from_fn(|j, _| compliances[j] * torques[j]);
        let moved = jacobian * turns;
        Vector3::new(moved[0], moved[1], moved[2])
    }

    /// 1/kappa of the Jacobian with lengths in units of `length` (Caro et al. 2013, eq. 26).
    pub(crate) fn inverse_condition(&self, frames: &[Isometry3<f64>; 7], at: &Vector3<f64>, length: f64) -> f64 {
        let mut scaled = jacobian(frames, at);
        for k in 0..3 {
            scaled.row_mut(k).scale_mut(1.0 / length);
        }
        let square = scaled * scaled.transpose();
        square.try_inverse().map_or(0.0, |inverse| 6.0 / (square.trace() * inverse.trace()).sqrt())
    }

    /// Joint angles near given ones with which the flange has a pose, by Newton's method.
    pub(crate) fn reach(&self, base: &Isometry3<f64>, target: &Isometry3<f64>, near: &[f64; 6]) -> Option<[f64; 6]> {
        let mut joints = *near;
        for _ in 0..50 {
            let frames = self.frames(base, &joints);
            let off = target.translation.vector - frames[6].translation.vector;
            let turn = (target.rotation * frames[6].rotation.inverse()).scaled_axis();
            if off.norm() < 1e-11 && turn.norm() < 1e-11 {
                return Some(joints);
            }
            let step = jacobian(&frames, &frames[6].translation.vector)
                .lu()
                .solve(&Vector6::new(off.x, off.y, off.z, turn.x, turn.y, turn.z))?;
            let most = step.amax();
            let share = if most > 0.2 { 0.2 / most } else { 1.0 };
            for j in 0..6 {
                joints[j] += step[j] * share;
            }
        }
        None
    }
}

/// Linear and angular speed of a point (m) for each joint.
pub(crate) fn jacobian(frames: &[Isometry3<f64>; 7], at: &Vector3<f64>) -> Matrix6<f64> {
    let mut jacobian = Matrix6::zeros();
    for j in 0..6 {
        let axis = frames[j + 1].rotation * Vector3::z();
        let linear = axis.cross(&(at - frames[j + 1].translation.vector));
        for k in 0..3 {
            jacobian[(k, j)] = linear[k];
            jacobian[(k + 3, j)] = axis[k];
        }
    }
    jacobian
}

impl Row {
    /// rad/(N m)
    pub(crate) fn compliance(&self, angle: f64) -> f64 {
        match self.law {
            Law::Constant(value) => value,
            Law::Range(at_min, at_max) => at_min + (at_max - at_min) * (angle - self.min) / (self.max - self.min),
            Law::Spring { alone, stiffness, levers: [a, l], angle: offset, free } => {
                // The second derivative of the energy of the spring, by differences of its torque's fourth order.
                let energy = |q: f64| {
                    let length = (a * a + l * l + 2.0 * a * l * (offset + q).cos()).sqrt();
                    0.5 * stiffness * (length - free) * (length - free)
                };
                let h = 2e-3;
                let [m3, m2, m1, o, p1, p2, p3] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|k| energy(angle + k * h));
                let added = ((m3 + p3) / 90.0 - 3.0 * (m2 + p2) / 20.0 + 1.5 * (m1 + p1) - 49.0 / 18.0 * o) / (h * h);
                1.0 / (1.0 / alone + added)
            }
        }
    }
}

fn row(table: &Table) -> Answer<Row> {
    let rad = |key: &str| required(table, key).map(f64::to_radians);
    let compliance = |value: &Value| match value {
        Value::Array(ends) => {
            let ends: Vec<f64> = ends.iter().filter_map(plain).collect();
            (ends.len() == 2).then(|| Law::Range(ends[0] * 1e-6, ends[1] * 1e-6))
        }
        other => plain(other).map(|value| Law::Constant(value * 1e-6)),
    };
    let law = match number(table, "stiffness_mnm_per_rad") {
        Some(stiffness) => Law::Constant(1e-6 / stiffness),
        None => table.get("compliance_urad_per_nm").and_then(compliance).ok_or("no stiffness")?,
    };
    let law = match (section(table, "compensator"), law) {
        (Some(spring), Law::Constant(alone)) => Law::Spring {
            alone,
            stiffness: required(spring, "spring_stiffness_n_per_mm")? * 1e3,
            levers: [required(spring, "a_mm")? * 1e-3, required(spring, "l_mm")? * 1e-3],
            angle: required(spring, "alpha_deg")?.to_radians(),
            free: required(spring, "free_length_mm")? * 1e-3,
        },
        (_, law) => law,
    };
    Ok(Row {
        alpha: rad("alpha_deg")?,
        a: required(table, "a_mm")? * 1e-3,
        d: required(table, "d_mm")? * 1e-3,
        min: rad("min_deg")?,
        max: rad("max_deg")?,
        speed: number(table, "max_speed_deg_per_s").map(f64::to_radians),
        acceleration: number(table, "max_acceleration_deg_per_s2").map(f64::to_radians),
        jerk: number(table, "max_jerk_deg_per_s3").map(f64::to_radians),
        law,
    })
}
