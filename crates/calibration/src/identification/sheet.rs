//! What was measured: configurations under load, and readings of reference points without and with the load.

use nalgebra::Vector3;
use serde::Serialize;
use std::ops::Range;

/// Joint angles and a wrench: a configuration to measure, or one in which the deflection is to be predicted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoadCase {
    /// Joint angles. rad
    pub theta: [f64; 6],
    /// Force, in the base frame. N
    pub force: Vector3<f64>,
    /// Moment, in the base frame. N m
    pub moment: Vector3<f64>,
}

/// One configuration of the arm and the load that was put on it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Configuration {
    /// Its name in the sheet.
    pub name: String,
    /// Joint angles. rad
    pub theta: [f64; 6],
    /// Force on the load point, in the base frame. N
    pub force: Vector3<f64>,
    /// Moment there, in the base frame. N m
    pub moment: Vector3<f64>,
    /// Its readings among [`Sheet::readings`].
    pub readings: Range<usize>,
}

/// One reference point in one configuration, seen without and with the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reading {
    /// Line of the file, from 1.
    pub line: usize,
    /// Which configuration, from 0.
    pub configuration: usize,
    /// Which reference point, from 0.
    pub point: usize,
    /// Place without load, in the tracker's frame. m
    pub unloaded: Vector3<f64>,
    /// Place with load, in the tracker's frame. m
    pub loaded: Vector3<f64>,
    /// How the body turned under load: rotation vector in the tracker's frame. rad. Only in sheets of full poses.
    pub turn: Option<Vector3<f64>>,
}

/// A measurement sheet.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sheet {
    /// Names of the reference points, in the order of their first reading.
    pub points: Vec<String>,
    /// The configurations, in the order of their first reading.
    pub configurations: Vec<Configuration>,
    /// The readings, configuration by configuration.
    pub readings: Vec<Reading>,
}

impl Sheet {
    /// Whether every reading has an orientation too.
    pub fn is_full_pose(&self) -> bool {
        !self.readings.is_empty() && self.readings.iter().all(|reading| reading.turn.is_some())
    }

    /// Scalar equations that one reading gives: three, or six with an orientation.
    pub fn rows_per_reading(&self) -> usize {
        if self.is_full_pose() { 6 } else { 3 }
    }
}

/// The columns of a sheet without orientations, as `stead identify fit` reads them.
pub const COLUMNS: &str = "configuration,theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,theta6_deg,\
                           force_x_n,force_y_n,force_z_n,moment_x_nm,moment_y_nm,moment_z_nm,point,\
                           unloaded_x_mm,unloaded_y_mm,unloaded_z_mm,loaded_x_mm,loaded_y_mm,loaded_z_mm";

impl Sheet {
    /// The sheet as CSV with [`COLUMNS`]: so many decimals of places in mm, all digits of angles and wrench; names must
    /// have no comma or quote in them. Orientations are left out.
    pub fn csv(&self, decimals: usize) -> String {
        self.text(|reading| {
            let read = reading.unloaded.iter().chain(&reading.loaded);
            read.map(|value| format!("{:.decimals$}", value * 1e3)).collect::<Vec<_>>().join(",")
        })
    }

    /// The same with the places left empty: a form to be filled in.
    pub fn form(&self) -> String {
        self.text(|_| ",".repeat(5))
    }

    fn text(&self, read: impl Fn(&Reading) -> String) -> String {
        let mut text = format!("{COLUMNS}\n");
        for reading in &self.readings {
            let Configuration { name, theta, force, moment, .. } = &self.configurations[reading.configuration];
            let angles = theta.iter().map(|angle| angle.to_degrees());
            let given: Vec<String> = angles
                .chain(force.iter().copied())
                .chain(moment.iter().copied())
                // Sums of rounding from the unit are beyond the ninth decimal.
                .map(|value| ((value * 1e9).round() / 1e9 + 0.0).to_string())
                .collect();
            let point = &self.points[reading.point];
            text += &format!("{name},{},{point},{}\n", given.join(","), read(reading));
        }
        text
    }
}
