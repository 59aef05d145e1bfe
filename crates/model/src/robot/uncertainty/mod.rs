//! How well the compliances of an arm are known: the covariance of the parameters behind them.
//!
//! An identification gives compliances with errors that hang together (Klimchik et al. 2017, eq. 19). [`Uncertainty`]
//! holds their covariance Sigma over the parameters of the joints' laws ([`Parameter`]), so that the standard deviation
//! of anything that is linear in them, `sqrt(g^T Sigma g)` with g its gradient, comes out with all correlations. A
//! deflection is linear in the six compliances, so that nothing is lost; the compliance of a joint beside a compensator
//! is linear in its parameters to first order only.

use super::Robot;
use nalgebra::{DMatrix, SymmetricEigen};
use stead_numerics::scalar::Scalar;

/// A number behind a compliance that an identification can find; each names its joint, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Parameter {
    /// The constant compliance of the joint, or that of the joint without its compensator. rad/(N m)
    Compliance(usize),
    /// The compliance of a range at the lower limit. rad/(N m)
    ComplianceAtMin(usize),
    /// The compliance of a range at the upper limit. rad/(N m)
    ComplianceAtMax(usize),
    /// The stiffness K_GC of the compensator's spring. N/m
    SpringStiffness(usize),
    /// The free length s_0 of the compensator's spring. m
    FreeLength(usize),
    /// The compliance about the x axis of the row's frame, normal to the axis of the joint. rad/(N m)
    AboutX(usize),
    /// The compliance about the y axis of the row's frame, normal to the axis of the joint. rad/(N m)
    AboutY(usize),
}

impl Parameter {
    /// The joint, from 0.
    pub fn joint(self) -> usize {
        match self {
            Self::Compliance(joint)
            | Self::ComplianceAtMin(joint)
            | Self::ComplianceAtMax(joint)
            | Self::SpringStiffness(joint)
            | Self::FreeLength(joint)
            | Self::AboutX(joint)
            | Self::AboutY(joint) => joint,
        }
    }

    /// Of a spring normal to the axis of its joint, about which axis of the row's frame: x (0) or y (1).
    pub fn about(self) -> Option<usize> {
        match self {
            Self::AboutX(_) => Some(0),
            Self::AboutY(_) => Some(1),
            _ => None,
        }
    }

    /// Every parameter that the springs of any joint (from 0) may have.
    pub fn of_joint(joint: usize) -> [Self; 7] {
        [
            Self::Compliance(joint),
            Self::ComplianceAtMin(joint),
            Self::ComplianceAtMax(joint),
            Self::SpringStiffness(joint),
            Self::FreeLength(joint),
            Self::AboutX(joint),
            Self::AboutY(joint),
        ]
    }
}

/// Parameters and their covariance, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    parameters: Vec<Parameter>,
    covariance: DMatrix<f64>,
    /// Vectors f_r over the parameters with `Sigma = sum_r f_r f_r^T`.
    directions: Vec<Vec<f64>>,
}

/// Why some numbers are not the covariance of an arm's parameters. Rows and columns count from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UncertaintyError {
    /// There is no parameter, or the matrix has not one row and one column for each.
    #[error("a covariance of {parameters} parameters has {rows} rows and {columns} columns")]
    Size {
        /// Number of parameters.
        parameters: usize,
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
    /// A parameter is named twice.
    #[error("{parameter:?} is named twice")]
    Repeated {
        /// The parameter.
        parameter: Parameter,
        /// Its second place among the parameters, from 0.
        place: usize,
    },
    /// The law of the joint has no such parameter, or the arm no such joint.
    #[error("the law of the joint has no {parameter:?}")]
    NotOfLaw {
        /// The parameter.
        parameter: Parameter,
        /// Its place among the parameters, from 0.
        place: usize,
    },
    /// An entry is NaN or infinite.
    #[error("entry ({row}, {column}) is {value}, but must be finite")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// What was found, in SI units.
        value: f64,
    },
    /// A variance is below zero.
    #[error("variance {row} is {value}, but must not be below zero")]
    NegativeVariance {
        /// Its row.
        row: usize,
        /// What was found, in SI units.
        value: f64,
    },
    /// An entry differs from its mirror image by more than rounding.
    #[error("entry ({row}, {column}) is {value}, but its mirror image is {mirrored}")]
    NotSymmetric {
        /// Its row.
        row: usize,
        /// Its column, below the row.
        column: usize,
        /// What was found, in SI units.
        value: f64,
        /// The entry with row and column exchanged, in SI units.
        mirrored: f64,
    },
    /// A covariance is larger than two variances allow.
    #[error("entry ({row}, {column}) makes a correlation of {correlation}, but the limits are -1 and 1")]
    Correlation {
        /// Its row.
        row: usize,
        /// Its column, below the row.
        column: usize,
        /// The covariance over the root of both variances.
        correlation: f64,
    },
    /// Some combination of the parameters would have a negative variance: the smallest eigenvalue of the correlation
    /// matrix.
    #[error("the matrix is not positive semidefinite: its correlations have an eigenvalue of {0}")]
    Indefinite(f64),
}

