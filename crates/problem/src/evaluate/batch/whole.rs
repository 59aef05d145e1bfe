//! What yields beside the joints about their axes, in lanes: springs normal to the axes, the base, the mount of the
//! spindle, holder and tool, the part.
//!
//! In the frame of joint 1, with t the tool centre point from the wrist centre W and T = t x f + m:
//!
//! - base and part answer alike whatever beta and posture: one constant for a point, a placement and a direction; joint
//!   1 too where it yields alike about x and y;
//! - joint 6, mount and tip are fixed to the tool, so that what they add is a polynomial of second degree in cos(beta)
//!   and sin(beta), the same in all postures;
//! - with their springs in W, joints 4 and 5 turn the tool by `C T`; since y4 = -+z5 and y5 = -+z6, and a triad of unit
//!   vectors makes up the whole of T, that is `(cx4 + cx5) T` beside multiples of z4, z5 and z6, the axes that the
//!   score without these springs has already;
//! - x and y of joints 2 and 3 are in the plane of the arm.
//!
//! What turns the tool is summed as vectors and projected once for each scored direction.
//! [`springs`](WholeState::springs) goes through the springs one by one instead: where derivatives by each are asked
//! for, or responses to errors of the force.

mod fixed;

pub(super) use fixed::{Fixed, FixedParts, PlacedLoad};

use super::pose::{Load, Pose, Vector, worst};
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::Robot;
use stead_numerics::simd::{Lanes, Simd};

/// Springs normal to the axes of an arm, ready for lanes; all zero where it has none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Normal {
    /// About x and y. rad/(N m)
    compliance: [[f64; 2]; 6],
    /// Where on its axis each joint yields, in the frame of its row. m
    bearing: [f64; 6],
    /// Where joints 2 and 3 yield across the plane of the arm, in the frame of joint 1. m
    across: [f64; 2],
    /// The spring about x of joints 4 and 5 where they yield in the wrist centre. rad/(N m)
    all_round: f64,
    /// What is added to the compliances about axes 4 to 6 for joints 4 and 5 that yield in the wrist centre. rad/(N m)
    added: [f64; 3],
    /// From the wrist centre to where joint 6 yields, along its axis. m
    sixth: f64,
}

/// The frames of joints 2 and 3 in the plane of the arm: the x and z components of their x axes.
#[derive(Clone, Copy)]
pub(super) struct Planar<S: Simd> {
    pub second: [Lanes<S>; 2],
    pub third: [Lanes<S>; 2],
}

/// Both axes of a joint that are in the plane of the arm, but for the sign of the second, from the x and z components
/// of the first.
#[inline(always)]
fn in_plane<S: Simd>(zero: Lanes<S>, first: [Lanes<S>; 2]) -> [Vector<S>; 2] {
    [Vector { x: first[0], y: zero, z: first[1] }, Vector { x: -first[1], y: zero, z: first[0] }]
}

/// A spring in lanes: its compliance, its axis, and how fast it moves the tool centre point.
#[derive(Clone, Copy)]
pub(super) struct Spring<S: Simd> {
    pub compliance: f64,
    pub axis: Vector<S>,
    pub velocity: Vector<S>,
}

impl Normal {
    pub fn new(robot: &Robot) -> Self {
        let g = robot.geometry();
        let normal = robot.normal_springs();
        let compliance = std::array::from_fn(|j| normal.map_or([0.0; 2], |springs| springs[j].compliance));
        let bearing: [f64; 6] = std::array::from_fn(|j| normal.map_or(0.0, |springs| springs[j].bearing));
        let central = |j: usize| if bearing[j] == 0.0 { compliance[j] } else { [0.0; 2] };
        let ([x4, y4], [x5, y5]) = (central(3), central(4));
        Self {
            compliance,
            bearing,
            across: [-g.lift * (robot.joints()[1].d + bearing[1]), g.lateral - g.lift * g.fold * bearing[2]],
            all_round: x4 + x5,
            added: [-x4, y4 - x4 - x5, y5 - x5],
            sixth: g.flange + bearing[5],
        }
    }

    /// Whether joint 1 yields alike about x and y.
    pub fn is_first_alike(&self) -> bool {
        self.compliance[0][0] == self.compliance[0][1]
    }

    /// Compliance of joint 1 about both where it is alike. rad/(N m)
    pub fn first_alike(&self) -> f64 {
        if self.is_first_alike() { self.compliance[0][0] } else { 0.0 }
    }

