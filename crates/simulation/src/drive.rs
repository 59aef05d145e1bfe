//! Drives about the joints of a chain: springs, dampers, backlash, and the share of gravity that the springs carry.

use nalgebra::SVector;

/// Springs and dampers about the `N` joints of a chain, between the joint and where its motor holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive<const N: usize> {
    /// Stiffness. N m/rad
    pub stiffness: SVector<f64, N>,
    /// Damping. N m s/rad
    pub damping: SVector<f64, N>,
    /// Half the backlash: no spring torque within it. rad
    pub backlash: SVector<f64, N>,
    /// Share of gravity that the spring carries: 0 with a compensator or without gravity, else 1.
    pub felt_gravity: SVector<f64, N>,
}

/// Angle beyond a backlash of half width `gap`. rad
fn beyond(gap: f64, angle: f64) -> f64 {
    if angle > gap {
        angle - gap
    } else if angle < -gap {
        angle + gap
    } else {
        0.0
    }
}

impl<const N: usize> Drive<N> {
    /// Torques on the joints (N m) at angles `q` and speeds `speed` with the motors at `reference` and
    /// `reference_speed`: `-k (q - theta) - d (q' - theta')`, less the backlash of the paper's eq. 12. Both oppose the
    /// motion (eq. 7 is printed with the sign of the spring turned around). rad and rad/s
    pub fn torques(
        &self,
        q: &SVector<f64, N>,
        speed: &SVector<f64, N>,
        reference: &SVector<f64, N>,
        reference_speed: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            -self.stiffness[j] * beyond(self.backlash[j], q[j] - reference[j])
                - self.damping[j] * (speed[j] - reference_speed[j])
        })
    }

    /// Stiffness of the springs at angles `q`: zero within the backlash. N m/rad
    pub fn stiffness_at(&self, q: &SVector<f64, N>, reference: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            let free = (q[j] - reference[j]).abs() <= self.backlash[j] && self.backlash[j] > 0.0;
            if free { 0.0 } else { self.stiffness[j] }
        })
    }

    /// By how much the springs yield under torques `load` on the joints (N m) at rest: spring and backlash, in the
    /// middle of the backlash where there is no load. rad
    pub fn deflection(&self, load: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            let spring = load[j] / self.stiffness[j];
            if load[j].abs() > NO_LOAD { spring + self.backlash[j].copysign(spring) } else { spring }
        })
    }
}

#[cfg(test)]
impl<const N: usize> Drive<N> {
    /// Energy in the springs. J
    pub fn energy(&self, q: &SVector<f64, N>, reference: &SVector<f64, N>) -> f64 {
        let each = (0..N).map(|j| (self.stiffness[j], beyond(self.backlash[j], q[j] - reference[j])));
        each.map(|(stiffness, angle)| stiffness * angle * angle / 2.0).sum()
    }
}

/// A torque below this is rounding and takes up no backlash. N m
const NO_LOAD: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(backlash: f64) -> Drive<2> {
        Drive {
            stiffness: SVector::from([2e6, 5e5]),
            damping: SVector::from([300.0, 100.0]),
            backlash: SVector::repeat(backlash),
            felt_gravity: SVector::zeros(),
        }
    }

    #[test]
    fn springs_and_dampers_oppose() {
        let (zero, reference) = (SVector::zeros(), SVector::from([0.2, -0.1]));
        let torques = drive(0.0).torques(&SVector::from([0.2001, -0.1001]), &zero, &reference, &zero);
        assert!((torques - SVector::from([-200.0, 50.0])).norm() < 1e-6);
        let torques =
            drive(0.0).torques(&reference, &SVector::from([0.1, 0.0]), &reference, &SVector::from([0.0, 0.1]));
        assert!((torques - SVector::from([-30.0, 10.0])).norm() < 1e-9);
    }

    #[test]
    fn play_is_without_torque_and_continuous_at_its_ends() {
        let (drive, zero) = (drive(7e-5), SVector::zeros());
        let torque = |angle: f64| drive.torques(&SVector::from([angle, 0.0]), &zero, &zero, &zero)[0];
        assert_eq!((torque(6.9e-5), torque(-6.9e-5)), (0.0, 0.0));
        assert!((torque(8e-5) + 20.0).abs() < 1e-9 && (torque(-8e-5) - 20.0).abs() < 1e-9);
        assert!(torque(7e-5 + 1e-12).abs() < 1e-5);
        let free = drive.stiffness_at(&SVector::from([6.9e-5, 8e-5]), &zero);
        assert_eq!(free, SVector::from([0.0, 5e5]));
    }

    #[test]
    fn at_rest_the_springs_carry_the_load() {
        let zero = SVector::zeros();
        for drive in [drive(0.0), drive(7e-5)] {
            let load = SVector::from([150.0, -30.0]);
            let q = drive.deflection(&load);
            assert!((drive.torques(&q, &zero, &zero, &zero) + load).norm() < 1e-6);
            assert_eq!(drive.deflection(&zero), zero);
        }
    }

    /// The torque is the slope of the energy.
    #[test]
    fn energy_falls_by_the_work_of_the_torque() {
        let (drive, zero) = (drive(7e-5), SVector::zeros());
        for angle in [-2e-4, -3e-5, 1e-5, 9e-5] {
            let (step, q) = (1e-8, |angle: f64| SVector::from([angle, 0.0]));
            let slope = (drive.energy(&q(angle + step), &zero) - drive.energy(&q(angle - step), &zero)) / (2.0 * step);
            assert!((drive.torques(&q(angle), &zero, &zero, &zero)[0] + slope).abs() < 1e-5);
        }
    }
}
