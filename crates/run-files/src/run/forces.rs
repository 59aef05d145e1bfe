//! The table `[forces]`, and which of the sources of forces a run has.

use super::segments::by_segment;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_format::document::NamedFile;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::scalars::Whole;
use stead_format::task::Imported;
use stead_format::tool::Cutting;
use stead_format::units::N;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};

/// The force along the path, in the frame of each path point: what the workpiece does to the tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForcesTable {
    /// Along the feed, taken normal to the tool axis.
    pub feed_n: N,
    /// To the left of the feed, tool axis x feed: towards or away from the wall.
    pub normal_n: N,
    /// Along the tool axis, from the work into the spindle.
    pub axis_n: N,
    /// Segments with another force.
    pub segment: Option<Vec<SegmentForces>>,
}

/// The force along one segment, in place of that for the whole path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SegmentForces {
    /// Its number in the task, from 1.
    pub number: Whole<1, 4294967295>,
    /// Along the feed, taken normal to the tool axis.
    pub feed_n: N,
    /// To the left of the feed, tool axis x feed: towards or away from the wall.
    pub normal_n: N,
    /// Along the tool axis, from the work into the spindle.
    pub axis_n: N,
}

impl ForcesTable {
    /// The wrench at every point of a path, in the workpiece frame.
    fn wrenches(&self, path: &ToolPath, at: &Place<'_>) -> Result<Vec<Wrench>, InputError> {
        let vector = |forces: [N; 3]| Vector3::from(forces.map(Quantity::si));
        let count = path.segments().len();
        let own = self.segment.iter().flatten();
        let own = own.map(|table| (table.number.count(), vector([table.feed_n, table.normal_n, table.axis_n])));
        let own = by_segment(own, count, &at.key("segment"), || format!("whole numbers from 1 to {count}"))?;
        let all = vector([self.feed_n, self.normal_n, self.axis_n]);
        let at = |(index, point): (usize, &PathPoint)| Wrench {
            force: point.workpiece_from_point() * own[path.segment_of(index)].unwrap_or(all),
            moment: Vector3::zeros(),
        };
        Ok(path.points().iter().enumerate().map(at).collect())
    }
}

/// What forces may come from.
const SOURCES: &str = "force columns in the task, tables [tool] and [cut], or a table [forces] with feed_n, normal_n and axis_n: one of them";

/// Where the forces of a run may come from beside the task.
pub(super) struct ForceTables<'a> {
    pub forces: Option<&'a ForcesTable>,
    pub cutting: Option<&'a Cutting<'a>>,
    /// `[tool]` and `[cut]` may then stand beside forces.
    pub is_for_stability: bool,
}

