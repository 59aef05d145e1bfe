//! The table `[redundancy]`: how the free rotation of the spindle about the tool axis is planned.

use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::scalars::words;
use stead_format::units::{Deg, DegPerMm, DegPerS, MmPerS, Positive};
use stead_problem::problem::{BetaPlan, Problem, Redundancy};

words!(BetaPlan: "free" => BetaPlan::Free, "constant_per_segment" => BetaPlan::ConstantPerSegment,
    "constant" => BetaPlan::Constant);

/// The free rotation of the spindle about the tool axis, beta, along the path. At least one of its three limits is
/// needed where it may change.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RedundancyTable {
    /// Step of the grid of beta; 360 over a whole number from 4 to 7200. Final plans are refined off the grid.
    pub beta_step_deg: Deg<Positive>,
    /// Speed of the tool along the path.
    pub feed_mm_per_s: MmPerS<Positive>,
    /// Largest change of beta, the angle of the spindle against the feed, along the path.
    pub max_beta_rate_deg_per_mm: Option<DegPerMm<Positive>>,
    /// Largest turn of the spindle in space, as the angle between the tool frames at neighbouring points, along the
    /// path.
    pub max_spindle_turn_deg_per_mm: Option<DegPerMm<Positive>>,
    /// The same in time, at the feed.
    pub max_spindle_turn_deg_per_s: Option<DegPerS<Positive>>,
    /// Where beta, the angle of the spindle against the feed, may change: `free` (where left out) from point to point,
    /// `constant_per_segment` from segment to segment alone, `constant` nowhere.
    pub beta: Option<Word<BetaPlan>>,
}

/// Bounds of the number of grid values of beta over a full turn.
const BETA_COUNT: std::ops::RangeInclusive<f64> = 4.0..=7200.0;
/// The keys of the limits, of which one is needed.
const LIMITS: &str =
    "at least one of max_beta_rate_deg_per_mm, max_spindle_turn_deg_per_mm and max_spindle_turn_deg_per_s";

impl RedundancyTable {
    pub(super) fn redundancy(&self, at: &Place<'_>) -> Result<Redundancy, InputError> {
        let step = self.beta_step_deg.written();
        let count = (360.0 / step).round();
        if !BETA_COUNT.contains(&count) || (count * step - 360.0).abs() > 360.0 * 1e-9 {
            let (most, fewest) = (BETA_COUNT.end(), BETA_COUNT.start());
            return Err(at.key("beta_step_deg").error(
                "does not divide a full turn into an allowed number of steps",
                format!(
                    "360 over a whole number from {fewest} to {most}, so from {} to {}",
                    360.0 / most,
                    360.0 / fewest
                ),
            ));
        }
        let redundancy = Redundancy {
            beta_count: count as usize,
            feed: self.feed_mm_per_s.si(),
            max_beta_rate: self.max_beta_rate_deg_per_mm.map(Quantity::si),
            max_spindle_turn: self.max_spindle_turn_deg_per_mm.map(Quantity::si),
            max_spindle_speed: self.max_spindle_turn_deg_per_s.map(Quantity::si),
            beta: self.beta.map_or(BetaPlan::Free, |word| word.0),
        };
        let limits = [redundancy.max_beta_rate, redundancy.max_spindle_turn, redundancy.max_spindle_speed];
        if limits.iter().all(Option::is_none) && redundancy.beta == BetaPlan::Free {
            return Err(at.error("sets no limit to the rotation of the spindle", LIMITS));
        }
        Ok(redundancy)
    }
}

