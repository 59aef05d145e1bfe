//! The parameters of the arm in a design, and the information matrix of a configuration over them.
//!
//! There are at most eight: one compliance for each joint, or, for the joint beside a compensator, the stiffnesses
//! K_theta, K_GC and s_0 K_GC, in which the joint's stiffness is linear (Klimchik et al. 2017, eq. 22). At an angle q
//! with compliance c and row r(q) of that equation, `dc = -c^2 r(q) d(K_theta, K_GC, s_0 K_GC)`: so the compliance at
//! any angle, a level of the plan or not, follows from the law that `fit` uses.

use super::super::law::Law;
use super::super::model::Noise;
use super::super::normal_equations::FreeParameters;
use super::super::response::Response;
use super::super::sheet::LoadCase;
use super::request::Request;
use nalgebra::{SMatrix, SVector};
use stead_model::robot::{Frames, Robot};

/// Most parameters of an arm. The first six are those of the joints, K_theta in place of the compliance beside a
/// compensator; then K_GC and s_0 K_GC.
pub const MAX_PARAMETERS: usize = 8;
/// Information matrix: products of derivatives by the parameters of the arm.
pub type InformationMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;
/// Derivatives of the six compliances, in rows, by the parameters of the arm.
pub type Derivatives = SMatrix<f64, 6, MAX_PARAMETERS>;

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
    pub fn free(&self, free: &FreeParameters) -> [bool; MAX_PARAMETERS] {
        let is_spring = matches!(self.varying, Some((_, Law::Spring(_))));
        let group = free.groups.iter().any(|free| *free);
        std::array::from_fn(|number| match self.varying {
            Some((joint, _)) if number == joint => group,
            _ if number < 6 => free.joints[number],
            _ => is_spring && group,
        })
    }

    /// Derivatives of the compliance of a joint (from 0) at its angle (rad).
    pub fn row(&self, joint: usize, angle: f64) -> SVector<f64, MAX_PARAMETERS> {
        let mut row = SVector::zeros();
        match self.varying {
            Some((varying, Law::Spring(geometry))) if varying == joint => {
                let compliance = self.robot.joints()[joint].compliance_at(angle);
                let by_stiffness = -geometry.row(angle) * (compliance * compliance);
                row[joint] = by_stiffness.x;
                row[6] = by_stiffness.y;
                row[7] = by_stiffness.z;
            }
            _ => row[joint] = 1.0,
        }
        row
    }

    /// Those of all compliances in a configuration.
    pub fn derivatives(&self, theta: &[f64; 6]) -> Derivatives {
        let mut all = Derivatives::zeros();
        for joint in 0..6 {
            all.set_row(joint, &self.row(joint, theta[joint]).transpose());
        }
        all
    }

    /// Information matrix of a configuration: the normal matrix of its readings, for equations of unit variance.
    pub fn information(&self, request: &Request, LoadCase { theta, force, moment }: &LoadCase) -> InformationMatrix {
        let frames = Frames::new(self.robot, theta);
        let at = |place| frames.base_from_flange.point(place);
        let load = at(&request.load_point);
        let derivatives = self.derivatives(theta);
        let noise = Noise { position: request.noise, orientation: 1.0 };
        let point = |point| {
            let response = Response::new(&frames, &at(point), &load, force, moment);
            let design = response.linear * noise.weights().0 * derivatives;
            design.tr_mul(&design)
        };
        request.points.iter().map(point).fold(InformationMatrix::zeros(), |sum, part| sum + part)
    }

    /// Derivatives of the deflection of the tip in a test.
    pub fn deflection(&self, request: &Request, test: &LoadCase) -> SMatrix<f64, 3, MAX_PARAMETERS> {
        let frames = Frames::new(self.robot, &test.theta);
        let tip = frames.base_from_flange.point(&request.tip);
        let response = Response::new(&frames, &tip, &tip, &test.force, &test.moment);
        response.linear * self.derivatives(&test.theta)
    }

    /// Q: mean over the tests of the products of the derivatives of the deflection. `trace(Q C)` is the mean square
    /// error of the deflection where C is the covariance of the parameters. m^2
    pub fn weighting(&self, request: &Request, tests: &[LoadCase]) -> InformationMatrix {
        let sum = tests.iter().fold(InformationMatrix::zeros(), |sum, test| {
            let by_numbers = self.deflection(request, test);
            sum + by_numbers.tr_mul(&by_numbers)
        });
        sum / tests.len().max(1) as f64
    }
}
