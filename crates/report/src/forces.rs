//! Reports of forces from a path: the task with forces, `engagement.csv`, a picture, a page, the stock that is left, a
//! JSON document, and a table for people.

mod page;

use super::output::ReportError;
use super::picture;
use super::{Files, named};
use crate::columns::table;
use crate::csv_file::rows;
use crate::document::{Document, bytes};
use crate::figure::{
    AngleDeg, Direction, ForceN, HeightUm, MomentNm, Percent, PlaceMm, PowerKw, RateCm3PerMin, RemovalMm2, SpeedMmPerS,
    TaskMm, VolumeMm3, some,
};
use crate::units::fixed;
use nalgebra::Vector3;
use serde_json::Value;
use std::fmt::Write;
use stead_model::task::{PathPoint, Wrench};
use stead_removal::cut::CutFigures;
use stead_removal::load::PointForces;
use stead_removal::outcome::{ForcesDifference, RemovalForces};
use stead_removal::surface::Surface;
use stead_runs::ForcesRun;

/// The endings of the names of the files of forces from a path; the task first, which has none.
pub const ENDINGS: [&str; 7] =
    ["", "-engagement.csv", "-forces.svg", "-forces.html", "-stock-before.stl", "-stock-after.stl", "-forces.json"];

/// The files of forces from a path, by their [`ENDINGS`].
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn forces_files(run: &ForcesRun, forces: &RemovalForces) -> Result<Files, ReportError> {
    let files = [
        task(forces)?,
        engagement(forces)?,
        picture::charts(&page::charts(forces)).into_bytes(),
        page::page(run, forces).html(),
        stl(&forces.stock[0]),
        stl(&forces.stock[1]),
        bytes(&forces_json(run, forces)),
    ];
    Ok(named(ENDINGS.into_iter().zip(files)))
}

