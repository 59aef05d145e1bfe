//! What was held against what, and where they differ.

use std::collections::BTreeMap;
use std::fmt;

/// What a judge found: how many figures of each kind it held against its own, and every disagreement.
#[derive(Debug, Clone, Default)]
pub struct Verdict {
    /// Number of comparisons by kind.
    pub checks: BTreeMap<&'static str, usize>,
    /// One line each; of each kind the first twenty.
    pub disagreements: Vec<String>,
    /// Why a program was not written, where it was requested.
    pub not_exported: Vec<String>,
    told: BTreeMap<&'static str, usize>,
}

impl Verdict {
    /// A figure as stated and as computed.
    pub(crate) fn close(
        &mut self,
        kind: &'static str,
        place: impl Fn() -> String,
        stated: f64,
        computed: f64,
        tolerance: f64,
    ) {
        let is_close = (stated - computed).abs() <= tolerance;
        self.holds(
            kind,
            || format!("{}: stated {stated}, computed {computed}, tolerance {tolerance:.3e}", place()),
            is_close,
        );
    }

    /// A figure that must not be above a limit.
    pub(crate) fn within(&mut self, kind: &'static str, place: impl Fn() -> String, value: f64, limit: f64) {
        self.holds(kind, || format!("{}: {value} is above {limit}", place()), value <= limit);
    }

    /// What must be so.
    pub(crate) fn holds(&mut self, kind: &'static str, place: impl Fn() -> String, is_so: bool) {
        *self.checks.entry(kind).or_insert(0) += 1;
        if is_so {
            return;
        }
        let told = self.told.entry(kind).or_insert(0);
        *told += 1;
        if *told <= 20 {
            self.disagreements.push(format!("{kind}: {}", place()));
        }
    }

    /// Joins what another found.
    pub fn join(&mut self, other: Self) {
        for (kind, count) in other.checks {
            *self.checks.entry(kind).or_insert(0) += count;
        }
        self.disagreements.extend(other.disagreements);
        self.not_exported.extend(other.not_exported);
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (kind, count) in &self.checks {
            writeln!(f, "{count:8} {kind}")?;
        }
        for line in &self.disagreements {
            writeln!(f, "DISAGREES {line}")?;
        }
        write!(f, "{} disagreements", self.disagreements.len())
    }
}
