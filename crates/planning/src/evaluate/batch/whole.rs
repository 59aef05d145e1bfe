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
//!   vectors makes up the whole of T, that is `(cx4 + cx5) T` beside multiples of z4, z5 and z6, the axes that the score
//!   without these springs has already;
//! - x and y of joints 2 and 3 are in the plane of the arm.
//!
//! What turns the tool is summed as vectors and projected once for each scored direction. [`springs`](Normal::springs)
//! goes through the springs one by one instead: where derivatives by each are asked for, or responses to errors of the
//! force.

use super::pose::{Load, Pose, Vector, worst};
use crate::problem::Problem;
use nalgebra::{Matrix3, Matrix6, Vector3};
use pulp::Simd;
use stead_model::robot::Robot;
use stead_numerics::simd::Lanes;

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
fn in_plane<S: Simd>(zero: Lanes<S>, [x, z]: [Lanes<S>; 2]) -> [Vector<S>; 2] {
    [Vector { x, y: zero, z }, Vector { x: -z, y: zero, z: x }]
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

    /// The displacement of the tool centre point by the springs of all joints, with compliances about the axes at the
    /// pose; without what is constant or fixed to the flange: joint 1 normal to its axis where it is alike, and joint 6.
    /// T is the torque about the wrist centre; `side` is -1 where axis 5 points against z5 of the pose. m
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "one call, inlined")]
    pub fn displacement<S: Simd>(
        &self,
        pose: &Pose<S>,
        planar: &Planar<S>,
        lateral: f64,
        side: f64,
        compliances: &[Lanes<S>; 6],
        force: Vector<S>,
        moment: Vector<S>,
    ) -> Vector<S> {
        let t = pose.lever;
        let (f, m) = (force, moment);
        let turn = t.cross(f).plus(m);
        let (px, py) = (pose.forward + t.x, t.y + lateral);
        let [(r2x, r2z), (r3x, r3z)] = pose.reaches();

        // Joint 1.
        let first = (px * f.y - py * f.x + m.z) * compliances[0];
        let mut moved = Vector { x: -(first * py), y: first * px, z: first - first };
        if !self.is_first_alike() {
            let [cx, cy] = self.compliance[0];
            let pz = r2z - self.bearing[0];
            let dx = (m.x + py * f.z - pz * f.y) * cx;
            let dy = (m.y + pz * f.x - px * f.z) * cy;
            moved = moved.plus(Vector { x: dy * pz, y: -(dx * pz), z: dx * py - dy * px });
        }

        // Joints 2 and 3.
        for (k, (rx, rz)) in [(r2x, r2z), (r3x, r3z)].into_iter().enumerate() {
            let ry = py - self.across[k];
            let (tx, ty, tz) = (m.x + ry * f.z - rz * f.y, m.y + rz * f.x - rx * f.z, m.z + rx * f.y - ry * f.x);
            let [cx, cy] = self.compliance[1 + k];
            let (dx, dz) = if cx == cy {
                (tx * cx, tz * cx)
            } else {
                let [gx, gz] = if k == 0 { planar.second } else { planar.third };
                let (mean, half) = ((cx + cy) * 0.5, (cx - cy) * 0.5);
                let (even, odd) = ((gx * gx - gz * gz) * half, gx * gz * (2.0 * half));
                ((even + mean) * tx + odd * tz, odd * tx - (even - mean) * tz)
            };
            let dy = ty * compliances[1 + k];
            moved = moved.plus(Vector { x: dy * rz - dz * ry, y: dz * rx - dx * rz, z: dx * ry - dy * rx });
        }

        // Joints 4 to 6.
        let [a4, a5, a6] = self.added;
        let (z4, z5, z6) = (pose.z4, pose.z5, pose.z6);
        let mut turned = z4
            .scale(z4.dot(turn) * (compliances[3] + a4))
            .plus(z5.scale(z5.dot(turn) * (compliances[4] + a5)))
            .plus(z6.scale(z6.dot(turn) * (compliances[5] + a6)));
        turned = Vector {
            x: turned.x + turn.x * self.all_round,
            y: turned.y + turn.y * self.all_round,
            z: turned.z + turn.z * self.all_round,
        };
        for (j, axis, next, bearing) in
            [(3, z4, z5, self.bearing[3]), (4, z5, z6, self.bearing[4] * side)]
        {
            let [cx, cy] = self.compliance[j];
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
    pub fn springs<S: Simd>(
        &self,
        simd: S,
        pose: &Pose<S>,
        planar: &Planar<S>,
        lateral: f64,
        side: f64,
        flange: &[Vector<S>; 3],
    ) -> [Spring<S>; 12] {
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
            Vector { x: px, y: py, z: r2z - self.bearing[0] },
            Vector { x: r2x, y: py - self.across[0], z: r2z },
            Vector { x: r3x, y: py - self.across[1], z: r3z },
            t.plus(pose.z4.scale(Lanes::splat(simd, -(self.bearing[3])))),
            t.plus(pose.z5.scale(Lanes::splat(simd, -(self.bearing[4] * side)))),
            t.plus(flange[2].scale(Lanes::splat(simd, -(self.sixth)))),
        ];
        // A loop and not a closure, which would be compiled without the processor's wide instructions.
        let first = Spring { compliance: 0.0, axis: axes[0][0], velocity: axes[0][0] };
        let mut springs = [first; 12];
        for j in 0..6 {
            for about in 0..2 {
                let axis = axes[j][about];
                let compliance = self.compliance[j][about];
                springs[2 * j + about] = Spring { compliance, axis, velocity: axis.cross(reaches[j]) };
            }
        }
        springs
    }
}

