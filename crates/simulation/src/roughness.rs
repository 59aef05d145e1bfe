//! Profile of the wall that a pass leaves, and its roughness (ISO 21920-2 parameters, Gaussian filter of ISO 16610-21).

use super::surface::Trail;
use serde::Serialize;
use std::f64::consts::{LN_2, PI, TAU};
use stead_model::cutting::{Cutter, PassCut};

/// Heights of a wall at equal distances along the feed, y over x.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// Where it starts. m
    pub start: f64,
    /// Distance between two heights. m
    pub spacing: f64,
    /// Heights above the nominal wall; where no tooth has come by, the stock. m
    pub heights: Vec<f64>,
}

/// Height parameters of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Roughness {
    /// Arithmetic mean height R_a. m
    pub mean: f64,
    /// Root mean square height R_q. m
    pub root_mean_square: f64,
    /// Total height R_t. m
    pub total: f64,
}

impl Profile {
    /// The wall at a height above the tip of the cutter (m), from a place to another (m): the lowest that any tooth
    /// came by, exactly on its arc.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn of_wall(trail: &Trail, cutter: &Cutter, cut: &PassCut, height: f64, span: [f64; 2], spacing: f64) -> Self {
        let [start, end] = span;
        let count = ((end - start) / spacing + 1e-9).max(0.0) as usize + 1;
        let top = if cut.section.is_slot(cutter) { 2.0 * cutter.radius() } else { cut.section.radial_depth };
        let mut heights = vec![top; count];
        let turn = cut.steps_per_turn as f64;
        let steps_per_radian = cut.section.sense() * turn / TAU;
        let range = trail.extents().last().map_or(0.0, |extent| extent.top - extent.bottom);
        for (tooth, offset) in cutter.teeth().iter().zip(cutter.offsets()) {
            let radius = tooth.radius;
            // Farther from its lowest point a tooth is higher than any other may have been there, or has not come by
            // alone.
            let reach = ((2.0 * radius * range).sqrt() + 4.0 * cut_advance(trail, cut)).min(0.9 * radius);
            let first = (offset + cutter.lag(height)) / TAU * turn;
            for lowest in (0..).map(|index| first + turn * f64::from(index)) {
                if lowest > (trail.nodes().len() - 1) as f64 {
                    break;
                }
                let Some([x, _]) = trail.place(lowest) else { continue };
                let from = ((x - reach - start) / spacing).ceil().max(0.0) as usize;
                let to = (((x + reach - start) / spacing).floor() + 1.0).max(0.0) as usize;
                for index in from..to.min(count) {
                    let place = start + spacing * index as f64;
                    let mut psi = libm::asin((place - x) / radius);
                    let mut centre = [0.0; 2];
                    let mut seen = false;
                    for _ in 0..3 {
                        let Some(found) = trail.place(lowest + steps_per_radian * psi) else { break };
                        psi = libm::asin(((place - found[0]) / radius).clamp(-1.0, 1.0));
                        (centre, seen) = (found, true);
                    }
                    if seen {
                        heights[index] = heights[index].min(centre[1] - radius * libm::cos(psi));
                    }
                }
            }
        }
        Self { start, spacing, heights }
    }

    /// The profile less its mean line: what waves longer than a cutoff (m) leave of it (ISO 16610-21, with weights that
    /// make up for what lies beyond the ends).
    pub fn filtered(&self, cutoff: f64) -> Self {
        let alpha = (LN_2 / PI).sqrt();
        let half = (cutoff / self.spacing).ceil() as usize;
        let weights: Vec<f64> = (0..=half)
            .map(|index| {
                let place = index as f64 * self.spacing / (alpha * cutoff);
                libm::exp(-PI * place * place)
            })
            .collect();
        let count = self.heights.len();
        let heights = (0..count).map(|middle| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for index in middle.saturating_sub(half)..(middle + half + 1).min(count) {
                let share = weights[index.abs_diff(middle)];
                sum += share * self.heights[index];
                weight += share;
            }
            self.heights[middle] - sum / weight
        });
        Self { heights: heights.collect(), ..*self }
    }

    /// Height parameters about the mean; `None` for a profile of no points.
    pub fn roughness(&self) -> Option<Roughness> {
        let count = self.heights.len() as f64;
        let mean = self.heights.iter().sum::<f64>() / count;
        let [min, max] = self.heights.iter().fold([f64::MAX, f64::MIN], |[a, b], &h| [a.min(h), b.max(h)]);
        (count > 0.0).then(|| Roughness {
            mean: self.heights.iter().map(|height| (height - mean).abs()).sum::<f64>() / count,
            root_mean_square: (self.heights.iter().map(|h| (h - mean) * (h - mean)).sum::<f64>() / count).sqrt(),
            total: max - min,
        })
    }
}

