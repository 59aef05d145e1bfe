//! The symmetry of upright tools: with axis 1 vertical and the tool along it, turning workpiece and joint 1 together
//! about axis 1 changes nothing but theta_1.
//!
//! So a placement is three numbers (radius and height of the workpiece origin, yaw less its azimuth), and a state four:
//! radius and height of the tool centre point, heading of the spindle against its azimuth, and posture class. The
//! lookup table (`stead_placement::lookup`) and the certificate (`stead_certify`) rest on this.

use super::criterion::{Aggregate, Criterion, Weights};
use super::problem::{BetaPlan, Placement, Problem};
use nalgebra::Vector3;
use stead_model::robot::{Compliance, Robot, angles::wrap};

/// Why a problem cannot be treated by means of the symmetry.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unsupported {
    /// Axis 1 is not vertical, so that states depend on the azimuth.
    #[error("axis 1 of the robot leans {:.3} deg from the vertical", angle.to_degrees())]
    BaseNotVertical {
        /// Angle between axis 1 and the vertical of the base frame. rad
        angle: f64,
    },
    /// There are external axes.
    #[error("external axes move the workpiece or the robot")]
    ExternalAxes,
    /// External axes do more than shift the cell and turn it about the vertical.
    #[error(
        "external axes other than rails, and turntables about the vertical, that stay at one place for the path or for \
         each segment"
    )]
    OtherAxes,
    /// There are several orientations of the part to choose from.
    #[error("the part may lie in several orientations (cell.orientations): name one with cell.orientation")]
    Orientations,
    /// One of the orientations of the part to choose from cannot be treated.
    #[error("in the orientation \"{name}\": {reason}")]
    Orientation {
        /// Its name.
        name: String,
        /// Why not.
        reason: Box<Self>,
    },
    /// Several reasons at once, none of them such a list.
    #[error("{}", .0.iter().map(Self::to_string).collect::<Vec<_>>().join("; "))]
    Several(Vec<Self>),
    /// The tool may lean.
    #[error(
        "the tool may lean (lead and tilt of [lean]): no bound covers that; without [lean] the placement can be certified"
    )]
    Lean,
    /// A tool axis that is not vertical.
    #[error("the tool is not upright: its axis is {:.3} deg from the vertical at point {point}", angle.to_degrees())]
    TiltedTool {
        /// The first such path point, from 0.
        point: usize,
        /// Angle between the tool axis and the vertical there. rad
        angle: f64,
    },
    /// The tool leans in more ways than bounds cover.
    #[error("the tool has {axes} different axes along the path: bounds cover {max}, each at any number of points")]
    ManyToolAxes {
        /// Different tool axes.
        axes: usize,
        /// Allowed.
        max: usize,
    },
    /// The tool leans, and bounds do not cover the rest of the problem then.
    #[error("bounds do not cover {what} with a tool that leans")]
    Leaning {
        /// What.
        what: &'static str,
    },
    /// A vertical tool axis that is upside down against the first one.
    #[error("the tool is not the same way up at every point: at point {point} it is upside down against point 0")]
    UpsideDown {
        /// The first such path point, from 0.
        point: usize,
    },
    /// A moment acts on the tool.
    #[error("a moment acts on the tool at point {point}")]
    Moment {
        /// The first such path point, from 0.
        point: usize,
    },
    /// A compliance that must be constant changes with its joint angle.
    #[error("the compliance of joint {joint} changes with its angle")]
    VaryingCompliance {
        /// The joint, from 1.
        joint: usize,
    },
    /// Joint 5 yields normal to its axis elsewhere than in the wrist centre, so that the flips of the wrist differ.
    #[error("joint 5 yields normal to its axis off the wrist centre (joints[5].bearing_mm)")]
    UnlikeFlips,
    /// More yields than the joints about their axes, and bounds have no terms for it.
    #[error("bounds do not cover {what}: a bound without them would be none")]
    YieldsBeside {
        /// What.
        what: &'static str,
    },
    /// Bounds from above do not cover the criterion.
    #[error(
        "bounds from above cover the mean of one part of the deflection without force errors, and not this {key}; those \
         of the best placement do"
    )]
    NotFromAbove {
        /// What is different: a key of the run file.
        key: &'static str,
    },
    /// Scores cover errors of the compliances.
    #[error("scores cover errors of the compliances (criterion.confidence)")]
    UncertainCompliances,
    /// The objective has the travel of the joints in it.
    #[error("the objective has the travel of the joints in it (criterion.joint_travel_weight_mm_per_rad)")]
    JointTravel,
    /// Beta stays along the path.
    #[error("beta stays (redundancy.beta = \"{}\")", beta.name())]
    ConstantBeta {
        /// Where it may change.
        beta: BetaPlan,
    },
    /// Something else than the mean deflection normal to the wall is minimised.
    #[error("it covers the mean of the deflection normal to the wall alone, and not another {key}")]
    OtherCriterion {
        /// What is different: a key of the table `[criterion]`, or the weights of segments.
        key: &'static str,
    },
    /// The bound on conditioning lets the arm come so near to its singularities that nothing can be bounded.
    #[error(
        "constraints.min_inverse_condition must be at least {needed:.3}: nearer to a singularity nothing can be bounded"
    )]
    Conditioning {
        /// The smallest bound on 1/kappa_F that will do.
        needed: f64,
    },
    /// The cell is so large that tables do not fit in memory.
    #[error(
        "the cell is so large that tables would take {:.3} GB, and at most {:.3} GB are allowed",
        *bytes as f64 / 1e9, *max as f64 / 1e9
    )]
    TooLarge {
        /// What they would take.
        bytes: u64,
        /// What they may take.
        max: u64,
    },
    /// The exact planner does not find what the lookup table promises: found out only after a search through it.
    #[error("what it promised was not to be had within the steps and turns of the joints")]
    Rejected,
    /// The caller stopped the work before it was done.
    #[error("it was interrupted before it was sampled")]
    Interrupted,
}

