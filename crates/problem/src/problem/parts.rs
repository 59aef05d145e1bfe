//! What a problem is made of, and the check that its parts agree.

use super::{Cell, Constraints, Problem, Redundancy};
use crate::criterion::Criterion;
use crate::lean::{LeanSpace, LeanSpaceError};
use crate::postures::PostureRules;
use crate::setup::{AxisPositions, Orientation, Setup};
use std::ops::Deref;
use std::sync::Arc;
use stead_cell::tool_scene::SegmentMoves;
use stead_cell::{Attachment, Scene};
use stead_model::external_axis::ExternalAxis;
use stead_model::robot::{Robot, Spindle};
use stead_model::task::{KeptPoint, Task};

/// Everything that defines the placement problem. [`Problem::builder`] gives one with all that must be stated; what may
/// be left out is changed by its fields; [`ProblemParts::build`] checks that the parts agree.
#[derive(Debug, Clone, PartialEq)]
pub struct ProblemParts {
    /// The arm.
    pub robot: Robot,
    /// The spindle as mounted.
    pub spindle: Spindle,
    /// The tool path with its wrenches, turned as the part lies in the [`setup`](Self::setup).
    pub task: Task,
    /// Where the workpiece may stand.
    pub cell: Cell,
    /// What every point must satisfy.
    pub constraints: Constraints,
    /// What is minimised.
    pub criterion: Criterion,
    /// How beta is planned.
    pub redundancy: Redundancy,
    /// Which postures segments may be driven in.
    pub postures: PostureRules,
    /// The shapes on the arm and around it, where collisions are looked for.
    pub scene: Option<Arc<Scene>>,
    /// How the tool gets from segment to segment among these shapes.
    pub segment_moves: SegmentMoves,
    /// The ways in which the part may lie; none where it lies as in the task file.
    pub orientations: Arc<[Orientation]>,
    /// Rails and turntables beside the robot's own axes.
    pub external_axes: Vec<ExternalAxis>,
    /// How far the tool may lean from the axis of the path; none where it keeps to it.
    pub lean: Option<Arc<LeanSpace>>,
    /// How part and axes are set up.
    pub setup: Setup,
}

/// Parts of a problem that do not agree, or a value out of range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A number out of range, in SI units.
    #[error("{what} is {found}; allowed: {allowed}")]
    Value {
        /// Which.
        what: &'static str,
        /// What it is.
        found: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// The setup is in an orientation that is not there.
    #[error("the setup is in orientation {number}; allowed: below {count}, the number of orientations")]
    Orientation {
        /// Its number, from 0.
        number: usize,
        /// How many there are, at least 1.
        count: usize,
    },
    /// The task is not that of the orientation.
    #[error("the task is not that of orientation {name}, in which the part is set up; allowed: its task")]
    TaskOfOrientation {
        /// The name of the orientation.
        name: String,
    },
    /// The task of an orientation has other points.
    #[error("orientation {name} has {found} path points; allowed: {expected}, as many as the task")]
    PointsOfOrientation {
        /// Its name.
        name: String,
        /// Points of its task.
        found: usize,
        /// Points of the problem's task.
        expected: usize,
    },
    /// Positions for another number of axes.
    #[error("the setup has {found} positions of external axes; allowed: {expected}, one for each axis")]
    AxisCount {
        /// Positions.
        found: usize,
        /// Axes.
        expected: usize,
    },
    /// Positions for another number of segments or points.
    #[error("the setup has positions of external axes for {found} {of}; allowed: {expected}, as many as the task has")]
    AxisRows {
        /// Rows of positions.
        found: usize,
        /// What they are for.
        of: &'static str,
        /// How many the task has.
        expected: usize,
    },
    /// A position outside the range of its axis.
    #[error("axis {name} is set up at {found}; allowed: from {min} to {max} (m or rad)")]
    AxisPosition {
        /// The name of the axis.
        name: String,
        /// Its position. m or rad
        found: f64,
        /// Its lowest position. m or rad
        min: f64,
        /// Its highest position. m or rad
        max: f64,
    },
    /// Leans for another number of points, or where the tool may not lean.
    #[error(
        "the setup leans the tool at {found} points; allowed: {expected}, as many as the task has where it may lean"
    )]
    Leans {
        /// Leans.
        found: usize,
        /// How many there may be.
        expected: usize,
    },
    /// A tool that may lean as it cannot.
    #[error(transparent)]
    Lean(#[from] LeanSpaceError),
    /// Weights for another number of segments.
    #[error("the criterion has {found} weights of segments; allowed: none or {expected}, one for each segment")]
    SegmentWeights {
        /// Weights.
        found: usize,
        /// Segments.
        expected: usize,
    },
    /// A stiffness set of another arm.
    #[error(
        "stiffness set {number} is of an arm of other dimensions; allowed: the arm of the problem with other compliances"
    )]
    StiffnessSet {
        /// Its number, from 1.
        number: usize,
    },
    /// The normal of the surface counts, and the task does not state it.
    #[error("the criterion weighs the normal of the surface; allowed: only with a task that states it")]
    NoSurfaceNormals,
    /// Joint travel is weighed beside something else than a mean.
    #[error("the criterion weighs joint travel; allowed: only where the mean of the scores is minimised")]
    JointTravel,
    /// A shape on an axis that is not there.
    #[error("shape {shape} is attached to external axis {axis}; allowed: 1 to {count}")]
    ShapeOnAxis {
        /// The name of the shape.
        shape: String,
        /// The number of the axis, from 1.
        axis: usize,
        /// How many there are.
        count: usize,
    },
}

