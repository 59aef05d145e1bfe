//! What is planned at a placement: the free angle beta, postures and turns along the path, under all constraints, and
//! what it scores.
//!
//! - [`redundancy`]: the free angle beta along the path, the posture of each segment, and the turns of the joints.
//! - [`compass`]: searches by ever smaller steps; [`transfer_path`]: collision-free moves between segments; [`course`]:
//!   the moves of a program in time; [`feed`]: the feed that the arm holds; [`transfer`]: times of the moves between
//!   segments; [`feasibility`]: why something is not allowed.
//!
//! Problems, their scores and constraints are in `stead-problem`. The posture scheme of a placement is found exactly,
//! where Caro et al. 2013 search for it, since continuity binds only inside a segment.
//!
//! ```
//! use stead_model::robot::testing::{kr270, spindle};
//! use stead_model::task::testing::five_segments;
//! use stead_problem::problem::{Cell, Constraints, Interval, Placement, Problem, Redundancy};
//! use stead_planning::redundancy::Planner;
//! use stead_problem::sense::Sense;
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
//! # Ok::<(), stead_problem::problem::ProblemError>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod compass;
pub mod course;
pub mod feasibility;
pub mod feed;
pub mod redundancy;
pub mod transfer;
pub mod transfer_path;