records! {
    /// A point of a task with forces, in the workpiece frame; a file that `stead place` and the others read.
    pub struct ForceTaskRow of (segment: usize, point: &PathPoint, normal: Option<&Vector3<f64>>, wrench: &Wrench, feed: f64, is_scored: bool) {
        /// Segment, from 1.
        segment: usize = segment,
        /// x of the tool centre point.
        x_mm: TaskMm = point.position.x.into(),
        /// y of it.
        y_mm: TaskMm = point.position.y.into(),
        /// z of it.
        z_mm: TaskMm = point.position.z.into(),
        /// x of the feed direction.
        feed_x: Direction = point.feed.x.into(),
        /// y of it.
        feed_y: Direction = point.feed.y.into(),
        /// z of it.
        feed_z: Direction = point.feed.z.into(),
        /// x of the tool axis, from the workpiece to the spindle.
        axis_x: Direction = point.axis.x.into(),
        /// y of it.
        axis_y: Direction = point.axis.y.into(),
        /// z of it.
        axis_z: Direction = point.axis.z.into(),
        /// x of the normal of the surface, where the path states it.
        normal_x?: Direction = normal.map(|normal| normal.x.into()),
        /// y of it.
        normal_y?: Direction = normal.map(|normal| normal.y.into()),
        /// z of it.
        normal_z?: Direction = normal.map(|normal| normal.z.into()),
        /// x of what the workpiece does to the tool: the mean force over a turn.
        force_x_n: ForceN = wrench.force.x.into(),
        /// y of it.
        force_y_n: ForceN = wrench.force.y.into(),
        /// z of it.
        force_z_n: ForceN = wrench.force.z.into(),
        /// x of the mean moment about the tool centre point.
        moment_x_nm: MomentNm = wrench.moment.x.into(),
        /// y of it.
        moment_y_nm: MomentNm = wrench.moment.y.into(),
        /// z of it.
        moment_z_nm: MomentNm = wrench.moment.z.into(),
        /// Feed of the move to the point.
        feed_mm_per_s: SpeedMmPerS = feed.into(),
        /// 0 for a point that is followed but not scored: its force is stated, and has no part in a score.
        scored: u8 = is_scored.into(),
    }

    /// What is cut at a point of the path. Forces and moments are means over a turn of what the workpiece does to the
    /// tool, in the workpiece frame, moments about the tool centre point, in two parts: at the share s of the
    /// programmed feed the force is s times that of the chips, and that of the edges.
    pub struct EngagementRow of (index: usize, segment: usize, along: f64, is_scored: bool, load: &PointForces) {
        /// Path point, from 0.
        point: usize = index,
        /// Segment, from 1.
        segment: usize = segment,
        /// Length of path to it.
        along_mm: PlaceMm = along.into(),
        /// 0 for a point that is followed but not scored: its forces are stated, and have no part in a score.
        scored: u8 = is_scored.into(),
        /// 1 for a point that was added, where a straight line between two misses the force by more than 10 %.
        added: u8 = load.is_added.into(),
        /// The part of the force that grows with the feed.
        chip_force: ForceColumns = load.chip.force.into(),
        /// The part of the edges, which does not.
        edge_force: ForceColumns = load.edge.force.into(),
        /// The part of the moment that grows with the feed.
        chip_moment: MomentColumns = load.chip.moment.into(),
        /// The part of the edges.
        edge_moment: MomentColumns = load.edge.moment.into(),
        /// Norm of the mean force.
        force_n: ForceN = load.at_feed(1.0).force.norm().into(),
        /// Largest norm of the force over a turn, within 15 %.
        largest_n: ForceN = load.largest.into(),
        /// Removed volume over length of path.
        removed_mm3_per_mm: RemovalMm2 = load.removed.into(),
        /// Lowest height above the tool centre point that cuts; empty where nothing does, as what follows.
        lowest_mm: Option<PlaceMm> = load.heights.map(|heights| heights[0].into()),
        /// Highest height that cuts.
        highest_mm: Option<PlaceMm> = load.heights.map(|heights| heights[1].into()),
        /// Angle at which a tooth enters, 0 where it moves along the feed, in the sense of rotation.
        entry_deg: Option<AngleDeg> = load.angles.map(|angles| angles[0].into()),
        /// Angle at which a tooth leaves.
        exit_deg: Option<AngleDeg> = load.angles.map(|angles| angles[1].into()),
        /// Thickest chip.
        chip_um: HeightUm = load.chip_thickness.into(),
    }

    /// A part of the force in a row.
    pub struct ForceColumns from force: Vector3<f64> {
        /// Along x, of the part that the name begins with.
        x_n: ForceN = force.x.into(),
        /// Along y.
        y_n: ForceN = force.y.into(),
        /// Along z.
        z_n: ForceN = force.z.into(),
    }

    /// A part of the moment in a row.
    pub struct MomentColumns from moment: Vector3<f64> {
        /// About x, of the part that the name begins with.
        x_nm: MomentNm = moment.x.into(),
        /// About y.
        y_nm: MomentNm = moment.y.into(),
        /// About z.
        z_nm: MomentNm = moment.z.into(),
    }

    /// What the scored points of a path cut, in a few figures.
    pub struct CutRecord from cut: &CutFigures {
        /// Axial depth that half of the points do not exceed.
        depth_mm: PlaceMm = cut.depths[0].into(),
        /// Axial depth that 95 of 100 points do not exceed.
        depth_95_mm: PlaceMm = cut.depths[1].into(),
        /// Largest axial depth.
        deepest_mm: PlaceMm = cut.depths[2].into(),
        /// The point of it, from 0.
        deepest_point: usize = cut.deepest,
        /// Diameter of the cutter.
        diameter_mm: PlaceMm = cut.diameter.into(),
        /// Length of its flutes.
        flutes_mm: PlaceMm = cut.flutes.into(),
        /// Section of what is cut, across the feed, in the mean.
        section_mm2: RemovalMm2 = cut.section.mean.into(),
        /// The largest.
        max_section_mm2: RemovalMm2 = cut.section.max.into(),
        /// Share of the points at which the cutter is in a full slot.
        full_slot_percent: Percent = cut.slot.into(),
        /// Thickest chip that half of the points do not exceed.
        chip_um: HeightUm = cut.chip.into(),
        /// Mean norm of the force.
        force_n: ForceN = cut.force.mean.into(),
        /// The largest.
        max_force_n: ForceN = cut.force.max.into(),
        /// Largest moment about the axis of the spindle.
        torque_nm: MomentNm = cut.torque.max.into(),
        /// Mean power of the spindle.
        power_kw: PowerKw = cut.power.mean.into(),
        /// The largest.
        max_power_kw: PowerKw = cut.power.max.into(),
        /// Volume cut in a minute, in the mean.
        removed_cm3_per_min: RateCm3PerMin = cut.rate.into(),
        /// Share of the length of scored path on which nothing is cut.
        air_percent: Percent = cut.air.into(),
    }

    /// Forces along a path, in figures.
    pub struct ForcesFigures from forces: &RemovalForces {
        let all = || forces.points.iter().map(|point| point.at_feed(1.0));
        let largest = |of: fn(&Wrench) -> f64| all().map(|wrench| of(&wrench)).fold(0.0, f64::max);
        let scored = || (0..forces.points.len()).filter(|point| forces.path.is_scored(*point));
        let cutting = || scored().filter(|point| forces.points[*point].heights.is_some());
        let sum: f64 = cutting().map(|point| forces.points[point].at_feed(1.0).force.norm()).sum();
        let count = cutting().count();
    } with {
        /// Points of the task.
        points: usize = forces.points.len(),
        /// Those that were added.
        added: usize = forces.points.iter().filter(|point| point.is_added).count(),
        /// Those that are scored.
        scored: usize = scored().count(),
        /// Share of the length of scored path on which nothing is cut.
        air_percent: Percent = forces.air.into(),
        /// Distance of the lines that the stock is held by.
        cell_mm: PlaceMm = forces.cell.into(),
        /// What is cut; null where nothing is.
        cut: Option<CutRecord> = forces.cut.as_ref().map(Into::into),
        /// Volume that the path removes.
        removed_mm3: VolumeMm3 = forces.removed.into(),
        /// Mean norm of the force of the scored points that cut; null where none does.
        mean_force_n: Option<ForceN> = some((count > 0).then(|| sum / count as f64)),
        /// Largest norm of a mean force.
        max_force_n: ForceN = largest(|wrench| wrench.force.norm()).into(),
        /// Largest norm of a mean moment.
        max_moment_nm: MomentNm = largest(|wrench| wrench.moment.norm()).into(),
        /// Largest norm of the force within a turn.
        max_in_turn_n: ForceN = forces.points.iter().map(|point| point.largest).fold(0.0, f64::max).into(),
        /// How far lines twice as far apart are off, over the largest force and moment of the path.
        doubled_cell: DifferenceFigures = (&forces.difference).into(),
    }

    /// A difference of forces and moments over the largest of the path.
    pub struct DifferenceFigures from difference: &ForcesDifference {
        /// Root mean square of the force.
        force_rms_percent: Percent = difference.rms[0].into(),
        /// Largest of the force.
        force_max_percent: Percent = difference.largest[0].into(),
        /// Root mean square of the moment.
        moment_rms_percent: Percent = difference.rms[1].into(),
        /// Largest of the moment.
        moment_max_percent: Percent = difference.largest[1].into(),
    }
}

