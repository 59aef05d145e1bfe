//! What the arm does: a plan with its times, and the keys of its animation.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;
use stead_planning::course::{MovePart, PlaceOnMove};

/// Time of a move, or of a turn in place, whose time is not known. s
pub(super) const UNKNOWN_MOVE: f64 = 1.0;
/// Shortest time that a move between segments is shown in. s
pub(super) const SHORTEST_MOVE: f64 = 0.15;
/// Keys of a move between segments at least: it starts and ends at rest.
const KEYS_OF_MOVE: usize = 16;
/// Points of a plan that an animation has at most; of more, so many are left out that these remain.
pub(super) const MAX_STOPS: usize = 6000;

/// The arm at a path point.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Joint angles. rad
    pub joints: [f64; 6],
    /// Positions of the external axes. m or rad
    pub axes: Vec<f64>,
    /// The path point in the workpiece frame. m
    pub position: Vector3<f64>,
    /// Number of the segment, from 1.
    pub segment: usize,
    /// The score: what the path is coloured by. m
    pub score: f64,
    /// Time since the first point. s
    pub time: f64,
    /// The parts of the move from the segment before; none where it is straight in joint space, or where there is no
    /// such move.
    pub way: Vec<MovePart>,
}

/// A plan as it is driven.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// What is shown.
    pub name: String,
    /// Its path points; times rise.
    pub stops: Vec<Stop>,
}

/// Joint angles (rad) and positions of the external axes (m or rad) at a time (s) of the animation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Key {
    pub time: f32,
    pub joints: [f64; 6],
    pub axes: Vec<f64>,
}

impl Motion {
    /// The stops that are shown: all, or of a long path every so-manieth of each segment and the ends.
    pub(super) fn shown(&self) -> Vec<Stop> {
        let stride = self.stops.len().div_ceil(MAX_STOPS).max(1);
        let is_end = |index: usize| {
            let segment = |index: usize| self.stops.get(index).map(|stop| stop.segment);
            let own = segment(index);
            segment(index + 1) != own || index.checked_sub(1).and_then(segment) != own
        };
        let shown = self.stops.iter().enumerate().filter(|(index, _)| index % stride == 0 || is_end(*index));
        shown.map(|(_, stop)| stop.clone()).collect()
    }

    /// The keys of the animation, at strictly rising times. Viewers turn a joint the short way round from key to key,
    /// so no joint and no turntable turns by more than 90 deg between two of them; each part of a move between segments
    /// starts and ends at rest.
    pub(super) fn keys(&self) -> Vec<Key> {
        let stops = self.shown();
        let mut keys: Vec<Key> = Vec::new();
        // A key at the time of the one before, in the precision of the file, takes its place.
        let mut put = |time: f64, PlaceOnMove { joints, axes }: PlaceOnMove| {
            let key = Key { time: time as f32, joints, axes };
            match keys.last_mut() {
                Some(last) if last.time >= key.time => *last = Key { time: last.time, ..key },
                _ => keys.push(key),
            }
        };
        if let Some(first) = stops.first() {
            put(first.time, first.place());
        }
        for pair in stops.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            let is_move = from.segment != to.segment;
            let straight = || vec![MovePart { places: vec![from.place(), to.place()], time_share: 1.0 }];
            let parts = if is_move && !to.way.is_empty() { to.way.clone() } else { straight() };
            let mut begun = 0.0;
            for part in &parts {
                for (share, place) in part_keys(&part.places, is_move) {
                    put(from.time + (to.time - from.time) * (begun + part.time_share * share), place);
                }
                begun += part.time_share;
            }
        }
        keys
    }
}

impl Stop {
    fn place(&self) -> PlaceOnMove {
        PlaceOnMove { joints: self.joints, axes: self.axes.clone() }
    }
}

/// Keys of what moves evenly over these places, or starts and ends at rest: the share of the time that each comes at.
fn part_keys(places: &[PlaceOnMove], is_from_rest: bool) -> Vec<(f64, PlaceOnMove)> {
    let [from, to] = places else {
        // Close to each other: at each of them is enough.
        let steps = places.len().saturating_sub(1) as f64;
        return places.iter().enumerate().skip(1).map(|(k, place)| (when(k as f64 / steps), place.clone())).collect();
    };
    let turns: [f64; 6] = std::array::from_fn(|j| to.joints[j] - from.joints[j]);
    let shifts: Vec<f64> = to.axes.iter().zip(&from.axes).map(|(to, from)| to - from).collect();
    let largest = turns.iter().chain(&shifts).fold(0.0_f64, |largest, turn| largest.max(turn.abs()));
    // The smooth start makes the steps in the middle of a move half as large again.
    let count = ((largest * 1.5 / FRAC_PI_2).ceil() as usize).max(if is_from_rest { KEYS_OF_MOVE } else { 1 });
    let key = |number: usize| {
        let share = number as f64 / count as f64;
        let done = if is_from_rest { share * share * (3.0 - 2.0 * share) } else { share };
        let axes = from.axes.iter().zip(&shifts).map(|(at, shift)| at + shift * done).collect();
        (share, PlaceOnMove { joints: std::array::from_fn(|j| from.joints[j] + turns[j] * done), axes })
    };
    (1..=count).map(key).collect()
}

/// The share of the time at which a smooth move from rest to rest has done a share of its way: the other way round of
/// `t t (3 - 2 t)`.
fn when(done: f64) -> f64 {
    0.5 - libm::sin(libm::asin(1.0 - 2.0 * done) / 3.0)
}

/// A turn about a unit vector, as the quaternion x, y, z, w.
pub(super) fn turn_about(direction: &Vector3<f64>, angle: f64) -> [f32; 4] {
    let (sine, cosine) = libm::sincos(angle / 2.0);
    [(direction.x * sine) as f32, (direction.y * sine) as f32, (direction.z * sine) as f32, cosine as f32]
}

/// A rotation as the quaternion x, y, z, w.
pub(super) fn quaternion(rotation: &Matrix3<f64>) -> [f32; 4] {
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation));
    [rotation.i as f32, rotation.j as f32, rotation.k as f32, rotation.w as f32]
}
