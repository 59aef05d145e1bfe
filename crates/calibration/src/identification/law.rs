//! From the compliances at distinct angles to the parameters of the arm: one constant compliance for each joint, or
//! compliance, spring stiffness and free length where a compensator acts on a joint.
//!
//! The compliances at the distinct angles of a joint become stiffnesses, which are linear in (K_theta, K_GC, s_0 K_GC)
//! (Klimchik et al. 2017, eq. 21 and 22, with the sign of its eq. 14 corrected), weighted by their covariance. From
//! there Gauss-Newton on the compliances themselves, together with those of the other joints, gives the least sum of
//! squares over all readings: the errors are normal in the compliances, not in their inverses.

use super::inverse::{MIN_PIVOT, scaled_inverse};
use super::normal_equations::{NormalEquations, Solution};
use super::spring::{Geometry, spring_start};
use super::springs::{column, spring};
use nalgebra::{DMatrix, DVector, SVector, Vector3};
use serde::Serialize;
use std::fmt;
use stead_model::robot::{About, Spring};

/// How the compliance of the varying joint depends on its angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Law {
    /// Not at all.
    Constant,
    /// By a compensator of known geometry.
    Spring(Geometry),
}

/// A parameter of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ArmParameter {
    /// Which joint, from 0.
    pub joint: usize,
    /// Which of its quantities.
    pub quantity: Quantity,
}

impl ArmParameter {
    /// The compliance of a spring.
    pub fn of_spring(spring: Spring) -> Self {
        let quantity = match spring.about {
            About::Z => Quantity::Compliance,
            About::X => Quantity::AboutX,
            About::Y => Quantity::AboutY,
        };
        Self { joint: spring.joint, quantity }
    }

    /// The spring whose compliance it is, or of whose law.
    pub fn spring(&self) -> Spring {
        let about = match self.quantity {
            Quantity::Compliance | Quantity::SpringStiffness | Quantity::FreeLength => About::Z,
            Quantity::AboutX => About::X,
            Quantity::AboutY => About::Y,
        };
        Spring { joint: self.joint, about }
    }

    /// The column of that spring in the equations: see [`super::springs`].
    pub fn column(&self) -> usize {
        column(self.spring())
    }
}

impl fmt::Display for ArmParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.joint + 1;
        match self.quantity {
            Quantity::Compliance => write!(f, "the compliance of joint {number}"),
            Quantity::SpringStiffness => write!(f, "the stiffness of the spring beside joint {number}"),
            Quantity::FreeLength => write!(f, "the free length of the spring beside joint {number}"),
            Quantity::AboutX => write!(f, "the compliance of joint {number} about x"),
            Quantity::AboutY => write!(f, "the compliance of joint {number} about y"),
        }
    }
}

/// Which quantity of a joint a parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Quantity {
    /// Compliance of the joint, without its compensator. rad/(N m)
    Compliance,
    /// Stiffness of the spring beside it. N/m
    SpringStiffness,
    /// Length of that spring without load. m
    FreeLength,
    /// Compliance about x of the frame of the row, normal to the joint axis. rad/(N m)
    AboutX,
    /// Compliance about y of the frame of the row, normal to the joint axis. rad/(N m)
    AboutY,
}

/// The parameters of the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmFit<const N: usize> {
    /// What they are, joint by joint.
    pub parameters: Vec<ArmParameter>,
    /// Their values, SI.
    pub values: DVector<f64>,
    /// Their covariance for equations of unit variance, SI.
    pub covariance: DMatrix<f64>,
    /// The compliances of the springs that do not vary, free or held. rad/(N m)
    pub joints: SVector<f64, N>,
    /// At each distinct angle the compliance by the law, and its derivatives by the values. rad/(N m)
    pub groups: Vec<(f64, DVector<f64>)>,
}

/// Why the compensator is not identifiable from the compliances at the distinct angles.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LawError {
    /// Fewer distinct angles than unknowns.
    #[error("{found} distinct angles of joint {joint} do not determine the three unknowns of a compensator")]
    TooFewAngles {
        /// How many there are.
        found: usize,
        /// Number of the joint, from 1.
        joint: usize,
    },
    /// The angles are too much alike.
    #[error(
        "at the distinct angles of joint {joint} its own stiffness and its compensator's are not identifiable separately"
    )]
    Unidentifiable {
        /// Number of the joint, from 1.
        joint: usize,
    },
    /// The best fit is no compensator.
    #[error(
        "joint {joint}: {what} comes out as {value:.4} {unit}, which is not above zero: the compensator is not identifiable from \
         the distinct angles; take more of them, wider apart, or leave out the table [compensator]"
    )]
    NoSpring {
        /// Number of the joint, from 1.
        joint: usize,
        /// Which number.
        what: &'static str,
        /// What it comes out as.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
}

const STEPS: usize = 60;

