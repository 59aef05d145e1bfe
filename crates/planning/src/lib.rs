//! What is planned at a placement: the free angle beta, postures and turns along the path, under all constraints, and
//! what it scores.
//!
//! - [`problem`]: what may vary, what must hold; [`setup`]: which way up the part lies, where external axes stand.
//! - [`evaluate`]: the score of a state of the arm, one at a time with derivatives, or a batch of states at once.
//! - [`criterion`]: which part of the deflection is scored, and how points make up one figure; [`objective`]: that of a
//!   problem.
//! - [`constraints`]: what a plan must satisfy, by kind, with signed margins; [`limit`]: which limits can hold an
//!   optimum.
//! - [`redundancy`]: the free angle beta along the path, the posture of each segment, and the turns of the joints.
//! - [`candidate`]: a placement with its objective value; [`sense`]: minimise or maximise; [`symmetry`]: upright tools.
//! - [`compass`]: searches by ever smaller steps; [`collision`]: shapes along a plan; [`transfer_path`]: collision-free
//!   moves between segments; [`course`]: the moves of a program in time.
//! - [`joint_travel`]: how much the joints turn within the cut; [`feed`]: the feed that the arm holds; [`transfer`]:
//!   times of the moves between segments; [`feasibility`]: why something is not allowed.
//!
//! Where the paper (Caro et al. 2013) leaves a choice or has a misprint, it is done as follows. Eq. 8 is a plain
//! rotation about z. The compliance is `J K_theta^-1 J^T` without a complementary term. kappa_F carries the factor 1/6
//! that makes the published bound of 0.2 possible. The posture scheme of a placement is found exactly, since continuity
//! binds only inside a segment.
//!
//! ```
//! use stead_model::robot::testing::{kr270, spindle};
//! use stead_model::task::testing::five_segments;
//! use stead_planning::problem::{Cell, Constraints, Interval, Placement, Problem, Redundancy};
//! use stead_planning::redundancy::Planner;
//! use stead_planning::sense::Sense;
//! // The published arm, spindle and path; beta in steps of 3 deg, at 4 m/min, by no more than 0.9 deg/mm.
//! let range = |min, max| Interval { min, max };
//! let cell = Cell { position: [range(-0.3, 0.3), range(-2.24, -1.64), range(-0.602, -0.214)], yaw: range(-3.1, 3.1) };
//! let redundancy = Redundancy { max_beta_rate: Some(900_f64.to_radians()), ..Redundancy::new(120, 4.0 / 60.0) };
//! let mut parts = Problem::builder(kr270(), spindle(), five_segments(), cell, redundancy);
//! parts.constraints = Constraints { min_inverse_condition: 0.2, characteristic_length: 0.682, ..Default::default() };
//! let problem = parts.build()?;
//! // The best plan at the placement that is published as the best of results/caro-2013: 0.1075 mm in the mean.
//! let planner = Planner::finer(&problem);
//! let placement = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
//! let plans = planner.plan(&placement, Sense::Min, None, &mut planner.workspace()).unwrap();
//! let mean = problem.objective(plans.iter().map(|segment| segment.cost));
//! assert!(plans.len() == 5 && (mean - 0.1075e-3).abs() < 1e-6, "{mean}");
//! # Ok::<(), stead_planning::problem::ProblemError>(())
//! ```

pub mod beta_step;
pub mod candidate;
pub mod cell;
pub mod collision;
pub mod compass;
pub mod constraints;
pub mod course;
pub mod criterion;
pub mod evaluate;
pub mod feasibility;
pub mod feed;
pub mod joint_travel;
pub mod lean;
pub mod limit;
pub mod objective;
pub mod postures;
pub mod problem;
pub mod redundancy;
mod segment_plan;
pub mod sense;
pub mod setup;
mod straight_move;
pub mod symmetry;
pub mod transfer;
pub mod transfer_path;

#[cfg(any(test, feature = "testing"))]
pub mod testing;
