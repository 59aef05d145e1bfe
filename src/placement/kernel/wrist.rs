//! The second half of the batch evaluator: wrist angles, conditioning and score, for the states that the first three
//! joints allow. Everything is in the frame turned with joint 1: x along the arm, y to its left, z along axis 1.

use super::lanes::{Lanes, WIDTH};
use super::states::StatesView;
use super::{Flips, Kernel, PointGeometry, Scratch};
use std::f64::consts::PI;

/// Number of columns that the first half hands over.
pub(super) const COLUMNS: usize = 10;

/// The columns that the first half hands over, each over beta.
pub(super) mod column {
    /// sin(theta_1)
    pub const SIN1: usize = 0;
    /// cos(theta_1)
    pub const COS1: usize = 1;
    /// Wrist centre along the arm. m
    pub const FORWARD: usize = 2;
    /// Wrist centre above the shoulder. m
    pub const HEIGHT: usize = 3;
    /// Sine and cosine of the elbow angle delta, taken as not negative.
    pub const SIN_DELTA: usize = 4;
    /// See [`SIN_DELTA`].
    pub const COS_DELTA: usize = 5;
    /// sin(theta_2) and cos(theta_2) of one elbow; the cosine is infinite where joints 1 to 3 are not allowed.
    pub const fn elbow(delta_negative: bool) -> [usize; 2] {
        if delta_negative { [8, 9] } else { [6, 7] }
    }
}

/// Four vectors in the frame of joint 1.
#[derive(Clone, Copy)]
struct Vector {
    x: Lanes,
    y: Lanes,
    z: Lanes,
}

impl Vector {
    #[inline(always)]
    fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    fn scale(self, factor: Lanes) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

/// A constant vector of the root frame, turned into the frame of joint 1.
#[inline(always)]
fn turned(v: [Lanes; 3], sin1: Lanes, cos1: Lanes) -> Vector {
    Vector { x: v[0] * cos1 + v[1] * sin1, y: v[1] * cos1 - v[0] * sin1, z: v[2] }
}

/// The arm's configuration, four at a time: what conditioning and score are made of.
struct Pose {
    /// Wrist centre from the shoulder. m
    u: Lanes,
    height: Lanes,
    /// Wrist centre from the elbow. m
    u3: Lanes,
    height3: Lanes,
    /// Wrist centre along the arm from axis 1. m
    forward: Lanes,
    /// Tool centre point from the wrist centre. m
    lever: Vector,
    z4: Vector,
    z5: Vector,
    z6: Vector,
    /// z4 . z6
    dot46: Lanes,
    /// |z4 x z6|^2
    sine5_squared: Lanes,
}

impl Kernel<'_> {
    /// Evaluates the surviving states of one class; `ROBUST` where scores cover errors of the force or of the compliances.
    pub(super) fn wrist<const ROBUST: bool>(
        &self,
        geometry: &PointGeometry,
        delta_negative: bool,
        scratch: &Scratch,
        mut states: StatesView<'_>,
    ) {
        for batch in scratch.survivors.chunks(WIDTH) {
            let mut index = [batch[0] as usize; WIDTH];
            for (slot, beta) in index.iter_mut().zip(batch) {
                *slot = *beta as usize;
            }
            self.batch::<ROBUST>(geometry, delta_negative, scratch, index, batch.len(), &mut states);
        }
    }

