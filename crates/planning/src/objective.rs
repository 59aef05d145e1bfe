//! The criterion applied to a problem: the directions that are scored at a path point, and the figure that the costs of
//! plans make up.

use super::criterion::{Aggregate, Over, ScoredDirections};
use super::problem::Problem;
use nalgebra::Matrix3;
use stead_model::robot::Robot;
use stead_model::stiffness::whole::yields_elsewhere;
use stead_numerics::scalar::Scalar;

impl Problem {
    /// The arm with each set of compliances that a score covers: the robot itself where no others are given.
    pub fn scored_robots(&self) -> &[Robot] {
        match &self.criterion.stiffness {
            Some(sets) => &sets.robots,
            None => std::slice::from_ref(&self.robot),
        }
    }

    /// Whether a score is the largest over the sets of compliances.
    pub fn is_over_worst(&self) -> bool {
        self.criterion.stiffness.as_ref().is_some_and(|sets| sets.over == Over::Worst)
    }

    /// Whether anything but the joints about their axes yields: springs normal to them, base, mount, tip, part.
    pub fn yields_beside(&self) -> bool {
        self.task.part_yields() || self.scored_robots().iter().any(|robot| yields_elsewhere(robot, &self.spindle))
    }

    /// The directions that are scored at a path point, in the frame in which its scored axes (feed, left of the feed,
    /// tool axis of the path) are given as columns.
    pub fn scored_directions<T: Scalar>(&self, point: usize, axes: &Matrix3<T>) -> ScoredDirections<T> {
        let path = self.task.path();
        let normal = path.surface_normals().map(|normals| path.scored_axes(point).tr_mul(&normals[point]));
        ScoredDirections::new(&self.criterion.weights, normal, axes)
    }

    /// The weight of a segment, from 0.
    pub fn segment_weight(&self, segment: usize) -> f64 {
        self.criterion.segment_weights.get(segment).copied().unwrap_or(1.0)
    }

    /// The weight of a path point: that of its segment and, where points make up a mean, the number of points it stands
    /// for.
    pub fn point_weight(&self, point: usize) -> f64 {
        let path = self.task.path();
        let segment =
            if self.criterion.segment_weights.is_empty() { 1.0 } else { self.segment_weight(path.segment_of(point)) };
        match self.criterion.aggregate {
            Aggregate::Mean | Aggregate::Rms => segment * path.weight(point),
            Aggregate::Max if !path.is_scored(point) => 0.0,
            Aggregate::Max => segment,
        }
    }

    /// What a path point of this score (m) adds to the cost of a plan.
    pub fn point_cost(&self, point: usize, score: f64) -> f64 {
        self.criterion.aggregate.point_cost(self.point_weight(point), score)
    }

    /// The figure that is minimised, from the costs of plans that together cover the whole path. m
    pub fn objective(&self, costs: impl IntoIterator<Item = f64>) -> f64 {
        let aggregate = self.criterion.aggregate;
        let cost = costs.into_iter().fold(0.0, |sum, cost| aggregate.join(sum, cost));
        match aggregate {
            Aggregate::Mean => cost / self.total_weight(),
            Aggregate::Rms => libm::sqrt(cost / self.total_weight()),
            Aggregate::Max => cost,
        }
    }

    /// Sum of the weights of all points.
    pub fn total_weight(&self) -> f64 {
        let path = self.task.path();
        if path.is_thinned() || path.first_unscored().is_some() {
            return (0..self.task.points().len()).map(|point| self.point_weight(point)).sum();
        }
        let points = |(weight, span): (&f64, &std::ops::Range<usize>)| weight * span.len() as f64;
        match &self.criterion.segment_weights[..] {
            [] => self.task.points().len() as f64,
            weights => weights.iter().zip(self.task.segments()).map(points).sum(),
        }
    }
}

#[cfg(test)]
mod tests;
