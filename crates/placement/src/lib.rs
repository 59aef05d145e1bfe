//! The main job: where to put the workpiece.
//!
//! - [`problem`]: what may vary, what must hold; [`setup`]: which way up the part lies, where external axes stand; [`settings`]: how hard to search.
//! - [`evaluate`]: the score of a state of the arm, one at a time with derivatives, or a batch of states at once.
//! - [`criterion`]: which part of the deflection is scored, and how points make up one figure; [`objective`]: that of a problem.
//! - [`constraints`]: what a plan must satisfy, by kind, with signed margins; [`limit`]: which limits can hold an optimum.
//! - [`redundancy`]: the free angle beta along the path, the posture of each segment, and the turns of the joints.
//! - [`lookup`]: scores of upright tools sampled once over the cell; [`evaluator`]: the objective of a placement, by table or
//!   planner.
//! - [`candidate`]: a placement with its objective value; [`search`]: the global search; [`refine`]: gradients from its basins to the optimum.
//! - [`sensitivity`]: how a result answers to the stiffness of the joints and to errors of the force.
//! - [`joint_travel`]: how much the joints turn within the cut; [`feed`]: the feed that the arm holds; [`transfer`]: times of the moves between segments; [`feasibility`]: why something is not
//!   allowed.
//! - [`place`]: the job as a whole; [`outcome`]: what it returns; [`sense`]: minimise or maximise.
//!
//! Where the paper (Caro et al. 2013) leaves a choice or has a misprint, this room does as follows. Eq. 8 is a plain
//! rotation about z. The compliance is `J K_theta^-1 J^T` without a complementary term. kappa_F carries the factor 1/6 that
//! makes the published bound of 0.2 possible. The posture scheme of a placement is found exactly, since continuity binds
//! only inside a segment. The "worst placement" is the one with the largest mean deflection under its best plan.

mod beta_step;
pub mod candidate;
pub mod cell;
pub mod certify;
pub mod collision;
pub mod constraints;
pub mod coordinate_search;
pub mod course;
pub mod criterion;
pub mod evaluate;
pub mod evaluator;
pub mod feasibility;
pub mod feed;
pub mod joint_travel;
pub mod limit;
pub mod lookup;
pub mod objective;
pub mod outcome;
pub mod overview;
pub mod path_comparison;
pub mod path_subset;
pub mod place;
pub mod postures;
pub mod problem;
pub mod redundancy;
pub mod refine;
pub mod search;
mod segment_plan;
pub mod sense;
pub mod sensitivity;
pub mod settings;
pub mod setup;
mod straight_move;
pub mod symmetry;
pub mod tool_scene;
pub mod transfer;
pub mod way;
mod whole_path;

#[cfg(any(test, feature = "testing"))]
pub mod testing {
    //! The problem of Caro 2013 for the tests of this crate and of those above.
    #![allow(clippy::unwrap_used)]
    use super::criterion::Criterion;
    use super::postures::PostureRules;
    use super::problem::*;
    use super::setup::Setup;
    use super::tool_scene::SegmentMoves;
    use nalgebra::{DMatrix, Vector3};
    use std::f64::consts::PI;
    use stead_model::robot::testing::{kr270, spindle};
    use stead_model::robot::{Compensator, Compliance, Parameter, Robot, Uncertainty};
    use stead_model::task::{PathPoint, Task, ToolPath, Wrench};

    /// The five-segment task in the paper's cell, with no joint speeds.
    pub fn five_segments() -> Problem {
        let interval = |min, max| Interval { min, max };
        Problem {
            robot: kr270(),
            spindle: spindle(),
            task: stead_model::task::testing::five_segments(),
            cell: Cell {
                position: [interval(-0.3, 0.3), interval(-2.24, -1.64), interval(-0.602, -0.214)],
                yaw: interval(-PI, PI),
            },
            constraints: Constraints {
                min_inverse_condition: 0.2,
                characteristic_length: 0.682,
                ..Constraints::default()
            },
            criterion: Criterion::default(),
            redundancy: Redundancy {
                beta_count: 120,
                feed: 0.066667,
                max_beta_rate: Some(0.9_f64.to_radians() * 1e3),
                max_spindle_turn: None,
                max_spindle_speed: None,
                beta: BetaPlan::Free,
            },
            postures: PostureRules::NONE,
            scene: None,
            segment_moves: SegmentMoves::default(),
            orientations: [].into(),
            external_axes: Vec::new(),
            setup: Setup::default(),
        }
    }

