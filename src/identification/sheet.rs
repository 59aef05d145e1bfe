//! What was measured: configurations under load, and readings of reference points without and with the load.

use nalgebra::Vector3;
use std::ops::Range;

/// One configuration of the arm and the load that was put on it.
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, PartialEq)]
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
