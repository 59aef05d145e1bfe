//! CSV files of the force and the moment of a milling tool.

use super::output::ReportError;
use crate::csv_file::rows_or;
use crate::figure::{AngleDeg, ForceN, MomentNm, each};
use stead_model::cutting::{ForceHistory, Sample};

records! {
    /// Mean force and moment over a turn as the tool moves into the work (Klimchik 2017, Fig. 4).
    #[derive(Default)]
    pub struct EngagementRow of (sample: &Sample) {
        /// The angle to which a tooth is in the work.
        engaged_deg: AngleDeg = sample.phi.into(),
        #[serde(flatten)] load: LoadColumns = sample.into(),
    }

    /// Force and moment of all teeth at an angle of the first tooth.
    #[derive(Default)]
    pub struct ToothRow of (sample: &Sample) {
        /// The angle of the first tooth.
        tooth_deg: AngleDeg = sample.phi.into(),
        #[serde(flatten)] load: LoadColumns = sample.into(),
    }
}

records! {
    /// Force on the tool, and moment about its centre point: along the feed, to the left of it, and along the tool axis
    /// from the work to the spindle.
    #[derive(Default)]
    struct LoadColumns from sample: &Sample {
        let [force_feed_n, force_left_n, force_axis_n] = each(sample.wrench.force.into());
        let [moment_feed_nm, moment_left_nm, moment_axis_nm] = each(sample.wrench.moment.into());
    } with {
        /// Force along the feed.
        force_feed_n: ForceN = force_feed_n,
        /// Force to the left of it.
        force_left_n: ForceN = force_left_n,
        /// Force along the tool axis.
        force_axis_n: ForceN = force_axis_n,
        /// Size of the force.
        force_n: ForceN = sample.wrench.force.norm().into(),
        /// Moment about the feed.
        moment_feed_nm: MomentNm = moment_feed_nm,
        /// Moment about the left.
        moment_left_nm: MomentNm = moment_left_nm,
        /// Moment about the tool axis.
        moment_axis_nm: MomentNm = moment_axis_nm,
        /// Size of the moment.
        moment_nm: MomentNm = sample.wrench.moment.norm().into(),
    }
}

/// An [`EngagementRow`] per degree, from 0 to 180.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn entering(force_history: &ForceHistory) -> Result<Vec<u8>, ReportError> {
    let samples = force_history.entering.iter().map(EngagementRow::of);
    rows_or("the table of mean cutting forces", &EngagementRow::default(), samples)
}

/// A [`ToothRow`] per angle of the first tooth over one turn.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn turn(force_history: &ForceHistory) -> Result<Vec<u8>, ReportError> {
    rows_or(
        "the table of cutting forces over a turn",
        &ToothRow::default(),
        force_history.turn.iter().map(ToothRow::of),
    )
}

#[cfg(test)]
mod tests {
    use super::super::testing::force_history;
    use super::*;

    fn lines(bytes: Vec<u8>) -> Vec<String> {
        String::from_utf8(bytes).unwrap().lines().map(str::to_owned).collect()
    }

    #[test]
    fn each_row_has_both_vectors_with_their_magnitudes() {
        let lines = lines(entering(&force_history()).unwrap());
        assert_eq!(lines.len(), 1 + 181);
        assert_eq!(
            lines[0],
            "engaged_deg,force_feed_n,force_left_n,force_axis_n,force_n,moment_feed_nm,moment_left_nm,moment_axis_nm,moment_nm"
        );
        assert!(lines[1].starts_with("0.0000,0.0000,0.0000,0.0000,0.0000,0.000000,"), "{}", lines[1]);
        let slot: Vec<f64> = lines[181].split(',').map(|field| field.parse().unwrap()).collect();
        assert_eq!(slot[0], 180.0);
        assert!((slot[4] - libm::sqrt(slot[1..4].iter().map(|part| part * part).sum())).abs() < 1e-3, "{slot:?}");
        assert!((slot[8] - libm::sqrt(slot[5..8].iter().map(|part| part * part).sum())).abs() < 1e-5, "{slot:?}");
    }

    #[test]
    fn a_turn_has_a_row_per_half_degree() {
        let lines = lines(turn(&force_history()).unwrap());
        assert_eq!(lines.len(), 1 + 721);
        assert!(lines[0].starts_with("tooth_deg,") && lines[721].starts_with("360.0000,"), "{}", lines[721]);
    }
}
