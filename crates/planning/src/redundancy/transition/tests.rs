//! A step against plain loops over real angles, and against steps that break its rules one by one.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::robot::angles::wrap;

const CLASS: PostureClass = PostureClass::ALL[1];

/// A score and real joint angles.
type State = (f64, [f64; 6]);

/// Random scores and real joint angles of two points, random limits.
struct Case {
    count: usize,
    change: BetaChange,
    sense: Sense,
    aggregate: Aggregate,
    /// Of joints not treated modulo a turn.
    ranges: [Option<Range>; 6],
    limits: [f64; 6],
    /// How joint 3 counts in a sum with joint 2 that is limited in its place, in some cases.
    fold: Option<f64>,
    /// Before and now, over beta: what is not there is not allowed.
    points: [Vec<Option<State>>; 2],
}

impl Case {
    fn random(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let count = random.random_range(9..70_usize);
        // Some joints hardly move, some go all the way from limit to limit.
        let ranges: [Range; 6] = std::array::from_fn(|_| {
            let (min, width) = (random.random_range(-6.0..3.0_f64), random.random_range(0.2..TAU - 3e-3));
            Range { min, max: min + width }
        });
        let shares: [f64; 6] =
            std::array::from_fn(|_| if random.random::<f64>() < 0.7 { 0.05 } else { random.random_range(0.3..1.0) });
        let is_modulo: [bool; 6] = std::array::from_fn(|_| random.random::<bool>());
        let limits = std::array::from_fn(|_| random.random_range(0.3..3.3_f64));
        let mut point = || {
            let state = |random: &mut ChaCha8Rng| {
                let angle = |j: usize, random: &mut ChaCha8Rng| {
                    let width = ranges[j].max - ranges[j].min;
                    // Both ends of the range: a narrow joint may have its gap between them.
                    let share = random.random::<f64>() * shares[j];
                    let share = if j.is_multiple_of(2) && random.random::<bool>() { 1.0 - share } else { share };
                    ranges[j].min + width * share
                };
                (random.random_range(0.1..1.0), std::array::from_fn(|j| angle(j, random)))
            };
            (0..count).map(|_| if random.random::<f64>() < 0.85 { Some(state(&mut random)) } else { None }).collect()
        };
        let points = [point(), point()];
        // About zero in half of the cases, anywhere in the others.
        let (reach, middle) = (random.random_range(0..4), random.random_range(-1..2));
        let change = if random.random() {
            BetaChange { min: -reach, max: reach }
        } else {
            BetaChange { min: middle - reach, max: middle + reach + random.random_range(0..2) }
        };
        // Sums are told modulo a turn here.
        let fold = [None, Some(1.0), Some(-1.0)][(seed % 3) as usize];
        let is_modulo = |j: usize| is_modulo[j] || (j == 2 && fold.is_some());
        let ranges = std::array::from_fn(|j| Some(ranges[j]).filter(|_| !is_modulo(j)));
        Self {
            count,
            change,
            sense: if random.random() { Sense::Max } else { Sense::Min },
            aggregate: if random.random_range(0..3) == 0 { Aggregate::Max } else { Aggregate::Mean },
            ranges,
            limits,
            fold,
            points,
        }
    }

    fn states(&self, point: usize, wrap_around: fn(&mut StateGrid)) -> StateGrid {
        let mut states = StateGrid::new(self.count, 6).with_angles(true);
        for (beta, state) in self.points[point].iter().enumerate() {
            if let Some((score, joints)) = state {
                states.set(CLASS, beta, *score, *joints);
            }
        }
        wrap_around(&mut states);
        states
    }

    fn is_within(&self, old: &[f64; 6], new: &[f64; 6]) -> bool {
        (0..6).all(|j| {
            let turned = new[j] - old[j];
            let turned = match self.fold {
                Some(fold) if j == 2 => new[1] - old[1] + fold * turned,
                _ => turned,
            };
            let turned = if self.ranges[j].is_none() { wrap(turned) } else { turned };
            turned.abs() <= self.limits[j]
        })
    }

