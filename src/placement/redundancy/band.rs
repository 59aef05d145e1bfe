//! Dynamic programming over the grid of beta, in the four posture classes at once.
//!
//! Point by point: the kernel fills a fresh set of states, and each state takes the cheapest predecessor within the band
//! that the rate of beta allows and from which no joint has to step too far. Only the last two points are kept, and for
//! each state the way it came.

use super::super::kernel::{
    Kernel, States,
    lanes::{Lanes, Mask, WIDTH},
};
use super::{Extremum, Planner, STEP_ROUNDING, Workspace};
use crate::robot::{Posture, PostureClass};
use std::f64::consts::{PI, TAU};
use std::ops::Range as Span;

/// What one pass over a segment found.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    /// For each class the smallest sum of signed scores and the beta number at the end.
    pub ends: [Option<(f64, usize)>; 4],
    /// For each class the first point that it cannot get to.
    pub stuck: [Option<usize>; 4],
    /// Points without an allowed state in any class asked for.
    pub blocked: Vec<usize>,
}

impl Sweep {
    /// The first point that the class that gets farthest cannot get to: the last one, where a class gets through but for
    /// the turns of its joints.
    pub fn farthest(&self, span: &Span<usize>) -> usize {
        let last = span.end - 1;
        if self.ends.iter().any(Option::is_some) {
            last
        } else {
            self.stuck.iter().flatten().copied().max().unwrap_or(last)
        }
    }
}

/// What bounds a step from one point to the next.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Largest change of the beta number.
    pub reach: usize,
    /// Largest change of each joint angle. rad
    pub limits: &'a [f64; 6],
    /// Joints whose angles are compared modulo a turn.
    pub modulo: &'a [bool; 6],
    /// Scores times this are minimised.
    pub sign: f64,
}

impl Planner<'_> {
    /// What bounds the step to path point `point` from the one before.
    pub fn step(&self, point: usize, extremum: Extremum) -> Step<'_> {
        Step { reach: self.reaches[point], limits: &self.steps[point], modulo: &self.modulo, sign: extremum.sign() }
    }

    /// Passes over the points of a segment with one of the kernels, in every posture class or in that of one posture. With `count_only`, only the
    /// blocked points are found.
    #[expect(clippy::too_many_arguments, reason = "one step of the planner, with all it has")]
    pub(super) fn sweep(
        &self,
        kernel: &Kernel<'_>,
        span: Span<usize>,
        pose: &[f64; 4],
        extremum: Extremum,
        only: Option<Posture>,
        workspace: &mut Workspace,
        count_only: bool,
    ) -> Sweep {
        let count = self.grid.beta_count;
        let mut sweep = Sweep { ends: [None; 4], stuck: [None; 4], blocked: Vec::new() };
        let Workspace { scratch, before, now, came_from } = workspace;
        for (place, point) in span.enumerate() {
            kernel.evaluate(point, pose, scratch, now);
            if let Some(posture) = only {
                PostureClass::ALL
                    .into_iter()
                    .filter(|class| *class != posture.class())
                    .for_each(|class| now.clear(class));
            }
            if PostureClass::ALL.iter().all(|class| !now.is_alive(*class)) {
                sweep.blocked.push(point);
            }
            if count_only {
                continue;
            }
            let step = self.step(point, extremum);
            for class in PostureClass::ALL {
                if now.is_alive(class) {
                    let way = &mut came_from[(place * 4 + class.index()) * count..][..count];
                    if place == 0 {
                        begin(now, class, step.sign);
                    } else if !before.is_alive(class) || !advance(before, now, class, &step, way) {
                        now.clear(class);
                    }
                }
                if now.is_alive(class) {
                    now.wrap_around(class);
                } else if sweep.stuck[class.index()].is_none() {
                    sweep.stuck[class.index()] = Some(point);
                }
            }
            std::mem::swap(before, now);
        }
        if !count_only {
            for class in PostureClass::ALL.into_iter().filter(|class| before.is_alive(*class)) {
                let costs = before.inner_scores(class);
                let end = (0..count).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
                sweep.ends[class.index()] = Some((costs[end], end));
            }
        }
        sweep
    }

    /// The beta numbers of the plan that a class ended with, along the segment last swept.
    pub(super) fn trace(
        &self,
        span: &Span<usize>,
        class: PostureClass,
        sweep: &Sweep,
        workspace: &Workspace,
    ) -> Vec<usize> {
        let count = self.grid.beta_count;
        let mut beta = sweep.ends[class.index()].map_or(0, |(_, end)| end);
        let mut betas = vec![beta; span.len()];
        for place in (1..span.len()).rev() {
            let step = workspace.came_from[(place * 4 + class.index()) * count + beta];
            beta = (beta as isize + isize::from(step)).rem_euclid(count as isize) as usize;
            betas[place - 1] = beta;
        }
        betas
    }
}

/// Turns the scores of a segment's first point into costs.
pub fn begin(now: &mut States, class: PostureClass, sign: f64) {
    for score in now.scores_mut(class).iter_mut() {
        if score.is_finite() {
            *score *= sign;
        }
    }
}

