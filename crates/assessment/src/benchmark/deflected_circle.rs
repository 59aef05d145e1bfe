//! One arm on the benchmark, circle by circle.

use super::{Benchmark, JUMP, LimitsAt, MAX_DEFLECTION, Obstacle, StiffnessModel, Turning};
use crate::circle::least_squares;
use nalgebra::{Matrix3, Vector3};
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};
use stead_model::robot::{
    Frames, NormalSprings, Pose, Posture, PostureClass, Robot, Spindle,
    angles::{ANGLE_ROUNDING, wrap},
    turns::Range,
};
use stead_model::stiffness::elastic::ElasticArm;
use stead_model::stiffness::loaded::loaded_displacement;
use stead_model::stiffness::whole::WholeArm;
use stead_model::task::Wrench;

/// An arm on the benchmark: what does not change from circle to circle.
#[derive(Debug, Clone)]
pub struct DeflectedCircle<'a> {
    benchmark: &'a Benchmark,
    robot: Cow<'a, Robot>,
    tool_from_flange: Pose<f64>,
    /// A tool on the flange that does not yield.
    spindle: Spindle,
    ranges: [Range; 6],
    /// Cosine and sine of each polar angle.
    directions: Vec<[f64; 2]>,
}

/// One of the two postures of a class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Flip {
    Plain,
    Flipped,
}

/// Room for the points of one circle, so that evaluating allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Profile {
    joints: Vec<[f64; 6]>,
    /// In-plane displacements. m
    displacements: Vec<[f64; 2]>,
    /// Displaced points in the plane relative to the centre of the nominal circle. m
    points: Vec<[f64; 2]>,
}

impl Profile {
    /// The machined profile of the last circle, relative to the centre of the nominal one. m
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }
}

impl<'a> DeflectedCircle<'a> {
    /// Sets an arm up for a benchmark.
    pub fn new(benchmark: &'a Benchmark, robot: &'a Robot) -> Self {
        let wrist_centre =
            || Pose { rotation: Matrix3::identity(), translation: Vector3::new(0.0, 0.0, -robot.geometry().flange) };
        let flange_from_tool = benchmark.flange_from_tool.unwrap_or_else(wrist_centre);
        let directions = (0..benchmark.points)
            .map(|k| {
                let (sine, cosine) = libm::sincos(TAU * k as f64 / benchmark.points as f64);
                [cosine, sine]
            })
            .collect();
        Self {
            benchmark,
            robot: joints_of(robot, benchmark.yielding),
            tool_from_flange: flange_from_tool.inverse(),
            spindle: Spindle::rigid(flange_from_tool),
            ranges: std::array::from_fn(|j| Range::of(&robot.joints()[j])),
            directions,
        }
    }

    /// Circularity of the circle about `centre` (plane coordinates, m) in a posture class, once for every load: a load
    /// of 1 is the wrench of the benchmark. Infinite under a load that the arm is too soft for (see
    /// [`Obstacle::TooSoft`] and [`Obstacle::Buckling`]). `profile` is left with the points of the last load. m
    ///
    /// # Errors
    /// The first [`Obstacle`] around the circle, or that of the first load where the arm is too soft for all.
    pub fn circularity<const N: usize>(
        &self,
        centre: [f64; 2],
        class: PostureClass,
        loads: [f64; N],
        profile: &mut Profile,
    ) -> Result<[f64; N], Obstacle> {
        self.go_round(centre, class, &mut profile.joints)?;
        let mut circularities = [0.0; N];
        let linear = self.benchmark.stiffness == StiffnessModel::Unloaded;
        if linear {
            self.displace(1.0, profile)?;
        }
        let mut obstacle = None;
        for (slot, load) in circularities.iter_mut().zip(loads) {
            let scale = if linear { load } else { 1.0 };
            let moved = if linear { Ok(()) } else { self.displace(load, profile) };
            let machined = moved.and_then(|()| self.machine(scale, profile));
            *slot = machined.unwrap_or_else(|why| {
                obstacle.get_or_insert(why);
                f64::INFINITY
            });
        }
        match obstacle {
            Some(obstacle) if circularities.iter().all(|value| value.is_infinite()) => Err(obstacle),
            _ => Ok(circularities),
        }
    }

