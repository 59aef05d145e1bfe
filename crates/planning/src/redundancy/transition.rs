//! One step of the dynamic programming over the grid of beta, within one posture class: each state of a path point
//! takes the cheapest predecessor within the band that the limits on beta allow and from which no joint has to step too
//! far.
//!
//! Joint steps are compared by sines and cosines, and first for the cheapest predecessor of each state only: mostly it
//! is within every step, and then it is the cheapest of those that are.

use super::between::Between;
use super::rate_limit::BetaChange;
use std::f64::consts::{PI, TAU};
use std::marker::PhantomData;
use stead_model::robot::{PostureClass, angles::ANGLE_ROUNDING, turns::Range};
use stead_numerics::simd::{Instructions, Lanes, MAX_LANES, Mask, Simd, WithSimd};
use stead_problem::constraints::STEP_ROUNDING;
use stead_problem::criterion::Aggregate;
use stead_problem::evaluate::batch::{KernelNumber, StateGrid};
use stead_problem::sense::Sense;

/// What bounds a step from one point to the next.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Which changes of the beta number.
    pub change: BetaChange,
    /// Whether each joint can make the step.
    pub joints: [JointStep; 6],
    /// On an arm with a linkage, where motor 3 turns the sum of joints 2 and 3, how joint 3 counts in it: 1 or -1.
    pub fold: Option<f64>,
    /// Whether costs are minimised or maximised.
    pub sense: Sense,
    /// How the costs of points make up that of a path.
    pub aggregate: Aggregate,
    /// What a radian of joint travel costs.
    pub travel: f64,
    /// What the processor is to use.
    pub instructions: Instructions,
}

impl Step {
    /// Whether the joints can make all steps from the states of a point to those of the next in a class, and their
    /// travel does not count: then the cheapest predecessor may be taken as it is.
    pub(super) fn is_free<E: KernelNumber>(
        &self,
        before: &StateGrid<E>,
        now: &StateGrid<E>,
        class: PostureClass,
    ) -> bool {
        let may_be = |joint: &JointStep| match joint {
            JointStep::Any => true,
            JointStep::Chord(_) => false,
            JointStep::Around { max, .. } => *max >= LONGEST && self.fold.is_none(),
        };
        let around = |j: usize| match self.joints[j] {
            JointStep::Around { middle, .. } => {
                self.instructions.run(Around { states: [before, now], class, joint: j, middle })
            }
            _ => true,
        };
        self.travel == 0.0 && self.joints.iter().all(may_be) && (0..6).all(around)
    }
}

/// The longest chord, squared.
const LONGEST: f64 = 4.0;

/// Whether no step of a joint from a state of a point to one of the next leads past the gap outside its range: all are
/// on one side of the middle of the range, or less than a quarter turn from it.
struct Around<'s, E> {
    states: [&'s StateGrid<E>; 2],
    class: PostureClass,
    joint: usize,
    /// Sine and cosine.
    middle: (f64, f64),
}

impl<E: KernelNumber> WithSimd for Around<'_, E> {
    type Number = E;
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd<Number = E>>(self, simd: S) -> bool {
        let Self { states, class, joint, middle: (sine, cosine) } = self;
        let (zero, infinity) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, f64::INFINITY));
        let numbers = Lanes::load(simd, &NUMBERS.map(E::of), 0);
        let mut seen = [Mask::splat(simd, false); 3];
        for states in states {
            let (scores, [sines, cosines]) = (states.scores(class), states.directions(class, joint));
            for start in (0..states.count()).step_by(Lanes::<S>::COUNT) {
                let here = states.pad() + start;
                let left = Lanes::splat(simd, (states.count() - start) as f64);
                let open = Lanes::load(simd, scores, here).less(infinity) & numbers.less(left);
                let (s, c) = (Lanes::load(simd, sines, here), Lanes::load(simd, cosines, here));
                let beside = s * cosine - c * sine;
                seen[0] = seen[0] | (open & beside.less(zero));
                seen[1] = seen[1] | (open & zero.less(beside));
                seen[2] = seen[2] | (open & (c * cosine + s * sine).less(zero));
            }
        }
        let [left, right, behind] = [seen[0].any(), seen[1].any(), seen[2].any()];
        !(left && right && behind)
    }
}

