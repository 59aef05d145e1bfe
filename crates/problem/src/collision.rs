//! Collisions of states and plans: whether the shapes of the scene keep their distance, and whether the arm can follow
//! the moves between points at all.
//!
//! Constraints on single states are evaluated for every candidate; collisions are not. A plan is made
//! without them, and then checked; what hits is forbidden, and the planner makes it again. Forbidding states makes no
//! plan cheaper, so a plan that is free is as good as if all states had been checked.

use crate::constraints::Measured;
use crate::evaluate::placed_task::PlacedTask;
use crate::problem::{Placement, Problem};
use crate::segment_plan::SegmentPlan;
use crate::straight_move::LineEnd;
use std::ops::Range as Span;
use std::sync::Arc;
use stead_cell::{Clearance, PairKind, Poses, Proximity, Scene};
use stead_model::external_axis::{Carried, carried};
use stead_model::robot::Posture;

/// A state of a plan, or a move between two, that may not be.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFault {
    /// The path point; of a move between two points the later one.
    pub point: usize,
    /// Whether it is on the way from the point before.
    pub is_between: bool,
    /// What it is.
    pub fault: Fault,
}

/// What is wrong with a state, or with a move between two.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// Two shapes are nearer than they may be: the number of the pair in the scene.
    Hit(usize),
    /// The arm cannot follow the straight move of the tool.
    Unfollowed(LineEnd),
}

/// The least room at the points of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanClearance {
    /// The path point.
    pub point: usize,
    /// The distance of the pair; zero where two shapes touch, less inside of a zone. m
    pub distance: f64,
    /// Their names.
    pub names: Arc<[String; 2]>,
}

/// A point of a plan with what is known of its room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointClearance {
    /// The path point.
    pub point: usize,
    /// Joint angles there. rad
    pub joints: [f64; 6],
    /// The pair with the least room; `None` where nothing is near.
    pub clearance: Option<Clearance>,
}

/// The least room at the points of a plan, without the pairs whose distance is the same at all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangingClearance {
    /// The pairs left out, with their distances. m
    pub still: Vec<Clearance>,
    /// What is left at each point; `None` where nothing is near.
    pub at: Vec<Option<Clearance>>,
}

/// Distances that differ by no more are the same along a plan. m
const SAME: f64 = 1e-6;

impl Problem {
    /// Where all that moves stands at a path point, for joint angles (rad) and the workpiece at a placement: in the
    /// base frame, in which the cell moves the other way where an external axis carries the robot.
    pub fn poses(&self, scene: &Scene, point: usize, placement: &Placement, joints: &[f64; 6]) -> Poses {
        self.poses_at(scene, self.axis_positions(point), placement, joints)
    }

    /// The same with the external axes at positions (m or rad).
    pub(crate) fn poses_at(&self, scene: &Scene, positions: &[f64], placement: &Placement, joints: &[f64; 6]) -> Poses {
        let axes = &self.external_axes;
        let part = self.turned(self.base_from_workpiece_at(positions, placement));
        let poses = scene.poses(joints, &part);
        if axes.is_empty() {
            return poses;
        }
        let base_from_cell = carried(axes, positions, Carried::Robot).inverse();
        axes.iter().enumerate().fold(poses.with_cell(base_from_cell), |poses, (number, axis)| {
            let cell_from_axis = carried(&axes[..=number], positions, axis.carries);
            poses.with_axis(number, base_from_cell.then(&cell_from_axis))
        })
    }

    /// The first pair that is nearer than it may be whatever the arm does, for the workpiece at a placement; `None`
    /// also where there is no scene.
    pub fn placement_hit(&self, placement: &Placement) -> Option<usize> {
        let scene = self.scene.as_deref()?;
        let joints = self.robot.mid_range();
        let hit = |point| scene.first_hit(&self.poses(scene, point, placement, &joints), &[PairKind::WorkpieceCell]);
        self.points_after_axes_moved().find_map(hit)
    }

