//! The Pareto front: layouts that no other is better than in every respect.

use super::layouts::Layouts;
use super::measure::Measure;
use std::cmp::Ordering;

/// A layout on the front.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontMember {
    /// Where it is among the layouts.
    pub layout: usize,
    /// Its values, one for each column.
    pub values: Vec<f64>,
    /// Whether another is at least as good in every column and better in one, though within the noise: it may be on the
    /// front, or close behind it.
    pub is_tie: bool,
}

/// The compromises between several columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// The columns.
    pub measures: Vec<Measure>,
    /// The layouts on the front, from the best to the worst in the first column.
    pub members: Vec<FrontMember>,
    /// All layouts with a value in every column, and their values.
    pub compared: Vec<(usize, Vec<f64>)>,
}

/// The Pareto front of several columns. A layout is off the front when another is at least as good in every column, and
/// better by more than the noise in one.
pub fn front(layouts: &Layouts, measures: Vec<Measure>) -> Front {
    let values = |layout: usize| -> Option<Vec<f64>> {
        measures.iter().map(|measure| measure.value(&layouts.all[layout].row)).collect()
    };
    let first = layouts.valued(&measures[0]);
    let mut compared: Vec<(usize, Vec<f64>)> =
        first.filter_map(|(layout, _)| Some((layout, values(layout)?))).collect();
    compared.sort_by(|a, b| in_order(&measures, &a.1, &b.1).then(a.0.cmp(&b.0)));
    // Whatever is at least as good everywhere comes before in this order; and what keeps a layout off the front is on
    // the front itself, or has something there that does the same.
    let mut members: Vec<FrontMember> = Vec::new();
    for (layout, values) in &compared {
        let as_good = |member: &&FrontMember| all(&measures, &member.values, values, Measure::is_as_good);
        let mut is_tie = false;
        let mut is_off = false;
        for member in members.iter().filter(as_good) {
            is_tie |= member.values != *values;
            is_off |= measures
                .iter()
                .zip(member.values.iter().zip(values))
                .any(|(measure, (a, b))| measure.is_clearly_better(*a, *b));
        }
        if !is_off {
            members.push(FrontMember { layout: *layout, values: values.clone(), is_tie });
        }
    }
    Front { measures, members, compared }
}

fn all(measures: &[Measure], a: &[f64], b: &[f64], is_so: impl Fn(&Measure, f64, f64) -> bool) -> bool {
    measures.iter().zip(a.iter().zip(b)).all(|(measure, (a, b))| is_so(measure, *a, *b))
}

/// By the first column, then the second, and so on, better first.
fn in_order(measures: &[Measure], a: &[f64], b: &[f64]) -> Ordering {
    let orders = measures.iter().zip(a.iter().zip(b)).map(|(measure, (a, b))| measure.sense.compare(*a, *b));
    orders.fold(Ordering::Equal, Ordering::then)
}

#[cfg(test)]
mod tests {
    use super::super::testing::figures;
    use super::*;
    use proptest::prelude::*;
    use stead_problem::sense::Sense;

    /// The definition, word by word, over all pairs.
    fn by_definition(measures: &[Measure], rows: &[Vec<f64>]) -> Vec<(usize, bool)> {
        let as_good = |a: &[f64], b: &[f64]| {
            measures.iter().enumerate().all(|(k, m)| if m.sense == Sense::Min { a[k] <= b[k] } else { a[k] >= b[k] })
        };
        let beyond = |a: &[f64], b: &[f64]| {
            measures.iter().enumerate().any(|(k, m)| (a[k] - b[k]).abs() > m.noise * a[k].abs().max(b[k].abs()))
        };
        let off = |row: &Vec<f64>| rows.iter().any(|other| as_good(other, row) && other != row && beyond(other, row));
        let tie = |row: &Vec<f64>| rows.iter().any(|other| as_good(other, row) && other != row);
        rows.iter().enumerate().filter(|(_, row)| !off(row)).map(|(index, row)| (index, tie(row))).collect()
    }

    /// The members of a front, and whether each is a tie: as found, and as expected.
    fn found(rows: &[Vec<f64>], noise: f64, senses: &[Sense]) -> [Vec<(usize, bool)>; 2] {
        let (layouts, measures) = figures(rows, noise, senses);
        let expected = by_definition(&measures, rows);
        let front = front(&layouts, measures);
        let mut members: Vec<_> = front.members.iter().map(|member| (member.layout, member.is_tie)).collect();
        members.sort_unstable();
        [members, expected]
    }

    proptest! {
        #[test]
        fn the_front_is_what_its_definition_says(
            rows in prop::collection::vec(prop::collection::vec(-12_i32..12, 3), 1..60),
            noise in prop::sample::select(vec![0.0, 0.1, 0.3]),
            senses in prop::collection::vec(prop::sample::select(Sense::BOTH.to_vec()), 3),
        ) {
            let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.iter().map(|n| f64::from(*n) / 4.0).collect()).collect();
            let [members, expected] = found(&rows, noise, &senses);
            prop_assert_eq!(members, expected);
        }

        #[test]
        fn without_noise_it_is_the_front_of_the_textbook(
            rows in prop::collection::vec(prop::collection::vec(0_i32..30, 2), 1..80),
        ) {
            let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.iter().map(|n| f64::from(*n)).collect()).collect();
            let dominates = |a: &[f64], b: &[f64]| a[0] <= b[0] && a[1] <= b[1] && a != b;
            let best = |row: &&Vec<f64>| !rows.iter().any(|other| dominates(other, row));
            let [members, _] = found(&rows, 0.0, &[Sense::Min; 2]);
            prop_assert_eq!(members.len(), rows.iter().filter(best).count());
            prop_assert!(members.iter().all(|(index, is_tie)| best(&&rows[*index]) && !is_tie));
        }
    }

    #[test]
    fn what_is_worse_within_the_noise_stays() {
        let rows = vec![vec![1.0, 5.0], vec![1.001, 5.0], vec![1.1, 5.0], vec![2.0, 1.0]];
        let [members, _] = found(&rows, 0.002, &[Sense::Min; 2]);
        assert_eq!(members, [(0, false), (1, true), (3, false)]);
    }
}
