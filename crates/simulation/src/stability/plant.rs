//! Response of the tool tip to forces, as a state-space model.

use crate::modes::{LinearArm, eigenvalues, is_within_reach};
use nalgebra::{Complex, DMatrix, Matrix2x3, Vector3};

/// `x' = A x + B F`, `u = C x`: force F (N) on the tool tip along the feed, the outward normal of the wall and the tool
/// axis, and motion u (m) of it along feed and normal.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    poles: Vec<Complex<f64>>,
}

/// Why matrices make no plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PlantError {
    /// Shapes that do not fit.
    #[error("a plant needs A of n x n, B of n x 3 (or n x 2) and C of 2 x n")]
    Shape,
    /// Entries that are not finite, or so large that the motion over a step cannot be computed.
    #[error("the arm is so stiff or so damped beside its masses that its motion is beyond all numbers")]
    NotFinite,
    /// Eigenvalues that cannot be found.
    #[error("the eigenvalues of the arm's motion are not found: its stiffness, damping and masses are too far apart")]
    NoPoles,
    /// A mass matrix without an inverse.
    #[error("the arm has no mass matrix that is positive definite")]
    Singular,
}

impl Plant {
    /// A plant of its matrices. B may have two columns: then a force along the tool axis does nothing.
    ///
    /// # Errors
    /// [`PlantError`] for shapes that do not fit, entries that are not finite or too large, and a matrix A without
    /// eigenvalues.
    pub fn new(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>) -> Result<Self, PlantError> {
        let n = a.nrows();
        if n == 0 || a.shape() != (n, n) || b.nrows() != n || !(2..=3).contains(&b.ncols()) || c.shape() != (2, n) {
            return Err(PlantError::Shape);
        }
        if ![&a, &b, &c].into_iter().all(is_within_reach) {
            return Err(PlantError::NotFinite);
        }
        let poles = eigenvalues(a.clone()).ok_or(PlantError::NoPoles)?;
        Ok(Self { a, b: b.resize_horizontally(3, 0.0), c, poles })
    }

    /// Small motions of an arm's tip under forces along three directions in the base frame: the feed, the outward
    /// normal of the wall and the tool axis.
    ///
    /// # Errors
    /// [`PlantError`] for an arm whose mass matrix has no inverse, or whose stiffness and damping are beyond all
    /// numbers.
    pub fn of_arm(arm: &LinearArm, directions: [Vector3<f64>; 3]) -> Result<Self, PlantError> {
        let a = arm.state_matrix().ok_or(PlantError::Singular)?;
        let n = arm.mass.nrows();
        let tip = DMatrix::from_fn(3, n, |row, joint| directions[row].dot(&arm.tip.column(joint)));
        let mass = arm.mass.clone().cholesky().ok_or(PlantError::Singular)?;
        let (mut b, mut c) = (DMatrix::zeros(2 * n, 3), DMatrix::zeros(2, 2 * n));
        b.view_mut((n, 0), (n, 3)).copy_from(&mass.solve(&tip.transpose()));
        c.view_mut((0, 0), (2, n)).copy_from(&tip.rows(0, 2));
        Self::new(a, b, c)
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.a.nrows()
    }

    /// A, 1/s or of other units that go with the states.
    #[cfg(test)]
    pub fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// C.
    pub fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    /// Eigenvalues of A. 1/s
    pub fn poles(&self) -> &[Complex<f64>] {
        &self.poles
    }

    /// Motion (m, complex amplitude) for a force (N) that swings with `omega` (rad/s): `C (i omega - A)^-1 B`; none in
    /// a resonance without damping.
    pub fn response(&self, omega: f64) -> Option<Matrix2x3<Complex<f64>>> {
        let n = self.states();
        let matrix = DMatrix::from_fn(n, n, |row, column| {
            let swing = if row == column { Complex::new(0.0, omega) } else { Complex::from(0.0) };
            swing - Complex::from(self.a[(row, column)])
        });
        let states = matrix.lu().solve(&self.b.map(Complex::from))?;
        let response = self.c.map(Complex::from) * states;
        Some(Matrix2x3::from_fn(|row, column| response[(row, column)]))
    }

    /// Over a step (s) exactly, for a force that changes linearly from one value to another: next states are
    /// `E x + W_0 F_0 + W_1 F_1`.
    pub(super) fn step(&self, step: f64) -> [DMatrix<f64>; 3] {
        // exp([[A, B, 0], [0, 0, 1], [0, 0, 0]] h) = [[E, P, Q], ..] with P = int e^(A (h - s)) B ds and Q that of B s.
        let n = self.states();
        let mut all = DMatrix::zeros(n + 6, n + 6);
        all.view_mut((0, 0), (n, n)).copy_from(&(&self.a * step));
        all.view_mut((0, n), (n, 3)).copy_from(&(&self.b * step));
        // That of the last block in parts of the step: Q / h, what a force that rises to 1 does.
        all.view_mut((n, n + 3), (3, 3)).fill_with_identity();
        let whole = all.exp();
        let [constant, rising] = [n, n + 3].map(|column| whole.view((0, column), (n, 3)).into_owned());
        [whole.view((0, 0), (n, n)).into_owned(), constant - &rising, rising]
    }
}
