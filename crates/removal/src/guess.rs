//! The stock that a path is for, guessed from the path: how deep it cuts, where its own levels and rows say so.

use crate::error::ForcesError;
use crate::forces::Run;
use crate::moves::{MoveKind, PathMoves, has_wall};
use crate::operation::{EndMill, ForcesProblem, Operation, PathStock, Stock};
use crate::points::Loads;
use crate::sums::Requested;
use nalgebra::Vector3;
use stead_cell::Solid;
use stead_model::robot::Pose;
use stead_model::task::ToolPath;
use stead_numerics::monitor::Monitor;

/// Stock from a path, and from what it is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StockGuess {
    /// The stock: either a depth or a layer.
    pub stock: PathStock,
    /// What tells it.
    pub told_by: ToldBy,
}

/// What tells the stock of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToldBy {
    /// Earlier moves of the path end most cuts: its levels, faces or rows.
    Levels,
    /// Nothing: a round corner or a turning axis finishes what an operation before has left.
    Finish,
    /// Nothing: the height of its lowest plunge.
    Plunge,
    /// Nothing: a share of the diameter.
    Diameter,
}

impl ToldBy {
    /// In words, for a comment beside the value.
    pub fn words(self) -> &'static str {
        match self {
            Self::Levels => "the path's own levels",
            Self::Finish => "what the operation before left",
            Self::Plunge => "one level, so its depth is not in the path: as high as it plunges at feed",
            Self::Diameter => "one level, so its depth is not in the path: a quarter of the diameter",
        }
    }
}

/// Cells of the cut that looks for levels, over the diameter.
const CELLS: f64 = 10.0;
/// The block of that cut is so many diameters higher than the path, along the tool axes.
const ABOVE: f64 = 2.0;
/// A cut that ends higher than so many diameters is not ended by the path.
const DECIDED: f64 = 1.5;
/// Share of the scored points that cut, at which the path decides the depth.
const ENOUGH: f64 = 0.3;
/// A corner of at least this share of the diameter finishes.
const ROUND: f64 = 0.25;
/// A layer, where nothing is known of it. m
const LAYER: f64 = 0.5e-3;
/// The largest depth by a plunge, and that without one, over the diameter.
const DEPTHS: [f64; 2] = [0.5, 0.25];
/// Tool axes that differ by more turn. rad
const TURNS: f64 = 1e-3;
/// Memory for that cut. bytes
const MEMORY: f64 = 1e9;

/// Guesses the stock of a path that a cutter takes.
///
/// The path cuts a block that is higher than any cut: where earlier moves end the cut well below its top, they decide
/// how deep it is.
///
/// # Errors
/// [`ForcesError`]: a path that is too large for the memory, a stop.
pub fn stock_of(path: &ToolPath, mill: &EndMill, monitor: &Monitor) -> Result<StockGuess, ForcesError> {
    let operation = Operation {
        name: "the path".to_owned(),
        path: path.clone(),
        rapids: Vec::new(),
        mill: mill.clone(),
        spindle_speed: 1.0,
    };
    let diameter = mill.cutter.diameter();
    let depth =
        |depth: f64, told_by| StockGuess { stock: PathStock { depth: Some(rounded(depth)), layer: None }, told_by };
    if let Some(levels) = levels(&operation, monitor)? {
        return Ok(depth(levels, ToldBy::Levels));
    }
    if mill.corner_radius >= ROUND * diameter - 1e-9 || turns(path) {
        let most = if mill.corner_radius > 0.0 { mill.corner_radius } else { diameter / 2.0 };
        let layer = Some(LAYER.min(most / 2.0));
        return Ok(StockGuess { stock: PathStock { depth: None, layer }, told_by: ToldBy::Finish });
    }
    let plunge = plunges(&operation).into_iter().fold(f64::INFINITY, f64::min);
    let [most, without] = DEPTHS.map(|share| share * diameter);
    Ok(if plunge.is_finite() { depth(plunge.min(most), ToldBy::Plunge) } else { depth(without, ToldBy::Diameter) })
}

