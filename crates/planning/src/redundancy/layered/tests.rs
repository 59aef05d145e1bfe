//! The cheapest path against all paths, in blocks of every length.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Numbers in layers, with steps of at most `reach`.
struct Numbers {
    layers: Vec<Vec<(i32, f64)>>,
    reach: i32,
    largest: bool,
}

impl Steps for Numbers {
    type State = (i32, f64);

    fn states(&mut self, place: usize) -> Vec<Self::State> {
        self.layers[place].clone()
    }

    fn prepare(&mut self, _: usize, _: &[Self::State]) {}

    fn may_lead_to(&self, before: &[Self::State], state: &Self::State, mut visit: impl FnMut(usize)) {
        let [first, last] = [state.0 - self.reach, state.0 + self.reach + 1]
            .map(|end| before.partition_point(|(number, _)| *number < end));
        (first..last).for_each(&mut visit);
    }

    fn step(&self, from: &Self::State, to: &Self::State) -> Option<f64> {
        let apart = (to.0 - from.0).abs();
        (apart <= self.reach).then_some(0.01 * f64::from(apart))
    }

    fn own(&self, _: usize, state: &Self::State) -> f64 {
        state.1
    }

    fn join(&self, way: f64, own: f64) -> f64 {
        if self.largest { way.max(own) } else { way + own }
    }
}

/// All paths one after the other: the least cost.
fn by_all_paths(numbers: &Numbers) -> Option<f64> {
    let mut ways: Vec<((i32, f64), f64)> = numbers.layers[0].iter().map(|state| (*state, state.1)).collect();
    for layer in &numbers.layers[1..] {
        let on = |(from, cost): &((i32, f64), f64)| {
            let (from, cost) = (*from, *cost);
            layer.iter().filter_map(move |to| Some((*to, numbers.join(cost + numbers.step(&from, to)?, to.1))))
        };
        ways = ways.iter().flat_map(on).collect();
    }
    ways.into_iter().map(|(_, cost)| cost).min_by(f64::total_cmp)
}

#[test]
fn the_cheapest_path_is_the_cheapest_of_all_in_blocks_of_any_length() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut found = 0;
    for _ in 0..200 {
        let count = random.random_range(1..7);
        let layer = |random: &mut ChaCha8Rng| {
            let mut numbers: Vec<i32> = (0..random.random_range(0..6)).map(|_| random.random_range(0..9)).collect();
            numbers.sort_unstable();
            numbers.dedup();
            numbers.into_iter().map(|number| (number, random.random_range(0.0..1.0))).collect()
        };
        let layers = (0..count).map(|_| layer(&mut random)).collect();
        let mut numbers = Numbers { layers, reach: random.random_range(1..5), largest: random.random_bool(0.3) };
        let least = by_all_paths(&numbers);
        for block in 1..=count {
            let path = cheapest_path_in_blocks(&mut numbers, count, block);
            assert_eq!(path.as_ref().map(|(cost, _)| *cost), least, "{count} in blocks of {block}");
            let Some((cost, path)) = path else { continue };
            found += 1;
            let mut sum = path[0].1;
            for pair in path.windows(2) {
                sum = numbers.join(sum + numbers.step(&pair[0], &pair[1]).unwrap(), pair[1].1);
            }
            assert_eq!((sum, path.len()), (cost, count));
        }
    }
    assert!(found > 100, "{found}");
}
