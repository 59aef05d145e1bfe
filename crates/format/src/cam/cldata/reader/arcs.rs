//! Arcs of CLDATA: a word with the circle, and the move behind it to the end.

use super::super::super::Move;
use super::super::super::arc::{Arc, MISSED};
use super::super::super::refusals::*;
use super::super::dialect::ArcForm;
use super::super::statement::Statement;
use super::Reader;
use nalgebra::{Unit, Vector3};
use std::f64::consts::{PI, TAU};
use stead_disk::input::InputError;

/// An arc that the next point ends.
pub(super) struct Pending {
    pub line: usize,
    /// In the workpiece frame. m
    centre: Vector3<f64>,
    axis: Vector3<f64>,
    radius: Option<f64>,
    /// Whole turns of a helix.
    turns: Option<u32>,
    /// Angle of the turn as it is stated. rad
    angle: Option<f64>,
    /// Whether the sense of the turn is stated, not told from the axis.
    is_certain: bool,
}

/// The most turns of a helix.
const MOST_TURNS: f64 = 1000.0;
/// A stated turn fits one that differs by less. rad
const ANGLE_ROUNDING: f64 = PI / 180.0;
/// A point that is nearer to the circle of the arc before goes on along it. m
const ON_CIRCLE: f64 = 2e-5;

impl Reader<'_> {
    /// Takes the word of an arc.
    pub(super) fn arc(&mut self, statement: &Statement<'_>, form: ArcForm) -> Result<(), InputError> {
        self.no_cycle_is_open(statement)?;
        let given = self.numbers(statement, &[], form.allowed)?;
        let way =
            form.ways.iter().find(|way| way.count == given.len() && statement.worded().eq_ignore_ascii_case(way.words));
        let is_of_numbers = statement.words().next().is_none();
        let problem = if is_of_numbers { statement.counted() } else { WORDS_OF_ARC.to_owned() };
        let way = way.ok_or_else(|| statement.fail((problem, form.allowed)))?;
        let (unit, frame, line) = (self.unit.metres(), self.course.frame, statement.line);
        let number = |place: Option<usize>| place.map(|place| given[place]);
        let at = |place: usize| Vector3::new(given[place], given[place + 1], given[place + 2]);
        let (turns, angle, radius) =
            (number(way.turns), number(way.angle), number(way.radius).map(|radius| radius * unit));
        let is_usual = turns.is_none_or(|turns| turns.fract() == 0.0 && (1.0..=MOST_TURNS).contains(&turns))
            && angle.is_none_or(|angle| (0.0..=361.0).contains(&angle));
        ensure!(is_usual, statement.fail((WORDS_OF_ARC, form.allowed)));
        let centre = frame.place(at(0) * unit);
        let axis = frame.rotation * at(3) * way.hand.unwrap_or_default();
        let angle = angle.map(f64::to_radians).filter(|angle| *angle > 0.0);
        let turns = turns.map(|turns| turns as u32);
        let is_certain = way.hand.is_none();
        let mut pending = Pending { line, centre, axis, radius, turns, angle, is_certain };
        if is_certain {
            let tangent = self.state.tangent.take();
            let tangent = tangent.ok_or_else(|| statement.fail((NO_WAY_OUT, form.allowed)))?;
            pending.axis = (self.start_of_arc(statement)?.position - centre).cross(&tangent);
            let is_along = pending.axis.norm() > 0.5 * radius.unwrap_or_default();
            ensure!(is_along, statement.fail((NOT_ALONG, form.allowed)));
            let place = at(given.len() - 3) * unit;
            self.end_arc(statement, pending, self.end(statement, place))?;
            self.course.place = <[f64; 3]>::from(place).map(Some);
        } else {
            self.state.pending = Some(pending);
        }
        Ok(())
    }

    fn start_of_arc(&self, statement: &Statement<'_>) -> Result<Move, InputError> {
        let is_known = !self.course.is_after_change && self.course.place.iter().all(Option::is_some);
        let start = self.course.program.moves.last().filter(|_| is_known);
        start.copied().ok_or_else(|| statement.fail(NO_START))
    }

    /// Goes along an arc to its end.
    pub(super) fn end_arc(&mut self, statement: &Statement<'_>, arc: Pending, end: Move) -> Result<(), InputError> {
        let start = self.start_of_arc(statement)?.position;
        ensure!(!end.is_rapid, statement.fail(RAPID_ARC));
        let Pending { line, centre, radius, turns, angle, mut is_certain, .. } = arc;
        let axis = Unit::try_new(arc.axis, 1e-9).ok_or_else(|| statement.fail(NO_AXIS_OF_ARC))?;
        let written = Arc { start, end: end.position, centre, axis, more_turns: 0 };
        let (mut arc, turn, found) = (written, written.turn(), written.distance(start));
        let stated = radius.unwrap_or(found);
        ensure!((stated - found).abs() < MISSED, statement.fail(misses_start([found, stated])));
        if let Some(turns) = turns {
            let off = found * turn.min(TAU - turn);
            ensure!(off < MISSED, statement.fail(no_whole_turns(off)));
            arc.more_turns = if turn < PI { turns } else { turns - 1 };
        }
        if let Some(angle) = angle {
            let rounding = ANGLE_ROUNDING.max(2.0 * MISSED / found.max(MISSED));
            let fits = |turn: f64| (turn - angle).abs() < rounding;
            let other = Arc { axis: -axis, ..arc };
            is_certain = fits(turn) != fits(other.turn());
            if is_certain && !fits(turn) {
                arc = other;
                self.course.program.note("arcs taken the way round that their angle fits", line);
            }
            ensure!(fits(arc.turn()), statement.fail(another_angle([turn, angle])));
        }
        let rise = arc.rise();
        let may_rise = turns.is_some() || self.dialect.arcs_go_on || rise.abs() < MISSED;
        ensure!(may_rise, statement.fail(out_of_plane(rise.abs())));
        self.course.go_round(arc, end, is_certain, line).map_err(|words| statement.fail(words))?;
        self.state.circle = Some((written, rise / arc.turn())).filter(|_| self.dialect.arcs_go_on);
        Ok(())
    }

    /// The arc to a point on the circle of the arc before.
    pub(super) fn on_circle(&self, end: &Move) -> Option<Arc> {
        let (circle, rise) = self.state.circle.filter(|_| !end.is_rapid)?;
        let start = self.course.program.moves.last()?.position;
        let arc = Arc { start, end: end.position, ..circle };
        let [from, to] = [start, end.position].map(|point| arc.distance(point));
        let off = (from - to).abs().max((arc.rise() - rise * arc.turn()).abs());
        let has_moved = (end.position - start - arc.axis.scale(arc.rise())).norm() > ON_CIRCLE;
        (off < ON_CIRCLE && has_moved).then_some(arc)
    }
}
