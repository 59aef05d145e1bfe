//! Where the machine is, and the states on a straight move.

use nalgebra::Vector3;

/// Moves are taken in parts in which no rotary axis turns by more than this. rad
const TURN_STEP: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Where the machine is: the programmed position (m) and angles (rad), as far as they are known.
#[derive(Clone, Copy)]
pub(super) struct State {
    pub position: [Option<f64>; 3],
    pub angles: [f64; 3],
}

impl State {
    /// Whether the position is known in all axes.
    pub fn is_known(&self) -> bool {
        self.position.iter().all(Option::is_some)
    }

    /// The programmed position, zero in an axis in which it is not known. m
    pub fn programmed(&self) -> Vector3<f64> {
        Vector3::from(self.position.map(Option::unwrap_or_default))
    }

    /// The states of a straight move from here, in parts where the tool turns, the end last.
    pub fn line_to(&self, end: &Self) -> Vec<Self> {
        let turn = (0..3).map(|k| (end.angles[k] - self.angles[k]).abs()).fold(0.0, f64::max);
        let parts = (turn / TURN_STEP - 1e-6).ceil().clamp(1.0, 1e5) as u32;
        let between = |from: f64, to: f64, part: u32| from + (to - from) * f64::from(part) / f64::from(parts);
        let mut states: Vec<Self> = (1..parts)
            .map(|part| Self {
                position: std::array::from_fn(|k| {
                    self.position[k].zip(end.position[k]).map(|(from, to)| between(from, to, part))
                }),
                angles: std::array::from_fn(|k| between(self.angles[k], end.angles[k], part)),
            })
            .collect();
        states.push(*end);
        states
    }
}
