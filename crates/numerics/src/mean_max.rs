//! Figures that sum up a magnitude along a path.

use serde::Serialize;

/// Mean and largest value of a magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct MeanAndMax {
    /// Mean.
    pub mean: f64,
    /// Largest value.
    pub max: f64,
}

impl MeanAndMax {
    /// Those of magnitudes, which are not negative; NaN as the mean of none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let (sum, max, count) = values
            .into_iter()
            .fold((0.0, 0.0_f64, 0), |(sum, max, count), value| (sum + value, max.max(value), count + 1));
        Self { mean: sum / f64::from(count), max }
    }
}

/// The value that a share (0 to 1) of all values does not exceed: the nearest rank. NaN of none.
pub fn percentile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_up() {
        assert_eq!(MeanAndMax::of([1.0, 4.0, 1.0]), MeanAndMax { mean: 2.0, max: 4.0 });
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!((percentile(hundred.clone(), 0.5), percentile(hundred, 0.95)), (50.0, 95.0));
        assert!(percentile([], 0.5).is_nan());
        assert_eq!(percentile([3.0], 0.0), 3.0);
    }
}