    /// Where joint 1 yields along axis 1 in the root frame. m
    pub fn first_height(&self, robot: &Robot) -> f64 {
        robot.geometry().shoulder_height + self.bearing[0]
    }

    /// What the springs of joint 6 normal to its axis add to the compliance of everything that is fixed to the flange,
    /// per force and per moment at the tool centre point, in the flange frame; `reach` is the tool centre point in it.
    pub fn of_sixth(&self, reach: &Vector3<f64>) -> [Matrix3<f64>; 2] {
        let from_bearing = reach - Vector3::new(0.0, 0.0, self.bearing[5]);
        let mut sums = [Matrix3::zeros(); 2];
        for (axis, compliance) in [Vector3::x(), Vector3::y()].into_iter().zip(self.compliance[5]) {
            let velocity = axis.cross(&from_bearing);
            sums[0] += velocity * velocity.transpose() * compliance;
            sums[1] += velocity * axis.transpose() * compliance;
        }
        sums
    }
}

/// What a state needs beside its pose where more than the joints about their axes yields.
#[derive(Clone, Copy)]
pub(super) struct Beside<S: Simd, const N: usize> {
    /// See [`FixedParts`]; along each direction. m
    pub parts: [Lanes<S>; N],
    /// How base and part answer a unit force along each direction. m/N
    pub responses: [Vector<S>; N],
    /// The axes of the flange.
    pub flange: [Vector<S>; 3],
}

/// The product of a matrix of the flange frame and a vector, both in the frame of joint 1.
#[inline(always)]
pub(super) fn flange_product<S: Simd>(matrix: &Matrix3<f64>, flange: &[Vector<S>; 3], v: Vector<S>) -> Vector<S> {
    let inside = [flange[0].dot(v), flange[1].dot(v), flange[2].dot(v)];
    let row = |k: usize| inside[0] * matrix[(k, 0)] + inside[1] * matrix[(k, 1)] + inside[2] * matrix[(k, 2)];
    flange[0].scale(row(0)).plus(flange[1].scale(row(1))).plus(flange[2].scale(row(2)))
}

/// The torque of the load about a spring.
#[inline(always)]
pub(super) fn torque<S: Simd, const N: usize>(spring: &Spring<S>, load: &Load<S, N>) -> Lanes<S> {
    spring.velocity.dot(load.force) + spring.axis.dot(load.moment)
}

/// A state of a whole arm under its load, but for its pose.
pub(super) struct WholeState<'a, S: Simd, const N: usize> {
    pub normal: &'a Normal,
    pub fixed: &'a Fixed,
    pub planar: &'a Planar<S>,
    /// Distance of the wrist centre from the plane of the arm. m
    pub lateral: f64,
    /// -1 where axis 5 points against z5 of the pose, else 1.
    pub side: f64,
    pub load: &'a Load<S, N>,
    pub beside: &'a Beside<S, N>,
}

