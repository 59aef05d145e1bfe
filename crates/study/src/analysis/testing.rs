//! Small studies for the tests of this room.

use super::layouts::Layouts;
use super::measure::Measure;
use crate::cases::{Column, ColumnKind, Table, TableCell};
use stead_problem::sense::Sense;

/// A table with axes and columns of figures: for each case the texts of its axes (numbers where all are), and its
/// figures. A case without figures is infeasible.
pub(super) fn table(axes: &[&str], names: &[&str], cases: &[(Vec<&str>, Option<Vec<f64>>)]) -> Table {
    let mut columns = vec![
        Column::new("case", ColumnKind::Count),
        Column::new("id", ColumnKind::Text),
        Column::new("task", ColumnKind::Text),
        Column::new("task_weight", ColumnKind::Number),
    ];
    let is_number = |axis: usize| cases.iter().all(|(values, _)| values[axis].parse::<f64>().is_ok());
    let kind = |axis: usize| if is_number(axis) { ColumnKind::Number } else { ColumnKind::Text };
    columns.extend(axes.iter().enumerate().map(|(axis, name)| Column::new(*name, kind(axis))));
    columns.extend([Column::new("status", ColumnKind::Text), Column::new("reason", ColumnKind::Text)]);
    columns.extend(names.iter().map(|name| Column::new(*name, ColumnKind::Number)));
    let words = |text: &str| TableCell::Text(text.to_owned());
    let rows = (1..).zip(cases).map(|(number, (values, figures))| {
        let mut row = vec![TableCell::Count(number), words("id"), words("t.csv"), TableCell::Number(1.0)];
        row.extend(values.iter().enumerate().map(|(axis, text)| match kind(axis) {
            ColumnKind::Number => TableCell::Number(text.parse().unwrap()),
            _ => words(text),
        }));
        row.extend(match figures {
            Some(_) => [words("placed"), TableCell::None],
            None => [words("infeasible"), words("out of reach")],
        });
        row.extend(
            (0..names.len()).map(|k| figures.as_ref().map_or(TableCell::None, |figures| TableCell::Number(figures[k]))),
        );
        row
    });
    Table { columns, rows: rows.collect() }
}

/// The layouts of a table with the one column `figure_mm`.
pub(super) fn layouts(axes: &[&str], cases: &[(Vec<&str>, Option<f64>)]) -> Layouts {
    let cases: Vec<_> =
        cases.iter().map(|(values, figure)| (values.clone(), figure.map(|figure| vec![figure]))).collect();
    Layouts::of(&table(axes, &["figure_mm"], &cases))
}

pub(super) fn measure(layouts: &Layouts, requested: &str, noise: f64) -> Measure {
    layouts.measure(requested, noise).unwrap()
}

/// Layouts with nothing but figures.
pub(super) fn figures(rows: &[Vec<f64>], noise: f64, senses: &[Sense]) -> (Layouts, Vec<Measure>) {
    let names = ["a", "b", "c"];
    let cases: Vec<_> = rows.iter().map(|row| (vec![], Some(row.clone()))).collect();
    let layouts = Layouts::of(&table(&[], &names[..senses.len()], &cases));
    let measures = names.iter().zip(senses).map(|(name, sense)| {
        let direction = if *sense == Sense::Min { "min" } else { "max" };
        measure(&layouts, &format!("{name}:{direction}"), noise)
    });
    let measures = measures.collect();
    (layouts, measures)
}
