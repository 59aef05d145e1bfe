//! What states looked at before say about the distances in the next one.
//!
//! From one state of a path to the next nothing moves far. A pair that had room is not looked at again before its two
//! shapes have come as far, together, as the room that was left; and what separated the two before mostly still does.

use super::motion::MotionHit;
use super::poses::{FRAMES, Poses, largest_move};
use super::{Members, PairKind, Scene};
use nalgebra::Vector3;
use stead_model::robot::Pose;

/// How far pairs of a scene are apart, at the least, in the state looked at last.
#[derive(Debug, Clone, Default)]
pub struct Proximity {
    /// Frames of that state; `None` before the first.
    frames: Option<[Pose<f64>; FRAMES]>,
    /// Centres of the spheres around the shapes, in the base frame. m
    centres: Vec<Vector3<f64>>,
    /// Directions along which pairs were apart when they were last looked at.
    axes: Vec<Option<Vector3<f64>>>,
    now: Rooms,
    /// The same in the state before.
    before: Rooms,
    /// The pair that hit last: often it hits in the next state too.
    recent: Option<usize>,
}

/// What bounds the room that pairs have.
#[derive(Debug, Clone, Default)]
struct Rooms {
    /// How far any point of a shape has come since the first state, at the most. m
    travelled: Vec<f64>,
    /// Pairs keep apart until their shapes have come so far together. m
    apart_until: Vec<f64>,
}

/// Distances are distinguished up to this beyond what is required: finding one that is larger costs more than it saves.
/// m
const AHEAD: f64 = 0.02;
/// What rounding may make of sums of travelled distances. m
const ROUNDING: f64 = 1e-9;

impl Rooms {
    /// How much room a pair has at the least beyond the distance that it has to keep. m
    fn of(&self, scene: &Scene, number: usize) -> f64 {
        match scene.pairs[number].members {
            Members::Bodies(a, b) => self.apart_until[number] - self.travelled[a] - self.travelled[b] - ROUNDING,
            Members::Zone(..) => f64::NEG_INFINITY,
        }
    }
}

impl Proximity {
    /// Forgets all states.
    pub fn clear(&mut self) {
        self.frames = None;
        self.recent = None;
    }

    /// Knows what another does, if it knows nothing itself.
    pub fn begin_with(&mut self, other: &Self) {
        if self.frames.is_none() {
            self.clone_from(other);
        }
    }

    /// Goes on to a state.
    fn advance(&mut self, scene: &Scene, poses: &Poses) {
        let centres = scene.bodies.iter().map(|body| body.centre(poses));
        let Some(before) = self.frames.replace(poses.frames) else {
            self.centres.clear();
            self.centres.extend(centres);
            self.axes.clear();
            self.axes.resize(scene.pairs.len(), None);
            self.now.travelled.clear();
            self.now.travelled.resize(scene.bodies.len(), 0.0);
            self.now.apart_until.clear();
            self.now.apart_until.resize(scene.pairs.len(), f64::NEG_INFINITY);
            return;
        };
        self.before.travelled.clone_from(&self.now.travelled);
        self.before.apart_until.clone_from(&self.now.apart_until);
        let mut turns = [None; FRAMES];
        let known = self.centres.iter_mut().zip(&mut self.now.travelled);
        for ((body, now), (centre, travelled)) in scene.bodies.iter().zip(centres).zip(known) {
            let turned = || largest_move(&before[body.frame].rotation, &poses.frames[body.frame].rotation);
            let turn: &mut f64 = turns[body.frame].get_or_insert_with(turned);
            *travelled += (now - *centre).norm() + *turn * body.cover.bound.radius;
            *centre = now;
        }
    }
}

impl Scene {
    /// A pair of some kinds that is nearer than it may be in a state, which `known` goes on to.
    pub fn next_hit(&self, known: &mut Proximity, poses: &Poses, kinds: &[PairKind]) -> Option<usize> {
        known.advance(self, poses);
        let recent = known.recent.filter(|number| kinds.contains(&self.pairs[*number].kind));
        let mut is_hit = |number: &usize| known.now.of(self, *number) <= 0.0 && !self.has_room(known, *number, poses);
        let hit = recent.filter(&mut is_hit).or_else(|| self.of_kinds(kinds).find(&mut is_hit));
        known.recent = hit.or(known.recent);
        hit
    }

    /// [`Scene::motion`] to the state that `known` has just gone to, from the one before; nothing hits in either.
    pub fn motion_to(
        &self,
        known: &Proximity,
        from: (&[f64; 6], &Poses),
        to: (&[f64; 6], &Poses),
    ) -> Option<MotionHit> {
        let has_room = |number: usize, travel: f64| {
            known.now.of(self, number).max(0.0) + known.before.of(self, number).max(0.0) >= travel
        };
        self.motion_unless(has_room, from, to)
    }

    /// Whether a pair is as far apart as it has to be; how much farther is kept in mind.
    fn has_room(&self, known: &mut Proximity, number: usize, poses: &Poses) -> bool {
        let pair = &self.pairs[number];
        let Members::Bodies(a, b) = pair.members else { return self.keeps_apart(number, poses) };
        let (first, second) = (&self.bodies[a], &self.bodies[b]);
        let (here, there) = (&poses.frames[first.frame], &poses.frames[second.frame]);
        let ahead = pair.required + AHEAD;
        let (mut distance, enough) = match known.axes[number] {
            Some(axis) => (first.collider.gap(here, &second.collider, there, &axis), pair.required),
            None => (self.bound(pair, poses, ahead), ahead),
        };
        if distance < enough || distance <= 0.0 {
            let found = first.collider.separation(here, &second.collider, there, ahead);
            (distance, known.axes[number]) = (found.distance, found.axis);
        }
        known.now.apart_until[number] = known.now.travelled[a] + known.now.travelled[b] + distance - pair.required;
        distance >= pair.required && !self.is_touching(number, distance)
    }
}
