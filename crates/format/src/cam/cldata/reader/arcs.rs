//! Arcs of CLDATA: a word with the circle, and the move behind it to the end.

use super::super::super::Move;
use super::super::super::arc::{Arc, MISSED, millimetres};
use super::super::dialect::ArcForm;
use super::super::statement::{Minor, Statement};
use super::Reader;
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use stead_disk::input::InputError;

/// An arc that the next point ends.
#[derive(Clone)]
pub(super) struct Pending {
    pub word: &'static str,
    pub line: usize,
    /// In the workpiece frame. m
    centre: Vector3<f64>,
    axis: Vector3<f64>,
    radius: Option<f64>,
    /// Whole turns of a helix.
    turns: Option<u32>,
    /// Angle of the turn as it is stated. rad
    sweep: Option<f64>,
    /// What the first part rises in a turn of 1 rad, once it is there. m
    rise: Option<f64>,
}

/// The most turns of a helix.
const MOST_TURNS: f64 = 1000.0;
/// A stated turn fits one that differs by less. rad
const SWEEP_ROUNDING: f64 = PI / 180.0;
/// A point that is nearer to the circle of the arc before goes on along it. m
const ON_CIRCLE: f64 = 2e-5;

impl Reader<'_> {
    /// Takes the word of an arc.
    pub(super) fn arc(&mut self, statement: &Statement<'_>, form: ArcForm) -> Result<(), InputError> {
        self.no_cycle_is_open(statement)?;
        if form == ArcForm::OfTangent {
            return self.arc_of_tangent(statement);
        }
        let allowed = match form {
            ArcForm::Swept => {
                "centre, axis, radius, or these behind CENTER, AXIS and RADIUS; ANGLE and degrees up to 360"
            }
            _ => "6 or 11 finite numbers, or 7 with the radius; behind 11 TIMES and a number of turns",
        };
        let mut given = self.numbers(statement, |_| true, allowed)?;
        let words: Vec<String> = statement.words().map(str::to_ascii_uppercase).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let angle = |angle: f64| Some(angle).filter(|angle| *angle > 0.0 && *angle <= 361.0);
        let (mut turns, mut sweep) = (None, None);
        let is_form = match (form, &words[..], given.len()) {
            (ArcForm::Swept, [] | ["CENTER", "AXIS", "RADIUS"], 7) => true,
            (ArcForm::Swept, ["ANGLE"] | ["CENTER", "AXIS", "RADIUS", "ANGLE"], 8) => {
                sweep = angle(given[7]);
                sweep.is_some()
            }
            (ArcForm::Circle | ArcForm::CircleWithSweep, [], 6 | 7) | (ArcForm::Circle, [], 11) => true,
            (ArcForm::CircleWithSweep, [], 11) => {
                sweep = angle(given[7]);
                true
            }
            (ArcForm::Circle, ["TIMES"], 12) => {
                let is_last = matches!(statement.minors[..], [.., Minor::Word(_), Minor::Number(..)]);
                let times = given[11];
                turns =
                    (is_last && times.fract() == 0.0 && (1.0..=MOST_TURNS).contains(&times)).then_some(times as u32);
                turns.is_some()
            }
            _ => false,
        };
        if !is_form {
            let problem = match words.len() {
                0 => format!("{} numbers that can be read", given.len()),
                _ => "an arc with words that are not known here".to_owned(),
            };
            return Err(self.fail(statement, &problem, allowed));
        }
        let hand = if given.len() > 8 { -1.0 } else { 1.0 };
        given.truncate(7);
        let frame = self.course.frame;
        self.pending = Some(Pending {
            word: if form == ArcForm::Swept { "MOVARC" } else { "CIRCLE" },
            line: statement.line,
            centre: frame.place(Vector3::new(given[0], given[1], given[2]) * self.unit.metres()),
            axis: frame.rotation * Vector3::new(given[3], given[4], given[5]) * hand,
            radius: given.get(6).map(|radius| radius * self.unit.metres()),
            turns,
            sweep: sweep.map(f64::to_radians),
            rise: None,
        });
        Ok(())
    }

    /// An arc by its way out, its circle, and the line from its centre to its end.
    fn arc_of_tangent(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        const ALLOWED: &str = "INDIRV/i,j,k, then TLON,GOFWD/(CIRCLE/centre,radius),ON[,2,INTOF],(LINE/centre,end)";
        let given = self.numbers(statement, |count| count == 10 || count == 11, ALLOWED)?;
        let known = ["GOFWD", "CIRCLE", "ON", "INTOF", "LINE"];
        let is_known = |word: &str| known.iter().any(|own| own.eq_ignore_ascii_case(word));
        let tangent = match self.tangent.take() {
            Some(tangent) if statement.words().all(is_known) => tangent,
            Some(_) => return Err(self.fail(statement, "an arc of another form", ALLOWED)),
            None => return Err(self.fail(statement, "an arc without its way out", ALLOWED)),
        };
        let frame = self.course.frame;
        let at = |k: usize| Vector3::new(given[k], given[k + 1], given[k + 2]) * self.unit.metres();
        let [centre, place] = [at(0), at(given.len() - 3)];
        let position = frame.place(place);
        let start = self.start_of_arc(statement)?;
        let (centre, radius) = (frame.place(centre), given[3] * self.unit.metres());
        let axis = (start.position - centre).cross(&tangent);
        if axis.norm() < 0.5 * radius {
            return Err(self.fail(statement, "the way out is not along the circle", ALLOWED));
        }
        let end = Move {
            position,
            axis: frame.rotation * self.course.axis,
            feed: self.course.feed,
            is_rapid: false,
            is_arc: true,
            line: statement.line,
        };
        let arc = Arc { start: start.position, end: position, centre, axis, more_turns: 0 };
        self.fits(statement, &arc, Some(radius), false)?;
        self.course.place = place.map(Some).into();
        self.draw(statement, arc, end, true, statement.line)
    }

    fn start_of_arc(&self, statement: &Statement<'_>) -> Result<Move, InputError> {
        match self.course.program.moves.last() {
            Some(start) if !self.course.is_after_change && self.course.place.iter().all(Option::is_some) => Ok(*start),
            _ => Err(self.fail(statement, "an arc without a start", "a GOTO before the arc")),
        }
    }

    /// Goes along an arc to its end.
    pub(super) fn end_arc(
        &mut self,
        statement: &Statement<'_>,
        mut pending: Pending,
        end: Move,
    ) -> Result<(), InputError> {
        let start = self.start_of_arc(statement)?;
        if end.is_rapid {
            let problem = format!("RAPID and {} for the same move", pending.word);
            return Err(self.fail(statement, &problem, "an arc as a cutting move"));
        }
        let Pending { centre, axis, .. } = pending;
        let mut arc = Arc { start: start.position, end: end.position, centre, axis, more_turns: 0 };
        let has_axis = axis.norm() > 1e-9;
        let mut is_certain = false;
        if let (Some(turns), true) = (pending.turns, has_axis) {
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
        } else if let (Some(sweep), true) = (pending.sweep, has_axis) {
            let rounding = SWEEP_ROUNDING.max(2.0 * MISSED / arc.distance(start.position).max(MISSED));
            let fits = |arc: &Arc| (arc.turn() - sweep).abs() < rounding;
            let other = Arc { axis: -axis, ..arc };
            is_certain = fits(&arc) != fits(&other);
            if is_certain && fits(&other) {
                arc = other;
                self.course.program.note_at("arcs taken the way round that their angle fits", pending.line);
            } else if !fits(&arc) {
                let turn = format!("{:.3}", arc.turn().to_degrees());
                let problem =
                    format!("the arc turns by {turn} deg to its end, and {:.3} are stated", sweep.to_degrees());
                return Err(self.fail(statement, &problem, "the same angle within 1 deg"));
            }
        }
        let may_rise = pending.turns.is_some() || self.dialect.arcs_go_on;
        self.fits(statement, &arc, pending.radius, may_rise)?;
        self.draw(statement, arc, end, is_certain, pending.line)?;
        if self.dialect.arcs_go_on {
            pending.rise = Some(arc.rise() / arc.turn());
            self.circle = Some(pending);
        }
        Ok(())
    }

    /// The arc to a point on the circle of the arc before.
    pub(super) fn on_circle(&self, end: &Move) -> Option<Arc> {
        let pending = self.circle.as_ref().filter(|_| !end.is_rapid)?;
        let start = self.course.program.moves.last()?.position;
        let Pending { centre, axis, .. } = *pending;
        let arc = Arc { start, end: end.position, centre, axis, more_turns: 0 };
        let [from, to] = [start, end.position].map(|point| arc.distance(point));
        let rise = pending.rise? * arc.turn();
        let has_moved = (end.position - start - axis.normalize() * arc.rise()).norm() > ON_CIRCLE;
        ((from - to).abs() < ON_CIRCLE && (arc.rise() - rise).abs() < ON_CIRCLE && has_moved).then_some(arc)
    }

    /// Refuses an arc that misses the radius that is stated, or the plane of its start.
    fn fits(
        &self,
        statement: &Statement<'_>,
        arc: &Arc,
        radius: Option<f64>,
        may_rise: bool,
    ) -> Result<(), InputError> {
        if let (Some(stated), Some(found)) = (radius, arc.radius())
            && (stated - found).abs() > MISSED
        {
            let [found, stated] = [found, stated].map(millimetres);
            let problem = format!("the arc misses its start: radius {found}, stated {stated}");
            return Err(self.fail(statement, &problem, "the same radius within 0.05 mm"));
        }
        if !may_rise && arc.rise().abs() > MISSED {
            let problem =
                format!("the arc misses its end, which is {} out of its plane", millimetres(arc.rise().abs()));
            return Err(self.fail(statement, &problem, "an end in the plane of the arc within 0.05 mm"));
        }
        Ok(())
    }

    pub(super) fn draw(
        &mut self,
        statement: &Statement<'_>,
        arc: Arc,
        end: Move,
        is_certain: bool,
        line: usize,
    ) -> Result<(), InputError> {
        self.course.go_round(arc, end, is_certain, line).map_err(|error| {
            let (problem, allowed) = error.words();
            self.fail(statement, &problem, allowed)
        })
    }
}
