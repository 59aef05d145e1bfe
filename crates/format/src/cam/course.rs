//! Where the tool is and how it goes on: what the readers of CLDATA and of G-code have in common.

use super::arc::Arc;
use super::refusals::Measured;
use super::{Move, Program, Resampling};
use nalgebra::{Rotation3, Vector3};

/// Moves that meet at more than this turn back. cos
const TURNED_BACK: f64 = -0.9;
/// A tool axis that is shorter than this is none.
pub(super) const NO_LENGTH: f64 = 1e-6;

/// A frame of positions in the workpiece frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Frame {
    pub rotation: Rotation3<f64>,
    /// m
    pub origin: Vector3<f64>,
}

impl Frame {
    /// A position of the frame (m) in the workpiece frame.
    pub fn place(&self, position: Vector3<f64>) -> Vector3<f64> {
        self.origin + self.rotation * position
    }

    pub fn is_near(&self, other: &Self) -> bool {
        let turn = self.rotation.matrix() - other.rotation.matrix();
        turn.abs().max() < 1e-9 && (self.origin - other.origin).norm() < 1e-9
    }
}

/// An arc that sets out against the move before it.
struct TurnedBack {
    arc: Arc,
    end: Move,
    /// The place of its first move.
    first: usize,
    line: usize,
}

/// The modal state.
#[derive(Default)]
pub(super) struct Course {
    resampling: Resampling,
    pub program: Program,
    pub frame: Frame,
    /// Tool axis in the frame.
    pub axis: Vector3<f64>,
    /// Position in the frame, axis by axis as far as it is known. m
    pub place: [Option<f64>; 3],
    /// Since which line an axis is not known, and why.
    unknown: [Option<(usize, &'static str)>; 3],
    pub feed: Option<f64>,
    /// Whether the next move is the first of a tool or path.
    pub is_after_change: bool,
    /// Direction in which the last cutting move has arrived.
    arrived: Option<Vector3<f64>>,
    turned_back: Option<TurnedBack>,
}

impl Course {
    pub fn new(resampling: Resampling) -> Self {
        Self { resampling, axis: Vector3::z(), ..Self::default() }
    }

    /// The place is not known any more in some axes, by a code of a line.
    pub fn forget(&mut self, axes: [bool; 3], code: &'static str, line: usize) {
        for axis in (0..3).filter(|axis| axes[*axis]) {
            (self.place[axis], self.unknown[axis]) = (None, Some((line, code)));
        }
    }

    /// Whether a move at feed to a place is a cut: not the first of a tool, nor one from or to where nobody knows.
    pub fn is_cut(&mut self, to: [Option<f64>; 3], line: usize) -> bool {
        if std::mem::take(&mut self.is_after_change) {
            if !self.program.moves.is_empty() {
                self.program.note("first moves of a tool or path, at feed in the program, taken as rapid ones", line);
            }
            return false;
        }
        let missing = |axis: &usize| self.place[*axis].is_none() || to[*axis].is_none();
        let Some(last) = (0..3).filter(missing).max_by_key(|axis| self.unknown[*axis]) else { return true };
        let axes = (0..3).filter(missing).map(|axis| ["X", "Y", "Z"][axis]).collect::<Vec<_>>().join(", ");
        let since = self.unknown[last].map_or("before".to_owned(), |(line, code)| format!("since {code}, line {line}"));
        let text = "moves at feed that are not scored, from or to where the tool is not known";
        self.program.note(format!("{text}: {axes} not known {since}"), line);
        false
    }

    /// Goes straight to the end of a move.
    pub fn go(&mut self, end: Move) {
        let way = self.program.moves.last().map(|last| end.position - last.position);
        let way = way.filter(|_| !end.is_rapid).and_then(|way| way.try_normalize(1e-9));
        self.meet(way);
        self.arrived = way;
        self.program.moves.push(end);
    }

    /// Goes along an arc; where it is told by its axis alone, it is turned if it would turn back at both ends.
    pub fn go_round(&mut self, arc: Arc, end: Move, is_certain: bool, line: usize) -> Result<(), Measured> {
        let points = arc.points(&self.resampling)?;
        let [out, back] = arc.tangents();
        self.meet(Some(out));
        let is_against = self.arrived.is_some_and(|way| way.dot(&out) < TURNED_BACK);
        let turned_back = TurnedBack { arc, end, first: self.program.moves.len(), line };
        self.turned_back = Some(turned_back).filter(|_| is_against && !is_certain);
        self.arrived = Some(back);
        self.push_all(points, end);
        Ok(())
    }

    fn push_all(&mut self, points: Vec<Vector3<f64>>, end: Move) {
        let from = self.program.moves.last().map_or(end.axis, |last| last.axis);
        let count = points.len() as f64;
        self.program.moves.extend(points.into_iter().zip(1..).map(|(position, place): (_, u32)| {
            let share = f64::from(place) / count;
            let axis = (from * (1.0 - share) + end.axis * share).try_normalize(NO_LENGTH).unwrap_or(end.axis);
            Move { position, axis, is_fixed: true, ..end }
        }));
    }

    /// Turns the last arc the other way where it sets out against the move before it and arrives against the one behind
    /// it, which sets out along a direction.
    fn meet(&mut self, way: Option<Vector3<f64>>) {
        let Some(last) = self.turned_back.take() else { return };
        let is_against = self.arrived.zip(way).is_some_and(|(before, way)| before.dot(&way) < TURNED_BACK);
        let arc = Arc { axis: -last.arc.axis, ..last.arc };
        if let (true, Ok(points)) = (is_against, arc.points(&self.resampling)) {
            self.program.moves.truncate(last.first);
            self.push_all(points, last.end);
            self.arrived = Some(arc.tangents()[1]);
            self.program.note("arcs that would turn back at both ends, taken the other way round", last.line);
        }
    }

    /// What comes next does not go on from here.
    pub fn end_run(&mut self) {
        (self.arrived, self.turned_back) = (None, None);
    }
}
