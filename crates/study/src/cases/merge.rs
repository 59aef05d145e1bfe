//! The rows of all shards as one table of results, handed to the caller to be put in place with its manifest.

use super::StudyError;
use super::keeping::Keeping;
use super::plan::Plan;
use super::row::result_columns;
use super::store::{Entries, Store};
use super::table::{Column, ColumnKind, Table, TableCell};
use std::path::Path;

/// The table of results, one row for each case in the order of their numbers; nothing as long as cases are missing.
///
/// # Errors
/// [`StudyError`]: the folder of another study, or a file that cannot be read.
pub fn merged(plan: &Plan, folder: &Path) -> Result<Option<Table>, StudyError> {
    let store = Store::at(folder);
    store.check(plan)?;
    Ok(table(plan, &store.finished(&mut Vec::new())?))
}

/// The file that holds the table of results.
pub const TABLE: &str = "study.csv";

/// Writes `study.csv` and `study-timing.csv` where every case is done; says whether it is so. The second differs from
/// run to run.
///
/// # Errors
/// [`StudyError`]: the folder of another study, or a file that cannot be read or written.
pub fn merge(plan: &Plan, folder: &Path, keeping: &dyn Keeping) -> Result<bool, StudyError> {
    let store = Store::at(folder);
    store.check(plan)?;
    let _lock = store.lock()?;
    let finished = store.finished(&mut Vec::new())?;
    let Some(table) = table(plan, &finished) else { return Ok(false) };
    store.write("study-timing.csv", &timing(plan, &finished).to_csv()?)?;
    keeping.publish(&[(TABLE, table.to_csv()?)]).map_err(StudyError::Keep)?;
    Ok(true)
}

fn table(plan: &Plan, finished: &Entries) -> Option<Table> {
    let columns = plan.columns();
    let row = |case| Some([plan.cells(case, &columns), finished.get(&case.id)?.row.clone()].concat());
    let rows = plan.cases.iter().map(row).collect::<Option<Vec<_>>>()?;
    Some(Table { columns: columns.into_iter().chain(result_columns()).collect(), rows })
}

/// The numbers of the cases with the smallest objective, the smallest first.
pub(super) fn best(plan: &Plan, folder: &Path, count: usize) -> Result<Vec<usize>, StudyError> {
    let Some(table) = merged(plan, folder)? else { return Ok(Vec::new()) };
    let Some(objective) = table.column("objective_mm") else { return Ok(Vec::new()) };
    let figure = |(row, case): (&Vec<TableCell>, usize)| match row[objective] {
        TableCell::Number(objective) => Some((objective, case)),
        _ => None,
    };
    let mut placed: Vec<(f64, usize)> = table.rows.iter().zip(1..).filter_map(figure).collect();
    placed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    Ok(placed.into_iter().take(count).map(|(_, case)| case).collect())
}

/// How long each case took, where, on how many threads.
fn timing(plan: &Plan, finished: &Entries) -> Table {
    let kinds = [
        ("case", ColumnKind::Count),
        ("seconds", ColumnKind::Number),
        ("threads", ColumnKind::Count),
        ("host", ColumnKind::Text),
    ];
    let rows = plan.cases.iter().map(|case| {
        let timing = finished.get(&case.id).map(|entry| entry.timing.clone()).unwrap_or_default();
        vec![
            TableCell::Count(case.case.number as i64),
            TableCell::Number(timing.seconds),
            TableCell::Count(timing.threads as i64),
            TableCell::Text(timing.host),
        ]
    });
    let rows = rows.collect();
    Table { columns: kinds.map(|(name, kind)| Column::new(name, kind)).to_vec(), rows }
}
