//! The CSV files. One function makes one file; every column carries its unit.

use super::setup;
use crate::csv_file::{table, vector};
use crate::names;
use crate::output::ReportError;
use crate::units::{Unit, fixed};
use stead_cell::Scene;
use stead_model::published::Published;
use stead_model::robot::turns::turns;
use stead_model::task::ToolPath;
use stead_numerics::mean_max::MeanAndMax;
use stead_placement::feasibility::DeflectionMap;
use stead_placement::outcome::{Cases, DeflectionFigures, Generation, Plan, PlanPoint, Refinement};
use stead_placement::problem::{Placement, Problem};

const PLAN: [&str; 28] = [
    "point",
    "segment",
    "x_mm",
    "y_mm",
    "z_mm",
    "beta_deg",
    "posture",
    "turn_1",
    "turn_4",
    "turn_6",
    "theta1_deg",
    "theta2_deg",
    "theta3_deg",
    "theta4_deg",
    "theta5_deg",
    "theta6_deg",
    "inverse_condition",
    "force_x_n",
    "force_y_n",
    "force_z_n",
    "deflection_x_mm",
    "deflection_y_mm",
    "deflection_z_mm",
    "normal_mm",
    "feed_mm",
    "axial_mm",
    "score_mm",
    "total_mm",
];

/// `best.csv`, `worst.csv` and the like: one plan, one row per path point. Places are those of the tool centre point, and all
/// vectors are in the robot base frame; turns are full turns beyond (-180, 180] deg; `total_mm` is the size of the deflection.
/// Behind it are `surface_mm` where the task states the normal of the surface, and `std_mm` where the robot's uncertainty is
/// known: the standard deviation of the scored part; then `e1_mm` or `e1_deg` and so on where there are external axes. Among shapes of
/// a cell, `clearance_mm` is the distance of the pair with the least room, zero where the two touch, and `nearest_pair` names it; both
/// are empty where nothing is nearer than 1 m.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn plan(plan: &Plan, scene: Option<&Scene>) -> Result<Vec<u8>, ReportError> {
    let mut header = PLAN.map(str::to_owned).to_vec();
    header.extend(plan.deflection.surface.map(|_| "surface_mm".to_owned()));
    header.extend(plan.mean_deviation.map(|_| "std_mm".to_owned()));
    header.extend(setup::columns(&plan.axes));
    header.extend(scene.iter().flat_map(|_| ["clearance_mm", "nearest_pair"].map(str::to_owned)));
    let rows = plan.points.iter().map(|point| {
        let mut row = plan_row(point);
        row.extend(setup::at_point(&plan.axes, point.point));
        row.extend(scene.iter().flat_map(|scene| {
            let distance = point.clearance.map(|clearance| clearance.distance);
            let pair = point.clearance.and_then(|clearance| scene.pair(clearance.pair));
            [Unit::PLACE_MM.text_or_empty(distance), pair.map(ToString::to_string).unwrap_or_default()]
        }));
        row
    });
    table("the table of a plan", &header, rows)
}

fn plan_row(point: &PlanPoint) -> Vec<String> {
    let mut row = vec![point.point.to_string(), point.segment.to_string()];
    row.extend(vector(Unit::PLACE_MM, &point.position));
    row.extend([Unit::ANGLE_DEG.text(point.beta), point.posture.to_string()]);
    row.extend([0, 3, 5].map(|j| turns(point.joints[j]).to_string()));
    row.extend(point.joints.map(|angle| Unit::ANGLE_DEG.text(angle)));
    row.push(Unit::PLAIN.text(point.inverse_condition));
    row.extend(vector(Unit::FORCE_N, &point.force));
    row.extend(vector(Unit::DEFLECTION_MM, &point.deflection));
    let parts = [point.normal_part, point.feed_part, point.axial_part, point.score, point.deflection.norm()];
    row.extend(parts.map(|part| Unit::DEFLECTION_MM.text(part)));
    row.extend(point.surface_part.map(|part| Unit::DEFLECTION_MM.text(part)));
    row.extend(point.deviation.map(|deviation| Unit::DEFLECTION_MM.text(deviation)));
    row
}

