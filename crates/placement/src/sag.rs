//! How far the weight of links and spindle moves the tool along a plan.
//!
//! It is no part of a score: it does not depend on the cutting force, is there already when the program is touched up,
//! and is taken away by a controller that corrects it. What remains of it is how it differs from point to point, since
//! it depends on the pose.

use nalgebra::Vector3;
use serde::Serialize;
use stead_model::stiffness::elastic::ElasticArm;
use stead_problem::problem::{Placement, Problem};

/// How far the weight moves the tool at the points of a path that are scored.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sag {
    /// Over the whole path.
    pub path: SagRange,
    /// Over each segment that has such points, with its number, from 1.
    pub segments: Vec<(usize, SagRange)>,
}

/// How far the weight moves the tool over some points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SagRange {
    /// The smallest displacement. m
    pub least: f64,
    /// The largest. m
    pub largest: f64,
    /// The largest difference between the displacements of two points, in the workpiece frame: what remains at most
    /// where the program is touched up at any one of them. m
    pub spread: f64,
}

impl SagRange {
    /// Over displacements (m); none of none.
    fn of(moved: &[Vector3<f64>]) -> Option<Self> {
        let sizes = || moved.iter().map(|moved| moved.norm());
        let (least, largest) = (sizes().reduce(f64::min)?, sizes().reduce(f64::max)?);
        Some(Self { least, largest, spread: widest(moved) })
    }
}

impl Sag {
    /// Along a plan, for the joint angles (rad) of its points; none where the mass of what the flange carries is not
    /// known.
    pub(crate) fn of(
        problem: &Problem,
        placement: &Placement,
        joints: impl Iterator<Item = (usize, [f64; 6])>,
    ) -> Option<Self> {
        problem.spindle.carried_mass()?;
        let path = problem.task.path();
        let arm = ElasticArm::new(&problem.robot, &problem.spindle);
        let mut segments: Vec<(usize, Vec<Vector3<f64>>)> = Vec::new();
        for (point, joints) in joints.filter(|(point, _)| path.is_scored(*point)) {
            let base_from_workpiece = problem.base_from_workpiece(point, placement).rotation;
            let sag = arm.clone().in_gravity(problem.free_fall(point)).sag(&joints);
            let moved = base_from_workpiece.tr_mul(&sag.linear);
            let segment = path.segment_of(point) + 1;
            match segments.last_mut() {
                Some((last, all)) if *last == segment => all.push(moved),
                _ => segments.push((segment, vec![moved])),
            }
        }
        let all: Vec<Vector3<f64>> = segments.iter().flat_map(|(_, moved)| moved.iter().copied()).collect();
        let of_segment = |(segment, moved): &(usize, Vec<Vector3<f64>>)| Some((*segment, SagRange::of(moved)?));
        Some(Self { path: SagRange::of(&all)?, segments: segments.iter().filter_map(of_segment).collect() })
    }
}

/// The largest distance between two of some points: pairs that cannot have it by their distances from the middle are
/// not looked at.
fn widest(points: &[Vector3<f64>]) -> f64 {
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let mut outermost: Vec<(f64, &Vector3<f64>)> = points.iter().map(|p| ((p - middle).norm(), p)).collect();
    outermost.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut widest = 0.0_f64;
    for (number, (distance, point)) in outermost.iter().enumerate() {
        // The one before is no farther out than this from the middle.
        if 2.0 * distance <= widest {
            break;
        }
        let others = outermost[number + 1..].iter().take_while(|(other, _)| distance + other > widest);
        widest = others.map(|(_, other)| (*point - *other).norm()).fold(widest, f64::max);
    }
    widest
}

#[cfg(test)]
mod tests;