/// Fits the parameters of the arm to the normal equations. `joints` says which springs are free, `by_angle` is the
/// estimate with one compliance for each distinct angle, at `angles` in rad.
///
/// # Errors
/// [`LawError`] where the law is a spring that is not identifiable from the angles.
pub fn fit<const N: usize>(
    normal: &NormalEquations<N>,
    joints: [bool; N],
    by_angle: &Solution<N>,
    angles: &[f64],
    law: Law,
) -> Result<ArmFit<N>, LawError> {
    let fit = Fit::new(normal, joints, angles, law);
    let number = normal.varying.map_or(0, |joint| joint + 1);
    let unidentifiable = LawError::Unidentifiable { joint: number };
    let start = match (normal.varying, law) {
        (None, _) => vec![],
        (Some(_), Law::Constant) => vec![by_angle.groups.first().copied().unwrap_or_default()],
        (Some(_), Law::Spring(_)) if angles.len() < 3 => {
            return Err(LawError::TooFewAngles { found: angles.len(), joint: number });
        }
        (Some(_), Law::Spring(geometry)) => {
            let rows: Vec<_> = angles.iter().map(|angle| geometry.row(*angle)).collect();
            spring_start(normal, joints, by_angle, &rows).ok_or(unidentifiable)?.iter().copied().collect()
        }
    };
    let mut iterate = Iterate { joints: by_angle.joints, law: start };
    for _ in 0..STEPS {
        let step = fit.step(&iterate).ok_or(unidentifiable)?;
        let next = fit.moved(&iterate, &step.0).ok_or(unidentifiable)?;
        let change = step.0.component_div(&step.1).amax();
        iterate = next;
        if change < 1e-14 {
            break;
        }
    }
    fit.finish(iterate, number, unidentifiable)
}

struct Iterate<const N: usize> {
    joints: SVector<f64, N>,
    /// Compliance, or (K_theta, K_GC, s_0 K_GC), or nothing.
    law: Vec<f64>,
}

struct Fit<'a, const N: usize> {
    normal: &'a NormalEquations<N>,
    law: Law,
    rows: Vec<Vector3<f64>>,
    parameters: Vec<ArmParameter>,
}

impl<'a, const N: usize> Fit<'a, N> {
    fn new(normal: &'a NormalEquations<N>, joints: [bool; N], angles: &[f64], law: Law) -> Self {
        let mut parameters = Vec::new();
        for number in 0..N {
            let first = ArmParameter::of_spring(spring(number));
            let more: &[Quantity] = match (normal.varying == Some(number), law) {
                (false, _) if !joints[number] => continue,
                (false, _) | (true, Law::Constant) => &[],
                (true, Law::Spring(_)) => &[Quantity::SpringStiffness, Quantity::FreeLength],
            };
            parameters.push(first);
            parameters.extend(more.iter().map(|quantity| ArmParameter { quantity: *quantity, ..first }));
        }
        let row = |angle: &f64| match law {
            Law::Constant => Vector3::zeros(),
            Law::Spring(geometry) => geometry.row(*angle),
        };
        Self { normal, law, rows: angles.iter().map(row).collect(), parameters }
    }

    /// Which number of the law a parameter is.
    fn place(&self, parameter: &ArmParameter) -> Option<usize> {
        (self.normal.varying == Some(parameter.column())).then_some(match parameter.quantity {
            Quantity::Compliance | Quantity::AboutX | Quantity::AboutY => 0,
            Quantity::SpringStiffness => 1,
            Quantity::FreeLength => 2,
        })
    }

    /// Compliance at a distinct angle and its derivatives by the numbers of the law.
    fn compliance(&self, law: &[f64], group: usize) -> (f64, Vector3<f64>) {
        match (self.law, law) {
            (Law::Spring(_), [joint, spring, pull]) => {
                let row = self.rows[group];
                let stiffness = row.dot(&Vector3::new(*joint, *spring, *pull));
                (1.0 / stiffness, -row / (stiffness * stiffness))
            }
            _ => (law.first().copied().unwrap_or_default(), Vector3::x()),
        }
    }