    /// The same problem with so many times the rate of beta.
    pub fn with_beta_rate(mut problem: Problem, times: f64) -> Problem {
        problem.redundancy.max_beta_rate = problem.redundancy.max_beta_rate.map(|rate| rate * times);
        problem
    }

    /// The five segments with forces in every direction.
    pub fn slanted() -> Problem {
        let mut problem = five_segments();
        let force = |point: usize| {
            let (sine, cosine) = libm::sincos(point as f64);
            Vector3::new(90.0 * sine, 40.0 * cosine, 60.0 * libm::sin(0.3 * point as f64))
        };
        let wrenches = (0..105).map(|point| Wrench { force: force(point), moment: Vector3::zeros() }).collect();
        problem.task = Task::new(problem.task.path().clone(), wrenches).unwrap();
        problem
    }

    /// The five segments on a workpiece that hangs, the tool from below: the other sense of the heading.
    pub fn hanging() -> Problem {
        let mut problem = five_segments();
        let turned = |v: Vector3<f64>| Vector3::new(v.x, -v.y, -v.z);
        let path = problem.task.path();
        let points = path.points().iter().enumerate().map(|(k, point)| {
            let point =
                PathPoint { position: turned(point.position), feed: turned(point.feed), axis: turned(point.axis) };
            (path.segment_of(k) as u32 + 1, point)
        });
        let turned_path = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
        let wrenches = problem.task.wrenches().iter().map(|w| Wrench { force: turned(w.force), ..*w }).collect();
        problem.cell.position[2] = Interval { min: 1.0, max: 1.4 };
        problem.task = Task::new(turned_path, wrenches).unwrap();
        problem
    }

    /// The same problem with other laws of compliance at some joints (from 0).
    pub fn with_laws(mut problem: Problem, laws: &[(usize, Compliance)]) -> Problem {
        let mut joints = problem.robot.joints().clone();
        for (joint, law) in laws {
            joints[*joint].compliance = *law;
        }
        problem.robot = Robot::new("laws", joints).unwrap();
        problem
    }

    /// The same problem with every parameter of the robot's laws known to about `share` of its value, in correlated errors.
    pub fn with_uncertainty(mut problem: Problem, share: f64) -> Problem {
        let mut values = Vec::new();
        for (j, joint) in problem.robot.joints().iter().enumerate() {
            match joint.compliance {
                Compliance::Constant(value) => values.push((Parameter::Compliance(j), value)),
                Compliance::Range { at_min, at_max } => {
                    values.extend([(Parameter::ComplianceAtMin(j), at_min), (Parameter::ComplianceAtMax(j), at_max)]);
                }
                Compliance::Compensated { alone, compensator } => values.extend([
                    (Parameter::Compliance(j), alone),
                    (Parameter::SpringStiffness(j), compensator.spring_stiffness),
                    (Parameter::FreeLength(j), compensator.free_length),
                ]),
            }
        }
        let (parameters, values): (Vec<_>, Vec<f64>) = values.into_iter().unzip();
        let count = values.len();
        // Rows of unit size that point in different directions.
        let factor = DMatrix::from_fn(count, count, |k, r| libm::sin((7 * k + 3 * r + k * r) as f64));
        let factor = DMatrix::from_fn(count, count, |k, r| share * values[k] * factor[(k, r)] / factor.row(k).norm());
        let uncertainty = Uncertainty::new(parameters, &factor * factor.transpose()).unwrap();
        problem.robot = problem.robot.with_uncertainty(uncertainty).unwrap();
        problem
    }

    /// A joint beside a compensator of the size of a KR270's, strong enough to be seen; `alpha` in rad, `alone` in
    /// rad/(N m).
    pub fn compensated(alpha: f64, alone: f64) -> Compliance {
        let compensator = Compensator { spring_stiffness: 3e6, a: 0.7, l: 0.18, alpha, free_length: 0.46 };
        Compliance::Compensated { alone, compensator }
    }

    /// The five-segment task with a compensator at joint 2.
    pub fn five_segments_compensated() -> Problem {
        with_laws(five_segments(), &[(1, compensated(0.2, 1e-6 / 3.32))])
    }
}
