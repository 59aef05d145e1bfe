//! Moves of G-code: where a block leads to, arcs, turns of the tool, and holes that are left out.

use super::super::super::arc::Arc;
use super::super::super::refusals::*;
use super::super::super::{LARGEST, Move};
use super::super::block::{Block, Word};
use super::super::codes::{Code, code_of};
use super::super::motion::Motion;
use super::Reader;
use nalgebra::{Rotation3, Unit, Vector3};
use stead_disk::input::InputError;

/// No rotary axis is programmed beyond this. deg
pub(super) const LARGEST_ANGLE: f64 = 3.6e4;
/// Moves are taken in parts in which no rotary axis turns by more than this. rad
const TURN_STEP: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// A radius may be so much less than half the way to the end: digits as printed. m
const ROUNDING: f64 = 5e-5;
/// A hole is repeated no more often than this.
const MOST_REPEATS: f64 = 1000.0;

/// Where a block leads to: the programmed position in the frame (m), as far as it is known, and angles (rad).
#[derive(Clone, Copy)]
pub(super) struct Target {
    place: [Option<f64>; 3],
    angles: [f64; 3],
}

impl Target {
    fn position(&self) -> Vector3<f64> {
        Vector3::from(self.place.map(Option::unwrap_or_default))
    }

    /// The straight move to an end in parts in which the tool turns a little, the end last.
    fn parts_to(&self, end: &Self) -> Vec<Self> {
        let turn = (0..3).map(|k| (end.angles[k] - self.angles[k]).abs()).fold(0.0, f64::max);
        let parts = (turn / TURN_STEP - 1e-6).ceil().clamp(1.0, 1e5) as u32;
        let between = |from: f64, to: f64, part: u32| from + (to - from) * f64::from(part) / f64::from(parts);
        let place = |k: usize, part| self.place[k].zip(end.place[k]).map(|(from, to)| between(from, to, part));
        let at = |part| Self {
            place: std::array::from_fn(|k| place(k, part)),
            angles: std::array::from_fn(|k| between(self.angles[k], end.angles[k], part)),
        };
        (1..parts).map(at).chain([*end]).collect()
    }
}

