//! The batch evaluator: one path point, all grid values of beta, all posture classes.
//!
//! For every state it finds the joint angles in closed form, drops those outside the joint limits or too near to a
//! singularity, and scores the rest. Structure of arrays over beta, no allocation, no branches inside a batch. The same
//! quantities, one state at a time and by way of the Jacobian, come from [`super::criterion::state`]; the tests hold the
//! two against each other.
//!
//! How it saves work: the rotation of the flange is linear in cos(beta) and sin(beta); everything is written in the frame
//! turned with joint 1, where the arm is a plane mechanism; angles are only computed where limits or the planner need them;
//! and what the first three joints rule out never reaches the wrist.

pub mod lanes;
mod laws;
mod spread;
mod states;
mod wrist;

pub use states::{States, StatesView};

use super::problem::{Problem, Redundancy, base_from_workpiece};
use crate::robot::{Posture, PostureClass, Robot, angles::ANGLE_ROUNDING, turns::Range};
use lanes::{Lanes, Mask, WIDTH};
use laws::Laws;
use nalgebra::Vector3;
use spread::Spread;
use std::f64::consts::{PI, TAU};

/// What does not change from one placement to the next.
#[derive(Debug, Clone)]
pub struct Kernel<'a> {
    problem: &'a Problem,
    count: usize,
    cosine: Vec<f64>,
    sine: Vec<f64>,
    limits: [Limit; 6],
    laws: Laws,
    spread: Option<Spread>,
    flips: Flips,
    forearm_sin_cos: (f64, f64),
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
    /// What kernels an arm needs: one for both postures of a class, or one for each.
    pub fn of(robot: &Robot) -> &'static [Self] {
        if robot.flips_yield_alike() { &[Self::Both] } else { &[Self::Plain, Self::Flipped] }
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

/// Scratch space of one thread.
#[derive(Debug, Clone)]
pub struct Scratch {
    columns: [Vec<f64>; wrist::COLUMNS],
    survivors: Vec<u32>,
}

/// One joint's limits, ready for lanes.
#[derive(Debug, Clone, Copy)]
struct Limit {
    min: f64,
    max: f64,
    has_turns: bool,
    /// Sine and cosine of both limits.
    ends: [(f64, f64); 2],
}

impl Limit {
    fn new(range: Range) -> Self {
        let (min, max) = (range.min - ANGLE_ROUNDING, range.max + ANGLE_ROUNDING);
        Self { min, max, has_turns: range.has_turns(), ends: [libm::sincos(min), libm::sincos(max)] }
    }

    /// Where the angle of the vector (cosine, sine), of any length, is allowed: found without the angle.
    #[inline(always)]
    fn allows(self, sine: Lanes, cosine: Lanes) -> Mask {
        if self.has_turns {
            return Mask::splat(true);
        }
        let [(s0, c0), (s1, c1)] = self.ends;
        let zero = Lanes::splat(0.0);
        let after_min = zero.at_most(sine * c0 - cosine * s0);
        let before_max = zero.at_most(cosine * s1 - sine * c1);
        if self.max - self.min <= PI { after_min & before_max } else { after_min | before_max }
    }

    /// The angle as the planner sees it (the real one, or any one where the joint has several), and where it is allowed.
    #[inline(always)]
    fn canonical(self, angle: Lanes) -> (Lanes, Mask) {
        if self.has_turns {
            return (angle, Mask::splat(true));
        }
        let turns = ((Lanes::splat(self.min) - angle) * (1.0 / TAU)).ceil();
        let real = angle + turns * TAU;
        (real, real.at_most(Lanes::splat(self.max)))
    }
}

/// A direction or vector of the flange as it turns with beta, in the root frame: `a + b cos(beta) + c sin(beta)`.
#[derive(Debug, Clone, Copy)]
struct Turning {
    a: Vector3<f64>,
    b: Vector3<f64>,
    c: Vector3<f64>,
}