/// Turns the scores of a point into the smallest sums of costs up to it, from those of the point before; `way` takes for
/// each beta number the step back to the predecessor. False when no state was reached.
///
/// Rows of `before` must be continued cyclically (see [`States::wrap_around`]) by at least `step.reach`.
pub fn advance(before: &States, now: &mut States, class: PostureClass, step: &Step<'_>, way: &mut [i16]) -> bool {
    let (count, pad) = (now.count(), now.pad());
    let infinity = Lanes::splat(f64::INFINITY);
    let mut reached = false;
    for start in (0..count).step_by(WIDTH) {
        let score = Lanes::load(now.scores(class), pad + start);
        let allowed = score.less(infinity);
        if !allowed.any() {
            continue;
        }
        let here = pad + start;
        // The cheapest predecessors, joint steps not looked at. Mostly they are within every step, and then they are the
        // cheapest of those that are.
        let (mut best, mut from) = cheapest(before, class, step.reach, here, |_, better| better);
        let chosen: [usize; WIDTH] = std::array::from_fn(|k| (here + k).wrapping_add_signed(from.0[k] as isize));
        let known = allowed & best.less(infinity);
        if !within_steps(before, now, class, step, here, |k| chosen[k]).covers(known) {
            (best, from) = cheapest(before, class, step.reach, here, |place, better| {
                better & within_steps(before, now, class, step, here, |k| place + k)
            });
        }
        let known = allowed & best.less(infinity);
        reached |= known.any();
        let cost = known.select(best + score * step.sign, infinity);
        let row = now.scores_mut(class);
        for k in 0..WIDTH.min(count - start) {
            row[here + k] = cost.0[k];
            way[start + k] = from.0[k] as i16;
        }
    }
    reached
}

/// For four neighbouring states from `here` the smallest cost of a predecessor that `admits` it, and the shift to it. Small
/// shifts are looked at first, so that of equal ways the quietest is taken.
#[inline(always)]
fn cheapest(
    before: &States,
    class: PostureClass,
    reach: usize,
    here: usize,
    admits: impl Fn(usize, Mask) -> Mask,
) -> (Lanes, Lanes) {
    let costs = before.scores(class);
    let reach = reach as isize;
    let mut best = Lanes::splat(f64::INFINITY);
    let mut from = Lanes::splat(0.0);
    for k in 0..=2 * reach {
        let shift = if k % 2 == 1 { -(k + 1) / 2 } else { k / 2 };
        let place = here.wrapping_add_signed(shift);
        let cost = Lanes::load(costs, place);
        let better = cost.less(best);
        if !better.any() {
            continue;
        }
        let better = admits(place, better);
        best = better.select(cost, best);
        from = better.select(Lanes::splat(shift as f64), from);
    }
    (best, from)
}

/// Which of four neighbouring states from `here` are within every joint's step of their predecessors at `there`.
#[inline(always)]
fn within_steps(
    before: &States,
    now: &States,
    class: PostureClass,
    step: &Step<'_>,
    here: usize,
    there: impl Fn(usize) -> usize,
) -> Mask {
    let there: [usize; WIDTH] = std::array::from_fn(there);
    let mut within = Mask::splat(true);
    for j in 0..6 {
        let limit = step.limits[j] + STEP_ROUNDING;
        if step.modulo[j] && limit >= PI {
            continue;
        }
        let old = before.joint(class, j);
        let mut turned = Lanes::load(now.joint(class, j), here) - Lanes(there.map(|place| old[place]));
        if step.modulo[j] {
            turned = turned - (turned * (1.0 / TAU)).round() * TAU;
        }
        within = within & turned.abs().at_most(Lanes::splat(limit));
    }
    within
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const CLASS: PostureClass = PostureClass::ALL[0];

    /// States with random scores and angles, some not allowed.
    fn random_states(count: usize, pad: usize, random: &mut ChaCha8Rng) -> States {
        let mut states = States::new(count, pad);
        for beta in 0..count {
            if random.random::<f64>() < 0.8 {
                let joints = std::array::from_fn(|_| random.random_range(-3.1..3.1));
                states.class_mut(CLASS).set(beta, random.random::<f64>(), joints);
            }
        }
        states.wrap_around(CLASS);
        states
    }

    proptest! {
        #[test]
        fn advance_agrees_with_plain_loops(
            seed in any::<u64>(), count in 9..40_usize, reach in 0..4_usize, limit in 0.3..3.2_f64, largest in any::<bool>()
        ) {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let before = random_states(count, reach, &mut random);
            let now = random_states(count, reach, &mut random);
            let modulo = [true, false, false, true, false, true];
            let sign = if largest { -1.0 } else { 1.0 };
            let step = Step { reach, limits: &[limit; 6], modulo: &modulo, sign };
            let within = |here: usize, there: usize| (0..6).all(|j| {
                let turned = now.joint(CLASS, j)[reach + here] - before.joint(CLASS, j)[reach + there];
                let turned = if modulo[j] { crate::robot::angles::wrap(turned) } else { turned };
                turned.abs() <= limit
            });
            let mut advanced = now.clone();
            let mut way = vec![0; count];
            advance(&before, &mut advanced, CLASS, &step, &mut way);
            for here in 0..count {
                let shifts = -(reach as isize)..=reach as isize;
                let from = |shift: isize| (here as isize + shift).rem_euclid(count as isize) as usize;
                let ways = shifts.filter(|shift| within(here, from(*shift)));
                let cheapest = ways.map(|shift| before.inner_scores(CLASS)[from(shift)]).fold(f64::INFINITY, f64::min);
                let expected = cheapest + sign * now.inner_scores(CLASS)[here];
                let found = advanced.inner_scores(CLASS)[here];
                if expected.is_finite() {
                    prop_assert_eq!(found, expected);
                    let predecessor = from(isize::from(way[here]));
                    prop_assert!(within(here, predecessor));
                    prop_assert_eq!(before.inner_scores(CLASS)[predecessor], cheapest);
                } else {
                    prop_assert!(found == f64::INFINITY);
                }
            }
        }
    }
}