impl Deref for Problem {
    type Target = ProblemParts;

    fn deref(&self) -> &ProblemParts {
        &self.parts
    }
}

/// Tests take problems apart as they like.
#[cfg(any(test, feature = "testing"))]
impl std::ops::DerefMut for Problem {
    fn deref_mut(&mut self) -> &mut ProblemParts {
        &mut self.parts
    }
}

/// Tests take problems apart as they like.
#[cfg(any(test, feature = "testing"))]
impl Problem {
    /// The problem with some parts changed, unchecked.
    pub fn with(mut self, change: impl FnOnce(&mut ProblemParts)) -> Self {
        change(&mut self.parts);
        self
    }
}

impl Problem {
    /// The parts of a problem with no constraint but the limits of the joints, scored by the mean deflection normal to
    /// the wall, without shapes and external axes. What differs is changed in the fields; then [`ProblemParts::build`].
    pub fn builder(robot: Robot, spindle: Spindle, task: Task, cell: Cell, redundancy: Redundancy) -> ProblemParts {
        ProblemParts {
            robot,
            spindle,
            task,
            cell,
            constraints: Constraints::default(),
            criterion: Criterion::default(),
            redundancy,
            postures: PostureRules::default(),
            scene: None,
            segment_moves: SegmentMoves::default(),
            orientations: [].into(),
            external_axes: Vec::new(),
            lean: None,
            setup: Setup::default(),
        }
    }

    /// What it is made of.
    pub fn into_parts(self) -> ProblemParts {
        self.parts
    }

    /// The same problem with some parts changed.
    ///
    /// # Errors
    /// As of [`ProblemParts::build`].
    pub fn changed(&self, change: impl FnOnce(&mut ProblemParts)) -> Result<Self, ProblemError> {
        let mut parts = self.parts.clone();
        change(&mut parts);
        parts.build()
    }

    /// The same problem in another cell.
    pub fn in_cell(&self, cell: Cell) -> Self {
        Self { parts: ProblemParts { cell, ..self.parts.clone() } }
    }

    /// The same problem on some points of its path alone, ascending, with what they stand for.
    pub fn on_points(&self, kept: &[KeptPoint]) -> Self {
        let points: Vec<usize> = kept.iter().map(|kept| kept.point).collect();
        let leans =
            if self.setup.leans.is_empty() { [].into() } else { points.iter().map(|p| self.setup.leans[*p]).collect() };
        let setup = Setup { positions: self.setup.positions.of_points(&points), leans, ..self.setup };
        let lean = self.lean.as_ref().map(|space| Arc::new(space.on_points(&points)));
        Self { parts: ProblemParts { task: self.task.thinned(kept), setup, lean, ..self.parts.clone() } }
    }

    /// The same problem with one of its stiffness sets alone.
    pub fn with_stiffness_alone(&self, set: &Robot) -> Self {
        let criterion = Criterion { stiffness: None, ..self.criterion.clone() };
        Self { parts: ProblemParts { robot: set.clone(), criterion, ..self.parts.clone() } }
    }
}

