//! CSV files of the force and the moment of a milling tool.

use super::output::ReportError;
use crate::csv_file::{table, vector};
use crate::units::Unit;
use stead_model::cutting::{ForceHistory, Sample};

/// Mean force and moment over a turn as the tool moves into the work: one row per degree to which a tooth is in it, from 0 to
/// 180 (Klimchik 2017, Fig. 4). Along the feed, to the left of it, and along the tool axis from the work to the spindle; the
/// moment is about the tool centre point.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn entering(force_history: &ForceHistory) -> Result<Vec<u8>, ReportError> {
    rows("the table of mean cutting forces", "engaged_deg", &force_history.entering)
}

/// Force and moment of all teeth over one turn, one row per angle of the first tooth, in the same directions.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn turn(force_history: &ForceHistory) -> Result<Vec<u8>, ReportError> {
    rows("the table of cutting forces over a turn", "tooth_deg", &force_history.turn)
}

fn rows(what: &'static str, angle: &'static str, samples: &[Sample]) -> Result<Vec<u8>, ReportError> {
    const PARTS: &str =
        "force_feed_n,force_left_n,force_axis_n,force_n,moment_feed_nm,moment_left_nm,moment_axis_nm,moment_nm";
    let row = |Sample { phi, wrench }: &Sample| {
        let mut row = vec![Unit::ANGLE_DEG.text(*phi)];
        for (unit, part) in [(Unit::FORCE_N, wrench.force), (Unit::MOMENT_NM, wrench.moment)] {
            row.extend(vector(unit, &part));
            row.push(unit.text(part.norm()));
        }
        row
    };
    table(what, std::iter::once(angle).chain(PARTS.split(',')), samples.iter().map(row))
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
