//! The tables of a study's report.

use super::words::{cases, number, percent};
use crate::csv_file::{Columns, rows};
use crate::output::ReportError;
use stead_study::analysis::{Analysis, AxisEffect, Effects, Front, FrontMember, Layout, Layouts, Level, Ranked};

records! {
    /// A layout of a ranking; its values of the axes and of the column have the names that the study gives them.
    pub struct RankingRow of (analysis: &Analysis, axes: &[usize], layout: usize, ranked: Option<&Ranked>) {
        let layout = &analysis.layouts.all[layout];
        let [status, reason] = analysis.layouts.status(layout);
    } with {
        /// The rank, from 1; empty where it has no value.
        rank: Option<usize> = ranked.map(|ranked| ranked.rank),
        /// Numbers of its cases.
        cases: String = cases(layout),
        #[serde(flatten)] axes: Columns<String> = axis_values(&analysis.layouts, layout, axes),
        #[serde(flatten)] value: Columns<Option<f64>> =
            Columns(vec![(analysis.ranking.measure.name.clone(), ranked.map(|ranked| ranked.value))]),
        /// How far it is behind the best. %
        behind_best_percent: Option<f64> = ranked.and_then(|ranked| ranked.behind).map(percent),
        /// What became of its cases.
        status: String = status,
        /// Why it has no value.
        reason: String = reason,
    }
}

/// `study-ranking.csv`: a `RankingRow` for every layout, best first, then those without a value.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn ranking_table(analysis: &Analysis) -> Result<Vec<u8>, ReportError> {
    let (axes, ranking) = (analysis.layouts.varied(), &analysis.ranking);
    let ranked = ranking.ranked.iter().map(|ranked| RankingRow::of(analysis, &axes, ranked.layout, Some(ranked)));
    let without = ranking.without.iter().map(|layout| RankingRow::of(analysis, &axes, *layout, None));
    rows("the ranking", ranked.chain(without))
}

records! {
    /// A layout on a front; its values of the axes and of the columns have the names that the study gives them.
    pub struct FrontRow of (member: &FrontMember, front: &Front, layouts: &Layouts) {
        let layout = &layouts.all[member.layout];
        let names = front.measures.iter().map(|measure| measure.name.clone());
    } with {
        /// Numbers of its cases.
        cases: String = cases(layout),
        #[serde(flatten)] axes: Columns<String> = axis_values(layouts, layout, &layouts.varied()),
        #[serde(flatten)] values: Columns<f64> = Columns(names.zip(member.values.iter().copied()).collect()),
        /// Whether it is behind the front, but within the noise.
        behind_within_noise: bool = member.is_tie,
    }
}

/// `study-front.csv`: a `FrontRow` for each layout on the front, from the best to the worst in its first column.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn front_table(front: &Front, layouts: &Layouts) -> Result<Vec<u8>, ReportError> {
    let members = front.members.iter().map(|member| FrontRow::of(member, front, layouts));
    rows("the front", members)
}

records! {
    /// A value of an axis; its mean is in a column `mean_of_` and the name of the column that it is of.
    pub struct EffectRow of (axis: &AxisEffect, level: &Level, effects: &Effects) {
        let mean = format!("mean_of_{}", effects.measure.name);
    } with {
        /// The axis.
        axis: String = axis.name.clone(),
        /// How its effect was found.
        method: &'static str = axis.method.word(),
        /// Share of the variance. %
        share_percent: Option<f64> = axis.share.map(percent),
        /// Largest less smallest mean.
        range: f64 = number(axis.range),
        /// Rank correlation.
        rank_correlation: Option<f64> = axis.rank_correlation.map(number),
        /// Slope of a line through the values.
        slope: Option<f64> = axis.slope.map(number),
        /// The value.
        value: String = level.label.clone(),
        /// Layouts that have it.
        layouts: usize = level.count,
        #[serde(flatten)] mean: Columns<f64> = Columns(vec![(mean.clone(), number(level.value))]),
    }
}

/// `study-effects.csv`: an `EffectRow` for every value of every axis.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn effects_table(effects: &Effects) -> Result<Vec<u8>, ReportError> {
    let row = |axis: &AxisEffect, level: &Level| EffectRow::of(axis, level, effects);
    let row = &row;
    rows("the effects", effects.axes.iter().flat_map(|axis| axis.levels.iter().map(move |level| row(axis, level))))
}

fn axis_values(layouts: &Layouts, layout: &Layout, axes: &[usize]) -> Columns<String> {
    Columns(axes.iter().map(|axis| (layouts.columns[*axis].name.clone(), layout.row[*axis].written())).collect())
}
