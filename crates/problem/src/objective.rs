//! The criterion applied to a problem: the directions that are scored at a path point, and the figure that the costs of
//! plans make up.

use super::criterion::{Aggregate, Direction, Over, ScoredDirections, Weights};
use super::problem::Problem;
use nalgebra::Matrix3;
use stead_model::robot::Robot;
use stead_model::stiffness::whole::yields_elsewhere;
use stead_numerics::digits::trimmed;
use stead_numerics::scalar::Scalar;

/// Decimals of weights and shares in words.
const DECIMALS: usize = 6;

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

    /// The part of the deflection that is scored, in words: "normal deflection".
    pub fn scored_words(&self) -> String {
        let criterion = &self.criterion;
        match criterion.direction() {
            Some(Direction::Wall) => "normal deflection".to_owned(),
            Some(Direction::Surface) => "deflection normal to the surface".to_owned(),
            Some(Direction::Axis) => "deflection along the tool axis".to_owned(),
            Some(Direction::Total) => "total deflection".to_owned(),
            None => {
                let Weights { feed, wall, axis, surface } = criterion.weights;
                let named = [("feed", feed), ("wall", wall), ("axis", axis), ("surface", surface)];
                let of = |(name, weight): (&str, f64)| {
                    (weight != 0.0).then(|| format!("{name} {}", trimmed(weight, DECIMALS)))
                };
                format!("deflection weighted by {}", named.into_iter().filter_map(of).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// What is minimised, in words, with all that it contains: "mean normal deflection (segments weighted 1, 2)".
    pub fn objective_words(&self) -> String {
        let criterion = &self.criterion;
        let aggregate = match criterion.aggregate {
            Aggregate::Mean => "mean",
            Aggregate::Rms => "root mean square of the",
            Aggregate::Max => "largest",
        };
        let mut parts = Vec::new();
        if self.task.path().first_unscored().is_some() {
            parts.push("of the points that are scored".to_owned());
        }
        if criterion.segment_weights.iter().any(|weight| *weight != 1.0) {
            let weights: Vec<String> =
                criterion.segment_weights.iter().map(|weight| trimmed(*weight, DECIMALS)).collect();
            parts.push(format!("segments weighted {}", weights.join(", ")));
        }
        if let Some(sets) = &criterion.stiffness {
            let how = if sets.over == Over::Worst { "the largest" } else { "the mean" };
            parts.push(format!("of {} sets of stiffness {how} at every point", sets.robots.len()));
        }
        if criterion.force_uncertainty != 0.0 {
            parts.push(format!("force errors of {} % covered", trimmed(criterion.force_uncertainty * 100.0, DECIMALS)));
        }
        if self.covers_compliance_errors() {
            parts.push(format!(
                "errors of the compliances covered to {} sigma",
                trimmed(criterion.confidence, DECIMALS)
            ));
        }
        if criterion.joint_travel_weight != 0.0 {
            parts.push("with the travel of the joints".to_owned());
        }
        let parts = if parts.is_empty() { String::new() } else { format!(" ({})", parts.join("; ")) };
        format!("{aggregate} {}{parts}", self.scored_words())
    }

    /// Whether scores cover errors of the compliances, which the robot states.
    pub fn covers_compliance_errors(&self) -> bool {
        self.criterion.confidence != 0.0 && self.scored_robots().iter().any(|robot| robot.uncertainty().is_some())
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
