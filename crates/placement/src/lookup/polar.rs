//! Path points as the lookup table sees them: about axis 1.

use super::LookupTable;
use nalgebra::{Matrix3, Vector3};
use stead_model::stiffness::whole::of_matrix;
use stead_problem::problem::{Placement, Problem};

/// A path point in the workpiece frame.
#[derive(Debug, Clone)]
pub(super) struct WorkpiecePoint {
    position: Vector3<f64>,
    /// Across the tool axis.
    feed: Vector3<f64>,
    normal: Vector3<f64>,
    force: Vector3<f64>,
    moment: Vector3<f64>,
    /// What the score counts of |K^-1 n|. N
    uncertainty: f64,
    /// How far the part yields along the normal. m
    part: f64,
    /// How the part answers a unit force along the normal. m/N
    part_response: Vector3<f64>,
}

#[cfg(test)]
impl WorkpiecePoint {
    /// Forgets the part.
    pub fn without_part(&mut self) {
        (self.part, self.part_response) = (0.0, Vector3::zeros());
    }
}

/// The path points of a problem.
pub(super) fn points(problem: &Problem) -> Vec<WorkpiecePoint> {
    let points = problem.task.points().iter().zip(problem.task.wrenches());
    points
        .enumerate()
        .map(|(number, (point, wrench))| {
            let axes = point.workpiece_from_point();
            let part_response =
                problem.task.part_compliance(number).map_or_else(Vector3::zeros, |part| part * axes.column(1));
            WorkpiecePoint {
                position: point.position,
                feed: axes.column(0).into_owned(),
                normal: axes.column(1).into_owned(),
                force: wrench.force,
                moment: wrench.moment,
                uncertainty: problem.criterion.force_uncertainty * wrench.force.norm(),
                part: part_response.dot(&wrench.force),
                part_response,
            }
        })
        .collect()
}

/// A placement, ready for its points: workpiece to root coordinates.
pub(super) struct PlacedPath {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

/// A path point at a placement.
pub(super) struct PolarPoint {
    /// The first of the four radii around it, and their weights.
    pub radius: (usize, [f32; 4]),
    /// In the root frame. m
    pub height: f64,
    /// Of the point about axis 1; zero where the table does not need it. rad
    pub azimuth: f64,
    /// Heading at beta zero against the azimuth, in the sense of beta. rad
    pub heading: f64,
    /// Tangential compliance by joint 1, r^2 k_1. m/N
    pub first_compliance: f64,
    /// The same under a moment about axis 1, r k_1. 1/N
    pub first_moment_compliance: f64,
    /// Wall normal, force and moment: radial, tangential, up. -, N, N m
    pub normal: Vector3<f64>,
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
    /// What the score counts of |K^-1 n|. N
    pub uncertainty: f64,
    /// How far base and part yield along the normal. m
    pub beside: f64,
    /// How they answer a unit force along the normal: radial, tangential, up. m/N
    pub beside_response: Vector3<f64>,
}

impl LookupTable<'_> {
    pub(super) fn place(&self, placement: &Placement) -> PlacedPath {
        let base_from_workpiece = placement.base_from_workpiece();
        let root = self.problem.robot.geometry().root_in_base;
        PlacedPath {
            rotation: self.root_from_base * base_from_workpiece.rotation,
            translation: self.root_from_base * (base_from_workpiece.translation - root),
        }
    }

    /// Where a path point is at a placement; `None` beyond the table, where the arm does not get, and too near to
    /// axis 1.
    pub(super) fn polar_point(&self, placed: &PlacedPath, point: usize) -> Option<PolarPoint> {
        let point = &self.points[point];
        let tip = placed.rotation * point.position + placed.translation;
        let radius = libm::hypot(tip.x, tip.y);
        if radius < self.problem.constraints.min_base_distance {
            return None;
        }
        let (cosine, sine) = if radius > 0.0 { (tip.x / radius, tip.y / radius) } else { (1.0, 0.0) };
        let polar = |v: &Vector3<f64>| {
            let v = placed.rotation * v;
            Vector3::new(v.x * cosine + v.y * sine, v.y * cosine - v.x * sine, v.z)
        };
        let feed = polar(&point.feed);
        let (mut beside, mut beside_response) = (point.part, polar(&point.part_response));
        if let Some((frame, matrix)) = &self.base {
            let in_root = |v: &Vector3<f64>| placed.rotation * v;
            let normal = in_root(&point.normal);
            let moved =
                |force: &Vector3<f64>, moment: &Vector3<f64>| of_matrix(matrix, frame, &tip, [force, moment]).linear;
            beside += moved(&in_root(&point.force), &in_root(&point.moment)).dot(&normal);
            let response = moved(&normal, &Vector3::zeros());
            let (along, aside) = (response.x * cosine + response.y * sine, response.y * cosine - response.x * sine);
            beside_response += Vector3::new(along, aside, response.z);
        }
        Some(PolarPoint {
            radius: self.shape.radius.stencil(radius)?,
            height: tip.z,
            azimuth: if self.shape.parts.first_joint { libm::atan2(sine, cosine) } else { 0.0 },
            heading: self.rotation_sign * libm::atan2(feed.y, feed.x),
            first_compliance: radius * radius * self.first_compliance,
            first_moment_compliance: radius * self.first_compliance,
            normal: polar(&point.normal),
            force: polar(&point.force),
            moment: polar(&point.moment),
            uncertainty: point.uncertainty,
            beside,
            beside_response,
        })
    }
}
