//! The main effect of each axis on a column, and how much of its variance that explains.
//!
//! Where every pair of values comes equally often (a grid of which nothing failed), an effect is what means over the
//! other axes say. Where cases are missing, or the study is a Latin hypercube, such means would mix the axes; then all
//! effects are fitted together by least squares, and the share of an axis is what the model loses without it.

use super::layouts::Layouts;
use super::least_squares::LinearModel;
use super::measure::Measure;
use crate::cases::TableCell;
use stead_problem::sense::Sense;

/// How an effect was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Means over the other axes, of which each value comes equally often.
    Means,
    /// Means as they would be then: all axes fitted together by least squares.
    AdjustedMeans,
    /// A straight line over the numbers of the axis, fitted together with all others by least squares.
    Line,
    /// Means that have the effects of other axes in them, which cannot be distinguished.
    MixedMeans,
}

impl Method {
    /// The word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Means => "means",
            Self::AdjustedMeans => "adjusted means",
            Self::Line => "line",
            Self::MixedMeans => "mixed means",
        }
    }
}

/// What stands for a value of an axis; for a line for its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// The value, as in `study.csv`.
    pub label: String,
    /// The value, where it is a number.
    pub number: Option<f64>,
    /// How many layouts have it and a value of the column.
    pub count: usize,
    /// The mean, or the height of the line.
    pub value: f64,
}

/// What an axis does.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisEffect {
    /// Its column.
    pub axis: usize,
    /// Its name.
    pub name: String,
    /// How it was computed.
    pub method: Method,
    /// Its values: numbers ascending, texts in the order of the study.
    pub levels: Vec<Level>,
    /// Largest less smallest of the values of the levels.
    pub range: f64,
    /// The share of the variance that it explains; none where the values are all the same.
    pub share: Option<f64>,
    /// Spearman's rank correlation of an axis of numbers with the column.
    pub rank_correlation: Option<f64>,
    /// Of an axis of numbers, by how much the column changes for each unit of it: the straight line through the values
    /// of the levels, each with the weight of its layouts. None where the effects of other axes are in them.
    pub slope: Option<f64>,
}

impl AxisEffect {
    /// The level with the best value.
    pub fn best(&self, sense: Sense) -> Option<&Level> {
        self.levels.iter().min_by(|a, b| sense.compare(a.value, b.value))
    }
}

/// What all axes do to a column.
#[derive(Debug, Clone, PartialEq)]
pub struct Effects {
    /// The column.
    pub measure: Measure,
    /// The axes of more than one value, the largest share first.
    pub axes: Vec<AxisEffect>,
    /// How many layouts have a value.
    pub count: usize,
    /// The mean of all.
    pub mean: f64,
    /// The share of the variance that effects of the axes one by one leave to what they do together.
    pub remainder: Option<f64>,
}

/// More columns than this are not fitted together.
const MAX_COLUMNS: usize = 200;
/// Beside other axes one of numbers is a line where it has more values than this, or fewer than three layouts to two
/// values.
const MAX_NUMBERS: usize = 12;

/// An axis in the layouts with a value.
struct Factor {
    axis: usize,
    labels: Vec<String>,
    numbers: Option<Vec<f64>>,
    /// The level of each layout.
    levels: Vec<usize>,
    is_line: bool,
}

/// The main effects of all axes on a column.
pub fn effects(layouts: &Layouts, measure: &Measure) -> Effects {
    let (rows, values): (Vec<usize>, Vec<f64>) = layouts.valued(measure).unzip();
    let varied = layouts.varied().into_iter().filter(|axis| *axis != measure.column);
    let mut factors: Vec<Factor> =
        varied.map(|axis| Factor::of(layouts, axis, &rows)).filter(|factor| factor.labels.len() > 1).collect();
    if let [alone] = &mut factors[..] {
        alone.is_line = false;
    }
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let deviations: Vec<f64> = values.iter().map(|value| value - mean).collect();
    let total: f64 = deviations.iter().map(|d| d * d).sum();
    let largest = values.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
    // What is left of equal values is rounding.
    let total = if total > 1e-24 * largest * largest * values.len() as f64 { total } else { 0.0 };
    let fit = Fit { factors: &factors, deviations: &deviations, mean, total };
    let (mut axes, remainder) = if fit.is_balanced() { fit.by_means() } else { fit.together() };
    for (effect, factor) in axes.iter_mut().zip(&factors) {
        effect.name.clone_from(&layouts.columns[factor.axis].name);
        effect.rank_correlation = factor.place().and_then(|place| rank_correlation(&place, &values));
        effect.slope = slope(effect);
    }
    axes.sort_by(|a, b| b.share.unwrap_or(0.0).total_cmp(&a.share.unwrap_or(0.0)));
    Effects { measure: measure.clone(), axes, count: values.len(), mean, remainder }
}

