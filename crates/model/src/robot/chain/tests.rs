//! The chain against the second formulation of [`testing`](super::testing).

use super::testing::{chain, mass_by_bodies, motion_histories, torques_by_bodies, vector_in};
use super::*;
use proptest::prelude::*;

/// Largest difference, relative to the largest number.
fn apart<const R: usize, const C: usize>(a: &SMatrix<f64, R, C>, b: &SMatrix<f64, R, C>) -> f64 {
    (a - b).amax() / b.amax().max(1e-3)
}

proptest! {
    #[test]
    fn the_mass_matrix_is_the_sum_over_bodies(chain in chain::<6>(), q in vector_in::<6>(3.0)) {
        let ours = chain.at(&q).mass_matrix(&chain);
        prop_assert!(apart(&ours, &mass_by_bodies(&chain, &q)) < 1e-12);
    }

    #[test]
    fn inverse_dynamics_is_the_sum_over_bodies(
        chain in chain::<6>(), q in vector_in::<6>(3.0), speed in vector_in::<6>(2.0), acceleration in vector_in::<6>(5.0)
    ) {
        let posed = chain.at(&q);
        let ours = posed.inverse_dynamics(&chain, &speed, &acceleration, chain.free_fall());
        prop_assert!(apart(&ours, &torques_by_bodies(&chain, &q, &speed, &acceleration)) < 1e-12);
    }

    #[test]
    fn eighteen_joints_obey_the_same_laws(
        chain in chain::<18>(), q in vector_in::<18>(3.0), speed in vector_in::<18>(1.0), rate in vector_in::<18>(1.0)
    ) {
        let posed = chain.at(&q);
        prop_assert!(apart(&posed.mass_matrix(&chain), &mass_by_bodies(&chain, &q)) < 1e-12);
        let ours = posed.inverse_dynamics(&chain, &speed, &rate, &Vector3::zeros()) + posed.gravity(&chain);
        prop_assert!(apart(&ours, &torques_by_bodies(&chain, &q, &speed, &rate)) < 1e-12);
    }

    /// Inverse dynamics from rest is the mass matrix times the accelerations.
    #[test]
    fn the_two_algorithms_agree(chain in chain::<6>(), q in vector_in::<6>(3.0), rate in vector_in::<6>(5.0)) {
        let posed = chain.at(&q);
        let torques = posed.inverse_dynamics(&chain, &SVector::zeros(), &rate, &Vector3::zeros());
        prop_assert!(apart(&torques, &(posed.mass_matrix(&chain) * rate)) < 1e-12);
    }

    #[test]
    fn the_tip_and_its_jacobian_are_those_of_the_exponentials(
        chain in chain::<6>(), q in vector_in::<6>(3.0), speed in vector_in::<6>(2.0), small in vector_in::<6>(0.02)
    ) {
        for q in [q, small] {
            let posed = chain.at(&q);
            let [value, rate, _] = motion_histories(&chain, &q, &speed, &SVector::zeros())[5].0;
            let tip = chain.last_from_tip.translation.push(1.0);
            prop_assert!((posed.tip() - (value * tip).xyz()).norm() < 1e-12);
            prop_assert!((posed.tip_jacobian() * speed - (rate * tip).xyz()).norm() < 1e-12);
            prop_assert!((posed.tip_velocity(&speed) - (rate * tip).xyz()).norm() < 1e-12);
            let force = Vector3::new(10.0, -20.0, 5.0);
            prop_assert!((posed.tip_torques(&force) - posed.tip_jacobian().transpose() * force).amax() < 1e-11);
        }
    }

    #[test]
    fn jacobians_agree_with_differences(chain in chain::<6>(), q in vector_in::<6>(3.0)) {
        let posed = chain.at(&q);
        let h = 1e-6;
        for j in 0..6 {
            let (mut up, mut down) = (q, q);
            up[j] += h;
            down[j] -= h;
            let (up, down) = (chain.at(&up), chain.at(&down));
            let slope = (up.tip() - down.tip()) / (2.0 * h);
            prop_assert!((posed.tip_jacobian().column(j) - slope).norm() < 1e-8);
            let spin = (up.base_from_tip.rotation - down.base_from_tip.rotation) / (2.0 * h)
                * posed.base_from_tip.rotation.transpose();
            let angular = Vector3::new(spin.m32, spin.m13, spin.m21);
            prop_assert!((posed.rotation_jacobian().column(j) - angular).norm() < 1e-8);
        }
    }

    #[test]
    fn gravity_is_the_slope_of_the_potential_and_its_stiffness_that_of_gravity(
        chain in chain::<6>(), q in vector_in::<6>(3.0)
    ) {
        let posed = chain.at(&q);
        let (gravity, stiffness) = (posed.gravity(&chain), posed.gravity_stiffness(&chain));
        let h = 1e-5;
        for j in 0..6 {
            let (mut up, mut down) = (q, q);
            up[j] += h;
            down[j] -= h;
            let (up, down) = (chain.at(&up), chain.at(&down));
            let slope = (up.potential(&chain) - down.potential(&chain)) / (2.0 * h);
            prop_assert!((gravity[j] - slope).abs() < 1e-6 * (1.0 + gravity.amax()), "{} {slope}", gravity[j]);
            let slope = (up.gravity(&chain) - down.gravity(&chain)) / (2.0 * h);
            prop_assert!((stiffness.column(j) - slope).amax() < 1e-6 * (1.0 + stiffness.amax()));
        }
    }
}

#[test]
fn small_angles_by_series_are_sine_and_cosine() {
    for k in -2000..=2000 {
        let angle = 1.1 * SMALL * f64::from(k) / 2000.0;
        let (sine, cosine) = sine_cosine(angle);
        assert!((sine - libm::sin(angle)).abs() <= 3e-16 * angle.abs(), "{angle}");
        assert!((cosine - libm::cos(angle)).abs() < 2e-16, "{angle}");
    }
}