/// `placements.csv`: the four cases. Times are empty where a joint speed is not known, the reference where there is none,
/// the ratio where case 1 is a cancellation. `mean_mm` and `max_mm` are of the scores, `objective_mm` is what was minimised. The
/// last column, `mean_std_mm`, is there where the robot's uncertainty is known: the standard deviation of the mean of the
/// scored part; behind it the orientation of the part and the positions of external axes that stand still along the path, where a run has
/// such. `max_feed_mm_per_s` is the highest feed that the plan holds, empty where no limit of the joints is known; `joint_travel_deg`
/// is what all joints turn in the cut, `max_joint_step_deg` the largest turn of one from a point to the next.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn placements(cases: &Cases, reference: Option<&Published<[f64; 4]>>) -> Result<Vec<u8>, ReportError> {
    let mut header = vec![
        "case",
        "x_mm",
        "y_mm",
        "z_mm",
        "yaw_deg",
        "q4",
        "postures",
        "mean_mm",
        "max_mm",
        "ratio_to_case_1",
        "reference_mm",
        "cutting_s",
        "transfer_s",
        "cycle_s",
        "objective_mm",
        "mean_wall_mm",
        "max_wall_mm",
        "mean_axis_mm",
        "max_axis_mm",
        "mean_total_mm",
        "max_total_mm",
        "max_feed_mm_per_s",
        "joint_travel_deg",
        "max_joint_step_deg",
    ];
    header.extend(cases.best.plan.deflection.surface.iter().flat_map(|_| ["mean_surface_mm", "max_surface_mm"]));
    header.extend(cases.best.plan.mean_deviation.map(|_| "mean_std_mm"));
    header.extend(cases.best.orientation.as_ref().map(|_| "orientation"));
    let mut header: Vec<String> = header.into_iter().map(str::to_owned).collect();
    header.extend(setup::columns(&cases.best.plan.axes));
    let rows = cases.all().into_iter().enumerate().map(|(index, case)| {
        let mut row = vec![case.number().to_string()];
        row.extend(placement(&case.placement, true));
        row.push(names::postures(&case.plan.postures));
        row.extend([case.plan.mean, case.plan.max].map(|value| Unit::DEFLECTION_MM.text(value)));
        row.push(Unit::PLAIN.text_or_empty(cases.ratio(case)));
        row.push(reference.map_or_else(String::new, |reference| reference.figures[index].to_string()));
        row.push(Unit::TIME_S.text(case.cycle.cutting));
        let total = case.cycle.total();
        row.push(Unit::TIME_S.text_or_empty(total.map(|total| total - case.cycle.cutting)));
        row.push(Unit::TIME_S.text_or_empty(total));
        row.push(Unit::DEFLECTION_MM.text(case.plan.objective));
        let DeflectionFigures { wall, axis, total, surface, .. } = case.plan.deflection;
        let pair = |figures: MeanAndMax| [figures.mean, figures.max].map(|value| Unit::DEFLECTION_MM.text(value));
        row.extend([wall, axis, total].into_iter().flat_map(pair));
        row.push(Unit::SPEED_MM_PER_S.text_or_empty(case.cycle.feed.highest().map(|limit| limit.feed)));
        let travel = &case.plan.travel;
        row.extend([travel.total, travel.largest_step].map(|angle| Unit::ANGLE_DEG.text(angle)));
        row.extend(surface.into_iter().flat_map(pair));
        row.extend(case.plan.mean_deviation.map(|deviation| Unit::DEFLECTION_MM.text(deviation)));
        row.extend(case.orientation.clone());
        row.extend(setup::standing(&case.plan.axes));
        row
    });
    table("the table of placements", &header, rows)
}

/// `convergence.csv`: both genetic searches, generation by generation.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn convergence(generations: &[Generation]) -> Result<Vec<u8>, ReportError> {
    let header = ["search", "generation", "best_mm", "average_mm", "feasible", "population", "evaluations"];
    let rows = generations.iter().map(|state| {
        vec![
            names::sense(state.sense).to_owned(),
            state.generation.to_string(),
            Unit::DEFLECTION_MM.text_or_empty(state.best),
            Unit::DEFLECTION_MM.text_or_empty(state.average),
            state.feasible.to_string(),
            state.population.to_string(),
            state.evaluations.to_string(),
        ]
    });
    table("the table of the convergence", header, rows)
}

