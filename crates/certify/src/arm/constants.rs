//! Constants of the closed form of an arm, from the problem: geometry, compliances by joint angle, and joint limits.

use super::super::cell::points_of;
use super::super::continuation::{Bend, Links};
use super::super::enclosure::Enclosure;
use super::super::interval_simd::Mask;
use super::super::number::Number;
use super::beside::Beside;
use super::singularity::{Limits, Needs, tool_lever};
use super::{ArmCompliance, Margins};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};
use stead_model::robot::{Compensator, Compliance, Geometry, Joint, Robot, angles::ANGLE_ROUNDING};
use stead_problem::problem::Problem;

/// What does not change from state to state.
#[derive(Debug, Clone)]
pub(in super::super) struct Arm {
    pub(super) geometry: Geometry,
    /// Tool centre point from the wrist centre, with heading zero. m
    pub(in super::super) lever: Vector3<f64>,
    /// Axis 6 with heading zero.
    pub(in super::super) axis6: Vector3<f64>,
    /// The tool axis, where it is not along axis 1.
    pub(super) leaning: Option<Vector3<f64>>,
    /// Compliance of joint 1. rad/(N m)
    pub(in super::super) joint1: f64,
    /// Compliances of joints 2 and 3, and what they are like. rad/(N m)
    pub(super) laws: [Law; 2],
    typical: f64,
    /// Compliances k_4 to k_6. rad/(N m)
    pub(super) compliances: [f64; 3],
    /// Limits of joints 2 and 3, rounding included. rad
    limits: [(f64, f64); 2],
    /// The limits of the sum of joints 2 and 3, where they say more than those of the joints.
    pub(super) sum: Option<SumLimits>,
    /// Whether joint 2 yields with the forearm keeping its direction: v_2 - v_3 in the place of v_2.
    pub(super) linkage: bool,
    /// Smallest cosine of theta_5.
    pub(super) min_cosine5: f64,
    pub(super) min_inverse_condition: f64,
    pub(super) characteristic_length: f64,
    pub(super) needs: Needs,
    pub(super) links: Links,
    pub(super) bend: Bend,
    /// Whether any force or scored direction is along axis 1, and whether both can be.
    pub(super) is_vertical: bool,
    pub(super) is_axial: bool,
    /// What yields beside the joints about their axes.
    pub(super) beside: Option<Beside>,
    /// Whether any moment acts.
    pub(in super::super) has_moments: bool,
}

/// The limits of the sum of joints 2 and 3.
#[derive(Debug, Clone, Copy)]
pub(super) struct SumLimits {
    /// Rounding included. rad
    pub limits: (f64, f64),
    /// 1 or -1: how joint 3 counts.
    pub fold: f64,
    /// Whether no sum beyond them is within them but for a whole turn, by the limits of the joints.
    pub is_exact: bool,
}

impl SumLimits {
    fn of(robot: &Robot) -> Option<Self> {
        let range = robot.sum_range()?;
        let [least, largest] = robot.sums();
        let limits = (range.min - ANGLE_ROUNDING, range.max + ANGLE_ROUNDING);
        let says_more = least < limits.0 || largest > limits.1;
        let is_exact = largest - TAU < limits.0 && least + TAU > limits.1;
        says_more.then_some(Self { limits, fold: robot.geometry().fold, is_exact })
    }
}

/// How the limits of a joint cut its turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LimitSpan {
    /// Narrower than half a turn: both limits must hold.
    Narrow,
    /// Wider than half a turn: one of the two limits must hold.
    Wide,
    /// A turn or more: nothing is cut off.
    Full,
}

impl LimitSpan {
    /// Of limits in rad.
    pub fn of(limits: (f64, f64)) -> Self {
        match limits.1 - limits.0 {
            width if width >= 2.0 * PI => Self::Full,
            width if width > PI => Self::Wide,
            _ => Self::Narrow,
        }
    }
}

