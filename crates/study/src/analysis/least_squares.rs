//! Linear least squares with columns that may depend on each other.

/// Columns of a linear model made orthonormal one by one (modified Gram-Schmidt, each column twice). A column that the
/// ones before it add up to is left out: its coefficient is zero.
pub(super) struct LinearModel {
    /// Orthonormal directions, each with the number of its column.
    directions: Vec<(usize, Vec<f64>)>,
    /// For each direction what its column has along this and the earlier ones.
    triangle: Vec<Vec<f64>>,
    columns: usize,
}

/// A column counts as dependent where less than this share of its length is left.
const DEPENDENT: f64 = 1e-9;

impl LinearModel {
    pub fn new(columns: &[Vec<f64>]) -> Self {
        let mut model = Self { directions: Vec::new(), triangle: Vec::new(), columns: columns.len() };
        for (number, column) in columns.iter().enumerate() {
            let (mut rest, mut along) = (column.clone(), vec![0.0; model.directions.len()]);
            for _ in 0..2 {
                for ((_, direction), along) in model.directions.iter().zip(&mut along) {
                    let part = dot(direction, &rest);
                    *along += part;
                    rest.iter_mut().zip(direction).for_each(|(rest, d)| *rest -= part * d);
                }
            }
            let length = libm::sqrt(dot(&rest, &rest));
            if length > DEPENDENT * libm::sqrt(dot(column, column)) {
                rest.iter_mut().for_each(|value| *value /= length);
                along.push(length);
                model.directions.push((number, rest));
                model.triangle.push(along);
            }
        }
        model
    }

    /// How many columns do not depend on earlier ones.
    pub fn rank(&self) -> usize {
        self.directions.len()
    }

    /// The part of the sum of squares of some values that the model leaves.
    pub fn residual(&self, values: &[f64]) -> f64 {
        let mut rest = values.to_vec();
        for (_, direction) in &self.directions {
            let part = dot(direction, &rest);
            rest.iter_mut().zip(direction).for_each(|(rest, d)| *rest -= part * d);
        }
        dot(&rest, &rest)
    }

    /// The coefficients of the columns that fit some values best.
    pub fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        let mut rest: Vec<f64> = self.directions.iter().map(|(_, direction)| dot(direction, values)).collect();
        let mut coefficients = vec![0.0; self.columns];
        for row in (0..rest.len()).rev() {
            let along = &self.triangle[row];
            let coefficient = rest[row] / along[row];
            rest.iter_mut().zip(along).take(row).for_each(|(rest, along)| *rest -= coefficient * along);
            coefficients[self.directions[row].0] = coefficient;
        }
        coefficients
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_come_back_and_dependent_columns_are_left_out() {
        let ones = vec![1.0; 5];
        let a = vec![0.0, 1.0, 2.0, 3.0, 4.0];
        let b = vec![1.0, 0.0, 0.0, 5.0, -2.0];
        let sum: Vec<f64> = ones.iter().zip(&a).map(|(one, a)| one + a).collect();
        let values: Vec<f64> = (0..5).map(|k| 3.0 - 2.0 * a[k] + 0.5 * b[k]).collect();
        let model = LinearModel::new(&[ones, a, sum, b]);
        assert_eq!(model.rank(), 3);
        assert!(model.residual(&values) < 1e-20);
        let expected = [3.0, -2.0, 0.0, 0.5];
        let found = model.coefficients(&values);
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{found:?}");
    }
}