    /// What plain loops say of the step to `here`: the smallest cost of a predecessor.
    fn expected(&self, here: usize) -> f64 {
        let Some((score, joints)) = self.points[1][here] else { return f64::INFINITY };
        let changes = self.change.min..=self.change.max;
        let before = changes.filter_map(|change| self.points[0][self.turned(here, -change as isize)]);
        let costs = before.filter(|(_, old)| self.is_within(old, &joints)).map(|(cost, _)| cost);
        let cost = costs.fold(f64::INFINITY, f64::min);
        if cost.is_finite() { self.aggregate.join_signed(self.sense, cost, self.sense.sign() * score) } else { cost }
    }

    fn turned(&self, here: usize, shift: isize) -> usize {
        (here as isize + shift).rem_euclid(self.count as isize) as usize
    }

    /// What is wrong with a step under the given rules, if anything is.
    fn fault<R: Rules>(&self, instructions: Instructions, wrap_around: fn(&mut StateGrid)) -> Option<String> {
        let joints = std::array::from_fn(|j| JointStep::new(self.limits[j], self.ranges[j]));
        let step = Step {
            change: self.change,
            joints,
            fold: self.fold,
            sense: self.sense,
            aggregate: self.aggregate,
            travel: 0.0,
            instructions,
        };
        let before = self.states(0, wrap_around);
        let mut now = self.states(1, wrap_around);
        let mut way = vec![0; self.count];
        let reached = advance_by::<R, f64>(&before, &mut now, CLASS, &step, None, Some(&mut way));
        let expected: Vec<f64> = (0..self.count).map(|here| self.expected(here)).collect();
        if reached != expected.iter().any(|cost| cost.is_finite()) {
            return Some(format!("reached: {reached}"));
        }
        for (here, expected) in expected.into_iter().enumerate() {
            let found = now.inner_scores(CLASS)[here];
            if found != expected {
                return Some(format!("cost {found} {expected} at {here}"));
            }
            if let Some((score, joints)) = self.points[1][here].filter(|_| expected.is_finite()) {
                let from = self.points[0][self.turned(here, isize::from(way[here]))];
                let right = from.is_some_and(|(cost, old)| {
                    self.is_within(&old, &joints)
                        && self.aggregate.join_signed(self.sense, cost, self.sense.sign() * score) == expected
                });
                if !right {
                    return Some(format!("way {} at {here}", way[here]));
                }
            }
        }
        None
    }
}

#[test]
fn joint_travel_counts_in_a_step() {
    let mut others = 0;
    for seed in 0..CASES {
        let case = Case::random(seed);
        let limits = case.limits.map(|limit| limit.min(3.0));
        let case = Case { sense: Sense::Min, aggregate: Aggregate::Mean, limits, ..case };
        let travel = 0.05;
        let cost = |here: usize, change: isize| {
            let (score, joints) = case.points[1][here]?;
            let (cost, old) =
                case.points[0][case.turned(here, -change)].filter(|(_, old)| case.is_within(old, &joints))?;
            let distance: f64 = (0..6).map(|j| wrap(joints[j] - old[j]).abs()).sum();
            Some(cost + travel * distance + score)
        };
        let (least, most) = (case.change.min as isize, case.change.max as isize);
        for instructions in Instructions::all() {
            let joints = std::array::from_fn(|j| JointStep::new(case.limits[j], case.ranges[j]));
            let (change, sense, aggregate) = (case.change, case.sense, case.aggregate);
            let fold = case.fold;
            let step = Step { change, joints, fold, sense, aggregate, travel, instructions };
            let before = case.states(0, wrap_around);
            let mut now = case.states(1, wrap_around);
            let mut way = vec![0; case.count];
            advance(&before, &mut now, CLASS, &step, &mut way);
            for here in 0..case.count {
                let found = now.inner_scores(CLASS)[here];
                let costs = (least..=most).filter_map(|change| cost(here, change));
                let expected = costs.fold(f64::INFINITY, f64::min);
                if expected.is_finite() {
                    let told = cost(here, -isize::from(way[here])).unwrap();
                    assert!((found - expected).abs() < 1e-12 && (told - expected).abs() < 1e-12, "{found} {expected}");
                    others += usize::from((expected - case.expected(here)).abs() > 1e-3);
                } else {
                    assert_eq!(found, expected);
                }
            }
        }
    }
    assert!(others > 1000, "{others}");
}

