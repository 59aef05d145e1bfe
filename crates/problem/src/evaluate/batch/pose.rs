//! Configurations of the arm in lanes: their conditioning and their score. Everything is in the frame turned with joint
//! 1: x along the arm, y to its left, z along axis 1.

use crate::criterion::worst_gains;
use stead_numerics::simd::{Lanes, Simd};

/// Vectors in the frame of joint 1.
#[derive(Clone, Copy)]
pub(super) struct Vector<S: Simd> {
    pub x: Lanes<S>,
    pub y: Lanes<S>,
    pub z: Lanes<S>,
}

impl<S: Simd> Vector<S> {
    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub fn scale(self, factor: Lanes<S>) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    /// A row of the inverse position block.
    #[inline(always)]
    fn row(x: Lanes<S>, slope: Lanes<S>, z: Lanes<S>) -> Self {
        Self { x, y: x * slope, z }
    }

    /// |self x t|^2, with t . t given.
    #[inline(always)]
    fn crossed2(self, t: Self, t2: Lanes<S>) -> Lanes<S> {
        let d = self.dot(t);
        self.dot(self) * t2 - d * d
    }

    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

/// An entry of the inverse wrist's quadratic form, from the components of z4, z5, z6 along two axes.
#[inline(always)]
fn form<S: Simd>(same: Lanes<S>, mixed: Lanes<S>, a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[1] * b[1] + same * (a[0] * b[0] + a[2] * b[2]) + mixed * (a[0] * b[2] + a[2] * b[0])
}

/// A vector of the root frame, turned into the frame of joint 1.
#[inline(always)]
pub(super) fn turned<S: Simd>(v: [Lanes<S>; 3], sin1: Lanes<S>, cos1: Lanes<S>) -> Vector<S> {
    Vector { x: v[0] * cos1 + v[1] * sin1, y: v[1] * cos1 - v[0] * sin1, z: v[2] }
}

/// Sine and cosine of the six joint angles.
pub(super) type Directions<S> = [[Lanes<S>; 2]; 6];

/// What acts on the tool, and the directions in which its deflection is scored: one, or three that may be zero.
#[derive(Clone, Copy)]
pub(super) struct Load<S: Simd, const N: usize> {
    pub directions: [Vector<S>; N],
    pub force: Vector<S>,
    pub moment: Vector<S>,
}

/// The arm's configuration, several at a time: what conditioning and score are made of.
pub(super) struct Pose<S: Simd> {
    /// Wrist centre from the shoulder. m
    pub u: Lanes<S>,
    pub height: Lanes<S>,
    /// Wrist centre from the elbow. m
    pub u3: Lanes<S>,
    pub height3: Lanes<S>,
    /// Wrist centre along the arm from axis 1. m
    pub forward: Lanes<S>,
    /// Tool centre point from the wrist centre. m
    pub lever: Vector<S>,
    pub z4: Vector<S>,
    pub z5: Vector<S>,
    pub z6: Vector<S>,
    /// z4 . z6
    pub dot46: Lanes<S>,
    /// |z4 x z6|^2
    pub sine5_squared: Lanes<S>,
    /// Whether the spring of joint 2 leaves the forearm its direction: J_2 - J_3 in the place of J_2.
    pub linkage: bool,
}

impl<S: Simd> Pose<S> {
    /// Tool centre point from axis 1, from the shoulder and from the elbow: x and z in the plane of the arm. m
    #[inline(always)]
    pub fn reaches(&self) -> [(Lanes<S>, Lanes<S>); 2] {
        let (tx, tz) = (self.lever.x, self.lever.z);
        [(self.u + tx, self.height + tz), (self.u3 + tx, self.height3 + tz)]
    }

