//! All options of a run and their values, and choices of them in which every pair of values occurs.

use std::collections::BTreeSet;

/// An option and its values.
pub struct Factor {
    /// Its name.
    pub name: &'static str,
    /// Its values.
    pub values: &'static [&'static str],
}

const fn factor(name: &'static str, values: &'static [&'static str]) -> Factor {
    Factor { name, values }
}

/// Every option of a run that the judge knows, with the values that are tried.
pub const FACTORS: &[Factor] = &[
    factor(
        "arm",
        &["kuka-kr270-2", "kuka-kr210-r2700", "abb-irb6640-185", "fanuc-m900ib-700", "staubli-tx200", "kuka-kr500"],
    ),
    factor("axes 2 and 3", &["apart", "sum", "linkage"]),
    factor("compliance", &["constant", "stiffness", "range", "compensator"]),
    factor("springs", &["not stated", "axes", "axial part", "left out", "full", "full pairs"]),
    factor("base", &["none", "alike", "unlike"]),
    factor("spindle yields", &["no", "mount", "tip", "both"]),
    factor("part yields", &["no", "table", "columns"]),
    factor("sets", &["one", "mean", "worst", "regret"]),
    factor("confidence", &["none", "2"]),
    factor("speeds", &["file", "none", "accelerations"]),
    factor("mount", &["none", "pedestal", "ceiling", "wall", "tilted"]),
    factor(
        "axes",
        &[
            "none",
            "rail fixed",
            "rail indexed",
            "rail continuous",
            "table fixed",
            "table indexed",
            "table continuous",
            "tilt and turn",
            "part rail continuous",
            "robot table indexed",
            "rail and table",
            "rail and table continuous",
            "held",
        ],
    ),
    factor("spindle", &["straight", "45 deg", "90 deg"]),
    factor("angles", &["rotation", "abc_deg", "wpr_deg", "rpy_deg", "quaternion_wxyz"]),
    factor("cell", &["point", "range"]),
    factor("orientations", &["none", "one", "named", "choice"]),
    factor("path", &["raster", "contour", "tilted", "single"]),
    factor("unscored", &["none", "plunge", "turn in place"]),
    factor("feeds", &["run", "task"]),
    factor("load", &["task", "moments", "forces", "forces by segment", "conventional", "climb", "stock"]),
    factor("scored", &["wall", "axis", "total", "surface", "weights"]),
    factor("aggregate", &["mean", "rms", "max"]),
    factor("force errors", &["0", "0.1"]),
    factor("segment weights", &["none", "one"]),
    factor("turns", &["beta", "per mm", "per s", "all"]),
    factor("beta", &["free", "constant_per_segment", "constant"]),
    factor("travel weight", &["0", "0.05"]),
    factor("postures", &["free", "some", "words", "never", "weighed moves"]),
    factor("tie", &["0", "default", "2"]),
    factor("bounds", &["none", "deflection", "base distance"]),
    factor("margin", &["0", "3"]),
    factor("shapes", &["none", "tool and part", "cell", "mesh", "hull"]),
    factor("tool", &["none", "cutter", "holder"]),
    factor("lean", &["no", "ball", "bull plane"]),
    factor("transfer", &["default", "stated"]),
    factor("search", &["auto", "never", "genetic", "subset", "best alone"]),
    factor("output", &["tables", "page"]),
    factor("program", &["none", "native", "csv"]),
];

/// One value of every option: its number.
pub type Choice = Vec<usize>;

/// Pairs of values that no run can have, and why.
const IMPOSSIBLE: &[([&str; 4], &str)] = &[
    (["speeds", "none", "postures", "weighed moves"], "refused: moves are weighed by their time"),
    (["postures", "weighed moves", "aggregate", "rms"], "refused: moves are weighed beside a mean"),
    (["postures", "weighed moves", "aggregate", "max"], "refused: moves are weighed beside a mean"),
    (["travel weight", "0.05", "aggregate", "rms"], "refused: joint travel is weighed beside a mean"),
    (["travel weight", "0.05", "aggregate", "max"], "refused: joint travel is weighed beside a mean"),
    (["load", "conventional", "tool", "none"], "the cutter gives the force"),
    (["load", "climb", "tool", "none"], "the cutter gives the force"),
    (["load", "stock", "tool", "none"], "the cutter gives the force"),
    (["lean", "ball", "tool", "none"], "how a tool leans depends on its end"),
    (["lean", "bull plane", "tool", "none"], "how a tool leans depends on its end"),
    (["lean", "ball", "load", "stock"], "refused: the cutter is tapered"),
    (["lean", "bull plane", "load", "stock"], "refused: the cutter is tapered"),
    (["part yields", "columns", "load", "stock"], "refused: the stock adds points of which the columns say nothing"),
    (["search", "genetic", "postures", "never"], "refused: it searches for a posture of each segment"),
    (["arm", "staubli-tx200", "axes 2 and 3", "sum"], "refused: its joint 3 turns by a whole turn"),
    (["arm", "staubli-tx200", "axes 2 and 3", "linkage"], "refused: its joint 3 turns by a whole turn"),
    (["arm", "staubli-tx200", "program", "native"], "no programs are written for this controller"),
];

/// Whether a run cannot have both values.
pub fn is_impossible(a: (usize, usize), b: (usize, usize)) -> bool {
    let words = |(factor, value): (usize, usize)| (FACTORS[factor].name, FACTORS[factor].values[value]);
    let [a, b] = [words(a), words(b)];
    IMPOSSIBLE.iter().any(|([f, v, g, w], _)| (a == (*f, *v) && b == (*g, *w)) || (b == (*f, *v) && a == (*g, *w)))
}

/// Random numbers that are the same on every machine (splitmix64).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x1234_5678))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 to below 1.
    pub fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Below a count.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
}

