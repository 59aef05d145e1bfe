//! When a gap will be reached, as far as its history tells.

use std::time::Duration;
use stead_numerics::monitor::Progress;

/// What is to be expected of a search for a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outlook {
    /// The gap requested, after so long from now at the earliest and at the latest, as far as its history tells.
    Reached([Duration; 2]),
    /// The gap has hardly become smaller while the time doubled, nor with its last report.
    Hardly,
}

/// The gaps of a search and when they were reached.
///
/// A gap falls about as a power of the time since there was one. The power is between that by which it fell while the
/// time doubled and that of its last two reports.
#[derive(Debug, Clone, Default)]
pub struct Forecast {
    stage: &'static str,
    /// Since the first gap (s), and the gap (relative).
    gaps: Vec<(f64, f64)>,
    began: Duration,
}

/// Nothing is said before the first gap is this old. s
const FIRST: f64 = 3.0;
/// A gap that falls by a lower power of the time is hardly closing,
const LEAST_POWER: f64 = 0.15;
/// unless its last report fell to this share of the one before.
const FALLEN: f64 = 0.9;

impl Forecast {
    /// What is to be expected after a report at a time on some clock; `None` where too little is known yet.
    pub fn add(&mut self, progress: &Progress, clock: Duration) -> Option<Outlook> {
        let Progress::Bound { stage, value, bound, gap: requested, .. } = *progress else { return None };
        if stage != self.stage {
            *self = Self { stage, ..Self::default() };
        }
        let gap = (1.0 - bound / value).abs();
        if bound <= 0.0 || !gap.is_finite() || gap >= 1.0 {
            return None;
        }
        if self.gaps.is_empty() {
            self.began = clock;
        }
        let now = clock.saturating_sub(self.began).as_secs_f64();
        if self.gaps.last().is_none_or(|last| last.1 != gap) {
            self.gaps.push((now, gap));
        }
        if now < FIRST || gap <= requested {
            return None;
        }
        let earlier = self.gaps.iter().rev().find(|(at, _)| *at <= 0.5 * now)?.1;
        let of_law = libm::log2(earlier / gap);
        let of_last = match self.gaps[..] {
            [.., (at, before), (then, last)] if at > 0.0 => Some((before, last, libm::log(then / at))),
            _ => None,
        };
        let has_fallen = of_last.is_some_and(|(before, last, _)| last <= FALLEN * before);
        if of_law < LEAST_POWER && !has_fallen {
            return Some(Outlook::Hardly);
        }
        let of_last = of_last.map(|(before, last, times)| libm::log(before / last) / times);
        let powers = [Some(of_law), of_last].into_iter().flatten().filter(|power| *power >= LEAST_POWER);
        let left = powers.map(|power| now * (libm::pow(gap / requested, 1.0 / power) - 1.0));
        let (least, most) =
            left.fold((f64::INFINITY, 0.0_f64), |(least, most), left| (least.min(left), most.max(left)));
        let band = [least, most].map(Duration::try_from_secs_f64);
        match band {
            [Ok(least), Ok(most)] => Some(Outlook::Reached([least, most])),
            _ => Some(Outlook::Hardly),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(gap: f64) -> Progress {
        Progress::Bound { stage: "certifying best", value: 1.0, bound: 1.0 - gap, gap: 0.01, open: 3, nodes: 9 }
    }

    #[test]
    fn a_gap_that_falls_as_a_power_of_the_time_is_foretold() {
        let mut forecast = Forecast::default();
        // From 16 % at 1 s by the power 1 / 2: 1 % after 256 s.
        let mut said = None;
        for tenth in 0..400 {
            let time = 0.1 * f64::from(tenth);
            let gap = 0.16 / time.max(1.0).sqrt();
            said = forecast.add(&report(gap), Duration::from_secs_f64(7.0 + time));
            assert!(time > 2.95 || said.is_none(), "{time}");
        }
        let Some(Outlook::Reached(left)) = said else { panic!("{said:?}") };
        assert!(left.iter().all(|left| (left.as_secs_f64() - 216.0).abs() < 20.0), "{left:?}");
        assert_eq!(forecast.add(&report(0.0099), Duration::from_secs(60)), None);
    }

    #[test]
    fn a_gap_that_falls_again_is_not_said_to_hardly_close() {
        let mut forecast = Forecast::default();
        let mut add = |second: u64, gap: f64| forecast.add(&report(gap), Duration::from_secs(second));
        add(0, 0.5);
        for second in 1..30 {
            add(second, 0.4);
        }
        assert_eq!(add(30, 0.4), Some(Outlook::Hardly));
        // By a tenth in the last report, of a gap that was the same for long.
        assert!(matches!(add(31, 0.36), Some(Outlook::Reached(_))));
        // By less than a tenth now: between the last two reports and what it fell by while the time doubled.
        let Some(Outlook::Reached([least, most])) = add(32, 0.2) else { panic!() };
        assert!(least < most, "{least:?} {most:?}");
    }

    #[test]
    fn a_gap_that_stays_is_said_to_hardly_close() {
        let mut forecast = Forecast::default();
        let mut said = None;
        for second in 0..20 {
            said = forecast.add(&report(0.5), Duration::from_secs(second));
        }
        assert_eq!(said, Some(Outlook::Hardly));
        // No gap yet, or another stage: nothing is known.
        assert_eq!(forecast.add(&report(1.0), Duration::from_secs(21)), None);
        let steps = Progress::Steps { stage: "refining", done: 1, total: 8 };
        assert_eq!(forecast.add(&steps, Duration::from_secs(22)), None);
    }
}