/// `deflection-map-*.csv`: every state of the grid with its smallest score over the allowed postures, or the reason why
/// there is none.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn deflection_map(problem: &Problem, map: &DeflectionMap) -> Result<Vec<u8>, ReportError> {
    let scene = problem.scene.as_deref();
    let mut header = vec!["point", "segment", "beta_deg", "score_mm", "posture", "reason"];
    header.extend(scene.map(|_| "pair"));
    let path = problem.task.path();
    let rows = map.rows.iter().enumerate().flat_map(|(point, row)| {
        row.iter().enumerate().map(move |(k, cell)| {
            let beta_deg = -180.0 + 360.0 * k as f64 / map.beta_count as f64;
            let mut fields = vec![point.to_string(), segment(path, point), fixed(beta_deg, Unit::ANGLE_DEG.decimals)];
            fields.extend(match cell {
                Ok(cell) => [Unit::DEFLECTION_MM.text(cell.score), cell.posture.to_string(), String::new()],
                Err(blocked) => [String::new(), String::new(), blocked.kind.code()],
            });
            fields.extend(scene.map(|scene| {
                let pair = cell.err().and_then(|blocked| scene.pair(blocked.pair?));
                pair.map(ToString::to_string).unwrap_or_default()
            }));
            fields
        })
    });
    table("the table of a deflection map", header, rows)
}

fn segment(path: &ToolPath, point: usize) -> String {
    (path.segment_of(point) + 1).to_string()
}

/// `transfers.csv`: the joint moves between segments. The duration is empty where a joint speed is not known. Among shapes of a cell,
/// `moves` is the number of straight moves that keep free, retraction and approach among them, and `blocked_by` the pair that hits where
/// no free way was found; `line_out_mm` and `line_into_mm` are lengths of lines out of the cut and into it that are shorter than asked for.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn transfers(cases: &Cases, scene: Option<&Scene>) -> Result<Vec<u8>, ReportError> {
    let mut header = vec!["case", "after_segment", "duration_s", "travel_deg"];
    header.extend(scene.iter().flat_map(|_| ["moves", "blocked_by", "line_out_mm", "line_into_mm"]));
    let rows = cases.all().into_iter().flat_map(|case| {
        case.cycle.transfers.iter().map(move |transfer| {
            let mut row = vec![
                case.number().to_string(),
                transfer.after_segment.to_string(),
                Unit::TIME_S.text_or_empty(transfer.duration),
                Unit::ANGLE_DEG.text(transfer.travel),
            ];
            row.extend(scene.iter().flat_map(|_| {
                let way = transfer.way.as_ref();
                let pair = way.and_then(|way| way.blocked_by.as_deref());
                let moves = way.map_or(1, |way| way.joints.len().saturating_sub(1));
                let pair = pair.map_or_else(String::new, |[a, b]| format!("{a} and {b}"));
                let line = |end: usize| {
                    let short = way.and_then(|way| way.short_lines[end].as_ref());
                    Unit::PLACE_MM.text_or_empty(short.map(|line| line.length))
                };
                [moves.to_string(), pair, line(0), line(1)]
            }));
            row
        })
    });
    table("the table of transfers", header, rows)
}

/// `refinements.csv`: each gradient refinement with its start and end.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn refinements(refinements: &[Refinement]) -> Result<Vec<u8>, ReportError> {
    let header = [
        "search",
        "start_x_mm",
        "start_y_mm",
        "start_z_mm",
        "start_yaw_deg",
        "start_mean_mm",
        "end_x_mm",
        "end_y_mm",
        "end_z_mm",
        "end_yaw_deg",
        "end_mean_mm",
        "rounds",
        "iterations",
        "kkt_residual_mm",
        "status",
    ];
    let rows = refinements.iter().map(|refinement| {
        let mut row = vec![names::sense(refinement.sense).to_owned()];
        row.extend(placement(&refinement.start, false));
        row.push(Unit::DEFLECTION_MM.text(refinement.start_mean));
        row.extend(placement(&refinement.end, false));
        row.push(Unit::DEFLECTION_MM.text(refinement.end_mean));
        row.extend([refinement.rounds.to_string(), refinement.iterations.to_string()]);
        row.push(refinement.kkt_residual.map_or(String::new(), |residual| Unit::RESIDUAL_MM.text(residual)));
        row.push(names::statuses(&refinement.statuses));
        row
    });
    table("the table of refinements", header, rows)
}

/// x, y, z in mm, the yaw in degrees, and Q4 where asked for.
fn placement(placement: &Placement, with_q4: bool) -> Vec<String> {
    let mut fields = [placement.x, placement.y, placement.z].map(|value| Unit::PLACE_MM.text(value)).to_vec();
    fields.push(Unit::ANGLE_DEG.text(placement.yaw));
    if with_q4 {
        fields.push(Unit::PLAIN.text(placement.q4()));
    }
    fields
}