    /// Normal matrix and gradient of the sum of squares in the parameters.
    fn equations(&self, iterate: &Iterate<N>) -> (DMatrix<f64>, DVector<f64>) {
        let size = self.parameters.len();
        let normal = self.normal;
        let own: Vec<Option<usize>> = self.parameters.iter().map(|parameter| self.place(parameter)).collect();
        let joint = |index: usize| self.parameters[index].column();
        let mut matrix = DMatrix::zeros(size, size);
        let mut gradient = DVector::zeros(size);
        let mut shared_gradient = normal.shared_rhs - normal.shared * iterate.joints;
        for (index, group) in normal.groups.iter().enumerate() {
            let (compliance, slope) = self.compliance(&iterate.law, index);
            shared_gradient -= group.coupling * compliance;
            let rest = group.rhs - group.coupling.dot(&iterate.joints) - group.diagonal * compliance;
            for a in 0..size {
                let Some(place) = own[a] else { continue };
                gradient[a] += slope[place] * rest;
                for b in 0..size {
                    matrix[(a, b)] += slope[place]
                        * own[b].map_or_else(|| group.coupling[joint(b)], |other| slope[other] * group.diagonal);
                }
            }
        }
        for a in (0..size).filter(|a| own[*a].is_none()) {
            gradient[a] = shared_gradient[joint(a)];
            for b in 0..size {
                matrix[(a, b)] = match own[b] {
                    None => normal.shared[(joint(a), joint(b))],
                    Some(_) => matrix[(b, a)],
                };
            }
        }
        (matrix, gradient)
    }

    /// A Gauss-Newton step, and the size of each parameter.
    fn step(&self, iterate: &Iterate<N>) -> Option<(DVector<f64>, DVector<f64>)> {
        let (matrix, gradient) = self.equations(iterate);
        let step = scaled_inverse(&matrix, MIN_PIVOT)? * gradient;
        let size = |parameter: &ArmParameter| match self.place(parameter) {
            Some(place) => iterate.law[place].abs().max(f64::MIN_POSITIVE),
            None => iterate.joints[parameter.column()].abs().max(f64::MIN_POSITIVE),
        };
        let sizes = DVector::from_iterator(self.parameters.len(), self.parameters.iter().map(size));
        step.iter().all(|value| value.is_finite()).then_some((step, sizes))
    }

    /// The state after as much of a step as leaves every stiffness above zero.
    fn moved(&self, iterate: &Iterate<N>, step: &DVector<f64>) -> Option<Iterate<N>> {
        let mut part = 1.0;
        while part > 1e-6 {
            let mut next = Iterate { joints: iterate.joints, law: iterate.law.clone() };
            for (parameter, change) in self.parameters.iter().zip(step.iter()) {
                match self.place(parameter) {
                    Some(place) => next.law[place] += part * change,
                    None => next.joints[parameter.column()] += part * change,
                }
            }
            let is_spring = matches!(self.law, Law::Spring(_)) && next.law.len() == 3;
            if !is_spring || (0..self.rows.len()).all(|group| self.compliance(&next.law, group).0 > 0.0) {
                return Some(next);
            }
            part /= 2.0;
        }
        None
    }

    /// From stiffnesses to the numbers that robot files have.
    fn finish(&self, iterate: Iterate<N>, number: usize, unidentifiable: LawError) -> Result<ArmFit<N>, LawError> {
        let (matrix, _) = self.equations(&iterate);
        let covariance = scaled_inverse(&matrix, MIN_PIVOT).ok_or(unidentifiable)?;
        let size = self.parameters.len();
        let mut change = DMatrix::<f64>::identity(size, size);
        let mut values = DVector::zeros(size);
        for (index, parameter) in self.parameters.iter().enumerate() {
            values[index] = match (self.place(parameter), self.law, &iterate.law[..]) {
                (None, ..) => iterate.joints[parameter.column()],
                (Some(0), Law::Spring(_), [stiffness, ..]) => {
                    change[(index, index)] = -1.0 / (stiffness * stiffness);
                    1.0 / stiffness
                }
                (Some(2), Law::Spring(_), [_, spring, pull]) => {
                    change[(index, index)] = 1.0 / spring;
                    change[(index, index - 1)] = -pull / (spring * spring);
                    pull / spring
                }
                (Some(place), ..) => iterate.law[place],
            };
        }
        if let (Law::Spring(_), [stiffness, spring, pull]) = (self.law, &iterate.law[..]) {
            let length_mm = pull / spring * 1e3;
            let wrong = |what, value, unit| LawError::NoSpring { joint: number, what, value, unit };
            if *stiffness <= 0.0 {
                return Err(wrong("the stiffness without the compensator", *stiffness / 1e6, "MN m/rad"));
            }
            if *spring <= 0.0 {
                return Err(wrong("the stiffness of the spring", *spring / 1e3, "N/mm"));
            }
            if length_mm <= 0.0 {
                return Err(wrong("the free length of the spring", length_mm, "mm"));
            }
        }
        let undo = change.clone().try_inverse().ok_or(unidentifiable)?;
        let group = |index: usize| {
            let (compliance, slope) = self.compliance(&iterate.law, index);
            let slopes = self.parameters.iter().map(|p| self.place(p).map_or(0.0, |place| slope[place]));
            (compliance, undo.transpose() * DVector::from_iterator(size, slopes))
        };
        Ok(ArmFit {
            parameters: self.parameters.clone(),
            values,
            covariance: &change * covariance * change.transpose(),
            joints: iterate.joints,
            groups: (0..self.rows.len()).map(group).collect(),
        })
    }
}
