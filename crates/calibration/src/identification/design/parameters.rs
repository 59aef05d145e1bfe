//! The parameters of the arm in a design, and the information matrix of a configuration over them.
//!
//! There are at most eight for springs about the joint axes alone, and twenty for all: one compliance for each spring,
//! or, for the joint beside a compensator, the stiffnesses K_theta, K_GC and s_0 K_GC, in which the joint's stiffness
//! is linear (Klimchik et al. 2017, eq. 22). At an angle q with compliance c and row r(q) of that equation,
//! `dc = -c^2 r(q) d(K_theta, K_GC, s_0 K_GC)`: so the compliance at any angle, a level of the plan or not, follows
//! from the law that `fit` uses.

use super::super::elastic::Elastic;
use super::super::law::Law;
use super::super::model::Noise;
use super::super::normal_equations::FreeParameters;
use super::super::response::Response;
use super::super::sheet::LoadCase;
use super::super::springs::{AXES, FULL, FitModel, compliances_of};
use super::request::Request;
use nalgebra::{SMatrix, SVector, Vector3};
use stead_model::robot::Robot;

/// Most parameters of an arm with springs about its axes alone. The first are those of the springs in the order of
/// [`super::super::springs`], K_theta in place of the compliance beside a compensator; the last two are K_GC and s_0
/// K_GC. Code is generic over the number of parameters, this one or [`FULL_PARAMETERS`].
pub const MAX_PARAMETERS: usize = AXES + 2;
/// Most parameters of an arm with springs about three directions of every joint.
pub const FULL_PARAMETERS: usize = FULL + 2;
/// Information matrix: products of derivatives by the parameters of the arm.
pub type InformationMatrix<const P: usize = MAX_PARAMETERS> = SMatrix<f64, P, P>;

/// The compliances of an arm as functions of its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Parameters<'a> {
    robot: &'a Robot,
    varying: Option<(usize, Law)>,
}

impl<'a> Parameters<'a> {
    /// Of an arm and the law of its varying joint.
    pub fn new(robot: &'a Robot, varying: Option<(usize, Law)>) -> Self {
        Self { robot, varying }
    }

    /// Which parameters there are, and which of them are free where these compliances are.
    pub fn free<const N: usize, const P: usize>(&self, free: &FreeParameters<N>) -> [bool; P] {
        let is_spring = matches!(self.varying, Some((_, Law::Spring(_))));
        let group = free.groups.iter().any(|free| *free);
        std::array::from_fn(|number| match self.varying {
            Some((joint, _)) if number == joint => group,
            _ if number < N => free.joints[number],
            _ => is_spring && group,
        })
    }

    /// Derivatives of the compliance of a spring, by its column, at the angle of its joint (rad).
    pub fn row<const P: usize>(&self, column: usize, angle: f64) -> SVector<f64, P> {
        let mut row = SVector::zeros();
        match self.varying {
            Some((varying, Law::Spring(geometry))) if varying == column => {
                let compliance = self.robot.joints()[column].compliance_at(angle);
                let by_stiffness = -geometry.row(angle) * (compliance * compliance);
                row[column] = by_stiffness.x;
                row[P - 2] = by_stiffness.y;
                row[P - 1] = by_stiffness.z;
            }
            _ => row[column] = 1.0,
        }
        row
    }

    /// Those of all compliances in a configuration, in rows.
    fn derivatives<const N: usize, const P: usize>(&self, theta: &[f64; 6]) -> SMatrix<f64, N, P> {
        let mut all = SMatrix::<f64, N, P>::zeros();
        for column in 0..N {
            // Only springs about the axes have a law over the angle of their joint.
            let angle = theta.get(column).copied().unwrap_or_default();
            all.set_row(column, &self.row::<P>(column, angle).transpose());
        }
        all
    }

    /// Derivatives of the deflection of some points of the flange (m) under a load at another, in a unit.
    fn moved<const N: usize, const P: usize>(
        &self,
        points: &[Vector3<f64>],
        load_point: &Vector3<f64>,
        load_case: &LoadCase,
        unit: f64,
    ) -> Vec<SMatrix<f64, 3, P>> {
        let LoadCase { theta, force, moment } = load_case;
        let arm = Elastic::<N>::unloaded(self.robot, theta);
        let at = |place| arm.base_from_flange.point(place);
        let load = at(load_point);
        let derivatives = self.derivatives::<N, P>(theta);
        let moved = |point| Response::new(&arm, &at(point), &load, force, moment).linear * unit * derivatives;
        points.iter().map(moved).collect()
    }

    /// The same with the springs of so many parameters.
    fn moved_by<const P: usize>(
        &self,
        points: &[Vector3<f64>],
        load_point: &Vector3<f64>,
        load_case: &LoadCase,
        unit: f64,
    ) -> Vec<SMatrix<f64, 3, P>> {
        if P == FULL_PARAMETERS {
            return self.moved::<FULL, P>(points, load_point, load_case, unit);
        }
        self.moved::<AXES, P>(points, load_point, load_case, unit)
    }

    /// Information matrix of a configuration: the normal matrix of its readings, for equations of unit variance.
    pub fn information<const P: usize>(&self, request: &Request, load_case: &LoadCase) -> InformationMatrix<P> {
        let noise = Noise { position: request.noise, orientation: 1.0 };
        let designs = self.moved_by::<P>(&request.points, &request.load_point, load_case, noise.weights().0);
        designs.iter().fold(InformationMatrix::zeros(), |sum, design| sum + design.tr_mul(design))
    }

    /// Q: mean over the tests of the products of the derivatives of the deflection of the tip. `trace(Q C)` is the mean
    /// square error of the deflection where C is the covariance of the parameters. m^2
    pub fn weighting<const P: usize>(&self, request: &Request, tests: &[LoadCase]) -> InformationMatrix<P> {
        let sum = tests.iter().fold(InformationMatrix::zeros(), |sum, test| {
            let by_numbers = self.moved_by::<P>(&[request.tip], &request.tip, test, 1.0);
            by_numbers.iter().fold(sum, |sum, tip| sum + tip.tr_mul(tip))
        });
        sum / tests.len().max(1) as f64
    }

    /// Root of the mean square of the deflection of the tip in the tests, by the arm as it is known. m
    pub fn deflection(&self, request: &Request, tests: &[LoadCase]) -> f64 {
        let square = |test: &LoadCase| match request.model {
            FitModel::Axes => self.tip_moved::<AXES>(request, test).norm_squared(),
            FitModel::Full => self.tip_moved::<FULL>(request, test).norm_squared(),
        };
        libm::sqrt(tests.iter().map(square).sum::<f64>() / tests.len().max(1) as f64)
    }

    fn tip_moved<const N: usize>(&self, request: &Request, test: &LoadCase) -> Vector3<f64> {
        let arm = Elastic::<N>::unloaded(self.robot, &test.theta);
        let tip = arm.base_from_flange.point(&request.tip);
        Response::new(&arm, &tip, &tip, &test.force, &test.moment).linear * compliances_of::<N>(self.robot, &test.theta)
    }
}
