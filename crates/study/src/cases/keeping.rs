//! Who writes the results of a study where readers look for them.

use super::plan::PlannedCase;
use crate::run::Placed;
use stead_certify::Certificate;
use stead_runs::Run;

/// Puts results where readers look for them: the files of a case into a folder of its own, the table into that of the
/// study.
pub trait Keeping: Sync {
    /// Writes files of the study as one set that a manifest vouches for. They take the place of those of an earlier
    /// table, and what was derived from another table goes.
    ///
    /// # Errors
    /// What is wrong, as one line.
    fn publish(&self, files: &[(&str, Vec<u8>)]) -> Result<(), String>;

    /// Whether they are there already.
    fn is_kept(&self, case: &PlannedCase) -> bool;

    /// Writes them.
    ///
    /// # Errors
    /// What is wrong, as one line.
    fn keep(
        &self,
        case: &PlannedCase,
        run: &Run,
        placed: Placed,
        certificate: Option<Certificate>,
    ) -> Result<(), String>;
}
