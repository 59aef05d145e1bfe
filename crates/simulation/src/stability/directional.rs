//! Directional coefficients: derivative of the milling force with respect to the motion of the tip, over each part of a
//! turn.

use nalgebra::Matrix3x2;
use std::f64::consts::{PI, TAU};
use stead_model::cutting::{
    Arc, Coefficients, Cutter, Engagement, EngagementError, Integrals, MillingDirection, PassCut,
};

/// `K_j` of every tooth as means over equal parts of a turn, at a depth of cut: `F = sum_j K_j (u(t) - u(t - tau_j))`.
/// N/m
///
/// With the tooth at psi the chip grows by `u_x sin psi - u_y cos psi`, and the force follows as
/// [`milling`](crate::milling) says. Runout is left out: it changes who cuts, not how the chip changes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Directional {
    /// One after the other: teeth of the first part, of the second, ...
    parts: Vec<Matrix3x2<f64>>,
    teeth: usize,
}

/// Where a tooth is in the work: psi from 0 to here. rad
///
/// # Errors
/// [`EngagementError`] for a width of cut that is none.
pub(super) fn exit(cutter: &Cutter, cut: &PassCut) -> Result<f64, EngagementError> {
    // By psi, down milling is up milling the other way round.
    let diameter = 2.0 * cutter.radius();
    let engagement = Engagement::up(cut.section.radial_depth.min(diameter), diameter)?;
    Ok(engagement.arcs().iter().fold(0.0, |_, arc| arc.exit))
}

impl Directional {
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub(super) fn new(cutter: &Cutter, cut: &PassCut, exit: f64, depth: f64, intervals: usize) -> Self {
        let width = TAU / intervals as f64;
        let slice = depth / cut.slices as f64;
        let lags: Vec<f64> = (0..cut.slices).map(|k| cutter.lag((k as f64 + 0.5) * slice)).collect();
        let offsets = cutter.offsets();
        let mut parts = Vec::with_capacity(intervals * offsets.len());
        for interval in 0..intervals {
            for offset in &offsets {
                let middle = (interval as f64 + 0.5) * width - offset;
                let mut sum = Integrals::default();
                for lag in &lags {
                    // Between -pi and pi, where the work lies from 0 to `exit`; in a slot beyond pi too.
                    let psi = cut.section.sense() * (middle - lag);
                    let psi = psi - TAU * ((psi + PI) / TAU).floor();
                    for psi in [psi, psi + TAU] {
                        let arc = Arc { entry: (psi - width / 2.0).max(0.0), exit: (psi + width / 2.0).min(exit) };
                        if arc.entry < arc.exit {
                            sum = sum.plus(Integrals::over(arc));
                        }
                    }
                }
                parts.push(matrix(cutter, cut.section.direction, &sum) * (slice / width));
            }
        }
        Self { parts, teeth: offsets.len() }
    }

    /// Every part replaced by the mean of all, tooth by tooth.
    #[cfg(test)]
    pub(super) fn mean(mut self) -> Self {
        let count = (self.parts.len() / self.teeth) as f64;
        for tooth in 0..self.teeth {
            let mean = self.parts.iter().skip(tooth).step_by(self.teeth).sum::<Matrix3x2<f64>>() / count;
            self.parts.iter_mut().skip(tooth).step_by(self.teeth).for_each(|part| *part = mean);
        }
        self
    }

    /// All teeth in one part of a turn.
    pub(super) fn at(&self, interval: usize) -> &[Matrix3x2<f64>] {
        &self.parts[interval * self.teeth..(interval + 1) * self.teeth]
    }
}

/// The mean over a turn of what one tooth does, at 1 m depth of cut. N/m^2
pub(super) fn mean(cutter: &Cutter, cut: &PassCut, exit: f64) -> Matrix3x2<f64> {
    matrix(cutter, cut.section.direction, &Integrals::over(Arc { entry: 0.0, exit })) / TAU
}

fn matrix(cutter: &Cutter, milling: MillingDirection, sums: &Integrals) -> Matrix3x2<f64> {
    let tangential = match milling {
        MillingDirection::Climb => cutter.coefficients().tangential,
        MillingDirection::Conventional => -cutter.coefficients().tangential,
    };
    let Coefficients { radial, axial, .. } = cutter.coefficients();
    let Integrals { sine, cosine, sine_squared, cosine_squared, sine_cosine, .. } = *sums;
    Matrix3x2::new(
        tangential * sine_cosine - radial * sine_squared,
        -tangential * cosine_squared + radial * sine_cosine,
        tangential * sine_squared + radial * sine_cosine,
        -tangential * sine_cosine - radial * cosine_squared,
        axial * sine,
        -axial * cosine,
    )
}
