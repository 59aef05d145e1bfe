//! The table `[certificate]` of a run file, and what a certificate asks of the rest of it.

use crate::input::InputError;
use crate::place::Place;
use crate::quantity::Quantity;
use crate::units::{Percent, Positive, S, ranges};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use stead_placement::certify::certifiable;
use stead_placement::problem::Problem;
use stead_placement::settings::CertificateSettings;
use stead_placement::symmetry::Unsupported;

/// Which gaps can be asked for, on the command line as well.
pub const GAPS_ALLOWED: &str = "a number of per cent from 0.0001 (finer is within rounding) to below 100";

ranges! {
    /// A gap in per cent; finer ones are within rounding.
    Gap: Included(1e-4), Excluded(100.0);
}

/// A proof of how far the placement found is from the best possible.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CertificateTable {
    /// The proof is done when no placement can be better than the one found by more than this.
    pub gap_percent: Percent<Gap>,
    /// Time after which the proof ends with the bound that it has; no limit where left out.
    pub time_limit_s: Option<S<Positive>>,
}

impl CertificateTable {
    pub(super) fn settings(&self) -> CertificateSettings {
        CertificateSettings { gap: self.gap_percent.si(), time_limit: self.time_limit_s.map(Quantity::si) }
    }
}

/// Refuses a cell whose tables would not fit in memory; other reasons against a certificate are left to the job, which places
/// the workpiece without one.
pub(super) fn check_size(problem: &Problem, cell: &Place<'_>) -> Result<(), InputError> {
    match certifiable(problem) {
        Err(too_large @ Unsupported::TooLarge { max, .. }) => {
            let allowed = format!("a cell whose tables take up to {:.1} GB, or no certificate", max as f64 / 1e9);
            Err(InputError::new(cell.file.file(), too_large.to_string())
                .at_line(cell.line())
                .in_field("cell")
                .allowed(allowed))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{RUN, assert_refused, folder, read_text as read};
    use crate::{read_run, read_run_to_certify};

    #[test]
    fn a_certificate_is_asked_for_in_per_cent() {
        assert_eq!(read(RUN).unwrap().certificate, None);
        let text = format!("{RUN}[certificate]\ngap_percent = 0.5\n");
        assert_eq!(read(&text).unwrap().certificate, Some(CertificateSettings { gap: 0.005, time_limit: None }));
        let settings = read(&format!("{text}time_limit_s = 20\n")).unwrap().certificate.unwrap();
        assert_eq!(settings.time_limit, Some(20.0));
        assert_eq!(read(&text.replace("0.5", "0.0001")).unwrap().certificate.unwrap().gap, 1e-6);
    }

    #[test]
    fn the_command_line_has_the_last_word_on_the_gap() {
        let folder = folder();
        let file = folder.path().join("run.toml");
        std::fs::write(&file, format!("{RUN}[certificate]\ngap_percent = 0.5\ntime_limit_s = 20\n")).unwrap();
        let asked = |gap| read_run_to_certify(&file, gap).unwrap().certificate;
        assert_eq!(asked(None), read_run(&file).unwrap().certificate);
        assert_eq!(asked(Some(0.02)), Some(CertificateSettings { gap: 0.02, time_limit: Some(20.0) }));
        std::fs::write(&file, RUN).unwrap();
        assert_eq!(asked(None), None);
        assert_eq!(asked(Some(0.02)), Some(CertificateSettings { gap: 0.02, time_limit: None }));
    }

    #[test]
    fn gaps_that_mean_nothing_are_refused() {
        for bad in ["0", "-0.5", "0.00009", "1e-9", "100", "1e300"] {
            let table = format!("[certificate]\ngap_percent = {bad}\n[cell]");
            let found = format!("found {bad};");
            assert_refused(
                "[cell]",
                &table,
                &["run.toml:7: certificate.gap_percent: is out of range", &found, "0.0001"],
            );
        }
        let table = "[certificate]\ntime_limit_s = 3\n[cell]";
        assert_refused("[cell]", table, &["run.toml:6: certificate.gap_percent: is missing"]);
        let table = "[certificate]\ngap_percent = 1\ntime_limit_s = 0\n[cell]";
        assert_refused("[cell]", table, &["run.toml:8: certificate.time_limit_s: is out of range", "found 0;"]);
        let table = "[certificate]\ngap_percent = nan\n[cell]";
        assert_refused("[cell]", table, &["run.toml:7: certificate.gap_percent: is not a finite number"]);
    }

    #[test]
    fn a_cell_too_large_for_the_tables_is_refused_only_where_a_certificate_is_asked_for() {
        let large = RUN.replace("x_mm = [-300, 300]", "x_mm = [-300000, 300000]");
        assert_eq!(read(&large).unwrap().certificate, None);
        let message = read(&format!("{large}[certificate]\ngap_percent = 1\n")).unwrap_err().to_string();
        for part in ["run.toml:6: cell: the cell is so large that tables would take ", " GB", "; allowed: a cell whose"]
        {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}
