//! The load at the points of a path, and the points that are added where a straight line between two misses it.

use crate::load::{PointForces, Sums};
use crate::moves::{LegPlace, PathMoves, has_wall};

use crate::sums::Found;
use crate::turn::Turn;
use nalgebra::Vector3;
use stead_model::task::{PathPoint, TaskError, ToolPath};

/// A point is added where the force is off a straight line by more than this share of the largest there.
const STRAIGHT: f64 = 0.1;
/// Windows over which the force is the mean where points are looked for.
const SMOOTH: f64 = 2.5;
/// Forces below this share of the largest of the path need no point.
const SMALL: f64 = 0.05;
/// Less is nothing. m2
const NOTHING: f64 = 1e-11;

/// Sums along a path.
pub struct Loads<'l> {
    /// Where they are.
    pub path: &'l PathMoves,
    /// What they are.
    pub found: &'l Found,
}

impl Loads<'_> {
    /// The load at a point of the path: of the leg that ends there or that begins there, whichever is larger; of legs
    /// with a wall, where one of them has it, since a plunge is not what is scored there.
    pub fn at_point(&self, point: usize) -> PointForces {
        let legs = || self.path.places[point].iter().flatten();
        let has_wall = |place: &&LegPlace| self.path.legs[place.leg].has_wall;
        let is_any = legs().any(|place| has_wall(&place));
        let places = legs().filter(|place| has_wall(place) || !is_any).map(|place| self.at(place));
        let larger = |a: PointForces, b: PointForces| {
            if b.at_feed(1.0).force.norm() > a.at_feed(1.0).force.norm() { b } else { a }
        };
        places.reduce(larger).unwrap_or_default()
    }

    /// The load at a place of a leg.
    pub fn at(&self, place: &LegPlace) -> PointForces {
        self.over(place, self.path.window)
    }

    /// The same as the mean over a window on either side (m).
    fn over(&self, place: &LegPlace, window: f64) -> PointForces {
        let leg = &self.path.legs[place.leg];
        let mut sums = Sums::default();
        for (node, weight) in leg.weights(place.along, window) {
            let of_node = &self.found.sums[node];
            if of_node.volume > 0.0 {
                sums.add(of_node, weight);
            }
        }
        if sums.volume < NOTHING {
            return PointForces::default();
        }
        let turn = self.turn(place);
        let mean = (sums.chip.force + sums.edge.force).norm();
        PointForces {
            is_added: false,
            chip: sums.chip,
            edge: sums.edge,
            largest: turn.largest.max(mean),
            removed: sums.volume,
            heights: Some(sums.heights),
            angles: turn.angles,
            chip_thickness: sums.thickest,
        }
    }

    /// What goes on in a turn at a place: between the nodes about it.
    fn turn(&self, place: &LegPlace) -> Turn {
        let leg = &self.path.legs[place.leg];
        let along = (place.along / leg.length * leg.turns.intervals as f64).clamp(0.0, leg.turns.intervals as f64);
        let (low, part) = (along.floor() as usize, along - along.floor());
        let at = |number: usize| self.found.turns.get(leg.turns.first + number.min(leg.turns.intervals)).copied();
        let (Some(a), Some(b)) = (at(low), at(low + 1)) else { return Turn::default() };
        let [near, far] = if part < 0.5 { [a, b] } else { [b, a] };
        Turn { largest: a.largest * (1.0 - part) + b.largest * part, angles: near.angles.or(far.angles) }
    }
}

/// A point between two of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Added {
    /// Number of the point after it.
    pub before: usize,
    /// Share of the way there from the point before.
    pub share: f64,
    /// The load there.
    pub load: PointForces,
}

