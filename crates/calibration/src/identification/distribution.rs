//! Quantiles and tails of the distributions that errors and their squares have.

use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Half the width of the 95 % interval of an estimate in its standard deviations: Student's t where the noise is
/// estimated with so many degrees of freedom, normal where it is known.
pub fn half_width(degrees: Option<usize>) -> f64 {
    const UPPER: f64 = 0.975;
    let student = degrees.and_then(|degrees| StudentsT::new(0.0, 1.0, degrees as f64).ok());
    student.map_or_else(|| Normal::standard().inverse_cdf(UPPER), |student| student.inverse_cdf(UPPER))
}

/// Probability of a ratio of two mean squares, with these degrees of freedom, at least as large as `ratio`.
pub fn tail(ratio: f64, above: usize, below: usize) -> f64 {
    match FisherSnedecor::new(above as f64, below as f64) {
        Ok(distribution) if ratio.is_finite() => distribution.sf(ratio.max(0.0)),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_printed_tables() {
        // Abramowitz and Stegun, Table 26.10, and the normal quantile.
        for (degrees, expected) in [(Some(1), 12.706), (Some(5), 2.571), (Some(30), 2.042), (None, 1.960)] {
            assert!((half_width(degrees) - expected).abs() < 5e-4, "{degrees:?}");
        }
        // Table 26.9: F = 8.66 has a tail of 5 % with 3 above and 20 below at 3.10.
        assert!((tail(3.10, 3, 20) - 0.05).abs() < 2e-4);
        assert!((tail(4.94, 3, 20) - 0.01).abs() < 1e-4);
    }
}
