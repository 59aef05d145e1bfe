//! Plans in one posture all along, where the run does not allow it to change.

use super::{NoFeasiblePlan, Planner, SegmentPlan, joint_turns};
use stead_model::robot::Posture;
use stead_problem::sense::Sense;

impl Planner<'_> {
    /// What `plan` finds for a scheme, or where the posture may not change, the best of what it finds for each posture:
    /// of those within the tie the one with the shortest moves.
    pub(super) fn unchanging(
        &self,
        scheme: Option<&[Posture]>,
        sense: Sense,
        mut plan: impl FnMut(Option<&[Posture]>) -> Result<Vec<SegmentPlan>, NoFeasiblePlan>,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        let schemes = self.problem.unchanging_schemes(scheme);
        if schemes.is_empty() {
            return plan(scheme);
        }
        let (mut found, mut failure): (Vec<Vec<SegmentPlan>>, Option<NoFeasiblePlan>) = (Vec::new(), None);
        for scheme in &schemes {
            match plan(Some(scheme)) {
                Ok(plans) => found.push(plans),
                Err(none) => {
                    let size = |none: &NoFeasiblePlan| (none.blocked_points.len(), none.broken_segments.len());
                    failure = Some(match failure {
                        Some(known) if size(&known) <= size(&none) => known,
                        _ => none,
                    });
                }
            }
        }
        joint_turns::best_of(self.problem, sense, found).ok_or_else(|| failure.unwrap_or_else(NoFeasiblePlan::empty))
    }
}
