//! A second formulation of the same mechanics: body by body, from homogeneous matrices as Taylor series in time.

use super::*;
use nalgebra::{Matrix4, vector};
use proptest::prelude::*;

impl<const N: usize> Posed<N> {
    /// How the tip turns per unit speed of each joint: angular velocity, one column a joint.
    pub fn rotation_jacobian(&self) -> SMatrix<f64, 3, N> {
        SMatrix::from_columns(&self.axes)
    }

    /// Velocity of the tip at joint speeds `speed` (rad/s). m/s
    pub fn tip_velocity(&self, speed: &SVector<f64, N>) -> Vector3<f64> {
        let tip = self.tip();
        let mut velocity = Vector3::zeros();
        for j in 0..N {
            velocity += self.axes[j].cross(&(tip - self.origins[j])) * speed[j];
        }
        velocity
    }
}

/// A matrix over time: value, first and second derivative.
#[derive(Clone, Copy)]
pub struct MotionHistory(pub [Matrix4<f64>; 3]);

impl MotionHistory {
    fn then(&self, other: &Self) -> Self {
        let ([a, da, dda], [b, db, ddb]) = (&self.0, &other.0);
        Self([a * b, da * b + a * db, dda * b + da * db * 2.0 + a * ddb])
    }
}

/// What each joint's frame does at angles, speeds and accelerations: products of exponentials.
pub fn motion_histories<const N: usize>(
    chain: &Chain<N>,
    q: &SVector<f64, N>,
    speed: &SVector<f64, N>,
    acceleration: &SVector<f64, N>,
) -> Vec<MotionHistory> {
    let mut course = MotionHistory([Matrix4::identity(), Matrix4::zeros(), Matrix4::zeros()]);
    let mut all = vec![];
    for (j, joint) in chain.links.iter().enumerate() {
        let axis = match joint.axis {
            Axis::X => Vector3::x(),
            Axis::Y => Vector3::y(),
            Axis::Z => Vector3::z(),
        };
        let cross = axis.cross_matrix().to_homogeneous() - Matrix4::from_diagonal(&vector![0.0, 0.0, 0.0, 1.0]);
        // Rodrigues: exp(cross q), and its derivatives, which commute with it.
        let (s, c) = libm::sincos(q[j]);
        let turn = Matrix4::identity() + cross * s + cross * cross * (1.0 - c);
        let mut placed = joint.turn.unwrap_or_else(nalgebra::Matrix3::identity).to_homogeneous();
        placed.fixed_view_mut::<3, 1>(0, 3).copy_from(&joint.shift);
        let first = cross * turn * speed[j];
        let second = cross * cross * turn * speed[j] * speed[j] + cross * turn * acceleration[j];
        course = course.then(&MotionHistory([placed * turn, placed * first, placed * second]));
        all.push(course);
    }
    all
}

/// Torques body by body: momentum of each over time, and its Jacobian (d'Alembert), gravity included.
pub fn torques_by_bodies<const N: usize>(
    chain: &Chain<N>,
    q: &SVector<f64, N>,
    speed: &SVector<f64, N>,
    acceleration: &SVector<f64, N>,
) -> SVector<f64, N> {
    let zero = SVector::zeros();
    let motion_histories = motion_histories(chain, q, speed, acceleration);
    let mut torques = SVector::zeros();
    for (b, joint) in chain.links.iter().enumerate() {
        let Some(body) = &joint.body else { continue };
        let [_, _, dd] = motion_histories[b].0;
        let [rotation, rate, rate2] = motion_histories[b].0.map(|m| m.fixed_view::<3, 3>(0, 0).into_owned());
        let centre = body.centre().push(1.0);
        let force = ((dd * centre).xyz() - chain.free_fall()) * body.mass();
        let spin = of_cross(&(rate * rotation.transpose()));
        let spin_rate = of_cross(&(rate2 * rotation.transpose() + rate * rate.transpose()));
        let inertia = rotation * body.inertia() * rotation.transpose();
        let moment = inertia * spin_rate + spin.cross(&(inertia * spin));
        for i in 0..=b {
            let mut unit = zero;
            unit[i] = 1.0;
            let [_, d, _] = super::testing::motion_histories(chain, q, &unit, &zero)[b].0;
            let turned = of_cross(&(d.fixed_view::<3, 3>(0, 0) * rotation.transpose()));
            torques[i] += (d * centre).xyz().dot(&force) + turned.dot(&moment);
        }
    }
    torques
}