/// Points where the force is not straight between two of the path, in order.
pub fn points_between(path: &ToolPath, loads: &[PointForces], along: &Loads<'_>) -> Vec<Added> {
    let largest = loads.iter().map(|load| load.at_feed(1.0).force.norm()).fold(0.0, f64::max);
    let mut added = Vec::new();
    for point in 1..loads.len() {
        let Some([start, end]) = along.path.leg_between(point - 1) else { continue };
        // Along the tool axis there is no wall, and no point that could be scored.
        if !path.is_scored(point) || !has_wall(path, point) {
            continue;
        }
        let way = end.along - start.along;
        let steps = (way / along.path.window).floor() as usize;
        if steps < 2 {
            continue;
        }
        let place = |share: f64| LegPlace { along: start.along + way * share, ..start };
        // What is not straight is looked for in a smoother force, so that noise adds no points.
        let smooth = |step: usize| {
            let share = step as f64 / steps as f64;
            (share, along.over(&place(share), SMOOTH * along.path.window))
        };
        let between: Vec<(f64, PointForces)> = (1..steps).map(smooth).collect();
        let mut kept = Vec::new();
        refine(&between, [smooth(0), smooth(steps)], largest * SMALL, &mut kept);
        added.extend(kept.into_iter().map(|(share, _)| Added { before: point, share, load: along.at(&place(share)) }));
    }
    added
}

/// Keeps the loads that a straight line between the ends misses most, until it misses none.
fn refine(
    between: &[(f64, PointForces)],
    ends: [(f64, PointForces); 2],
    small: f64,
    kept: &mut Vec<(f64, PointForces)>,
) {
    let [a, b] = ends;
    let force = |load: &PointForces| load.at_feed(1.0).force;
    let (from, to) = (force(&a.1), force(&b.1));
    let off = |(share, load): &(f64, PointForces)| {
        let line = from + (to - from) * ((share - a.0) / (b.0 - a.0));
        let scale = from.norm().max(to.norm()).max(force(load).norm()).max(small);
        (force(load) - line).norm() / scale
    };
    let worst = between.iter().enumerate().map(|(number, one)| (off(one), number)).max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, number)) = worst.filter(|(off, _)| *off > STRAIGHT) else { return };
    let middle = between[number];
    refine(&between[..number], [a, middle], small, kept);
    kept.push(middle);
    refine(&between[number + 1..], [middle, b], small, kept);
}

/// The path and its loads with the points that are added.
///
/// # Errors
/// [`TaskError`] where they make no path.
pub fn with_points(
    path: &ToolPath,
    loads: Vec<PointForces>,
    added: &[Added],
) -> Result<(ToolPath, Vec<PointForces>), TaskError> {
    if added.is_empty() {
        return Ok((path.clone(), loads));
    }
    let mut points: Vec<(u32, PathPoint, bool)> = Vec::new();
    let (mut feeds, mut normals, mut all) = (Vec::new(), Vec::new(), Vec::new());
    let mut added = added.iter().peekable();
    let mut put = |segment: u32, point: PathPoint, is_scored: bool, feed: f64, normal: Option<Vector3<f64>>, load| {
        points.push((segment, point, is_scored));
        feeds.push(feed);
        normals.extend(normal);
        all.push(load);
    };
    for (number, load) in loads.into_iter().enumerate() {
        let segment = path.segment_of(number) as u32 + 1;
        let here = path.points()[number];
        let feed = path.feed(number).unwrap_or_default();
        let is_scored = path.is_scored(number);
        while let Some(one) = added.next_if(|one| one.before == number) {
            let last = path.points()[number - 1];
            let mix = |a: Vector3<f64>, b: Vector3<f64>| (a * (1.0 - one.share) + b * one.share).normalize();
            let position = last.position + (here.position - last.position) * one.share;
            let axis = mix(last.axis, here.axis);
            let point = PathPoint { position, feed: (here.position - last.position).normalize(), axis };
            let normal = path.surface_normals().map(|normals| mix(normals[number - 1], normals[number]));
            put(segment, point, is_scored, feed, normal, PointForces { is_added: true, ..one.load });
        }
        put(segment, here, is_scored, feed, path.surface_normals().map(|normals| normals[number]), load);
    }
    let has_normals = path.surface_normals().is_some();
    let path = ToolPath::partly_scored(points)?.with_feeds(feeds)?;
    let path = if has_normals { path.with_surface_normals(normals)? } else { path };
    Ok((path, all))
}