    #[inline(always)]
    fn batch<const ROBUST: bool>(
        &self,
        geometry: &PointGeometry,
        delta_negative: bool,
        scratch: &Scratch,
        index: [usize; WIDTH],
        filled: usize,
        states: &mut StatesView<'_>,
    ) {
        let g = self.problem.robot.geometry();
        let gather = |values: &[f64]| Lanes(index.map(|k| values[k]));
        let column = |k: usize| gather(&scratch.columns[k]);
        let (cosine, sine) = (gather(&self.cosine), gather(&self.sine));
        let (sin1, cos1) = (column(column::SIN1), column(column::COS1));
        let (forward, height) = (column(column::FORWARD), column(column::HEIGHT));
        let [s2, c2] = column::elbow(delta_negative).map(column);
        let turn = |v: &super::Turning| turned([0, 1, 2].map(|k| v.at(k, cosine, sine)), sin1, cos1);
        let (x6, y6, z6, lever) = (turn(&geometry.x6), turn(&geometry.y6), turn(&geometry.z6), turn(&geometry.lever));

        // Elbow and forearm: the bar from elbow to wrist centre, turned back by its constant angle, is x3.
        let u = forward - g.shoulder_radius;
        let u3 = u - c2 * g.upper_arm;
        let height3 = height - s2 * (g.lift * g.upper_arm);
        let (bar_cos, bar_sin) = (u3 * (1.0 / g.forearm), height3 * (g.lift / g.forearm));
        let (sin_bar_angle, cos_bar_angle) = (self.forearm_sin_cos.0 * g.fold, self.forearm_sin_cos.1);
        let cos_psi = bar_cos * cos_bar_angle + bar_sin * sin_bar_angle;
        let sin_psi = bar_sin * cos_bar_angle - bar_cos * sin_bar_angle;
        let zero = Lanes::splat(0.0);
        let twist4 = g.fold * g.twist[0];
        let z4 = Vector { x: sin_psi * twist4, y: zero, z: cos_psi * (-twist4 * g.lift) };

        // Wrist, with theta_5 not negative.
        let [_, s5, s6] = g.twist;
        let m1 = z6.x * cos_psi + z6.z * sin_psi * g.lift;
        let m2 = z6.y * (-twist4 * g.lift);
        let dot46 = z6.x * z4.x + z6.z * z4.z;
        let sine5_squared = m1 * m1 + m2 * m2;
        let sine5 = sine5_squared.sqrt();
        let z5 = z4.cross(z6).scale(Lanes::splat(1.0) / sine5);
        let theta5 = sine5.atan2(dot46 * (-s5 * s6));
        let pose = Pose { u, height, u3, height3, forward, lever, z4, z5, z6, dot46, sine5_squared };

        let inverse_condition = pose.inverse_condition(g.lateral, self.problem.constraints.characteristic_length);
        let conditioned = Lanes::splat(self.problem.constraints.min_inverse_condition).at_most(inverse_condition);
        let (real5, plain5) = self.limits[4].canonical(theta5);
        let (turned5, flipped5) = self.limits[4].canonical(-theta5);
        let mut allowed = conditioned & (plain5 | flipped5);
        if !allowed.any() {
            return;
        }
        let theta4 = (m2 * s6).atan2(m1 * s6);
        let theta6 = (z4.dot(y6) * -s5).atan2(z4.dot(x6) * s5);
        let theta1 = sin1.atan2(cos1);
        let (theta1, allowed1) = self.limits[0].canonical(theta1);
        let (real4, plain4) = self.limits[3].canonical(theta4);
        let (real6, plain6) = self.limits[5].canonical(theta6);
        let (turned4, flipped4) = self.limits[3].canonical(theta4 + PI);
        let (turned6, flipped6) = self.limits[5].canonical(theta6 + PI);
        let (plain, flipped) = (plain4 & plain5 & plain6, flipped4 & flipped5 & flipped6);
        allowed = allowed
            & allowed1
            & match self.flips {
                Flips::Both => plain | flipped,
                Flips::Plain => plain,
                Flips::Flipped => flipped,
            };

        let constant = |v: &nalgebra::Vector3<f64>| turned([v.x, v.y, v.z].map(Lanes::splat), sin1, cos1);
        let (normal, force, moment) =
            (constant(&geometry.normal), constant(&geometry.force), constant(&geometry.moment));
        let elbow = if delta_negative { -1.0 } else { 1.0 };
        let (sin_delta, cos_delta) = (column(column::SIN_DELTA) * elbow, column(column::COS_DELTA));
        let (theta2, _) = self.limits[1].canonical(s2.atan2(c2));
        let (theta3, _) = self.limits[2].canonical(sin_delta.atan2(cos_delta) - g.forearm_angle);
        let joints = [theta1, theta2, theta3, theta4, theta5, theta6];
        let turned = || {
            let (sin_bar, cos_bar) = self.forearm_sin_cos;
            let third = [sin_delta * cos_bar - cos_delta * sin_bar, cos_delta * cos_bar + sin_delta * sin_bar];
            let is_flipped = self.flips == Flips::Flipped;
            let wrist = if is_flipped { [turned4, turned5, turned6] } else { [real4, real5, real6] };
            // Flipped, joints 4 and 6 point the other way, and joint 5 is bent to the other side.
            let sign = if is_flipped { -1.0 } else { 1.0 };
            let per_sine = Lanes::splat(sign) / sine5;
            let fourth = [m2 * s6 * per_sine, m1 * s6 * per_sine];
            let fifth = [sine5 * sign, dot46 * (-s5 * s6)];
            let sixth = [z4.dot(y6) * -s5 * per_sine, z4.dot(x6) * s5 * per_sine];
            let angles = [theta1, theta2, theta3, wrist[0], wrist[1], wrist[2]];
            (angles, [[sin1, cos1], [s2, c2], third, fourth, fifth, sixth])
        };
        let compliances = self.laws.constants().unwrap_or_else(|| {
            let (angles, directions) = turned();
            self.laws.at(&angles, &directions)
        });
        let (mut score, parts) =
            pose.score::<ROBUST>(g.lateral, &compliances, normal, force, moment, geometry.uncertainty);
        if ROBUST && let Some(spread) = &self.spread {
            let (angles, directions) = turned();
            score = score + spread.margin(&parts, &angles, &directions, &compliances);
        }
        if let Some(limit) = self.problem.constraints.max_deflection {
            allowed = allowed & score.at_most(Lanes::splat(limit));
        }
        for k in 0..filled {
            if allowed.lane(k) {
                states.set(index[k], score.0[k], joints.map(|theta| theta.0[k]));
            }
        }
    }
}

