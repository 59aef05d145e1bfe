//! The report of a study for programs.

use super::words::{number, percent};
use crate::document::Document;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use stead_disk::input::InputFile;
use stead_study::analysis::{
    self, Analysis, AxisEffect, Effects, Failures, Front, Layout, Layouts, Measure, Ranked, Ranking, TaskRanking,
};
use stead_study::cases::TableCell;

records! {
    /// A study that was analysed. Numbers of results have the nine digits that are more than rounding.
    pub struct StudyFigures of (name: &str, analysis: &Analysis) {
        let layouts = &analysis.layouts;
    } with {
        /// Name of the study.
        study: String = name.to_owned(),
        /// Relative difference up to which values are alike. %
        noise_percent: f64 = percent(analysis.noise),
        /// The tasks whose placements are joined to one value of a layout.
        tasks_joined: Vec<String> = layouts.tasks().to_vec(),
        /// The ranking of the layouts.
        ranking: RankingFigures = RankingFigures::of(&analysis.ranking, layouts),
        /// The ranking of each task.
        tasks: Vec<TaskFigures> = analysis.tasks.iter().map(TaskFigures::of).collect(),
        /// The front of several columns.
        front: Option<FrontFigures> = analysis.front.as_ref().map(|found| FrontFigures::of(found, layouts)),
        /// Effects of the axes.
        effects: EffectFigures = (&analysis.effects).into(),
        /// Means over two axes.
        map: Option<MapFigures> = analysis.map.as_ref().map(Into::into),
        /// Cases without a placement.
        failures: FailureFigures = (&analysis.failures).into(),
    }

    /// A column of a study.
    pub struct MeasureFigures from measure: &Measure {
        /// Name of the column.
        column: String = measure.name.clone(),
        /// Whether smaller or larger values are better: `min` or `max`.
        #[schemars(with = "String")] sense: stead_problem::sense::Sense = measure.sense,
    }

    /// A layout.
    pub struct LayoutFigures of (layouts: &Layouts, layout: &Layout) {
        let axis = |axis: usize| (layouts.columns[axis].name.clone(), (&layout.row[axis]).into());
    } with {
        /// Numbers of its cases.
        cases: Vec<i64> = layout.cases.clone(),
        /// Its value on each axis.
        axes: BTreeMap<String, CellValue> = layouts.varied().into_iter().map(axis).collect(),
    }
}

/// A value of a table.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
enum CellValue {
    Number(f64),
    Count(i64),
    Text(String),
    None(()),
}

impl From<&TableCell> for CellValue {
    fn from(cell: &TableCell) -> Self {
        match cell {
            TableCell::Number(number) => Self::Number(*number),
            TableCell::Count(count) => Self::Count(*count),
            TableCell::Text(text) => Self::Text(text.clone()),
            TableCell::None => Self::None(()),
        }
    }
}

