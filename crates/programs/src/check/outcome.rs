//! How a program compares with its plan, move by move.

use super::expected::Expected;
use super::written::Written;
use std::path::PathBuf;
use stead_disk::input::InputFile;
use stead_planning::transfer_path::LineEnd;

/// How far the tool may be off. mm
pub const POSITION_MM: f64 = 0.01;
/// How far the tool may be turned. deg
pub const ANGLE_DEG: f64 = 0.01;

/// A move of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MovePlace {
    /// File and line of the move.
    pub file: PathBuf,
    /// Line in the file, from 1.
    pub line: usize,
    /// Segment of the plan, from 1.
    pub segment: usize,
    /// Path point at which the tool is, or from which it is retracted, from 0.
    pub point: usize,
    /// Whether it is retracted.
    pub is_retracted: bool,
}

impl MovePlace {
    pub(super) fn of(one: &Written, wanted: &Expected) -> Self {
        let Expected { segment, point, is_retracted, .. } = *wanted;
        Self { file: one.file.clone(), line: one.line, segment, point, is_retracted }
    }
}

/// A move that hits what stands around.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MoveHit {
    /// The move.
    pub at: MovePlace,
    /// The names of the two that come too near to each other.
    pub pair: String,
}

/// A line of the tool that the arm cannot follow.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnfollowedMove {
    /// The move.
    pub at: MovePlace,
    /// Why.
    pub end: LineEnd,
}

/// A deviation and where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest {
    /// How large, in the unit of the field.
    pub value: f64,
    /// The move.
    pub at: MovePlace,
}

impl Largest {
    /// Keeps a deviation where it is larger than that known.
    pub(super) fn keep(known: &mut Option<Self>, value: f64, one: &Written, wanted: &Expected) {
        // What is no number is larger than any.
        if known.as_ref().is_none_or(|found| value > found.value || value.is_nan()) {
            *known = Some(Self { value, at: MovePlace::of(one, wanted) });
        }
    }
}

/// How a program compares with its plan.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramCheck {
    /// The program.
    pub file: PathBuf,
    /// How many moves it has.
    pub moves: usize,
    /// How many of them to joint angles.
    pub joint_moves: usize,
    /// How many moves the plan asks for.
    pub expected_moves: usize,
    /// The largest distance of the tool centre point from where it should be. mm
    pub position: Option<Largest>,
    /// The largest angle of the tool to how it should be turned. deg
    pub angle: Option<Largest>,
    /// The largest distance of the contact of a leaning tool, by tip and axis in the program, from that of the task.
    /// mm
    pub contact: Option<Largest>,
    /// The largest that is allowed. mm
    pub contact_allowed: f64,
    /// The first way in which the moves are others than the plan's, but for their places.
    pub mismatch: Option<String>,
    /// The moves between segments that hit what stands around.
    pub hits: Vec<MoveHit>,
    /// The lines between path points that the arm cannot follow.
    pub unfollowed: Vec<UnfollowedMove>,
    /// The files that it was compared with.
    pub inputs: Vec<InputFile>,
}

impl ProgramCheck {
    /// Whether the program is that of the plan, within 0.01 mm and 0.01 deg, and a leaning tool touches where it does
    /// in the task.
    pub fn is_sound(&self) -> bool {
        let within = |largest: &Option<Largest>, limit: f64| largest.as_ref().is_some_and(|found| found.value <= limit);
        let touches = self.contact.as_ref().is_none_or(|found| found.value <= self.contact_allowed);
        self.mismatch.is_none() && touches && within(&self.position, POSITION_MM) && within(&self.angle, ANGLE_DEG)
    }
}
