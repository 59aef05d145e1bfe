//! Compass search: ever smaller steps about the best that is known.
//!
//! Two searches of this kind are apart. `coordinate_search` of the placement crate has a step of its own for each
//! direction, which grows with success, and takes the first improvement; the poll of the refinement is a single round
//! between gradient steps.

use stead_numerics::monitor::Monitor;

/// The steps of a compass search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompassSteps {
    /// The first.
    pub first: f64,
    /// With a step of this or less it ends.
    pub last: f64,
    /// What a step that leads to nothing better is divided by.
    pub shrink: f64,
    /// Rounds at the most.
    pub rounds: usize,
}

impl CompassSteps {
    /// Goes on to what `better` finds from the best so far by a step, as long as it finds something; else the step
    /// shrinks. A stop ends it.
    pub fn search<T>(&self, start: T, monitor: &Monitor, mut better: impl FnMut(&T, f64) -> Option<T>) -> T {
        let (mut best, mut step) = (start, self.first);
        for _ in 0..self.rounds {
            if step <= self.last || monitor.should_stop() {
                break;
            }
            match better(&best, step) {
                Some(found) => best = found,
                None => step /= self.shrink,
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_ends_within_a_step_of_the_bottom_and_within_its_rounds() {
        let steps = CompassSteps { first: 0.5, last: 1e-4, shrink: 2.0, rounds: 1000 };
        let cost = |x: f64| (x - 0.3123).abs();
        let better = |x: &f64, step: f64| [x - step, x + step].into_iter().find(|there| cost(*there) < cost(*x));
        let found = steps.search(7.0, &Monitor::silent(), better);
        assert!(cost(found) <= 2e-4, "{found}");
        let mut rounds = 0;
        let few = CompassSteps { rounds: 5, ..steps };
        few.search(7.0, &Monitor::silent(), |x, step| {
            rounds += 1;
            better(x, step)
        });
        assert_eq!(rounds, 5);
    }
}
