//! Arcs of CLDATA: a word with the circle, and the move behind it to the end.

use super::super::super::Move;
use super::super::super::arc::{Arc, MISSED, millimetres};
use super::super::super::refusals::*;
use super::super::dialect::ArcForm;
use super::super::statement::Statement;
use super::Reader;
use nalgebra::Vector3;
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
    /// What an arc that goes on rises in a turn of 1 rad. m
    rise: f64,
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
        let way = form.ways.iter().find(|way| way.count == given.len() && statement.has_just(way.words));
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
        let mut pending = Pending { line, centre, axis, radius, turns, angle, is_certain, rise: 0.0 };
        if is_certain {
            let tangent = self.state.tangent.take();
            let tangent = tangent.ok_or_else(|| statement.fail((NO_WAY_OUT, form.allowed)))?;
            pending.axis = (self.start_of_arc(statement)?.position - centre).cross(&tangent);
            let is_along = pending.axis.norm() > 0.5 * radius.unwrap_or_default();
            ensure!(is_along, statement.fail((NOT_ALONG, form.allowed)));
            let place = at(given.len() - 3) * unit;
            self.end_arc(statement, pending, self.end(statement, place))?;
            self.course.place = [place.x, place.y, place.z].map(Some);
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
    pub(super) fn end_arc(
        &mut self,
        statement: &Statement<'_>,
        mut pending: Pending,
        end: Move,
    ) -> Result<(), InputError> {
        let start = self.start_of_arc(statement)?.position;
        ensure!(!end.is_rapid, statement.fail(RAPID_ARC));
        let Pending { centre, axis, turns, angle, .. } = pending;
        let mut arc = Arc { start, end: end.position, centre, axis, more_turns: 0 };
        if let Some(found) = arc.radius() {
            let (turn, stated) = (arc.turn(), pending.radius.unwrap_or(found));
            let problem = || {
                let [found, stated] = [found, stated].map(millimetres);
                format!("the arc misses its start: radius {found}, stated {stated}")
            };
            ensure!((stated - found).abs() < MISSED, statement.fail((problem(), SAME_RADIUS)));
            if let Some(turns) = turns {
                let off = found * turn.min(TAU - turn);
                let problem = || format!("a helix whose end is {} beside its start, along the turn", millimetres(off));
                ensure!(off < MISSED, statement.fail((problem(), WHOLE_TURNS)));
                arc.more_turns = if turn < PI { turns } else { turns - 1 };
            }
            if let Some(angle) = angle {
                let rounding = ANGLE_ROUNDING.max(2.0 * MISSED / found.max(MISSED));
                let fits = |turn: f64| (turn - angle).abs() < rounding;
                let other = Arc { axis: -axis, ..arc };
                pending.is_certain = fits(turn) != fits(other.turn());
                if pending.is_certain && !fits(turn) {
                    arc = other;
                    self.course.program.note("arcs taken the way round that their angle fits", pending.line);
                }
                let problem = || {
                    let [turn, angle] = [turn, angle].map(f64::to_degrees);
                    format!("the arc turns by {turn:.3} deg to its end, and {angle:.3} are stated")
                };
                ensure!(fits(arc.turn()), statement.fail((problem(), SAME_ANGLE)));
            }
            let rise = arc.rise().abs();
            let may_rise = turns.is_some() || self.dialect.arcs_go_on || rise < MISSED;
            let problem = || format!("the arc misses its end, which is {} out of its plane", millimetres(rise));
            ensure!(may_rise, statement.fail((problem(), IN_PLANE)));
        }
        let drawn = self.course.go_round(arc, end, pending.is_certain, pending.line);
        drawn.map_err(|words| statement.fail(words))?;
        if self.dialect.arcs_go_on {
            pending.rise = arc.rise() / arc.turn();
            self.state.circle = Some(pending);
        }
        Ok(())
    }

    /// The arc to a point on the circle of the arc before.
    pub(super) fn on_circle(&self, end: &Move) -> Option<Arc> {
        let Pending { centre, axis, rise, .. } = *self.state.circle.as_ref().filter(|_| !end.is_rapid)?;
        let start = self.course.program.moves.last()?.position;
        let arc = Arc { start, end: end.position, centre, axis, more_turns: 0 };
        let [from, to] = [start, end.position].map(|point| arc.distance(point));
        let off = (from - to).abs().max((arc.rise() - rise * arc.turn()).abs());
        let has_moved = (end.position - start - axis.normalize() * arc.rise()).norm() > ON_CIRCLE;
        (off < ON_CIRCLE && has_moved).then_some(arc)
    }
}
