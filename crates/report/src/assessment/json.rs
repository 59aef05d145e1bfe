//! The JSON documents of an assessment: what `stead assess --json` prints, and `summary.json`.

use super::AssessmentContext;
use crate::document::{Document, Timing};
use crate::figure::{DeflectionMm, ForceN, MomentNm, PlaceMm, Plain, TimeS, each, some};
use crate::word::Word;
use serde_json::Value;
use stead_assessment::benchmark::{Benchmark, LimitsAt, StiffnessModel, Turning};
use stead_assessment::comparison::{Assessment, Comparison, Configuration, ElbowNames, MapPoint, RobotResult, Zones};
use stead_assessment::published::Agreement;
use stead_assessment::ranking::{Accuracy, Capable};

records! {
    /// An assessment of robots.
    pub struct AssessmentFigures of (assessment: &Assessment, context: &AssessmentContext) {
        let accuracies = assessment.accuracies.iter().map(AccuracyFigures::of);
        let selection = assessment.capable.iter().map(SelectionFigures::of);
        let agreement = context.published.as_ref();
    } with {
        /// The robots.
        robots: Vec<RobotFigures> = assessment.robots.iter().map(Into::into).collect(),
        /// Their names, the best first.
        order: Vec<String> = assessment.order.clone(),
        /// Circularities at the best place, in proportion to the force.
        accuracies: Vec<AccuracyFigures> = accuracies.collect(),
        /// The robots that suit an accuracy and a force.
        selection: Vec<SelectionFigures> = selection.collect(),
        /// How far published tables agree.
        reference: Option<AgreementFigures> =
            agreement.map(|(published, agreement)| AgreementFigures::of(&published.source, agreement)),
        /// What was compared.
        benchmark?: BenchmarkFigures = None,
        /// Threads used.
        threads?: usize = None,
        /// Time on the clock.
        wall_s?: TimeS = None,
    }

    /// The circularity of a robot under a force.
    pub struct AccuracyFigures of (cell: &Accuracy) {
        /// Name of the robot.
        robot: String = cell.robot.clone(),
        /// Magnitude of the force.
        force_n: ForceN = cell.force.into(),
        /// Its circularity; null where the force is above the payload.
        circularity_mm: Option<DeflectionMm> = some(cell.circularity),
    }

    /// The robots that suit an accuracy and a force.
    pub struct SelectionFigures of (cell: &Capable) {
        /// Circularity that is required.
        accuracy_mm: DeflectionMm = cell.accuracy.into(),
        /// Magnitude of the force.
        force_n: ForceN = cell.force.into(),
        /// Names of the robots that reach it.
        robots: Vec<String> = cell.robots.clone(),
    }

    /// A robot of an assessment.
    pub struct RobotFigures from robot: &RobotResult {
        /// Its name.
        name: String = robot.name.clone(),
        /// Rated payload; null where it is not known. kg
        payload_kg: Option<f64> = robot.data_sheet.payload,
        /// Its working radius.
        working_radius_mm: PlaceMm = robot.working_radius.into(),
        /// Price; null where it is not known. EUR
        price_eur: Option<f64> = robot.data_sheet.price,
        /// Its results by posture and load.
        configurations: Vec<ConfigurationFigures> = robot.configurations.iter().map(Into::into).collect(),
    }

    /// A configuration of a robot: a posture under a load.
    pub struct ConfigurationFigures from configuration: &Configuration {
        let value = |spot: Option<MapPoint>| some(spot.map(|spot| spot.circularity));
        let place = |spot: Option<MapPoint>| spot.map(|spot| spot.centre.into());
    } with {
        /// Posture of the elbow.
        elbow: String = configuration.elbow.word().to_owned(),
        /// The load: `test` or `rated`.
        load: String = configuration.load.word().to_owned(),
        /// Magnitude of the force.
        force_n: ForceN = configuration.force.into(),
        /// Places of the map at which the circle can be milled.
        circles: usize = configuration.circles,
        /// Places at which the arm is too compliant for a result.
        circles_too_soft: usize = configuration.too_soft,
        /// Least circularity over the map.
        min_mm: Option<DeflectionMm> = value(configuration.min),
        /// Place of the least circularity.
        min_at: Option<PlanePlace> = place(configuration.min),
        /// Largest circularity over the map.
        max_mm: Option<DeflectionMm> = value(configuration.max),
        /// Place of the largest circularity.
        max_at: Option<PlanePlace> = place(configuration.max),
        /// Circularity in the middle of the map.
        middle_mm: Option<DeflectionMm> = value(configuration.middle),
        /// Place of the middle of the map.
        middle_at: Option<PlanePlace> = place(configuration.middle),
        /// Square zones.
        zones: Vec<ZoneFigures> = configuration.zones.iter().map(Into::into).collect(),
    }

    /// A place in the coordinates of the plane.
    pub struct PlanePlace from place: [f64; 2] {
        /// Coordinate along x of the plane.
        x_mm: PlaceMm = place[0].into(),
        /// Coordinate along y of the plane.
        y_mm: PlaceMm = place[1].into(),
    }

    /// Square zones of a size.
    pub struct ZoneFigures from zones: &Zones {
        /// Side of the square zone.
        size_mm: PlaceMm = zones.side.into(),
        /// Largest circularity in the best zone of this size; null where none fits.
        optimal_mm: Option<DeflectionMm> = some(zones.optimal.map(|zone| zone.largest)),
        /// Centre of the best zone.
        optimal_at: Option<PlanePlace> = zones.optimal.map(|zone| zone.centre.into()),
        /// Largest circularity in the zone in the middle of the map; null where it does not fit.
        middle_mm: Option<DeflectionMm> = some(zones.middle.map(|zone| zone.largest)),
        /// Centre of the zone in the middle.
        middle_at: Option<PlanePlace> = zones.middle.map(|zone| zone.centre.into()),
    }

    /// How far published tables agree.
    pub struct AgreementFigures of (source: &str, agreement: &Agreement) {
        let (cells, same) = agreement.accuracies;
        let (capable, same_capable) = agreement.capable;
    } with {
        /// Publication of the tables.
        source: String = source.to_owned(),
        /// Relative difference of all readings, root mean square. %
        rms_percent: Plain = Plain(agreement.rms * 100.0),
        /// Published circularities compared.
        readings: usize = agreement.readings,
        /// Circularities that only the publication or only this assessment has.
        readings_on_one_side_only: usize = agreement.one_sided,
        /// Names of the robots in the published order.
        order: Vec<String> = agreement.order.clone(),
        /// Whether the most accurate robot is the same.
        same_best: bool = agreement.same_best,
        /// Whether the least accurate robot is the same.
        same_worst: bool = agreement.same_worst,
        /// Whether the order of all robots is the same.
        same_order: bool = agreement.same_order,
        /// Cells of the accuracy table compared.
        accuracy_cells: usize = cells,
        /// Cells of it that round to the published figure.
        accuracy_cells_that_round_alike: usize = same,
        /// Cells of the selection table compared.
        selection_cells: usize = capable,
        /// Cells of it with the same robots.
        selection_cells_with_the_same_robots: usize = same_capable,
    }

    /// What was compared: a circle in a plane, the load on it, and the map of its places.
    pub struct BenchmarkFigures of (comparison: &Comparison, range_share: Option<f64>) {
        let Benchmark {
            radius, points, wrench, turning, base_from_tool, yielding, limits_at, stiffness, ..
        } = &comparison.benchmark;
        let tool_axis = -base_from_tool.column(2).into_owned();
    } with {
        /// The plane, in the base frame.
        plane: PlaneFigures = PlaneFigures::of(comparison),
        /// Radius of the programmed circle.
        radius_mm: PlaceMm = (*radius).into(),
        /// Number of points on the circle.
        points: usize = *points,
        /// The force on the tool.
        force_n: [ForceN; 3] = each(wrench.force.into()),
        /// The moment about the tool centre point.
        moment_nm: [MomentNm; 3] = each(wrench.moment.into()),
        /// How the force turns with the direction of feed.
        force_turns: Word<Turning> = Word::from(*turning),
        /// Which point follows the circle: `tool` or `wrist-centre`.
        traced: &'static str = if comparison.benchmark.flange_from_tool.is_some() { "tool" } else { "wrist-centre" },
        /// The tool axis, from the workpiece to the robot.
        tool_axis: [Plain; 3] = each(tool_axis.into()),
        /// At which points of the circle joint limits are checked.
        limits_at: Word<LimitsAt> = Word::from(*limits_at),
        /// How the postures of the elbow are named: by geometry or swapped.
        elbow_names: Word<ElbowNames> = Word::from(comparison.elbow_names),
        /// Numbers of the compliant joints, from 1.
        joints: Vec<usize> = (1..=6).filter(|joint| yielding[joint - 1]).collect(),
        /// Where a range of compliance was replaced by one value of it: how far from its smaller to its larger end.
        range_share: Option<f64> = range_share,
        /// Whether the stiffness that the load itself adds is included.
        loaded: bool = *stiffness == StiffnessModel::Loaded,
        /// The rated load as a share of the payload.
        rated_share: f64 = comparison.rated_share,
        /// Gravity. m/s2
        gravity_m_per_s2: f64 = comparison.selection.gravity,
        /// Share of the deflection that remains after compensation.
        remaining_share: f64 = comparison.selection.remaining_share,
        /// The map of places of the circle.
        map: MapFigures = MapFigures::of(comparison),
    }

    /// A plane.
    pub struct PlaneFigures of (comparison: &Comparison) {
        /// Origin of the plane.
        origin_mm: [PlaceMm; 3] = each(comparison.benchmark.plane.origin.into()),
        /// Direction of its x axis.
        x: [Plain; 3] = each(comparison.benchmark.plane.x.into()),
        /// Direction of its y axis.
        y: [Plain; 3] = each(comparison.benchmark.plane.y.into()),
    }

    /// The map of the places of the circle: its ends and its step.
    pub struct MapFigures of (comparison: &Comparison) {
        let last = comparison.grid.at(comparison.grid.counts.map(|count| (count - 1) as f64));
        let ends = |axis: usize| each([comparison.grid.origin[axis], last[axis]]);
    } with {
        /// First and last place along x.
        x_mm: [PlaceMm; 2] = ends(0),
        /// First and last place along y.
        y_mm: [PlaceMm; 2] = ends(1),
        /// Distance between neighbouring places.
        step_mm: PlaceMm = comparison.grid.step.into(),
    }
}

/// What `stead assess --json` prints.
pub fn assess_json(assessment: &Assessment, context: &AssessmentContext, timing: &Timing) -> Value {
    let (threads, wall_s) = (Some(timing.threads), Some(timing.wall.into()));
    document(context, assessment, AssessmentFigures { threads, wall_s, ..AssessmentFigures::of(assessment, context) })
}

/// The content of `summary.json`: byte for byte the same for the same inputs.
pub fn summary_json(comparison: &Comparison, assessment: &Assessment, context: &AssessmentContext) -> Value {
    let benchmark = Some(BenchmarkFigures::of(comparison, context.range_share));
    document(context, assessment, AssessmentFigures { benchmark, ..AssessmentFigures::of(assessment, context) })
}

fn document(context: &AssessmentContext, assessment: &Assessment, figures: AssessmentFigures) -> Value {
    Document::new(&context.inputs).notes(&context.notes).warnings(&assessment.warnings).with(figures)
}
