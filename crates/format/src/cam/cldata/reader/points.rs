//! Points of CLDATA: where a statement leads to, and the holes of cycles.

use super::super::super::Move;
use super::super::super::course::NO_LENGTH;
use super::super::super::refusals::*;
use super::super::dialect::{Ends, Three};
use super::super::statement::Statement;
use super::{FRAME_ROUNDING, Reader};
use nalgebra::Vector3;
use stead_disk::input::InputError;

impl Reader<'_> {
    pub(super) fn goto(&mut self, statement: &Statement<'_>, ends: Ends) -> Result<(), InputError> {
        if ends == Ends::Home && statement.minors.is_empty() {
            self.course.forget([true; 3], "GOHOME", statement.line);
            self.course.is_after_change = true;
            return Ok(());
        }
        let given = self.numbers(statement, &[], NUMBERS_OF_POINT)?;
        let is_on_arc = self.state.pending.is_some() || self.state.circle.is_some();
        let are_points = self.dialect.arcs_go_on && is_on_arc && given.len() > 3 && given.len().is_multiple_of(3);
        let axis = given.get(3..).filter(|axis| axis.len() == 3).map(Vector3::from_column_slice);
        let axis = axis.filter(|axis| !are_points || (axis.norm() - 1.0).abs() < FRAME_ROUNDING);
        let is_form = (axis.is_some() || given.len() == 3 || are_points) && statement.words().next().is_none();
        ensure!(is_form, statement.fail((statement.counted(), NUMBERS_OF_POINT)));
        match axis {
            Some(axis) => {
                let length = axis.norm();
                ensure!(length > NO_LENGTH, statement.fail(NO_TOOL_AXIS));
                if (length - 1.0).abs() > FRAME_ROUNDING {
                    self.course.program.note("tool axes made of unit length", statement.line);
                }
                self.course.axis = axis / length;
            }
            None => {
                let is_tilted = (self.course.axis - Vector3::z()).norm() > NO_LENGTH;
                let is_asked = self.dialect.three == Three::Asked && self.state.is_three_axis && is_tilted;
                ensure!(!is_asked, statement.fail(THREE_ASKED));
                if self.dialect.three == Three::Upright {
                    self.course.axis = Vector3::z();
                }
            }
        }
        let places = if axis.is_some() { &given[..3] } else { &given[..] };
        let unit = self.unit.metres();
        places.chunks_exact(3).try_for_each(|place| self.to(statement, ends, Vector3::from_column_slice(place) * unit))
    }

    /// The end of a move to a place in the frame (m).
    pub(super) fn end(&self, statement: &Statement<'_>, place: Vector3<f64>) -> Move {
        let frame = &self.course.frame;
        let (position, axis) = (frame.place(place), frame.rotation * self.course.axis);
        Move { position, axis, feed: self.course.feed, is_rapid: false, is_fixed: false, line: statement.line }
    }

    /// Moves to a place in the frame. m
    fn to(&mut self, statement: &Statement<'_>, ends: Ends, place: Vector3<f64>) -> Result<(), InputError> {
        let known = <[f64; 3]>::from(place).map(Some);
        let mut end = self.end(statement, place);
        end.is_rapid = std::mem::take(&mut self.state.is_rapid) || ends != Ends::To;
        self.state.tangent = None;
        if let Some(pending) = self.state.pending.take() {
            self.end_arc(statement, pending, end)?;
        } else if let Some(arc) = self.on_circle(&end) {
            self.course.go_round(arc, end, true, statement.line).map_err(|words| statement.fail(words))?;
        } else if self.state.holes.is_some() && ends == Ends::To {
            self.hole(statement, end)?;
        } else {
            self.state.circle = None;
            end.is_rapid = end.is_rapid || !self.course.is_cut(known, statement.line);
            self.course.go(end);
            self.course.is_after_change = ends != Ends::To;
        }
        self.course.place = known;
        Ok(())
    }

    /// A hole at a point.
    fn hole(&mut self, statement: &Statement<'_>, end: Move) -> Result<(), InputError> {
        if let Some((Some(cycle), _)) = &self.state.holes {
            let above = |height: f64| end.position + end.axis * (height * self.unit.metres());
            let own = cycle.feed.as_ref().map(|(value, word)| self.feed_in(statement, *value, word)).transpose()?;
            self.course.program.moves.extend([
                Move { position: above(cycle.clear), is_rapid: true, ..end },
                Move { position: above(-cycle.depth), is_rapid: false, feed: own.or(end.feed), ..end },
                Move { position: above(cycle.retract), is_rapid: true, ..end },
            ]);
            let note = "holes of drilling cycles taken as a plunge and a rapid retract, not scored";
            self.course.program.note(note, statement.line);
        } else {
            self.course.program.holes_left_out.push((end.position, statement.line));
        }
        self.course.is_after_change = self.settings.skip_cycles;
        self.course.end_run();
        Ok(())
    }
}