/// What rounding may do to symmetry, correlations and their eigenvalues.
const ROUNDING: f64 = 1e-9;

impl Uncertainty {
    /// The most parameters that the springs of six joints can have: three of the law about each axis, two normal to it.
    pub const MAX_PARAMETERS: usize = 30;

    /// Takes parameters and their covariance, in SI units, row and column k for parameter k.
    ///
    /// # Errors
    /// [`UncertaintyError`] unless each parameter is named once and the matrix is square, finite, symmetric and
    /// positive semidefinite, the last two up to 1e-9 of the variances.
    pub fn new(parameters: Vec<Parameter>, covariance: DMatrix<f64>) -> Result<Self, UncertaintyError> {
        let (count, (rows, columns)) = (parameters.len(), covariance.shape());
        if count == 0 || rows != count || columns != count {
            return Err(UncertaintyError::Size { parameters: count, rows, columns });
        }
        for (place, parameter) in parameters.iter().enumerate() {
            if parameters[..place].contains(parameter) {
                return Err(UncertaintyError::Repeated { parameter: *parameter, place });
            }
        }
        let deviations = deviations(&covariance)?;
        let correlations = correlations(&covariance, &deviations)?;
        let eigen = SymmetricEigen::new(correlations);
        let least = eigen.eigenvalues.min();
        if least < -ROUNDING {
            return Err(UncertaintyError::Indefinite(least));
        }
        let directions = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let directions = directions.filter(|(value, _)| **value > 0.0).map(|(value, vector)| {
            vector.iter().zip(&deviations).map(|(entry, deviation)| entry * libm::sqrt(*value) * deviation).collect()
        });
        let directions = directions.collect();
        let covariance = (&covariance + covariance.transpose()) * 0.5;
        Ok(Self { parameters, covariance, directions })
    }

    /// The parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Their covariance in SI units, row and column k for parameter k.
    pub fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }

    /// Vectors f_r over the parameters with `Sigma = sum_r f_r f_r^T`: independent errors of size one, in SI units.
    pub fn directions(&self) -> &[Vec<f64>] {
        &self.directions
    }

    /// Standard deviation `sqrt(g^T Sigma g)` of a quantity whose derivatives by the parameters are `gradient`, in
    /// their order and in SI units. Exactly zero, with derivatives of zero, where no error is seen.
    pub fn standard_deviation<T: Scalar>(&self, gradient: &[T]) -> T {
        self.changes(gradient).fold(T::zero(), |variance, change| variance + change * change).sqrt()
    }

    /// By how much each of [`Uncertainty::directions`] changes a quantity whose derivatives by the parameters are
    /// `gradient`: the standard deviation is the Euclidean norm of these changes.
    pub fn changes<T: Scalar>(&self, gradient: &[T]) -> impl Iterator<Item = T> {
        self.directions.iter().map(move |direction| {
            let shares = direction.iter().zip(gradient);
            shares.fold(T::zero(), |change, (share, slope)| change + slope.scale(*share))
        })
    }
}

/// Roots of the variances of a matrix whose numbers are all finite.
fn deviations(covariance: &DMatrix<f64>) -> Result<Vec<f64>, UncertaintyError> {
    let count = covariance.nrows();
    for row in 0..count {
        for column in 0..count {
            let value = covariance[(row, column)];
            if !value.is_finite() {
                return Err(UncertaintyError::NotFinite { row, column, value });
            }
        }
    }
    let deviation = |row: usize| match covariance[(row, row)] {
        value if value < 0.0 => Err(UncertaintyError::NegativeVariance { row, value }),
        value => Ok(libm::sqrt(value)),
    };
    (0..count).map(deviation).collect()
}