#[test]
fn of_a_free_step_the_way_is_found_again_from_the_costs() {
    for seed in 0..CASES {
        let case = Case::random(seed);
        let (change, sense, aggregate) = (case.change, case.sense, case.aggregate);
        for instructions in Instructions::all() {
            let joints = [JointStep::Any; 6];
            let step = Step { change, joints, fold: case.fold, sense, aggregate, travel: 0.0, instructions };
            let before = case.states(0, wrap_around);
            let [mut now, mut alone] = [(); 2].map(|()| case.states(1, wrap_around));
            let mut way = vec![0; case.count];
            let reached = advance(&before, &mut now, CLASS, &step, &mut way);
            assert_eq!(advance_costs(&before, &mut alone, CLASS, &step), reached);
            assert_eq!(alone.inner_scores(CLASS), now.inner_scores(CLASS));
            for (here, shift) in
                way.into_iter().enumerate().filter(|(here, _)| now.inner_scores(CLASS)[*here].is_finite())
            {
                assert_eq!(cheapest_shift(change, before.inner_scores(CLASS), here), shift);
            }
        }
    }
}

#[test]
fn where_a_step_is_free_every_joint_can_make_every_step() {
    let mut seen = [0; 2];
    for seed in 0..CASES {
        let case = Case { limits: [PI; 6], ..Case::random(seed) };
        let joints = std::array::from_fn(|j| JointStep::new(case.limits[j], case.ranges[j]));
        let (change, sense, aggregate) = (case.change, case.sense, case.aggregate);
        let [before, now] = [0, 1].map(|point| case.states(point, wrap_around));
        let free = Instructions::all().into_iter().map(|instructions| {
            let step = Step { change, joints, fold: case.fold, sense, aggregate, travel: 0.0, instructions };
            step.is_free(&before, &now, CLASS)
        });
        let free: Vec<bool> = free.collect();
        assert!(free.iter().all(|is_free| *is_free == free[0]));
        let mut pairs =
            case.points[0].iter().flatten().flat_map(|old| case.points[1].iter().flatten().map(move |new| (old, new)));
        assert!(!free[0] || pairs.all(|((_, old), (_, new))| case.is_within(old, new)), "{seed}");
        seen[usize::from(free[0])] += 1;
    }
    assert!(seen.iter().all(|number| *number > CASES / 20), "{seen:?}");
}

fn wrap_around(states: &mut StateGrid) {
    states.wrap_around(CLASS);
}

/// Rows continued by the wrong neighbours, one off.
fn wrap_one_off(states: &mut StateGrid) {
    wrap_around(states);
    let (count, pad) = (states.count(), states.pad());
    let scores = states.scores_mut(CLASS);
    scores.copy_within(count + 1..count + pad, 0);
    scores.copy_within(pad + 1..2 * pad, pad + count);
}

const CASES: u64 = 400;

#[test]
fn a_step_agrees_with_plain_loops_on_every_processor() {
    let mut joint_paths = 0;
    for seed in 0..CASES {
        let case = Case::random(seed);
        for instructions in Instructions::all() {
            assert_eq!(case.fault::<Right>(instructions, wrap_around), None, "{seed} {instructions:?}");
        }
        let unbound = Case { limits: [7.0; 6], ..Case::random(seed) };
        let bound = (0..case.count).filter(|k| case.expected(*k) != unbound.expected(*k));
        joint_paths += bound.filter(|k| case.expected(*k).is_finite()).count();
    }
    // The cases have joints that force another way, and often.
    assert!(joint_paths > 1000, "{joint_paths}");
}

/// Rules with one of them broken.
macro_rules! breach {
    ($name:ident: $rule:ident, $kind:ty, $value:expr) => {
        struct $name;
        impl Rules for $name {
            const $rule: $kind = $value;
        }
    };
}

