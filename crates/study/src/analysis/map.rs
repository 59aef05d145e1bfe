//! A column over two axes.

use super::layouts::Layouts;
use super::measure::Measure;
use crate::cases::TableCell;

/// A column over two axes: means over all others.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// The column.
    pub measure: Measure,
    /// The names of the axes: across and upwards.
    pub names: [String; 2],
    /// Their values, or for an axis of many numbers equal parts of its range.
    pub labels: [Vec<String>; 2],
    /// The mean of each pair, row by row from the bottom; none where no layout has a value.
    pub cells: Vec<Option<f64>>,
    /// How many layouts of each pair have a value.
    pub counts: Vec<usize>,
}

/// An axis of more numbers than this is cut into equal parts.
pub const MAX_LEVELS: usize = 24;
const PARTS: usize = 8;

/// An axis of the map.
struct Side {
    labels: Vec<String>,
    /// Where each layout is.
    places: Vec<usize>,
}

/// A column over two axes, given by their columns; nothing where no layout has a value.
pub fn map(layouts: &Layouts, measure: &Measure, axes: [usize; 2]) -> Option<Map> {
    let sides = axes.map(|axis| Side::of(layouts, axis));
    let width = sides[0].labels.len();
    let mut sums = vec![0.0; width * sides[1].labels.len()];
    let mut counts = vec![0; sums.len()];
    for (layout, value) in layouts.valued(measure) {
        let cell = sides[1].places[layout] * width + sides[0].places[layout];
        sums[cell] += value;
        counts[cell] += 1;
    }
    let mean = |(sum, count): (&f64, &usize)| (*count > 0).then(|| sum / *count as f64);
    let cells: Vec<Option<f64>> = sums.iter().zip(&counts).map(mean).collect();
    let names = axes.map(|axis| layouts.columns[axis].name.clone());
    let labels = sides.map(|side| side.labels);
    cells.iter().any(Option::is_some).then(|| Map { measure: measure.clone(), names, labels, cells, counts })
}

impl Side {
    fn of(layouts: &Layouts, axis: usize) -> Self {
        let cells: Vec<&TableCell> = layouts.all.iter().map(|layout| &layout.row[axis]).collect();
        let numbers: Option<Vec<f64>> = cells.iter().map(|cell| cell.as_number()).collect();
        let mut labels: Vec<String> = Vec::new();
        for label in cells.iter().map(|cell| cell.written()) {
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        let Some(numbers) = numbers else { return Self::by_label(labels, &cells) };
        if labels.len() > MAX_LEVELS {
            return Self::in_parts(&numbers);
        }
        let number = |label: &String| label.parse().unwrap_or(0.0);
        labels.sort_by(|a, b| f64::total_cmp(&number(a), &number(b)));
        Self::by_label(labels, &cells)
    }

    fn by_label(labels: Vec<String>, cells: &[&TableCell]) -> Self {
        let place = |cell: &&TableCell| labels.iter().position(|label| *label == cell.written()).unwrap_or(0);
        let places = cells.iter().map(place).collect();
        Self { labels, places }
    }

    fn in_parts(numbers: &[f64]) -> Self {
        let (min, max) = numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), n| (a.min(*n), b.max(*n)));
        let width = (max - min) / PARTS as f64;
        let place = |number: &f64| (((number - min) / width) as usize).min(PARTS - 1);
        let edge = |part: usize| stead_numerics::digits::figures(min + width * part as f64);
        let labels = (0..PARTS).map(|part| format!("{} .. {}", edge(part), edge(part + 1))).collect();
        Self { labels, places: numbers.iter().map(place).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{layouts, measure};
    use super::*;

    #[test]
    fn cells_are_means_over_the_other_axes() {
        let case = |robot, height, side, value| (vec![robot, height, side], value);
        let cases = [
            case("a", "20", "l", Some(1.0)),
            case("a", "20", "r", Some(3.0)),
            case("b", "20", "l", Some(5.0)),
            case("b", "3", "l", None),
            case("a", "3", "l", Some(7.0)),
        ];
        let layouts = layouts(&["robot", "height", "side"], &cases);
        let measure = measure(&layouts, "figure_mm", 0.0);
        let axes = layouts.axes_named(&["robot", "height"].map(str::to_owned)).unwrap();
        let map = map(&layouts, &measure, axes).unwrap();
        assert_eq!(
            map.labels,
            [vec!["a", "b"], vec!["3", "20"]].map(|labels| labels.into_iter().map(str::to_owned).collect::<Vec<_>>())
        );
        assert_eq!(map.cells, [Some(7.0), None, Some(2.0), Some(5.0)]);
        assert_eq!(map.counts, [1, 0, 2, 1]);
    }

    #[test]
    fn an_axis_of_many_numbers_is_cut_into_parts() {
        let numbers: Vec<String> = (0..=80).map(|k| k.to_string()).collect();
        let cases: Vec<_> =
            numbers.iter().map(|n| (vec![n.as_str(), if n.len() == 1 { "x" } else { "y" }], Some(1.0))).collect();
        let layouts = layouts(&["k", "side"], &cases);
        let map = map(&layouts, &measure(&layouts, "figure_mm", 0.0), [4, 5]).unwrap();
        assert_eq!((map.labels[0].len(), map.labels[0][1].as_str()), (8, "10.0 .. 20.0"));
        assert_eq!(map.counts[..8], [10, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(map.counts[8..], [0, 10, 10, 10, 10, 10, 10, 11]);
    }
}
