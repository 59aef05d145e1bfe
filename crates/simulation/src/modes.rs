//! Modal analysis: natural frequencies, damping ratios and mode shapes of an arm, and the frequency response of its
//! tip.
//!
//! Small motions about a state of rest obey `M x'' + C x' + K x = J^T F`. Modes are the eigenvalues `s` of the state
//! matrix `[0, 1; -M^-1 K, -M^-1 C]`: a pair `s = -zeta omega +- i omega sqrt(1 - zeta^2)` is a mode with damping ratio
//! `zeta`; its natural frequency is that without damping, near `omega = |s|`.

use super::arm::Arm;
use nalgebra::{Complex, DMatrix, DVector, Matrix3, Matrix3xX, SMatrix, SVector, Schur, Vector3};
use serde::Serialize;
use std::f64::consts::TAU;

/// An arm linearised about a state of rest.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearArm {
    /// kg m^2
    pub mass: DMatrix<f64>,
    /// N m s/rad
    pub damping: DMatrix<f64>,
    /// Springs and gravity, the backlash taken up. N m/rad
    pub stiffness: DMatrix<f64>,
    /// Velocity of the tip per unit speed of each joint. m/rad
    pub tip: Matrix3xX<f64>,
}

/// A mode: a free vibration, or an overdamped motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mode {
    /// |s| / (2 pi). Hz
    pub frequency: f64,
    /// Undamped natural frequency of the mode with the same number, a little off |s| unless damping is proportional;
    /// `None` where overdamped modes make the numbers differ. Hz
    pub undamped: Option<f64>,
    /// Damping ratio; 1 for overdamped motions, negative for growing ones.
    pub damping_ratio: f64,
    /// Amplitudes of the joints, the largest 1, where the largest is at its peak.
    pub joints: Vec<f64>,
    /// Amplitude of the tip (m) for those of the joints (rad).
    pub tip: Vector3<f64>,
}

impl Mode {
    /// The undamped natural frequency where it is known, else |s| / (2 pi). Hz
    pub fn natural_frequency(&self) -> f64 {
        self.undamped.unwrap_or(self.frequency)
    }
}

