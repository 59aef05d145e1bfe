//! A candidate of the search: a placement, perhaps with a posture scheme, and its objective value.

use super::sense::Sense;
use crate::problem::Placement;
use std::cmp::Ordering;
use stead_model::robot::Posture;

/// The objective value of a placement: the mean score under its best (or worst) plan on the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// The mean score under the plan requested. m
    Feasible(f64),
    /// Nothing to plan: number of path points that no posture allows, and of segments that no one posture gets through.
    Infeasible {
        /// Path points without an allowed state.
        points: usize,
        /// Segments without a plan; not counted when there are such points.
        segments: usize,
    },
}

impl Objective {
    /// The mean score, where there is one. m
    pub fn mean(self) -> Option<f64> {
        match self {
            Objective::Feasible(mean) => Some(mean),
            Objective::Infeasible { .. } => None,
        }
    }
}

/// One candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// x, y, z (m) and yaw (rad).
    pub placement: Placement,
    /// One posture per segment, in the genetic mode.
    pub scheme: Option<Vec<Posture>>,
    /// What it is worth under its best plan.
    pub objective: Objective,
}

/// The better one of several objectives of a placement.
pub fn best_of(sense: Sense, objectives: impl Iterator<Item = Objective>) -> Objective {
    let nothing = Objective::Infeasible { points: usize::MAX, segments: usize::MAX };
    objectives.fold(nothing, |best, next| if rank(sense, next, best).is_lt() { next } else { best })
}

/// Order of two candidates, better first.
pub fn rank(sense: Sense, a: Objective, b: Objective) -> Ordering {
    match (a, b) {
        (Objective::Feasible(a), Objective::Feasible(b)) => sense.compare(a, b),
        (Objective::Feasible(_), Objective::Infeasible { .. }) => Ordering::Less,
        (Objective::Infeasible { .. }, Objective::Feasible(_)) => Ordering::Greater,
        (Objective::Infeasible { points: p, segments: s }, Objective::Infeasible { points: q, segments: t }) => {
            (p, s).cmp(&(q, t))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feasible_ranks_before_infeasible() {
        let (a, b) = (Objective::Feasible(1.0), Objective::Feasible(2.0));
        let (c, d) =
            (Objective::Infeasible { points: 1, segments: 5 }, Objective::Infeasible { points: 2, segments: 0 });
        assert_eq!(rank(Sense::Min, a, b), Ordering::Less);
        assert_eq!(rank(Sense::Max, a, b), Ordering::Greater);
        assert_eq!(rank(Sense::Max, a, c), Ordering::Less);
        assert_eq!(rank(Sense::Min, d, c), Ordering::Greater);
    }
}