/// What is the same in all states of a problem: matrices, where it has any.
#[derive(Debug, Clone)]
pub(super) struct Fixed {
    /// In the root frame: where the base yields, and how.
    base: Option<(Vector3<f64>, Matrix6<f64>)>,
    /// What is fixed to the flange, at the tool centre point, per force and per moment: mount and tip, in the flange
    /// frame.
    pub flange: [Matrix3<f64>; 2],
    /// The same in the tool frame, with the springs of joint 6 normal to its axis.
    tool: [Matrix3<f64>; 2],
    /// Of the one set of springs: compliance of joint 1 where it is alike about x and y, and where it yields.
    first: f64,
    first_height: f64,
}

/// What a point at a placement adds to the parts of the deflection along the scored directions:
/// `a + b cos(beta) + c sin(beta) + d cos(2 beta) + e sin(2 beta)`, and, where errors of the force are covered, how base
/// and part answer a unit force along each, in the root frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FixedParts {
    terms: [[f64; 5]; 3],
    pub responses: [Vector3<f64>; 3],
}

/// What acts on a path point, in the root frame.
pub(super) struct PlacedLoad<'a> {
    /// Axes of the point, as columns.
    pub axes: &'a Matrix3<f64>,
    /// Rotation of the workpiece.
    pub workpiece: &'a Matrix3<f64>,
    /// Tool centre point. m
    pub tip: &'a Vector3<f64>,
    /// Force (N) and moment (N m).
    pub force: &'a Vector3<f64>,
    pub moment: &'a Vector3<f64>,
    pub directions: &'a [Vector3<f64>; 3],
}

impl Fixed {
    pub fn new(problem: &Problem, normal: &Normal) -> Self {
        let g = problem.robot.geometry();
        let root_from_base = g.base_from_root.transpose();
        let base = problem.robot.yielding_base().map(|(frame, matrix)| {
            let rotation = root_from_base * frame.rotation;
            let mut both = Matrix6::zeros();
            both.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
            both.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
            (root_from_base * (frame.translation - g.root_in_base), both * matrix * both.transpose())
        });
        let tool = &problem.spindle.flange_from_tool;
        let reach = tool.translation;
        let block = |matrix: &Matrix6<f64>, row: usize, column: usize| {
            matrix.fixed_view::<3, 3>(row, column).into_owned()
        };
        let mut flange = [Matrix3::zeros(); 2];
        if let Some(mount) = &problem.spindle.mount {
            // Displacement at the tool centre point: u + phi x q, under the moment m + q x f.
            let lever = reach.cross_matrix();
            let turning = block(mount, 0, 3) - lever * block(mount, 3, 3);
            let shifting = block(mount, 0, 0) - lever * block(mount, 3, 0);
            flange = [shifting + turning * lever, turning];
        }
        if let Some(tip) = &problem.spindle.tip {
            flange[0] += tool.rotation * tip * tool.rotation.transpose();
        }
        let sixth = normal.of_sixth(&reach);
        let in_tool = |k: usize| tool.rotation.transpose() * (flange[k] + sixth[k]) * tool.rotation;
        Self {
            base,
            flange,
            tool: [in_tool(0), in_tool(1)],
            first: normal.first_alike(),
            first_height: normal.first_height(&problem.robot),
        }
    }

    /// What a point adds, where there is one set of springs, and no error is covered (`is_plain`): all that does not
    /// depend on the posture. Else, what does not depend on the springs and on beta.
    pub fn parts(&self, is_plain: bool, part: Option<&Matrix3<f64>>, load: &PlacedLoad<'_>) -> FixedParts {
        let mut found = FixedParts::default();
        let PlacedLoad { axes, workpiece, tip, force, moment, directions } = load;
        let part = part.map(|matrix| *workpiece * matrix * workpiece.transpose());
        let answer = |force: &Vector3<f64>, moment: &Vector3<f64>| {
            let mut moved = part.map_or_else(Vector3::zeros, |part| part * force);
            if let Some((point, matrix)) = &self.base {
                let reach = *tip - point;
                let turning = moment + reach.cross(force);
                let block = |row: usize, column: usize| matrix.fixed_view::<3, 3>(row, column);
                let shift = block(0, 0) * force + block(0, 3) * turning;
                moved += shift + (block(3, 0) * force + block(3, 3) * turning).cross(&reach);
            }
            moved
        };
        let moved = answer(force, moment);
        let lever = Vector3::new(tip.x, tip.y, tip.z - self.first_height);
        let turning = *moment + lever.cross(force);
        for (k, direction) in directions.iter().enumerate() {
            found.terms[k][0] = moved.dot(direction);
            if is_plain {
                let across = lever.cross(direction);
                found.terms[k][0] += self.first * (turning.x * across.x + turning.y * across.y);
                let in_point = |vector: &Vector3<f64>| axes.tr_mul(vector);
                self.add_of_tool(&mut found.terms[k], &in_point(direction), [&in_point(force), &in_point(moment)]);
            } else {
                found.responses[k] = answer(direction, &Vector3::zeros());
            }
        }
        found
    }