/// The depth of the cuts that the path itself ends, where they are many: their median. m
fn levels(operation: &Operation, monitor: &Monitor) -> Result<Option<f64>, ForcesError> {
    let (path, diameter) = (&operation.path, operation.mill.cutter.diameter());
    let [low, high] = block(path, diameter);
    let pose = Pose { translation: (low + high) / 2.0, ..Pose::identity() };
    let problem = ForcesProblem {
        stock: Stock::Solid { solid: Solid::Box(high - low), pose },
        before: Vec::new(),
        operation: operation.clone(),
        finished_part: None,
        cell: None,
        memory: MEMORY,
    };
    let cell = diameter / CELLS;
    let stage = "cutting a block, to see how deep the path cuts";
    let run = match Run::new(&problem, cell, None, Requested::Forces, stage, monitor) {
        Err(ForcesError::Stopped(stop)) => return Err(stop.into()),
        // What cannot be cut so tells nothing.
        Err(_) => return Ok(None),
        Ok(run) => run,
    };
    let loads = Loads { path: &run.path, found: &run.found };
    let scored = (0..path.points().len()).filter(|point| path.is_scored(*point));
    let tops: Vec<(usize, f64)> = scored
        .filter_map(|point| Some((point, loads.at_point(point).heights?[1])))
        .filter(|(_, top)| *top > 0.0)
        .collect();
    // How high the block is over a point, along the tool axis.
    let room = |point: usize| {
        let at = path.points()[point];
        let to_face = |k: usize| {
            let face = if at.axis[k] > 0.0 { high[k] } else { low[k] };
            if at.axis[k].abs() < 1e-9 { f64::INFINITY } else { (face - at.position[k]) / at.axis[k] }
        };
        (0..3).map(to_face).fold(f64::INFINITY, f64::min)
    };
    let is_decided = |(point, top): &&(usize, f64)| *top < DECIDED * diameter && *top < room(*point) - 2.0 * cell;
    let mut decided: Vec<f64> = tops.iter().filter(is_decided).map(|(_, top)| *top).collect();
    decided.sort_by(f64::total_cmp);
    let is_enough = !decided.is_empty() && decided.len() as f64 >= ENOUGH * tops.len() as f64;
    Ok(is_enough.then(|| decided[decided.len() / 2]))
}

/// A block about the scored points, with room for the cutter beside them and for any cut above. m
fn block(path: &ToolPath, diameter: f64) -> [Vector3<f64>; 2] {
    let scored = path.points().iter().enumerate().filter(|(number, _)| path.is_scored(*number));
    let ends = scored.flat_map(|(_, point)| [point.position, point.position + point.axis * (ABOVE * diameter)]);
    let whole = ends.fold(None, |known: Option<[Vector3<f64>; 2]>, at| {
        Some(known.map_or([at, at], |[low, high]| [low.inf(&at), high.sup(&at)]))
    });
    let beside = Vector3::repeat(diameter);
    let [low, high] = whole.unwrap_or_default();
    [low - beside, high + beside]
}

/// Whether the tool axis turns from one scored point to the next.
fn turns(path: &ToolPath) -> bool {
    let pairs = path.segments().iter().flat_map(|range| range.clone().skip(1));
    let mut scored = pairs.filter(|point| path.is_scored(*point) && path.is_scored(point - 1));
    scored.any(|point| {
        let [before, here] = [point - 1, point].map(|point| path.points()[point].axis);
        before.cross(&here).norm() > TURNS
    })
}

/// The heights of plunges at feed down to where a cut begins. m
fn plunges(operation: &Operation) -> Vec<f64> {
    let path = &operation.path;
    let moves = PathMoves::new(operation, LAYER).moves;
    let mut heights = Vec::new();
    let mut height = 0.0;
    for one in moves.iter().filter(|one| one.kind == MoveKind::Feed) {
        let down = -one.by.dot(&one.axis);
        if !has_wall(path, one.point as usize) && down > 0.0 {
            height += down;
        } else {
            heights.extend(Some(height).filter(|height| *height > 0.0));
            height = 0.0;
        }
    }
    heights
}

/// To a twentieth of a millimetre, as a depth is written. m
fn rounded(metres: f64) -> f64 {
    ((metres * 2e4).round() / 2e4).max(5e-5)
}