impl Reader<'_> {
    /// Moves to the position of a block.
    pub(super) fn travel(&mut self, block: &Block<'_>) -> Result<(), InputError> {
        let first = block.first("XYZABCIJKR");
        let motion = self.modes.motion.ok_or_else(|| block.fail(first, NO_MOTION))?;
        ensure!(self.modes.unit.is_some(), block.fail(first, NO_UNIT_BEFORE));
        if motion == Motion::Cycle {
            return self.leave_out_hole(block);
        }
        let is_arc = matches!(motion, Motion::Clockwise | Motion::CounterClockwise);
        ensure!(!is_arc || !self.course.is_after_change, block.fail(first, ARC_AT_CHANGE));
        ensure!(is_arc || !block.has("IJKR"), block.fail_at("IJKR", CENTRE_OF_NONE));
        let end = self.target(block)?;
        if end.angles != [0.0; 3] && !self.modes.is_controlled && self.settings.pivot.is_none() {
            // Where the tip of the turned tool is cannot be told: no cut goes there, and it is not known behind.
            let word = block.first(if block.has("ABC") { "ABC" } else { "XYZ" });
            ensure!(motion == Motion::Rapid, block.fail(word, UNCONTROLLED));
            self.course.program.note(TURNED, block.line);
            (self.course.is_after_change, self.modes.angles) = (false, end.angles);
            self.course.forget([true; 3], "a turn without tool centre point control", block.line);
            return Ok(());
        }
        if motion == Motion::Rapid || self.course.program.moves.is_empty() {
            self.course.is_after_change = false;
        }
        let is_cut = motion != Motion::Rapid && self.course.is_cut(end.place, block.line);
        let from = Target { place: self.course.place, angles: self.modes.angles };
        let first_move = self.course.program.moves.len();
        if is_arc && is_cut {
            self.go_round(block, motion, &from, &end)?;
        } else if end.place.iter().all(Option::is_some) {
            for part in if is_cut { from.parts_to(&end) } else { vec![end] } {
                let part = self.end(block, &part, !is_cut)?;
                self.course.go(part);
            }
        }
        if is_cut {
            let feed = self.feed_of(block, first, first_move)?;
            self.course.program.moves[first_move..].iter_mut().for_each(|one| one.feed = feed);
        }
        (self.course.place, self.modes.angles) = (end.place, end.angles);
        Ok(())
    }

    /// How the tool stands in the frame at angles of the rotary axes, and where its tip is. m
    pub(super) fn pose(&self, programmed: Vector3<f64>, angles: [f64; 3]) -> (Rotation3<f64>, Vector3<f64>) {
        let machine = self.settings.machine.filter(|_| !self.modes.is_tilted);
        let Some(machine) = machine else { return (Rotation3::identity(), programmed) };
        let pivot = self.settings.pivot.filter(|_| !self.modes.is_controlled);
        let tip = pivot.map_or(programmed, |pivot| machine.tip(programmed, angles, pivot));
        (machine.workpiece_from_tool(angles), tip)
    }

    /// The end of a move.
    fn end(&mut self, block: &Block<'_>, to: &Target, is_rapid: bool) -> Result<Move, InputError> {
        self.has_turned[usize::from(self.modes.is_controlled)] |= to.angles != [0.0; 3];
        let (rotation, tip) = self.pose(to.position(), to.angles);
        let frame = &self.course.frame;
        let (position, axis) = (frame.place(tip), frame.rotation * (rotation * self.course.axis));
        ensure!(position.amax() <= 2.0 * LARGEST, block.fail(('X', to.position().x), FAR_PLACE));
        Ok(Move { position, axis, feed: None, is_rapid, is_fixed: false, line: block.line })
    }

    /// Goes along an arc.
    fn go_round(&mut self, block: &Block<'_>, motion: Motion, from: &Target, end: &Target) -> Result<(), InputError> {
        ensure!(end.angles == from.angles, block.fail_at("ABC", TURNING_ARC));
        let is_plain = self.settings.machine.is_none() || end.angles == [0.0; 3];
        ensure!(is_plain, block.fail_at("IJKR", TILTED_ARC));
        let mut axis = Vector3::zeros();
        axis[self.modes.plane] = if motion == Motion::Clockwise { -1.0 } else { 1.0 };
        let ends = [from.position(), end.position()];
        let centre = centre(block, &axis, ends, self.metres())?;
        let frame = self.course.frame;
        let [start, end_of_arc, centre] = [ends[0], ends[1], centre].map(|place| frame.place(place));
        let axis = Unit::new_normalize(frame.rotation * axis);
        let arc = Arc { start, end: end_of_arc, centre, axis, more_turns: 0 };
        let end = self.end(block, end, false)?;
        self.course.go_round(arc, end, true, block.line).map_err(|words| block.fail_at("IJKR", words))
    }

    /// The feed of the moves of a block, which are there from a place on; nothing where they have no length. m/s
    fn feed_of(&self, block: &Block<'_>, word: Word, from: usize) -> Result<Option<f64>, InputError> {
        if !self.modes.is_inverse_time {
            let feed = self.course.feed.ok_or_else(|| block.fail(word, NO_FEED))?;
            return Ok(Some(feed * self.metres() / 60.0));
        }
        let per_minute = block.get('F').ok_or_else(|| block.fail(word, NO_INVERSE_TIME))?;
        let moves = &self.course.program.moves;
        let length: f64 = moves[from - 1..].windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let before = moves[from - 1].feed.unwrap_or(1e-3);
        Ok(Some(if length > 1e-6 { length * per_minute / 60.0 } else { before }))
    }

    /// Takes a hole of a canned cycle, which is left out: behind it the tool is over it, at R or at the height before.
    fn leave_out_hole(&mut self, block: &Block<'_>) -> Result<(), InputError> {
        let along = self.modes.plane;
        let is_across = |word: &Word| "XYZABC".contains(word.0) && word.0 != ['X', 'Y', 'Z'][along];
        let across: Vec<Word> = block.words.iter().copied().filter(is_across).collect();
        if let Some(plane) = block.get('R') {
            let from = if self.modes.is_incremental { self.modes.heights[0] } else { Some(0.0) };
            self.modes.heights[1] = from.map(|from| from + plane * self.metres());
        }
        let is_begun = block.words.iter().any(|word| word.0 == 'G' && code_of(word.1) == Some(Code::Cycle));
        if across.is_empty() && !is_begun {
            return Ok(());
        }
        let repeats = block.get('L').or(block.get('K')).filter(|_| self.modes.is_incremental).unwrap_or(1.0);
        for _ in 0..repeats.clamp(1.0, MOST_REPEATS) as usize {
            let mut at = self.target(&Block { words: &across, ..*block })?;
            at.place[along] = self.modes.heights[1];
            self.course.program.holes_left_out.push((self.course.frame.place(at.position()), block.line));
            at.place[along] = self.modes.heights[usize::from(self.modes.is_to_plane)];
            if at.place.iter().all(Option::is_some) {
                let end = self.end(block, &at, true)?;
                self.course.go(end);
            }
            (self.course.place, self.modes.angles) = (at.place, at.angles);
        }
        if self.course.place[along].is_none() {
            self.course.forget(std::array::from_fn(|axis| axis == along), "a canned cycle", block.line);
        }
        self.course.is_after_change = false;
        Ok(())
    }

    /// Where a block leads to.
    fn target(&self, block: &Block<'_>) -> Result<Target, InputError> {
        let metres = self.metres();
        let mut end = Target { place: self.course.place, angles: self.modes.angles };
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let Some(value) = block.get(letter) else { continue };
            let word = (letter, value);
            ensure!(value.abs() * metres <= LARGEST, block.fail(word, FAR_PLACE));
            let from = if self.modes.is_incremental { self.course.place[axis] } else { Some(0.0) };
            let from = from.ok_or_else(|| block.fail(word, FROM_NOWHERE))?;
            end.place[axis] = Some(from + value * metres);
        }
        for (axis, letter) in ['A', 'B', 'C'].into_iter().enumerate() {
            let Some(value) = block.get(letter) else { continue };
            let word = (letter, value);
            ensure!(value.abs() <= LARGEST_ANGLE, block.fail(word, FAR_ANGLE));
            let before = if self.modes.is_incremental { self.modes.angles[axis] } else { 0.0 };
            let angle = before + value.to_radians();
            ensure!(!self.modes.is_tilted || angle == 0.0, block.fail(word, AXIS_IN_PLANE));
            end.angles[axis] = angle;
            match self.settings.machine {
                None => ensure!(angle == 0.0, block.fail(word, NO_MACHINE)),
                Some(machine) => ensure!(machine.has(axis), block.fail(word, not_of_machine(machine.word()))),
            }
        }
        Ok(end)
    }
}

