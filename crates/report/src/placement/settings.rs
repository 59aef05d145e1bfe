//! Inputs and settings of a run as `summary.json` states them.

use super::Context;
use crate::figure::{
    AngleDeg, DeflectionMm, PlaceMm, Plain, RateDegPerMm, SpeedDegPerS, SpeedMmPerS, TimeS, WeightMmPerRad,
    WeightMmPerS, each, some,
};
use serde_json::Value;
use stead_model::robot::{Pose, Posture};
use stead_numerics::rotation::zyx_from_rotation;
use stead_problem::criterion::{Criterion, Direction};
use stead_problem::postures::PostureRules;
use stead_problem::problem::{BetaPlan, Interval, Problem, Redundancy};
use stead_problem::settings::{LookupUse, PostureSearch};

records! {
    /// Inputs and settings of a run.
    pub struct SettingsFigures of (problem: &Problem, context: &Context) {
        /// Name of the robot.
        robot: String = problem.robot.name().to_owned(),
        /// The postures 1 to 8 of the robot in words, in this order.
        posture_words: [String; 8] = Posture::ALL.map(|posture| problem.robot.posture_words(posture).to_string()),
        /// Seed of all random numbers.
        seed: u64 = context.search.seed,
        /// How hard the search is.
        search: SearchSettings = SearchSettings::of(context),
        /// Assumptions behind the times of the moves.
        transfer: TransferSettings = TransferSettings::of(context),
        /// Where the workpiece may be.
        cell: CellFigures = CellFigures::of(problem),
        /// What every state must keep.
        constraints: ConstraintFigures = ConstraintFigures::of(problem),
        /// What is minimised.
        criterion: CriterionFigures = CriterionFigures::of(problem),
        /// What is chosen along the path.
        redundancy: RedundancyFigures = RedundancyFigures::of(&problem.redundancy),
        /// The path.
        task: TaskFigures = TaskFigures::of(problem),
        /// What the run file states, key by key.
        run_file: Value = context.stated.clone(),
        /// Where the robot is mounted in the cell, where that is not its origin.
        mount?: MountFigures = problem.robot.is_mounted().then(|| MountFigures::of(&problem.robot.cell_from_base())),
        /// Rules for postures, where there are some.
        postures?: PostureFigures = (problem.postures != PostureRules::NONE).then(|| PostureFigures::of(problem)),
    }

    /// How hard a search is.
    pub struct SearchSettings of (context: &Context) {
        /// Individuals of a generation.
        population: usize = context.search.population,
        /// Generations.
        generations: usize = context.search.generations,
        /// How postures are chosen: `exact` or `genetic`.
        #[schemars(with = "String")] postures: PostureSearch = context.search.postures,
        /// Basins that are refined.
        basins: usize = context.search.basins,
        /// When a lookup table is used: `auto`, `always` or `never`.
        #[schemars(with = "String")] tables: LookupUse = context.search.tables,
        /// False where the worst placement is not searched.
        #[serde(skip_serializing_if = "std::clone::Clone::clone")] worst: bool = context.search.worst,
    }

    /// Assumptions behind the times of the moves.
    pub struct TransferSettings of (context: &Context) {
        /// Time from rest to full speed at full acceleration.
        acceleration_time_s: TimeS = context.transfer.acceleration_time.into(),
        /// Time from no to full acceleration at full jerk.
        jerk_time_s: TimeS = context.transfer.jerk_time.into(),
        /// Distance over which the controller blends changes of the joint speeds along the cut.
        blend_mm: PlaceMm = context.transfer.blend.into(),
    }

    /// Where the workpiece may be: ends of intervals.
    pub struct CellFigures of (problem: &Problem) {
        let ends = |bounds: Interval| [bounds.min, bounds.max];
        let [x_mm, y_mm, z_mm] = problem.cell.position.map(|bounds| each(ends(bounds)));
    } with {
        /// x of the workpiece origin.
        x_mm: [PlaceMm; 2] = x_mm,
        /// y of the workpiece origin.
        y_mm: [PlaceMm; 2] = y_mm,
        /// z of the workpiece origin.
        z_mm: [PlaceMm; 2] = z_mm,
        /// Rotation about z.
        yaw_deg: [AngleDeg; 2] = each(ends(problem.cell.yaw)),
    }

    /// Where the robot is mounted in the cell.
    pub struct MountFigures of (mount: &Pose<f64>) {
        let [yaw, pitch, roll] = zyx_from_rotation(&mount.rotation);
    } with {
        /// Its base in the cell frame.
        xyz_mm: [PlaceMm; 3] = each(mount.translation.into()),
        /// Roll, pitch and yaw of the base frame in the cell frame.
        rpy_deg: [AngleDeg; 3] = each([roll, pitch, yaw]),
    }

    /// What every state must keep.
    pub struct ConstraintFigures of (problem: &Problem) {
        /// Least inverse condition number of the Jacobian.
        min_inverse_condition: f64 = problem.constraints.min_inverse_condition,
        /// Length that makes its position rows comparable with its rotation rows.
        characteristic_length_mm: PlaceMm = problem.constraints.characteristic_length.into(),
        /// Largest score of a point.
        max_deflection_mm: Option<DeflectionMm> = some(problem.constraints.max_deflection),
        /// Least distance of a joint from its limits.
        joint_margin_deg: AngleDeg = problem.constraints.joint_margin.into(),
        /// Smallest distance of any path point from axis 1.
        min_base_distance_mm: PlaceMm = problem.constraints.min_base_distance.into(),
    }

    /// What is minimised.
    pub struct CriterionFigures of (problem: &Problem) {
        let criterion = &problem.criterion;
        let Criterion { aggregate, segment_weights, force_uncertainty, .. } = criterion;
        let travel = criterion.joint_travel_weight;
    } with {
        /// The direction that is scored; null where the weights name no single one.
        direction: Option<&'static str> = criterion.direction().map(Direction::name),
        /// Weights of the directions.
        weights: WeightFigures = WeightFigures::of(problem),
        /// How the scores of the points make one: `mean`, `rms` and the like.
        aggregate: &'static str = aggregate.name(),
        /// Weights of the segments; empty where all are 1.
        segment_weights: Vec<f64> = segment_weights.clone(),
        /// Relative size of the force error that a score covers.
        force_uncertainty: f64 = *force_uncertainty,
        /// What a radian of joint travel in every 10 mm of the cut adds to the objective.
        joint_travel_weight_mm_per_rad?: WeightMmPerRad = (travel > 0.0).then(|| travel.into()),
        /// How stiffness sets make one objective.
        over?: &'static str = criterion.stiffness.as_ref().map(|sets| sets.over.name()),
        /// How many standard deviations a score covers, where the robot's uncertainty is known.
        confidence?: f64 = problem.robot.uncertainty().map(|_| criterion.confidence),
    }

    /// Weights of the directions of a deflection.
    pub struct WeightFigures of (problem: &Problem) {
        let criterion = &problem.criterion;
        let weights = &criterion.weights;
    } with {
        /// Normal to feed and tool axis.
        wall: f64 = weights.wall,
        /// Along the tool axis.
        axis: f64 = weights.axis,
        /// Along the feed.
        feed: f64 = weights.feed,
        /// Along the normal of the surface.
        surface: f64 = weights.surface,
    }

    /// Rules for postures.
    pub struct PostureFigures of (problem: &Problem) {
        /// The postures allowed, 1 to 8.
        allowed: Vec<u8> = problem.postures.allowed().map(|posture| posture.number()).collect(),
        /// The same in words.
        allowed_words: Vec<String> =
            problem.postures.allowed().map(|posture| problem.robot.posture_words(posture).to_string()).collect(),
        /// Whether it may change between segments: `free` or `never`.
        changes: &'static str = if problem.postures.may_change { "free" } else { "never" },
        /// What a second of the moves between segments counts in the choice of postures.
        move_weight_mm_per_s: WeightMmPerS = problem.postures.move_weight.into(),
        /// How much worse than its best plan that of a segment may be to make the moves shorter. %
        tie_percent: Plain = Plain(problem.postures.tie * 100.0),
    }

    /// What is chosen along the path.
    pub struct RedundancyFigures of (redundancy: &Redundancy) {
        let beta = redundancy.beta;
        let is_constant = matches!(beta, BetaPlan::ConstantPerSegment | BetaPlan::Constant);
    } with {
        /// Angles about the tool axis that are tried at a point.
        beta_count: usize = redundancy.beta_count,
        /// Feed where the task states none.
        feed_mm_per_s: SpeedMmPerS = redundancy.feed.into(),
        /// Largest rate of beta.
        max_beta_rate_deg_per_mm?: RateDegPerMm = some(redundancy.max_beta_rate),
        /// Largest rate of turning of the spindle.
        max_spindle_turn_deg_per_mm?: RateDegPerMm = some(redundancy.max_spindle_turn),
        /// Largest speed of turning of the spindle.
        max_spindle_turn_deg_per_s?: SpeedDegPerS = some(redundancy.max_spindle_speed),
        /// Where beta is constant: along each segment, or along the path.
        beta?: &'static str = is_constant.then(|| beta.name()),
    }

    /// The path of a task.
    pub struct TaskFigures of (problem: &Problem) {
        /// Points.
        points: usize = problem.task.points().len(),
        /// Segments.
        segments: usize = problem.task.segments().len(),
    }
}