    /// Joint angles at every point of the circle, wrapped or not, or why it cannot be gone round.
    fn go_round(&self, centre: [f64; 2], class: PostureClass, angles: &mut Vec<[f64; 6]>) -> Result<(), Obstacle> {
        angles.clear();
        let radius = self.benchmark.radius;
        // Joints 1 to 3 are checked as they come: most circles that fail do so early.
        let (early, mut flip) = match self.benchmark.limits_at {
            LimitsAt::Circle => (3, Flip::Plain),
            LimitsAt::Centre => {
                let joints = self.joints(centre, class)?;
                self.sum_within(&joints, [self.robot.sum_of(&joints); 2])?;
                (0, self.within_limits(&joints, &joints)?)
            }
        };
        let mut min = [f64::INFINITY; 6];
        let mut max = [f64::NEG_INFINITY; 6];
        let mut unwrapped = [0.0; 6];
        let mut sums = [f64::INFINITY, f64::NEG_INFINITY];
        // The first point is the last one too: the circle has to be closed.
        for (k, [cosine, sine]) in self.directions.iter().chain(self.directions.first()).enumerate() {
            let joints = match angles.first() {
                Some(first) if k == self.directions.len() => *first,
                _ => self.joints([centre[0] + radius * cosine, centre[1] + radius * sine], class)?,
            };
            for j in 0..6 {
                let step = if k == 0 { 0.0 } else { wrap(joints[j] - unwrapped[j]) };
                if step.abs() > JUMP {
                    return Err(Obstacle::Singularity(j + 1));
                }
                unwrapped[j] = if k == 0 { joints[j] } else { unwrapped[j] + step };
                min[j] = min[j].min(unwrapped[j]);
                max[j] = max[j].max(unwrapped[j]);
                if j < early && !fits(&self.ranges[j], min[j], max[j]) {
                    return Err(Obstacle::JointLimit(j + 1));
                }
            }
            let sum = self.robot.sum_of(&unwrapped);
            sums = [sums[0].min(sum), sums[1].max(sum)];
            if k < self.directions.len() {
                angles.push(joints);
            }
        }
        if self.benchmark.limits_at == LimitsAt::Circle {
            self.sum_within(&min, sums)?;
            flip = self.within_limits(&min, &max)?;
        }
        if flip == Flip::Flipped && !self.robot.flips_yield_alike() {
            for [_, _, _, fourth, fifth, sixth] in angles {
                (*fourth, *fifth, *sixth) = (*fourth + PI, -*fifth, *sixth + PI);
            }
        }
        Ok(())
    }

    /// Whether the sum of joints 2 and 3 stays within its limits between two values, for the least angles of the
    /// joints: all of them but for the whole turns that bring these within their ranges.
    fn sum_within(&self, min: &[f64; 6], sums: [f64; 2]) -> Result<(), Obstacle> {
        let Some(range) = self.robot.sum_range() else { return Ok(()) };
        let turns = |j: usize| self.ranges[j].lowest(min[j]) - min[j];
        let by = turns(1) + self.robot.geometry().fold * turns(2);
        let [least, largest] = sums.map(|sum| sum + by);
        let is_within = least >= range.min - ANGLE_ROUNDING && largest <= range.max + ANGLE_ROUNDING;
        if is_within { Ok(()) } else { Err(Obstacle::AxesSum) }
    }

    /// Which of the two wrist flips keeps all joints within their limits between the given angles of the unflipped one;
    /// that one, if both do.
    fn within_limits(&self, min: &[f64; 6], max: &[f64; 6]) -> Result<Flip, Obstacle> {
        let unflipped = (0..6).find(|j| !fits(&self.ranges[*j], min[*j], max[*j]));
        let Some(joint) = unflipped else { return Ok(Flip::Plain) };
        let flipped = (0..6).all(|j| match j {
            3 | 5 => fits(&self.ranges[j], min[j] + PI, max[j] + PI),
            4 => fits(&self.ranges[j], -max[j], -min[j]),
            _ => fits(&self.ranges[j], min[j], max[j]),
        });
        if flipped { Ok(Flip::Flipped) } else { Err(Obstacle::JointLimit(joint + 1)) }
    }

    /// Joint angles with the tip at a point of the plane, wrapped, in the posture of the class that is not flipped. rad
    fn joints(&self, point: [f64; 2], class: PostureClass) -> Result<[f64; 6], Obstacle> {
        let benchmark = self.benchmark;
        let base_from_tool = Pose { rotation: benchmark.base_from_tool, translation: benchmark.plane.point(point) };
        let [posture, _]: [Posture; 2] = class.postures();
        self.robot.inverse(&base_from_tool.then(&self.tool_from_flange), posture).map_err(|_| Obstacle::Reach)
    }

    /// Displacement of the tip for joint angles under a wrench at the tip, all in the base frame. m
    fn displacement(&self, joints: &[f64; 6], force: &Vector3<f64>, moment: &Vector3<f64>) -> Vector3<f64> {
        let frames = Frames::new(&self.robot, joints);
        let tip = self.tip(&frames);
        let arm = WholeArm::new(&self.robot, &self.spindle, &frames, self.compliances(joints), tip);
        arm.displacement(force, moment).linear
    }

    fn tip(&self, frames: &Frames<f64>) -> Vector3<f64> {
        frames.base_from_flange.point(&self.spindle.flange_from_tool.translation)
    }

    /// The same by the compliance under the load.
    fn loaded(&self, joints: &[f64; 6], force: &Vector3<f64>, moment: &Vector3<f64>) -> Result<Vector3<f64>, Obstacle> {
        let compliances = self.compliances(joints);
        let moved = if self.robot.normal_springs().is_some() {
            let load = Wrench { force: *force, moment: *moment };
            ElasticArm::new(&self.robot, &self.spindle).loaded_displacement(&compliances, joints, &load)?
        } else {
            let frames = Frames::new(&self.robot, joints);
            loaded_displacement(&frames, &self.tip(&frames), &compliances, force, moment)?
        };
        Ok(moved.linear)
    }