breach!(BandOneTooWide: WIDER, i32, 1);
breach!(PredecessorBeside: BESIDE, i16, 1);
breach!(LimitOfTheNextJoint: OTHER_JOINT, usize, 1);
breach!(NeverLooksAgain: LOOKS_AGAIN, bool, false);
breach!(NoJointSteps: STEPS_COUNT, bool, false);
breach!(AlwaysSmallest: SIGNED, bool, false);

/// The share of the cases in which a breach is noticed.
fn noticed<R: Rules>(wrap_around: fn(&mut StateGrid)) -> f64 {
    let best = Instructions::best();
    let faults = (0..CASES).filter(|seed| Case::random(*seed).fault::<R>(best, wrap_around).is_some());
    faults.count() as f64 / CASES as f64
}

#[test]
fn every_breach_of_the_rules_is_noticed() {
    let breaches = [
        ("band one too wide", noticed::<BandOneTooWide>(wrap_around)),
        ("predecessor beside the one taken", noticed::<PredecessorBeside>(wrap_around)),
        ("limit of the next joint", noticed::<LimitOfTheNextJoint>(wrap_around)),
        ("no second look where a joint steps too far", noticed::<NeverLooksAgain>(wrap_around)),
        ("joint steps not checked", noticed::<NoJointSteps>(wrap_around)),
        ("smallest instead of largest", noticed::<AlwaysSmallest>(wrap_around)),
        ("cyclic continuation one off", noticed::<Right>(wrap_one_off)),
    ];
    for (name, share) in breaches {
        assert!(share > 0.2, "{name} is noticed in {share} of the cases");
    }
    assert_eq!(noticed::<Right>(wrap_around), 0.0);
}

/// Whether a joint's step is allowed, in the first lane.
struct OneStep(JointStep, f64, f64);

impl WithSimd for OneStep {
    type Number = f64;
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd<Number = f64>>(self, simd: S) -> bool {
        let direction = |angle: f64| {
            let (sine, cosine) = libm::sincos(angle);
            [Lanes::splat(simd, sine), Lanes::splat(simd, cosine)]
        };
        self.0.allows(simd, direction(self.1), direction(self.2)).first() == 0
    }
}

#[test]
fn joint_steps_are_told_from_directions_up_to_rounding() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut kinds = [0; 3];
    for k in 0..20_000 {
        // Limits from far below rounding to above half a turn.
        let limit = match k % 4 {
            0 => libm::exp(random.random_range(-22.0..1.2_f64)),
            1 => PI - 1e-6,
            2 => 0.0,
            _ => random.random_range(2.5..6.0),
        };
        let width = random.random_range(0.01..TAU - 1e-6);
        let min = random.random_range(-7.0..4.0_f64);
        let range = Range { min, max: min + width };
        let (has_range, step) = (k % 3 > 0, random.random_range(-1.0..1.0_f64));
        let old = min + width * random.random::<f64>();
        // Steps of any size, and just inside and outside the limit.
        let step = match k % 5 {
            0 => step * width,
            1 => step.signum() * (limit + 0.5e-9),
            2 => step.signum() * (limit + 1.5e-9),
            3 => step.signum() * (limit + STEP_ROUNDING - 1e-4 * limit.min(1.0)),
            _ => step * limit,
        };
        let new = old + step;
        if has_range && !(range.min..=range.max).contains(&new) {
            continue;
        }
        let turned = if has_range { step.abs() } else { wrap(step).abs() };
        // Half a turn is told to a millionth of a degree.
        let doubt = if (limit - PI).abs() < 1e-5 || (turned - PI).abs() < 1e-5 { 2e-8 } else { 2e-10 };
        if (turned - limit - STEP_ROUNDING).abs() < doubt {
            continue;
        }
        let rule = JointStep::new(limit, Some(range).filter(|_| has_range));
        kinds[match rule {
            JointStep::Any => 0,
            JointStep::Chord(_) => 1,
            JointStep::Around { .. } => 2,
        }] += 1;
        for instructions in Instructions::all() {
            let found = instructions.run(OneStep(rule, old, new));
            assert_eq!(found, turned <= limit + STEP_ROUNDING, "{rule:?} limit {limit} {old} {new} {range:?}");
        }
    }
    assert!(kinds.iter().all(|count| *count > 500), "{kinds:?}");
}