/// The task: a [`ForceTaskRow`] for each point. Forces of points that are not scored are stated too.
fn task(forces: &RemovalForces) -> Result<Vec<u8>, ReportError> {
    let path = &forces.path;
    let row = |index: usize| {
        let normal = path.surface_normals().map(|normals| &normals[index]);
        let wrench = forces.points[index].at_feed(1.0);
        let (segment, feed) = (path.segment_of(index) + 1, path.feed(index).unwrap_or_default());
        ForceTaskRow::of(segment, &path.points()[index], normal, &wrench, feed, path.is_scored(index))
    };
    rows("the task", (0..path.points().len()).map(row))
}

/// `engagement.csv`: an [`EngagementRow`] for each point.
fn engagement(forces: &RemovalForces) -> Result<Vec<u8>, ReportError> {
    let path = &forces.path;
    let along = page::along(forces);
    let row = |index: usize| {
        let segment = path.segment_of(index) + 1;
        EngagementRow::of(index, segment, along[index], path.is_scored(index), &forces.points[index])
    };
    rows("the table of the engagement", (0..forces.points.len()).map(row))
}

/// A surface as STL in text, in mm.
fn stl(surface: &Surface) -> Vec<u8> {
    let mut text = String::from("solid stock\n");
    for triangle in &surface.triangles {
        let corners = triangle.map(|number| surface.vertices[number as usize] * 1e3);
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let Some(normal) = normal.try_normalize(1e-12) else { continue };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "facet normal {:.4} {:.4} {:.4}\nouter loop", normal.x, normal.y, normal.z);
        for corner in corners {
            let _ = writeln!(text, "vertex {:.3} {:.3} {:.3}", corner.x, corner.y, corner.z);
        }
        text.push_str("endloop\nendfacet\n");
    }
    text.push_str("endsolid stock\n");
    text.into_bytes()
}

