//! What a finished study says: which layout is best, which compromises there are, what each axis does, what failed and
//! why.
//!
//! Everything here is computed from the table of results alone. A search ends near an optimum and not at it, so figures
//! that differ by less than its noise ([`SEARCH_NOISE`]) are ties; axes are exact.

mod effects;
mod front;
mod layouts;
mod least_squares;
mod map;
mod measure;
mod ranking;
#[cfg(test)]
mod testing;
mod without;

pub use effects::{AxisEffect, Effects, Level, Method, effects};
pub use front::{Front, FrontMember, front};
pub use layouts::{Layout, Layouts};
pub use map::{MAX_LEVELS, Map, map};
pub use measure::Measure;
pub use ranking::{Ranked, Ranking, ranking};
pub use without::{Failures, LostLevel, failures};

use crate::cases::Table;
use stead_numerics::message::Note;

/// The relative difference of two figures that a search may make by itself: it ends within 0.1 % of the optimum (guide,
/// page `validation`), so two of them differ by up to twice that.
pub const SEARCH_NOISE: f64 = 0.002;

/// Why a table could not be analysed as asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// There is no column, or no axis, of that name.
    #[error("{requested:?} is no {kind}{}; allowed: {allowed}", nearest.as_ref().map_or_else(String::new, |name| format!(" (nearest one: {name})")))]
    Unknown {
        /// What was requested.
        requested: String,
        /// What it should be the name of.
        kind: &'static str,
        /// The nearest name.
        nearest: Option<String>,
        /// What would be accepted.
        allowed: String,
    },
    /// The column holds texts.
    #[error("{0:?} holds no numbers; allowed: a column of study.csv with numbers")]
    NoNumbers(String),
    /// The column is empty in every case that has a placement.
    #[error("{0:?} has no value in any case; allowed: a column of study.csv with values")]
    NoValues(String),
    /// A list of names is too short, too long, or names something twice.
    #[error("{requested:?}: {problem}; allowed: {allowed}")]
    Names {
        /// What was requested.
        requested: String,
        /// What is wrong with it.
        problem: &'static str,
        /// What would be accepted.
        allowed: &'static str,
    },
    /// The noise is out of range.
    #[error("a search noise of {} % is out of range; allowed: 0 up to, but not including, 100", f64::from_bits(*.0) * 100.0)]
    Noise(u64),
    /// There is no row.
    #[error("the table of results has no rows; allowed: a study of one case or more")]
    Empty,
}

/// What is asked of a study. Columns go by their names in `study.csv`, with `:min` or `:max` behind them where the
/// direction is not the usual one.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The column by which layouts are ranked and effects computed.
    pub by: Option<String>,
    /// The columns of the front.
    pub front: Option<Vec<String>>,
    /// The two axes of the map.
    pub map: Option<[String; 2]>,
    /// The relative difference up to which figures are ties.
    pub noise: f64,
}

impl Default for Question {
    fn default() -> Self {
        Self { by: None, front: None, map: None, noise: SEARCH_NOISE }
    }
}

/// What a finished study says.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// The layouts that are compared.
    pub layouts: Layouts,
    /// The layouts by a column.
    pub ranking: Ranking,
    /// Where several tasks have each its own placement: the cases of each task by the same column.
    pub tasks: Vec<TaskRanking>,
    /// The compromises between several columns; nothing where only one has values.
    pub front: Option<Front>,
    /// What each axis does to the column of the ranking.
    pub effects: Effects,
    /// The column of the ranking over two axes, or over one and the tasks; nothing where there are fewer.
    pub map: Option<Map>,
    /// What has no placement.
    pub failures: Failures,
    /// Up to which relative difference figures are ties.
    pub noise: f64,
    /// What it does not say, in sentences ([`Plan::notes`](crate::cases::Plan::notes)); the table alone does not tell.
    pub notes: Vec<Note>,
}

/// The cases of one task.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskRanking {
    /// The task.
    pub task: String,
    /// Its cases.
    pub layouts: Layouts,
    /// Its cases by the column of the whole.
    pub ranking: Ranking,
}

/// What is ranked by, where nothing else is requested.
const BY: &str = "objective_mm";

/// What the front is of, where nothing else is requested: the first two that have values.
const FRONT: [&str; 5] =
    ["best_mean_total_mm", "cycle_s", "price_eur", "min_joint_margin_deg", "min_inverse_condition"];

impl Analysis {
    /// Analyses a table of results.
    ///
    /// # Errors
    /// [`AnalysisError`]: a column that is not there, or holds no numbers or no values; a name too many or too few; a
    /// table without rows.
    pub fn of(table: &Table, question: &Question) -> Result<Self, AnalysisError> {
        if table.rows.is_empty() {
            return Err(AnalysisError::Empty);
        }
        if !(0.0..1.0).contains(&question.noise) {
            return Err(AnalysisError::Noise(question.noise.to_bits()));
        }
        let layouts = Layouts::of(table);
        let measure = layouts.measure(question.by.as_deref().unwrap_or(BY), question.noise)?;
        if question.by.is_some() {
            layouts.check_values(&measure)?;
        }
        let measures = front_measures(&layouts, question)?;
        let effects = effects(&layouts, &measure);
        let requested = question.map.as_ref().map(|names| layouts.axes_named(names)).transpose()?;
        let axes = requested.or_else(|| effects.largest_two());
        let tasks = layouts.tasks().iter().map(|task| {
            let layouts = Layouts::of_task(table, task);
            TaskRanking { task: task.clone(), ranking: ranking(&layouts, &measure), layouts }
        });
        Ok(Self {
            ranking: ranking(&layouts, &measure),
            tasks: tasks.collect(),
            front: measures.map(|measures| front(&layouts, measures)),
            map: match axes {
                Some(axes) => map(&layouts, &measure, axes),
                None => map_over_tasks(table, &layouts, &measure),
            },
            failures: failures(table),
            noise: question.noise,
            notes: Vec::new(),
            effects,
            layouts,
        })
    }
}

/// The column over the one axis that is varied and the tasks, where each layout has a placement for every one of
/// several tasks.
fn map_over_tasks(table: &Table, layouts: &Layouts, measure: &Measure) -> Option<Map> {
    let [axis] = layouts.varied()[..] else { return None };
    let cases = Layouts::cases(table);
    let task = cases.axes.last().copied().filter(|_| !layouts.tasks().is_empty())?;
    map(&cases, measure, [axis, task])
}

/// The columns of the front, as requested or those of [`FRONT`] that have values.
fn front_measures(layouts: &Layouts, question: &Question) -> Result<Option<Vec<Measure>>, AnalysisError> {
    let Some(requested) = &question.front else {
        let measures = FRONT.iter().filter_map(|name| layouts.measure(name, question.noise).ok());
        let measures: Vec<Measure> = measures.filter(|measure| layouts.check_values(measure).is_ok()).take(2).collect();
        return Ok((measures.len() == 2).then_some(measures));
    };
    let names = |problem| AnalysisError::Names {
        requested: requested.join(","),
        problem,
        allowed: "two to six different columns of study.csv, as in best_mean_total_mm,cycle_s",
    };
    if !(2..=6).contains(&requested.len()) {
        return Err(names("is no list of two to six columns"));
    }
    let measures: Vec<Measure> =
        requested.iter().map(|name| layouts.measure(name, question.noise)).collect::<Result<_, _>>()?;
    for (number, measure) in measures.iter().enumerate() {
        layouts.check_values(measure)?;
        if measures[..number].iter().any(|other| other.column == measure.column) {
            return Err(names("names a column twice"));
        }
    }
    Ok(Some(measures))
}