impl<S: Simd, const N: usize> WholeState<'_, S, N> {
    /// The displacement of the tool centre point by the springs of all joints, with compliances about the axes at the
    /// pose; without what is constant or fixed to the flange: joint 1 normal to its axis where it is alike, and joint
    /// 6. m
    #[inline(always)]
    fn displacement(&self, pose: &Pose<S>, compliances: &[Lanes<S>; 6]) -> Vector<S> {
        let Self { normal, planar, lateral, .. } = *self;
        let t = pose.lever;
        let (f, m) = (self.load.force, self.load.moment);
        let (px, py) = (pose.forward + t.x, t.y + lateral);
        let [(r2x, r2z), (r3x, r3z)] = pose.reaches();

        // Joint 1.
        let first = (px * f.y - py * f.x + m.z) * compliances[0];
        let mut moved = Vector { x: -(first * py), y: first * px, z: first.all(0.0) };
        if !normal.is_first_alike() {
            let [cx, cy] = normal.compliance[0];
            let pz = r2z - normal.bearing[0];
            let dx = (m.x + py * f.z - pz * f.y) * cx;
            let dy = (m.y + pz * f.x - px * f.z) * cy;
            moved = moved.plus(Vector { x: dy * pz, y: -(dx * pz), z: dx * py - dy * px });
        }

        // Joints 2 and 3. With a linkage the spring of joint 2 turns the upper arm, and joint 3 back by as much.
        let mut held = first;
        for (k, (rx, rz)) in [(r2x, r2z), (r3x, r3z)].into_iter().enumerate() {
            let ry = py - normal.across[k];
            let (tx, ty, tz) = (m.x + ry * f.z - rz * f.y, m.y + rz * f.x - rx * f.z, m.z + rx * f.y - ry * f.x);
            let [cx, cy] = normal.compliance[1 + k];
            let (dx, dz) = if cx == cy {
                (tx * cx, tz * cx)
            } else {
                let [gx, gz] = if k == 0 { planar.second } else { planar.third };
                let (mean, half) = ((cx + cy) * 0.5, (cx - cy) * 0.5);
                let (even, odd) = ((gx * gx - gz * gz) * half, gx * gz * (2.0 * half));
                ((even + mean) * tx + odd * tz, odd * tx - (even - mean) * tz)
            };
            let mut dy = ty * compliances[1 + k];
            if pose.linkage {
                if k == 0 {
                    held = ((r2z - r3z) * f.x - (r2x - r3x) * f.z) * compliances[1];
                    dy = held;
                } else {
                    dy = dy - held;
                }
            }
            moved = moved.plus(Vector { x: dy * rz - dz * ry, y: dz * rx - dx * rz, z: dx * ry - dy * rx });
        }
        self.moved_by_wrist(pose, compliances, moved)
    }

    /// A displacement with that by the springs of joints 4 to 6. m
    #[inline(always)]
    fn moved_by_wrist(&self, pose: &Pose<S>, compliances: &[Lanes<S>; 6], mut moved: Vector<S>) -> Vector<S> {
        let Self { normal, side, .. } = *self;
        let (t, f) = (pose.lever, self.load.force);
        let turn = t.cross(f).plus(self.load.moment);
        let [a4, a5, a6] = normal.added;
        let (z4, z5, z6) = (pose.z4, pose.z5, pose.z6);
        let mut turned = z4
            .scale(z4.dot(turn) * (compliances[3] + a4))
            .plus(z5.scale(z5.dot(turn) * (compliances[4] + a5)))
            .plus(z6.scale(z6.dot(turn) * (compliances[5] + a6)));
        turned = Vector {
            x: turned.x + turn.x * normal.all_round,
            y: turned.y + turn.y * normal.all_round,
            z: turned.z + turn.z * normal.all_round,
        };
        for (j, axis, next, bearing) in [(3, z4, z5, normal.bearing[3]), (4, z5, z6, normal.bearing[4] * side)] {
            let [cx, cy] = normal.compliance[j];
            if bearing == 0.0 || (cx == 0.0 && cy == 0.0) {
                continue;
            }
            // x of the joint is `next x axis`, y is `next`, but for signs.
            let across = next.cross(axis);
            let dx = (across.dot(turn) + next.dot(f) * bearing) * cx;
            let dy = (next.dot(turn) - across.dot(f) * bearing) * cy;
            turned = turned.plus(across.scale(dx)).plus(next.scale(dy));
            moved = moved.plus(next.scale(dx * bearing)).plus(across.scale(-(dy * bearing)));
        }
        moved.plus(turned.cross(t))
    }

    /// The twelve springs one by one, two a joint, base first: about x, about y.
    #[inline(always)]
    fn springs(&self, simd: S, pose: &Pose<S>) -> [Spring<S>; 12] {
        let Self { normal, planar, lateral, side, .. } = *self;
        let flange = &self.beside.flange;
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let t = pose.lever;
        let (px, py) = (pose.forward + t.x, t.y + lateral);
        let [(r2x, r2z), (r3x, r3z)] = pose.reaches();
        let axes = [
            [Vector { x: one, y: zero, z: zero }, Vector { x: zero, y: one, z: zero }],
            in_plane(zero, planar.second),
            in_plane(zero, planar.third),
            [pose.z5.cross(pose.z4), pose.z5],
            [pose.z6.cross(pose.z5), pose.z6],
            [flange[0], flange[1]],
        ];
        let reaches = [
            Vector { x: px, y: py, z: r2z - normal.bearing[0] },
            Vector { x: r2x, y: py - normal.across[0], z: r2z },
            Vector { x: r3x, y: py - normal.across[1], z: r3z },
            t.plus(pose.z4.scale(Lanes::splat(simd, -(normal.bearing[3])))),
            t.plus(pose.z5.scale(Lanes::splat(simd, -(normal.bearing[4] * side)))),
            t.plus(flange[2].scale(Lanes::splat(simd, -(normal.sixth)))),
        ];
        // A loop and not a closure, which would be compiled without the processor's wide instructions.
        let first = Spring { compliance: 0.0, axis: axes[0][0], velocity: axes[0][0] };
        let mut springs = [first; 12];
        for j in 0..6 {
            for about in 0..2 {
                let axis = axes[j][about];
                let compliance = normal.compliance[j][about];
                springs[2 * j + about] = Spring { compliance, axis, velocity: axis.cross(reaches[j]) };
            }
        }
        springs
    }

    /// How the arm yields along each scored direction, spring by spring.
    #[inline(always)]
    fn yielding(&self, simd: S, pose: &Pose<S>, compliances: &[Lanes<S>; 6]) -> Yielding<S, N> {
        let Self { fixed, lateral, load, beside, .. } = *self;
        let tool = [pose.forward + pose.lever.x, pose.lever.y + lateral];
        let velocities = pose.velocities(simd, tool);
        let axial = pose.axial_torques(load, tool);
        let springs = self.springs(simd, pose);
        let of_flange = flange_product(&fixed.flange[0], &beside.flange, load.force).plus(flange_product(
            &fixed.flange[1],
            &beside.flange,
            load.moment,
        ));
        let parts = [[Lanes::splat(simd, 0.0); 18]; N];
        let mut found = Yielding { parts, deflection: beside.parts, responses: beside.responses };
        let Yielding { parts, deflection, responses } = &mut found;
        for k in 0..N {
            let direction = load.directions[k];
            deflection[k] = deflection[k] + of_flange.dot(direction);
            responses[k] = responses[k].plus(flange_product(&fixed.flange[0], &beside.flange, direction));
            for j in 0..6 {
                let moves = velocities[j].dot(direction);
                parts[k][j] = moves * axial[j];
                deflection[k] = deflection[k] + parts[k][j] * compliances[j];
                responses[k] = responses[k].plus(velocities[j].scale(moves * compliances[j]));
            }
            for (j, spring) in springs.iter().enumerate() {
                let moves = spring.velocity.dot(direction);
                parts[k][6 + j] = moves * torque(spring, load);
                deflection[k] = deflection[k] + parts[k][6 + j] * spring.compliance;
                responses[k] = responses[k].plus(spring.velocity.scale(moves * spring.compliance));
            }
        }
        found
    }
}

