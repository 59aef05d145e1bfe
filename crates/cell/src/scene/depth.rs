//! How deep shapes are in each other, to say which of those that touch touch most. Too slow for searches: for messages.

use super::{Clearance, Members, PairKind, Poses, Scene};
use nalgebra::Vector3;
use stead_model::robot::Pose;

/// The shortest shift that is tried, and the finest difference of depths. m
const FINEST: f64 = 1e-5;
/// A shift that does not part two shapes is doubled this often at the most: to 80 m.
const DOUBLINGS: usize = 23;
/// How far the best direction is turned to look for a better one, first and last. rad
const TURNS: [f64; 5] = [0.35, 0.18, 0.09, 0.045, 0.022];

impl Scene {
    /// As [`Scene::clearance`], and of several pairs that touch the one that is deepest in each other beyond what it
    /// has to keep.
    pub fn deepest(&self, poses: &Poses, kinds: &[PairKind]) -> Option<Clearance> {
        let least = self.clearance(poses, kinds)?;
        if least.distance > 0.0 {
            return Some(least);
        }
        let touching = self.of_kinds(kinds).filter(|number| self.distance(*number, poses, f64::MIN_POSITIVE) <= 0.0);
        let depths = touching.map(|number| (self.depth(number, poses) + self.pairs[number].required, number));
        // Of equal ones the first.
        let deepest = depths.reduce(|a, b| if b.0 > a.0 { b } else { a });
        deepest.map(|(_, pair)| Clearance { distance: 0.0, pair })
    }

    /// About how far a pair that touches has to be moved until it does not: the shortest shift found over directions
    /// all round. m
    fn depth(&self, number: usize, poses: &Poses) -> f64 {
        let parts = |shift: Vector3<f64>| match self.pairs[number].members {
            Members::Bodies(a, b) => {
                let (a, b) = (&self.bodies[a], &self.bodies[b]);
                let (at, other) = (&poses.frames[a.frame], &poses.frames[b.frame]);
                let moved = Pose { translation: other.translation + shift, ..*other };
                a.collider.distance(at, &b.collider, &moved, f64::MIN_POSITIVE) > 0.0
            }
            Members::Zone(zone, point) => {
                let point = poses.frames[0].inverse().point(&(self.tracked(point, poses) + shift));
                self.surroundings.zones()[zone].zone.distance(&point) > 0.0
            }
        };
        let mut best = (f64::INFINITY, Vector3::z());
        for direction in directions() {
            best = shorter(best, direction, &parts);
        }
        for turn in TURNS {
            let about = best.1;
            let side = about.cross(&if about.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() }).normalize();
            for beside in [side, -side, about.cross(&side), -about.cross(&side)] {
                best = shorter(best, (about + beside * turn).normalize(), &parts);
            }
        }
        best.0
    }
}

/// The directions from the middle of a cube to its corners, edges and faces.
fn directions() -> impl Iterator<Item = Vector3<f64>> {
    let steps = [-1.0, 0.0, 1.0];
    let all = steps.into_iter().flat_map(move |x| steps.map(move |y| steps.map(move |z| Vector3::new(x, y, z))));
    all.flatten().filter(|direction| direction.norm() > 0.5).map(|direction| direction.normalize())
}

/// The shortest shift known with its direction, or one along another direction that parts sooner.
fn shorter(
    best: (f64, Vector3<f64>),
    direction: Vector3<f64>,
    parts: &impl Fn(Vector3<f64>) -> bool,
) -> (f64, Vector3<f64>) {
    if best.0.is_finite() && !parts(direction * (best.0 - FINEST).max(0.0)) {
        return best;
    }
    let Some(mut parted) = (0..DOUBLINGS).map(|k| FINEST * f64::from(1 << k)).find(|by| parts(direction * *by)) else {
        return best;
    };
    let mut touching = parted / 2.0;
    while parted - touching > FINEST {
        let middle = (parted + touching) / 2.0;
        if parts(direction * middle) {
            parted = middle;
        } else {
            touching = middle;
        }
    }
    if parted < best.0 { (parted, direction) } else { best }
}