impl Arm {
    /// With the stiffness of a robot of the geometry of the problem's, for radii of the tool centre point from
    /// `nearest` (m) on.
    pub fn new(problem: &Problem, robot: &Robot, nearest: f64) -> Self {
        let side = robot.geometry().base_from_root[(2, 2)];
        let parts = points_of(problem).into_iter().map(|point| point.load.vertical_parts());
        let parts = parts.fold([false; 2], |all, one| [all[0] || one[0], all[1] || one[1]]);
        let axis = problem.task.points().first().map_or(1.0, |p| p.axis.z) * side;
        // With heading zero: feed along x, axis up or down.
        Self::with_tool(problem, robot, nearest, &Matrix3::from_diagonal(&Vector3::new(1.0, axis, axis)), parts)
    }

    /// The same for a tool with this axis in the frame of the workpiece about axis 1.
    pub fn leaning(problem: &Problem, robot: &Robot, nearest: f64, axis: Vector3<f64>) -> Self {
        let aside = Vector3::ith(axis.iamin(), 1.0).cross(&axis).normalize();
        let frame = Matrix3::from_columns(&[aside, axis.cross(&aside), axis]);
        Self { leaning: Some(axis), ..Self::with_tool(problem, robot, nearest, &frame, [true; 2]) }
    }

    /// With a frame whose third axis is the tool axis, and whether entries of the compliance out of the plan count.
    fn with_tool(problem: &Problem, robot: &Robot, nearest: f64, frame: &Matrix3<f64>, parts: [bool; 2]) -> Self {
        let compliances = robot.compliances_at(&[0.0; 6]);
        let geometry = robot.geometry().clone();
        // Eq. 10 with beta zero.
        let root_from_flange = frame
            * Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))
            * problem.spindle.flange_from_tool.inverse().rotation;
        let joint = |j: usize| &robot.joints()[j];
        let widest5 = joint(4).min.abs().max(joint(4).max.abs()) + ANGLE_ROUNDING;
        let limits = Limits::new(problem, problem.constraints.min_inverse_condition, nearest);
        let (upper_arm, forearm) = (geometry.upper_arm, geometry.forearm);
        let (square, twice) = (upper_arm * upper_arm + forearm * forearm, 2.0 * upper_arm * forearm);
        let distances2 = [square - twice * limits.folded, square + twice * limits.stretched];
        let lever = root_from_flange * tool_lever(problem);
        Self {
            beside: Beside::of(robot, &problem.spindle, &root_from_flange, &lever),
            geometry,
            needs: limits.needs,
            links: Links { upper_arm, forearm, limits: distances2 },
            bend: Bend { limit: limits.in_line },
            is_vertical: parts[0],
            is_axial: parts[1],
            has_moments: problem.task.wrenches().any(|wrench| wrench.moment.norm() > 0.0),
            lever,
            axis6: root_from_flange.column(2).into_owned(),
            leaning: None,
            joint1: compliances[0],
            laws: [1, 2].map(|j| Law::of(joint(j))),
            typical: compliances[1].max(compliances[2]) / 3.0,
            compliances: std::array::from_fn(|k| compliances[k + 3]),
            limits: [1, 2].map(|j| (joint(j).min - ANGLE_ROUNDING, joint(j).max + ANGLE_ROUNDING)),
            sum: SumLimits::of(robot),
            linkage: robot.has_linkage(),
            min_cosine5: if widest5 >= PI { -1.0 } else { libm::cos(widest5) },
            min_inverse_condition: problem.constraints.min_inverse_condition,
            characteristic_length: problem.constraints.characteristic_length,
        }
    }

    /// How large a compliance of the arm is: that of its upper joints at a lever of a metre. m/N
    pub fn typical_compliance(&self) -> f64 {
        self.typical
    }

    /// Limits of joint 2 (0) or 3 (1), rounding included. rad
    pub(super) fn limits(&self, joint: usize) -> (f64, f64) {
        self.limits[joint]
    }

    /// How the limits of joint 2 (0) or 3 (1) cut its turn.
    pub(super) fn limit_span(&self, joint: usize) -> LimitSpan {
        LimitSpan::of(self.limits[joint])
    }

    /// Whether all states of a region are sure to be allowed.
    pub fn is_sure<const V: usize, const P: usize>(&self, y: &ArmCompliance<Enclosure<V, P>>, lane: usize) -> bool {
        y.conditioned.lane(lane) && self.sure_to_hold(&y.margins, lane).into_iter().all(|holds| holds)
    }

    /// Which constraints are sure to hold in all states of a region: the elbow's, the wrist's and the general share of
    /// conditioning, and the limits of joints 2, 3 (with those of the sum of both) and 5.
    pub fn sure_to_hold<const V: usize, const P: usize>(
        &self,
        margins: &Margins<Enclosure<V, P>>,
        lane: usize,
    ) -> [bool; 6] {
        let holds = |margin: &Enclosure<V, P>| margin.value.low().0[lane] >= 0.0;
        let is_within = |span: LimitSpan, limits: &[Enclosure<V, P>; 2]| match (span, limits) {
            (LimitSpan::Full, _) => true,
            (LimitSpan::Wide, [min, max]) => holds(min) || holds(max),
            (LimitSpan::Narrow, [min, max]) => holds(min) && holds(max),
        };
        let within = |joint: usize| is_within(self.limit_span(joint), &margins.joints[joint]);
        // A sum that is within its limits but for a whole turn is beyond them.
        let of_sum = match (&self.sum, &margins.sum) {
            (Some(limits), Some(sum)) => limits.is_exact && is_within(LimitSpan::of(limits.limits), sum),
            _ => true,
        };
        let Margins { elbow, wrist, conditioning, joint5, .. } = margins;
        [holds(elbow), holds(wrist), holds(conditioning), within(0), within(1) && of_sum, holds(joint5)]
    }
}

