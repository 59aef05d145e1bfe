//! Reports of a program: what was written with the frames for the operator, and how a program that is read back
//! compares.

use crate::document::Document;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use stead_programs::check::{ANGLE_DEG, Largest, MoveHit, MovePlace, POSITION_MM, ProgramCheck, UnfollowedMove};
use stead_programs::{OperatorFrame, Program, Rotation};

records! {
    /// A program that was written.
    pub struct ProgramFigures of (program: &Program) {
        /// Name of the robot.
        robot: String = program.robot.clone(),
        /// The language of the program.
        program_format: &'static str = program.format.word(),
        /// Its name.
        name: String = program.name.clone(),
        /// Segments of the path.
        segments: usize = program.segments,
        /// Moves to joint angles.
        joint_moves: usize = program.joint_moves,
        /// Moves on lines.
        linear_moves: usize = program.linear_moves,
        /// Parts that it is divided into.
        parts: usize = program.parts,
        /// Points that are as planned, for they could not be corrected.
        uncorrected: usize = program.uncorrected,
        /// Frames for the operator.
        frames: Vec<FrameFigures> = program.frames.iter().map(Into::into).collect(),
        /// Names of its files.
        files: Vec<String> = program.files.iter().map(|file| file.name.clone()).collect(),
    }

    /// A frame that the operator sets at the controller.
    pub struct FrameFigures from frame: &OperatorFrame {
        let rotation = match frame.rotation {
            Rotation::Angles(names, angles) => {
                let key = format!("{}_deg", names.concat().to_ascii_lowercase());
                RotationFigures::Angles(BTreeMap::from([(key, angles)]))
            }
            Rotation::Quaternion(quaternion_wxyz) => RotationFigures::Quaternion { quaternion_wxyz },
        };
    } with {
        /// Its name at the controller.
        name: &'static str = frame.name,
        /// What it is.
        what: &'static str = frame.what,
        /// Its origin. mm
        xyz_mm: [f64; 3] = frame.xyz_mm,
        #[serde(flatten)] rotation: RotationFigures = rotation,
    }
}

/// A rotation as a controller states it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
enum RotationFigures {
    /// Angles under the names that the controller has for them: `abc_deg`. deg
    Angles(BTreeMap<String, [f64; 3]>),
    /// A quaternion.
    Quaternion {
        /// Its parts.
        quaternion_wxyz: [f64; 4],
    },
}

/// What `stead export --json` prints.
pub fn program_json(program: &Program) -> Value {
    Document::new(&program.inputs).notes(&program.notes).warnings(&program.warnings).with(ProgramFigures::of(program))
}

/// What `stead export` prints, without the files.
pub fn program_text(program: &Program) -> String {
    let moves = program.joint_moves + program.linear_moves;
    let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
    let mut text = format!(
        "{}: {} for {}\n{}, {} ({} to joint angles, {} on lines) in {}\n",
        program.name,
        program.format.word(),
        program.robot,
        plural(program.segments, "segment"),
        plural(moves, "move"),
        program.joint_moves,
        program.linear_moves,
        plural(program.parts, "part"),
    );
    if program.uncorrected > 0 {
        let points = plural(program.uncorrected, "point");
        text.push_str(&format!("{points} as planned, for they could not be corrected\n"));
    }
    if !program.frames.is_empty() {
        text.push_str("\nframes at the controller:\n");
        program.frames.iter().for_each(|frame| text.push_str(&format!("  {frame}\n")));
    }
    text
}

