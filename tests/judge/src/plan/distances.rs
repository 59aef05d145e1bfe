//! Distances of a plan, at its points and between them.

use super::Plan;
use crate::cell::Stand;
use crate::verdict::Verdict;
use nalgebra::Isometry3;

/// Distances of round shapes by parry's plain method are within this. m
pub(crate) const SHAPE_SLACK: f64 = 3e-5;

/// By so much what a joint (rad) or an external axis (m or rad) moves in a step may be off, for the printed digits of
/// both ends.
const ROUNDED: f64 = 4e-6;

/// So far a joint may be beyond its limit between two points without a word. rad
const MOST_BEYOND: f64 = 2.1e-3;

impl Plan<'_> {
    /// Distances at a point.
    pub(super) fn clear(&self, verdict: &mut Verdict, i: usize, stand: &Stand) {
        let cell = self.cell;
        if cell.pairs.is_empty() && cell.zones.is_empty() {
            return;
        }
        let row = &self.rows[i];
        let zone = cell.zone_depth(stand);
        if let Some((depth, which)) = &zone {
            verdict.within("zone kept out of (m)", || format!("{} {which}", self.at(i)), *depth, 1e-5);
        }
        let nearest = cell.nearest(&cell.bodies, &cell.pairs, stand, 1.0);
        let pair = |pair: &[usize; 2]| pair.map(|body| cell.bodies[body].name.as_str()).join(" and ");
        let told = || {
            let words = nearest.as_ref().map_or("nothing within 1 m".to_owned(), |(_, which)| pair(which));
            format!("{} (stated {}, computed {words}, zone {zone:?})", self.at(i), row.nearest)
        };
        let of_zone = zone.as_ref().map(|(depth, _)| (-depth).max(0.0)).filter(|distance| *distance < 1.0);
        // The pair with the least room: what is left beyond the clearance, of which a zone needs none.
        let least = match (nearest.as_ref().map(|(distance, _)| *distance), of_zone) {
            (Some(shapes), Some(zone)) => Some(if shapes - cell.clearance < zone { shapes } else { zone }),
            (shapes, zone) => shapes.or(zone),
        };
        match (least, row.clearance) {
            (Some(found), Some(stated)) => verdict.close("stated clearance (m)", told, stated, found, SHAPE_SLACK),
            (found, stated) => {
                let is_edge = found.or(stated).is_none_or(|distance| distance > 1.0 - 1e-3);
                verdict.holds("stated clearance (m)", told, is_edge);
            }
        }
        if let Some((found, _)) = nearest {
            verdict.within("clearance at a point (m)", told, cell.clearance, found + SHAPE_SLACK);
        }
    }

    /// From point to point the tool moves straight and turns evenly in the frame of the part. Where the results state
    /// that the arm cannot follow the move, it is judged as far as the arm does. The feed that the speeds of the joints
    /// and external axes allow, by what they move in each step at the least. m/s
    pub(super) fn between(&self, verdict: &mut Verdict, i: usize, is_told: bool) -> f64 {
        let cell = self.cell;
        let [from, to] = [&self.rows[i - 1], &self.rows[i]];
        let [start, end] = [self.stand(i - 1), self.stand(i)].map(|stand| stand.part.inverse() * stand.tool);
        let turn = (end.rotation * start.rotation.inverse()).scaled_axis();
        let way = (end.translation.vector - start.translation.vector).norm();
        // By what the path states of what is touched, which digits of joint angles do not blur.
        let told_way = self.length(i);
        let most = (0..6).map(|j| (to.joints[j] - from.joints[j]).abs()).fold(0.0, f64::max);
        let steps = (way / 0.01).max(most / 0.02).ceil().clamp(2.0, 60.0) as usize;
        let mut joints = from.joints;
        let allowed = |speed: Option<f64>, moved: f64| match speed.filter(|_| !self.is_in_place(i)) {
            Some(speed) => speed * told_way / steps as f64 / (moved.abs() - ROUNDED).max(1e-12),
            None => f64::INFINITY,
        };
        let axes = cell.axes.iter().zip(from.positions.iter().zip(&to.positions));
        let mut feed =
            axes.map(|(axis, (a, b))| allowed(axis.speed, (a - b) / steps as f64)).fold(f64::INFINITY, f64::min);
        for step in 1..steps {
            let share = step as f64 / steps as f64;
            let positions: Vec<f64> =
                from.positions.iter().zip(&to.positions).map(|(a, b)| a + (b - a) * share).collect();
            let place = start.translation.vector.lerp(&end.translation.vector, share);
            let target = Isometry3::new(place, turn * share) * start.rotation;
            let part = cell.at(&self.placement, &joints, &positions);
            let Some(found) = cell.arm.reach(&part.frames[0], &(part.part * target * cell.tool.inverse()), &joints)
            else {
                verdict.holds("reach between points", || format!("{} at {share}", self.at(i)), is_told);
                return feed;
            };
            let motors = [&joints, &found].map(|joints| cell.arm.motors(joints));
            for (j, row) in cell.arm.rows.iter().enumerate() {
                // The digits of two angles are in the turn of a forearm.
                let rounded = if j == 2 && cell.arm.linkage { ROUNDED } else { 0.0 };
                feed = feed.min(allowed(row.speed, ((motors[1][j] - motors[0][j]).abs() - rounded).max(0.0)));
            }
            joints = found;
            let stand = cell.at(&self.placement, &joints, &positions);
            let told = |which: &str| format!("{} at {share:.3} of the way: {which}", self.at(i));
            for (row, angle) in cell.arm.rows.iter().zip(joints).filter(|_| !is_told) {
                let beyond = (row.min - angle).max(angle - row.max);
                verdict.within("joint limit between points (rad)", || told("joints"), beyond, MOST_BEYOND);
            }
            if let Some([min, max]) = cell.arm.sum.filter(|_| !is_told) {
                let sum = cell.arm.forearm(&joints);
                let beyond = (min - sum).max(sum - max);
                verdict.within("sum of joints 2 and 3 between points (rad)", || told("sum"), beyond, MOST_BEYOND);
            }
            if let Some((depth, which)) = cell.zone_depth(&stand) {
                verdict.within("zone between points (m)", || told(&which), depth, 1e-4);
            }
            let nearest = cell.nearest(&cell.bodies, &cell.pairs, &stand, cell.clearance.max(1e-3));
            let (distance, which) = nearest.map_or((f64::INFINITY, String::new()), |(distance, pair)| {
                (distance, pair.map(|body| cell.bodies[body].name.as_str()).join(" and "))
            });
            verdict.within(
                "clearance between points (m)",
                || told(&which),
                0.9 * cell.clearance,
                distance + SHAPE_SLACK,
            );
        }
        let off = (0..6).map(|j| (joints[j] - to.joints[j]).abs()).fold(0.0, f64::max);
        if !is_told {
            let slack = most / (steps as f64) * 8.0 + 0.3;
            verdict.within("the way leads to the next point (rad)", || self.at(i), off, slack);
        }
        feed
    }
}
