//! Points of CLDATA: where a statement leads to, and the holes of cycles.

use super::super::super::Move;
use super::super::super::course::NO_LENGTH;
use super::super::dialect::{Ends, Three};
use super::super::statement::Statement;
use super::{FRAME_ROUNDING, Holes, Reader};
use nalgebra::Vector3;
use stead_disk::input::InputError;

impl Reader<'_> {
    pub(super) fn goto(&mut self, statement: &Statement<'_>, ends: Ends) -> Result<(), InputError> {
        const ALLOWED: &str = "3 or 6 finite numbers";
        if ends == Ends::Home && statement.minors.is_empty() {
            self.course.forget([true; 3], "GOHOME", statement.line);
            self.course.is_after_change = true;
            return Ok(());
        }
        let given = self.numbers(statement, |_| true, ALLOWED)?;
        let (is_on_arc, mut places) = (self.pending.is_some() || self.circle.is_some(), &given[..]);
        let axis = |numbers: &[f64]| Vector3::new(numbers[3], numbers[4], numbers[5]);
        let is_direction = |numbers: &[f64]| (axis(numbers).norm() - 1.0).abs() < FRAME_ROUNDING;
        let are_points = self.dialect.arcs_go_on && is_on_arc && given.len() > 3 && given.len().is_multiple_of(3);
        match given.len() {
            _ if statement.words().next().is_some() => {
                return Err(self.fail(statement, &format!("{} numbers that can be read", given.len()), ALLOWED));
            }
            3 => self.stand_by_three(statement)?,
            6 if !are_points || is_direction(&given) => {
                let axis = axis(&given);
                let length = axis.norm();
                if length < NO_LENGTH {
                    return Err(self.fail(statement, "the tool axis has no length", "a direction, as 0,0,1"));
                }
                if (length - 1.0).abs() > FRAME_ROUNDING {
                    self.course.program.note("tool axes made of unit length");
                }
                self.course.axis = axis / length;
                places = &given[..3];
            }
            _ if are_points => self.stand_by_three(statement)?,
            count => return Err(self.fail(statement, &format!("{count} numbers that can be read"), ALLOWED)),
        }
        for place in places.chunks_exact(3) {
            let place = Vector3::from_column_slice(place) * self.unit.metres();
            self.to(statement, ends, place)?;
        }
        Ok(())
    }

    /// The tool axis of a point with three numbers.
    fn stand_by_three(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let is_tilted = (self.course.axis - Vector3::z()).norm() > NO_LENGTH;
        match self.dialect.three {
            Three::Upright => self.course.axis = Vector3::z(),
            Three::Asked if self.is_three_axis && is_tilted => {
                let problem = "three numbers behind MULTAX/OFF while the tool is tilted: in some systems its axis holds, in others it is 0,0,1";
                let allowed = "the system that wrote the file: --format catia, nx or solidworks (it holds), autodesk, camplete or creo (0,0,1)";
                return Err(self.fail(statement, problem, allowed));
            }
            Three::Holds | Three::Asked => {}
        }
        Ok(())
    }

    /// Moves to a place in the frame. m
    fn to(&mut self, statement: &Statement<'_>, ends: Ends, place: Vector3<f64>) -> Result<(), InputError> {
        let frame = self.course.frame;
        let known = [place.x, place.y, place.z].map(Some);
        let mut end = Move {
            position: frame.place(place),
            axis: frame.rotation * self.course.axis,
            feed: self.course.feed,
            is_rapid: std::mem::take(&mut self.is_rapid) || ends != Ends::To,
            is_arc: false,
            line: statement.line,
        };
        if let Some(pending) = self.pending.take() {
            self.end_arc(statement, pending, end)?;
        } else if let Some(arc) = self.on_circle(&end) {
            self.draw(statement, arc, end, true, statement.line)?;
        } else if let (Some(_), Ends::To) = (&self.holes, ends) {
            self.hole(statement, end)?;
        } else {
            self.circle = None;
            if !end.is_rapid {
                end.is_rapid = !self.course.is_cut(known);
            }
            self.course.go(end);
            self.course.is_after_change = ends != Ends::To;
        }
        self.course.place = known;
        self.tangent = None;
        Ok(())
    }

    /// A hole at a point.
    fn hole(&mut self, statement: &Statement<'_>, end: Move) -> Result<(), InputError> {
        match &self.holes {
            Some((Holes::Drilled(cycle), _)) => {
                let unit = self.unit.metres();
                let above = |height: f64| end.position + end.axis * (height * unit);
                let feed = match &cycle.feed {
                    Some((value, word)) => Some(self.feed_in(statement, *value, word)?),
                    None => self.course.feed,
                };
                self.course.program.moves.extend([
                    Move { position: above(cycle.clear), is_rapid: true, ..end },
                    Move { position: above(-cycle.depth), is_rapid: false, feed, ..end },
                    Move { position: above(cycle.retract), is_rapid: true, ..end },
                ]);
                self.course.program.note("holes of drilling cycles taken as a plunge and a rapid retract, not scored");
                self.course.is_after_change = false;
            }
            _ => {
                self.course.program.holes_left_out.push((end.position, statement.line));
                self.course.is_after_change = true;
            }
        }
        self.course.end_run();
        Ok(())
    }
}