fn is_allowed(choice: &Choice) -> bool {
    (0..choice.len()).all(|a| (0..a).all(|b| !is_impossible((a, choice[a]), (b, choice[b]))))
}

/// All pairs of values that a run can have.
pub fn pairs() -> BTreeSet<[(usize, usize); 2]> {
    let mut all = BTreeSet::new();
    for a in 0..FACTORS.len() {
        for b in a + 1..FACTORS.len() {
            for v in 0..FACTORS[a].values.len() {
                for w in 0..FACTORS[b].values.len() {
                    if !is_impossible((a, v), (b, w)) {
                        all.insert([(a, v), (b, w)]);
                    }
                }
            }
        }
    }
    all
}

/// The pairs of values that occur in choices.
pub fn pairs_of(choices: &[Choice]) -> BTreeSet<[(usize, usize); 2]> {
    let all = pairs();
    choices.iter().flat_map(|choice| gained(choice, &all).collect::<Vec<_>>()).collect()
}

/// Choices in which every possible pair of values occurs: of some tries that begin with a pair which is missing, each
/// time the one that brings most.
pub fn cover(seed: u64) -> Vec<Choice> {
    let mut random = Random::new(seed);
    let mut missing = pairs();
    let mut choices = Vec::new();
    while let Some(first) = missing.iter().nth(random.below(missing.len().max(1))).copied() {
        let mut best: Option<(usize, Choice)> = None;
        for _ in 0..40 {
            let Some(choice) = extended(first, &missing, &mut random) else { continue };
            let gain = gained(&choice, &missing).count();
            if best.as_ref().is_none_or(|(known, _)| gain > *known) {
                best = Some((gain, choice));
            }
        }
        let Some((_, choice)) = best else {
            missing.remove(&first);
            continue;
        };
        let found: Vec<_> = gained(&choice, &missing).collect();
        found.iter().for_each(|pair| {
            missing.remove(pair);
        });
        choices.push(choice);
    }
    choices
}

fn gained<'a>(
    choice: &'a Choice,
    missing: &'a BTreeSet<[(usize, usize); 2]>,
) -> impl Iterator<Item = [(usize, usize); 2]> + 'a {
    let all = (0..choice.len()).flat_map(move |a| (a + 1..choice.len()).map(move |b| [(a, choice[a]), (b, choice[b])]));
    all.filter(|pair| missing.contains(pair))
}

/// A choice with these two values, the others one by one in random order, each with the value that brings most.
fn extended(
    first: [(usize, usize); 2],
    missing: &BTreeSet<[(usize, usize); 2]>,
    random: &mut Random,
) -> Option<Choice> {
    let mut values: Vec<Option<usize>> = vec![None; FACTORS.len()];
    first.iter().for_each(|(factor, value)| values[*factor] = Some(*value));
    let mut order: Vec<usize> = (0..FACTORS.len()).filter(|factor| values[*factor].is_none()).collect();
    for k in (1..order.len()).rev() {
        order.swap(k, random.below(k + 1));
    }
    for factor in order {
        let count = FACTORS[factor].values.len();
        let start = random.below(count);
        let mut best: Option<(usize, usize)> = None;
        for k in 0..count {
            let value = (start + k) % count;
            let others = || values.iter().enumerate().filter_map(|(other, known)| Some((other, (*known)?)));
            if others().any(|other| is_impossible((factor, value), other)) {
                continue;
            }
            let is_new = |other: &(usize, usize)| {
                let pair = if other.0 < factor { [*other, (factor, value)] } else { [(factor, value), *other] };
                missing.contains(&pair)
            };
            // A search takes most of the time of a run: it is drawn where it brings much.
            let is_search = FACTORS[factor].values[value] == "range" || FACTORS[factor].values[value] == "choice";
            let gain = others().filter(is_new).count() * if is_search { 1 } else { 3 };
            if best.is_none_or(|(known, _)| gain > known) {
                best = Some((gain, value));
            }
        }
        values[factor] = Some(best?.1);
    }
    let choice: Choice = values.into_iter().collect::<Option<_>>()?;
    is_allowed(&choice).then_some(choice)
}

/// The value that a choice has for an option.
pub fn value_of(choice: &Choice, name: &str) -> &'static str {
    let found = FACTORS.iter().zip(choice).find(|(factor, _)| factor.name == name);
    found.map_or("", |(factor, value)| factor.values[*value])
}

/// A choice in words.
pub fn words(choice: &Choice) -> String {
    let each: Vec<String> = FACTORS
        .iter()
        .zip(choice)
        .map(|(factor, value)| format!("{}={}", factor.name, factor.values[*value]))
        .collect();
    each.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_possible_pair_of_values_occurs() {
        let choices = cover(1);
        let mut missing = pairs();
        for choice in &choices {
            assert!(is_allowed(choice), "{}", words(choice));
            gained(choice, &missing.clone()).for_each(|pair| {
                missing.remove(&pair);
            });
        }
        assert!(
            missing.is_empty(),
            "{} pairs are missing of {}, first {:?}",
            missing.len(),
            pairs().len(),
            missing.first()
        );
        assert_eq!(choices, cover(1));
        println!("{} runs cover {} pairs", choices.len(), pairs().len());
    }

    #[test]
    fn what_is_impossible_names_options_that_there_are() {
        for ([f, v, g, w], reason) in IMPOSSIBLE {
            for (name, value) in [(f, v), (g, w)] {
                let is_there = FACTORS.iter().any(|factor| factor.name == *name && factor.values.contains(value));
                assert!(is_there, "{name}={value}: {reason}");
            }
        }
    }
}