/// The shift to the predecessor that [`advance`] takes for a state of number `here`, from the costs of the point before
/// over beta, where joints say nothing.
pub(super) fn cheapest_shift<E: KernelNumber>(change: BetaChange, costs: &[E], here: usize) -> i16 {
    let cost = |shift: isize| costs[(here as isize + shift).rem_euclid(costs.len() as isize) as usize].get();
    let middle = change.middle_shift();
    let (half, is_even) = ((change.count() - 1) / 2, change.count().is_multiple_of(2));
    let beside = (1..=half as isize).flat_map(|far| [middle - far, middle + far]);
    let last = is_even.then_some(middle - half as isize - 1);
    beside.chain(last).fold(middle, |best, shift| if cost(shift) < cost(best) { shift } else { best }) as i16
}

/// Which steps of a joint are small enough, told from sines and cosines of its angles before and after: by the square
/// of the chord between the two directions, `4 sin(step/2)^2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointStep {
    /// All.
    Any,
    /// Those with a chord of at most this, squared: for angles modulo a turn, and where the other way round would be
    /// longer than the joint's range.
    Chord(f64),
    /// For a joint with less than a turn, whose range is too wide for that: where the short way from one direction to
    /// the other leads through the gap outside its range, the step goes the long way round.
    Around {
        /// Largest chord, squared, of a step that does not go past the gap.
        max: f64,
        /// Smallest chord, squared, of a step that goes the long way round.
        min: f64,
        /// Sine and cosine of the middle of the range.
        middle: (f64, f64),
    },
}

impl JointStep {
    /// For a joint with a step of at most `limit` (rad), of a range of real angles of less than a turn or, with none,
    /// of angles modulo a turn.
    pub fn new(limit: f64, range: Option<Range>) -> Self {
        let limit = limit + STEP_ROUNDING;
        let half = libm::sin(limit.min(PI) / 2.0);
        let chord = 4.0 * half * half;
        let Some(range) = range else {
            return if limit >= PI { Self::Any } else { Self::Chord(chord) };
        };
        let width = range.max - range.min + 2.0 * ANGLE_ROUNDING;
        if limit >= width {
            Self::Any
        } else if limit + width < TAU - STEP_ROUNDING {
            Self::Chord(chord)
        } else {
            let half = libm::sin(limit / 2.0);
            let (max, min) = if limit >= PI { (f64::INFINITY, 4.0 * half * half) } else { (chord, f64::INFINITY) };
            Self::Around { max, min, middle: libm::sincos((range.min + range.max) / 2.0) }
        }
    }

    /// The same where chords may be longer by so much, the rounding of what they are made of.
    pub(super) fn with_rounding(self, rounding: f64) -> Self {
        let wider = |max: f64| {
            let chord = libm::sqrt(max) + rounding;
            chord * chord
        };
        match self {
            // No chord is longer than two radii.
            Self::Chord(max) if rounding > 0.0 && wider(max) >= LONGEST => Self::Any,
            Self::Chord(max) if rounding > 0.0 => Self::Chord(wider(max)),
            Self::Around { max, min, middle } if rounding > 0.0 => Self::Around { max: wider(max), min, middle },
            step => step,
        }
    }

    /// Where the step from one direction (sine, cosine) to another is small enough.
    #[inline(always)]
    fn allows<S: Simd>(&self, simd: S, old: [Lanes<S>; 2], new: [Lanes<S>; 2]) -> Mask<S> {
        if *self == Self::Any {
            return Mask::splat(simd, true);
        }
        let (s, c) = (new[0] - old[0], new[1] - old[1]);
        let chord = s * s + c * c;
        match *self {
            Self::Any => Mask::splat(simd, true),
            Self::Chord(max) => chord.at_most(Lanes::splat(simd, max)),
            Self::Around { max, min, middle: (sine, cosine) } => {
                // Seen from the middle of the range: where on the circle's axis through the gap the chord crosses it.
                let zero = Lanes::splat(simd, 0.0);
                let (s0, c0) = (old[0] * cosine - old[1] * sine, old[1] * cosine + old[0] * sine);
                let (s1, c1) = (new[0] * cosine - new[1] * sine, new[1] * cosine + new[0] * sine);
                let past = (s0 * s1).less(zero) & (c0 * s1.abs() + c1 * s0.abs()).less(zero);
                let long = past & Lanes::splat(simd, min).at_most(chord);
                chord.at_most(Lanes::splat(simd, max)).and_not(past) | long
            }
        }
    }
}