impl Effects {
    /// The two axes with the largest shares.
    pub(super) fn largest_two(&self) -> Option<[usize; 2]> {
        match &self.axes[..] {
            [first, second, ..] => Some([first.axis, second.axis]),
            _ => None,
        }
    }
}

impl Factor {
    fn of(layouts: &Layouts, axis: usize, rows: &[usize]) -> Self {
        let cells: Vec<&TableCell> = rows.iter().map(|row| &layouts.all[*row].row[axis]).collect();
        let numbers: Option<Vec<f64>> = cells.iter().map(|cell| cell.as_number()).collect();
        let mut distinct: Vec<&TableCell> = Vec::new();
        for cell in &cells {
            if !distinct.contains(cell) {
                distinct.push(cell);
            }
        }
        if numbers.is_some() {
            let number = |cell: &TableCell| cell.as_number().unwrap_or(0.0);
            distinct.sort_by(|a, b| number(a).total_cmp(&number(b)));
        }
        let count = distinct.len();
        let is_line = numbers.is_some() && (count > MAX_NUMBERS || 3 * count > 2 * cells.len()) && count > 2;
        let level = |cell: &&TableCell| distinct.iter().position(|other| other == cell).unwrap_or(0);
        let levels = cells.iter().map(level).collect();
        Self { axis, labels: distinct.iter().map(|cell| cell.written()).collect(), numbers, levels, is_line }
    }

    fn counts(&self) -> Vec<usize> {
        let mut counts = vec![0; self.labels.len()];
        self.levels.iter().for_each(|level| counts[*level] += 1);
        counts
    }

    /// Its columns in a linear model: the number, or one less than it has levels.
    fn columns(&self) -> Vec<Vec<f64>> {
        match self.place() {
            Some(place) if self.is_line => vec![place],
            _ => (1..self.labels.len())
                .map(|level| self.levels.iter().map(|of| if *of == level { 1.0 } else { 0.0 }).collect())
                .collect(),
        }
    }

    /// The numbers on a scale from 0 to 1.
    fn place(&self) -> Option<Vec<f64>> {
        let numbers = self.numbers.as_ref()?;
        let (min, max) = numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), n| (a.min(*n), b.max(*n)));
        Some(numbers.iter().map(|number| (number - min) / (max - min)).collect())
    }

    /// The effect with these values of the levels.
    fn effect(&self, method: Method, values: &[f64], share: Option<f64>) -> AxisEffect {
        let number = |label: &String| self.numbers.as_ref().and_then(|_| label.parse().ok());
        let level = |((label, count), value): ((&String, usize), &f64)| Level {
            label: label.clone(),
            number: number(label),
            count,
            value: *value,
        };
        let mut levels: Vec<Level> = self.labels.iter().zip(self.counts()).zip(values).map(level).collect();
        if method == Method::Line {
            let last = levels.len() - 1;
            let mut index = 0;
            levels.retain(|_| {
                index += 1;
                index == 1 || index == last + 1
            });
        }
        let range = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick).unwrap_or(0.0);
        AxisEffect {
            axis: self.axis,
            name: String::new(),
            method,
            levels,
            range: range(f64::max) - range(f64::min),
            share,
            rank_correlation: None,
            slope: None,
        }
    }

    /// The mean of each level.
    fn means(&self, deviations: &[f64], mean: f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.labels.len()];
        self.levels.iter().zip(deviations).for_each(|(level, deviation)| sums[*level] += deviation);
        sums.iter().zip(self.counts()).map(|(sum, count)| mean + sum / count.max(1) as f64).collect()
    }

    /// The share of the variance that lies between its levels.
    fn share_of_means(&self, means: &[f64], mean: f64, total: f64) -> Option<f64> {
        let squares = means.iter().zip(self.counts()).map(|(m, n)| n as f64 * (m - mean) * (m - mean));
        share(squares.sum(), total)
    }
}

fn share(part: f64, total: f64) -> Option<f64> {
    (total > 0.0).then(|| (part / total).clamp(0.0, 1.0))
}

/// What is fitted.
struct Fit<'f> {
    factors: &'f [Factor],
    deviations: &'f [f64],
    mean: f64,
    total: f64,
}

