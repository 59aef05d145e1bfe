//! A task with a tool that leans.
//!
//! Tip and axis are those of the tool; what is scored, the wall and the feed, and how far it is from point to point,
//! stay those of the path.

use super::lean::{Lean, LeanForce, LeanRule};
use super::{KeptPoint, PathPoint, PointLoad, SAME_PLACE, Task, ToolPath, Wrench};
use nalgebra::Matrix3;
use std::sync::Arc;

/// What a path keeps of itself where its tool leans.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaned {
    /// How the tool leans at every point.
    leans: Arc<[Lean]>,
    /// The path with the tool axes that it states.
    pub(super) upright: Arc<ToolPath>,
}

impl Leaned {
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        Self { leans: self.leans.clone(), upright: Arc::new(self.upright.turned(rotation)) }
    }

    pub(super) fn thinned(&self, kept: &[KeptPoint]) -> Self {
        let leans = kept.iter().map(|kept| self.leans[kept.point]).collect();
        Self { leans, upright: Arc::new(self.upright.thinned(kept)) }
    }
}

impl ToolPath {
    /// The axes along which deflections are scored at a point, as columns in the workpiece frame: the feed (made normal
    /// to the tool axis), the left of the feed, the tool axis, all as the path states them, however the tool leans.
    pub fn scored_axes(&self, point: usize) -> Matrix3<f64> {
        let stated = self.leaned.as_ref().map_or(self, |leaned| &leaned.upright);
        stated.points[point].workpiece_from_point()
    }

    /// How far the tip goes to a point from the one before, both in one segment, over the distance along the path:
    /// other than 1 for a tool that leans otherwise at both alone.
    pub fn tip_share(&self, point: usize) -> f64 {
        if self.leaned.is_none() || self.is_thinned() {
            return 1.0;
        }
        let along = self.step_length(point);
        if along < SAME_PLACE {
            return 1.0;
        }
        (self.points[point].position - self.points[point - 1].position).norm() / along
    }

    /// How the tool leans at every point; none where it does not.
    pub fn leans(&self) -> Option<&[Lean]> {
        self.leaned.as_ref().map(|leaned| &*leaned.leans)
    }
}

impl Task {
    /// The task with the tool axis that the path states, whatever the tool does in this one.
    pub fn upright(&self) -> &Self {
        self.upright.as_deref().unwrap_or(self)
    }

    /// The task with a tool that leans at every point, so many `leans` as points, from the axis that the path states;
    /// with the wrenches of its leans where these are known, or else those of the task, carried to its tip.
    pub fn leaned(&self, rule: &LeanRule, leans: &[Lean]) -> Self {
        let upright = self.upright();
        if leans.iter().all(|lean| *lean == Lean::NONE) {
            return upright.clone();
        }
        let path = &upright.path;
        let each = path.points.iter().zip(&*upright.loads).zip(leans).enumerate();
        let (points, loads): (Vec<_>, Vec<_>) = each
            .map(|(point, ((at, load), lean))| {
                let leaned = rule.leaned(at, path.surface_normals().map(|normals| &normals[point]), lean);
                let carried = |wrench: &Wrench| carried(wrench, rule.force, at, &leaned);
                let computed = upright.lean_forces.as_ref().filter(|_| *lean != Lean::NONE && path.is_scored(point));
                let wrench = computed.map(|forces| forces.wrench(point, lean));
                let edge = |own| computed.and_then(|forces| forces.edge(point, lean)).unwrap_or_else(|| carried(own));
                let wrench = wrench.unwrap_or_else(|| carried(&load.wrench));
                (leaned, PointLoad { wrench, edge: load.edge.as_ref().map(edge), ..*load })
            })
            .unzip();
        let leaned = Some(Leaned { leans: leans.into(), upright: path.clone() });
        Self {
            path: Arc::new(ToolPath { points, leaned, ..(**path).clone() }),
            loads: loads.into(),
            lean_forces: upright.lean_forces.clone(),
            upright: Some(Arc::new(upright.clone())),
        }
    }
}