/// Turns the scores of a segment's first point into costs.
pub fn begin<E: KernelNumber>(now: &mut StateGrid<E>, class: PostureClass, sign: f64) {
    for score in now.scores_mut(class).iter_mut() {
        if score.get().is_finite() {
            *score = E::of(score.get() * sign);
        }
    }
}

/// Turns the scores of a point into the smallest sums of costs up to it, from those of the point before; `way` takes
/// for each beta number the step back to the predecessor. False when no state was reached.
///
/// Rows of `before` must be continued cyclically (see [`StateGrid::wrap_around`]) by at least [`BetaChange::widest`],
/// and where joint travel counts, both must keep angles (see [`StateGrid::with_angles`]).
pub fn advance<E: KernelNumber>(
    before: &StateGrid<E>,
    now: &mut StateGrid<E>,
    class: PostureClass,
    step: &Step,
    way: &mut [i16],
) -> bool {
    advance_by::<Right, E>(before, now, class, step, None, Some(way))
}

/// The same for a free step ([`Step::is_free`]) without the steps back, which [`cheapest_shift`] finds again.
pub(super) fn advance_costs<E: KernelNumber>(
    before: &StateGrid<E>,
    now: &mut StateGrid<E>,
    class: PostureClass,
    step: &Step,
) -> bool {
    advance_by::<Right, E>(before, now, class, step, None, None)
}

/// The same over a run of points, with what the points between cost.
pub(super) fn advance_over<E: KernelNumber>(
    before: &StateGrid<E>,
    now: &mut StateGrid<E>,
    class: PostureClass,
    step: &Step,
    between: Between<'_, E>,
    way: &mut [i16],
) -> bool {
    advance_by::<Right, E>(before, now, class, step, Some(between), Some(way))
}

#[inline]
fn advance_by<R: Rules, E: KernelNumber>(
    before: &StateGrid<E>,
    now: &mut StateGrid<E>,
    class: PostureClass,
    step: &Step,
    between: Option<Between<'_, E>>,
    way: Option<&mut [i16]>,
) -> bool {
    step.instructions.run(Advance::<R, E> { before, now, class, step, between, way, rules: PhantomData })
}

/// The rules of a step; the tests break them one by one, to see that each breach is noticed.
trait Rules {
    /// Changes beyond the allowed ones that are tried, at either end.
    const WIDER: i32 = 0;
    /// How far the predecessor told is beside the one taken.
    const BESIDE: i16 = 0;
    /// How far the limit of a joint's step belongs to a joint further on.
    const OTHER_JOINT: usize = 0;
    /// Whether a cheapest predecessor too far away for a joint is replaced by the cheapest that is not.
    const LOOKS_AGAIN: bool = true;
    /// Whether joint steps count at all.
    const STEPS_COUNT: bool = true;
    /// Whether the largest sum is sought where it is requested.
    const SIGNED: bool = true;
}

/// The rules as they are.
struct Right;

impl Rules for Right {}

struct Advance<'s, R, E> {
    before: &'s StateGrid<E>,
    now: &'s mut StateGrid<E>,
    class: PostureClass,
    step: &'s Step,
    between: Option<Between<'s, E>>,
    way: Option<&'s mut [i16]>,
    rules: PhantomData<R>,
}

