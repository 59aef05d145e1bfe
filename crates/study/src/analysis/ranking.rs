//! Layouts by one column, with ties.

use super::layouts::Layouts;
use super::measure::Measure;

/// A layout with its rank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked {
    /// Where it is among the layouts.
    pub layout: usize,
    /// Its rank, from 1; ties share one, and the ranks behind them are left out.
    pub rank: usize,
    /// Its value.
    pub value: f64,
    /// How far it is behind the best, as a share of the best value; none where that is nothing but rounding.
    pub behind: Option<f64>,
}

/// Layouts by one column.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// The column.
    pub measure: Measure,
    /// The layouts with a value, the best first, ties in the order of their values.
    pub ranked: Vec<Ranked>,
    /// The layouts without.
    pub without: Vec<usize>,
}

/// The layouts by one column. A layout ties with the best of its rank: differences do not add up along a row of ties.
pub fn ranking(layouts: &Layouts, measure: &Measure) -> Ranking {
    let mut valued: Vec<(usize, f64)> = layouts.valued(measure).collect();
    valued.sort_by(|a, b| measure.sense.compare(a.1, b.1).then(a.0.cmp(&b.0)));
    let mut ranked: Vec<Ranked> = Vec::with_capacity(valued.len());
    let (mut rank, mut first) = (1, None);
    for (place, (layout, value)) in (1..).zip(&valued) {
        if !first.is_some_and(|first| measure.is_tie(first, *value)) {
            (rank, first) = (place, Some(*value));
        }
        let best = valued[0].1;
        let behind =
            (best != 0.0 && !measure.is_nothing(best)).then(|| measure.sense.sign() * (value - best) / best.abs());
        ranked.push(Ranked { layout: *layout, rank, value: *value, behind });
    }
    let mut has_value = vec![false; layouts.all.len()];
    ranked.iter().for_each(|ranked| has_value[ranked.layout] = true);
    let without = (0..layouts.all.len()).filter(|layout| !has_value[*layout]).collect();
    Ranking { measure: measure.clone(), ranked, without }
}

impl Ranking {
    /// The best layouts, which are ties.
    pub fn best(&self) -> &[Ranked] {
        let count = self.ranked.iter().take_while(|ranked| ranked.rank == 1).count();
        &self.ranked[..count]
    }

    /// The best layout that is no tie with the best.
    pub fn next(&self) -> Option<&Ranked> {
        self.ranked.iter().find(|ranked| ranked.rank > 1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{layouts, measure};
    use super::*;
    use stead_problem::sense::Sense;

    fn ranks(ranking: &Ranking) -> Vec<(usize, usize)> {
        ranking.ranked.iter().map(|ranked| (ranked.layout, ranked.rank)).collect()
    }

    #[test]
    fn ties_share_a_rank_and_do_not_add_up() {
        let values = [1.0, 1.003, 1.0015, 0.9999, 2.0].map(Some);
        let layouts = layouts(&["a"], &values.map(|value| (vec!["1"], value)));
        let ranking = ranking(&layouts, &measure(&layouts, "figure_mm", 0.002));
        // 1.0015 ties with 0.9999; 1.003 with 1.0015, but not with the first.
        assert_eq!(ranks(&ranking), [(3, 1), (0, 1), (2, 1), (1, 4), (4, 5)]);
        assert_eq!((ranking.best().len(), ranking.next().unwrap().layout), (3, 1));
        assert!((ranking.ranked[4].behind.unwrap() - (2.0 / 0.9999 - 1.0)).abs() < 1e-12);
    }

    #[test]
    fn rounding_is_no_difference() {
        let values = [2e-7, 5e-7, 3e-6].map(Some);
        let layouts = layouts(&["a"], &values.map(|value| (vec!["1"], value)));
        let of = |noise| ranking(&layouts, &measure(&layouts, "figure_mm", noise));
        assert_eq!(ranks(&of(0.002)), [(0, 1), (1, 1), (2, 3)]);
        assert_eq!((of(0.002).ranked[2].behind, of(0.0).ranked[1].rank), (None, 2));
    }

    #[test]
    fn larger_is_better_where_asked_for_and_cases_without_value_come_last() {
        let values = [Some(1.0), None, Some(3.0)];
        let layouts = layouts(&["a"], &values.map(|value| (vec!["1"], value)));
        let measure = measure(&layouts, "figure_mm:max", 0.002);
        assert_eq!(measure.sense, Sense::Max);
        let ranking = ranking(&layouts, &measure);
        assert_eq!((ranks(&ranking), ranking.without), (vec![(2, 1), (0, 2)], vec![1]));
        assert!((ranking.ranked[1].behind.unwrap() - 2.0 / 3.0).abs() < 1e-12);
    }
}
