//! The certificate that `stead place` adds where it is asked for.

use super::progress::Terminal;
use super::{Failure, on_threads, say};
use std::time::{Duration, Instant};
use stead_format::Run;
use stead_numerics::monitor::{Monitor, Stop};
use stead_placement::certify::{self, Bound, End, Unfit};
use stead_placement::outcome::{CANCELLATION, Case, Cases, Outcome};
use stead_placement::sense::Sense;
use stead_placement::settings::CertificateSettings;
use stead_report::certificate::{Certificate, Ended, Proof, ending};

/// What goes into every bound.
struct Job<'a> {
    run: &'a Run,
    settings: CertificateSettings,
    threads: Option<usize>,
    terminal: &'a Terminal,
    deadline: Option<Instant>,
}

/// Says before any work is done why a run cannot be certified, where that is so.
pub(super) fn warn_unfit(run: &Run) {
    if run.certificate.is_some()
        && let Err(unfit) = certify::certifiable(&run.problem)
    {
        say(&format!("warning: no certificate: {unfit}; the workpiece is placed without one"));
    }
}

/// Bounds how far the placements found are from the best and the worst there are, and says where that falls short of what was
/// asked for.
pub(super) fn certified(
    run: &Run,
    settings: CertificateSettings,
    outcome: &Outcome,
    threads: Option<usize>,
    terminal: &Terminal,
) -> Result<Certificate, Failure> {
    let started = Instant::now();
    // A limit beyond what a clock holds is none.
    let limit = settings.time_limit.and_then(|limit| Duration::try_from_secs_f64(limit).ok());
    let deadline = limit.and_then(|limit| started.checked_add(limit));
    let job = Job { run, settings, threads, terminal, deadline };
    let Cases { best, worst, .. } = &outcome.cases;
    let (best, worst) = match certify::certifiable(&run.problem) {
        Err(unfit) => (Err(unfit.to_string()), Err(unfit.to_string())),
        Ok(()) => (job.best(best)?, job.worst(worst)?),
    };
    let inputs = run.inputs.clone();
    let certificate = Certificate { settings, best, worst, inputs, wall: started.elapsed().as_secs_f64() };
    for proof in [&certificate.best, &certificate.worst].into_iter().flatten() {
        ending(&certificate, proof).iter().for_each(|short| say(short));
    }
    Ok(certificate)
}

impl Job<'_> {
    /// A lower bound of all placements, with the rate of beta.
    fn best(&self, case: &Case) -> Result<Result<Proof, String>, Failure> {
        let (problem, value) = (&self.run.problem, case.plan.mean);
        self.proof(Sense::Min, case, value, |monitor| certify::best(problem, value, self.settings.gap, true, monitor))
    }

    /// An upper bound of all placements, with the rate of beta dropped.
    fn worst(&self, case: &Case) -> Result<Result<Proof, String>, Failure> {
        let problem = &self.run.problem;
        let Some(value) = certify::relaxed_value(problem, &case.placement) else {
            return Ok(Err("the worst placement has no value with these limits relaxed".to_owned()));
        };
        self.proof(Sense::Max, case, value, |monitor| certify::worst(problem, value, self.settings.gap, monitor))
    }

    /// Runs a search for a bound on the threads asked for.
    fn proof(
        &self,
        sense: Sense,
        case: &Case,
        value: f64,
        search: impl FnOnce(&Monitor) -> Result<Bound, Unfit> + Send,
    ) -> Result<Result<Proof, String>, Failure> {
        let shown = self.terminal.show(self.deadline);
        match shown.monitor.stop() {
            Some(Stop::Asked) => return Ok(Err("interrupted before it began".to_owned())),
            Some(Stop::Deadline) => return Ok(Err("the time limit was over before it began".to_owned())),
            None => {}
        }
        if value <= CANCELLATION {
            return Ok(Err(
                "the plan balances the deflection to nothing, which no bound can be compared with".to_owned()
            ));
        }
        let (bound, _) = on_threads(self.threads, || search(&shown.monitor))?;
        let proof = bound.map_err(|unfit| unfit.to_string()).map(|bound| {
            let end = match bound.end {
                End::Reached => Ended::Reached,
                End::Exhausted => Ended::Exhausted,
                End::Stopped(Stop::Asked) => Ended::Interrupted,
                End::Stopped(Stop::Deadline) => Ended::TimeLimit,
            };
            Proof::new(&self.run.problem, sense, case.placement, bound, end)
        });
        Ok(proof)
    }
}
