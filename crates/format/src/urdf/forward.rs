//! Forward kinematics of a URDF as its format defines it: the product of joint origins and turns about joint axes. It
//! shares nothing with the rows that are derived from it, which are tested against it.

use super::read::{Joint, Urdf};
use super::tree::Chain;
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::Pose;

/// A link of the chain in the base link, for the values of the six moving joints in rad: the link behind joint `last`
/// of the path, counted from 0; the tip link for the last of them.
pub(super) fn link_at(urdf: &Urdf, chain: &Chain, values: &[f64; 6], last: usize) -> Pose<f64> {
    let mut pose = Pose::identity();
    for joint in chain.path.iter().take(last + 1) {
        let value = chain.moving.iter().position(|moving| moving == joint).map_or(0.0, |k| values[k]);
        pose = pose.then(&step(&urdf.joints[*joint], value));
    }
    pose
}

/// The tip link in the base link.
pub(super) fn tip_at(urdf: &Urdf, chain: &Chain, values: &[f64; 6]) -> Pose<f64> {
    link_at(urdf, chain, values, chain.path.len())
}

/// The base link in the root link, where fixed joints alone are between.
pub(super) fn base_at(urdf: &Urdf, chain: &Chain) -> Option<Pose<f64>> {
    let fixed = |pose: Pose<f64>, joint: &usize| pose.then(&urdf.joints[*joint].origin);
    chain.carrier(urdf).is_none().then(|| chain.stand.iter().fold(Pose::identity(), fixed))
}

/// The child of a joint in its parent.
fn step(joint: &Joint, value: f64) -> Pose<f64> {
    joint.origin.then(&Pose { rotation: turn(&joint.axis, value), translation: Vector3::zeros() })
}

/// Rodrigues' formula: the rotation by an angle in rad about a unit vector.
fn turn(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = libm::sincos(angle);
    let cross = axis.cross_matrix();
    Matrix3::identity() + cross * sine + cross * cross * (1.0 - cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_about_an_axis_is_right_handed() {
        let turned = turn(&Vector3::z(), std::f64::consts::FRAC_PI_2) * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-15);
        let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        assert!((turn(&axis, 2.0) * axis - axis).norm() < 1e-15);
    }
}