/// The correlation matrix; zero in the rows of parameters without variance.
fn correlations(covariance: &DMatrix<f64>, deviations: &[f64]) -> Result<DMatrix<f64>, UncertaintyError> {
    let count = deviations.len();
    let mut correlations = DMatrix::zeros(count, count);
    for row in 0..count {
        if deviations[row] > 0.0 {
            correlations[(row, row)] = 1.0;
        }
        for column in 0..row {
            let (value, mirrored) = (covariance[(row, column)], covariance[(column, row)]);
            let unit = deviations[row] * deviations[column];
            if (value - mirrored).abs() > ROUNDING * unit {
                return Err(UncertaintyError::NotSymmetric { row, column, value, mirrored });
            }
            let mean = 0.5 * value + 0.5 * mirrored;
            // A parameter without variance has no covariance with any other.
            let correlation = if mean == 0.0 { 0.0 } else { mean / unit };
            if correlation.abs() > 1.0 + ROUNDING {
                return Err(UncertaintyError::Correlation { row, column, correlation });
            }
            correlations[(row, column)] = correlation;
            correlations[(column, row)] = correlation;
        }
    }
    Ok(correlations)
}

impl Robot {
    /// How well the compliances are known, where the robot file says so.
    pub fn uncertainty(&self) -> Option<&Uncertainty> {
        self.uncertainty.as_ref()
    }

    /// The same arm with compliances known this well.
    ///
    /// # Errors
    /// [`UncertaintyError::NotOfLaw`] for a parameter that the law of its joint does not have.
    pub fn with_uncertainty(mut self, uncertainty: Uncertainty) -> Result<Self, UncertaintyError> {
        for (place, parameter) in uncertainty.parameters.iter().enumerate() {
            if !self.has_parameter(*parameter) {
                return Err(UncertaintyError::NotOfLaw { parameter: *parameter, place });
            }
        }
        self.uncertainty = Some(uncertainty);
        Ok(self)
    }

    /// Whether a joint of the arm has a law, or a spring, with this parameter.
    pub fn has_parameter(&self, parameter: Parameter) -> bool {
        if parameter.about().is_some() {
            return self.stated_normal_springs().is_some() && parameter.joint() < 6;
        }
        self.joints().get(parameter.joint()).is_some_and(|joint| joint.compliance.has(parameter))
    }

    /// Derivatives of the compliances by the uncertain parameters at joint angles `theta` (rad), wrapped or not: one
    /// entry for each parameter, by which it moves the compliance of its own spring, in rad/(N m) per SI unit (it moves
    /// no other: the entries are the nonzero ones of the matrix G of springs by parameters); zero for a spring that
    /// deflections do not count. Empty for an arm without uncertainty.
    pub fn compliance_gradient_at<T: Scalar>(&self, theta: &[T; 6]) -> Vec<T> {
        let parameters = self.uncertainty.as_ref().map(Uncertainty::parameters).unwrap_or_default();
        let counts_normal = self.normal_springs().is_some();
        let slope = |parameter: &Parameter| {
            let joint = parameter.joint();
            if parameter.about().is_some() {
                return if counts_normal { T::one() } else { T::zero() };
            }
            self.joints()[joint].compliance_slope_at(*parameter, theta[joint])
        };
        parameters.iter().map(slope).collect()
    }

    /// Covariance `G Sigma G^T` of the six compliances about the axes at joint angles `theta` (rad), in (rad/(N m))^2;
    /// zero for an arm without uncertainty.
    #[cfg(any(test, feature = "testing"))]
    pub fn compliance_covariance_at(&self, theta: &[f64; 6]) -> nalgebra::Matrix6<f64> {
        let mut covariance = nalgebra::Matrix6::zeros();
        let Some(uncertainty) = &self.uncertainty else { return covariance };
        let slopes = self.compliance_gradient_at(theta);
        for (k, a) in uncertainty.parameters.iter().enumerate() {
            for (l, b) in uncertainty.parameters.iter().enumerate() {
                if a.about().is_some() || b.about().is_some() {
                    continue;
                }
                covariance[(a.joint(), b.joint())] += slopes[k] * uncertainty.covariance[(k, l)] * slopes[l];
            }
        }
        covariance
    }
}

#[cfg(test)]
mod tests;
