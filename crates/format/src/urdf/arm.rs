//! The arm of a URDF: its chain of joints with their rows and limits, and the robot that they make.

use super::read::{Kind, Limit, Urdf};
use super::rows::{ImportedRow, Rows, rounded};
use super::stand::Stand;
use super::tree::{Chain, Tree};
use stead_disk::input::InputError;
use stead_model::robot::turns::Range;
use stead_model::robot::{Axes23, Joint, Robot, RobotError};

/// The arm of a URDF.
pub(super) struct Arm<'a> {
    pub urdf: &'a Urdf,
    pub chain: Chain,
    pub rows: Rows,
    /// Limits of the joints of the URDF. rad
    pub limits: [[f64; 2]; 6],
    /// The same of the joint angles of the rows. deg
    pub limits_deg: [[f64; 2]; 6],
    /// Speed of each joint, where the URDF states it. deg/s
    pub speeds_deg: [Option<f64>; 6],
    /// The arm that the rows make, with a compliance that nothing depends on.
    pub robot: Robot,
    pub stand: Stand,
}

/// Limits of a joint that turns without end. rad
const ENDLESS: f64 = std::f64::consts::TAU;

impl<'a> Arm<'a> {
    /// The arm between two links, as [`Chain::new`] finds them.
    ///
    /// # Errors
    /// [`InputError`] with file, line and element: links that are no tree, a chain that is not six hinges, a joint
    /// without limits, an arm that is no upright elbow arm with a spherical wrist.
    pub fn new(urdf: &'a Urdf, base: Option<&str>, tip: Option<&str>) -> Result<Self, InputError> {
        let chain = Chain::new(urdf, &Tree::new(urdf)?, base, tip)?;
        let limits = limits_of(urdf, &chain)?;
        let rows = Rows::derive(urdf, &chain)?;
        let limits_deg = std::array::from_fn(|k| mapped(&rows.rows[k], limits[k]));
        let speeds_deg = speeds_of(urdf, &chain)?;
        let robot = checked(urdf, &chain, &rows, &limits_deg)?;
        let stand = Stand::of(urdf, &chain, &rows);
        Ok(Self { urdf, chain, rows, limits, limits_deg, speeds_deg, robot, stand })
    }

    /// The sum of joints 2 and 3 that their ranges allow, where a parallelogram drives axis 3 and neither of them turns
    /// by a whole turn. deg
    pub fn linkage_sums_deg(&self) -> Option<[f64; 2]> {
        let [min, max] = self.robot.sums();
        let axes_2_3 = Axes23 { linkage: true, sum: Range { min, max } };
        let is_linkage =
            !self.chain.linkage(self.urdf).is_empty() && self.robot.clone().with_axes_2_3(Some(axes_2_3)).is_ok();
        is_linkage.then(|| [min, max].map(|sum| rounded(sum.to_degrees())))
    }
}

/// The limits of the six joints as the URDF states them. rad
fn limits_of(urdf: &Urdf, chain: &Chain) -> Result<[[f64; 2]; 6], InputError> {
    let mut limits = [[-ENDLESS, ENDLESS]; 6];
    for (k, joint) in chain.moving.into_iter().enumerate() {
        if urdf.joints[joint].kind == Kind::Continuous {
            continue;
        }
        const WANTED: &str =
            "<limit lower=\"..\" upper=\"..\" velocity=\"..\"/> in rad and rad/s, lower below upper, within 1e6 deg";
        limits[k] = match urdf.joints[joint].limit {
            None | Some(Limit { lower: None, upper: None, .. }) => {
                return Err(urdf.joint_error(joint, "has no limits", WANTED));
            }
            Some(Limit { lower, upper, .. }) => [lower, upper].map(Option::unwrap_or_default),
        };
        let [lower, upper] = limits[k];
        if lower >= upper || lower < -LARGEST_LIMIT || upper > LARGEST_LIMIT {
            return Err(urdf.joint_error(joint, format!("has limits from {lower} to {upper} rad"), WANTED));
        }
    }
    Ok(limits)
}

/// No limit and no speed is above this. rad, rad/s
const LARGEST_LIMIT: f64 = 17440.0;

/// The speeds of the six joints. deg/s
fn speeds_of(urdf: &Urdf, chain: &Chain) -> Result<[Option<f64>; 6], InputError> {
    let mut speeds = [None; 6];
    for (k, joint) in chain.moving.into_iter().enumerate() {
        let velocity = urdf.joints[joint].limit.and_then(|limit| limit.velocity).filter(|velocity| *velocity != 0.0);
        if let Some(velocity) = velocity {
            let speed = rounded(velocity.to_degrees());
            if !(speed > 0.0 && velocity <= LARGEST_LIMIT) {
                let problem = format!("has a speed of {velocity} rad/s");
                return Err(urdf.joint_error(
                    joint,
                    problem,
                    "a velocity above 0 and not above 1e6 deg/s, or 0 where it is not known",
                ));
            }
            speeds[k] = Some(speed);
        }
    }
    Ok(speeds)
}

/// Limits of a joint of the URDF (rad) as those of the row. deg
fn mapped(row: &ImportedRow, limits: [f64; 2]) -> [f64; 2] {
    let [from, to] = limits.map(|limit| rounded(row.sign * limit.to_degrees() + row.offset_deg));
    if from <= to { [from, to] } else { [to, from] }
}

/// The robot of the rows.
fn checked(urdf: &Urdf, chain: &Chain, rows: &Rows, limits_deg: &[[f64; 2]; 6]) -> Result<Robot, InputError> {
    let joints = std::array::from_fn(|k| {
        let (row, [min, max]) = (&rows.rows[k], limits_deg[k].map(f64::to_radians));
        let (alpha, a, d) = (row.alpha_deg.to_radians(), row.a_mm / 1e3, row.d_mm / 1e3);
        let (max_speed, max_acceleration, max_jerk) = (None, None, None);
        Joint { alpha, a, d, min, max, max_speed, max_acceleration, max_jerk, compliance: 1e-6.into() }
    });
    Robot::new(urdf.name.as_str(), joints).map_err(|error| {
        let number = match &error {
            RobotError::Geometry { joint, .. } | RobotError::Limits { joint, .. } => *joint,
            _ => 1,
        };
        let joint = chain.moving[number.clamp(1, 6) - 1];
        urdf.joint_error(
            joint,
            format!("makes an arm that is not supported: {error}"),
            "an elbow arm with a spherical wrist",
        )
    })
}
