//! The batch evaluator: one path point, all grid values of beta, all posture classes.
//!
//! For every state it finds the joint angles in closed form, drops those outside the joint limits or too near to a
//! singularity, and scores the rest. Structure of arrays over beta, no allocation, no branches inside a batch. The same
//! quantities, one state at a time and by way of the Jacobian, come from
//! [`PlacedTask::state`](crate::evaluate::placed_task::PlacedTask::state); the tests hold the two against each other.
//!
//! How it saves work: the rotation of the flange is linear in cos(beta) and sin(beta); everything is written in the
//! frame turned with joint 1, where the arm is a plane mechanism; joint angles are never computed, only their sines and
//! cosines (but where a compliance is given over the angle itself); what the first three joints rule out never reaches
//! the wrist; and all is done in the widest vectors that the processor has ([`stead_numerics::simd`]), to the same bits
//! with each.

mod arm;
mod at;
mod deviation;
mod laws;
mod limit;
mod pose;
mod states;
mod variants;
mod whole;
mod wrist;

pub use at::PlacedPoint;
pub use states::StateGrid;
pub use variants::KernelNumber;

use crate::constraints::{ConstraintKind, relaxed};
use crate::problem::{Placement, Problem, Redundancy};
use deviation::Deviation;
use laws::Laws;
use limit::{Limit, SumLimit};
use nalgebra::{Matrix3, Vector3};
use std::ops::Range as Span;
use stead_model::robot::{Posture, PostureClass, Robot, turns::Range};
use stead_model::task::PathPoint;
use stead_numerics::simd::{Instructions, LaneNumber, LaneRows, Lanes, MAX_LANES, Simd};
use variants::Evaluation;
use whole::{Fixed, FixedParts, Normal, PlacedLoad};

/// A set of compliances.
#[derive(Debug, Clone)]
struct Set {
    laws: Laws,
    deviation: Option<Deviation>,
    normal: Normal,
}

/// What does not change from one placement to the next.
#[derive(Debug, Clone)]
pub struct BatchEvaluator<'a> {
    problem: &'a Problem,
    count: usize,
    cosine: LaneRows,
    sine: LaneRows,
    limits: [Limit; 6],
    /// The range of the sum of joints 2 and 3, where it says more than theirs.
    sum: Option<SumLimit>,
    /// For each set of compliances its laws, what is known of them, and its springs normal to the axes.
    sets: Vec<Set>,
    /// What yields beside the joints, where it does.
    fixed: Option<Fixed>,
    /// Whether the largest score over the sets counts, and not their mean.
    is_over_worst: bool,
    flips: Flips,
    forearm_sin_cos: (f64, f64),
    /// The axes of the flange in the tool frame.
    tool_from_flange: [Vector3<f64>; 3],
    /// Tool centre point from the wrist centre, in the tool frame. m
    lever: Vector3<f64>,
    /// The axes of every path point in the workpiece frame.
    workpiece_from_point: Vec<Matrix3<f64>>,
    instructions: Instructions,
}

/// Which of the two postures of a class are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flips {
    /// Both as one, for arms that yield alike in both ([`Robot::flips_yield_alike`]): the score is that of either.
    Both,
    /// The one with theta_5 not negative.
    Plain,
    /// The one with theta_5 negative.
    Flipped,
}

impl Flips {
    /// What evaluators a problem needs: one for both postures of a class, or one for each.
    pub fn of(problem: &Problem) -> &'static [Self] {
        if problem.scored_robots().iter().all(Robot::flips_yield_alike) {
            &[Self::Both]
        } else {
            &[Self::Plain, Self::Flipped]
        }
    }

    /// Whether a posture is among them.
    pub fn contains(self, posture: Posture) -> bool {
        match self {
            Self::Both => true,
            Self::Plain => !posture.is_flipped(),
            Self::Flipped => posture.is_flipped(),
        }
    }
}

/// A direction or vector of the flange as it turns with beta, in the root frame: `a + b cos(beta) + c sin(beta)`.
#[derive(Debug, Clone, Copy)]
struct Turning<E = f64> {
    a: [E; 3],
    b: [E; 3],
    c: [E; 3],
}

impl Turning {
    /// A vector given in the tool frame, on point axes given as columns in the root frame (Caro 2013, eq. 7 and 10).
    fn new(axes: &Matrix3<f64>, v: &Vector3<f64>) -> Self {
        let (x, y, z) = (axes.column(0), axes.column(1), axes.column(2));
        Self { a: (-z * v.z).into(), b: (x * v.x - y * v.y).into(), c: (x * v.y + y * v.x).into() }
    }

    #[inline(always)]
    fn with<E: LaneNumber>(self) -> Turning<E> {
        Turning { a: self.a.map(E::of), b: self.b.map(E::of), c: self.c.map(E::of) }
    }
}