/// What `stead forces --json` prints, and the content of the JSON file.
pub fn forces_json(run: &ForcesRun, forces: &RemovalForces) -> Value {
    Document::new(&run.inputs)
        .notes(&run.notes)
        .notes(&forces.notes)
        .warnings(&forces.warnings)
        .with(ForcesFigures::from(forces))
}

/// A column of the table for people: its value, and decimals.
type Column = (fn(&PointForces) -> f64, usize);

/// The table for people.
pub fn forces_text(run: &ForcesRun, forces: &RemovalForces) -> String {
    let name = &run.problem.operation.name;
    let figures = ForcesFigures::from(forces);
    let mut text =
        format!("{name}: {} points, {} of them added, {} scored\n\n", figures.points, figures.added, figures.scored);
    let header = ["", "force N", "moment N m", "in a turn N", "removed mm3/mm", "height mm", "chip um"];
    let mut rows = Vec::new();
    let scored: Vec<&PointForces> = (0..forces.points.len())
        .filter(|point| forces.path.is_scored(*point) && forces.points[*point].heights.is_some())
        .map(|point| &forces.points[point])
        .collect();
    let of: [Column; 6] = [
        (|load| load.at_feed(1.0).force.norm(), 1),
        (|load| load.at_feed(1.0).moment.norm(), 3),
        (|load| load.largest, 1),
        (|load| load.removed * 1e6, 3),
        (|load| load.heights.map_or(0.0, |heights| heights[1] * 1e3), 3),
        (|load| load.chip_thickness * 1e6, 2),
    ];
    let mean = |of: fn(&PointForces) -> f64| scored.iter().map(|load| of(load)).sum::<f64>() / scored.len() as f64;
    let most = |of: fn(&PointForces) -> f64| scored.iter().map(|load| of(load)).fold(0.0, f64::max);
    if !scored.is_empty() {
        for (name, value) in [("mean", &mean as &dyn Fn(fn(&PointForces) -> f64) -> f64), ("largest", &most)] {
            let cells = of.iter().map(|(of, decimals)| fixed(value(*of), *decimals));
            rows.push(std::iter::once(name.to_owned()).chain(cells).collect());
        }
    }
    text.push_str(&table(header, rows, &[0]));
    let _ = writeln!(
        text,
        "\nof scored points that cut; {} % of the scored length cuts nothing; {} mm3 removed",
        fixed(forces.air * 100.0, 1),
        fixed(forces.removed * 1e9, 0)
    );
    let lines = forces.cut.map(|cut| cut.lines());
    lines.into_iter().flatten().zip(["cut", ""]).for_each(|(line, about)| {
        let _ = writeln!(text, "{about:<5}{line}");
    });
    text
}
