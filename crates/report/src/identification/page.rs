//! `report.html` of an identification.

use super::json::{URAD, key, unit};
use crate::page::cards::{Axis, Cell, Chart, Column, Mark, Page, Series, Style, Table, Tile};
use crate::units::{figures, fixed};
use stead_calibration::identification::outcome::Estimate;
use stead_calibration::identification::{FitModel, Identified, RowResult};
use stead_runs::IdentifyRun;

/// Compliances with their intervals, how well they explain the readings, and every reading.
pub(super) fn page(run: &IdentifyRun, found: &Identified) -> Page {
    let sheet = &run.problem.sheet;
    let subtitle =
        format!("identification · {} readings in {} configurations", sheet.readings.len(), sheet.configurations.len());
    let lead = format!(
        "The identified compliances explain the readings to {} mm, and predict a configuration from all others to {} mm.",
        fixed(found.residual_rms * 1e3, 4),
        fixed(found.prediction.rms * 1e3, 4)
    );
    Page::new(found.robot.name(), subtitle, lead, &run.inputs)
        .messages(&found.warnings, &run.notes)
        .with(tiles(found))
        .with(intervals(found))
        .with(compliances(found))
        .with_all(found.varying.is_some().then(|| arm(found)))
        .with_all((found.model == FitModel::Full).then(|| springs(found)))
        .with(agreement(run, found))
        .with(residuals_chart(run, found))
        .with(residuals(run, found))
}

fn tiles(found: &Identified) -> Vec<Tile> {
    let mm = |length: f64| fixed(length * 1e3, 4);
    let noise = if found.is_noise_estimated { "estimated from the residuals" } else { "as stated" };
    let freedom = format!("{} degrees of freedom", found.degrees_of_freedom);
    vec![
        Tile::new("residual", mm(found.residual_rms), "mm rms", freedom),
        Tile::new("noise of one reading", mm(found.noise), "mm", noise),
        Tile::new("prediction", mm(found.prediction.rms), "mm rms", "of a configuration left out"),
        Tile::new("outliers", found.outliers().count().to_string(), "", "readings left out"),
        Tile::new("unloaded readings", mm(found.setup.residual_rms), "mm rms", "off the joint angles"),
    ]
}

/// What a compliance is of.
fn name(found: &Identified, estimate: &Estimate<stead_calibration::identification::model::Parameter>) -> String {
    let joint = match found.model {
        FitModel::Axes => format!("joint {}", found.joint(estimate.parameter) + 1),
        FitModel::Full => found.name(estimate.parameter, None),
    };
    estimate.angle.map_or(joint.clone(), |angle| format!("{joint} at {} deg", fixed(angle.to_degrees(), 2)))
}

fn intervals(found: &Identified) -> Chart {
    let names: Vec<String> = found.compliances.iter().map(|estimate| name(found, estimate)).collect();
    let of = |value: fn(&Estimate<_>) -> f64| {
        found.compliances.iter().map(|estimate| value(estimate) * URAD).collect::<Vec<f64>>()
    };
    let places = (0..names.len()).map(|k| k as f64).collect();
    let low = of(|estimate| estimate.interval[0]);
    let is_log = low.iter().all(|low| *low > 0.0);
    let series = Series {
        style: Style::Intervals,
        x: places,
        y: of(|estimate| estimate.value),
        high: of(|estimate| estimate.interval[1]),
        low,
        ..Series::default()
    };
    let y = Axis { is_log, ..Axis::new("compliance (urad/(N m))") };
    Chart::new("Compliances with their 95 % intervals", Axis::named("", names), y, [series])
}

/// Value, standard deviation, its share and the interval, each with two digits of the standard deviation.
fn cells<P>(estimate: &Estimate<P>, factor: f64) -> impl Iterator<Item = Cell> {
    let [value, deviation, percent, interval] = super::text::cells(estimate, factor);
    [Cell::Number(value), Cell::Number(deviation), Cell::Number(percent), Cell::Text(interval)].into_iter()
}

/// The columns of [`cells`], with the first of a table before them.
fn columns(first: &str, value: &str) -> Vec<Column> {
    let numbers = [value, "std", "std in %"].map(Column::number);
    std::iter::once(Column::text(first)).chain(numbers).chain([Column::text("95 % interval")]).collect()
}

fn compliances(found: &Identified) -> Table {
    let row = |estimate| std::iter::once(Cell::Text(name(found, estimate))).chain(cells(estimate, URAD)).collect();
    Table::new("Compliances", columns("joint", "urad/(N m)"), found.compliances.iter().map(row).collect())
}