impl<E: LaneNumber> Turning<E> {
    #[inline(always)]
    fn at<S: Simd<Number = E>>(&self, k: usize, cosine: Lanes<S>, sine: Lanes<S>) -> Lanes<S> {
        cosine.times(self.b[k]) + sine.times(self.c[k]) + cosine.all_of(self.a[k])
    }
}

/// What the kernel takes of a point and of the arm, in its own numbers, made once for all values of beta.
struct Constants<'k, E> {
    tip: [E; 3],
    /// x6, y6, z6 and the lever of [`PointGeometry`].
    flange: [Turning<E>; 4],
    directions: [[E; 3]; 3],
    force: [E; 3],
    moment: [E; 3],
    uncertainty: f64,
    fixed: &'k FixedParts,
    limits: [Limit<E>; 6],
}

impl<'k, E: LaneNumber> Constants<'k, E> {
    #[inline(always)]
    fn new(geometry: &'k PointGeometry, limits: &[Limit; 6]) -> Self {
        let own = |v: &Vector3<f64>| [E::of(v.x), E::of(v.y), E::of(v.z)];
        let PointGeometry { tip, x6, y6, z6, lever, directions, force, moment, uncertainty, fixed, .. } = geometry;
        Self {
            tip: own(tip),
            flange: [x6.with(), y6.with(), z6.with(), lever.with()],
            directions: [own(&directions[0]), own(&directions[1]), own(&directions[2])],
            force: own(force),
            moment: own(moment),
            uncertainty: *uncertainty,
            fixed,
            limits: limits.map(Limit::with),
        }
    }
}

/// One path point at one placement, in the root frame of the arm.
#[derive(Debug, Clone, Copy)]
struct PointGeometry {
    tip: Vector3<f64>,
    x6: Turning,
    y6: Turning,
    z6: Turning,
    lever: Turning,
    /// See [`ScoredDirections`](crate::criterion::ScoredDirections); zero beyond their number.
    directions: [Vector3<f64>; 3],
    force: Vector3<f64>,
    moment: Vector3<f64>,
    /// Size of the force error that scores cover. N
    uncertainty: f64,
    weight: f64,
    /// What base, part and all that is fixed to the tool add, where anything does.
    fixed: FixedParts,
}

impl<'a> BatchEvaluator<'a> {
    /// Prepares the evaluation of a problem on a grid of beta, in one or both postures of each class.
    pub fn new(problem: &'a Problem, grid: &Redundancy, flips: Flips) -> Self {
        let count = grid.beta_count;
        let padded = count.next_multiple_of(MAX_LANES);
        let angle = |k: usize| libm::sincos(grid.beta(k % count));
        let tool_from_flange = problem.spindle.flange_from_tool.inverse().rotation;
        let mut lever = problem.spindle.flange_from_tool.translation;
        lever.z += problem.robot.geometry().flange;
        let limits = std::array::from_fn(|j| Limit::new(Range::of(&problem.robot.joints()[j])));
        Self {
            problem,
            count,
            cosine: LaneRows::new((0..padded).map(|k| angle(k).1)),
            sine: LaneRows::new((0..padded).map(|k| angle(k).0)),
            limits,
            sum: SumLimit::new(&problem.robot),
            sets: problem
                .scored_robots()
                .iter()
                .map(|robot| Set {
                    laws: Laws::new(robot),
                    deviation: Deviation::new(robot, problem.criterion.confidence),
                    normal: Normal::new(robot),
                })
                .collect(),
            fixed: problem.yields_beside().then(|| Fixed::new(problem, &Normal::new(&problem.scored_robots()[0]))),
            is_over_worst: problem.is_over_worst(),
            flips,
            forearm_sin_cos: libm::sincos(problem.robot.geometry().forearm_angle),
            tool_from_flange: std::array::from_fn(|k| tool_from_flange.column(k).into_owned()),
            lever: tool_from_flange * lever,
            workpiece_from_point: problem.task.points().iter().map(PathPoint::workpiece_from_point).collect(),
            instructions: Instructions::best(),
        }
    }

    /// The evaluators that a problem needs ([`Flips::of`]).
    pub fn all(problem: &'a Problem, grid: &Redundancy) -> Vec<Self> {
        Flips::of(problem).iter().map(|flips| Self::new(problem, grid, *flips)).collect()
    }

    /// The one of a posture.
    pub fn of_posture(all: &[Self], posture: Posture) -> Option<&Self> {
        all.iter().find(|evaluator| evaluator.flips.contains(posture))
    }