    /// 1/kappa_F through the 3x3 blocks of a spherical wrist; see [`stead_model::robot::conditioning`]. Signs of
    /// columns do not matter, so axes 2 and 3 are both taken as (0, -1, 0).
    #[inline(always)]
    pub fn inverse_condition(&self, simd: S, lateral: f64, length: f64) -> Lanes<S> {
        let one = Lanes::splat(simd, 1.0);
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

        // Inverse of the position block at the wrist centre: rows q1, q2, q3; arm rotation per velocity: rows 0, wy,
        // wz.
        let inverse_forward = one / self.forward;
        let slope = inverse_forward * lateral;
        let inverse_det = one / (self.height3 * self.u - self.height * self.u3);
        let zero = Lanes::splat(simd, 0.0);
        let q1 = Vector { x: zero, y: inverse_forward, z: zero };
        let q2 = Vector::row(self.u3 * inverse_det, slope, self.height3 * inverse_det);
        let q3 = Vector::row(-self.u * inverse_det, slope, -self.height * inverse_det);
        let wy = q2.plus(q3).scale(Lanes::splat(simd, -1.0));
        let arm2 = q1.dot(q1) + q2.dot(q2) + q3.dot(q3);
        let arm_crossed2 = q1.crossed2(t, lever2) + q2.crossed2(t, lever2) + q3.crossed2(t, lever2);

        // The inverse wrist as a quadratic form, from the dual basis of z4, z5, z6.
        let g = one / self.sine5_squared;
        let g2 = g * g;
        let same = (self.dot46 * self.dot46 + 1.0) * g2;
        let mixed = self.dot46 * g2 * -2.0;
        let (x, y, z) =
            ([self.z4.x, self.z5.x, self.z6.x], [self.z4.y, self.z5.y, self.z6.y], [self.z4.z, self.z5.z, self.z6.z]);
        let qxx = form(same, mixed, x, x);
        let qyy = form(same, mixed, y, y);
        let qzz = form(same, mixed, z, z);
        let qxy = form(same, mixed, x, y);
        let qxz = form(same, mixed, x, z);
        let qyz = form(same, mixed, y, z);
        let spin2 = qyy * wy.dot(wy) + qyz * wy.dot(q1) * 2.0 + qzz * q1.dot(q1);
        let (cy, cz) = (wy.cross(t), q1.cross(t));
        let my = Vector { x: -cy.x, y: one - cy.y, z: -cy.z };
        let mz = Vector { x: -cz.x, y: -cz.y, z: one - cz.z };
        let rest2 = qxx + qyy * my.dot(my) + qzz * mz.dot(mz) + (qxy * my.x + qxz * mz.x + qyz * my.dot(mz)) * 2.0;
        let inverse_norm2 = (arm2 + spin2) * (length * length) + arm_crossed2 + rest2;
        Lanes::splat(simd, 6.0) / (norm2 * inverse_norm2).sqrt()
    }

    /// Torque of a unit force along a direction on the spring of each joint; `tool` is the tool centre point from axis
    /// 1, along x and y. m
    #[inline(always)]
    fn torques(&self, n: Vector<S>, tool: [Lanes<S>; 2]) -> [Lanes<S>; 6] {
        let [(r2x, r2z), (r3x, r3z)] = self.reaches();
        let turn = self.lever.cross(n);
        let mut torques = [
            tool[0] * n.y - tool[1] * n.x,
            r2x * n.z - r2z * n.x,
            r3x * n.z - r3z * n.x,
            self.z4.dot(turn),
            self.z5.dot(turn),
            self.z6.dot(turn),
        ];
        if self.linkage {
            torques[1] = torques[1] - torques[2];
        }
        torques
    }

    /// Velocity of the tool centre point per speed of the spring of each joint. m
    #[inline(always)]
    pub fn velocities(&self, simd: S, tool: [Lanes<S>; 2]) -> [Vector<S>; 6] {
        let [(r2x, r2z), (r3x, r3z)] = self.reaches();
        let (zero, t) = (Lanes::splat(simd, 0.0), self.lever);
        let mut velocities = [
            Vector { x: -tool[1], y: tool[0], z: zero },
            Vector { x: -r2z, y: zero, z: r2x },
            Vector { x: -r3z, y: zero, z: r3x },
            self.z4.cross(t),
            self.z5.cross(t),
            self.z6.cross(t),
        ];
        if self.linkage {
            velocities[1] = Vector { x: r3z - r2z, y: zero, z: r2x - r3x };
        }
        velocities
    }

    /// Torque of the load on the spring of each joint.
    #[inline(always)]
    pub fn axial_torques<const N: usize>(&self, load: &Load<S, N>, tool: [Lanes<S>; 2]) -> [Lanes<S>; 6] {
        let Load { force, moment, .. } = *load;
        let [(r2x, r2z), (r3x, r3z)] = self.reaches();
        let turn = self.lever.cross(force).plus(moment);
        let mut torques = [
            tool[0] * force.y - tool[1] * force.x + moment.z,
            r2x * force.z - r2z * force.x - moment.y,
            r3x * force.z - r3z * force.x - moment.y,
            self.z4.dot(turn),
            self.z5.dot(turn),
            self.z6.dot(turn),
        ];
        if self.linkage {
            torques[1] = torques[1] - torques[2];
        }
        torques
    }

