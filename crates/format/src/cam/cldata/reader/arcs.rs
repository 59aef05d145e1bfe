//! Arcs of CLDATA: `CIRCLE` and the `GOTO` that ends it.

use super::super::super::Move;
use super::super::super::arc::{Arc, ArcError, MISSED};
use super::super::statement::{Minor, Statement};
use super::{MOST_TURNS, NO_LENGTH, Pending, Reader, TURNED_BACK};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use stead_disk::input::InputError;

impl Reader<'_> {
    pub(super) fn arc(&mut self, statement: &Statement<'_>, pending: &Pending, end: Move) -> Result<(), InputError> {
        let start = match self.program.moves.last() {
            Some(start) if !self.is_after_change => start,
            _ => return Err(self.fail(statement, "an arc without a start", "a GOTO before CIRCLE")),
        };
        if self.is_rapid {
            return Err(self.fail(statement, "RAPID and CIRCLE for the same move", "an arc as a cutting move"));
        }
        let Pending { centre, axis, radius, .. } = *pending;
        let (from, last) = (start.axis, start.position);
        let mut arc = Arc { start: last, end: end.position, centre, axis, more_turns: 0 };
        let millimetres = |length: f64| format!("{:.4} mm", length * 1e3);
        if let (Some(stated), Some(found)) = (radius, arc.radius())
            && (stated - found).abs() > MISSED
        {
            let problem =
                format!("the arc misses its start: radius {}, stated {}", millimetres(found), millimetres(stated));
            return Err(self.fail(statement, &problem, "the same radius within 0.05 mm"));
        }
        let [out, back] = if axis.norm() > 1e-9 { arc.tangents() } else { [Vector3::zeros(); 2] };
        if let (Some(turns), true) = (pending.turns, axis.norm() > 1e-9) {
            let turn = arc.turn();
            let off = arc.radius().unwrap_or(0.0) * turn.min(TAU - turn);
            if off > MISSED {
                return Err(self.fail(
                    statement,
                    &format!("a helix whose end is {} beside its start, along the turn", millimetres(off)),
                    "whole turns behind TIMES: let the CAM system write straight moves",
                ));
            }
            arc.more_turns = if turn < PI { turns } else { turns - 1 };
        } else if arc.rise().abs() > MISSED {
            let problem =
                format!("the arc misses its end, which is {} out of its plane", millimetres(arc.rise().abs()));
            return Err(self.fail(statement, &problem, "an end in the plane of the arc within 0.05 mm"));
        }
        let points = arc.points(&self.resampling).map_err(|error| match error {
            ArcError::Axis => self.fail(statement, "the axis of the arc has no length", "a direction, as 0,0,1"),
            ArcError::Radius(from, to) => {
                let problem = format!(
                    "the arc misses its end: radius {} at its start, {} there",
                    millimetres(from),
                    millimetres(to)
                );
                self.fail(statement, &problem, "the same radius, above 0, within 0.05 mm")
            }
        })?;
        self.goes_on(Some(out))?;
        self.against = self.arrived.filter(|way| way.dot(&out) < TURNED_BACK).map(|_| pending.line);
        self.arrived = Some(back);
        let count = points.len() as f64;
        self.program.moves.extend(points.into_iter().zip(1..).map(|(position, place): (_, u32)| {
            let share = f64::from(place) / count;
            let axis = (from * (1.0 - share) + end.axis * share).try_normalize(NO_LENGTH).unwrap_or(end.axis);
            Move { position, axis, is_arc: true, ..end }
        }));
        Ok(())
    }

    /// Refuses an arc that sets out against the move before it and arrives against the one behind it, which sets out
    /// along a direction: it would be turned the other way.
    pub(super) fn goes_on(&mut self, way: Option<Vector3<f64>>) -> Result<(), InputError> {
        let turns_back = |before: Vector3<f64>| way.is_some_and(|way| before.dot(&way) < TURNED_BACK);
        match self.against.take() {
            Some(line) if self.arrived.is_some_and(turns_back) => Err(self.fail_at(
                line,
                "CIRCLE",
                "the arc sets out against the move before it and arrives against the one behind it: read the other way round?",
                "arcs with 11 numbers left-handed about their axis, with 6 or 7 right-handed; or straight moves",
            )),
            _ => Ok(()),
        }
    }

    pub(super) fn circle(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        const ALLOWED: &str = "6 or 11 finite numbers, or 7 with the radius; behind 11 TIMES and a number of turns";
        let mut given = self.numbers(statement, |_| true, ALLOWED)?;
        let words: Vec<&str> = statement.words().collect();
        let turns = match (&words[..], &statement.minors[..]) {
            ([], _) => None,
            ([word], [.., Minor::Word(_), Minor::Number(turns, _)])
                if word.eq_ignore_ascii_case("TIMES")
                    && turns.fract() == 0.0
                    && (1.0..=MOST_TURNS).contains(turns)
                    && given.len() == 12 =>
            {
                given.pop();
                Some(*turns as u32)
            }
            _ => return Err(self.fail(statement, "an arc with words that are not known here", ALLOWED)),
        };
        // NX writes 11 numbers and turns as a left-handed screw along the axis.
        let hand = match given.len() {
            11 => -1.0,
            6 | 7 => 1.0,
            count => return Err(self.fail(statement, &format!("{count} numbers that can be read"), ALLOWED)),
        };
        self.pending = Some(Pending {
            centre: self.place(Vector3::new(given[0], given[1], given[2])),
            axis: self.rotation * Vector3::new(given[3], given[4], given[5]) * hand,
            radius: given.get(6).map(|radius| radius * self.unit.metres()),
            turns,
            line: statement.line,
        });
        Ok(())
    }
}
