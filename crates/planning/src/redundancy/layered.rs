//! Dynamic programming along a path: of layers of states, one for each point or knot, the cheapest way from the first
//! to the last.
//!
//! What may vary along the path is the state: beta, the turns of the joints, the position of an external axis. Who
//! plans it says what states a point has, which of them lead to which, and what states and steps cost ([`Steps`]);
//! [`cheapest_path`] does the rest. Of long paths only the links of one block of layers are remembered, and the first
//! layers of the others, from which theirs are found again: memory grows with the square root of their number.
//!
//! [`Stages`] is the same for layers that are kept and connected in a way of their own (`turns_dp`). Apart from both
//! are: [`super::transition`] with `forward_pass`, the vector kernel for beta alone, which carries four posture classes
//! in rows that are allocated once; the choice of postures over segments (`joint_turns`), whose sums are ordered by two
//! figures; and the tables of search and certificate, which need costs of a sliding window and no path.
//! [`super::reference_dp`] is a separate, plain twin on purpose.

/// Layers that follow from one another.
pub(super) trait Stages {
    /// The states of a stage with the cost of the cheapest way to each.
    type Layer: Clone;
    /// What is remembered of a layer: for each state the one before it on that way.
    type Links: Clone;

    /// The layer of stage 0; none where it has no state.
    fn first(&mut self) -> Option<Self::Layer>;

    /// Makes the layer of a stage out of the one before; none where no state is reached.
    fn advance(&mut self, layer: &mut Self::Layer, stage: usize) -> Option<()>;

    /// Costs over the states of a layer, infinite where they are not reached.
    fn costs(layer: &Self::Layer) -> &[f64];

    /// What is remembered of a layer.
    fn links(layer: &Self::Layer) -> &Self::Links;

    /// The state of the stage before on the way to a state.
    fn before(links: &Self::Links, state: usize) -> usize;
}

/// The cost of the cheapest way through so many stages, of which `visit` is told stage by stage from the last to the
/// first, by the links of the stage and the index of its state. The links of `block` stages are kept at a time. Of
/// equal ends the first is taken.
pub(super) fn cheapest<S: Stages>(
    stages: &mut S,
    count: usize,
    block: usize,
    mut visit: impl FnMut(usize, &S::Links, usize),
) -> Option<f64> {
    let mut firsts = vec![stages.first()?];
    let mut kept = Vec::new();
    let mut costs = Vec::new();
    for start in (0..count).step_by(block) {
        let mut layer = firsts.last()?.clone();
        kept = links(stages, &mut layer, start..count.min(start + block))?;
        if start + block < count {
            stages.advance(&mut layer, start + block)?;
            firsts.push(layer);
        } else {
            costs.extend_from_slice(S::costs(&layer));
        }
    }
    let mut state = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b]))?;
    let cost = Some(costs[state]).filter(|cost| cost.is_finite())?;
    for (number, first) in firsts.iter().enumerate().rev() {
        let start = number * block;
        if number + 1 < firsts.len() {
            kept = links(stages, &mut first.clone(), start..start + block)?;
        }
        for (place, links) in kept.iter().enumerate().rev() {
            visit(start + place, links, state);
            state = S::before(links, state);
        }
    }
    Some(cost)
}

/// The links of some stages, of which the layer of the first is given and becomes that of the last.
fn links<S: Stages>(stages: &mut S, layer: &mut S::Layer, block: std::ops::Range<usize>) -> Option<Vec<S::Links>> {
    let mut kept = vec![S::links(layer).clone()];
    for stage in block.skip(1) {
        stages.advance(layer, stage)?;
        kept.push(S::links(layer).clone());
    }
    Some(kept)
}

/// What may vary along a path: the states of its points, the steps between them, and what both cost. Costs are signed:
/// the smaller the better, steps not negative.
pub(super) trait Steps {
    /// A state of a point.
    type State: Clone;

    /// The allowed states of the point at a place.
    fn states(&mut self, place: usize) -> Vec<Self::State>;