records! {
    /// A ranking: the best with its ties, and the next; all others are in the table.
    pub struct RankingFigures of (found: &Ranking, layouts: &Layouts) {
        let ranked = |ranked: &Ranked| RankedFigures::of(ranked, layouts);
    } with {
        /// The column that layouts are ranked by.
        by: MeasureFigures = (&found.measure).into(),
        /// Number of layouts ranked.
        ranked: usize = found.ranked.len(),
        /// The best layout and those that differ from it by less than the noise of the search.
        best: Vec<RankedFigures> = found.best().iter().map(ranked).collect(),
        /// The best layout that is no tie with the best.
        next: Option<RankedFigures> = found.next().map(ranked),
    }

    /// A layout with its rank.
    pub struct RankedFigures of (ranked: &Ranked, layouts: &Layouts) {
        /// Its rank, from 1; ties share one.
        rank: usize = ranked.rank,
        /// The layout.
        layout: LayoutFigures = LayoutFigures::of(layouts, &layouts.all[ranked.layout]),
        /// Its value in the ranked column.
        value: f64 = ranked.value,
        /// Difference from the best value, in per cent of it. %
        behind_best_percent: Option<f64> = ranked.behind.map(percent),
    }

    /// The ranking of a task.
    pub struct TaskFigures of (found: &TaskRanking) {
        /// Name of the task.
        task: String = found.task.clone(),
        /// Ranking of the layouts for this task alone.
        ranking: RankingFigures = RankingFigures::of(&found.ranking, &found.layouts),
    }

    /// The layouts that no other is better than in every column.
    pub struct FrontFigures of (front: &Front, layouts: &Layouts) {
        /// The columns that are compared.
        of: Vec<MeasureFigures> = front.measures.iter().map(Into::into).collect(),
        /// Layouts compared.
        compared: usize = front.compared.len(),
        /// Layouts on the front.
        members: Vec<MemberFigures> =
            front.members.iter().map(|member: &analysis::FrontMember| MemberFigures::of(member, layouts)).collect(),
    }

    /// A layout on a front.
    pub struct MemberFigures of (member: &analysis::FrontMember, layouts: &Layouts) {
        /// The layout.
        layout: LayoutFigures = LayoutFigures::of(layouts, &layouts.all[member.layout]),
        /// Its value in each of the compared columns.
        values: Vec<f64> = member.values.clone(),
        /// Whether another layout is better, but by less than the noise of the search.
        behind_within_noise: bool = member.is_tie,
    }

    /// Effects of the axes on a column.
    pub struct EffectFigures from effects: &Effects {
        /// Name of the column whose changes are explained.
        on: MeasureFigures = (&effects.measure).into(),
        /// Layouts with a value of the column.
        layouts: usize = effects.count,
        /// Mean of the column over them.
        mean: Option<f64> = (effects.count > 0).then(|| number(effects.mean)),
        /// The effects, axis by axis.
        axes: Vec<AxisEffectFigures> = effects.axes.iter().map(Into::into).collect(),
        /// Share of the variance that the effects of single axes leave to combinations of axes. %
        together_percent: Option<f64> = effects.remainder.map(percent),
    }

    /// The effect of an axis.
    pub struct AxisEffectFigures from axis: &AxisEffect {
        /// Name of the axis.
        axis: String = axis.name.clone(),
        /// How the effect was computed.
        method: &'static str = axis.method.word(),
        /// Share of the variance of the column that the axis explains; null where all values are the same. %
        share_percent: Option<f64> = axis.share.map(percent),
        /// Largest mean of its values less the smallest.
        range: f64 = number(axis.range),
        /// Rank correlation (Spearman) of axis and column; null where the axis has no numbers.
        rank_correlation: Option<f64> = axis.rank_correlation.map(number),
        /// Change of the column for a unit of the axis, by a straight line; null where there is none.
        slope: Option<f64> = axis.slope.map(number),
        /// The values of the axis with their means.
        values: Vec<LevelFigures> = axis.levels.iter().map(LevelFigures::of).collect(),
    }

    /// A value of an axis.
    pub struct LevelFigures of (level: &analysis::Level) {
        /// The value, as the study file states it.
        value: String = level.label.clone(),
        /// Layouts with this value.
        layouts: usize = level.count,
        /// Mean of the column over these layouts.
        mean: f64 = number(level.value),
    }

    /// Means of a column over two axes.
    pub struct MapFigures from map: &analysis::Map {
        /// Name of the column.
        column: String = map.measure.name.clone(),
        /// Names of the two axes.
        axes: [String; 2] = map.names.clone(),
        /// The values of each axis.
        values: [Vec<String>; 2] = map.labels.clone(),
        /// Mean of the column in each cell; null where no layout has a value.
        means: Vec<Option<f64>> = map.cells.iter().map(|cell| cell.map(number)).collect(),
        /// Number of layouts in each cell.
        layouts: Vec<usize> = map.counts.clone(),
    }

    /// Cases without a placement.
    pub struct FailureFigures from found: &Failures {
        let reason = |(reason, cases, first): &(String, usize, String)| ReasonFigures::of(reason, *cases, first);
    } with {
        /// Cases without a placement.
        cases: usize = found.cases,
        /// Cases in which no placement is feasible.
        infeasible: usize = found.infeasible,
        /// Cases that ended with an error.
        failed: usize = found.failed,
        /// The reasons, with how often each occurs.
        reasons: Vec<ReasonFigures> = found.reasons.iter().map(reason).collect(),
        /// Values of axes under which no case has a placement.
        never_placed: Vec<LostFigures> = found.lost.iter().map(LostFigures::of).collect(),
    }

    /// A reason why cases have no placement.
    pub struct ReasonFigures of (reason: &str, cases: usize, first: &str) {
        /// The reason, in words.
        reason: String = reason.to_owned(),
        /// Number of cases with this reason.
        cases: usize = cases,
        /// Number of the first such case.
        first_case: String = first.to_owned(),
    }

    /// Values of axes under which no case has a placement.
    pub struct LostFigures of (lost: &analysis::LostLevel) {
        /// The values, axis by axis.
        values: Vec<AxisValue> = lost.values.iter().map(Into::into).collect(),
        /// Cases with these values.
        cases: usize = lost.cases,
    }

    /// A value of an axis.
    pub struct AxisValue from named: &[String; 2] {
        /// Name of the axis.
        axis: String = named[0].clone(),
        /// Its value, as the study file states it.
        value: String = named[1].clone(),
    }
}

/// What `stead study report --json` prints, and the content of `study-report.json`.
pub fn study_json(name: &str, analysis: &Analysis, inputs: &[InputFile]) -> Value {
    Document::new(inputs).notes(&analysis.notes).with(StudyFigures::of(name, analysis))
}
