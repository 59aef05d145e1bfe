//! The certificate that `stead place` adds where it is asked for.

use super::progress::Terminal;
use super::{Failure, on_threads, say};
use stead_format::Run;
use stead_placement::certify::{Certificate, certifiable, certify, no_certificate};
use stead_placement::outcome::Cases;
use stead_placement::settings::CertificateSettings;

/// Says before any work is done why a run cannot be certified, where that is so.
pub(super) fn warn_unsupported(run: &Run) {
    if run.certificate.is_some()
        && let Err(reason) = certifiable(&run.problem)
    {
        say(&format!("warning: {}", no_certificate(&reason)));
    }
}

/// Bounds how far the placements found are from the best and the worst there are, and says where that falls short of what was
/// asked for.
pub(super) fn certified(
    run: &Run,
    settings: CertificateSettings,
    Cases { best, worst, .. }: &Cases,
    threads: Option<usize>,
    terminal: &Terminal,
) -> Result<Certificate, Failure> {
    let shown = terminal.show(None);
    let found = (&best.placement, best.plan.mean);
    let (certificate, _) =
        on_threads(threads, || certify(&run.problem, found, &worst.placement, settings, &shown.monitor))?;
    drop(shown);
    // What cannot be certified was said before.
    if certifiable(&run.problem).is_ok() {
        certificate.warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    }
    Ok(certificate)
}
