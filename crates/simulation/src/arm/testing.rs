//! The Stäubli TX200 with its spindle, as in `configs/robots/staubli-tx200.toml`.
#![allow(clippy::unwrap_used, reason = "for tests alone")]

use nalgebra::{Matrix3, Rotation3, Vector3, matrix, vector};
use stead_model::robot::{Inertial, Joint, JointDynamics, Orthogonal, Robot, Spindle, testing::robot_from};

/// Tables 1, 2, 4, 5 and 6, and section 2.1: links in the frames of the rows. The limits are ours.
pub fn tx200() -> Robot {
    let stiffness = [2.03, 6.02, 1.91, 0.45, 0.22, 0.07];
    let geometry = [
        (0.0, 0.0, 0.642),
        (-90.0, 0.25, 0.0),
        (0.0, 0.95, 0.0),
        (90.0, 0.0, 0.8),
        (-90.0, 0.0, 0.0),
        (90.0, 0.0, 0.194),
    ];
    let rows = std::array::from_fn(|j| {
        let (alpha, a, d) = geometry[j];
        (alpha, a, d, -300.0, 300.0, stiffness[j])
    });
    let robot = robot_from(rows);
    let body = |mass, centre: Vector3<f64>, inertia: Matrix3<f64>| Inertial::new(mass, centre, inertia).unwrap();
    let links = [
        body(364.0, vector![0.150, -0.008, -0.089], matrix![12.25, -0.20, 1.55; -0.20, 17.83, 0.25; 1.55, 0.25, 16.95]),
        body(256.0, vector![0.401, 0.007, 0.374], matrix![6.57, 0.18, 0.74; 0.18, 36.58, 0.05; 0.74, 0.05, 39.92]),
        body(99.0, vector![0.039, 0.043, 0.060], matrix![0.57, 0.07, -0.02; 0.07, 0.46, -0.02; -0.02, -0.02, 0.51]),
        body(41.0, vector![0.0, 0.004, -0.355], matrix![1.23, 0.0, 0.0; 0.0, 1.17, 0.06; 0.0, 0.06, 0.30]),
        body(14.0, vector![0.0, -0.068, 0.0], matrix![0.03, 0.0, 0.0; 0.0, 0.02, 0.0; 0.0, 0.0, 0.03]),
        body(0.6, vector![0.0, 0.0, -0.012], Matrix3::from_diagonal(&vector![6e-3, 6e-3, 1e-3])),
    ];
    let damping = [383.3, 660.0, 371.7, 180.5, 126.2, 71.2];
    let bearing = [-0.298, 0.235, 0.279, -0.621, 0.0, -0.017];
    robot.with_dynamics(std::array::from_fn(|j| JointDynamics {
        link: links[j],
        damping: damping[j],
        backlash: (15.0_f64 / 3600.0).to_radians(),
        gravity_compensated: [1, 2, 4].contains(&j),
        orthogonal: Some(Orthogonal { stiffness: [5e6; 2], damping: [1000.0; 2] }),
        bearing: bearing[j],
    }))
}

/// The same geometry with other masses left out: only what [`Robot::new`] needs.
pub fn massless(robot: &Robot) -> Robot {
    let joints: [Joint; 6] = robot.joints().clone();
    Robot::new("massless", joints).unwrap()
}

/// Table 3 and the payload of table 4.
pub fn spindle() -> Spindle {
    let tilt = *Rotation3::from_axis_angle(&Vector3::y_axis(), 60_f64.to_radians()).matrix();
    let mut spindle = Spindle::new(tilt, vector![0.201, 0.0, 0.317]).unwrap();
    let inertia = matrix![0.095, 0.0, 0.035; 0.0, 0.106, 0.0; 0.035, 0.0, 0.098];
    spindle.payload = Some(Inertial::new(44.4, vector![-0.004, 0.0, 0.158], inertia).unwrap());
    spindle
}

/// Table 7 in the angles of the rows. rad
pub fn start() -> [f64; 6] {
    [-11.71_f64, 20.78 - 90.0, -212.14 + 90.0, 82.76, 60.80, -166.96].map(f64::to_radians)
}