impl LinearArm {
    /// The arm at rest at angles `q` (rad), with its damping times `damping_scale`.
    pub fn of<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>, damping_scale: f64) -> Self {
        let posed = arm.chain.at(q);
        let dynamic = |matrix: SMatrix<f64, N, N>| DMatrix::from_column_slice(N, N, matrix.as_slice());
        Self {
            mass: dynamic(posed.mass_matrix(&arm.chain)),
            damping: dynamic(SMatrix::from_diagonal(&(arm.drive.damping * damping_scale))),
            stiffness: dynamic(arm.stiffness(&posed, &arm.drive.stiffness)),
            tip: Matrix3xX::from_column_slice(posed.tip_jacobian().as_slice()),
        }
    }

    /// Number of its joints.
    fn joints(&self) -> usize {
        self.mass.nrows()
    }

    /// Natural frequencies without damping, ascending: square roots of the eigenvalues of `M^-1 K`. Hz; none where the
    /// mass matrix is not positive definite. A mode that gravity makes unstable counts as 0 Hz.
    pub fn undamped(&self) -> Option<Vec<f64>> {
        let factor = self.mass.clone().cholesky()?;
        let half = factor.l().solve_lower_triangular(&self.stiffness)?;
        let both = factor.l().solve_lower_triangular(&half.transpose())?;
        let both = (&both + both.transpose()) / 2.0;
        if !is_within_reach(&both) {
            return None;
        }
        let mut found: Vec<f64> =
            both.symmetric_eigenvalues().iter().map(|square| libm::sqrt(square.max(0.0)) / TAU).collect();
        found.sort_by(f64::total_cmp);
        Some(found)
    }

    /// The state matrix `[0, 1; -M^-1 K, -M^-1 C]`; none where the mass matrix is not positive definite.
    pub fn state_matrix(&self) -> Option<DMatrix<f64>> {
        let factor = self.mass.clone().cholesky()?;
        let n = self.joints();
        let mut matrix = DMatrix::zeros(2 * n, 2 * n);
        matrix.view_mut((0, n), (n, n)).fill_with_identity();
        matrix.view_mut((n, 0), (n, n)).copy_from(&-factor.solve(&self.stiffness));
        matrix.view_mut((n, n), (n, n)).copy_from(&-factor.solve(&self.damping));
        Some(matrix)
    }

    /// All modes, by natural frequency; none where the mass matrix is not positive definite, or stiffness and damping
    /// are beyond all numbers.
    pub fn modes(&self) -> Option<Vec<Mode>> {
        let mut modes: Vec<Mode> = eigenvalues(self.state_matrix()?)?
            .iter()
            // One of each pair; what does not swing is by itself.
            .filter(|s| s.im >= 0.0)
            .filter_map(|s| self.mode(*s))
            .collect();
        modes.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        let undamped = self.undamped()?;
        if modes.len() == undamped.len() {
            modes.iter_mut().zip(undamped).for_each(|(mode, frequency)| mode.undamped = Some(frequency));
        }
        Some(modes)
    }

    /// The mode of an eigenvalue: a null vector of `s^2 M + s C + K`, by inverse iteration.
    fn mode(&self, s: Complex<f64>) -> Option<Mode> {
        let size = s.norm();
        // Next to the eigenvalue, so that the matrix has an inverse.
        let near = s * (1.0 + 1e-9) + Complex::new(1e-300, 0.0);
        let factor = self.dynamic_stiffness(near).lu();
        let mut shape = DVector::from_fn(self.joints(), |k, _| Complex::new(1.0 + k as f64 / 7.0, 0.3));
        for _ in 0..4 {
            shape = factor.solve(&shape)?;
            let norm = shape.norm();
            shape.unscale_mut(norm);
        }
        let largest = shape.iter().copied().max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr()))?;
        let joints: Vec<f64> = shape.iter().map(|amplitude| (amplitude / largest).re).collect();
        let tip = &self.tip * DVector::from_column_slice(&joints);
        let damping_ratio = if size > 0.0 { -s.re / size } else { 0.0 };
        Some(Mode { frequency: size / TAU, undamped: None, damping_ratio, joints, tip })
    }

    /// `s^2 M + s C + K`.
    fn dynamic_stiffness(&self, s: Complex<f64>) -> DMatrix<Complex<f64>> {
        DMatrix::from_fn(self.joints(), self.joints(), |row, column| {
            let at = (row, column);
            s * s * self.mass[at] + s * self.damping[at] + Complex::from(self.stiffness[at])
        })
    }

    /// Response of the tip (m, complex amplitude) to a force (N) in each direction that swings at `frequency` (Hz):
    /// columns are directions of the force; none in a resonance without damping.
    pub fn response(&self, frequency: f64) -> Option<Matrix3<Complex<f64>>> {
        let matrix = self.dynamic_stiffness(Complex::new(0.0, TAU * frequency));
        let jacobian = DMatrix::from_fn(self.joints(), 3, |row, column| Complex::from(self.tip[(column, row)]));
        let angles = matrix.lu().solve(&jacobian)?;
        let response = jacobian.transpose() * angles;
        Some(Matrix3::from_fn(|row, column| response[(row, column)]))
    }
}

/// Entries of a matrix whose eigenvalues, powers and exponential can be held in numbers.
const REACH: f64 = 1e25;
/// Steps of the QR algorithm for each eigenvalue; two or three are usual.
const QR_STEPS: usize = 100;

/// Whether a matrix has finite entries, none of them so large that its powers overflow.
pub(crate) fn is_within_reach(matrix: &DMatrix<f64>) -> bool {
    matrix.iter().all(|entry| entry.abs() <= REACH)
}

/// The eigenvalues of a square matrix; none where its entries are [beyond reach](is_within_reach) or the QR algorithm
/// does not converge.
pub(crate) fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if !is_within_reach(&matrix) {
        return None;
    }
    let steps = QR_STEPS * matrix.nrows();
    let schur = Schur::try_new(matrix, f64::EPSILON, steps)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

#[cfg(test)]
mod tests;