records! {
    /// How a program that is read back compares with its plan.
    pub struct ProgramCheckFigures of (check: &ProgramCheck) {
        /// The file of the program.
        program: String = check.file.display().to_string(),
        /// Whether it does what the plan asks for.
        sound: bool = check.is_sound(),
        /// Moves read.
        moves: usize = check.moves,
        /// Moves to joint angles among them.
        joint_moves: usize = check.joint_moves,
        /// Moves that the plan asks for.
        expected_moves: usize = check.expected_moves,
        /// Largest deviation of a position. mm
        position_mm: Option<LargestFigures> = check.position.as_ref().map(LargestFigures::of),
        /// Largest deviation of an angle. deg
        angle_deg: Option<LargestFigures> = check.angle.as_ref().map(LargestFigures::of),
        /// Largest deviation of the contact of a leaning tool, from tip and axis in the program. mm
        contact_mm?: LargestFigures = check.contact.as_ref().map(LargestFigures::of),
        /// Why the program is another one.
        mismatch: Option<String> = check.mismatch.as_ref().map(ToString::to_string),
        /// Moves that hit.
        hits: Vec<HitFigures> = check.hits.iter().map(HitFigures::of).collect(),
        /// Moves that the arm cannot follow.
        unfollowed: Vec<UnfollowedFigures> = check.unfollowed.iter().map(UnfollowedFigures::of).collect(),
        /// Largest deviation of a position that is allowed. mm
        allowed_mm: f64 = POSITION_MM,
        /// Largest deviation of an angle that is allowed. deg
        allowed_deg: f64 = ANGLE_DEG,
        /// Largest deviation of the contact that is allowed, where the tool leans. mm
        allowed_contact_mm?: f64 = check.contact.as_ref().map(|_| check.contact_allowed),
    }

    /// Where a move is.
    pub struct PlaceFigures from at: &MovePlace {
        /// The file.
        file: String = at.file.display().to_string(),
        /// The line in it.
        line: usize = at.line,
        /// The segment, from 1.
        segment: usize = at.segment,
        /// The path point, from 0.
        point: usize = at.point,
        /// Whether the tool is retracted.
        retracted: bool = at.is_retracted,
    }

    /// The largest deviation, and where.
    pub struct LargestFigures of (found: &Largest) {
        #[serde(flatten)] at: PlaceFigures = (&found.at).into(),
        /// The deviation.
        value: f64 = found.value,
    }

    /// A move that hits.
    pub struct HitFigures of (hit: &MoveHit) {
        #[serde(flatten)] at: PlaceFigures = (&hit.at).into(),
        /// The two that hit.
        pair: String = hit.pair.to_string(),
    }

    /// A move that the arm cannot follow.
    pub struct UnfollowedFigures of (found: &UnfollowedMove) {
        #[serde(flatten)] at: PlaceFigures = (&found.at).into(),
        /// Why not.
        since: String = found.end.to_string(),
    }
}

/// What `stead export --check --json` prints.
pub fn program_check_json(check: &ProgramCheck) -> Value {
    Document::new(&check.inputs).with(ProgramCheckFigures::of(check))
}

/// What `stead export --check` prints.
pub fn program_check_text(check: &ProgramCheck) -> String {
    let mut text = format!(
        "{}: {} moves read back, {} to joint angles; the plan asks for {}\n",
        check.file.display(),
        check.moves,
        check.joint_moves,
        check.expected_moves
    );
    let parts =
        [("position", "mm", &check.position), ("angle", "deg", &check.angle), ("contact", "mm", &check.contact)];
    for (name, unit, largest) in parts {
        let Some(Largest { value, at }) = largest else { continue };
        let retracted = if at.is_retracted { ", retracted" } else { "" };
        text.push_str(&format!(
            "largest deviation in {name}: {value:.5} {unit}, at {}:{} (segment {}, point {}{retracted})\n",
            at.file.display(),
            at.line,
            at.segment,
            at.point
        ));
    }
    for MoveHit { at, pair } in &check.hits {
        text.push_str(&format!("{}:{} hits: {pair} (segment {})\n", at.file.display(), at.line, at.segment));
    }
    for UnfollowedMove { at, end } in &check.unfollowed {
        let (file, line) = (at.file.display(), at.line);
        text.push_str(&format!("{file}:{line} the arm cannot follow: {end} (segment {})\n", at.segment));
    }
    if let Some(mismatch) = &check.mismatch {
        text.push_str(&format!("{mismatch}\n"));
    }
    text
}