impl<R: Rules, E: KernelNumber> WithSimd for Advance<'_, R, E> {
    type Number = E;
    type Output = bool;

    #[inline(always)]
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn with_simd<S: Simd<Number = E>>(self, simd: S) -> bool {
        let Self { before, now, class, step, between, mut way, .. } = self;
        let (count, pad) = (now.count(), now.pad());
        let lanes = Lanes::<S>::COUNT;
        let infinity = Lanes::splat(simd, f64::INFINITY);
        let numbers = Lanes::load(simd, &NUMBERS.map(E::of), 0);
        let sign = if R::SIGNED { step.sense.sign() } else { 1.0 };
        let BetaChange { min, max } = step.change;
        let change = BetaChange { min: min - R::WIDER, max: max + R::WIDER };
        if change.is_none() {
            now.scores_mut(class).fill(E::of(f64::INFINITY));
            return false;
        }
        let band = Band::<R, E>::new(before.scores(class), change, between);
        let stride = band.costs.len();
        let (scores, now_joints) = now.scores_and_joints(class);
        let joints = Joints::<R, E>::new(before.all_joints(class), now_joints, stride, step);
        let mut reached = false;
        for start in (0..count).step_by(lanes) {
            let here = pad + start;
            let score = Lanes::load(simd, scores, here);
            let allowed = score.less(infinity) & numbers.less(Lanes::splat(simd, (count - start) as f64));
            if !allowed.any() {
                continue;
            }
            let (mut best, mut from) = match &way {
                None => (band.least(simd, here), numbers),
                Some(_) if step.travel > 0.0 => band.calmest(simd, here, &joints, step.travel),
                Some(_) => band.cheapest(simd, here),
            };
            let mut known = allowed & best.less(infinity);
            if R::STEPS_COUNT && step.travel == 0.0 && way.is_some() && known.any() {
                let far = joints.too_far(simd, here, known, from);
                if far.any() {
                    if R::LOOKS_AGAIN {
                        (best, from) = band.cheapest_within(simd, here, &joints);
                        known = allowed & best.less(infinity);
                    } else {
                        known = known.and_not(far);
                    }
                }
            }
            reached |= known.any();
            let own = score * sign;
            let cost = match (step.aggregate, step.sense) {
                (Aggregate::Mean | Aggregate::Rms, _) => best + own,
                (Aggregate::Max, Sense::Min) => best.max(own),
                (Aggregate::Max, Sense::Max) => best.min(own),
            };
            known.select(cost, infinity).store(scores, here);
            if let Some(way) = &mut way {
                for (way, from) in way[start..].iter_mut().zip(from.to_whole()).take(lanes) {
                    *way = from + R::BESIDE;
                }
            }
        }
        reached
    }
}

const NUMBERS: [f64; MAX_LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The costs of the point before, and how far to look.
struct Band<'s, R, E> {
    costs: &'s [E],
    change: BetaChange,
    /// The shift in the middle, how many there are to either side of it, and whether there is one more below.
    middle: isize,
    half: usize,
    is_even: bool,
    between: Option<Between<'s, E>>,
    rules: PhantomData<R>,
}

impl<'s, R: Rules, E: KernelNumber> Band<'s, R, E> {
    #[inline(always)]
    fn new(costs: &'s [E], change: BetaChange, between: Option<Between<'s, E>>) -> Self {
        Self {
            costs,
            change,
            between,
            middle: change.middle_shift(),
            half: (change.count() - 1) / 2,
            is_even: change.count().is_multiple_of(2),
            rules: PhantomData,
        }
    }

    /// The costs of neighbouring states from `here` up to the points between, by the predecessors beside them.
    #[inline(always)]
    fn cost<S: Simd<Number = E>>(&self, simd: S, here: usize, shift: isize) -> Lanes<S> {
        let cost = Lanes::load(simd, self.costs, here.wrapping_add_signed(shift));
        match &self.between {
            None => cost,
            Some(between) => between.join(simd, cost, Lanes::load(simd, between.row(shift), here)),
        }
    }