    /// The constraints in force that it does not evaluate: all that bind neighbouring points, and the cell. Joint
    /// limits are seen joint by joint, in either flip of the wrist; that of the sum of joints 2 and 3 as it is.
    pub fn relaxed(&self) -> Vec<ConstraintKind> {
        use ConstraintKind::{AxesSum, BaseDistance, Conditioning, JointLimit, MaxDeflection, Reach};
        let mut evaluated = vec![Reach, AxesSum, BaseDistance, Conditioning, MaxDeflection];
        evaluated.extend((1..=6).map(JointLimit));
        relaxed(self.problem, &evaluated)
    }

    /// The problem.
    pub fn problem(&self) -> &'a Problem {
        self.problem
    }

    /// Which of the two postures of a class are evaluated.
    pub fn flips(&self) -> Flips {
        self.flips
    }

    /// The same with other instructions of the processor; the results are the same too.
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self { instructions, ..self }
    }

    /// Evaluates path point `point` with the workpiece at a placement into `states`.
    ///
    /// Allowed states get what they add to the cost of a plan ([`Problem::point_cost`]; by default their score, m) and
    /// the sines and cosines of their joint angles (theta_5 not negative), all others an infinite score. A state is
    /// allowed when one of the postures requested is inside the limits of every joint by itself; turns, and limits that
    /// tell two postures apart, are checked by the planner.
    pub fn evaluate<E: KernelNumber>(&self, point: usize, placement: &Placement, states: &mut StateGrid<E>) {
        self.evaluate_some(point, placement, [true; 4], None, states);
    }

    /// The same with states of some posture classes only, by their [`PostureClass::index`], and on request of one
    /// number of beta.
    pub fn evaluate_some<E: KernelNumber>(
        &self,
        point: usize,
        placement: &Placement,
        classes: [bool; 4],
        only_beta: Option<usize>,
        states: &mut StateGrid<E>,
    ) {
        let placed = self.placed(point, placement);
        let betas = only_beta.map_or(0..self.count, |only| only..only + 1);
        self.run(&placed, classes, [&self.sine, &self.cosine].map(E::row), betas, states);
        if let Some(only) = only_beta {
            states.keep_beta(only);
        }
    }

    /// Evaluates the values of beta with these sines and cosines, and their neighbours in the same lanes.
    fn run<E: KernelNumber>(
        &self,
        placed: &PlacedPoint,
        classes: [bool; 4],
        rows: [&[E]; 2],
        betas: Span<usize>,
        states: &mut StateGrid<E>,
    ) {
        let [sine, cosine] = rows;
        for class in PostureClass::ALL {
            states.clear(class);
        }
        if placed.is_near {
            return;
        }
        let evaluation =
            Evaluation { evaluator: self, geometry: &placed.geometry, classes, sine, cosine, betas, states };
        E::evaluate(evaluation, placed.is_plain);
    }

    fn point_geometry(&self, point: usize, placement: &Placement) -> PointGeometry {
        let g = self.problem.robot.geometry();
        let root_from_base = g.base_from_root.transpose();
        let workpiece = self.problem.base_from_workpiece(point, placement);
        let path_point = &self.problem.task.points()[point];
        let wrench = &self.problem.task.loads()[point].wrench;
        let rotation = root_from_base * workpiece.rotation;
        let axes = rotation * self.workpiece_from_point[point];
        let flange_axis = |k: usize| Turning::new(&axes, &self.tool_from_flange[k]);
        let tip = root_from_base * (workpiece.point(&path_point.position) - g.root_in_base);
        let path = self.problem.task.path();
        let scored = if path.leans().is_some() { rotation * path.scored_axes(point) } else { axes };
        let directions = *self.problem.scored_directions(point, &scored).padded();
        let (force, moment) = (rotation * wrench.force, rotation * wrench.moment);
        let fixed = self.fixed.as_ref().map_or_else(FixedParts::default, |fixed| {
            let load = PlacedLoad {
                axes: &axes,
                workpiece: &rotation,
                tip: &tip,
                force: &force,
                moment: &moment,
                directions: &directions,
            };
            fixed.parts(self.is_plain(point), self.problem.task.part_compliance(point), &load)
        });
        PointGeometry {
            tip,
            x6: flange_axis(0),
            y6: flange_axis(1),
            z6: flange_axis(2),
            lever: Turning::new(&axes, &self.lever),
            directions,
            force,
            moment,
            uncertainty: self.problem.criterion.force_uncertainty * wrench.force.norm(),
            weight: self.problem.point_weight(point),
            fixed,
        }
    }

    /// Whether there is one set of compliances, and the score of a point covers no errors.
    fn is_plain(&self, point: usize) -> bool {
        let uncertainty =
            self.problem.criterion.force_uncertainty * self.problem.task.loads()[point].wrench.force.norm();
        uncertainty == 0.0 && matches!(self.sets[..], [Set { deviation: None, .. }])
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod whole_tests;
