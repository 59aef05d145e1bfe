//! Reports of a program: what was written with the frames for the operator, and how a program that is read back compares.

use crate::document::Document;
use serde_json::{Value, json};
use stead_format::program::check::{ANGLE_DEG, Largest, MoveHit, MovePlace, POSITION_MM, ProgramCheck, UnfollowedMove};
use stead_format::program::{OperatorFrame, Program, Rotation};

/// What `stead export --json` prints.
pub fn program_json(program: &Program) -> Value {
    Document::new(&program.inputs).notes(&program.notes).warnings(&program.warnings).with(json!({
        "robot": program.robot,
        "program_format": program.format.word(),
        "name": program.name,
        "segments": program.segments,
        "joint_moves": program.joint_moves,
        "linear_moves": program.linear_moves,
        "parts": program.parts,
        "uncorrected": program.uncorrected,
        "frames": program.frames.iter().map(frame_json).collect::<Value>(),
        "files": program.files.iter().map(|file| file.name.as_str()).collect::<Value>(),
    }))
}

fn frame_json(frame: &OperatorFrame) -> Value {
    let mut entry = json!({ "name": frame.name, "what": frame.what, "xyz_mm": frame.xyz_mm });
    let (key, value) = match frame.rotation {
        Rotation::Angles(names, angles) => (format!("{}_deg", names.concat().to_ascii_lowercase()), json!(angles)),
        Rotation::Quaternion(parts) => ("quaternion_wxyz".to_owned(), json!(parts)),
    };
    if let Value::Object(entries) = &mut entry {
        entries.insert(key, value);
    }
    entry
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
        text.push_str(&format!(
            "{} as planned, for they could not be corrected\n",
            plural(program.uncorrected, "point")
        ));
    }
    if !program.frames.is_empty() {
        text.push_str("\nframes at the controller:\n");
        program.frames.iter().for_each(|frame| text.push_str(&format!("  {frame}\n")));
    }
    text
}

/// What `stead export --check --json` prints.
pub fn program_check_json(check: &ProgramCheck) -> Value {
    let largest = |found: &Option<Largest>| {
        found.as_ref().map(|found| {
            let mut entry = place_json(&found.at);
            entry["value"] = json!(found.value);
            entry
        })
    };
    Document::new(&check.inputs).with(json!({
        "program": check.file.display().to_string(),
        "sound": check.is_sound(),
        "moves": check.moves,
        "joint_moves": check.joint_moves,
        "expected_moves": check.expected_moves,
        "position_mm": largest(&check.position),
        "angle_deg": largest(&check.angle),
        "mismatch": check.mismatch,
        "hits": check.hits.iter().map(hit_json).collect::<Value>(),
        "unfollowed": check.unfollowed.iter().map(unfollowed_json).collect::<Value>(),
        "allowed_mm": POSITION_MM,
        "allowed_deg": ANGLE_DEG,
    }))
}

fn place_json(at: &MovePlace) -> Value {
    json!({
        "file": at.file.display().to_string(),
        "line": at.line,
        "segment": at.segment,
        "point": at.point,
        "retracted": at.is_retracted,
    })
}

fn hit_json(hit: &MoveHit) -> Value {
    let mut entry = place_json(&hit.at);
    entry["pair"] = json!(hit.pair);
    entry
}

fn unfollowed_json(unfollowed: &UnfollowedMove) -> Value {
    let mut entry = place_json(&unfollowed.at);
    entry["since"] = json!(unfollowed.end.to_string());
    entry
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
    let parts = [("position", "mm", &check.position), ("angle", "deg", &check.angle)];
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