    /// For neighbouring states from `here` the smallest cost of a predecessor, joint steps not checked, and the shift
    /// to it. Small shifts come first, so that of equal predecessors the nearest is taken.
    #[inline(always)]
    fn cheapest<S: Simd<Number = E>>(&self, simd: S, here: usize) -> (Lanes<S>, Lanes<S>) {
        let middle = self.middle;
        let mut best = self.cost(simd, here, middle);
        let mut from = Lanes::splat(simd, middle as f64);
        let (mut down, mut up) = (from, from);
        for far in 1..=self.half {
            (down, up) = (down - 1.0, up + 1.0);
            let (left, right) = (middle - far as isize, middle + far as isize);
            let (left, right) = (self.cost(simd, here, left), self.cost(simd, here, right));
            let better = left.less(best);
            best = better.select(left, best);
            from = better.select(down, from);
            let better = right.less(best);
            best = better.select(right, best);
            from = better.select(up, from);
        }
        if self.is_even {
            let left = self.cost(simd, here, middle - self.half as isize - 1);
            let better = left.less(best);
            best = better.select(left, best);
            from = better.select(down - 1.0, from);
        }
        (best, from)
    }

    /// The same cost alone.
    #[inline(always)]
    fn least<S: Simd<Number = E>>(&self, simd: S, here: usize) -> Lanes<S> {
        let (middle, half) = (self.middle, self.half as isize);
        let first = self.cost(simd, here, if self.is_even { middle - half - 1 } else { middle });
        let (mut left, mut right) = (first, self.cost(simd, here, middle));
        for far in 1..=half {
            left = left.min(self.cost(simd, here, middle - far));
            right = right.min(self.cost(simd, here, middle + far));
        }
        left.min(right)
    }

    /// The same among predecessors that are within every joint's step.
    #[inline(always)]
    fn cheapest_within<S: Simd<Number = E>>(
        &self,
        simd: S,
        here: usize,
        joints: &Joints<'_, R, E>,
    ) -> (Lanes<S>, Lanes<S>) {
        let mut best = Lanes::splat(simd, f64::INFINITY);
        let mut from = Lanes::splat(simd, 0.0);
        for shift in self.change.shifts() {
            let there = here.wrapping_add_signed(shift);
            let cost = self.cost(simd, here, shift);
            let mut better = cost.less(best);
            if better.any() {
                better = better & joints.within(simd, here, there);
                best = better.select(cost, best);
                from = better.select(Lanes::splat(simd, shift as f64), from);
            }
        }
        (best, from)
    }
}

impl<R: Rules, E: KernelNumber> Band<'_, R, E> {
    /// The same with the joint travel from each predecessor.
    #[inline(always)]
    fn calmest<S: Simd<Number = E>>(
        &self,
        simd: S,
        here: usize,
        joints: &Joints<'_, R, E>,
        travel: f64,
    ) -> (Lanes<S>, Lanes<S>) {
        let mut best = Lanes::splat(simd, f64::INFINITY);
        let mut from = Lanes::splat(simd, 0.0);
        let angles = joints.angles(simd, here);
        for shift in self.change.shifts() {
            let there = here.wrapping_add_signed(shift);
            let cost = self.cost(simd, here, shift);
            if !cost.less(best).any() {
                continue;
            }
            let cost = cost + joints.distance(simd, &angles, there) * travel;
            let better = cost.less(best);
            if !better.any() {
                continue;
            }
            let better = better & joints.within(simd, here, there);
            best = better.select(cost, best);
            from = better.select(Lanes::splat(simd, shift as f64), from);
        }
        (best, from)
    }
}

/// Joint angles at the point before and at this one, and how far each joint may step.
struct Joints<'s, R, E> {
    /// See [`StateGrid::all_joints`].
    old: &'s [E],
    new: &'s [E],
    old_angles: &'s [E],
    new_angles: &'s [E],
    stride: usize,
    limits: [JointStep; 6],
    fold: Option<f64>,
    /// Largest chords, squared, where they say all.
    chords: Option<[f64; 6]>,
    rules: PhantomData<R>,
}

impl<'s, R: Rules, E: KernelNumber> Joints<'s, R, E> {
    #[inline(always)]
    fn new(before: [&'s [E]; 2], now: [&'s [E]; 2], stride: usize, step: &Step) -> Self {
        let ([old, old_angles], [new, new_angles]) = (before, now);
        let joints = &step.joints;
        let (mut limits, mut chords, mut are_all) = (*joints, [0.0; 6], true);
        for j in 0..6 {
            limits[j] = joints[(j + R::OTHER_JOINT) % 6];
            match limits[j] {
                JointStep::Any => chords[j] = f64::INFINITY,
                JointStep::Chord(max) => chords[j] = max,
                JointStep::Around { .. } => are_all = false,
            }
        }
        let (fold, chords) = (step.fold, Some(chords).filter(|_| are_all));
        Self { old, new, old_angles, new_angles, stride, limits, fold, chords, rules: PhantomData }
    }