impl ProblemParts {
    /// The problem.
    ///
    /// # Errors
    /// [`ProblemError`] at the first part that does not agree with the others, or is out of range.
    pub fn build(self) -> Result<Problem, ProblemError> {
        self.check_values()?;
        self.check_setup()?;
        let segments = self.task.segments().len();
        let weights = self.criterion.segment_weights.len();
        if weights != 0 && weights != segments {
            return Err(ProblemError::SegmentWeights { found: weights, expected: segments });
        }
        if let Some(sets) = &self.criterion.stiffness {
            let differs =
                |set: &Robot| set.geometry() != self.robot.geometry() || set.axes_2_3() != self.robot.axes_2_3();
            if let Some(place) = sets.robots.iter().position(differs) {
                return Err(ProblemError::StiffnessSet { number: place + 1 });
            }
        }
        if self.criterion.weights.surface > 0.0 && self.task.path().surface_normals().is_none() {
            return Err(ProblemError::NoSurfaceNormals);
        }
        if self.criterion.joint_travel_weight != 0.0 && !self.criterion.aggregate.weighs_joint_travel() {
            return Err(ProblemError::JointTravel);
        }
        let count = self.external_axes.len();
        for shape in self.scene.iter().flat_map(|scene| scene.surroundings().shapes()) {
            if let Attachment::Axis(axis) = shape.attached
                && usize::from(axis) >= count
            {
                let (shape, axis) = (shape.name.clone(), usize::from(axis) + 1);
                return Err(ProblemError::ShapeOnAxis { shape, axis, count });
            }
        }
        Ok(Problem { parts: self })
    }

    /// Checks the numbers by themselves.
    fn check_values(&self) -> Result<(), ProblemError> {
        let Redundancy { beta_count, feed, max_beta_rate, max_spindle_turn, max_spindle_speed, .. } = self.redundancy;
        let positive = [
            ("feed", Some(feed)),
            ("rate of beta", max_beta_rate),
            ("turn of the spindle", max_spindle_turn),
            ("speed of the spindle", max_spindle_speed),
            ("largest deflection", self.constraints.max_deflection),
        ];
        for (what, found) in positive.into_iter().filter_map(|(what, found)| Some((what, found?))) {
            if !(found > 0.0 && found.is_finite()) {
                return Err(ProblemError::Value { what, found, allowed: "a finite number above 0" });
            }
        }
        let not_negative = [
            ("smallest inverse condition number", self.constraints.min_inverse_condition),
            ("distance from axis 1", self.constraints.min_base_distance),
            ("force uncertainty", self.criterion.force_uncertainty),
            ("confidence", self.criterion.confidence),
            ("weight of joint travel", self.criterion.joint_travel_weight),
            ("weight of moves", self.postures.move_weight),
            ("tie of postures", self.postures.tie),
            ("retract", self.segment_moves.retract),
        ];
        let weights = &self.criterion.weights;
        let of_weights =
            [weights.feed, weights.wall, weights.axis, weights.surface].map(|weight| ("weight of a direction", weight));
        let of_segments = self.criterion.segment_weights.iter().map(|weight| ("weight of a segment", *weight));
        for (what, found) in not_negative.into_iter().chain(of_weights).chain(of_segments) {
            if !(found >= 0.0 && found.is_finite()) {
                return Err(ProblemError::Value { what, found, allowed: "a finite number, 0 or more" });
            }
        }
        let length = self.constraints.characteristic_length;
        if self.constraints.min_inverse_condition > 0.0 && !(length > 0.0 && length.is_finite()) {
            let what = "characteristic length";
            return Err(ProblemError::Value { what, found: length, allowed: "a finite number above 0" });
        }
        if beta_count < MIN_BETA_COUNT {
            let (what, allowed) = ("number of values of beta", "4 or more");
            return Err(ProblemError::Value { what, found: beta_count as f64, allowed });
        }
        for bounds in self.cell.position.iter().chain([&self.cell.yaw]) {
            for (what, found, is_allowed) in [
                ("lower end of the cell", bounds.min, bounds.min.is_finite()),
                ("upper end of the cell", bounds.max, bounds.max.is_finite() && bounds.max >= bounds.min),
            ] {
                if !is_allowed {
                    return Err(ProblemError::Value { what, found, allowed: "finite numbers, the lower end first" });
                }
            }
        }
        Ok(())
    }

