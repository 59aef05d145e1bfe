//! Plans and cases: what is stated of a placement.

use crate::sag::Sag;
use nalgebra::Vector3;
use serde::Serialize;
use stead_cell::Clearance;
use stead_model::robot::{Posture, PostureWords, Spring};
use stead_model::task::lean::Lean;
use stead_numerics::mean_max::MeanAndMax;
use stead_planning::transfer::Cycle;
use stead_problem::collision::PlanClearance;
use stead_problem::criterion::CANCELLATION;
use stead_problem::evaluate::reference::ScoredByOrigin;
use stead_problem::joint_travel::JointTravel;
use stead_problem::limit::ActiveBound;
use stead_problem::problem::Placement;
use stead_problem::sense::{BySense, Sense};
use stead_problem::setup::{AxisPath, Setup};

/// One path point of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanPoint {
    /// Index of the path point, from 0.
    pub point: usize,
    /// Number of its segment, from 1.
    pub segment: usize,
    /// Tool centre point in the robot base frame. m
    pub position: Vector3<f64>,
    /// Free angle about the tool axis, in (-pi, pi]. rad
    pub beta: f64,
    /// Posture, the same all along a segment.
    pub posture: Posture,
    /// The same in words.
    pub posture_words: PostureWords,
    /// Real joint angles, inside the limits, turns included. rad
    pub joints: [f64; 6],
    /// 1/kappa_F.
    pub inverse_condition: f64,
    /// Force on the tool in the robot base frame. N
    pub force: Vector3<f64>,
    /// Deflection of the tool centre point in the robot base frame. m
    pub deflection: Vector3<f64>,
    /// Part of the deflection along the feed. m
    pub feed_part: f64,
    /// Part to the left of the feed, with its sign; its absolute value is c_i. m
    pub normal_part: f64,
    /// Part along the tool axis, positive towards the robot. m
    pub axial_part: f64,
    /// Part along the normal of the surface, where the task states that. m
    pub surface_part: Option<f64>,
    /// The score: the size of the scored part, what force errors can add to it, and what is added for its deviation. m
    pub score: f64,
    /// Standard deviation of the scored part, where the robot's uncertainty is known. m
    pub deviation: Option<f64>,
    /// What each thing that yields adds to the scored part, where more does than the joints about their axes.
    pub by_origin: Option<ScoredByOrigin>,
    /// The pair of shapes with the least room; `None` without a scene, and where nothing is near.
    pub clearance: Option<Clearance>,
    /// How the tool leans from the axis of the path, where it does along this plan.
    pub lean: Option<Lean>,
}

/// How large the deflection is along a path, in each direction and altogether.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DeflectionFigures {
    /// Normal to the wall, axis x feed. m
    pub wall: MeanAndMax,
    /// Normal to the surface, where the task states that. m
    pub surface: Option<MeanAndMax>,
    /// Along the feed. m
    pub feed: MeanAndMax,
    /// Along the tool axis. m
    pub axis: MeanAndMax,
    /// The size of the whole. m
    pub total: MeanAndMax,
}

impl DeflectionFigures {
    /// Those of the points of a plan that are scored.
    pub fn of<'a>(points: impl Iterator<Item = &'a PlanPoint> + Clone) -> Self {
        let figures = |of: &dyn Fn(&PlanPoint) -> f64| MeanAndMax::of(points.clone().map(|point| of(point).abs()));
        let surface: Option<Vec<f64>> = points.clone().map(|point| point.surface_part.map(f64::abs)).collect();
        Self {
            wall: figures(&|point| point.normal_part),
            surface: surface.map(MeanAndMax::of),
            feed: figures(&|point| point.feed_part),
            axis: figures(&|point| point.axial_part),
            total: figures(&|point| point.deflection.norm()),
        }
    }
}

/// A plan at the feed that the arm holds, with the forces of that feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtHeldFeed {
    /// Number of segments that are cut slower than programmed.
    pub slowed: usize,
    /// Mean of the scores. m
    pub mean: f64,
    /// Largest score. m
    pub max: f64,
    /// The deflection itself.
    pub deflection: DeflectionFigures,
}

