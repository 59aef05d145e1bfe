//! The rows of a study as layouts.
//!
//! Mostly a layout is a case. Where several tasks have each its own placement, a layout is all cases that differ in the
//! task alone: its deflections and times are means over the tasks by their weights, its margins the smallest.

use super::AnalysisError;
use super::measure::{Measure, nearest};
use crate::cases::{CaseStatus, Column, ColumnKind, Table, TableCell};
use std::collections::HashMap;

/// One layout.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// The numbers of its cases.
    pub cases: Vec<i64>,
    /// Its values, under the columns of the study.
    pub row: Vec<TableCell>,
}

/// All layouts of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Layouts {
    /// The columns of the study.
    pub columns: Vec<Column>,
    /// Where the axes are among them.
    pub axes: Vec<usize>,
    /// The layouts, in the order of their first cases.
    pub all: Vec<Layout>,
    tasks: Vec<String>,
}

/// Where the columns are that every table has.
struct Fixed {
    case: usize,
    task: usize,
    weight: usize,
    status: usize,
    reason: usize,
}

impl Fixed {
    fn of(columns: &[Column]) -> Self {
        let at = |name: &str, usual: usize| columns.iter().position(|column| column.name == name).unwrap_or(usual);
        let status = at("status", columns.len());
        Self { case: at("case", 0), task: at("task", 2), weight: at("task_weight", 3), status, reason: status + 1 }
    }

    /// The columns between the weight of the task and the status.
    fn axes(&self) -> Vec<usize> {
        (self.weight + 1..self.status).collect()
    }
}

impl Layouts {
    /// The layouts of a table of results.
    pub fn of(table: &Table) -> Self {
        let fixed = Fixed::of(&table.columns);
        let groups = groups(table, &fixed.axes());
        let tasks = tasks(table, &fixed);
        let is_joined = tasks.len() > 1 && groups.iter().any(|rows| rows.len() == tasks.len());
        if is_joined {
            let all = groups.iter().map(|rows| joined(table, &fixed, rows, tasks.len())).collect();
            return Self { columns: table.columns.clone(), axes: fixed.axes(), all, tasks };
        }
        Self::cases(table)
    }

    /// The cases of one task.
    pub(super) fn of_task(table: &Table, task: &str) -> Self {
        let column = Fixed::of(&table.columns).task;
        Self::single(table, |row| row[column].written() == task)
    }

    /// All cases one by one, whatever their task.
    pub(super) fn cases(table: &Table) -> Self {
        let (mut cases, fixed) = (Self::single(table, |_| true), Fixed::of(&table.columns));
        cases.axes.push(fixed.task);
        cases
    }

    fn single(table: &Table, is_meant: impl Fn(&[TableCell]) -> bool) -> Self {
        let fixed = Fixed::of(&table.columns);
        let rows = table.rows.iter().filter(|row| is_meant(row));
        let all = rows.map(|row| Layout { cases: vec![case(&row[fixed.case])], row: row.clone() }).collect();
        Self { columns: table.columns.clone(), axes: fixed.axes(), all, tasks: Vec::new() }
    }

    /// The tasks that each layout was placed for; none where a layout is a case.
    pub fn tasks(&self) -> &[String] {
        &self.tasks
    }

    /// The columns of axes that have more than one value.
    pub fn varied(&self) -> Vec<usize> {
        let is_varied = |axis: &usize| self.all.iter().any(|layout| layout.row[*axis] != self.all[0].row[*axis]);
        self.axes.iter().copied().filter(is_varied).collect()
    }

    /// What a layout is, in words: `robot = a.toml, pedestal = low`.
    pub fn words(&self, layout: &Layout) -> String {
        let words = |axis: usize| format!("{} = {}", self.columns[axis].name, layout.row[axis].written());
        self.varied().into_iter().map(words).collect::<Vec<_>>().join(", ")
    }

    /// Whether a layout has a placement, in the word of the table, and why it has none.
    pub fn status(&self, layout: &Layout) -> [String; 2] {
        let fixed = Fixed::of(&self.columns);
        [fixed.status, fixed.reason].map(|column| layout.row.get(column).map_or_else(String::new, TableCell::written))
    }

    pub(super) fn measure(&self, requested: &str, noise: f64) -> Result<Measure, AnalysisError> {
        Measure::of(&self.columns, &self.axes, requested, noise)
    }

    /// The layouts with a value of a column, with their places. Those without a placement have none, not even on an
    /// axis.
    pub fn valued(&self, measure: &Measure) -> impl Iterator<Item = (usize, f64)> {
        let fixed = Fixed::of(&self.columns);
        let is_placed = move |row: &[TableCell]| {
            row.get(fixed.status).is_some_and(|cell| cell.written() == CaseStatus::Placed.word())
        };
        let value = move |layout: &Layout| if is_placed(&layout.row) { measure.value(&layout.row) } else { None };
        self.all.iter().enumerate().filter_map(move |(index, layout)| Some((index, value(layout)?)))
    }

