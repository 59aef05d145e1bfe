//! What is planned for one segment of a path.

use std::ops::Range as Span;
use stead_model::robot::Posture;

/// The plan of one segment.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentPlan {
    /// The path points.
    pub points: Span<usize>,
    /// The posture kept all along.
    pub posture: Posture,
    /// Free angle at each point, changing from point to point by less than half a turn. rad
    pub betas: Vec<f64>,
    /// Real joint angles at each point. rad
    pub joints: Vec<[f64; 6]>,
    /// What its points add to the objective ([`Problem::objective`](crate::problem::Problem::objective)): by default
    /// the sum of the scores. m
    pub cost: f64,
}