/// A redundancy plan with its posture scheme, for one placement.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// All path points.
    pub points: Vec<PlanPoint>,
    /// Where the external axes stand at every point; empty where there are none.
    pub axes: Vec<AxisPath>,
    /// Posture of each segment.
    pub postures: Vec<Posture>,
    /// The same in words.
    pub posture_words: Vec<PostureWords>,
    /// The figure that is minimised ([`Problem::objective`](stead_problem::problem::Problem::objective)), with what
    /// joint travel counts in it; by default the mean. m
    pub objective: f64,
    /// Mean of the scores: f_MQC (Caro 2013, eq. 13). m
    pub mean: f64,
    /// Largest score. m
    pub max: f64,
    /// How much the joints turn within the cut.
    pub travel: JointTravel,
    /// The scores that half of the points, and 95 of 100, do not exceed. m
    pub percentiles: [f64; 2],
    /// The deflection itself.
    pub deflection: DeflectionFigures,
    /// The same figures at the feed that the arm holds, where it is known how the forces change with the feed: the
    /// others are those of the programmed one.
    pub held: Option<AtHeldFeed>,
    /// Standard deviation of the mean of the scored part, where the robot's uncertainty is known: the points err
    /// together, so that it does not shrink with their number. m
    pub mean_deviation: Option<f64>,
    /// What each thing that yields adds to the scored part, in the mean, where more does than the joints about their
    /// axes.
    pub by_origin: Option<ScoredByOrigin>,
    /// How far the weight of links and spindle moves the tool, which no score counts; where the mass of what the flange
    /// carries is known.
    pub sag: Option<Sag>,
    /// The point with the least room, and its pair; `None` without a scene, and where nothing is near.
    pub clearance: Option<PlanClearance>,
}

/// A placement with one of its plans.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Whether the placement is the best or the worst.
    pub placement_sense: Sense,
    /// Whether the plan is the best or the worst at this placement.
    pub plan_sense: Sense,
    /// The placement.
    pub placement: Placement,
    /// How part and external axes are set up for it.
    pub setup: Setup,
    /// The name of the orientation of the part, where the run says several.
    pub orientation: Option<String>,
    /// The plan.
    pub plan: Plan,
    /// Times of the moves between segments and of the whole cut.
    pub cycle: Cycle,
    /// The bounds that hold the placement, the largest gain first; of cases 1 and 3, which are optima; none where
    /// they are not known.
    pub active_bounds: Option<Vec<ActiveBound>>,
    /// How the objective answers to the stiffness of each spring ([`objective_by_stiffness`]); none where it was not
    /// requested.
    ///
    /// [`objective_by_stiffness`]: super::sensitivity::objective_by_stiffness
    pub objective_by_stiffness: Option<Vec<SpringSlope>>,
}

impl Case {
    /// Its number in Caro 2013, Table III: 1 best placement, best plan; 2 best placement, worst plan; 3 worst
    /// placement, best plan; 4 worst placement, worst plan.
    pub fn number(&self) -> u8 {
        let second = |sense: Sense| u8::from(sense == Sense::Max);
        1 + 2 * second(self.placement_sense) + second(self.plan_sense)
    }
}

/// The four cases of Caro 2013, Table III, or the first two of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Cases {
    /// Best placement, best plan.
    pub best: Case,
    /// Best placement, worst plan.
    pub best_worst_plan: Case,
    /// Worst placement with its best and its worst plan; `None` where it was not looked for
    /// ([`SearchSettings::worst`](stead_problem::settings::SearchSettings::worst)).
    pub worst: Option<BySense<Case>>,
}

impl Cases {
    /// All there are, in the order of their numbers.
    pub fn all(&self) -> Vec<&Case> {
        let worst = self.worst.iter().flat_map(BySense::values);
        [&self.best, &self.best_worst_plan].into_iter().chain(worst).collect()
    }

    /// The placements, each with its best plan: the best one, and the worst where it was looked for.
    pub fn optima(&self) -> Vec<&Case> {
        self.all().into_iter().step_by(2).collect()
    }

    /// Mean score of a case over that of the first; `None` where the first is a cancellation.
    pub fn ratio(&self, case: &Case) -> Option<f64> {
        (self.best.plan.mean > CANCELLATION).then(|| case.plan.mean / self.best.plan.mean)
    }
}

/// How an objective answers to the stiffness of a spring, or of several that turn the tool about one line in every
/// configuration, so that no deflection tells them apart.
#[derive(Debug, Clone, PartialEq)]
pub struct SpringSlope {
    /// The spring, and those that cannot be told from it.
    pub springs: Vec<Spring>,
    /// Derivative of the objective by the logarithm of the stiffness. m
    pub slope: f64,
}