/// The centre of the arc of a block between places, in the plane normal to an axis, about which it turns as a
/// right-handed screw; the unit of length of the block is so many metres. m
fn centre(
    block: &Block<'_>,
    axis: &Vector3<f64>,
    ends: [Vector3<f64>; 2],
    metres: f64,
) -> Result<Vector3<f64>, InputError> {
    ensure!(!block.has("P"), block.fail_at("P", SEVERAL_TURNS));
    let offsets = ['I', 'J', 'K'].map(|letter| block.get(letter));
    let Some(radius) = block.get('R') else {
        ensure!(block.has("IJK"), block.fail_at("XYZ", NO_CENTRE));
        let out = axis.iamax();
        let is_in_plane = offsets[out].is_none_or(|offset| offset == 0.0);
        ensure!(is_in_plane, block.fail_at(["I", "J", "K"][out], OUT_OF_PLANE));
        return Ok(ends[0] + Vector3::from(offsets.map(|offset| offset.unwrap_or(0.0) * metres)));
    };
    ensure!(!block.has("IJK"), block.fail_at("R", RADIUS_AND_CENTRE));
    let way = ends[1] - ends[0];
    let way = way - axis * way.dot(axis);
    let (half, size) = (way.norm() / 2.0, (radius * metres).abs());
    ensure!(half > 1e-9, block.fail_at("R", CIRCLE_BY_RADIUS));
    ensure!(size > half - ROUNDING, block.fail_at("R", SMALL_RADIUS));
    // With a negative radius the longer of the two arcs.
    let aside = libm::sqrt((size * size - half * half).max(0.0)) * radius.signum();
    Ok(ends[0] + way / 2.0 + axis.cross(&way).normalize() * aside)
}
