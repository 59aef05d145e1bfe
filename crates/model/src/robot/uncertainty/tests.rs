//! Slopes against differences, standard deviations against the matrix product, and what is refused.

use super::super::{Compensator, Compliance, testing::kr270};
use super::*;
use nalgebra::{DVector, Matrix6, Vector6};
use proptest::prelude::*;
use stead_numerics::scalar::Dual;

const SPRING: Compensator = Compensator { spring_stiffness: 1.4e5, a: 0.7, l: 0.18, alpha: 0.2, free_length: 0.46 };

/// The paper's arm with a compensator at joint 2 and a range at joint 3, by the values of its seven parameters.
fn arm(values: [f64; 9]) -> Robot {
    let [c1, c2, spring_stiffness, free_length, at_min, at_max, c4, c5, c6] = values;
    let compensator = Compensator { spring_stiffness, free_length, ..SPRING };
    let compliances = [
        c1.into(),
        Compliance::Compensated { alone: c2, compensator },
        Compliance::Range { at_min, at_max },
        c4.into(),
        c5.into(),
        c6.into(),
    ];
    kr270().with_compliances(compliances).unwrap()
}

const VALUES: [f64; 9] = [4e-6, 3e-7, 1.4e5, 0.46, 5e-7, 3e-7, 2e-6, 1.9e-6, 2.6e-6];

const PARAMETERS: [Parameter; 9] = [
    Parameter::Compliance(0),
    Parameter::Compliance(1),
    Parameter::SpringStiffness(1),
    Parameter::FreeLength(1),
    Parameter::ComplianceAtMin(2),
    Parameter::ComplianceAtMax(2),
    Parameter::Compliance(3),
    Parameter::Compliance(4),
    Parameter::Compliance(5),
];

/// `M M^T` with 5 % of each value as the size of a row of M.
fn covariance(entries: &[f64]) -> DMatrix<f64> {
    let count = PARAMETERS.len();
    let factor = DMatrix::from_fn(count, count, |k, r| 0.05 * VALUES[k] * entries[k * count + r]);
    &factor * factor.transpose()
}

fn entries() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0_f64, 81)
}

proptest! {
    #[test]
    fn gradients_agree_with_central_differences(theta in prop::array::uniform6(0.05..0.4_f64), lift in 0.0..2.0_f64) {
        let mut theta = theta;
        theta[1] += lift;
        theta[2] -= 2.0 * lift;
        let robot = arm(VALUES).with_uncertainty(Uncertainty::new(PARAMETERS.to_vec(), covariance(&[0.1; 81])).unwrap()).unwrap();
        let gradient = robot.compliance_gradient_at(&theta);
        let nominal = robot.compliances_at(&theta);
        for (k, parameter) in PARAMETERS.into_iter().enumerate() {
            let h = 1e-5 * VALUES[k];
            let moved = |h: f64| {
                let mut values = VALUES;
                values[k] += h;
                arm(values).compliances_at(&theta)
            };
            let (up, down) = (moved(h), moved(-h));
            for j in 0..6 {
                let difference = (up[j] - down[j]) / (2.0 * h);
                let expected = if j == parameter.joint() { gradient[k] } else { 0.0 };
                prop_assert!((difference - expected).abs() * VALUES[k] < 1e-9 * nominal[j], "{} {} {}", k, difference, expected);
            }
        }
        // Their own derivatives, by the joint angle.
        let duals: [Dual<6>; 6] = std::array::from_fn(|j| Dual::variable(theta[j], j));
        let exact = robot.compliance_gradient_at(&duals);
        for j in 0..6 {
            let h = 1e-5;
            let at = |h: f64| {
                let mut theta = theta;
                theta[j] += h;
                robot.compliance_gradient_at(&theta)
            };
            let (up, down) = (at(h), at(-h));
            for k in 0..PARAMETERS.len() {
                let slope = (up[k] - down[k]) / (2.0 * h);
                prop_assert_eq!(exact[k].value, gradient[k]);
                let unit = nominal[PARAMETERS[k].joint()] / VALUES[k];
                prop_assert!((exact[k].gradient[j] - slope).abs() < 1e-8 * unit, "{} {} {}", k, exact[k].gradient[j], slope);
            }
        }
    }

    #[test]
    fn standard_deviations_are_those_of_the_matrix(entries in entries(), parts in prop::array::uniform6(-1.0..1.0_f64)) {
        let sigma = covariance(&entries);
        let uncertainty = Uncertainty::new(PARAMETERS.to_vec(), sigma.clone()).unwrap();
        let robot = arm(VALUES).with_uncertainty(uncertainty).unwrap();
        let theta = [0.1, 1.1, -1.4, 0.3, 0.7, -0.2];
        let slopes = robot.compliance_gradient_at(&theta);
        let gradient: Vec<f64> = PARAMETERS.iter().zip(&slopes).map(|(p, s)| parts[p.joint()] * s).collect();
        let found = robot.uncertainty().unwrap().standard_deviation(&gradient);
        let gradient = DVector::from_vec(gradient);
        let expected = (gradient.transpose() * &sigma * &gradient)[0];
        prop_assert!((found * found - expected).abs() < 1e-12 * expected, "{} {}", found * found, expected);
        let at_the_pose = robot.compliance_covariance_at(&theta);
        let parts = Vector6::from(parts);
        let expected = (parts.transpose() * at_the_pose * parts)[0];
        prop_assert!((found * found - expected).abs() < 1e-12 * expected, "{} {}", found * found, expected);
    }
}