/// Refuses limits on the turn of the spindle that its axis alone passes, whatever beta is.
pub(super) fn check_axis_turns(problem: &Problem, at: &Place<'_>) -> Result<(), InputError> {
    let inner = problem.task.segments().iter().flat_map(|span| span.clone().skip(1));
    let inner = inner.filter(|point| !problem.task.path().turns_in_place(*point));
    let turned = inner.map(|point| (point, problem.axis_turn(point)));
    let by_length = turned.clone().map(|(point, turn)| (point, turn / problem.step_length(point)));
    let by_time = turned.map(|(point, turn)| (point, turn / problem.step_time(point)));
    let worst = |turns: &mut dyn Iterator<Item = (usize, f64)>| turns.max_by(|a, b| a.1.total_cmp(&b.1));
    let check = |key: &str, limit: Option<f64>, worst: Option<(usize, f64)>, unit: f64| {
        let (Some(limit), Some((point, turn))) = (limit, worst) else { return Ok(()) };
        if turn <= limit * (1.0 + 1e-9) {
            return Ok(());
        }
        // Rounded up, so that what is said to be allowed is.
        let turn = (turn.to_degrees() * unit * 1e4).ceil() / 1e4;
        let why = format!("the tool axis alone turns by {turn:.4} between path points {} and {point}", point - 1);
        Err(at.key(key).error(why, format!("at least {turn:.4}")))
    };
    let Redundancy { max_spindle_turn, max_spindle_speed, .. } = problem.redundancy;
    check("max_spindle_turn_deg_per_mm", max_spindle_turn, worst(&mut by_length.into_iter()), 1e-3)?;
    check("max_spindle_turn_deg_per_s", max_spindle_speed, worst(&mut by_time.into_iter()), 1.0)
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, assert_refused, folder, read_text as read};

    const RATE: &str = "max_beta_rate_deg_per_mm = 0.9";

    #[test]
    fn one_limit_of_three_is_enough_and_none_is_refused() {
        let limits = |text: &str| {
            let r = read(&RUN.replace(RATE, text)).unwrap().problem.redundancy;
            [r.max_beta_rate.map(|v| v * 1e-3), r.max_spindle_turn.map(|v| v * 1e-3), r.max_spindle_speed]
                .map(|limit| limit.map(|limit| (limit.to_degrees() * 1e6).round() / 1e6))
        };
        assert_eq!(limits(RATE), [Some(0.9), None, None]);
        assert_eq!(limits("max_spindle_turn_deg_per_mm = 0.5"), [None, Some(0.5), None]);
        assert_eq!(limits("max_spindle_turn_deg_per_s = 40"), [None, None, Some(40.0)]);
        assert_eq!(limits(&format!("{RATE}\nmax_spindle_turn_deg_per_s = 40")), [Some(0.9), None, Some(40.0)]);
        let names = ["max_beta_rate_deg_per_mm", "max_spindle_turn_deg_per_mm", "max_spindle_turn_deg_per_s"];
        assert_refused(RATE, "", &[&[":13: redundancy: ", "sets no limit"][..], &names].concat());
        for name in names {
            let place = format!(":16: redundancy.{name}: ");
            assert_refused(RATE, &format!("{name} = 0"), &[&place, "found 0", "above 0"]);
        }
    }

    #[test]
    fn a_limit_that_the_axis_alone_passes_is_refused() {
        let folder = folder();
        // The axis turns by 36.87 deg over 10 mm, in 0.2 s.
        let task = crate::testing::TASK.replace("1,10,0,0,1,0,0,0,0,1", "1,10,0,0,1,0,0,0,0.6,0.8");
        std::fs::write(folder.path().join("task.csv"), task).unwrap();
        let file = folder.path().join("run.toml");
        for (key, limit, parts) in [
            ("max_spindle_turn_deg_per_mm", 3.0, ["turns by 3.6870 between path points 0 and 1", "found 3;"]),
            ("max_spindle_turn_deg_per_s", 180.0, ["turns by 184.3495 between path points 0 and 1", "found 180;"]),
        ] {
            let read = |limit: f64| {
                std::fs::write(&file, RUN.replace(RATE, &format!("{key} = {limit}"))).unwrap();
                crate::read_run(&file)
            };
            let message = read(limit).unwrap_err().to_string();
            for part in
                parts.into_iter().chain([&format!("run.toml:16: redundancy.{key}: ")[..], "; allowed: at least"])
            {
                assert!(message.contains(part), "{part} in {message}");
            }
            assert!(read(limit * 1.3).is_ok());
        }
    }
}