    /// Makes ready for steps to the point at a place from these states of the one before.
    fn prepare(&mut self, place: usize, before: &[Self::State]);

    /// Calls `visit` with the states before, by their index, from which a step to a state may be allowed; from the
    /// others none is. Of equally cheap ones the first is taken.
    fn may_lead_to(&self, before: &[Self::State], state: &Self::State, visit: impl FnMut(usize));

    /// What a step from one of these costs beside its ends; none where it is not allowed.
    fn step(&self, from: &Self::State, to: &Self::State) -> Option<f64>;

    /// What a state costs by itself at a place.
    fn own(&self, place: usize, state: &Self::State) -> f64;

    /// The cost of a way to a state with what the state costs.
    fn join(&self, way: f64, own: f64) -> f64;
}

/// The cost of the cheapest way to a state without its own, and the state before on it.
#[inline]
pub(super) fn cheapest_before<S: Steps>(
    steps: &S,
    before: &[S::State],
    costs: &[f64],
    state: &S::State,
) -> Option<(f64, usize)> {
    let (mut best, mut from) = (f64::INFINITY, 0);
    steps.may_lead_to(before, state, |index| {
        if costs[index] < best
            && let Some(step) = steps.step(&before[index], state)
            && costs[index] + step < best
        {
            (best, from) = (costs[index] + step, index);
        }
    });
    best.is_finite().then_some((best, from))
}

/// The cheapest way through so many points, and its signed cost; `states` of a point are about as many as said.
pub(super) fn cheapest_path<S: Steps>(steps: &mut S, count: usize, states: usize) -> Option<(f64, Vec<S::State>)> {
    let block = (MAX_STATES / states.max(1)).max(count.isqrt()).max(1);
    cheapest_path_in_blocks(steps, count, block)
}

/// States that are kept at the most, where blocks of the square root of the number of points do not need more.
const MAX_STATES: usize = 1 << 22;

fn cheapest_path_in_blocks<S: Steps>(steps: &mut S, count: usize, block: usize) -> Option<(f64, Vec<S::State>)> {
    let mut path = Vec::with_capacity(count);
    let cost = cheapest(&mut Along(steps), count, block, |_, links, state| path.push(links.states[state].clone()))?;
    path.reverse();
    Some((cost, path))
}

/// Points with their states as stages.
struct Along<'s, S>(&'s mut S);

/// The states of a point that are reached.
#[derive(Clone)]
struct Layer<T> {
    costs: Vec<f64>,
    links: Links<T>,
}

#[derive(Clone)]
struct Links<T> {
    states: Vec<T>,
    before: Vec<usize>,
}

impl<S: Steps> Stages for Along<'_, S> {
    type Layer = Layer<S::State>;
    type Links = Links<S::State>;

    fn first(&mut self) -> Option<Self::Layer> {
        let states = self.0.states(0);
        let costs: Vec<f64> = states.iter().map(|state| self.0.own(0, state)).collect();
        let before = vec![0; states.len()];
        (!states.is_empty()).then_some(Layer { costs, links: Links { states, before } })
    }

    fn advance(&mut self, layer: &mut Self::Layer, place: usize) -> Option<()> {
        let all = self.0.states(place);
        self.0.prepare(place, &layer.links.states);
        let (mut costs, mut states, mut before) = (Vec::new(), Vec::new(), Vec::new());
        for state in all {
            if let Some((way, from)) = cheapest_before(self.0, &layer.links.states, &layer.costs, &state) {
                costs.push(self.0.join(way, self.0.own(place, &state)));
                states.push(state);
                before.push(from);
            }
        }
        *layer = Layer { costs, links: Links { states, before } };
        (!layer.costs.is_empty()).then_some(())
    }

    fn costs(layer: &Self::Layer) -> &[f64] {
        &layer.costs
    }

    fn links(layer: &Self::Layer) -> &Self::Links {
        &layer.links
    }

    fn before(links: &Self::Links, state: usize) -> usize {
        links.before[state]
    }
}

#[cfg(test)]
mod tests;