    /// Which of the `requested` states from `here` are too far for some joint from the predecessors `from` beside them.
    #[inline(always)]
    fn too_far<S: Simd<Number = E>>(&self, simd: S, here: usize, requested: Mask<S>, from: Lanes<S>) -> Mask<S> {
        // Neighbours mostly come by the same shift: all that do are checked at once.
        let shifts = from.to_whole();
        let (mut open, mut far) = (requested, Mask::splat(simd, false));
        loop {
            let lane = open.first();
            if lane >= Lanes::<S>::COUNT {
                return far;
            }
            let shift = shifts[lane % MAX_LANES];
            let same = open & from.equal(Lanes::splat(simd, f64::from(shift)));
            far = far | same.and_not(self.within(simd, here, here.wrapping_add_signed(isize::from(shift))));
            open = open.and_not(same);
        }
    }

    /// The joint angles of the states from `here`. rad
    #[inline(always)]
    fn angles<S: Simd<Number = E>>(&self, simd: S, here: usize) -> [Lanes<S>; 6] {
        std::array::from_fn(|j| Lanes::load(simd, self.new_angles, j * self.stride + here))
    }

    /// The joint travel to states of these angles from those from `there`. rad
    #[inline(always)]
    fn distance<S: Simd<Number = E>>(&self, simd: S, angles: &[Lanes<S>; 6], there: usize) -> Lanes<S> {
        let turn = Lanes::splat(simd, TAU);
        let travels = angles.iter().enumerate().map(|(j, angle)| {
            let turned = (*angle - Lanes::load(simd, self.old_angles, j * self.stride + there)).abs();
            turned.min(turn - turned)
        });
        travels.fold(Lanes::splat(simd, 0.0), |sum, turned| sum + turned)
    }

    /// Which of the states from `here` are within every joint's step of those from `there`.
    #[inline(always)]
    fn within<S: Simd<Number = E>>(&self, simd: S, here: usize, there: usize) -> Mask<S> {
        let stride = self.stride;
        let rows = self.old.chunks_exact(2 * stride).zip(self.new.chunks_exact(2 * stride));
        let mut within = Mask::splat(simd, true);
        let zero = Lanes::splat(simd, 0.0);
        let mut second = [[zero; 2]; 2];
        for (j, (old, new)) in rows.enumerate().take(6) {
            if self.fold.is_none() && self.limits[j] == JointStep::Any {
                continue;
            }
            let ((old_sines, old_cosines), (sines, cosines)) = (old.split_at(stride), new.split_at(stride));
            let mut old = [Lanes::load(simd, old_sines, there), Lanes::load(simd, old_cosines, there)];
            let mut new = [Lanes::load(simd, sines, here), Lanes::load(simd, cosines, here)];
            if let Some(fold) = self.fold {
                match j {
                    1 => second = [old, new],
                    2 => (old, new) = (sum(second[0], old, fold), sum(second[1], new, fold)),
                    _ => {}
                }
            }
            within = within
                & match &self.chords {
                    Some(chords) => {
                        let (s, c) = (new[0] - old[0], new[1] - old[1]);
                        (s * s + c * c).at_most(Lanes::splat(simd, chords[j]))
                    }
                    None => self.limits[j].allows(simd, old, new),
                };
        }
        within
    }
}

/// Sine and cosine of an angle and another, which counts by 1 or -1.
#[inline(always)]
fn sum<S: Simd>(angle: [Lanes<S>; 2], other: [Lanes<S>; 2], fold: f64) -> [Lanes<S>; 2] {
    let [s, c] = angle;
    let (other_s, other_c) = (other[0] * fold, other[1]);
    [s * other_c + c * other_s, c * other_c - s * other_s]
}

#[cfg(test)]
mod tests;