#[test]
fn an_error_common_to_all_is_one_direction_and_no_error_is_none() {
    // Fully correlated errors of 5 % each: a matrix of rank one.
    let common = DMatrix::from_fn(9, 9, |k, l| 0.05 * VALUES[k] * 0.05 * VALUES[l]);
    let uncertainty = Uncertainty::new(PARAMETERS.to_vec(), common).unwrap();
    let found = uncertainty.standard_deviation(&[1.0 / VALUES[0], 0.0, 0.0, 0.0, 1.0 / VALUES[4]]);
    assert!((found - 0.1).abs() < 1e-9, "{found}");
    let none = Uncertainty::new(vec![Parameter::Compliance(3)], DMatrix::zeros(1, 1)).unwrap();
    assert!(none.directions().is_empty());
    let found = none.standard_deviation(&[Dual::<1>::variable(2.0, 0)]);
    assert_eq!(found, Dual::constant(0.0));
    // A quantity that does not see the error has no kink in its derivatives.
    let seen = Uncertainty::new(vec![Parameter::Compliance(3)], DMatrix::from_element(1, 1, 4.0)).unwrap();
    assert_eq!(seen.standard_deviation(&[Dual::<1>::variable(0.0, 0)]), Dual::constant(0.0));
    assert_eq!(seen.standard_deviation(&[Dual::<1>::variable(-3.0, 0)]), Dual { value: 6.0, gradient: [-2.0] });
}

#[test]
fn what_is_no_covariance_is_refused() {
    let two = || vec![Parameter::Compliance(0), Parameter::Compliance(1)];
    let refused = |entries: [f64; 4]| Uncertainty::new(two(), DMatrix::from_row_slice(2, 2, &entries)).unwrap_err();
    assert!(Uncertainty::new(two(), DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0 + 1e-9, 1.0])).is_ok());
    assert!(matches!(refused([4.0, 2.0, 2.0 + 1e-8, 1.0]), UncertaintyError::NotSymmetric { row: 1, column: 0, .. }));
    assert!(matches!(refused([4.0, f64::NAN, 0.0, 1.0]), UncertaintyError::NotFinite { row: 0, column: 1, .. }));
    assert!(matches!(refused([4.0, 0.0, 0.0, -1.0]), UncertaintyError::NegativeVariance { row: 1, value: -1.0 }));
    assert!(
        matches!(refused([4.0, 2.1, 2.1, 1.0]), UncertaintyError::Correlation { correlation, .. } if correlation == 1.05)
    );
    assert!(matches!(refused([4.0, 0.1, 0.1, 0.0]), UncertaintyError::Correlation { row: 1, column: 0, .. }));
    let three = vec![Parameter::Compliance(0), Parameter::Compliance(1), Parameter::Compliance(2)];
    let indefinite = DMatrix::from_fn(3, 3, |k, l| if k == l { 1.0 } else { -0.6 });
    let error = Uncertainty::new(three, indefinite).unwrap_err();
    assert!(matches!(error, UncertaintyError::Indefinite(eigenvalue) if (eigenvalue + 0.2).abs() < 1e-12), "{error}");
    let error = Uncertainty::new(two(), DMatrix::zeros(2, 3)).unwrap_err();
    assert_eq!(error, UncertaintyError::Size { parameters: 2, rows: 2, columns: 3 });
    assert!(matches!(Uncertainty::new(vec![], DMatrix::zeros(0, 0)), Err(UncertaintyError::Size { .. })));
    let error = Uncertainty::new(vec![Parameter::Compliance(4); 2], DMatrix::identity(2, 2)).unwrap_err();
    assert_eq!(error, UncertaintyError::Repeated { parameter: Parameter::Compliance(4), place: 1 });
}

#[test]
fn each_law_has_its_own_parameters() {
    let known = |parameter| Uncertainty::new(vec![parameter], DMatrix::identity(1, 1)).unwrap();
    for joint in 0..6 {
        for parameter in Parameter::of_joint(joint) {
            let found = arm(VALUES).with_uncertainty(known(parameter));
            match PARAMETERS.contains(&parameter) {
                true => assert_eq!(found.unwrap().uncertainty(), Some(&known(parameter))),
                false => assert_eq!(found.unwrap_err(), UncertaintyError::NotOfLaw { parameter, place: 0 }),
            }
        }
    }
    assert!(arm(VALUES).with_uncertainty(known(Parameter::Compliance(6))).is_err());
    // Other compliances are not known as well as these.
    let robot = kr270().with_uncertainty(known(Parameter::Compliance(5))).unwrap();
    assert_eq!(robot.with_compliances([1e-6; 6]).unwrap().uncertainty(), None);
    assert_eq!(
        robot.with_data_sheet(Default::default()).unwrap().uncertainty(),
        Some(&known(Parameter::Compliance(5)))
    );
    assert_eq!(kr270().compliance_covariance_at(&[0.0; 6]), Matrix6::zeros());
}
