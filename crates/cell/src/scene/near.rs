//! Pairs that have little room, and how that room changes with a small motion: what a refinement by linear models
//! needs.

use super::{Members, PairKind, Poses, Scene};
use crate::collider::Nearest;
use nalgebra::Vector3;

/// Two shapes, or a point of the arm and a zone, with little room between them in a state in which they keep apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// Number of the pair ([`Scene::pair`]).
    pub pair: usize,
    /// Their room beyond the distance that they have to keep. m
    pub room: f64,
    /// Of two shapes: where they are nearest, in the base frame.
    points: Option<[Vector3<f64>; 2]>,
}

impl Scene {
    /// The pairs of some kinds with less room than `within` (m), except those that touch.
    pub fn near(&self, poses: &Poses, kinds: &[PairKind], within: f64) -> Vec<Near> {
        let near = |number: usize| {
            let pair = &self.pairs[number];
            let limit = pair.required + within;
            let distance = self.bound(pair, poses, limit);
            if distance >= limit {
                return None;
            }
            let of = |distance: f64, points| Near { pair: number, room: distance - pair.required, points };
            match pair.members {
                Members::Zone(..) => Some(of(distance, None)),
                Members::Bodies(a, b) => {
                    let (a, b) = (&self.bodies[a], &self.bodies[b]);
                    let found = a.collider.nearest(&poses.frames[a.frame], &b.collider, &poses.frames[b.frame], limit);
                    found.map(|Nearest { distance, points }| of(distance, Some(points)))
                }
            }
        };
        self.of_kinds(kinds).filter_map(near).collect()
    }

    /// By how much the room of such a pair changes from its state to one nearby, to first order: the nearest points,
    /// carried along by their shapes, part or meet along the direction from one to the other. m
    pub fn room_change(&self, near: &Near, from: &Poses, to: &Poses) -> f64 {
        match (self.pairs[near.pair].members, &near.points) {
            (Members::Bodies(a, b), Some(points)) => {
                let frames = [a, b].map(|body| self.bodies[body].frame);
                let [a, b]: [Vector3<f64>; 2] = std::array::from_fn(|k| {
                    let carried = to.frames[frames[k]].then(&from.frames[frames[k]].inverse());
                    carried.point(&points[k]) - points[k]
                });
                (points[1] - points[0]).normalize().dot(&(b - a))
            }
            (Members::Zone(zone, point), _) => {
                self.zone_distance(zone, point, to) - self.zone_distance(zone, point, from)
            }
            (Members::Bodies(..), None) => 0.0,
        }
    }
}
