//! The job: forces at every point of a path.

use crate::cutting::Tool;
use crate::error::ForcesError;
use crate::kept::CutResult;
use crate::load::Sums;
use crate::memory;
use crate::moves::{PathMoves, window_for};
use crate::operation::{EndMill, ForcesProblem, Operation};
use crate::outcome::{ForcesDifference, RemovalForces};
use crate::points::{Loads, points_between};
use crate::removal::Workpiece;
use crate::solid_lines::Body;
use crate::sums::{Found, Requested};
use crate::surface::{Surface, surface};
use stead_cell::Solid;
use stead_numerics::monitor::Monitor;

/// Of the cells of the first run, over the diameter of the cutter.
const FIRST: f64 = 12.0;
/// Of the cells of the last one.
const LAST: f64 = 24.0;
/// Of the finest cells that are taken without being asked for, and of those where plunges take more force than all
/// other cuts.
const FINEST: f64 = 100.0;
/// Of the width of a cut by a round corner.
const ROUND: f64 = 10.0;
/// Share of the force along the path that may be of cuts less deep than the cells are made for.
const SHALLOW: f64 = 0.05;
/// More lines than this share that are no body's are refused.
const UNSOUND: f64 = 1e-6;

/// Mean force and moment over a turn at every point of the path of an operation.
///
/// # Errors
/// [`ForcesError`]: a stock that is not closed, one that the path does not touch, cells that are too small for the
/// memory, a stop.
pub fn forces(problem: &ForcesProblem, monitor: &Monitor) -> Result<RemovalForces, ForcesError> {
    cut(problem, monitor)?.forces(problem)
}

/// What cutting along the path of an operation gives, which is what takes long of [`forces`].
///
/// # Errors
/// Those of [`forces`].
pub fn cut(problem: &ForcesProblem, monitor: &Monitor) -> Result<CutResult, ForcesError> {
    let operation = &problem.operation;
    if operation.path.feed(0).is_none() {
        return Err(ForcesError::NoFeeds(operation.name.clone()));
    }
    if let Some(cell) = problem.cell {
        memory::check(problem, &Body::of_stock(problem, cell)?.extent, cell)?;
    }
    let diameter = operation.mill.cutter.diameter();
    let mut first = None;
    let cell = match problem.cell {
        Some(cell) => cell,
        None => {
            let stage = "cutting, to choose the cell";
            let run = Run::new(problem, diameter / FIRST, None, Requested::Forces, stage, monitor)?;
            let cell = run.cell_for(operation);
            first = Some(run);
            cell
        }
    };
    let window = window_for(cell);
    // The first run is that with cells twice as large, where they are.
    let known = first.filter(|run| (run.workpiece.cell - 2.0 * cell).abs() < 1e-12 && run.path.window == window);
    let stage = "cutting with cells twice as large";
    // Of that its sums alone are kept.
    let Run { path, found, .. } = match known {
        Some(run) => run,
        None => Run::new(problem, 2.0 * cell, Some(window), Requested::Forces, stage, monitor)?,
    };
    let fine = Run::new(problem, cell, Some(window), Requested::Turns, "cutting", monitor)?;
    Ok(fine.result(operation, &Loads { path: &path, found: &found }))
}

/// A run through all operations with one size of cell.
pub(crate) struct Run {
    workpiece: Workpiece,
    /// The surface of the stock before the operation, where turns are asked for: of the last run.
    before: Surface,
    /// Likewise what those before it have removed, by lines along each axis. m3
    removed_before: [f64; 3],
    pub path: PathMoves,
    pub found: Found,
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
        let body = Body::of_stock(problem, cell)?;
        let part = match &problem.finished_part {
            Some((mesh, pose)) => Some(Body::new(&Solid::Mesh(mesh.clone()), pose, cell).ok_or(ForcesError::Form)?),
            None => None,
        };
        memory::check(problem, &body.extent, cell)?;
        let diagonal = (body.extent[1] - body.extent[0]).norm();
        let tool = |mill: &EndMill| Tool::new(mill, diagonal);
        let mut workpiece = Workpiece::new(body, part, cell);
        let window = window.unwrap_or(window_for(cell));
        for before in &problem.before {
            let path = PathMoves::new(before, window);
            workpiece.cut(&tool(&before.mill), &path, Requested::Removal, "cutting what is cut before", monitor)?;
        }
        let (before, removed_before) = match requested {
            Requested::Turns => (surface(&workpiece), workpiece.removed().map(|(_, volume)| volume)),
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
        Ok(Self { workpiece, before, removed_before, path, found })
    }

    /// The distance of lines with which forces are good: a share of the diameter, and no more than the depth of the
    /// cut along legs with a wall, or, where a round corner cuts all of it, than a share of the width that it cuts at
    /// that depth. m
    fn cell_for(&self, operation: &Operation) -> f64 {
        let force = |sums: &Sums| (sums.chip.force + sums.edge.force).norm();
        let cuts = |has_wall: bool| {
            let legs = self.path.legs.iter().filter(move |leg| leg.has_wall == has_wall);
            let nodes = legs.flat_map(|leg| &self.found.sums[leg.nodes.first..=leg.nodes.first + leg.nodes.intervals]);
            nodes.filter(|sums| sums.volume > 0.0)
        };
        let of_plunges: f64 = cuts(false).map(force).sum();
        let mut tops: Vec<[f64; 2]> = cuts(true).map(|sums| [sums.heights[1], force(sums)]).collect();
        tops.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let of_walls: f64 = tops.iter().map(|[_, force]| force).sum();
        let mut below = 0.0;
        let is_deep = |[_, force]: &&[f64; 2]| {
            below += force;
            below > SHALLOW * of_walls
        };
        let depth = tops.iter().find(is_deep).map_or(f64::INFINITY, |[top, _]| *top);
        let (mill, diameter) = (&operation.mill, operation.mill.cutter.diameter());
        let round = mill.corner_radius * (1.0 - libm::sin(mill.taper));
        let width = if depth < round {
            (2.0 * mill.corner_radius * depth - depth * depth).sqrt() / ROUND
        } else {
            f64::INFINITY
        };
        let last = if of_plunges > of_walls { FINEST } else { LAST };
        let cell = (diameter / last).min(depth).min(width);
        cell.max(diameter / FINEST)
    }

    fn result(self, operation: &Operation, coarse: &Loads<'_>) -> CutResult {
        let fine = Loads { path: &self.path, found: &self.found };
        let at_points =
            |loads: &Loads<'_>| (0..operation.path.points().len()).map(|point| loads.at_point(point)).collect();
        let (loads, rough): (Vec<_>, Vec<_>) = (at_points(&fine), at_points(coarse));
        // By the axis along which most lines were cut: walls are thin along the others, or floors.
        let volumes = self.workpiece.removed().into_iter().zip(self.removed_before);
        let most = volumes.max_by_key(|((lines, _), _)| *lines);
        CutResult {
            cell: self.workpiece.cell,
            difference: ForcesDifference::between(&loads, &rough),
            removed: most.map_or(0.0, |((_, volume), before)| volume - before),
            added: points_between(&operation.path, &loads, &fine),
            loads,
            stock: [self.before, surface(&self.workpiece)],
            events: self.found.events,
        }
    }
}

#[cfg(test)]
mod tests;