    /// Checks orientation and axes against task and each other.
    fn check_setup(&self) -> Result<(), ProblemError> {
        let points = self.task.points().len();
        let number = self.setup.orientation;
        if number >= self.orientations.len().max(1) {
            return Err(ProblemError::Orientation { number, count: self.orientations.len().max(1) });
        }
        for (place, orientation) in self.orientations.iter().enumerate() {
            let (name, found) = (|| orientation.name.clone(), orientation.task.points().len());
            if found != points {
                return Err(ProblemError::PointsOfOrientation { name: name(), found, expected: points });
            }
            if place == number && *orientation.task != *self.task.upright() {
                return Err(ProblemError::TaskOfOrientation { name: name() });
            }
        }
        let leans = &self.setup.leans;
        if !leans.is_empty() && (self.lean.is_none() || leans.len() != points) {
            return Err(ProblemError::Leans { found: leans.len(), expected: self.lean.as_ref().map_or(0, |_| points) });
        }
        if let Some(space) = &self.lean {
            space.check(self.task.upright().path())?;
        }
        let segments = self.task.segments().len();
        let rows: &[Vec<f64>] = match &self.setup.positions {
            AxisPositions::Same(row) => std::slice::from_ref(row),
            AxisPositions::PerSegment(rows) if rows.len() != segments => {
                return Err(ProblemError::AxisRows { found: rows.len(), of: "segments", expected: segments });
            }
            AxisPositions::PerPoint(rows) if rows.len() != points => {
                return Err(ProblemError::AxisRows { found: rows.len(), of: "points", expected: points });
            }
            AxisPositions::PerSegment(rows) | AxisPositions::PerPoint(rows) => rows,
        };
        for row in rows {
            if row.len() != self.external_axes.len() {
                return Err(ProblemError::AxisCount { found: row.len(), expected: self.external_axes.len() });
            }
            for (axis, found) in self.external_axes.iter().zip(row) {
                if !(axis.min - POSITION_ROUNDING..=axis.max + POSITION_ROUNDING).contains(found) {
                    let (min, max) = (axis.min, axis.max);
                    return Err(ProblemError::AxisPosition { name: axis.name.clone(), found: *found, min, max });
                }
            }
        }
        Ok(())
    }
}

/// Values of beta over a turn at the least.
const MIN_BETA_COUNT: usize = 4;
/// How far beyond the range of an axis a position may be: rounding. m or rad
const POSITION_ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::{Aggregate, Over, StiffnessSets, Weights};
    use crate::testing::five_segments;
    use stead_model::external_axis::{AxisKind, AxisUse, Carried};

    fn axis() -> ExternalAxis {
        ExternalAxis {
            name: "rail".to_owned(),
            kind: AxisKind::Rail,
            carries: Carried::Robot,
            direction: nalgebra::Vector3::x(),
            point: nalgebra::Vector3::zeros(),
            min: 0.0,
            max: 1.0,
            max_speed: None,
            axis_use: AxisUse::Fixed,
        }
    }

    #[test]
    fn parts_that_disagree_are_refused_by_name() {
        assert_eq!(five_segments().into_parts().build(), Ok(five_segments()));
        let refused = |change: &dyn Fn(&mut ProblemParts)| {
            let mut parts = five_segments().into_parts();
            change(&mut parts);
            parts.build().unwrap_err().to_string()
        };
        for (change, part) in [
            (&(|p: &mut ProblemParts| p.redundancy.feed = f64::NAN) as &dyn Fn(&mut ProblemParts), "feed is NaN"),
            (&|p| p.redundancy.beta_count = 3, "number of values of beta is 3"),
            (&|p| p.redundancy.max_beta_rate = Some(0.0), "rate of beta is 0"),
            (&|p| p.constraints.min_inverse_condition = -0.1, "smallest inverse condition number is -0.1"),
            (&|p| p.constraints.characteristic_length = 0.0, "characteristic length is 0"),
            (&|p| p.criterion.weights = Weights { wall: -1.0, ..Weights::NONE }, "weight of a direction is -1"),
            (&|p| p.cell.yaw.max = -4.0, "upper end of the cell is -4"),
            (&|p| p.setup.orientation = 1, "the setup is in orientation 1"),
            (&|p| p.setup.positions = AxisPositions::Same(vec![0.0]), "1 positions of external axes; allowed: 0"),
            (&|p| p.external_axes = vec![axis()], "0 positions of external axes; allowed: 1"),
            (
                &|p| {
                    p.external_axes = vec![axis()];
                    p.setup.positions = AxisPositions::Same(vec![1.5]);
                },
                "axis rail is set up at 1.5",
            ),
            (&|p| p.setup.positions = AxisPositions::PerSegment(vec![Vec::new(); 4]), "for 4 segments; allowed: 5"),
            (&|p| p.setup.positions = AxisPositions::PerPoint(vec![Vec::new(); 4]), "for 4 points; allowed: 105"),
            (&|p| p.criterion.segment_weights = vec![1.0; 4], "4 weights of segments"),
            (&|p| p.criterion.weights = Weights::SURFACE, "normal of the surface"),
            (
                &|p| {
                    p.criterion.joint_travel_weight = 1e-6;
                    p.criterion.aggregate = Aggregate::Max;
                },
                "joint travel",
            ),
            (
                &|p| {
                    // The same arm with a longer forearm.
                    let mut joints = p.robot.joints().clone();
                    joints[3].d += 0.1;
                    let robot = Robot::new("other", joints).unwrap();
                    p.criterion.stiffness = Some(StiffnessSets { robots: vec![robot], over: Over::Mean });
                },
                "stiffness set 1",
            ),
        ] {
            let message = refused(change);
            assert!(message.contains(part) && message.contains("; allowed: "), "{part} in {message}");
        }
    }
}
