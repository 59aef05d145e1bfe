//! The job: forces at every point of a path.

use crate::cutting::Tool;
use crate::moves::PathMoves;
use crate::operation::{EndMill, ForcesProblem, Operation};
use crate::outcome::{ForcesDifference, RemovalForces};
use crate::points::{Loads, added_points};
use crate::removal::Workpiece;
use crate::solid_lines::Body;
use crate::sums::{Found, Requested};
use crate::surface::{Surface, surface};
use crate::warnings::{place, warnings};
use nalgebra::Vector3;
use stead_cell::Solid;
use stead_model::task::TaskError;
use stead_numerics::monitor::{Monitor, Stop};

/// Why there are no forces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForcesError {
    /// The stock is a form that it cannot be.
    #[error("the stock and the finished part are boxes, cylinders or closed meshes")]
    Form,
    /// The stock is too long.
    #[error("the stock is {length} m long: at most {most} m", most = LARGEST)]
    Large {
        /// Its longest side. m
        length: f64,
    },
    /// The surface of the stock is not closed, or crosses itself.
    #[error("the surface of the stock is no closed one: {share:.1e} of the lines through it do not go in and out in turn, as at {}", place(.at))]
    Open {
        /// Share of such lines.
        share: f64,
        /// Where one of them begins. m
        at: Vector3<f64>,
    },
    /// A path without feeds.
    #[error("the path of {0} has no feeds")]
    NoFeeds(String),
    /// Nothing is cut.
    #[error("the path never touches the stock")]
    Untouched,
    /// The lines do not fit into the memory.
    #[error("cells of {:.3} mm take {:.1} GB, more than the {:.1} GB allowed: {:.3} mm fits", .cell * 1e3, .needed / 1e9, .allowed / 1e9, .fits * 1e3)]
    Memory {
        /// The distance of lines. m
        cell: f64,
        /// What they take. bytes
        needed: f64,
        /// What they may take. bytes
        allowed: f64,
        /// A distance that fits. m
        fits: f64,
    },
    /// Points that were added make no path.
    #[error(transparent)]
    Path(#[from] TaskError),
    /// Stopped before it was done.
    #[error(transparent)]
    Stopped(#[from] Stop),
}

/// Coordinates of stock are nanometres in 32 bits. m
const LARGEST: f64 = 4.2;
/// Of the cells of the first run, over the diameter of the cutter.
const FIRST: f64 = 12.0;
/// Of the cells of the last one.
const LAST: f64 = 24.0;
/// Of the finest cells that are taken without being asked for.
const FINEST: f64 = 100.0;
/// Of the width of a cut by a round corner.
const ROUND: f64 = 10.0;
/// Share of the path that may be cut less deep than the cells are made for.
const SHALLOW: f64 = 0.05;
/// Lines of a tile and what goes with them. bytes
const TILE_BYTES: f64 = 1024.0 * 16.0 + 200.0;
/// More lines than this share that are no body's are refused.
const UNSOUND: f64 = 1e-6;

/// Mean force and moment over a turn at every point of the path of an operation.
///
/// # Errors
/// [`ForcesError`]: a stock that is not closed, one that the path does not touch, cells that are too small for the
/// memory, a stop.
pub fn forces(problem: &ForcesProblem, monitor: &Monitor) -> Result<RemovalForces, ForcesError> {
    let operation = &problem.operation;
    if operation.path.feed(0).is_none() {
        return Err(ForcesError::NoFeeds(operation.name.clone()));
    }
    let extent = problem.stock.solid.extent_at(&problem.stock.pose);
    let length = (extent[1] - extent[0]).max();
    if length > LARGEST {
        return Err(ForcesError::Large { length });
    }
    if let Some(cell) = problem.cell {
        check_memory(problem, &extent, cell)?;
    }
    let diameter = operation.mill.cutter.diameter();
    let mut first = None;
    let cell = match problem.cell {
        Some(cell) => cell,
        None => {
            let run =
                Run::new(problem, diameter / FIRST, None, Requested::Forces, "cutting, to choose the cell", monitor)?;
            let cell = run.cell_for(operation);
            first = Some(run);
            cell
        }
    };
    let window = window_for(cell);
    // The first run is that with cells twice as large, where they are.
    let known = first.filter(|run| (run.workpiece.cell() - 2.0 * cell).abs() < 1e-12 && run.path.window == window);
    // Of that its sums alone are kept.
    let Run { path, found, .. } = match known {
        Some(run) => run,
        None => Run::new(
            problem,
            2.0 * cell,
            Some(window),
            Requested::Forces,
            "cutting with cells twice as large",
            monitor,
        )?,
    };
    let fine = Run::new(problem, cell, Some(window), Requested::Turns, "cutting", monitor)?;
    fine.outcome(problem, &Loads { path: &path, found: &found })
}

/// Half the length of path that the load at a point is the mean of. m
pub(crate) fn window_for(cell: f64) -> f64 {
    (1.5 * cell).max(0.75e-3)
}

/// A run through all operations with one size of cell.
pub(crate) struct Run {
    workpiece: Workpiece,
    /// The surface of the stock before the operation, where turns are asked for: of the last run.
    before: Surface,
    /// Likewise what those before it have removed. m3
    removed_before: f64,
    pub path: PathMoves,
    pub found: Found,
    tool: Tool,
}

impl Run {
    pub fn new(
        problem: &ForcesProblem,
        cell: f64,
        window: Option<f64>,
        requested: Requested,
        stage: &'static str,
        monitor: &Monitor,
    ) -> Result<Self, ForcesError> {
        let body = Body::new(&problem.stock.solid, &problem.stock.pose, cell).ok_or(ForcesError::Form)?;
        let part = match &problem.finished_part {
            Some((mesh, pose)) => Some(Body::new(&Solid::Mesh(mesh.clone()), pose, cell).ok_or(ForcesError::Form)?),
            None => None,
        };
        check_memory(problem, &body.extent, cell)?;
        let diagonal = (body.extent[1] - body.extent[0]).norm();
        let tool = |mill: &EndMill| Tool::new(mill, diagonal);
        let mut workpiece = Workpiece::new(body, part, cell);
        let window = window.unwrap_or(window_for(cell));
        for before in &problem.before {
            let path = PathMoves::new(before, window);
            workpiece.cut(&tool(&before.mill), &path, Requested::Removal, "cutting what is cut before", monitor)?;
        }
        let (before, removed_before) = match requested {
            Requested::Turns => (surface(&workpiece), workpiece.removed(2)),
            Requested::Removal | Requested::Forces => Default::default(),
        };
        let (tool, path) = (tool(&problem.operation.mill), PathMoves::new(&problem.operation, window));
        let found = workpiece.cut(&tool, &path, requested, stage, monitor)?;
        let unsound = workpiece.unsound().filter(|(share, _)| *share > UNSOUND);
        if let Some((share, at)) = unsound {
            return Err(ForcesError::Open { share, at });
        }
        if !found.sums.iter().any(|sums| sums.volume > 0.0) {
            return Err(ForcesError::Untouched);
        }
        Ok(Self { workpiece, before, removed_before, path, found, tool })
    }

    /// The distance of lines with which forces are good: a share of the diameter, and no more than the depth of the
    /// cut, or, where a round corner cuts all of it, than a share of the width that it cuts at that depth. m
    fn cell_for(&self, operation: &Operation) -> f64 {
        let mut tops: Vec<f64> =
            self.found.sums.iter().filter(|sums| sums.volume > 0.0).map(|sums| sums.heights[1]).collect();
        tops.sort_by(f64::total_cmp);
        let depth = tops.get((tops.len() as f64 * SHALLOW) as usize).copied().unwrap_or(f64::INFINITY);
        let (mill, diameter) = (&operation.mill, operation.mill.cutter.diameter());
        let round = mill.corner_radius * (1.0 - libm::sin(mill.taper));
        let width = if depth < round {
            (2.0 * mill.corner_radius * depth - depth * depth).sqrt() / ROUND
        } else {
            f64::INFINITY
        };
        let cell = (diameter / LAST).min(depth).min(width);
        cell.max(diameter / FINEST)
    }

    fn outcome(self, problem: &ForcesProblem, coarse: &Loads<'_>) -> Result<RemovalForces, ForcesError> {
        let operation = &problem.operation;
        let loads = Loads { path: &self.path, found: &self.found };
        let points = operation.path.points().len();
        let fine: Vec<_> = (0..points).map(|point| loads.at_point(point)).collect();
        let rough: Vec<_> = (0..points).map(|point| coarse.at_point(point)).collect();
        let difference = ForcesDifference::between(&fine, &rough);
        let (path, points) = added_points(&operation.path, fine, &loads)?;
        let removed = self.workpiece.removed(2) - self.removed_before;
        let stock = [self.before, surface(&self.workpiece)];
        let cell = self.workpiece.cell();
        let mut all = RemovalForces {
            path,
            points,
            cell,
            difference,
            removed,
            air: 0.0,
            stock,
            warnings: Vec::new(),
            notes: Vec::new(),
        };
        warnings(&mut all, problem, &self.found, &self.tool);
        Ok(all)
    }
}

/// Refuses cells whose lines would not fit into the memory.
fn check_memory(problem: &ForcesProblem, extent: &[Vector3<f64>; 2], cell: f64) -> Result<(), ForcesError> {
    let operations = || problem.before.iter().chain([&problem.operation]);
    let widest = operations().map(|operation| operation.mill.cutter.diameter()).fold(0.0, f64::max);
    let places = operations().flat_map(|operation| operation.path.points()).map(|point| point.position);
    let about = places.fold(None, |known: Option<[Vector3<f64>; 2]>, at| {
        Some(known.map_or([at, at], |[low, high]| [low.inf(&at), high.sup(&at)]))
    });
    let Some([low, high]) = about else { return Ok(()) };
    // Above the path all of the stock may be met.
    let margin = Vector3::repeat(widest);
    let low = (low - margin).sup(&extent[0]);
    let high = (high + margin).inf(&extent[1]);
    let size = (high - low).sup(&Vector3::zeros());
    let tile = crate::lattice::TILE as f64;
    let needed = |cell: f64| {
        let tiles = |axis: usize| (size[axis] / (cell * tile)).ceil() + 1.0;
        (tiles(0) * tiles(1) + tiles(1) * tiles(2) + tiles(2) * tiles(0)) * TILE_BYTES
    };
    if needed(cell) <= problem.memory {
        return Ok(());
    }
    let mut fits = cell;
    while needed(fits) > problem.memory && fits < 1.0 {
        fits *= 1.01;
    }
    // Up, to a figure that can be typed.
    let fits = (fits * 1e6).ceil() / 1e6;
    Err(ForcesError::Memory { cell, needed: needed(cell), allowed: problem.memory, fits })
}

#[cfg(test)]
mod tests;