impl Turning {
    /// A vector given in the tool frame, on point axes given as columns in the root frame (Caro 2013, eq. 7 and 10).
    fn new(axes: &nalgebra::Matrix3<f64>, v: &Vector3<f64>) -> Self {
        let (x, y, z) = (axes.column(0), axes.column(1), axes.column(2));
        Self { a: -z * v.z, b: x * v.x - y * v.y, c: x * v.y + y * v.x }
    }

    #[inline(always)]
    fn at(&self, k: usize, cosine: Lanes, sine: Lanes) -> Lanes {
        cosine * self.b[k] + sine * self.c[k] + self.a[k]
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
    normal: Vector3<f64>,
    force: Vector3<f64>,
    moment: Vector3<f64>,
    uncertainty: f64,
}

impl<'a> Kernel<'a> {
    /// Prepares the evaluation of a problem on a grid of beta, in one or both postures of each class.
    pub fn new(problem: &'a Problem, grid: &Redundancy, flips: Flips) -> Self {
        let count = grid.beta_count;
        let padded = count.next_multiple_of(WIDTH);
        let angle = |k: usize| libm::sincos(grid.beta(k % count));
        let limits = std::array::from_fn(|j| Limit::new(Range::of(&problem.robot.joints()[j])));
        Self {
            problem,
            count,
            cosine: (0..padded).map(|k| angle(k).1).collect(),
            sine: (0..padded).map(|k| angle(k).0).collect(),
            limits,
            laws: Laws::new(&problem.robot),
            spread: Spread::new(problem),
            flips,
            forearm_sin_cos: libm::sincos(problem.robot.geometry().forearm_angle),
        }
    }

    /// Which of the two postures of a class are evaluated.
    pub fn flips(&self) -> Flips {
        self.flips
    }

    /// Space for one thread to work in.
    pub fn scratch(&self) -> Scratch {
        let padded = self.count.next_multiple_of(WIDTH);
        Scratch { columns: std::array::from_fn(|_| vec![0.0; padded]), survivors: Vec::with_capacity(padded) }
    }

    /// Evaluates path point `point` with the workpiece at `pose` (x, y, z in m, yaw in rad) into `states`.
    ///
    /// Allowed states get their score (m) and their joint angles (theta_5 not negative; rad), all others an infinite
    /// score. A state is allowed when one of the postures asked for is inside the limits of every joint by itself; turns,
    /// and limits that tell two postures apart, are for the planner to look at.
    pub fn evaluate(&self, point: usize, pose: &[f64; 4], scratch: &mut Scratch, states: &mut States) {
        let geometry = self.point_geometry(point, pose);
        for class in PostureClass::ALL {
            states.clear(class);
        }
        for back in [false, true] {
            self.arm(&geometry, back, scratch);
            for delta_negative in [false, true] {
                self.select(delta_negative, scratch);
                if !scratch.survivors.is_empty() {
                    let class = PostureClass::ALL[2 * usize::from(back) + usize::from(delta_negative)];
                    if geometry.uncertainty > 0.0 || self.spread.is_some() {
                        self.wrist::<true>(&geometry, delta_negative, scratch, states.class_mut(class));
                    } else {
                        self.wrist::<false>(&geometry, delta_negative, scratch, states.class_mut(class));
                    }
                }
            }
        }
    }

    fn point_geometry(&self, point: usize, pose: &[f64; 4]) -> PointGeometry {
        let g = self.problem.robot.geometry();
        let root_from_base = g.base_from_root.transpose();
        let workpiece = base_from_workpiece(pose);
        let path_point = &self.problem.task.points()[point];
        let wrench = &self.problem.task.wrenches()[point];
        let rotation = root_from_base * workpiece.rotation;
        let axes = rotation * path_point.workpiece_from_point();
        let tool_from_flange = self.problem.spindle.flange_from_tool.inverse();
        let mut lever = self.problem.spindle.flange_from_tool.translation;
        lever.z += g.flange;
        let flange_axis = |k: usize| Turning::new(&axes, &tool_from_flange.rotation.column(k).into_owned());
        PointGeometry {
            tip: root_from_base * (workpiece.point(&path_point.position) - g.root_in_base),
            x6: flange_axis(0),
            y6: flange_axis(1),
            z6: flange_axis(2),
            lever: Turning::new(&axes, &(tool_from_flange.rotation * lever)),
            normal: axes.column(1).into_owned(),
            force: rotation * wrench.force,
            moment: rotation * wrench.moment,
            uncertainty: self.problem.criterion.force_uncertainty * wrench.force.norm(),
        }
    }