    /// The score, the norm of the parts of K^-1 w along the scored directions, with the share of force errors; and what
    /// each joint adds to it per compliance.
    #[inline(always)]
    pub fn score<const PLAIN: bool, const N: usize>(
        &self,
        simd: S,
        lateral: f64,
        compliances: &[Lanes<S>; 6],
        load: &Load<S, N>,
        uncertainty: f64,
    ) -> (Lanes<S>, [Lanes<S>; 6]) {
        let t = self.lever;
        let tool = [self.forward + t.x, t.y + lateral];
        let directions = load.directions;
        // Torque on each joint: of a unit force along each direction, and of the wrench.
        let torque_f = self.axial_torques(load, tool);
        let zero = Lanes::splat(simd, 0.0);
        // What each joint adds to the part along each direction per compliance.
        let mut torque_n = [torque_f; N];
        let mut parts = torque_n;
        let mut deflection = [zero; N];
        for k in 0..N {
            torque_n[k] = self.torques(directions[k], tool);
            for j in 0..6 {
                parts[k][j] = torque_n[k][j] * torque_f[j];
                deflection[k] = deflection[k] + parts[k][j] * compliances[j];
            }
        }
        if N == 1 {
            let mut score = deflection[0].abs();
            if !PLAIN && uncertainty > 0.0 {
                let response = response(simd, &self.velocities(simd, tool), &torque_n[0], compliances);
                score = score + response.dot(response).sqrt() * uncertainty;
            }
            return (score, parts[0]);
        }
        let mut square = zero;
        for part in deflection {
            square = square + part * part;
        }
        let scored = square.sqrt();
        let mut score = scored;
        if !PLAIN {
            // Along the deflection itself, where there is one.
            let inverse = zero.less(scored).select(Lanes::splat(simd, 1.0) / scored, zero);
            let mut along = [zero; 6];
            for k in 0..N {
                for j in 0..6 {
                    along[j] = along[j] + parts[k][j] * (deflection[k] * inverse);
                }
            }
            parts[0] = along;
            if uncertainty > 0.0 {
                let velocities = self.velocities(simd, tool);
                let mut gains = [Vector { x: zero, y: zero, z: zero }; N];
                for k in 0..N {
                    gains[k] = response(simd, &velocities, &torque_n[k], compliances);
                }
                score = worst(simd, &gains, &deflection, square, uncertainty);
            }
        }
        (score, parts[0])
    }
}

/// The deflection under a unit force of these torques. m/N
#[inline(always)]
fn response<S: Simd>(
    simd: S,
    velocities: &[Vector<S>; 6],
    torques: &[Lanes<S>; 6],
    compliances: &[Lanes<S>; 6],
) -> Vector<S> {
    let zero = Lanes::splat(simd, 0.0);
    let mut response = Vector { x: zero, y: zero, z: zero };
    for j in 0..6 {
        response = response.plus(velocities[j].scale(torques[j] * compliances[j]));
    }
    response
}

/// The norm of the parts of a deflection under the worst error of the force of this size (N), from how the parts grow
/// with the force.
#[inline(always)]
pub(super) fn worst<S: Simd, const N: usize>(
    simd: S,
    gains: &[Vector<S>; N],
    parts: &[Lanes<S>; N],
    square: Lanes<S>,
    size: f64,
) -> Lanes<S> {
    let zero = Lanes::splat(simd, 0.0);
    let [mut xx, mut yy, mut zz, mut xy, mut xz, mut yz, mut x, mut y, mut z] = [zero; 9];
    for (gain, part) in gains.iter().zip(parts) {
        (xx, yy, zz) = (xx + gain.x * gain.x, yy + gain.y * gain.y, zz + gain.z * gain.z);
        (xy, xz, yz) = (xy + gain.x * gain.y, xz + gain.x * gain.z, yz + gain.y * gain.z);
        (x, y, z) = (x + gain.x * *part, y + gain.y * *part, z + gain.z * *part);
    }
    (square + worst_gains(simd, [xx, yy, zz, xy, xz, yz], [x, y, z], size)).sqrt()
}