impl Pose {
    /// Tool centre point from axis 1, from the shoulder and from the elbow: x and z in the plane of the arm. m
    #[inline(always)]
    fn reaches(&self) -> [(Lanes, Lanes); 2] {
        let (tx, tz) = (self.lever.x, self.lever.z);
        [(self.u + tx, self.height + tz), (self.u3 + tx, self.height3 + tz)]
    }

    /// 1/kappa_F through the 3x3 blocks of a spherical wrist; see [`crate::robot::conditioning`]. Signs of columns do not
    /// matter, so axes 2 and 3 are both taken as (0, -1, 0).
    #[inline(always)]
    fn inverse_condition(&self, lateral: f64, length: f64) -> Lanes {
        let one = Lanes::splat(1.0);
        let t = self.lever;
        let lever2 = t.dot(t);
        let px = self.forward + t.x;
        let py = t.y + lateral;
        let [(r2x, r2z), (r3x, r3z)] = self.reaches();
        let along = [self.z4.dot(t), self.z5.dot(t), self.z6.dot(t)];
        let linear2 = px * px + py * py + r2x * r2x + r2z * r2z + r3x * r3x + r3z * r3z + lever2 * 3.0
            - along[0] * along[0]
            - along[1] * along[1]
            - along[2] * along[2];
        let norm2 = linear2 * (1.0 / (length * length)) + 6.0;

        // Inverse of the position block at the wrist centre: rows q1, q2, q3; arm rotation per velocity: rows 0, wy, wz.
        let inverse_forward = one / self.forward;
        let slope = inverse_forward * lateral;
        let inverse_det = one / (self.height3 * self.u - self.height * self.u3);
        let row = |x: Lanes, z: Lanes| {
            let x = x * inverse_det;
            Vector { x, y: x * slope, z: z * inverse_det }
        };
        let zero = Lanes::splat(0.0);
        let q1 = Vector { x: zero, y: inverse_forward, z: zero };
        let q2 = row(self.u3, self.height3);
        let q3 = row(-self.u, -self.height);
        let wy = q2.plus(q3).scale(Lanes::splat(-1.0));
        let arm2 = q1.dot(q1) + q2.dot(q2) + q3.dot(q3);
        let crossed = |q: Vector| {
            let d = q.dot(t);
            q.dot(q) * lever2 - d * d
        };
        let arm_crossed2 = crossed(q1) + crossed(q2) + crossed(q3);

        // The inverse wrist as a quadratic form, from the dual basis of z4, z5, z6.
        let g = one / self.sine5_squared;
        let g2 = g * g;
        let same = (self.dot46 * self.dot46 + 1.0) * g2;
        let mixed = self.dot46 * g2 * -2.0;
        let (z4, z5, z6) = (self.z4, self.z5, self.z6);
        let form = |a4: Lanes, b4: Lanes, a5: Lanes, b5: Lanes, a6: Lanes, b6: Lanes| {
            a5 * b5 + same * (a4 * b4 + a6 * b6) + mixed * (a4 * b6 + a6 * b4)
        };
        let qxx = form(z4.x, z4.x, z5.x, z5.x, z6.x, z6.x);
        let qyy = form(z4.y, z4.y, z5.y, z5.y, z6.y, z6.y);
        let qzz = form(z4.z, z4.z, z5.z, z5.z, z6.z, z6.z);
        let qxy = form(z4.x, z4.y, z5.x, z5.y, z6.x, z6.y);
        let qxz = form(z4.x, z4.z, z5.x, z5.z, z6.x, z6.z);
        let qyz = form(z4.y, z4.z, z5.y, z5.z, z6.y, z6.z);
        let spin2 = qyy * wy.dot(wy) + qyz * wy.dot(q1) * 2.0 + qzz * q1.dot(q1);
        let (cy, cz) = (wy.cross(t), q1.cross(t));
        let my = Vector { x: -cy.x, y: one - cy.y, z: -cy.z };
        let mz = Vector { x: -cz.x, y: -cz.y, z: one - cz.z };
        let rest2 = qxx + qyy * my.dot(my) + qzz * mz.dot(mz) + (qxy * my.x + qxz * mz.x + qyz * my.dot(mz)) * 2.0;
        let inverse_norm2 = (arm2 + spin2) * (length * length) + arm_crossed2 + rest2;
        Lanes::splat(6.0) / (norm2 * inverse_norm2).sqrt()
    }

