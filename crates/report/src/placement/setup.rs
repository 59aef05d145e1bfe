//! How part and external axes are set up, in documents, tables and words; nothing where a run has neither orientations
//! nor axes.

use super::PLACES;
use crate::columns::table;
use crate::csv_file::Columns;
use crate::figure::{AngleDeg, DeflectionMm, PlaceMm, some};
use crate::units::{Unit, fixed};
use schemars::JsonSchema;
use serde::Serialize;
use stead_model::external_axis::AxisKind;
use stead_placement::outcome::{Case, Outcome};
use stead_problem::problem::Problem;
use stead_problem::setup::{AxisPath, AxisPositions, Setup, TriedSetup};

/// The unit of the positions of an axis.
pub(crate) fn unit(kind: AxisKind) -> Unit {
    match kind {
        AxisKind::Rail => Unit::PLACE_MM,
        AxisKind::Turntable => Unit::ANGLE_DEG,
    }
}

/// The name of that unit.
pub(crate) fn unit_name(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Rail => "mm",
        AxisKind::Turntable => "deg",
    }
}

/// The word for a kind.
pub(crate) fn word(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Rail => "rail",
        AxisKind::Turntable => "turntable",
    }
}

/// The column of the positions of an axis, by its number from 0: `e1_mm`, `e2_deg`.
pub(crate) fn column(number: usize, kind: AxisKind) -> String {
    format!("e{}_{}", number + 1, unit_name(kind))
}

/// The positions of axes as columns of a row: `e1_mm` or `e1_deg` and so on.
pub(super) type AxisColumns = Columns<Option<AxisFigure>>;

/// A position of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum AxisFigure {
    Rail(PlaceMm),
    Turntable(AngleDeg),
}

/// Positions at a path point.
pub(super) fn at_point(axes: &[AxisPath], point: usize) -> AxisColumns {
    columns(axes, |axis| axis.positions.get(point).copied())
}

/// The positions of the axes that are the same along the path.
pub(super) fn fixed_positions(axes: &[AxisPath]) -> AxisColumns {
    columns(axes, one_position)
}

fn columns(axes: &[AxisPath], position: impl Fn(&AxisPath) -> Option<f64>) -> AxisColumns {
    let figure = |axis: &AxisPath, at: f64| match axis.kind {
        AxisKind::Rail => AxisFigure::Rail(at.into()),
        AxisKind::Turntable => AxisFigure::Turntable(at.into()),
    };
    let named =
        |(number, axis): (usize, &AxisPath)| (column(number, axis.kind), position(axis).map(|at| figure(axis, at)));
    Columns(axes.iter().enumerate().map(named).collect())
}

/// The position of each axis that stands still along the path.
pub(super) fn standing(axes: &[AxisPath]) -> Vec<String> {
    axes.iter().map(|axis| one_position(axis).map_or_else(String::new, |at| unit(axis.kind).text(at))).collect()
}

/// Where the external axes stand, in few words; those that move along the path by their ends.
pub(super) fn standing_words(axes: &[AxisPath]) -> Option<String> {
    let word = |axis: &AxisPath| {
        let (unit, name) = (unit(axis.kind), unit_name(axis.kind));
        match one_position(axis) {
            Some(at) => format!("{} {} {name}", axis.name, unit.text(at)),
            None => format!("{} {} {name}", axis.name, ends(axis).join(" to ")),
        }
    };
    (!axes.is_empty()).then(|| axes.iter().map(word).collect::<Vec<_>>().join(", "))
}

/// The least and the largest position of an axis along the path.
fn ends(axis: &AxisPath) -> [String; 2] {
    let end = |of: fn(f64, f64) -> f64| axis.positions.iter().copied().reduce(of).unwrap_or(0.0);
    [end(f64::min), end(f64::max)].map(|at| unit(axis.kind).text(at))
}

fn one_position(axis: &AxisPath) -> Option<f64> {
    let first = *axis.positions.first()?;
    axis.positions.iter().all(|position| *position == first).then_some(first)
}

