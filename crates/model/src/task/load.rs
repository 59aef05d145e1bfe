//! What acts at a path point: the wrench of the cut, and how the part yields to it.
//!
//! The mean force of a cut is affine in the feed: chips take a force in proportion to their thickness, edges one that
//! knows nothing of it,
//!
//! ```text
//! F(v) = F_edge + v / v_programmed F_chip
//! ```

use super::{Task, TaskError, ToolPath};
use crate::stiffness::matrix::checked;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// What the workpiece does to the tool at the tool centre point, in the workpiece frame where no other is named;
/// nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Wrench {
    /// Force. N
    pub force: Vector3<f64>,
    /// Moment about the tool centre point. N m
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// The wrench in the directions of the frame in which a rotation is given.
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        Self { force: rotation * self.force, moment: rotation * self.moment }
    }
}

/// What acts at a path point, in the workpiece frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLoad {
    /// The wrench on the tool.
    pub wrench: Wrench,
    /// The part of it that does not grow with the feed, where that is known.
    pub edge: Option<Wrench>,
    /// Compliance of the part, where it yields: its displacement per force on it. m/N
    pub part: Option<Matrix3<f64>>,
}

impl PointLoad {
    /// A wrench on a part that does not yield.
    pub(super) fn of(wrench: Wrench) -> Self {
        Self { wrench, edge: None, part: None }
    }

    /// The load in the directions of the frame in which a rotation is given.
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        Self {
            wrench: self.wrench.turned(rotation),
            edge: self.edge.map(|edge| edge.turned(rotation)),
            part: self.part.map(|part| rotation * part * rotation.transpose()),
        }
    }

    /// The load at another feed, over the programmed one; `None` where it is not known how the wrench changes with it.
    fn at_feed(&self, share: f64) -> Option<Self> {
        let (edge, wrench) = (self.edge?, self.wrench);
        // To the last digit.
        if share == 1.0 {
            return Some(*self);
        }
        let force = edge.force + (wrench.force - edge.force) * share;
        let moment = edge.moment + (wrench.moment - edge.moment) * share;
        Some(Self { wrench: Wrench { force, moment }, ..*self })
    }
}

impl ToolPath {
    /// A wrench for every point, none for a point that is not scored.
    pub(super) fn of_scored(&self, wrenches: Vec<Wrench>) -> Result<impl Iterator<Item = Wrench>, TaskError> {
        if wrenches.len() != self.points.len() {
            return Err(TaskError::Wrenches { wrenches: wrenches.len(), points: self.points.len() });
        }
        for (point, wrench) in wrenches.iter().enumerate() {
            for (field, vector) in [("force", wrench.force), ("moment", wrench.moment)] {
                if vector.iter().any(|v| !v.is_finite()) {
                    return Err(TaskError::NotFinite { point, field });
                }
            }
        }
        let of = |(point, wrench)| if self.is_scored(point) { wrench } else { Wrench::default() };
        Ok(wrenches.into_iter().enumerate().map(of))
    }
}

impl Task {
    /// States which part of every wrench does not grow with the feed; none of a point that is not scored, whatever is
    /// given for it.
    ///
    /// # Errors
    /// [`TaskError::Wrenches`] when the numbers differ, [`TaskError::NotFinite`] for a wrench with NaN or infinity.
    pub fn with_edge_parts(mut self, edges: Vec<Wrench>) -> Result<Self, TaskError> {
        let loads = self.loads.iter().zip(self.path.of_scored(edges)?);
        self.loads = loads.map(|(load, edge)| PointLoad { edge: Some(edge), ..*load }).collect();
        Ok(self)
    }

    /// Whether it is known how the wrenches change with the feed.
    pub fn has_edge_parts(&self) -> bool {
        self.loads.iter().all(|load| load.edge.is_some())
    }

    /// The same task cut with another feed at every point, over the programmed one; `None` where it is not known how
    /// the wrenches change with it.
    pub fn at_feed(&self, share: impl Fn(usize) -> f64) -> Option<Self> {
        let loads = self.loads.iter().enumerate().map(|(point, load)| load.at_feed(share(point)));
        Some(Self { loads: loads.collect::<Option<_>>()?, ..self.clone() })
    }

    /// The same task on a part that yields at every point by a matrix in the workpiece frame: displacement (m) of the
    /// part per force (N) on it. The tool moves against the part as far as both do.
    ///
    /// # Errors
    /// [`TaskError`] where their number is not that of the points, or at the first that is no compliance.
    pub fn with_part_compliances(mut self, matrices: Vec<Matrix3<f64>>) -> Result<Self, TaskError> {
        if matrices.len() != self.loads.len() {
            return Err(TaskError::PartCompliances { matrices: matrices.len(), points: self.loads.len() });
        }
        let of = |(point, (load, matrix)): (usize, (&PointLoad, _))| {
            let part = checked(matrix).map_err(|error| TaskError::PartCompliance { point, error })?;
            Ok(PointLoad { part: Some(part), ..*load })
        };
        self.loads = self.loads.iter().zip(matrices).enumerate().map(of).collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// How the part yields at a point, where it does: displacement (m) per force (N), in the workpiece frame.
    pub fn part_compliance(&self, point: usize) -> Option<&Matrix3<f64>> {
        self.loads.get(point)?.part.as_ref()
    }

    /// Whether the part yields.
    pub fn part_yields(&self) -> bool {
        self.loads.iter().any(|load| load.part.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::five_segments;
    use super::super::{KeptPoint, Task, Wrench};
    use stead_numerics::rotation::rotation_from_zyx;

    #[test]
    fn the_part_of_the_edges_stays_when_the_feed_falls() {
        let task = five_segments();
        assert_eq!(task.at_feed(|_| 0.5), None);
        let edge = |wrench: &Wrench| Wrench { force: wrench.force * 0.25, moment: wrench.moment * 0.25 };
        let edges = task.wrenches().map(edge).collect();
        let task =
            Task::new(task.path().clone(), task.wrenches().copied().collect()).unwrap().with_edge_parts(edges).unwrap();
        assert_eq!(task.at_feed(|_| 1.0).as_ref(), Some(&task));
        // A turned and thinned task knows them too.
        let rotation = rotation_from_zyx([0.3, -0.7, 1.2]);
        let kept: Vec<KeptPoint> = (0..5).map(|segment| KeptPoint { point: 21 * segment + 3, weight: 21.0 }).collect();
        for (task, whole) in
            [(task.turned(&rotation), task.turned(&rotation)), (task.thinned(&kept), task.thinned(&kept))]
        {
            let slow = task.at_feed(|point| if point == 2 { 0.4 } else { 1.0 }).unwrap();
            for (point, (slow, whole)) in slow.wrenches().zip(whole.wrenches()).enumerate() {
                let share = if point == 2 { 0.25 + 0.4 * 0.75 } else { 1.0 };
                assert!((slow.force - whole.force * share).norm() < 1e-12 && slow.force.norm() > 0.0);
            }
        }
    }
}