    /// The path points at which the external axes stand otherwise than at the point before: at others the part stands
    /// as it did. The first alone where there are no axes.
    pub fn points_after_axes_moved(&self) -> impl Iterator<Item = usize> {
        let points = if self.external_axes.is_empty() { 1 } else { self.task.points().len() };
        (0..points).filter(|point| self.axes_moved_to(*point))
    }

    /// Whether the external axes stand otherwise at a path point than at the one before; also at the first.
    pub fn axes_moved_to(&self, point: usize) -> bool {
        let has_axes = !self.external_axes.is_empty();
        point == 0 || (has_axes && self.axis_positions(point) != self.axis_positions(point - 1))
    }

    /// The first pair that is nearer than it may be at a path point with the arm at joint angles (rad); `None` also
    /// where there is no scene.
    pub fn state_hit(&self, point: usize, placement: &Placement, joints: &[f64; 6]) -> Option<usize> {
        let scene = self.scene.as_deref()?;
        scene.first_hit(&self.poses(scene, point, placement, joints), &PairKind::OF_STATES)
    }

    /// Any such pair of some kinds, by what is known from states looked at before.
    pub fn hit_after(
        &self,
        known: &mut Proximity,
        point: usize,
        placement: &Placement,
        joints: &[f64; 6],
        kinds: &[PairKind],
    ) -> Option<usize> {
        let scene = self.scene.as_deref()?;
        scene.next_hit(known, &self.poses(scene, point, placement, joints), kinds)
    }

    /// The same for a path point at a free angle (rad) in a posture; `None` also where that is out of reach.
    #[cfg(any(test, feature = "testing"))]
    pub fn posture_hit(&self, point: usize, placement: &Placement, beta: f64, posture: Posture) -> Option<usize> {
        self.at(placement).next_hit(point, beta, posture, &PairKind::OF_STATES, &mut Proximity::default())
    }

    /// The pair with the least room beyond what it has to keep; `None` where there is no scene, or nothing is near.
    pub fn state_clearance(&self, point: usize, placement: &Placement, joints: &[f64; 6]) -> Option<Clearance> {
        let scene = self.scene.as_deref()?;
        scene.clearance(&self.poses(scene, point, placement, joints), &PairKind::ALL)
    }

    /// The least room along a plan without the pairs whose distance does not change along it, as that of a part and the
    /// table that it lies on; `None` where no such pair has the least room anywhere.
    pub fn changing_clearance(&self, placement: &Placement, plan: &[PointClearance]) -> Option<ChangingClearance> {
        let scene = self.scene.as_deref()?;
        let poses = |of: &PointClearance| self.poses(scene, of.point, placement, &of.joints);
        let distance = |pair: usize, of: &PointClearance| scene.distance(pair, &poses(of), f64::INFINITY);
        let mut changing = ChangingClearance { still: Vec::new(), at: plan.iter().map(|of| of.clearance).collect() };
        let mut seen = Vec::new();
        loop {
            let mut still = Vec::new();
            for pair in changing.at.iter().flatten().map(|clearance| clearance.pair) {
                if seen.contains(&pair) {
                    continue;
                }
                seen.push(pair);
                let first = distance(pair, plan.first()?);
                if plan.iter().all(|of| (distance(pair, of) - first).abs() <= SAME) {
                    still.push(Clearance { distance: first, pair });
                }
            }
            if still.is_empty() {
                return (!changing.still.is_empty()).then_some(changing);
            }
            changing.still.extend(still);
            let left_out: Vec<usize> = changing.still.iter().map(|clearance| clearance.pair).collect();
            for (of, at) in plan.iter().zip(&mut changing.at) {
                if at.is_some_and(|clearance| left_out.contains(&clearance.pair)) {
                    *at = scene.clearance_without(&poses(of), &left_out);
                }
            }
        }
    }

