//! The compliance of an arm under load: what a load adds to or takes from the stiffness by turning its own lever arms.
//!
//! `K_C = (J (K_theta - H)^-1 J^T)^-1` with H the derivative of the joint torques `J^T w` by the joint angles (Klimchik
//! et al. 2017, eq. 11). For a force H is a Hessian and symmetric. A moment that keeps its direction in space has no
//! potential: its part of H is not symmetric. It is kept as it is, since only then `K_theta - H` is the tangent of the
//! static equilibrium `K_theta (theta - theta_0) = J^T w` (see [`super::equilibrium`]), and K_C what a little more load
//! meets. Whether the arm holds is judged by the symmetric part: while that is positive definite, any small motion
//! costs more work than the load gives back.

use super::Displacement;
use crate::robot::Frames;
use nalgebra::{Matrix6, Vector3, Vector6};

/// The arm gives way: under this load the joints have no stiffness left in some direction.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the arm buckles: {share:.3} of the load suffices to leave its joints without stiffness")]
pub struct Buckled {
    /// The share of the load, at most one, that suffices in this configuration; zero for a load that is not finite.
    pub share: f64,
}

/// H of eq. 11: the derivative of the joint torques `J^T w` by the joint angles, row by row, for `force` (N) and
/// `moment` (N m) at `point` (m), all in the base frame and unchanged while the joints turn. N m/rad
///
/// With z an axis, o a point on it, and i the joint nearer to the base: `(z_i x (z_j x (p - o_j))) . F` in both places
/// of a pair, and of a moment `(z_i x z_j) . M` in row j, column i alone.
pub fn load_hessian(
    frames: &Frames<f64>,
    point: &Vector3<f64>,
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> Matrix6<f64> {
    let mut hessian = Matrix6::zeros();
    for j in 0..6 {
        let velocity = frames.twist(j, point).0;
        for i in 0..=j {
            let of_force = frames.axes[i].cross(&velocity).dot(force);
            hessian[(i, j)] = of_force;
            hessian[(j, i)] = of_force;
            if i < j {
                hessian[(j, i)] += frames.axes[i].cross(&frames.axes[j]).dot(moment);
            }
        }
    }
    hessian
}

/// The inverse of K_C under load (eq. 11): displacement of the tool (m, rad) per additional wrench (N, N m) at `point`
/// (m), for joint compliances at the pose in rad/(N m). Symmetric for a pure force.
///
/// # Errors
/// [`Buckled`] when the symmetric part of `K_theta - H` is not positive definite.
pub fn loaded_compliance(
    frames: &Frames<f64>,
    point: &Vector3<f64>,
    compliances: &[f64; 6],
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> Result<Matrix6<f64>, Buckled> {
    let scale = scale(frames, compliances);
    let inverse = inverse_tangent(&load_hessian(frames, point, force, moment), &scale)?;
    let scaled = frames.jacobian(point) * scale;
    Ok(scaled * inverse * scaled.transpose())
}

/// The displacement at `point` (m) as Klimchik et al. (2017) take it, `K_C^-1 w` with K_C under the load (eq. 9 with
/// 11), for joint compliances at the pose in rad/(N m).
///
/// It agrees with the equilibrium to first order in the load. Of the second-order part along the force it has two
/// thirds: the last third is the curvature of the way that the point takes. [`super::equilibrium::displaced`] has all
/// of it.
///
/// # Errors
/// Those of [`loaded_compliance`].
pub fn loaded_displacement(
    frames: &Frames<f64>,
    point: &Vector3<f64>,
    compliances: &[f64; 6],
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> Result<Displacement<f64>, Buckled> {
    let compliance = loaded_compliance(frames, point, compliances, force, moment)?;
    let moved = compliance * Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
    Ok(Displacement { linear: moved.fixed_rows::<3>(0).into_owned(), angular: moved.fixed_rows::<3>(3).into_owned() })
}

/// Turns of the joints per scaled turn of the springs, which are those of the joints but for a linkage: square roots of
/// the compliances. The scale S makes `S^T (K_theta - H) S = 1 - S^T H S` a matrix without units, which exists for
/// rigid joints too.
pub(super) fn scale(frames: &Frames<f64>, compliances: &[f64; 6]) -> Matrix6<f64> {
    frames.joints_by_springs() * Matrix6::from_diagonal(&Vector6::from(compliances.map(libm::sqrt)))
}

/// `(1 - S^T H S)^-1`.
pub(super) fn inverse_tangent(hessian: &Matrix6<f64>, scale: &Matrix6<f64>) -> Result<Matrix6<f64>, Buckled> {
    let softening = scale.transpose() * hessian * scale;
    let tangent = Matrix6::identity() - softening;
    let symmetric = (tangent + tangent.transpose()) * 0.5;
    let inverse = symmetric.cholesky().and_then(|_| tangent.try_inverse());
    inverse.ok_or_else(|| {
        if softening.iter().any(|entry| !entry.is_finite()) {
            return Buckled { share: 0.0 };
        }
        let most = ((softening + softening.transpose()) * 0.5).symmetric_eigenvalues().max();
        Buckled { share: (1.0 / most).min(1.0) }
    })
}

#[cfg(test)]
mod tests {
    use super::super::displacement;
    use super::*;
    use crate::robot::testing::{kr270, odd_arms};
    use nalgebra::vector;
    use proptest::prelude::*;

    const TOOL: Vector3<f64> = vector![0.1, -0.3, 0.2];

    proptest! {
        #[test]
        fn hessian_is_the_derivative_of_the_joint_torques(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let wrench = Vector6::from(wrench);
            let (force, moment) = (wrench.fixed_rows::<3>(0).into_owned(), wrench.fixed_rows::<3>(3).into_owned());
            let torques = |theta: &[f64; 6]| {
                let frames = Frames::new(robot, theta);
                frames.jacobian(&frames.base_from_flange.point(&TOOL)).transpose() * wrench
            };
            let frames = Frames::new(robot, &theta);
            let hessian = load_hessian(&frames, &frames.base_from_flange.point(&TOOL), &force, &moment);
            let h = 1e-5;
            for j in 0..6 {
                let (mut up, mut down) = (theta, theta);
                up[j] += h;
                down[j] -= h;
                let slope = (torques(&up) - torques(&down)) / (2.0 * h);
                prop_assert!((hessian.column(j) - slope).norm() < 1e-6, "{} {}", hessian.column(j), slope);
            }
            let of_force = load_hessian(&frames, &frames.base_from_flange.point(&TOOL), &force, &Vector3::zeros());
            prop_assert_eq!(of_force, of_force.transpose());
        }

        #[test]
        fn loaded_compliance_is_the_inverse_of_equation_11(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-2000.0..2000.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let frames = Frames::new(robot, &theta);
            let point = frames.base_from_flange.point(&TOOL);
            let compliances = robot.compliances_at(&theta);
            let (force, moment) = (vector![wrench[0], wrench[1], wrench[2]], vector![wrench[3], wrench[4], wrench[5]]);
            let stiffness = Matrix6::from_diagonal(&Vector6::from(compliances.map(|c| 1.0 / c)));
            let tangent = stiffness - load_hessian(&frames, &point, &force, &moment);
            let jacobian = frames.jacobian(&point);
            let expected = jacobian * tangent.lu().solve(&jacobian.transpose()).unwrap();
            let found = loaded_compliance(&frames, &point, &compliances, &force, &moment).unwrap();
            prop_assert!((found - expected).norm() < 1e-12 * expected.norm());
            // Without load it is that of eq. 10.
            let none = Vector3::zeros();
            let unloaded = loaded_compliance(&frames, &point, &compliances, &none, &none).unwrap();
            let moved = unloaded * Vector6::from(wrench);
            let plain = displacement(&frames, &point, &compliances, &force, &moment);
            prop_assert!((moved.fixed_rows::<3>(0) - plain.linear).norm() < 1e-14);
            prop_assert!((moved.fixed_rows::<3>(3) - plain.angular).norm() < 1e-14);
        }
    }

    #[test]
    fn a_column_buckles_at_eulers_load_of_a_hinge() {
        // Only joint 2 yields; the tool stands 2 m above it and is pressed straight down: it falls at F = K / 2 m.
        let robot = kr270();
        let frames = Frames::new(&robot, &[0.0, 1.2, -2.0, 0.0, 1.0, 0.0]);
        let point = frames.origins[1] + vector![0.0, 0.0, 2.0];
        let compliances = [0.0, 1e-5, 0.0, 0.0, 0.0, 0.0];
        let pressed = |force: f64| {
            loaded_compliance(&frames, &point, &compliances, &vector![0.0, 0.0, -force], &Vector3::zeros())
        };
        let found = pressed(4e4).unwrap();
        // c L^2 / (1 - F L c) = 1e-5 * 4 / (1 - 0.8)
        assert!((found[(0, 0)] - 2e-4).abs() < 1e-16, "{found}");
        let buckled = pressed(1e5).unwrap_err();
        assert!((buckled.share - 0.5).abs() < 1e-12, "{buckled}");
        assert!(pressed(5e4 * (1.0 - 1e-9)).is_ok() && pressed(5e4 * (1.0 + 1e-9)).is_err());
        assert_eq!(pressed(f64::INFINITY).unwrap_err().share, 0.0);
    }
}
