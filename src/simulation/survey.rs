//! Whether a cut chatters: modes of the arm, its answer at the tip, and how deep it may cut at which spindle speed.

use super::arm::{AnyArm, Arm, Missing};
use super::modes::{Linear, Mode};
use super::setup::Setup;
use crate::cutting::Milling;
use nalgebra::{Complex, Matrix3, SVector, Vector3};

/// What is to be found out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Where on the pass the arm stands. m
    pub way: f64,
    /// Spindle speeds of the lobes, from and to. rad/s
    pub speeds: [f64; 2],
    /// Spindle speeds between and at both.
    pub points: usize,
    /// Depths of cut beyond this are not looked at. m
    pub deepest: f64,
    /// Frequencies of the answer at the tip, from and to. Hz
    pub frequencies: [f64; 2],
}

/// How the tip answers to a swinging force, in the plane of the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Frequency of the force. Hz
    pub frequency: f64,
    /// Along the feed, to a force along the feed. m/N
    pub feed: Complex<f64>,
    /// Along the normal of the wall, to a force along it. m/N
    pub normal: Complex<f64>,
    /// Along the normal, to a force along the feed, and the other way round. m/N
    pub cross: Complex<f64>,
}

/// The directions of a cut in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutFrame {
    /// Of the feed.
    pub feed: Vector3<f64>,
    /// Out of the wall.
    pub normal: Vector3<f64>,
}

impl CutFrame {
    /// For a cutter that turns clockwise as seen from its spindle: `axis` points from the work to the spindle. In climb milling
    /// the wall is to the right of the feed.
    pub fn new(feed: Vector3<f64>, axis: Vector3<f64>, milling: Milling) -> Self {
        let left = axis.cross(&feed).normalize();
        Self { feed, normal: if milling == Milling::Climb { left } else { -left } }
    }
}

/// Modes of an arm somewhere on its pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Vibration {
    /// All modes, by natural frequency.
    pub modes: Vec<Mode>,
    /// The answer at the tip over frequency.
    pub answers: Vec<Answer>,
}

/// Why there is nothing to be said.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SurveyError {
    /// The robot file says too little.
    #[error("{0}")]
    Missing(#[from] Missing),
    /// The mass matrix is not positive definite, or the arm without damping is in resonance with the force.
    #[error("the arm has no mass matrix that is positive definite")]
    Singular,
}

/// The arm of a setup, for small motions about where it stands after a way (m) of its pass.
pub fn linear_at(setup: &Setup, way: f64) -> Result<AnyLinear, SurveyError> {
    let motors = setup.motion.motors_after(way, 0.0).0;
    Ok(match setup.arm()? {
        AnyArm::Six(arm) => AnyLinear::Six(Box::new(about(&arm, &motors))),
        AnyArm::Eighteen(arm) => AnyLinear::Eighteen(Box::new(about(&arm, &motors))),
    })
}

fn about<const N: usize>(arm: &Arm<N>, motors: &[f64; 6]) -> Linear<N> {
    let rest: SVector<f64, N> = arm.at_rest(&Arm::<N>::spread(motors));
    Linear::of(arm, &rest, 1.0)
}

/// A [`Linear`] of as many joints as its arm has.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyLinear {
    /// Six joints.
    Six(Box<Linear<6>>),
    /// Eighteen.
    Eighteen(Box<Linear<18>>),
}

impl AnyLinear {
    /// All modes, by natural frequency.
    ///
    /// # Errors
    /// [`SurveyError::Singular`].
    pub fn modes(&self) -> Result<Vec<Mode>, SurveyError> {
        let modes = match self {
            Self::Six(linear) => linear.modes(),
            Self::Eighteen(linear) => linear.modes(),
        };
        modes.ok_or(SurveyError::Singular)
    }

    /// The answer of the tip to a force of a frequency (Hz) in each direction of the base frame. m/N
    ///
    /// # Errors
    /// [`SurveyError::Singular`] in a resonance without damping.
    pub fn response(&self, frequency: f64) -> Result<Matrix3<Complex<f64>>, SurveyError> {
        let response = match self {
            Self::Six(linear) => linear.response(frequency),
            Self::Eighteen(linear) => linear.response(frequency),
        };
        response.ok_or(SurveyError::Singular)
    }

    /// Modes, and the answer in the plane of the cut at frequencies (Hz).
    ///
    /// # Errors
    /// [`SurveyError::Singular`].
    pub fn vibration(&self, frame: &CutFrame, frequencies: &[f64]) -> Result<Vibration, SurveyError> {
        let along = |response: &Matrix3<Complex<f64>>, to: &Vector3<f64>, from: &Vector3<f64>| {
            let sum = (0..3).flat_map(|row| (0..3).map(move |column| (row, column)));
            sum.map(|(row, column)| response[(row, column)] * (to[row] * from[column])).sum()
        };
        let answers = frequencies.iter().map(|frequency| {
            let response = self.response(*frequency)?;
            Ok(Answer {
                frequency: *frequency,
                feed: along(&response, &frame.feed, &frame.feed),
                normal: along(&response, &frame.normal, &frame.normal),
                cross: along(&response, &frame.normal, &frame.feed),
            })
        });
        Ok(Vibration { modes: self.modes()?, answers: answers.collect::<Result<_, SurveyError>>()? })
    }
}