/// A direction may be this far from vertical (its sine) to be taken as vertical: printed digits.
const VERTICAL: f64 = 1e-9;

/// Which way up arm and tool are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Upright {
    /// +1 where axis 1 points up in the base frame, -1 where the arm hangs.
    pub side: f64,
    /// +1 where the tool axis (from the workpiece to the robot) is along axis 1, so that a growing beta turns the
    /// spindle counter-clockwise about it; -1 where it is against it.
    pub rotation_sign: f64,
}

impl Upright {
    /// That of a problem with an upright tool.
    ///
    /// # Errors
    /// [`Unsupported`], with the reason, for any other problem.
    pub fn of(problem: &Problem) -> Result<Self, Unsupported> {
        let up = axis_1(problem);
        if !is_vertical(&up) {
            return Err(Unsupported::BaseNotVertical { angle: libm::acos(up.z.abs().min(1.0)) });
        }
        if !problem.external_axes.is_empty() {
            return Err(Unsupported::ExternalAxes);
        }
        let points = problem.task.points();
        let first = points.first().map_or(1.0, |point| point.axis.z.signum());
        if let Some(point) = points.iter().position(|p| !is_vertical(&p.axis)) {
            let axis = &points[point].axis;
            return Err(Unsupported::TiltedTool {
                point,
                angle: libm::atan2(libm::hypot(axis.x, axis.y), axis.z.abs()),
            });
        }
        if let Some(point) = points.iter().position(|p| p.axis.z.signum() != first) {
            return Err(Unsupported::UpsideDown { point });
        }
        Ok(Self { side: up.z.signum(), rotation_sign: first * up.z.signum() })
    }
}

/// Requires that only forces act on the tool.
///
/// # Errors
/// [`Unsupported::Moment`] at the first point where a moment does.
pub fn require_no_moment(problem: &Problem) -> Result<(), Unsupported> {
    let first = problem.task.wrenches().position(|wrench| wrench.moment.norm() > 0.0);
    first.map_or(Ok(()), |point| Err(Unsupported::Moment { point }))
}

/// Requires the compliances of some joints (from 0) to be constant.
///
/// # Errors
/// [`Unsupported::VaryingCompliance`] for the first that is not.
pub fn require_constant(problem: &Problem, joints: &[usize]) -> Result<(), Unsupported> {
    let is_law = |j: &&usize| {
        let varies = |robot: &Robot| !matches!(robot.joints()[**j].compliance, Compliance::Constant(_));
        problem.scored_robots().iter().any(varies)
    };
    joints.iter().find(is_law).map_or(Ok(()), |joint| Err(Unsupported::VaryingCompliance { joint: joint + 1 }))
}