/// The farthest that the centre came along the feed in a turn. m
fn cut_advance(trail: &Trail, cut: &PassCut) -> f64 {
    let nodes = trail.nodes();
    let pairs = nodes.iter().zip(nodes.iter().skip(cut.steps_per_turn));
    pairs.map(|(before, after)| (after.place[0] - before.place[0]).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Node;
    use stead_model::cutting::{Coefficients, Cut, MillingDirection, Rotation, Tooth};

    const RADIUS: f64 = 5e-3;

    /// Ten turns of 0.2 mm with two teeth; y of the centre at a time in steps.
    fn pass(runout: f64, direction: MillingDirection, y: impl Fn(f64) -> f64) -> (Trail, Cutter, PassCut) {
        let tooth = |radius| Tooth { pitch: PI, radius };
        let coefficients = Coefficients::new(1e9, 0.0, 0.0);
        let cutter = Cutter::new(
            vec![tooth(RADIUS), tooth(RADIUS - runout)],
            0.5,
            Some(0.01),
            Rotation::Clockwise,
            coefficients,
        )
        .unwrap();
        let cut = PassCut {
            section: Cut { direction, radial_depth: 4e-3, axial_depth: 2e-3 },
            length: 1.0,
            spindle_speed: 1e3,
            slices: 1,
            steps_per_turn: 72,
        };
        let mut trail = Trail::with_room(0, 100);
        for step in 0..=72 * 10 {
            let time = f64::from(step);
            let motion = [0.2e-3 / 72.0, y(time + 0.5) - y(time - 0.5)];
            trail.push(Node { place: [time * 0.2e-3 / 72.0, y(time)], motion });
        }
        (trail, cutter, cut)
    }

    /// Cusps of `s^2 / 8R`, s apart: the feed per tooth with equal teeth, per turn if one is too short to matter. An
    /// edge goes along a trochoid, of another curvature at its lowest by `1 +- f / 2 pi R` squared, with f the feed per
    /// turn.
    #[test]
    fn a_rigid_tool_leaves_cusps() {
        for (direction, sign) in [(MillingDirection::Climb, -1.0), (MillingDirection::Conventional, 1.0)] {
            for (runout, spacing) in [(0.0, 0.1e-3), (5e-6, 0.2e-3)] {
                let (trail, cutter, cut) = pass(runout, direction, |_| RADIUS);
                let profile = Profile::of_wall(&trail, &cutter, &cut, 1e-3, [0.8e-3, 1.4e-3], 0.2e-6);
                let swifter = 1.0 + sign * 0.2e-3 / (TAU * RADIUS);
                let cusp = spacing * spacing / (8.0 * RADIUS) / (swifter * swifter);
                let rough = profile.roughness().unwrap();
                assert!((rough.total / cusp - 1.0).abs() < 0.01, "{} {cusp}", rough.total);
                // Parabolas of height c: mean deviation 4 c / (9 sqrt 3), rms c sqrt(4 / 45).
                assert!((rough.mean / (cusp * 4.0 / (9.0 * 3_f64.sqrt())) - 1.0).abs() < 0.02, "{rough:?}");
                assert!((rough.root_mean_square / (cusp * (4.0 / 45_f64).sqrt()) - 1.0).abs() < 0.02, "{rough:?}");
            }
        }
    }

    /// The wall is the lowest point of any tooth's whole way, sampled finely.
    #[test]
    fn a_wall_is_the_envelope_of_all_teeth() {
        let (trail, cutter, cut) = pass(3e-6, MillingDirection::Climb, |time| RADIUS + 20e-6 * libm::sin(0.05 * time));
        let (from, spacing) = (0.8e-3, 2e-6);
        let profile = Profile::of_wall(&trail, &cutter, &cut, 0.5e-3, [from, 1.2e-3], spacing);
        let mut sampled = vec![f64::MAX; profile.heights.len()];
        for (tooth, offset) in cutter.teeth().iter().zip(cutter.offsets()) {
            for index in 0..720 * 2000 {
                let time = f64::from(index) / 2000.0;
                let (sine, cosine) = libm::sincos(-(time / 72.0 * TAU - offset - cutter.lag(0.5e-3)));
                let [x, y] = trail.place(time).unwrap();
                let cell = ((x + tooth.radius * sine - from) / spacing).round();
                if cosine > 0.0 && cell >= 0.0 && (cell as usize) < sampled.len() {
                    let lowest = &mut sampled[cell as usize];
                    *lowest = lowest.min(y - tooth.radius * cosine);
                }
            }
        }
        for (height, sampled) in profile.heights.iter().zip(sampled) {
            assert!((height - sampled).abs() < 0.2e-6, "{height} {sampled}");
        }
    }

    /// By its definition a wave of the length of the cutoff is halved, long ones go, short ones stay; and constants go
    /// entirely.
    #[test]
    fn the_filter_halves_a_wave_of_the_cutoff() {
        let wave = |length: f64| {
            let heights = (0..4000).map(|index| 1e-6 * libm::sin(TAU * f64::from(index) * 10e-6 / length)).collect();
            let profile = Profile { start: 0.0, spacing: 10e-6, heights }.filtered(2.5e-3);
            let inside = &profile.heights[1000..3000];
            inside.iter().map(|height| height.abs()).fold(0.0, f64::max)
        };
        for (length, left) in [(2.5e-3, 0.5), (0.25e-3, 1.0), (5e-3, 1.0 - libm::pow(0.5, 0.25))] {
            assert!((wave(length) / 1e-6 - left).abs() < 2e-3, "{length} {}", wave(length));
        }
        let flat = Profile { start: 0.0, spacing: 10e-6, heights: vec![3e-3; 100] }.filtered(2.5e-3);
        assert!(flat.heights.iter().all(|height| height.abs() < 1e-17));
        assert_eq!(Profile { heights: vec![], ..flat }.roughness(), None);
    }
}