impl ForceTables<'_> {
    /// Puts the forces to the path: those of the file, those of the table, or those of the cutter and its cut, which
    /// may be there for the stability alone.
    pub fn task(
        &self,
        imported: Imported,
        file: &NamedFile,
        field: &Place<'_>,
        forces_at: &Place<'_>,
    ) -> Result<Task, InputError> {
        let columns = || format!("the task {} has force columns already: forces come from one place only", file.name);
        let wrenches = match (imported.wrenches, self.forces, self.cutting) {
            (Some(_), Some(_), _) => return Err(forces_at.error(columns(), SOURCES)),
            (Some(_), None, Some(cutting)) if !self.is_for_stability => {
                return Err(cutting.tool_at.error(columns(), SOURCES));
            }
            (None, Some(_), Some(_)) if !self.is_for_stability => {
                let problem = "there are tables [tool] and [cut] already: forces come from one place only";
                return Err(forces_at.error(problem, SOURCES));
            }
            (Some(wrenches), None, _) => wrenches,
            (None, Some(forces), _) => forces.wrenches(&imported.path, forces_at)?,
            (None, None, Some(cutting)) => cutting.path_forces()?.wrenches(&imported.path),
            (None, None, None) => {
                let problem = "has no force columns, and there is neither [tool] and [cut] to compute them nor [forces] to state them";
                return Err(field.error(problem, SOURCES));
            }
        };
        let at = match (self.forces, self.cutting) {
            (Some(_), _) => forces_at,
            (None, Some(cutting)) => &cutting.tool_at,
            (None, None) => field,
        };
        Task::new(imported.path, wrenches)
            .map_err(|e| at.error(format!("gives no usable forces: {e}"), "values whose forces are finite"))
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, TASK, folder};

    const FORCES: &str = "[forces]\nfeed_n = -100\nnormal_n = 20\naxis_n = 30\n";
    const TOOLS: &str = "[tool]\ncutter_diameter_mm = 16\nteeth = 4\nkt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n\
                         [cut]\nmilling = 'climb'\nradial_depth_mm = 2\naxial_depth_mm = 5\nfeed_per_tooth_mm = 0.05\n";

    /// A run with tables added, of a task with or without its force columns.
    fn read(tables: &str, with_columns: bool) -> Result<stead_runs::Run, stead_disk::input::InputError> {
        let folder = folder();
        if !with_columns {
            let rows = TASK.lines().map(|line| line.split(',').take(10).collect::<Vec<_>>().join(",") + "\n");
            std::fs::write(folder.path().join("task.csv"), rows.collect::<String>()).unwrap();
        }
        let file = folder.path().join("run.toml");
        std::fs::write(&file, format!("{RUN}{tables}")).unwrap();
        crate::read_run(&file)
    }

    #[test]
    fn a_stated_force_is_in_the_frame_of_each_point() {
        let run = read(FORCES, false).unwrap();
        for (point, wrench) in run.problem.task.points().iter().zip(run.problem.task.wrenches()) {
            let along = [point.feed, point.normal(), point.axis].map(|direction| direction.dot(&wrench.force));
            assert!(
                along.iter().zip([-100.0, 20.0, 30.0]).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-9),
                "{along:?}"
            );
        }
    }

    #[test]
    fn a_segment_may_have_forces_of_its_own() {
        let own = "[[forces.segment]]\nnumber = 1\nfeed_n = -40\nnormal_n = 5\naxis_n = 6\n";
        let run = read(&format!("{FORCES}{own}"), false).unwrap();
        let task = &run.problem.task;
        for (index, (point, wrench)) in task.points().iter().zip(task.wrenches()).enumerate() {
            let feed_n = if task.path().segment_of(index) == 0 { -40.0 } else { -100.0 };
            assert!((point.feed.dot(&wrench.force) - feed_n).abs() < 1e-9, "{index}");
        }
        for (change, place, allowed) in [
            ("number = 9", "forces.segment[1].number: is no segment of the task", "whole numbers from 1 to "),
            ("number = 0", "forces.segment[1].number", "allowed"),
        ] {
            let message =
                read(&format!("{FORCES}{}", own.replace("number = 1", change)), false).unwrap_err().to_string();
            assert!(message.contains(place) && message.contains(allowed), "{message}");
        }
        let message = read(&format!("{FORCES}{own}{own}"), false).unwrap_err().to_string();
        assert!(message.contains("forces.segment[2].number: is there twice"), "{message}");
    }

    const STOCK: &str = "[stock]\nbox_mm = [40, 40, 10]\nxyz_mm = [0, 10, 0]\n\
                         [tool]\ncutter_diameter_mm = 16\nteeth = 4\nflute_length_mm = 20\nkt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n\
                         [cut]\nspindle_rpm = 6000\n";

    #[test]
    fn a_run_with_stock_has_the_forces_of_what_its_path_removes() {
        let run = read(STOCK, false).unwrap();
        let largest = run.problem.task.wrenches().map(|wrench| wrench.force.norm()).fold(0.0, f64::max);
        assert!(largest > 50.0, "{largest}");
        for part in ["those of what the path removes", "no rapid moves"] {
            assert!(run.notes.iter().any(|note| note.contains(part)), "{part} in {:?}", run.notes);
        }
        for (tables, with_columns, part) in [
            (
                STOCK.to_owned(),
                true,
                "stock: the task task.csv has force columns already: forces come from one place only",
            ),
            (
                format!("{FORCES}{STOCK}"),
                false,
                "forces: there is a table [stock] already: forces come from one place only",
            ),
            (
                STOCK.replace("[tool]", "material = 'steel'\n[tool]"),
                false,
                "stock.material: is a key of the file, not of this table, found 'steel'; allowed: material at the top of the file",
            ),
            (
                STOCK.replace("[cut]", "[cut]\nmilling = 'climb'"),
                false,
                "cut.milling: is given, and the path and the stock",
            ),
            (STOCK.replace("spindle_rpm = 6000", ""), false, "cut.spindle_rpm: is missing"),
            (STOCK.replace("[0, 10, 0]", "[0, 500, 0]"), false, "stock: the path never touches the stock"),
            (format!("{TOOLS}[finished_part]\nmesh = 'a.stl'\n"), false, "finished_part: is there without the stock"),
        ] {
            let message = read(&tables, with_columns).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("; allowed: "), "{part} in {message}");
        }
    }

    #[test]
    fn scores_may_cover_the_errors_that_forces_from_the_path_state() {
        let with = |table: &str| read(&format!("[criterion]\n{table}\n{STOCK}"), false);
        let size = |word: &str| {
            let run = with(&format!("force_uncertainty_from = '{word}'")).unwrap();
            let note = run.notes.iter().find(|note| note.starts_with("the scores cover force errors of ")).unwrap();
            let size = run.problem.criterion.force_uncertainty;
            assert!(note.contains(&format!("of {:.2} %: ", size * 100.0)), "{note}");
            size
        };
        let [cells, turn, both] = ["cells", "turn", "both"].map(size);
        // Teeth that come and go: the largest force of a turn is far above the mean, and cells hardly matter.
        assert!(cells > 0.0 && cells < 0.05 && turn > 0.1 && turn < 3.0, "{cells} {turn}");
        assert_eq!(both, cells + turn);
        for (result, part) in [
            (
                with("force_uncertainty_from = 'cells'\nforce_uncertainty = 0.1"),
                "is there beside criterion.force_uncertainty",
            ),
            (with("force_uncertainty_from = 'all'"), "\"cells\" or \"turn\" or \"both\""),
            (read(&format!("[criterion]\nforce_uncertainty_from = 'turn'\n{TOOLS}"), false), "there is no stock"),
        ] {
            let message = result.unwrap_err().to_string();
            assert!(message.contains("criterion.force_uncertainty_from: ") && message.contains(part), "{message}");
        }
    }

    #[test]
    fn forces_come_from_one_place_and_every_place_is_named() {
        let ways = ["force columns in the task", "[tool] and [cut]", "[forces] with feed_n, normal_n and axis_n"];
        let both = format!("{FORCES}{TOOLS}");
        for (tables, with_columns, part) in [
            ("", false, "task: has no force columns"),
            (FORCES, true, "forces: the task task.csv has force columns already: forces come"),
            (TOOLS, true, "tool: the task task.csv has force columns already: forces come"),
            (&both, false, "forces: there are tables [tool] and [cut] already: forces come"),
        ] {
            let message = read(tables, with_columns).unwrap_err().to_string();
            for part in ways.iter().chain([&part]) {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
        assert!(read(TOOLS, false).is_ok() && read("", true).is_ok());
        let message = read(&FORCES.replace("axis_n = 30\n", ""), false).unwrap_err().to_string();
        assert!(message.contains("forces.axis_n: is missing"), "{message}");
    }
}