    /// The first three joints, wrist centre in front (or back) of joint 1, both elbows, for all beta: into the columns.
    fn arm(&self, geometry: &PointGeometry, back: bool, scratch: &mut Scratch) {
        use wrist::column as at;
        let g = self.problem.robot.geometry();
        let sign = if back { -1.0 } else { 1.0 };
        let product = 1.0 / (2.0 * g.upper_arm * g.forearm);
        let squares = g.upper_arm * g.upper_arm + g.forearm * g.forearm;
        let infinity = Lanes::splat(f64::INFINITY);
        let columns = &mut scratch.columns;
        for start in (0..self.count).step_by(WIDTH) {
            let (c, s) = (Lanes::load(&self.cosine, start), Lanes::load(&self.sine, start));
            let wx = Lanes::splat(geometry.tip.x) - geometry.lever.at(0, c, s);
            let wy = Lanes::splat(geometry.tip.y) - geometry.lever.at(1, c, s);
            let wz = Lanes::splat(geometry.tip.z) - geometry.lever.at(2, c, s);
            let radius2 = wx * wx + wy * wy;
            let forward2 = radius2 - g.lateral * g.lateral;
            let forward = forward2.sqrt() * sign;
            let height = wz - g.shoulder_height;
            let u = forward - g.shoulder_radius;
            let v = height * g.lift;
            let distance2 = u * u + v * v;
            let cosine = (distance2 - squares) * product;
            let sine = ((Lanes::splat(1.0) - cosine) * (cosine + 1.0)).sqrt();
            let along = cosine * g.forearm + g.upper_arm;
            let across = sine * (g.fold * g.forearm);
            let (u_along, v_along) = (u * along, v * along);
            let (u_across, v_across) = (u * across, v * across);
            let inverse = Lanes::splat(1.0) / distance2;
            let (sin_bar, cos_bar) = self.forearm_sin_cos;
            // Out of reach the sine is NaN, and so is everything made of it.
            let exists = sine.at_most(Lanes::splat(1.0));
            for (negative, e) in [(false, 1.0), (true, -1.0)] {
                let sine2 = v_along - u_across * e;
                let cosine2 = u_along + v_across * e;
                let sine3 = sine * (e * cos_bar) - cosine * sin_bar;
                let cosine3 = cosine * cos_bar + sine * (e * sin_bar);
                let allowed = exists & self.limits[1].allows(sine2, cosine2) & self.limits[2].allows(sine3, cosine3);
                let [s2, c2] = at::elbow(negative);
                (sine2 * inverse).store(&mut columns[s2], start);
                allowed.select(cosine2 * inverse, infinity).store(&mut columns[c2], start);
            }
            sine.store(&mut columns[at::SIN_DELTA], start);
            cosine.store(&mut columns[at::COS_DELTA], start);
            let inverse_radius2 = Lanes::splat(1.0) / radius2;
            ((wy * forward - wx * g.lateral) * inverse_radius2).store(&mut columns[at::SIN1], start);
            ((wx * forward + wy * g.lateral) * inverse_radius2).store(&mut columns[at::COS1], start);
            forward.store(&mut columns[at::FORWARD], start);
            height.store(&mut columns[at::HEIGHT], start);
        }
    }

    /// The grid values of beta that the first three joints allow with one elbow.
    fn select(&self, delta_negative: bool, scratch: &mut Scratch) {
        let cos2 = &scratch.columns[wrist::column::elbow(delta_negative)[1]][..self.count];
        scratch.survivors.clear();
        scratch.survivors.extend((0u32..).zip(cos2).filter(|(_, c)| c.is_finite()).map(|(k, _)| k));
    }
}

#[cfg(test)]
mod tests;