/// What each spring adds to the scored part per compliance: about the axes, then the twelve normal to them.
pub(super) type Parts<S> = [Lanes<S>; 18];

/// How an arm yields along each scored direction.
struct Yielding<S: Simd, const N: usize> {
    parts: [Parts<S>; N],
    /// m
    deflection: [Lanes<S>; N],
    /// Displacement under a unit force along the direction. m/N
    responses: [Vector<S>; N],
}

impl<S: Simd> Pose<S> {
    /// As [`Pose::score`], of a whole arm.
    #[inline(always)]
    pub fn score_whole<const PLAIN: bool, const N: usize>(
        &self,
        simd: S,
        whole: &WholeState<'_, S, N>,
        compliances: &[Lanes<S>; 6],
        uncertainty: f64,
    ) -> (Lanes<S>, Parts<S>) {
        let zero = Lanes::splat(simd, 0.0);
        let mut along = [zero; 18];
        let mut square = zero;
        if PLAIN {
            let moved = whole.displacement(self, compliances);
            let mut deflection = whole.beside.parts;
            for k in 0..N {
                deflection[k] = deflection[k] + whole.load.directions[k].dot(moved);
                square = square + deflection[k] * deflection[k];
            }
            return (if N == 1 { deflection[0].abs() } else { square.sqrt() }, along);
        }
        let Yielding { parts, deflection, responses } = whole.yielding(simd, self, compliances);
        if N == 1 {
            let mut score = deflection[0].abs();
            if uncertainty > 0.0 {
                score = score + responses[0].dot(responses[0]).sqrt() * uncertainty;
            }
            return (score, parts[0]);
        }
        for part in deflection {
            square = square + part * part;
        }
        let scored = square.sqrt();
        let mut score = scored;
        // Along the deflection itself, where there is one.
        let inverse = zero.less(scored).select(Lanes::splat(simd, 1.0) / scored, zero);
        for k in 0..N {
            for j in 0..18 {
                along[j] = along[j] + parts[k][j] * (deflection[k] * inverse);
            }
        }
        if uncertainty > 0.0 {
            score = worst(simd, &responses, &deflection, square, uncertainty);
        }
        (score, along)
    }
}