/// Half the angle from the middle of the limits is told by its tangent, which needs one plus its cosine above this.
const MIN_OPEN: f64 = 1e-2;
/// Squared length of a spring and share of the stiffness left, below which too little is known.
const MIN_SPRING2: f64 = 1e-6;
const MIN_SHARE: f64 = 1e-3;

/// How a joint yields.
#[derive(Debug, Clone, Copy)]
pub(super) enum Law {
    /// The same at every angle. rad/(N m)
    Constant(f64),
    /// Linear in the angle: its value in the middle of the limits (rad/(N m)), slope, and sine and cosine of the
    /// middle.
    Range { middle: f64, slope: f64, at: (f64, f64) },
    /// Beside a spring: [`Compliance::Compensated`], and sine and cosine of its alpha.
    Compensated { alone: f64, compensator: Compensator, at: (f64, f64) },
}

impl Law {
    pub fn of(joint: &Joint) -> Self {
        match joint.compliance {
            Compliance::Constant(value) => Self::Constant(value),
            Compliance::Range { at_min, at_max } => Self::Range {
                middle: 0.5 * (at_min + at_max),
                slope: (at_max - at_min) / (joint.max - joint.min),
                at: libm::sincos(0.5 * (joint.min + joint.max)),
            },
            Compliance::Compensated { alone, compensator } => {
                Self::Compensated { alone, compensator, at: libm::sincos(compensator.alpha) }
            }
        }
    }

    /// A number times the compliance at the angle of this sine and cosine: true within the limits of the joint.
    /// `regular` loses the lanes in which too little is known. rad/(N m)
    #[inline(always)]
    pub fn times<T: Number>(&self, number: T, angle: [T; 2], regular: &mut Mask) -> T {
        let [sine, cosine] = angle;
        match *self {
            Self::Constant(value) => number.scale(value),
            Self::Range { middle, slope, at: (s, c) } => {
                // tan(x / 2) = sin x / (1 + cos x), with x the angle from the middle of the limits.
                let off = sine.scale(c) - cosine.scale(s);
                let open = (cosine.scale(c) + sine.scale(s)).plus(1.0).assume_above(MIN_OPEN, regular);
                number * (off * open.reciprocal()).arctangent().scale(2.0 * slope).plus(middle)
            }
            Self::Compensated { alone, compensator, at: (s, c) } => {
                let Compensator { spring_stiffness, a, l, free_length, .. } = compensator;
                let straight = cosine.scale(c) - sine.scale(s);
                let length2 = straight.scale(2.0 * a * l).plus(a * a + l * l).assume_above(MIN_SPRING2, regular);
                let inverse = length2.inverse_sqrt();
                let product = straight.scale(l).plus(a) * straight.scale(a).plus(l);
                let pull = (product * inverse.square() * inverse).scale(free_length);
                let share = (pull - straight).scale(spring_stiffness * a * l * alone).plus(1.0);
                (number * share.assume_above(MIN_SHARE, regular).reciprocal()).scale(alone)
            }
        }
    }
}
