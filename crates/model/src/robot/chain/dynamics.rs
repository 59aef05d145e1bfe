//! Mass matrix, inverse dynamics, gravity and energy of a chain in one configuration.

use super::{Chain, Posed};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// A rigid body as seen from a point at rest in base coordinates: mass, first moment and inertia about that point.
#[derive(Clone, Copy)]
struct SpatialInertia {
    mass: f64,
    moment: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl SpatialInertia {
    const NONE: Self = Self {
        mass: 0.0,
        moment: Vector3::new(0.0, 0.0, 0.0),
        inertia: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.moment += other.moment;
        self.inertia += other.inertia;
    }

    /// Angular (about the point) and linear momentum of a motion: angular velocity, velocity of the body's point there.
    fn momentum(&self, angular: &Vector3<f64>, linear: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (self.inertia * angular + self.moment.cross(linear), linear * self.mass - self.moment.cross(angular))
    }
}

impl<const N: usize> Posed<N> {
    /// The point about which spatial vectors are taken: near the light links, where rounding would tell most.
    fn pole(&self) -> Vector3<f64> {
        if N == 0 { Vector3::zeros() } else { self.origins[N - 1] }
    }

    fn spatial_inertia(&self, chain: &Chain<N>, j: usize, pole: &Vector3<f64>) -> Option<SpatialInertia> {
        let body = chain.links[j].body.as_ref()?;
        let rotation = &self.rotations[j];
        let mass = body.mass();
        let centre = self.origins[j] - pole + rotation * body.centre();
        let moment = centre * mass;
        let mut inertia = rotation * body.inertia() * rotation.transpose();
        let square = moment.dot(&centre);
        for row in 0..3 {
            inertia[(row, row)] += square;
            for column in 0..3 {
                inertia[(row, column)] -= moment[row] * centre[column];
            }
        }
        Some(SpatialInertia { mass, moment, inertia })
    }

    /// The mass matrix by composite rigid bodies (Featherstone 2008, table 6.2): kg m^2.
    pub fn mass_matrix(&self, chain: &Chain<N>) -> SMatrix<f64, N, N> {
        let pole = self.pole();
        let mut matrix = SMatrix::zeros();
        let mut composite = SpatialInertia::NONE;
        for j in (0..N).rev() {
            if let Some(body) = self.spatial_inertia(chain, j, &pole) {
                composite.add(&body);
            }
            let axis = &self.axes[j];
            let (angular, linear) = composite.momentum(axis, &(self.origins[j] - pole).cross(axis));
            for i in 0..=j {
                let other = &self.axes[i];
                let entry = other.dot(&angular) + (self.origins[i] - pole).cross(other).dot(&linear);
                matrix[(i, j)] = entry;
                matrix[(j, i)] = entry;
            }
        }
        matrix
    }

    /// Joint torques (N m) that joint speeds (rad/s) and accelerations (rad/s^2) need in a field of gravity
    /// (acceleration of free fall, m/s^2): `M qdd + C(q, qd) qd + g(q)`, by recursive Newton-Euler.
    pub fn inverse_dynamics(
        &self,
        chain: &Chain<N>,
        speed: &SVector<f64, N>,
        acceleration: &SVector<f64, N>,
        free_fall: &Vector3<f64>,
    ) -> SVector<f64, N> {
        let pole = self.pole();
        // Motion of the body's point at the pole, and its rate of change there, angular and linear.
        let (mut spin, mut velocity) = (Vector3::zeros(), Vector3::zeros());
        // To be held against gravity is to be moved upwards.
        let (mut spin_rate, mut velocity_rate) = (Vector3::zeros(), -free_fall);
        let mut loads = [None; N];
        let levers: [_; N] = std::array::from_fn(|j| (self.origins[j] - pole).cross(&self.axes[j]));
        for j in 0..N {
            let (axis, lever) = (&self.axes[j], &levers[j]);
            // The joint's screw moves with the body before it.
            spin_rate += axis * acceleration[j] + spin.cross(axis) * speed[j];
            velocity_rate += lever * acceleration[j] + (spin.cross(lever) + velocity.cross(axis)) * speed[j];
            spin += axis * speed[j];
            velocity += lever * speed[j];
            if let Some(body) = self.spatial_inertia(chain, j, &pole) {
                let (moment, force) = body.momentum(&spin_rate, &velocity_rate);
                let (angular, linear) = body.momentum(&spin, &velocity);
                let moment = moment + spin.cross(&angular) + velocity.cross(&linear);
                loads[j] = Some((moment, force + spin.cross(&linear)));
            }
        }
        let mut torques = SVector::zeros();
        let (mut moment, mut force) = (Vector3::zeros(), Vector3::zeros());
        for j in (0..N).rev() {
            if let Some((m, f)) = &loads[j] {
                moment += m;
                force += f;
            }
            torques[j] = self.axes[j].dot(&moment) + levers[j].dot(&force);
        }
        torques
    }

    /// The first moment about the origin of each joint of all that it carries. kg m
    fn carried(&self, chain: &Chain<N>) -> [Vector3<f64>; N] {
        let pole = self.pole();
        let (mut mass, mut moment) = (0.0, Vector3::zeros());
        let mut carried = [Vector3::zeros(); N];
        for j in (0..N).rev() {
            if let Some(body) = &chain.links[j].body {
                mass += body.mass();
                moment += (self.origins[j] - pole + self.rotations[j] * body.centre()) * body.mass();
            }
            carried[j] = moment - (self.origins[j] - pole) * mass;
        }
        carried
    }

    /// Joint torques (N m) that hold the chain against gravity at rest: the slope of the potential energy.
    pub fn gravity(&self, chain: &Chain<N>) -> SVector<f64, N> {
        let carried = self.carried(chain);
        SVector::from_fn(|j, _| -self.axes[j].cross(&carried[j]).dot(&chain.gravity))
    }

    /// How [`Posed::gravity`] changes with the angles: its Jacobian, which is symmetric. N m/rad
    pub fn gravity_stiffness(&self, chain: &Chain<N>) -> SMatrix<f64, N, N> {
        let mut stiffness = SMatrix::zeros();
        for (j, carried) in self.carried(chain).iter().enumerate() {
            let about = self.axes[j].cross(carried);
            for i in 0..=j {
                let entry = -self.axes[i].cross(&about).dot(&chain.gravity);
                stiffness[(i, j)] = entry;
                stiffness[(j, i)] = entry;
            }
        }
        stiffness
    }

    /// Potential energy in the field of gravity, from the base's origin up. J
    #[cfg(any(test, feature = "testing"))]
    pub fn potential(&self, chain: &Chain<N>) -> f64 {
        let bodies = chain.links.iter().zip(self.origins.iter().zip(&self.rotations));
        bodies
            .filter_map(|(link, (origin, rotation))| {
                let body = link.body.as_ref()?;
                Some(-body.mass() * chain.gravity.dot(&(origin + rotation * body.centre())))
            })
            .sum()
    }
}