fn of_cross(matrix: &Matrix3<f64>) -> Vector3<f64> {
    vector![matrix.m32 - matrix.m23, matrix.m13 - matrix.m31, matrix.m21 - matrix.m12] / 2.0
}

/// The mass matrix as a sum over bodies: `m J_v^T J_v + J_w^T I J_w`.
pub fn mass_by_bodies<const N: usize>(chain: &Chain<N>, q: &SVector<f64, N>) -> SMatrix<f64, N, N> {
    let zero = SVector::zeros();
    let mut matrix = SMatrix::zeros();
    for (b, joint) in chain.links.iter().enumerate() {
        let Some(body) = &joint.body else { continue };
        let (mut linear, mut angular) = (SMatrix::<f64, 3, N>::zeros(), SMatrix::<f64, 3, N>::zeros());
        let mut rotation = Matrix3::identity();
        for i in 0..=b {
            let mut unit = zero;
            unit[i] = 1.0;
            let [value, d, _] = motion_histories(chain, q, &unit, &zero)[b].0;
            rotation = value.fixed_view::<3, 3>(0, 0).into_owned();
            linear.set_column(i, &(d * body.centre().push(1.0)).xyz());
            angular.set_column(i, &of_cross(&(d.fixed_view::<3, 3>(0, 0) * rotation.transpose())));
        }
        let inertia = rotation * body.inertia() * rotation.transpose();
        matrix += linear.transpose() * linear * body.mass() + angular.transpose() * inertia * angular;
    }
    matrix
}

/// Chains of any kind: random displacements, directions, axes and bodies, some joints without.
pub fn chain<const N: usize>() -> impl Strategy<Value = Chain<N>> {
    let joint = (
        prop::array::uniform3(-3.0..3.0_f64),
        prop::array::uniform3(-1.0..1.0_f64),
        0..3_usize,
        prop::option::weighted(0.7, (0.1..50.0_f64, prop::array::uniform3(-0.5..0.5_f64))),
        prop::array::uniform3(0.01..1.0_f64),
        prop::array::uniform3(-3.0..3.0_f64),
    );
    let joint = joint.prop_map(|(turn, shift, axis, body, moments, tilt)| {
        let rotation = *nalgebra::Rotation3::from_euler_angles(turn[0], turn[1], turn[2]).matrix();
        let tilt = *nalgebra::Rotation3::from_euler_angles(tilt[0], tilt[1], tilt[2]).matrix();
        // Moments of a point cloud: sums of two of three positive numbers.
        let [a, b, c] = moments;
        let inertia = tilt * Matrix3::from_diagonal(&vector![b + c, c + a, a + b]) * tilt.transpose();
        let body = body.map(|(mass, centre)| Inertial::new(mass, centre.into(), inertia).unwrap());
        Link::new(Pose { rotation, translation: shift.into() }, [Axis::X, Axis::Y, Axis::Z][axis], body)
    });
    prop::collection::vec(joint, N).prop_map(|joints| {
        let tip = Pose { translation: vector![0.1, -0.2, 0.3], ..Pose::identity() };
        Chain::new(joints.try_into().unwrap(), tip).with_gravity(vector![1.0, -2.0, -9.81])
    })
}

/// A vector of `N` numbers in a range.
pub fn vector_in<const N: usize>(size: f64) -> impl Strategy<Value = SVector<f64, N>> {
    prop::collection::vec(-size..size, N).prop_map(|numbers| SVector::from_column_slice(&numbers))
}
