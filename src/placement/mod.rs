//! The main job: where to put the workpiece.
//!
//! - [`problem`]: what may vary, what must hold; [`settings`]: how hard to search.
//! - [`criterion`]: the score of one state, the ordinary evaluator; [`kernel`]: the same for a whole batch of states.
//! - [`redundancy`]: the free angle beta along the path, the posture of each segment, and the turns of the joints.
//! - [`genetic`]: the global search; [`refine`]: gradients from its basins to the optimum.
//! - [`transfer`]: times of the moves between segments; [`feasibility`]: why something is not allowed.
//! - [`place`]: the job as a whole; [`outcome`]: what it returns; [`control`]: progress out, a wish to stop in.
//!
//! Where the paper (Caro et al. 2013) leaves a choice or has a misprint, this room does as follows. Eq. 8 is a plain
//! rotation about z. The compliance is `J K_theta^-1 J^T` without a complementary term. kappa_F carries the factor 1/6 that
//! makes the published bound of 0.2 possible. The posture scheme of a placement is found exactly, since continuity binds
//! only inside a segment. The "worst placement" is the one with the largest mean deflection under its best plan.

pub mod control;
pub mod criterion;
pub mod feasibility;
pub mod genetic;
pub mod kernel;
pub mod outcome;
pub mod place;
pub mod problem;
pub mod redundancy;
pub mod refine;
pub mod settings;
pub mod transfer;

#[cfg(test)]
pub(crate) mod testing {
    //! The problem of Caro 2013 for the tests of this room.
    use super::problem::*;
    use crate::robot::testing::{kr270, spindle};
    use crate::robot::{Compensator, Compliance, Robot};
    use crate::task::{Task, read_csv};
    use std::f64::consts::PI;
    use std::path::Path;

    /// The five-segment task in the paper's cell, with no joint speeds.
    pub fn five_segments() -> Problem {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tasks/five-segments.csv"));
        let imported = read_csv(file).unwrap();
        let interval = |min, max| Interval { min, max };
        Problem {
            robot: kr270(),
            spindle: spindle(),
            task: Task::new(imported.path, imported.wrenches.unwrap()).unwrap(),
            cell: Cell {
                position: [interval(-0.3, 0.3), interval(-2.24, -1.64), interval(-0.602, -0.214)],
                yaw: interval(-PI, PI),
            },
            constraints: Constraints { min_inverse_condition: 0.2, characteristic_length: 0.682, max_deflection: None },
            criterion: Criterion::default(),
            redundancy: Redundancy { beta_count: 120, feed: 0.066667, max_beta_rate: 0.9_f64.to_radians() * 1e3 },
        }
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