/// Requires that the mean of the deflection normal to the wall is minimised, whatever the weights of the segments.
///
/// # Errors
/// [`Unsupported::OtherCriterion`] where it is not, and [`Unsupported::JointTravel`] where joint travel counts too.
pub fn require_mean_wall(problem: &Problem) -> Result<(), Unsupported> {
    let Criterion { weights, aggregate, .. } = &problem.criterion;
    if *weights != Weights::WALL {
        Err(Unsupported::OtherCriterion { key: "criterion.direction" })
    } else if problem.criterion.stiffness.is_some() {
        Err(Unsupported::OtherCriterion { key: "criterion.robots" })
    } else if *aggregate != Aggregate::Mean {
        Err(Unsupported::OtherCriterion { key: "criterion.aggregate" })
    } else {
        require_no_travel(problem)
    }
}

/// Requires that joint travel does not count.
///
/// # Errors
/// [`Unsupported::JointTravel`] where it does.
pub fn require_no_travel(problem: &Problem) -> Result<(), Unsupported> {
    if problem.criterion.joint_travel_weight == 0.0 { Ok(()) } else { Err(Unsupported::JointTravel) }
}

/// Requires that beta may change along the path.
///
/// # Errors
/// [`Unsupported::ConstantBeta`] where it may not.
pub fn require_free_beta(problem: &Problem) -> Result<(), Unsupported> {
    match problem.redundancy.beta {
        BetaPlan::Free => Ok(()),
        beta => Err(Unsupported::ConstantBeta { beta }),
    }
}

/// Requires scores to leave out the uncertainty of the compliances.
///
/// # Errors
/// [`Unsupported::UncertainCompliances`] where they cover it.
pub fn require_certain_compliances(problem: &Problem) -> Result<(), Unsupported> {
    if problem.covers_compliance_errors() { Err(Unsupported::UncertainCompliances) } else { Ok(()) }
}

/// Requires that the two flips of the wrist yield alike.
///
/// # Errors
/// [`Unsupported::UnlikeFlips`] where they do not.
pub fn require_alike_flips(problem: &Problem) -> Result<(), Unsupported> {
    if problem.robot.flips_yield_alike() { Ok(()) } else { Err(Unsupported::UnlikeFlips) }
}

/// Whether turning workpiece and joint 1 together about axis 1 changes nothing but the angle of joint 1.
pub fn is_axis_1_vertical(problem: &Problem) -> bool {
    is_vertical(&axis_1(problem))
}

/// Whether it changes nothing else in a whole cell: nothing stands in it that shapes could hit, no external axis and no
/// compliant base has a direction of its own.
pub fn is_free_about_axis_1(problem: &Problem) -> bool {
    let is_stiff = |robot: &Robot| robot.base_compliance().is_none();
    is_axis_1_vertical(problem)
        && problem.external_axes.is_empty()
        && problem.scene.is_none()
        && is_stiff(&problem.robot)
        && problem.scored_robots().iter().all(is_stiff)
}

/// The direction of axis 1 in the base frame.
fn axis_1(problem: &Problem) -> Vector3<f64> {
    problem.robot.geometry().base_from_root * Vector3::z()
}

/// Whether a unit vector is along the vertical, up or down.
pub fn is_vertical(direction: &Vector3<f64>) -> bool {
    libm::hypot(direction.x, direction.y) < VERTICAL
}

/// A placement about axis 1: distance of the workpiece origin (m), its z in the base frame (m), and the yaw less its
/// azimuth (rad, not wrapped).
pub fn about_axis_1(problem: &Problem, placement: &Placement) -> [f64; 3] {
    let root = problem.robot.geometry().root_in_base;
    let (x, y) = (placement.x - root.x, placement.y - root.y);
    [libm::hypot(x, y), placement.z, placement.yaw - libm::atan2(y, x)]
}

/// How far apart two placements are about axis 1: in distance (m), in height (m) and in yaw less azimuth (rad); none is
/// negative.
pub fn apart_about_axis_1(problem: &Problem, a: &Placement, b: &Placement) -> [f64; 3] {
    let [a, b] = [a, b].map(|placement| about_axis_1(problem, placement));
    [(a[0] - b[0]).abs(), (a[1] - b[1]).abs(), wrap(a[2] - b[2]).abs()]
}