    /// The pair with the least room as a constraint, of pairs that touch the deepest; `None` where there is no scene,
    /// or nothing is near.
    pub fn clearance_constraint(&self, point: usize, placement: &Placement, joints: &[f64; 6]) -> Option<Measured> {
        let scene = self.scene.as_deref()?;
        let poses = self.poses(scene, point, placement, joints);
        let Clearance { distance, pair } = scene.deepest(&poses, &PairKind::ALL)?;
        let pair = scene.pair(pair)?;
        Some(Measured::Clearance { names: pair.names.clone(), distance, required: pair.required })
    }

    /// Whether spindle and holder are too near to the part or its fixture at a path point and free angle (rad),
    /// wherever the part stands, by what is known from the angles looked at before.
    pub fn tool_hits_workpiece(&self, point: usize, beta: f64, known: &mut Proximity) -> bool {
        let Some(scene) = self.scene.as_deref() else { return false };
        let at_origin = Placement::from([0.0; 4]);
        let part = self.base_from_part(point, &at_origin);
        let poses = Poses::of_tool(&self.at(&at_origin).base_from_flange(point, beta), &part);
        scene.next_hit(known, &poses, &[PairKind::ToolWorkpiece]).is_some()
    }

    /// The states of a segment's plan that hit, and with `with_moves` also the moves from point to point that hit or
    /// cannot be followed, unless the path is a subset of points.
    pub fn plan_faults(&self, placement: &Placement, plan: &SegmentPlan, with_moves: bool) -> Vec<PlanFault> {
        let posture = (with_moves && !self.task.path().is_thinned()).then_some(plan.posture);
        self.path_faults(placement, &plan.points, &plan.joints, &PairKind::OF_STATES, posture).collect()
    }

    /// The same, by pairs of some kinds, of joint angles (rad) at path points of a segment, one after the other; moves
    /// from point to point are checked where a posture is given.
    pub fn path_faults(
        &self,
        placement: &Placement,
        points: &Span<usize>,
        joints: &[[f64; 6]],
        kinds: &'static [PairKind],
        posture: Option<Posture>,
    ) -> impl Iterator<Item = PlanFault> {
        let scene = self.scene.as_deref();
        let mut known = Proximity::default();
        // The poses at the point before; whether nothing hits there.
        let mut before: (Option<Poses>, bool) = (None, false);
        let fault = move |(place, point): (usize, usize)| {
            let poses = scene.map(|scene| (scene, self.poses(scene, point, placement, &joints[place])));
            let between = posture.filter(|_| before.1).and_then(|posture| {
                let ends = [joints[place - 1], joints[place]];
                let at_ends = poses.as_ref().zip(before.0.as_ref()).map(|((scene, end), start)| (*scene, [start, end]));
                self.at(placement).move_fault(point, posture, ends, at_ends, &mut known)
            });
            let pair = poses.as_ref().and_then(|(scene, poses)| scene.next_hit(&mut known, poses, kinds));
            before = (poses.map(|(_, poses)| poses), pair.is_none());
            let is_between = pair.is_none();
            pair.map(Fault::Hit).or(between).map(|fault| PlanFault { point, is_between, fault })
        };
        points.clone().enumerate().filter_map(fault)
    }

    /// Whether nothing hits along the plans of all segments, between points too, and the arm can follow all moves
    /// between points.
    pub fn is_free(&self, placement: &Placement, plans: &[SegmentPlan]) -> bool {
        self.placement_hit(placement).is_none()
            && plans.iter().all(|plan| self.plan_faults(placement, plan, true).is_empty())
    }
}

impl PlacedTask<'_> {
    /// A pair of shapes of some kinds that touch at a path point at a free angle (rad) in a posture, by what is known
    /// from states looked at before; `None` also where that is out of reach.
    pub fn next_hit(
        self,
        point: usize,
        beta: f64,
        posture: Posture,
        kinds: &[PairKind],
        known: &mut Proximity,
    ) -> Option<usize> {
        let joints = self.problem.robot.inverse(&self.base_from_flange(point, beta), posture).ok()?;
        self.problem.hit_after(known, point, self.placement, &joints, kinds)
    }
}

mod between;