fn arm(found: &Identified) -> Table {
    let row = |estimate: &Estimate<_>| {
        let (name, factor) = key(&estimate.parameter);
        let name = format!("{name} ({})", unit(estimate.parameter.quantity));
        std::iter::once(Cell::Text(name)).chain(cells(estimate, factor)).collect()
    };
    Table::new("In the robot file", columns("parameter", "value"), found.arm.iter().map(row).collect())
}

/// The springs as the robot file has them.
fn springs(found: &Identified) -> Table {
    let rows = super::text::spring_rows(found);
    let rows = rows.map(|row| row.into_iter().map(Cell::Number).collect()).collect();
    let columns = ["joint", "about z", "about x", "about y"].map(Column::number);
    let split =
        "springs that cannot be told apart are split such that none is below zero and the sum of squares is least";
    Table::new("Springs of the robot file", columns.to_vec(), rows).detailed(format!("urad/(N m); {split}"))
}

/// What a reading is.
fn label(run: &IdentifyRun, row: &RowResult) -> String {
    let sheet = &run.problem.sheet;
    format!("{}, {}, line {}", sheet.configurations[row.configuration].name, sheet.points[row.point], row.line)
}

/// The three components of every reading over those predicted, in mm, with rings about outliers.
fn dots(run: &IdentifyRun, found: &Identified, height: fn(f64, f64) -> f64) -> Vec<Series> {
    let point = |row: &RowResult, axis: usize| {
        let (predicted, measured) = (row.predicted[axis] * 1e3, row.measured[axis] * 1e3);
        [predicted, height(measured, predicted)]
    };
    let labels: Vec<String> = found.rows.iter().map(|row| label(run, row)).collect();
    let axis = |(axis, name): (usize, &str)| {
        Series::dots(name, axis, found.rows.iter().map(|row| point(row, axis))).labelled(labels.clone())
    };
    let mut series: Vec<Series> = ["x of the base frame", "y", "z"].into_iter().enumerate().map(axis).collect();
    if found.outliers().next().is_some() {
        let outliers = found.outliers().flat_map(|row| (0..3).map(move |axis| point(row, axis)));
        series.push(Series::dots("left out", 3, outliers).styled(Style::Rings));
    }
    series
}

/// Every component of every deflection, read over predicted, with the line on which both are the same.
pub(super) fn agreement(run: &IdentifyRun, found: &Identified) -> Chart {
    let components = found
        .rows
        .iter()
        .flat_map(|row| row.predicted.iter().chain(row.measured.iter()).copied().collect::<Vec<f64>>());
    let reach = components.fold(0.0_f64, |reach, part| reach.max(part.abs())) * 1e3;
    let mut series = dots(run, found, |measured, _| measured);
    series.push(Series::curve("read as predicted", 4, [[-reach, -reach], [reach, reach]]).styled(Style::Dashed));
    let title = "Deflection read and by the identified arm";
    Chart { is_even: true, ..Chart::new(title, "predicted component (mm)", "component read (mm)", series) }
}

/// What is left of it, over the predicted one.
pub(super) fn residuals_chart(run: &IdentifyRun, found: &Identified) -> Chart {
    let dots = dots(run, found, |measured, predicted| measured - predicted);
    Chart::new("Residuals", "predicted component (mm)", "read less predicted (mm)", dots)
        .detailed(format!("{} mm rms", figures(found.residual_rms * 1e3)))
        .marked([Mark::level(0.0, "")])
}

fn residuals(run: &IdentifyRun, found: &Identified) -> Table {
    let sheet = &run.problem.sheet;
    let row = |row: &RowResult| {
        let residual = row.measured - row.predicted;
        let lengths = [row.measured.norm(), residual.norm(), residual.x, residual.y, residual.z];
        let words = [sheet.configurations[row.configuration].name.clone(), sheet.points[row.point].clone()];
        let outlier = if row.is_outlier { "left out" } else { "" };
        std::iter::once(Cell::Number(row.line.to_string()))
            .chain(words.map(Cell::Text))
            .chain(lengths.map(|length| Cell::Number(fixed(length * 1e3, 4))))
            .chain([Cell::Number(fixed(row.studentised, 2)), Cell::Text(outlier.to_owned())])
            .collect()
    };
    let numbers = ["read mm", "residual mm", "x mm", "y mm", "z mm", "studentised"].map(Column::number);
    let first = [Column::number("line"), Column::text("configuration"), Column::text("point")];
    let columns = first.into_iter().chain(numbers).chain([Column::text("outlier")]).collect();
    Table::new("Readings", columns, found.rows.iter().map(row).collect())
        .detailed("sizes of deflection and residual; residual in the base frame")
        .filtered()
}