records! {
    /// How part and external axes are set up; empty where a run has neither orientations nor axes, and
    /// no tool that leans.
    pub struct SetupFigures of (orientation: Option<&String>, setup: &Setup, axes: &[AxisPath]) {
        let leans = || setup.leans.iter().map(|lean| [lean.lead, lean.tilt].map(f64::to_degrees)).collect();
    } with {
        /// Name of the orientation of the part.
        orientation?: String = orientation.cloned(),
        /// External axes and their positions.
        external_axes?: ExternalAxisFigures = (!axes.is_empty()).then(|| ExternalAxisFigures::of(setup, axes)),
        /// Lead and tilt of the tool from the axis of the path at every point with every digit, where it leans.
        leans_deg?: Vec<[f64; 2]> = (!setup.leans.is_empty()).then(leans),
    }

    /// Positions of external axes.
    pub struct ExternalAxisFigures of (setup: &Setup, axes: &[AxisPath]) {
        let exact = |(position, axis): (&f64, &AxisPath)| match axis.kind {
            AxisKind::Rail => position * 1e3,
            AxisKind::Turntable => position.to_degrees(),
        };
        let row = |row: &Vec<f64>| row.iter().zip(axes).map(exact).collect();
        let (for_each, positions) = match &setup.positions {
            AxisPositions::Same(one) => ("path", vec![row(one)]),
            AxisPositions::PerSegment(all) => ("segment", all.iter().map(row).collect()),
            AxisPositions::PerPoint(all) => ("point", all.iter().map(row).collect()),
        };
    } with {
        /// The axes.
        axes: Vec<AxisFigures> = axes.iter().map(AxisFigures::of).collect(),
        /// What each row of positions is for: the `path`, a `segment` or a `point`.
        for_each: &'static str = for_each,
        /// Rows of positions with every digit, in the units of the axes.
        positions: Vec<Vec<f64>> = positions,
    }

    /// An external axis.
    pub struct AxisFigures of (axis: &AxisPath) {
        /// Its name.
        name: String = axis.name.clone(),
        /// `rail` or `turntable`.
        kind: &'static str = word(axis.kind),
        /// Unit of its positions.
        unit: &'static str = unit_name(axis.kind),
    }

    /// A setup that was searched.
    pub struct TriedFigures of (problem: &Problem, tried: &TriedSetup) {
        let TriedSetup { setup, objectives } = tried;
        let problem = problem.in_setup(setup);
    } with {
        /// Objective of its best placement; null where none is feasible.
        best_objective_mm: Option<DeflectionMm> = objectives.map(|(best, _)| best.into()),
        /// Objective of its worst placement.
        worst_objective_mm: Option<DeflectionMm> = some(objectives.and_then(|(_, worst)| worst)),
        #[serde(flatten)] setup: SetupFigures =
            SetupFigures::of(problem.orientation().map(|orientation| &orientation.name), setup, &problem.axis_paths()),
    }
}

/// How part and axes are set up for a case, a line each.
pub(crate) fn lines(of: &str, orientation: Option<&String>, axes: &[AxisPath]) -> Vec<String> {
    let mut lines: Vec<String> = orientation.map(|name| format!("{of} has the part \"{name}\"")).into_iter().collect();
    for axis in axes {
        let (unit, name) = (unit(axis.kind), unit_name(axis.kind));
        let kind = word(axis.kind);
        lines.push(match one_position(axis) {
            Some(at) => format!("{of} has the {kind} \"{}\" at {} {name}", axis.name, unit.text(at)),
            None => {
                let [least, most] = ends(axis);
                format!("{of} has the {kind} \"{}\" between {least} and {most} {name} along the path", axis.name)
            }
        });
    }
    lines
}

/// The lines of the best and the worst placement, and a table of the setups that were searched.
pub(super) fn text(problem: &Problem, outcome: &Outcome) -> String {
    let cases = PLACES.into_iter().zip(outcome.cases.optima());
    let of = |(name, case): (&str, &Case)| lines(name, case.orientation.as_ref(), &case.plan.axes);
    let all: Vec<String> = cases.flat_map(of).collect();
    let mut text: String = all.iter().map(|line| format!("{line}\n")).collect();
    if outcome.tried_setups.len() > 1 {
        let mut header = vec!["setup".to_owned()];
        header.extend((!problem.orientations.is_empty()).then(|| "orientation".to_owned()));
        header.extend(problem.external_axes.iter().map(|axis| format!("{} {}", axis.name, unit_name(axis.kind))));
        header.extend(["best mm", "worst mm"].map(str::to_owned));
        let rows = outcome.tried_setups.iter().zip(1..).map(|(TriedSetup { setup, objectives }, number)| {
            let problem = problem.in_setup(setup);
            let mut row = vec![number.to_string()];
            row.extend(problem.orientation().map(|orientation| orientation.name.clone()));
            row.extend(standing(&problem.axis_paths()));
            let figure = |objective: Option<f64>| objective.map_or_else(|| "-".to_owned(), |of| fixed(of * 1e3, 4));
            row.extend([objectives.map(|(best, _)| best), objectives.and_then(|(_, worst)| worst)].map(figure));
            row
        });
        let names = if problem.orientations.is_empty() { vec![] } else { vec![1] };
        text.push('\n');
        text.push_str(&table(header, rows, &names));
    }
    text
}
