//! Where the part stands, and how it and the external axes are set up: as pages ask for it and results state it.

use serde_json::{Map, Value, json};
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};

/// Places farther away than this are a slip. mm
pub(super) const FARTHEST_MM: f64 = 1e6;

/// A placement with its setup.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    /// The placement.
    pub placement: Placement,
    /// How part and axes are set up.
    pub setup: Setup,
}

impl Place {
    /// In the middle of the cell, as the run is set up.
    pub fn middle(problem: &Problem) -> Self {
        let middle = |range: &stead_problem::problem::Interval| (range.min + range.max) / 2.0;
        let [x, y, z] = problem.cell.position.each_ref().map(middle);
        let placement = Placement { x, y, z, yaw: middle(&problem.cell.yaw) };
        Self { placement, setup: problem.setup.clone() }
    }

    /// As the entry of a result states it, with every digit; none where it is none of the problem's.
    pub fn of_entry(problem: &Problem, entry: &Value) -> Option<Self> {
        let exact = &entry["placement_exact"];
        let number = |key: &str| exact[key].as_f64().filter(|value| value.abs() <= FARTHEST_MM);
        let [x, y, z] = [number("x_mm")?, number("y_mm")?, number("z_mm")?];
        let placement = Placement::from_mm_deg([x, y, z], number("yaw_deg")?);
        Some(Self { placement, setup: stead_runs::setup_in(problem, entry).ok()? })
    }

    /// The same as such an entry.
    pub fn entry(&self, problem: &Problem) -> Value {
        let Placement { x, y, z, yaw } = self.placement;
        let mut entry = Map::new();
        entry.insert(
            "placement_exact".to_owned(),
            json!({ "x_mm": x * 1e3, "y_mm": y * 1e3, "z_mm": z * 1e3, "yaw_deg": yaw.to_degrees() }),
        );
        if let Some(orientation) = problem.orientations.get(self.setup.orientation) {
            entry.insert("orientation".to_owned(), orientation.name.clone().into());
        }
        let axes = &problem.external_axes;
        if !axes.is_empty() {
            let row = |row: &Vec<f64>| row.iter().zip(axes).map(|(at, axis)| shown(axis, *at)).collect::<Vec<f64>>();
            let (for_each, positions) = match &self.setup.positions {
                AxisPositions::Same(one) => ("path", vec![row(one)]),
                AxisPositions::PerSegment(all) => ("segment", all.iter().map(row).collect()),
                AxisPositions::PerPoint(all) => ("point", all.iter().map(row).collect()),
            };
            entry.insert("external_axes".to_owned(), json!({ "for_each": for_each, "positions": positions }));
        }
        Value::Object(entry)
    }
}

/// A position of an axis in its unit, mm or deg.
pub(super) fn shown(axis: &ExternalAxis, at: f64) -> f64 {
    match axis.kind {
        AxisKind::Rail => at * 1e3,
        AxisKind::Turntable => at.to_degrees(),
    }
}
