//! The job: forces of a tool that leans otherwise than its path states.

use crate::error::ForcesError;
use crate::forces::Run;
use crate::load::PointForces;
use crate::moves::window_for;
use crate::operation::{ForcesProblem, Operation};
use crate::outcome::RemovalForces;
use crate::points::Loads;
use crate::sums::Requested;
use stead_model::task::{ToolPath, Wrench};
use stead_numerics::monitor::Monitor;

/// Mean force and moment at every point of paths that are that of an operation with the tool leaning, tip and axis of
/// it at each of the points that [`forces`](crate::forces::forces) has found.
///
/// Each path is cut by itself into the stock as it is before the operation; what is known changes by as much as its
/// loads differ from those of the path as it is, so that a tool that does not lean has the forces that are known.
///
/// # Errors
/// [`ForcesError`]: a path that does not touch the stock, cells too small for the memory, a stop.
pub fn leaning_forces(
    problem: &ForcesProblem,
    known: &RemovalForces,
    paths: &[ToolPath],
    monitor: &Monitor,
) -> Result<Vec<Vec<PointForces>>, ForcesError> {
    let upright = loads(problem, known, &known.path, monitor)?;
    let of_path = |path: &ToolPath| {
        let leaning = loads(problem, known, path, monitor)?;
        let points = known.points.iter().zip(leaning.iter().zip(&upright));
        let at = |(known, (own, upright)): (&PointForces, (&PointForces, &PointForces))| PointForces {
            chip: shifted(&known.chip, &own.chip, &upright.chip),
            edge: shifted(&known.edge, &own.edge, &upright.edge),
            ..*own
        };
        Ok(points.map(at).collect())
    };
    paths.iter().map(of_path).collect()
}

/// A wrench changed by as much as another differs from a third.
fn shifted(known: &Wrench, to: &Wrench, from: &Wrench) -> Wrench {
    Wrench { force: known.force + (to.force - from.force), moment: known.moment + (to.moment - from.moment) }
}

/// The loads at the points of a path on the cells of what is known.
fn loads(
    problem: &ForcesProblem,
    known: &RemovalForces,
    path: &ToolPath,
    monitor: &Monitor,
) -> Result<Vec<PointForces>, ForcesError> {
    let operation = Operation { path: path.clone(), ..problem.operation.clone() };
    let problem = ForcesProblem { operation, finished_part: None, ..problem.clone() };
    let (cell, window) = (known.cell, window_for(known.cell));
    let stage = "cutting with a leaning tool";
    let run = Run::new(&problem, cell, Some(window), Requested::Forces, stage, monitor)?;
    let loads = Loads { path: &run.path, found: &run.found };
    Ok((0..known.points.len()).map(|point| loads.at_point(point)).collect())
}
