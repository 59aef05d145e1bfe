//! Sets of states: those that a plan may not use though every constraint on them holds, since something hits.

use rayon::prelude::*;
use std::collections::BTreeMap;
use stead_cell::{PairKind, Proximity};
use stead_model::robot::PostureClass;
use stead_problem::evaluate::batch::{KernelNumber, StateGrid};
use stead_problem::problem::{Problem, Redundancy};

/// A set of states: path point, posture class, number of beta.
#[derive(Debug, Clone, Default)]
pub struct StateSet {
    /// For each point with any, a row of bits for each class.
    points: BTreeMap<usize, [Vec<u64>; 4]>,
}

fn set(bits: &mut Vec<u64>, beta: usize) -> bool {
    let (word, bit) = (beta / 64, 1_u64 << (beta % 64));
    if bits.len() <= word {
        bits.resize(word + 1, 0);
    }
    let is_new = bits[word] & bit == 0;
    bits[word] |= bit;
    is_new
}

/// Numbers of the bits that are set.
fn numbers(bits: &[u64]) -> impl Iterator<Item = usize> + '_ {
    bits.iter()
        .enumerate()
        .filter(|(_, word)| **word != 0)
        .flat_map(|(index, word)| (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| index * 64 + bit))
}

impl StateSet {
    /// Forgets all states.
    pub fn clear(&mut self) {
        self.points.clear();
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Adds a state; whether it is new.
    pub fn add(&mut self, point: usize, class: PostureClass, beta: usize) -> bool {
        set(&mut self.points.entry(point).or_default()[class.index()], beta)
    }

    /// Whether a state is among them.
    pub fn contains(&self, point: usize, class: PostureClass, beta: usize) -> bool {
        let bits = self.points.get(&point).map(|classes| &classes[class.index()]);
        bits.and_then(|bits| bits.get(beta / 64)).is_some_and(|word| word >> (beta % 64) & 1 == 1)
    }

    /// Takes the states of a point out of what the evaluator has written.
    pub fn apply<E: KernelNumber>(&self, point: usize, states: &mut StateGrid<E>) {
        let Some(classes) = self.points.get(&point) else { return };
        for class in PostureClass::ALL {
            let bits = &classes[class.index()];
            if states.is_alive(class) && !bits.is_empty() {
                states.forbid(class, numbers(bits));
            }
        }
    }

    /// Makes the scores of forbidden states of one class infinite.
    pub fn apply_to_scores(&self, point: usize, class: usize, scores: &mut [f32]) {
        let Some(classes) = self.points.get(&point) else { return };
        for beta in numbers(&classes[class]) {
            scores[beta] = f32::INFINITY;
        }
    }

    /// The states of a grid of beta in which spindle or holder are too near to part or fixture, wherever these stand;
    /// none where there is no scene. `None` where there are so many states that looking at those of plans is less work.
    pub fn of_tool(problem: &Problem, grid: &Redundancy) -> Option<Self> {
        let points = problem.task.points().len();
        if problem.scene.is_none() {
            return Some(Self::default());
        }
        if points * grid.beta_count > MOST_STATES {
            return None;
        }
        let rows: Vec<Vec<u64>> = (0..points)
            .into_par_iter()
            .map(|point| {
                let (mut bits, mut known) = (Vec::new(), Proximity::default());
                let is_hit = |k: &usize| problem.tool_hits_workpiece(point, grid.beta(*k), &mut known);
                for beta in (0..grid.beta_count).filter(is_hit) {
                    set(&mut bits, beta);
                }
                bits
            })
            .collect();
        let with_any = rows.into_iter().enumerate().filter(|(_, bits)| !bits.is_empty());
        Some(Self { points: with_any.map(|(point, bits)| (point, std::array::from_fn(|_| bits.clone()))).collect() })
    }
}

/// The kinds of pairs that states of a grid are looked at for: not for spindle and holder where those were looked at
/// before.
pub fn kinds_left(tool_hits: Option<&StateSet>) -> &'static [PairKind] {
    if tool_hits.is_some() { &PairKind::OF_JOINTS } else { &PairKind::OF_STATES }
}

/// States of tool and workpiece that are looked at ahead of all plans, at the most.
const MOST_STATES: usize = 100_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_taken_out_by_point_class_and_beta() {
        let class = PostureClass::ALL[2];
        let mut forbidden = StateSet::default();
        assert!(forbidden.add(7, class, 70) && !forbidden.add(7, class, 70) && forbidden.add(7, class, 3));
        assert!(forbidden.contains(7, class, 70) && !forbidden.contains(7, class, 71));
        assert!(!forbidden.contains(6, class, 70) && !forbidden.contains(7, PostureClass::ALL[1], 70));
        let mut states = StateGrid::<f64>::new(80, 4);
        for beta in [3, 70] {
            states.set(class, beta, 1.0, [0.1; 6]);
        }
        states.set(class, 5, 1.0, [0.1; 6]);
        forbidden.apply(6, &mut states);
        assert!(states.inner_scores(class)[70].is_finite());
        forbidden.apply(7, &mut states);
        let scores = states.inner_scores(class);
        assert!(scores[70].is_infinite() && scores[3].is_infinite() && scores[5].is_finite());
        forbidden.add(7, class, 5);
        forbidden.apply(7, &mut states);
        assert!(!states.is_alive(class));
    }
}
