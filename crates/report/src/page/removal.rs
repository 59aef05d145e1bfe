//! What a path removes of its stock, for the page: forces and engagement at every point, the stock before and after.

use super::body::BodyData;
use super::packed::{chosen_singles, singles};
use super::shapes::{BodyFrame, BodyMesh};
use super::thinned::thinned;
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use stead_problem::problem::Problem;
use stead_removal::load::PointForces;
use stead_removal::outcome::RemovalForces;
use stead_removal::surface::Surface;

/// Triangles of each stock at most.
const STOCK_TRIANGLES: usize = 4000;
records! {
    /// What the path removes of its stock: a number or a vector for each path point, also of those that are not scored;
    /// NaN where nothing is cut and there is no such number. Forces are means over a turn at the programmed feed.
    pub struct RemovalData of (problem: &Problem, removal: &RemovalForces) {
        // The frame of the task that the page has.
        let turned = problem.orientation().map_or(Matrix3::identity(), |orientation| orientation.rotation);
        let column = |of: &dyn Fn(&PointForces) -> f64| singles(removal.points.iter().map(of));
        let height = |k: usize| move |load: &PointForces| load.heights.map_or(f64::NAN, |heights| heights[k] * 1e3);
        let angle = |k: usize| move |load: &PointForces| load.angles.map_or(f64::NAN, |angles| angles[k].to_degrees());
        let force = |load: &PointForces| <[f64; 3]>::from(turned * load.at_feed(1.0).force);
    } with {
        /// What the workpiece does to the tool, in the directions of the path. N
        force_n: String = singles(removal.points.iter().flat_map(force)),
        /// Size of the part that grows with the feed. N
        chip_n: String = column(&|load| load.chip.force.norm()),
        /// Size of the part of the edges. N
        edge_n: String = column(&|load| load.edge.force.norm()),
        /// Largest size within a turn. N
        largest_n: String = column(&|load| load.largest),
        /// Size of the moment about the tool centre point. N m
        moment_nm: String = column(&|load| load.at_feed(1.0).moment.norm()),
        /// Removed volume over length of path. mm3/mm
        removed_mm3_per_mm: String = column(&|load| load.removed * 1e6),
        /// Lowest height above the tool centre point that cuts. mm
        lowest_mm: String = column(&height(0)),
        /// Highest one. mm
        highest_mm: String = column(&height(1)),
        /// Angle at which a tooth enters. deg
        entry_deg: String = column(&angle(0)),
        /// Angle at which it leaves. deg
        exit_deg: String = column(&angle(1)),
        /// Thickest chip. um
        chip_um: String = column(&|load| load.chip_thickness * 1e6),
        /// The stock before the path and after it, of at most 4000 triangles each.
        stock: [BodyData; 2] = [0, 1].map(|k| (&stock(STOCKS[k], &removal.stock[k], &turned)).into()),
    }
}

const STOCKS: [&str; 2] = ["stock before", "stock after"];

/// Keeps chosen path points of [`RemovalData`].
pub(super) fn keep(removal: &mut Value, chosen: &[usize]) {
    let entries = removal.as_object_mut().into_iter().flatten();
    for (key, all) in entries.filter(|(key, _)| *key != "stock") {
        let width = if key == "force_n" { 3 } else { 1 };
        *all = chosen_singles(all.as_str().unwrap_or_default(), chosen, width).into();
    }
}

/// A stock in the frame of the task that the page has.
fn stock(name: &str, surface: &Surface, turned: &Matrix3<f64>) -> BodyMesh {
    let Surface { vertices, triangles } = thinned(surface, STOCK_TRIANGLES);
    let place = |corner: &Vector3<f64>| <[f64; 3]>::from(turned * corner).map(|value| value as f32);
    BodyMesh {
        name: name.to_owned(),
        frame: BodyFrame::Workpiece,
        color: [0.73, 0.77, 0.82],
        positions: vertices.iter().map(place).collect(),
        triangles,
        is_illustration: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::value;
    use stead_model::task::Wrench;
    use stead_problem::testing::five_segments;
    use stead_removal::outcome::ForcesDifference;

    /// A load that grows along the path, with one point in the air, and stock that is a tetrahedron.
    fn removal(problem: &Problem) -> RemovalForces {
        let load = |point: usize| PointForces {
            is_added: false,
            chip: Wrench { force: Vector3::new(point as f64, 0.0, 2.0), moment: Vector3::zeros() },
            edge: Wrench { force: Vector3::new(0.0, 1.0, 0.0), moment: Vector3::new(0.0, 0.0, 0.5) },
            largest: 9.0,
            removed: 2e-6,
            heights: (point != 1).then_some([0.0, 3e-3]),
            angles: None,
            chip_thickness: 4e-5,
        };
        let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let stock = Surface { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] };
        RemovalForces {
            path: problem.task.path().clone(),
            points: (0..problem.task.points().len()).map(load).collect(),
            cell: 1e-3,
            difference: ForcesDifference::default(),
            removed: 1e-6,
            air: 0.0,
            cut: None,
            stock: [stock.clone(), stock],
            warnings: Vec::new(),
            notes: Vec::new(),
        }
    }

    #[test]
    fn every_point_has_its_force_and_chosen_ones_keep_theirs() {
        let problem = five_segments();
        let mut data = value(&RemovalData::of(&problem, &removal(&problem)));
        let column = |data: &Value, key: &str| data[key].as_str().unwrap().to_owned();
        let forces = |points: &[usize]| singles(points.iter().flat_map(|point| [*point as f64, 1.0, 2.0]));
        let all: Vec<usize> = (0..105).collect();
        assert_eq!(column(&data, "force_n"), forces(&all));
        assert_eq!(column(&data, "moment_nm"), singles(vec![0.5; 105]));
        keep(&mut data, &[0, 1, 104]);
        assert_eq!(column(&data, "force_n"), forces(&[0, 1, 104]));
        assert_eq!(column(&data, "highest_mm"), singles([3.0, f64::NAN, 3.0]));
        assert_eq!(column(&data, "entry_deg"), singles([f64::NAN; 3]));
        assert_eq!(data["stock"][1]["name"], "stock after");
    }
}