    /// Refuses a column that is empty, unless nothing has a placement.
    pub(super) fn check_values(&self, measure: &Measure) -> Result<(), AnalysisError> {
        let fixed = Fixed::of(&self.columns);
        let is_placed = |layout: &Layout| layout.row[fixed.status].written() == CaseStatus::Placed.word();
        if self.valued(measure).next().is_none() && self.all.iter().any(is_placed) {
            return Err(AnalysisError::NoValues(measure.name.clone()));
        }
        Ok(())
    }

    /// The columns of two axes, by their names.
    pub(super) fn axes_named(&self, names: &[String; 2]) -> Result<[usize; 2], AnalysisError> {
        let varied = self.varied();
        let known = || varied.iter().map(|axis| self.columns[*axis].name.as_str());
        let find = |name: &String| {
            varied.iter().copied().find(|axis| self.columns[*axis].name == *name).ok_or_else(|| {
                AnalysisError::Unknown {
                    requested: name.clone(),
                    kind: "axis of the study with several values",
                    nearest: nearest(name, known()),
                    allowed: known().collect::<Vec<_>>().join(", "),
                }
            })
        };
        let axes = [find(&names[0])?, find(&names[1])?];
        if axes[0] == axes[1] {
            let (requested, problem) = (names.join(","), "names an axis twice");
            return Err(AnalysisError::Names { requested, problem, allowed: "two different axes of the study" });
        }
        Ok(axes)
    }
}

fn case(cell: &TableCell) -> i64 {
    if let TableCell::Count(number) = cell { *number } else { 0 }
}

/// The tasks, in the order in which they come.
fn tasks(table: &Table, fixed: &Fixed) -> Vec<String> {
    let mut tasks: Vec<String> = Vec::new();
    for task in table.rows.iter().map(|row| row[fixed.task].written()) {
        if !tasks.contains(&task) {
            tasks.push(task);
        }
    }
    tasks
}

/// The rows with the same value on every axis, in the order in which they come.
fn groups<'t>(table: &'t Table, axes: &[usize]) -> Vec<Vec<&'t Vec<TableCell>>> {
    let mut places: HashMap<Vec<String>, usize> = HashMap::new();
    let mut groups: Vec<Vec<&Vec<TableCell>>> = Vec::new();
    for row in &table.rows {
        let key = axes.iter().map(|axis| row[*axis].written()).collect();
        let place = *places.entry(key).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(row);
    }
    groups
}

/// One layout out of its cases, one for each task.
fn joined(table: &Table, fixed: &Fixed, rows: &[&Vec<TableCell>], tasks: usize) -> Layout {
    let cases = rows.iter().map(|row| case(&row[fixed.case])).collect();
    let mut row = rows[0].clone();
    row[fixed.task] = TableCell::None;
    row[fixed.weight] = TableCell::None;
    let failed = rows.iter().find(|row| row[fixed.status].written() != CaseStatus::Placed.word());
    let (status, reason) = match failed {
        Some(failed) => {
            let reason = format!("{}: {}", failed[fixed.task].written(), failed[fixed.reason].written());
            (failed[fixed.status].clone(), TableCell::Text(reason))
        }
        None if rows.len() < tasks => {
            let reason = format!("the study places {} of its {tasks} tasks", rows.len());
            (TableCell::Text(CaseStatus::Failed.word().to_owned()), TableCell::Text(reason))
        }
        None => (row[fixed.status].clone(), TableCell::None),
    };
    let is_whole = failed.is_none() && rows.len() == tasks;
    (row[fixed.status], row[fixed.reason]) = (status, reason);
    for column in fixed.reason + 1..table.columns.len() {
        row[column] = if is_whole { joined_cell(table, fixed, rows, column) } else { TableCell::None };
    }
    Layout { cases, row }
}

/// The figure of a layout: the smallest of margins and feeds, means of the others by the weights of the tasks; none of
/// texts and placements, which belong to one task.
fn joined_cell(table: &Table, fixed: &Fixed, rows: &[&Vec<TableCell>], column: usize) -> TableCell {
    const OF_ONE_TASK: [&str; 5] = ["x_mm", "y_mm", "z_mm", "q4", "yaw_deg"];
    let Column { name, kind } = &table.columns[column];
    if *kind != ColumnKind::Number || OF_ONE_TASK.contains(&name.as_str()) {
        return TableCell::None;
    }
    let values: Option<Vec<f64>> = rows.iter().map(|row| row[column].as_number()).collect();
    let Some(values) = values else { return TableCell::None };
    if name.starts_with("min_") || name.starts_with("max_feed") {
        return TableCell::number(values.into_iter().reduce(f64::min));
    }
    let weights = rows.iter().map(|row| row[fixed.weight].as_number().unwrap_or(1.0));
    let (sum, all) = values.iter().zip(weights).fold((0.0, 0.0), |(sum, all), (v, w)| (sum + v * w, all + w));
    TableCell::number(Some(sum / all))
}