/// A wrench with the tip from where the path has it to where the tool that leans has it.
fn carried(wrench: &Wrench, force: LeanForce, from: &PathPoint, to: &PathPoint) -> Wrench {
    match force {
        LeanForce::Feed => {
            Wrench { force: wrench.force, moment: wrench.moment + (from.position - to.position).cross(&wrench.force) }
        }
        LeanForce::Tool => {
            let turn = to.workpiece_from_point() * from.workpiece_from_point().transpose();
            Wrench { force: turn * wrench.force, moment: turn * wrench.moment }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BALL, five_segments};
    use super::*;
    use nalgebra::Vector3;
    use stead_numerics::rotation::rotation_from_zyx;

    fn leans(task: &Task) -> Vec<Lean> {
        let of = |k: usize| Lean { lead: 0.01 * (k % 17) as f64, tilt: -0.1 + 0.01 * (k % 11) as f64 };
        (0..task.points().len()).map(of).collect()
    }

    #[test]
    fn what_is_scored_stays_and_the_wrench_acts_at_the_contact() {
        let task = five_segments();
        let leaned = task.leaned(&BALL, &leans(&task));
        assert_eq!(leaned.upright(), &task);
        assert_eq!(leaned.leaned(&BALL, &vec![Lean::NONE; 105]), task);
        for point in 0..task.points().len() {
            assert_eq!(leaned.path().scored_axes(point), task.points()[point].workpiece_from_point());
            assert_eq!(task.path().scored_axes(point), leaned.path().scored_axes(point));
            let (a, b) = (&task.points()[point], &leaned.points()[point]);
            // The centre of the ball stays, and the moment about it.
            assert!((a.position + a.axis * 0.006 - b.position - b.axis * 0.006).norm() < 1e-15);
            let about = |at: &PathPoint, wrench: &Wrench| {
                wrench.moment + (at.position - Vector3::new(0.1, 0.2, 0.3)).cross(&wrench.force)
            };
            let (before, after) = (&task.loads()[point].wrench, &leaned.loads()[point].wrench);
            assert!((about(a, before) - about(b, after)).norm() < 1e-12);
        }
        for span in task.segments() {
            for point in span.clone().skip(1) {
                assert_eq!(leaned.path().step_length(point), task.path().step_length(point));
            }
        }
    }

    #[test]
    fn forces_of_the_tool_turn_with_it() {
        let task = five_segments();
        let rule = LeanRule { force: LeanForce::Tool, ..BALL };
        let leaned = task.leaned(&rule, &leans(&task));
        for (point, (a, b)) in task.points().iter().zip(leaned.points()).enumerate() {
            let [before, after] = [(a, &task), (b, &leaned)]
                .map(|(at, task)| at.workpiece_from_point().tr_mul(&task.loads()[point].wrench.force));
            assert!((before - after).norm() < 1e-9);
        }
    }

    #[test]
    fn a_part_may_be_turned_before_the_tool_leans_or_after() {
        let task = five_segments();
        let (leans, rotation) = (leans(&task), rotation_from_zyx([0.3, -0.7, 1.2]));
        let [a, b] = [task.turned(&rotation).leaned(&BALL, &leans), task.leaned(&BALL, &leans).turned(&rotation)];
        for point in 0..task.points().len() {
            assert!((a.points()[point].position - b.points()[point].position).norm() < 1e-12);
            assert!((a.points()[point].axis - b.points()[point].axis).norm() < 1e-12);
            assert!((a.path().scored_axes(point) - b.path().scored_axes(point)).norm() < 1e-12);
            assert!((a.loads()[point].wrench.moment - b.loads()[point].wrench.moment).norm() < 1e-9);
        }
        assert_eq!(a.upright(), &task.turned(&rotation));
    }
}
