//! Distances of a plan, at its points and between them.

use super::Plan;
use crate::cell::Stand;
use crate::verdict::Verdict;
use nalgebra::Isometry3;

/// Distances of round shapes by parry's plain method are within this. m
pub(crate) const SHAPE_SLACK: f64 = 3e-5;

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

    /// From point to point the tool moves straight and turns evenly in the frame of the part.
    pub(super) fn between(&self, verdict: &mut Verdict, i: usize) {
        let cell = self.cell;
        let [from, to] = [&self.rows[i - 1], &self.rows[i]];
        let [start, end] = [self.stand(i - 1), self.stand(i)].map(|stand| stand.part.inverse() * stand.tool);
        let turn = (end.rotation * start.rotation.inverse()).scaled_axis();
        let way = (end.translation.vector - start.translation.vector).norm();
        let most = (0..6).map(|j| (to.joints[j] - from.joints[j]).abs()).fold(0.0, f64::max);
        let steps = (way / 0.01).max(most / 0.02).ceil().clamp(2.0, 60.0) as usize;
        let mut joints = from.joints;
        for step in 1..steps {
            let share = step as f64 / steps as f64;
            let positions: Vec<f64> =
                from.positions.iter().zip(&to.positions).map(|(a, b)| a + (b - a) * share).collect();
            let place = start.translation.vector.lerp(&end.translation.vector, share);
            let target = Isometry3::new(place, turn * share) * start.rotation;
            let part = cell.at(&self.placement, &joints, &positions);
            let Some(found) = cell.arm.reach(&part.frames[0], &(part.part * target * cell.tool.inverse()), &joints)
            else {
                verdict.holds("reach between points", || format!("{} at {share}", self.at(i)), false);
                return;
            };
            joints = found;
            let stand = cell.at(&self.placement, &joints, &positions);
            let told = |which: &str| format!("{} at {share:.3} of the way: {which}", self.at(i));
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
        verdict.within("the way leads to the next point (rad)", || self.at(i), off, most / (steps as f64) * 8.0 + 0.3);
    }
}
