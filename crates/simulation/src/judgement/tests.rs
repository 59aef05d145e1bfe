use super::super::coupled::Sample;
use super::super::surface::Trail;
use super::*;
use nalgebra::Complex;
use stead_model::cutting::{Coefficients, Rotation, Tooth};

/// A run of one step a second with this force along the feed.
fn run(force: impl Fn(usize) -> f64) -> Run {
    let sample = |index: usize| Sample { force: [force(index), 0.0, 0.0], deflection: [0.0; 2] };
    Run {
        step: 1.0,
        samples: (0..900).map(sample).collect(),
        trail: Trail::with_room(0, 1),
        end: End::Complete,
        evaluations: 0,
    }
}

/// A tooth that is in the work for a third of a period (in steps): the force jumps in and falls to nothing; each other
/// tooth has this much more of it.
fn pulses(period: f64, more: f64) -> Run {
    run(|index| {
        let turned = index as f64 / period;
        let (number, share) = (turned.floor(), turned - turned.floor());
        let factor = if (number as usize).is_multiple_of(2) { 1.0 + more } else { 1.0 };
        factor * (100.0 * (1.0 - 3.0 * share)).max(0.0)
    })
}

const WINDOW: [f64; 2] = [450.0, 890.0];

#[test]
fn a_flip_of_two_teeth_shows_from_tooth_to_tooth_and_not_from_turn_to_turn() {
    for period in [45.0, 22.5, 30.4] {
        let variation =
            |more: f64, periods: f64| period_variation(&pulses(period, more), WINDOW, periods * period).unwrap();
        // What is left without a flip are the jumps between two steps.
        assert!(variation(0.0, 1.0) < 0.06 && variation(0.0, 2.0) < 0.06, "{period}: {}", variation(0.0, 1.0));
        assert!(variation(1.0, 2.0) < 0.06, "{period}: {}", variation(1.0, 2.0));
        // 1 and 2 by turns: a difference of 1 beside a mean square of 5/2, so 0.63, less what the jumps hide.
        assert!((0.5..0.65).contains(&variation(1.0, 1.0)), "{period}: {}", variation(1.0, 1.0));
    }
}

#[test]
fn a_run_that_ended_before_the_window_has_no_variation() {
    assert_eq!(period_variation(&pulses(45.0, 1.0), [450.0, 950.0], 45.0), None);
    assert_eq!(period_variation(&run(|_| 0.0), WINDOW, 45.0), None);
}

fn cutter(runouts: &[f64]) -> Cutter {
    let pitch = std::f64::consts::TAU / runouts.len() as f64;
    let teeth = runouts.iter().map(|runout| Tooth { pitch, radius: 5e-3 + runout }).collect();
    Cutter::new(teeth, 0.0, None, Rotation::Clockwise, Coefficients::new(1e9, 0.0, 0.0)).unwrap()
}

/// Small motions that grow at this rate (1/s), as a flip or not.
fn verdict(rate: f64, is_flip: bool) -> Verdict {
    let size = libm::exp(rate * 0.01);
    let multiplier = if is_flip { Complex::new(-size, 0.0) } else { Complex::new(0.0, size) };
    Verdict { multiplier, period: 0.01 }
}

#[test]
fn forces_and_small_motions_are_judged_together() {
    let judged = |runouts: &[f64], variation: f64, rates: [f64; 2], is_flip: bool| {
        let [middle, analysed] = rates.map(|rate| verdict(rate, is_flip));
        let (cutter, variation, verdicts) = (cutter(runouts), Some(variation), [&middle, &analysed]);
        Evidence { end: &End::Complete, cutter: &cutter, variation, verdicts, time: 10.0 }.judgement()
    };
    let (even, uneven) = ([0.0, 0.0], [7e-6, 0.0]);
    let (small, large) = (0.05, 0.6);
    for (runouts, variation, rates, is_flip, expected) in [
        (&even[..], small, [-1.0, -1.0], true, Judgement::Calm),
        (&even, large, [-1.0, -1.0], true, Judgement::Unsettled),
        (&even, large, [9.0, 9.0], true, Judgement::Chatter(Kind::Flip)),
        (&even, large, [9.0, 9.0], false, Judgement::Chatter(Kind::Hopf)),
        (&even, small, [0.1, 0.1], true, Judgement::Growing(Kind::Flip)),
        (&even, small, [-0.1, 0.1], true, Judgement::Marginal),
        (&even, large, [0.1, -0.1], true, Judgement::Marginal),
        // With runout a flip hides from the comparison of turns; a motion with a frequency of its own does not.
        (&uneven, small, [9.0, 9.0], true, Judgement::Chatter(Kind::Flip)),
        (&uneven, small, [0.1, 0.1], true, Judgement::Growing(Kind::Flip)),
        (&uneven, small, [9.0, 9.0], false, Judgement::Growing(Kind::Hopf)),
        // Three teeth: a flip is the other way round after a turn, whatever their radii.
        (&[7e-6, 0.0, 0.0], small, [9.0, 9.0], true, Judgement::Growing(Kind::Flip)),
    ] {
        assert_eq!(judged(runouts, variation, rates, is_flip), expected, "{runouts:?} {variation} {rates:?} {is_flip}");
    }
    let (calm, cutter) = (verdict(-1.0, true), cutter(&even));
    let end = End::Step(crate::integrator::StepError::Singular(1.0));
    let evidence = Evidence { end: &end, cutter: &cutter, variation: None, verdicts: [&calm, &calm], time: 1.0 };
    assert_eq!(evidence.judgement(), Judgement::Ended);
}
