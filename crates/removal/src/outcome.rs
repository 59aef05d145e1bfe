//! Force, moment and engagement at every point of a path, with what is said of them.

use crate::cut::CutFigures;
use crate::load::PointForces;
use crate::surface::Surface;
use nalgebra::Vector3;
use stead_model::task::{ToolPath, Wrench};
use stead_numerics::message::{Note, Warning};

/// How far forces and moments with cells twice as large are from those stated, over the largest of the path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForcesDifference {
    /// Root mean square over the points of the path, force and moment. Relative
    pub rms: [f64; 2],
    /// Largest at a point, force and moment. Relative
    pub largest: [f64; 2],
}

impl ForcesDifference {
    /// Of the same points.
    pub(crate) fn between(fine: &[PointForces], coarse: &[PointForces]) -> Self {
        let parts: [fn(&Wrench) -> Vector3<f64>; 2] = [|wrench| wrench.force, |wrench| wrench.moment];
        let of_part = parts.map(|part| {
            let at = |point: &PointForces| part(&point.at_feed(1.0));
            let scale = fine.iter().map(|point| at(point).norm()).fold(0.0, f64::max);
            if scale == 0.0 {
                return [0.0, 0.0];
            }
            let off = fine.iter().zip(coarse).map(|(fine, coarse)| (at(fine) - at(coarse)).norm() / scale);
            let squares: f64 = off.clone().map(|off| off * off).sum();
            [(squares / fine.len() as f64).sqrt(), off.fold(0.0, f64::max)]
        });
        Self { rms: of_part.map(|[rms, _]| rms), largest: of_part.map(|[_, largest]| largest) }
    }
}

/// Forces along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct RemovalForces {
    /// The path, with the points that were added; points that cut nothing are followed and not scored, unless none
    /// cuts.
    pub path: ToolPath,
    /// The load at each of its points.
    pub points: Vec<PointForces>,
    /// Distance of neighbouring lines of the stock. m
    pub cell: f64,
    /// How far cells twice as large are off.
    pub difference: ForcesDifference,
    /// Volume that the operation removes. m3
    pub removed: f64,
    /// Length of scored path on which nothing is cut, over all of it.
    pub air: f64,
    /// What is cut, in a few figures; nothing where no scored point cuts.
    pub cut: Option<CutFigures>,
    /// The stock before the operation and after it, thinned.
    pub stock: [Surface; 2],
    /// What the user should see to.
    pub warnings: Vec<Warning>,
    /// What was assumed and done, in sentences.
    pub notes: Vec<Note>,
}

impl RemovalForces {
    /// The error of the forces by their own estimate, as a share of them: root mean square over the points of the path
    /// of how far cells twice as large are off, over that of the forces.
    pub fn own_error(&self) -> f64 {
        let norms = || self.points.iter().map(|point| point.at_feed(1.0).force.norm());
        let largest = norms().fold(0.0, f64::max);
        let squares: f64 = norms().map(|norm| norm * norm).sum();
        if squares > 0.0 { self.difference.rms[0] * largest / (squares / self.points.len() as f64).sqrt() } else { 0.0 }
    }

    /// How far the force exceeds its mean within a turn, as a share of the mean: over the scored points that cut, the
    /// sum of the largest norms less that of the norms of the means, over the latter.
    pub fn spread_over_a_turn(&self) -> f64 {
        let (mut over, mut means) = (0.0, 0.0);
        for (_, point) in self.points.iter().enumerate().filter(|(number, _)| self.path.is_scored(*number)) {
            let mean = point.at_feed(1.0).force.norm();
            over += (point.largest - mean).max(0.0);
            means += mean;
        }
        if means > 0.0 { over / means } else { 0.0 }
    }

    /// The wrench at every point at the programmed feed.
    pub fn wrenches(&self) -> Vec<Wrench> {
        self.points.iter().map(|point| point.at_feed(1.0)).collect()
    }
}