impl Fit<'_> {
    /// Whether values of any two axes come together as often as they would by themselves, so that means do not mix the
    /// axes.
    fn is_balanced(&self) -> bool {
        let rows = self.deviations.len();
        let of_two = |a: &Factor, b: &Factor| {
            let width = b.labels.len();
            let mut counts = vec![0; a.labels.len() * width];
            a.levels.iter().zip(&b.levels).for_each(|(a, b)| counts[a * width + b] += 1);
            let (of_a, of_b) = (a.counts(), b.counts());
            counts.iter().enumerate().all(|(k, count)| count * rows == of_a[k / width] * of_b[k % width])
        };
        let pairs = self.factors.iter().enumerate().flat_map(|(k, b)| self.factors[..k].iter().map(move |a| (a, b)));
        !self.factors.iter().any(|factor| factor.is_line) && pairs.into_iter().all(|(a, b)| of_two(a, b))
    }

    fn by_means(&self) -> (Vec<AxisEffect>, Option<f64>) {
        let effect = |factor: &Factor| {
            let means = factor.means(self.deviations, self.mean);
            let share = factor.share_of_means(&means, self.mean, self.total);
            factor.effect(Method::Means, &means, share)
        };
        let axes: Vec<AxisEffect> = self.factors.iter().map(effect).collect();
        let explained: Option<f64> = axes.iter().map(|axis| axis.share).sum();
        (axes, explained.filter(|_| self.total > 0.0).map(|explained| (1.0 - explained).max(0.0)))
    }

    /// All axes by one linear model.
    fn together(&self) -> (Vec<AxisEffect>, Option<f64>) {
        let columns: Vec<Vec<Vec<f64>>> = self.factors.iter().map(Factor::columns).collect();
        if columns.iter().map(Vec::len).sum::<usize>() > MAX_COLUMNS {
            return (self.factors.iter().map(|factor| self.mixed(factor)).collect(), None);
        }
        let ones = || vec![vec![1.0; self.deviations.len()]];
        let effect = |(number, factor): (usize, &Factor)| {
            let others: Vec<Vec<f64>> =
                (0..).zip(&columns).filter(|(k, _)| *k != number).flat_map(|(_, c)| c.clone()).collect();
            let without = LinearModel::new(&[ones(), others.clone()].concat());
            let whole = LinearModel::new(&[ones(), others, columns[number].clone()].concat());
            if whole.rank() < without.rank() + columns[number].len() {
                return self.mixed(factor);
            }
            let lost = without.residual(self.deviations) - whole.residual(self.deviations);
            let coefficients = whole.coefficients(self.deviations);
            let own = &coefficients[coefficients.len() - columns[number].len()..];
            let (method, heights) = factor.heights(own);
            let at_mean = factor.levels.iter().map(|level| heights[*level]).sum::<f64>() / factor.levels.len() as f64;
            let values: Vec<f64> = heights.iter().map(|height| self.mean + height - at_mean).collect();
            factor.effect(method, &values, share(lost, self.total))
        };
        let axes = self.factors.iter().enumerate().map(effect).collect();
        let whole = LinearModel::new(&[ones(), columns.concat()].concat());
        (axes, share(whole.residual(self.deviations), self.total))
    }

    /// Means of an axis that goes with others.
    fn mixed(&self, factor: &Factor) -> AxisEffect {
        let means = factor.means(self.deviations, self.mean);
        let share = factor.share_of_means(&means, self.mean, self.total);
        factor.effect(Method::MixedMeans, &means, share)
    }
}

impl Factor {
    /// What the coefficients of its columns give each level.
    fn heights(&self, coefficients: &[f64]) -> (Method, Vec<f64>) {
        if !self.is_line {
            return (Method::AdjustedMeans, std::iter::once(0.0).chain(coefficients.iter().copied()).collect());
        }
        let mut heights = vec![0.0; self.labels.len()];
        if let Some(place) = self.place() {
            self.levels.iter().zip(place).for_each(|(level, place)| heights[*level] = coefficients[0] * place);
        }
        (Method::Line, heights)
    }
}

/// See [`AxisEffect::slope`].
fn slope(effect: &AxisEffect) -> Option<f64> {
    if effect.method == Method::MixedMeans {
        return None;
    }
    let levels: Option<Vec<[f64; 3]>> =
        effect.levels.iter().map(|level| Some([level.count as f64, level.number?, level.value])).collect();
    let levels = levels?;
    let count: f64 = levels.iter().map(|[count, ..]| count).sum();
    let mean = |of: usize| levels.iter().map(|level| level[0] * level[of]).sum::<f64>() / count;
    let (at, height) = (mean(1), mean(2));
    let product =
        |of: usize, mean: f64| levels.iter().map(|level| level[0] * (level[1] - at) * (level[of] - mean)).sum::<f64>();
    let scale = product(1, at);
    (scale > 0.0).then(|| product(2, height) / scale)
}

/// Spearman's rank correlation: that of the ranks, ties at the mean of theirs. None where one side does not vary.
fn rank_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let (a, b) = (mean_ranks(a), mean_ranks(b));
    let middle = (a.len() as f64 - 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>();
    let scale = libm::sqrt(product(&a, &a) * product(&b, &b));
    (scale > 0.0).then(|| product(&a, &b) / scale)
}

fn mean_ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut place = 0;
    for ties in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let rank = place as f64 + (ties.len() as f64 - 1.0) / 2.0;
        ties.iter().for_each(|index| ranks[*index] = rank);
        place += ties.len();
    }
    ranks
}

#[cfg(test)]
mod tests;