    fn compliances(&self, joints: &[f64; 6]) -> [f64; 6] {
        let mut compliances = self.robot.compliances_at(joints);
        for (compliance, yields) in compliances.iter_mut().zip(self.benchmark.yielding) {
            if !yields {
                *compliance = 0.0;
            }
        }
        compliances
    }

    /// In-plane displacement of every point under a load, from the joint angles left by [`Self::go_round`].
    fn displace(&self, load: f64, profile: &mut Profile) -> Result<(), Obstacle> {
        let Benchmark { plane, wrench, .. } = self.benchmark;
        let normal = plane.normal();
        profile.displacements.clear();
        for (joints, [cosine, sine]) in profile.joints.iter().zip(&self.directions) {
            let turned = match self.benchmark.turning {
                Turning::WithTool => *sine,
                Turning::AgainstTool => -*sine,
            };
            let radial = plane.x * *cosine + plane.y * turned;
            let tangential = plane.y * *cosine - plane.x * turned;
            let in_base = |v: &Vector3<f64>| (radial * v.x + tangential * v.y + normal * v.z) * load;
            let (force, moment) = (in_base(&wrench.force), in_base(&wrench.moment));
            let moved = match self.benchmark.stiffness {
                StiffnessModel::Unloaded => self.displacement(joints, &force, &moment),
                StiffnessModel::Loaded => self.loaded(joints, &force, &moment)?,
            };
            profile.displacements.push([moved.dot(&plane.x), moved.dot(&plane.y)]);
        }
        Ok(())
    }

    /// Circularity of the nominal circle with so many times the displacements. m
    fn machine(&self, scale: f64, profile: &mut Profile) -> Result<f64, Obstacle> {
        let radius = self.benchmark.radius;
        let nominal = self.directions.iter().map(|direction| direction.map(|part| radius * part));
        let moves = profile.displacements.iter().map(|moved| moved.map(|part| scale * part));
        profile.points.clear();
        profile.points.extend(nominal.zip(moves).map(|([x, y], [dx, dy])| [x + dx, y + dy]));
        let count = profile.displacements.len() as f64;
        let mean = [0, 1].map(|axis| profile.displacements.iter().map(|moved| moved[axis]).sum::<f64>() / count);
        let off = |moved: &[f64; 2]| libm::hypot(moved[0] - mean[0], moved[1] - mean[1]) * scale;
        let max = profile.displacements.iter().map(off).fold(0.0, f64::max);
        if max.is_nan() || max > MAX_DEFLECTION * radius {
            return Err(Obstacle::TooSoft);
        }
        least_squares(&profile.points).map(|fit| fit.circularity).map_err(|_| Obstacle::TooSoft)
    }
}

/// The arm with the springs normal to the axes of the joints that yield, on a base that does not.
fn joints_of(robot: &Robot, yielding: [bool; 6]) -> Cow<'_, Robot> {
    let Some(normal) = robot.normal_springs() else { return Cow::Borrowed(robot) };
    let springs = std::array::from_fn(|j| match yielding[j] {
        true => normal[j],
        false => NormalSprings { compliance: [0.0; 2], ..normal[j] },
    });
    // Springs that do not yield are as good as those that did.
    let masked = robot.clone().with_normal_springs(Some(springs)).unwrap_or_else(|_| robot.clone());
    Cow::Owned(masked.with_base_compliance(None))
}

/// Whether some number of turns brings an interval of angles into a range.
fn fits(range: &Range, min: f64, max: f64) -> bool {
    let lowest = range.lowest(min);
    lowest + (max - min) <= range.max + ANGLE_ROUNDING
}

#[cfg(test)]
impl DeflectedCircle<'_> {
    /// First-order circularity `load |F| (lambda_max - lambda_min)`, or with the sum where the wrench turns against the
    /// tool, with the in-plane compliance at the centre of the circle. m
    ///
    /// # Errors
    /// [`Obstacle::Reach`] when the centre is out of reach.
    pub(super) fn first_order(&self, centre: [f64; 2], class: PostureClass, load: f64) -> Result<f64, Obstacle> {
        let joints = self.joints(centre, class)?;
        let plane = &self.benchmark.plane;
        let unit = |direction: &Vector3<f64>| {
            let moved = self.displacement(&joints, direction, &Vector3::zeros());
            [moved.dot(&plane.x), moved.dot(&plane.y)]
        };
        let ([xx, xy], [yx, yy]) = (unit(&plane.x), unit(&plane.y));
        let eigenvalues = nalgebra::Matrix2::new(xx, (xy + yx) / 2.0, (xy + yx) / 2.0, yy).symmetric_eigenvalues();
        let (max, min) = (eigenvalues.max(), eigenvalues.min());
        Ok(load
            * self.benchmark.in_plane_force()
            * match self.benchmark.turning {
                Turning::WithTool => max - min,
                Turning::AgainstTool => max + min,
            })
    }
}
