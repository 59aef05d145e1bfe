//! Whether a pass stayed calm: what its forces show and what small motions do, judged together.
//!
//! A motion that chatters is not the same again after one period of the cutter: a flip is the other way round, a Hopf
//! bifurcation has a frequency of its own. So forces are compared one period apart, and a period is the part of a turn
//! after which pitches and radii of the teeth repeat: a flip of a cutter with two equal teeth repeats every turn, and
//! only teeth that are compared with each other tell of it. With runout no two teeth are alike and a flip looks like
//! the runout itself; there the growth of small motions over the time in the work decides.

use super::coupled::{End, Run};
use super::stability::{Kind, Verdict};
use serde::Serialize;
use stead_model::cutting::Cutter;

/// How a pass went, by its forces and by the stability of small motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Judgement {
    /// Small motions die out, and the forces repeat.
    Calm,
    /// Small motions grow, and have become large.
    Chatter(Kind),
    /// Small motions grow, but have not become large by the end of the pass.
    Growing(Kind),
    /// Small motions die out at one of the two places where they are analysed, and grow at the other.
    Marginal,
    /// Small motions die out, but the forces do not repeat: the start is still felt, or large motions keep themselves
    /// up.
    Unsettled,
    /// The run ended before the pass.
    Ended,
}

impl Judgement {
    /// The word for it in files; of chatter, its kind.
    pub fn word(self) -> &'static str {
        match self {
            Judgement::Calm => "calm",
            Judgement::Chatter(kind) => kind.word(),
            Judgement::Growing(_) => "growing",
            Judgement::Marginal => "marginal",
            Judgement::Unsettled => "unsettled",
            Judgement::Ended => "ended",
        }
    }
}

/// What a pass is judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Evidence<'a> {
    /// How the run ended.
    pub end: &'a End,
    /// The cutter.
    pub cutter: &'a Cutter,
    /// [`period_variation`] over a period of the cutter, where it is known.
    pub variation: Option<f64>,
    /// Small motions in the middle of the work, and where the stability analysis looks at them.
    pub verdicts: [&'a Verdict; 2],
    /// How long the tool is in the work before the time in which the variation is measured. s
    pub time: f64,
}

/// Largest period variation of a cut without chatter.
pub const MAX_PERIOD_VARIATION: f64 = 0.2;
/// A motion that has grown by this factor is large, whatever it began with.
const LARGE: f64 = 1e3;

impl Evidence<'_> {
    pub fn judgement(&self) -> Judgement {
        if *self.end != End::Complete {
            return Judgement::Ended;
        }
        let repeats = self.variation.is_none_or(|variation| variation < MAX_PERIOD_VARIATION);
        let kind = self.verdicts[0].kind();
        match self.verdicts.map(Verdict::is_stable) {
            [true, true] if repeats => Judgement::Calm,
            [true, true] => Judgement::Unsettled,
            [false, false] if !repeats || self.is_hidden(kind) && self.has_grown() => Judgement::Chatter(kind),
            [false, false] => Judgement::Growing(kind),
            _ => Judgement::Marginal,
        }
    }

    /// Whether a motion of a kind is the same again after a period of the cutter with its runout: a flip after any even
    /// number of periods of its pitches.
    fn is_hidden(&self, kind: Kind) -> bool {
        let periods = self.cutter.repeats() / self.cutter.repeats_with_runout();
        kind == Kind::Flip && periods.is_multiple_of(2)
    }

    fn has_grown(&self) -> bool {
        self.verdicts[0].growth_rate() * self.time > libm::log(LARGE)
    }
}

/// Root mean square of the difference between forces one period (in steps) apart, between two times (s), relative to
/// that of the forces. Where the period is no whole number of steps, a difference counts as far as it leaves the values
/// of both steps around it: forces jump where teeth enter, so that interpolated ones would never repeat.
pub fn period_variation(run: &Run, window: [f64; 2], period: f64) -> Option<f64> {
    let range = steps(run, window)?;
    let [near, far] = [(period + WHOLE).floor() as usize, (period - WHOLE).ceil() as usize];
    let (mut changes, mut squares) = (0.0, 0.0);
    for index in range.start.max(far)..range.end {
        for axis in 0..2 {
            let [now, first, second] = [0, near, far].map(|back| run.samples[index - back].force[axis]);
            let change = now - now.max(first.min(second)).min(first.max(second));
            changes += change * change;
            squares += now * now;
        }
    }
    (squares > 0.0).then(|| (changes / squares).sqrt())
}

/// Periods that are so near to a whole number of steps are one.
const WHOLE: f64 = 1e-6;

/// Steps between two times (s); none if the run does not have them all.
pub(super) fn steps(run: &Run, window: [f64; 2]) -> Option<std::ops::Range<usize>> {
    let [first, last] = [(window[0] / run.step - 1e-9).ceil(), (window[1] / run.step + 1e-9).floor()];
    let range = first.max(0.0) as usize..last.max(0.0) as usize + 1;
    (!range.is_empty() && range.end <= run.samples.len()).then_some(range)
}

#[cfg(test)]
mod tests;
