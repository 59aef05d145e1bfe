//! The table `[certificate]` of a run file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use stead_format::quantity::Quantity;
use stead_format::units::{Gb, Percent, Positive, S, ranges};
use stead_problem::settings::CertificateSettings;

/// Which gaps can be requested, on the command line as well.
pub const GAPS_ALLOWED: &str = "a number of per cent from 0.0001 (finer is within rounding) to below 100";

ranges! {
    /// A gap in per cent; finer ones are within rounding.
    Gap: Included(1e-4), Excluded(100.0);
    /// Memory from a megabyte to a petabyte. GB
    Memory: Included(1e-3), Included(1e6);
}

/// A proof of how far the placement found is from the best possible.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CertificateTable {
    /// The proof is done when no placement can be better than the one found by more than this.
    pub gap_percent: Percent<Gap>,
    /// Time after which the proof ends with the bound that it has; no limit where left out.
    pub time_limit_s: Option<S<Positive>>,
    /// Memory for the tables of the proof and the boxes that it has open; 4 GB where left out, on every machine. Where
    /// it does not suffice, the workpiece is placed with the bound reached by then, or without one.
    pub memory_gb: Option<Gb<Memory>>,
}

impl CertificateTable {
    pub(super) fn settings(&self) -> CertificateSettings {
        let default = CertificateSettings::new(self.gap_percent.si());
        CertificateSettings {
            time_limit: self.time_limit_s.map(Quantity::si),
            memory: self.memory_gb.map_or(default.memory, |memory| memory.si() as u64),
            ..default
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{RUN, assert_refused, read_text as read};

    #[test]
    fn a_certificate_is_asked_for_in_per_cent() {
        assert_eq!(read(RUN).unwrap().certificate, None);
        let text = format!("{RUN}[certificate]\ngap_percent = 0.5\n");
        assert_eq!(read(&text).unwrap().certificate, Some(CertificateSettings::new(0.005)));
        let settings = read(&format!("{text}time_limit_s = 20\n")).unwrap().certificate.unwrap();
        assert_eq!(settings.time_limit, Some(20.0));
        assert_eq!(read(&text.replace("0.5", "0.0001")).unwrap().certificate.unwrap().gap, 1e-6);
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
    fn a_cell_too_large_for_the_tables_is_no_bad_input() {
        let large = RUN.replace("x_mm = [-300, 300]", "x_mm = [-300000, 300000]");
        assert!(read(&format!("{large}[certificate]\ngap_percent = 1\n")).is_ok());
    }

    #[test]
    fn the_memory_of_a_certificate_is_the_same_on_every_machine() {
        let with =
            |line: &str| read(&format!("{RUN}[certificate]\ngap_percent = 1\n{line}")).unwrap().certificate.unwrap();
        assert_eq!((with("").memory, with("memory_gb = 0.5\n").memory), (4_000_000_000, 500_000_000));
        for bad in ["0", "-1", "0.0001", "1e7", "nan"] {
            let table = format!("[certificate]\ngap_percent = 1\nmemory_gb = {bad}\n[cell]");
            assert_refused("[cell]", &table, &["run.toml:8: certificate.memory_gb: ", &format!("found {bad};")]);
        }
    }
}