    /// The score: |n . K^-1 w| as a sum over joints, and the force uncertainty's share; and what each joint adds to
    /// n . K^-1 w per compliance.
    #[inline(always)]
    fn score<const ROBUST: bool>(
        &self,
        lateral: f64,
        compliances: &[Lanes; 6],
        normal: Vector,
        force: Vector,
        moment: Vector,
        uncertainty: f64,
    ) -> (Lanes, [Lanes; 6]) {
        let t = self.lever;
        let (px, py) = (self.forward + t.x, t.y + lateral);
        let [(r2x, r2z), (r3x, r3z)] = self.reaches();
        let turn_n = t.cross(normal);
        let turn_f = t.cross(force).plus(moment);
        // Torque of a unit normal force, and of the wrench, on each joint.
        let torque_n = [
            px * normal.y - py * normal.x,
            r2x * normal.z - r2z * normal.x,
            r3x * normal.z - r3z * normal.x,
            self.z4.dot(turn_n),
            self.z5.dot(turn_n),
            self.z6.dot(turn_n),
        ];
        let torque_f = [
            px * force.y - py * force.x + moment.z,
            r2x * force.z - r2z * force.x - moment.y,
            r3x * force.z - r3z * force.x - moment.y,
            self.z4.dot(turn_f),
            self.z5.dot(turn_f),
            self.z6.dot(turn_f),
        ];
        let parts = std::array::from_fn(|j| torque_n[j] * torque_f[j]);
        let mut deflection = Lanes::splat(0.0);
        for j in 0..6 {
            deflection = deflection + parts[j] * compliances[j];
        }
        let mut score = deflection.abs();
        if ROBUST && uncertainty > 0.0 {
            let zero = Lanes::splat(0.0);
            let velocities = [
                Vector { x: -py, y: px, z: zero },
                Vector { x: -r2z, y: zero, z: r2x },
                Vector { x: -r3z, y: zero, z: r3x },
                self.z4.cross(t),
                self.z5.cross(t),
                self.z6.cross(t),
            ];
            let mut response = Vector { x: zero, y: zero, z: zero };
            for j in 0..6 {
                response = response.plus(velocities[j].scale(torque_n[j] * compliances[j]));
            }
            score = score + response.dot(response).sqrt() * uncertainty;
        }
        (score, parts)
    }
}
