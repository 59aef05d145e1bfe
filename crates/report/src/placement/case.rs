//! A case as documents state it: a placement with its plan, feeds and moves.

use super::origins::OriginFigures;
use super::setup::SetupFigures;
use super::text::spring_name;
use crate::document::{DeflectionByDirection, FeedFigures, JointTravelFigures, PlacementExact, PlacementFigures};
use crate::figure::{AngleDeg, DeflectionMm, Gain, MmPerPercent, PlaceMm, Plain, TimeS, each, some};
use crate::names;
use stead_model::robot::Posture;
use stead_placement::outcome::{AtHeldFeed, Case, Cycle, Plan, PlanPoint};
use stead_placement::sag::{Sag, SagRange};
use stead_placement::sensitivity::SpringSlope;
use stead_planning::transfer::Transfer;
use stead_planning::transfer_path::{self, LineEnd};
use stead_problem::collision;
use stead_problem::criterion::CANCELLATION;
use stead_problem::limit::ActiveBound;

records! {
    /// A case: where the workpiece is, and how it is milled there.
    pub struct CaseFigures of (case: &Case, with_points: bool) {
        let slope = |slope: &SpringSlope| StiffnessSlope::of(slope, case);
    } with {
        /// 1 to 4: best or worst placement under its best or worst plan.
        case: u8 = case.number(),
        /// The placement.
        placement: PlacementFigures = (&case.placement).into(),
        /// The placement with every digit.
        placement_exact: PlacementExact = (&case.placement).into(),
        #[serde(flatten)]
        setup: SetupFigures = SetupFigures::of(case.orientation.as_ref(), &case.setup, &case.plan.axes),
        #[serde(flatten)] plan: PlanFigures = PlanFigures::of(&case.plan, &case.cycle),
        /// What one per cent more stiffness of each joint does to the objective; of a full set of springs, of each
        /// spring.
        objective_by_stiffness: Option<Vec<StiffnessSlope>> =
            case.objective_by_stiffness.as_ref().map(|of| of.iter().map(slope).collect()),
        /// The bounds that hold the placement; null where they were not looked for.
        active_bounds: Option<Vec<ActiveBoundFigures>> =
            case.active_bounds.as_ref().map(|bounds| bounds.iter().map(Into::into).collect()),
        /// The moves between segments.
        transfers: Vec<TransferFigures> = case.cycle.transfers.iter().map(Into::into).collect(),
        /// The plan, point by point.
        #[serde(rename = "plan", skip_serializing_if = "Option::is_none")]
        points: Option<Vec<PlanPointFigures>> = with_points.then(|| case.plan.points.iter().map(Into::into).collect()),
    }

    /// A plan with its feeds and times.
    pub struct PlanFigures of (plan: &Plan, cycle: &Cycle) {
        /// What was minimised or maximised.
        objective_mm: DeflectionMm = plan.objective.into(),
        /// Mean of the scores, every scored point alike: weights of segments count in `objective_mm` alone.
        mean_mm: DeflectionMm = plan.mean.into(),
        /// Largest score.
        max_mm: DeflectionMm = plan.max.into(),
        /// The score that half of the points are below.
        p50_mm: DeflectionMm = plan.percentiles[0].into(),
        /// The score that 95 % of the points are below.
        p95_mm: DeflectionMm = plan.percentiles[1].into(),
        /// What each thing that yields adds to the scored part, in the mean of the points, where more does than the
        /// joints about their axes.
        by_origin_mm?: OriginFigures = plan.by_origin.as_ref().map(Into::into),
        /// How far the weight of links and spindle moves the tool, which no score counts; where the mass of what the
        /// flange carries is known.
        sag_mm?: SagFigures = plan.sag.as_ref().map(Into::into),
        /// Standard deviation of the mean of the scored part, where the robot's uncertainty is known.
        mean_std_mm?: DeflectionMm = some(plan.mean_deviation),
        /// Deflections by direction.
        deflection_mm: DeflectionByDirection = (&plan.deflection).into(),
        /// The same at the feed that the arm holds, with forces of a table `[stock]`, of which a part grows with the
        /// feed: what stands above is at the programmed feed.
        at_held_feed?: HeldFeedFigures = plan.held.as_ref().map(Into::into),
        /// The posture of each segment, 1 to 8.
        #[schemars(with = "Vec<u8>")] postures: Vec<Posture> = plan.postures.clone(),
        /// The same in words.
        posture_words: Vec<String> = plan.posture_words.iter().map(ToString::to_string).collect(),
        /// How much the joints turn.
        joint_travel: JointTravelFigures = (&plan.travel).into(),
        /// Feeds that the plan holds.
        feed: FeedFigures = (&cycle.feed).into(),
        /// Time of the cut at the programmed feed.
        cutting_s: TimeS = cycle.cutting.into(),
        /// Time with the moves between segments; null where a joint speed is not known.
        pub(super) cycle_s: Option<TimeS> = some(cycle.total()),
        /// Path points to which the arm cannot follow the straight move of the tool, or not within its joint limits.
        unfollowed_moves: Vec<UnfollowedMove> = cycle.unfollowed.iter().map(Into::into).collect(),
        /// The least clearance at the points, among shapes of a cell.
        clearance?: ClearanceFigures = plan.clearance.as_ref().map(ClearanceFigures::of),
    }

    /// A plan at the feed that the arm holds.
    pub struct HeldFeedFigures from held: &AtHeldFeed {
        /// Segments that are cut slower than programmed.
        slowed_segments: usize = held.slowed,
        /// Mean of the scores, every scored point alike: weights of segments count in `objective_mm` alone.
        mean_mm: DeflectionMm = held.mean.into(),
        /// Largest score.
        max_mm: DeflectionMm = held.max.into(),
        /// Deflections by direction.
        deflection_mm: DeflectionByDirection = (&held.deflection).into(),
    }

    /// A straight move of the tool that the arm cannot follow.
    pub struct UnfollowedMove from unfollowed: &(usize, LineEnd) {
        /// The path point that it leads to, from 0.
        to_point: usize = unfollowed.0,
        /// Why not.
        since: String = unfollowed.1.to_string(),
    }

    /// The least clearance at the points of a plan.
    pub struct ClearanceFigures of (of: &collision::PlanClearance) {
        /// The path point, from 0.
        point: usize = of.point,
        /// The distance.
        distance_mm: PlaceMm = of.distance.into(),
        /// The two shapes.
        pair: [String; 2] = (*of.names).clone(),
    }

    /// What one per cent more stiffness of a joint, or of one of its springs, does to the objective.
    pub struct StiffnessSlope of (found: &SpringSlope, case: &Case) {
        let is_full = case.objective_by_stiffness.as_ref().is_some_and(|all| all.len() > 6);
    } with {
        /// The joint, from 1.
        joint: usize = found.springs.first().map_or(0, |spring| spring.joint + 1),
        /// Of a full set of springs: the spring, with those that no deflection tells from it, as in `joint 5 about z
        /// with joint 4 about y`.
        spring?: String = is_full.then(|| spring_name(found)),
        /// Change of the objective.
        mm_per_percent: MmPerPercent = MmPerPercent(found.slope / 100.0),
        /// The same in per cent of it; null where the objective is nothing.
        percent_per_percent: Option<Plain> =
            (case.plan.objective > CANCELLATION).then(|| Plain(found.slope / case.plan.objective)),
    }

    /// How far the weight moves the tool.
    pub struct SagFigures from sag: &Sag {
        /// The smallest displacement along the path.
        least_mm: DeflectionMm = sag.path.least.into(),
        /// The largest.
        largest_mm: DeflectionMm = sag.path.largest.into(),
        /// The largest difference between the displacements of two points: what remains at most where the program is
        /// touched up at one of them.
        spread_mm: DeflectionMm = sag.path.spread.into(),
        /// The same of each segment.
        segments: Vec<SegmentSag> = sag.segments.iter().map(|(segment, range)| SegmentSag::of(*segment, range)).collect(),
    }

    /// How far the weight moves the tool within a segment.
    pub struct SegmentSag of (segment: usize, range: &SagRange) {
        /// The segment, from 1.
        segment: usize = segment,
        /// The smallest displacement.
        least_mm: DeflectionMm = range.least.into(),
        /// The largest.
        largest_mm: DeflectionMm = range.largest.into(),
        /// The largest difference between the displacements of two of its points.
        spread_mm: DeflectionMm = range.spread.into(),
    }

    /// A bound that holds an optimum.
    pub struct ActiveBoundFigures from bound: &ActiveBound {
        let (gain, unit) = names::gain(bound);
    } with {
        /// The bound, by its key of the files where it has one.
        bound: String = names::bound(bound),
        /// `lower` or `upper`.
        side: &'static str = names::side(bound),
        /// What moving it gains.
        gain: Gain = gain.into(),
        /// The unit of the gain.
        unit: &'static str = unit,
    }

    /// A path point of a plan.
    pub struct PlanPointFigures from point: &PlanPoint {
        /// The point, from 0.
        point: usize = point.point,
        /// Its segment, from 1.
        segment: usize = point.segment,
        /// Angle about the tool axis.
        beta_deg: AngleDeg = point.beta.into(),
        /// The posture, 1 to 8.
        #[schemars(with = "u8")] posture: Posture = point.posture,
        /// The same in words.
        posture_words: String = point.posture_words.to_string(),
        /// Joint angles.
        joints_deg: [AngleDeg; 6] = each(point.joints),
        /// Inverse of the condition number of the Jacobian.
        inverse_condition: Plain = point.inverse_condition.into(),
        /// Deflection normal to the wall.
        normal_mm: DeflectionMm = point.normal_part.into(),
        /// Size of the deflection.
        total_mm: DeflectionMm = point.deflection.norm().into(),
        /// The scored part of the deflection.
        score_mm: DeflectionMm = point.score.into(),
        /// Standard deviation of the scored part, where the robot's uncertainty is known.
        std_mm?: DeflectionMm = some(point.deviation),
        /// Lead of the tool from the axis of the path, where it leans.
        lead_deg?: AngleDeg = some(point.lean.map(|lean| lean.lead)),
        /// Its tilt.
        tilt_deg?: AngleDeg = some(point.lean.map(|lean| lean.tilt)),
    }

    /// A move between two segments.
    pub struct TransferFigures from transfer: &Transfer {
        /// The segment that it follows, from 1.
        after_segment: usize = transfer.after_segment,
        /// How long it takes; null where a joint speed is not known.
        duration_s: Option<TimeS> = some(transfer.duration),
        /// What the joint that turns most turns.
        travel_deg: AngleDeg = transfer.travel.into(),
        #[serde(flatten)] way: Option<TransferPath> = transfer.way.as_ref().map(Into::into),
    }

    /// How a move between segments goes round the shapes of a cell.
    pub struct TransferPath from way: &transfer_path::TransferPath {
        /// The pair that hits where no free path was found.
        blocked_by: Option<String> = way.blocked_by.as_deref().map(|[a, b]| format!("{a} and {b}")),
        /// Lines out of the cut and into it that are shorter than they should be.
        short_lines: [Option<ShortLine>; 2] = way.short_lines.each_ref().map(|found| found.as_ref().map(ShortLine::of)),
        /// Joint angles at its corners.
        joints_deg: Vec<[AngleDeg; 6]> = way.joints.iter().map(|joints| each(*joints)).collect(),
        /// Whether it begins with a line along the tool axis.
        retracts: bool = way.along_axis[0],
        /// Whether it ends with one.
        approaches: bool = way.along_axis[1],
    }

    /// A line along the tool axis that is not as long as it should be.
    pub struct ShortLine of (line: &transfer_path::ShortLine) {
        /// Its length.
        length_mm: PlaceMm = line.length.into(),
        /// The length that it should have.
        wanted_mm: PlaceMm = line.wanted.into(),
        /// Why it is shorter.
        since: String = line.end.to_string(),
    }
}