    /// What is fixed to the tool adds along a direction n, which like force and moment is given on the axes of the
    /// point. There, with P the rotation from the point to the tool, the matrices are `P^T C P`.
    fn add_of_tool(&self, terms: &mut [f64; 5], n: &Vector3<f64>, [force, moment]: [&Vector3<f64>; 2]) {
        for (matrix, load) in self.tool.iter().zip([force, moment]) {
            let symmetric = (matrix + matrix.transpose()) * 0.5;
            let (mean, half) = ((symmetric.m11 + symmetric.m22) * 0.5, (symmetric.m11 - symmetric.m22) * 0.5);
            let (mixed, x, y) = (symmetric.m12, symmetric.m13, symmetric.m23);
            let (same, odd) = (n.x * load.x - n.y * load.y, n.x * load.y + n.y * load.x);
            let (along, aside) = (n.x * load.z + n.z * load.x, n.y * load.z + n.z * load.y);
            terms[0] += mean * (n.x * load.x + n.y * load.y) + symmetric.m33 * n.z * load.z;
            terms[1] += y * aside - x * along;
            terms[2] -= y * along + x * aside;
            terms[3] += half * same - mixed * odd;
            terms[4] += mixed * same + half * odd;
            // What is left of a matrix that is not symmetric turns like a vector.
            let spin = Vector3::new(
                (matrix.m32 - matrix.m23) * 0.5,
                (matrix.m13 - matrix.m31) * 0.5,
                (matrix.m21 - matrix.m12) * 0.5,
            );
            let turned = load.cross(n);
            terms[0] -= spin.z * turned.z;
            terms[1] += spin.x * turned.x - spin.y * turned.y;
            terms[2] += spin.y * turned.x + spin.x * turned.y;
        }
    }
}

impl FixedParts {
    /// At the cosines and sines of beta. m
    #[inline(always)]
    pub fn at<S: Simd, const N: usize>(&self, simd: S, cosine: Lanes<S>, sine: Lanes<S>) -> [Lanes<S>; N] {
        let twice = [cosine * cosine - sine * sine, cosine * sine * 2.0];
        let mut parts = [Lanes::splat(simd, 0.0); N];
        for (part, [a, b, c, d, e]) in parts.iter_mut().zip(self.terms) {
            *part = cosine * b + sine * c + twice[0] * d + twice[1] * e + a;
        }
        parts
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

/// The load as it is, for [`Normal::springs`].
#[inline(always)]
pub(super) fn torque<S: Simd, const N: usize>(spring: &Spring<S>, load: &Load<S, N>) -> Lanes<S> {
    spring.velocity.dot(load.force) + spring.axis.dot(load.moment)
}

/// What each spring adds to the scored part per compliance: about the axes, then the twelve normal to them.
pub(super) type Parts<S> = [Lanes<S>; 18];

impl<S: Simd> Pose<S> {
    /// As [`Pose::score`], of a whole arm.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "one call, inlined")]
    pub fn score_whole<const PLAIN: bool, const N: usize>(
        &self,
        simd: S,
        (normal, fixed): (&Normal, &Fixed),
        planar: &Planar<S>,
        lateral: f64,
        side: f64,
        compliances: &[Lanes<S>; 6],
        load: &Load<S, N>,
        beside: &Beside<S, N>,
        uncertainty: f64,
    ) -> (Lanes<S>, Parts<S>) {
        let zero = Lanes::splat(simd, 0.0);
        let mut along = [zero; 18];
        let mut deflection = beside.parts;
        if PLAIN {
            let moved = normal.displacement(self, planar, lateral, side, compliances, load.force, load.moment);
            let mut square = zero;
            for k in 0..N {
                deflection[k] = deflection[k] + load.directions[k].dot(moved);
                square = square + deflection[k] * deflection[k];
            }
            return (if N == 1 { deflection[0].abs() } else { square.sqrt() }, along);
        }
        let at_tool = [self.forward + self.lever.x, self.lever.y + lateral];
        let velocities = self.velocities(simd, at_tool);
        let axial = self.axial_torques(load, at_tool);
        let springs = normal.springs(simd, self, planar, lateral, side, &beside.flange);
        let of_flange = flange_product(&fixed.flange[0], &beside.flange, load.force)
            .plus(flange_product(&fixed.flange[1], &beside.flange, load.moment));
        let mut parts = [[zero; 18]; N];
        let mut responses = beside.responses;
        let mut square = zero;
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
            square = square + deflection[k] * deflection[k];
        }
        if N == 1 {
            let mut score = deflection[0].abs();
            if uncertainty > 0.0 {
                score = score + responses[0].dot(responses[0]).sqrt() * uncertainty;
            }
            return (score, parts[0]);
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
