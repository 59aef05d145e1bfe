//! A result for the tests of this room: the five-segment task at the published optimum and at a place chosen to be bad,
//! planned by a shortest path over the grid, with an invented search.

pub use stead_document::testing::assert_well_formed;

use crate::placement::Context;
use std::sync::OnceLock;
use stead_disk::input::InputFile;
use stead_model::cutting::{Cutter, CuttingForce, Engagement, ForceHistory, RakeFace, Rotation};
use stead_model::published::Published;
use stead_model::robot::{Posture, Robot, angles::yaw_from_q4, turns::Range};
use stead_placement::outcome::*;
use stead_placement::sensitivity::{About, Spring, SpringSlope};
use stead_planning::feasibility::{DeflectionMap, MapCell, MapReason};
use stead_planning::feed::{CutFeed, FeedLimit, FeedLimitKind};
use stead_problem::constraints::{ConstraintKind, on_joints, on_state};
use stead_problem::evaluate::reference::State;
use stead_problem::joint_travel::JointTravel;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::{BySense, Sense};
use stead_problem::settings::{SearchSettings, TransferSettings};
use stead_problem::testing::five_segments;

/// Grid steps of beta from point to point.
const STEPS: i64 = 4;

/// The problem of the result: the paper's, with narrower limits of joints 5 and 6 and a largest deflection, so that
/// every reason against a state occurs.
pub fn problem() -> &'static Problem {
    static PROBLEM: OnceLock<Problem> = OnceLock::new();
    PROBLEM.get_or_init(|| {
        let mut problem = five_segments();
        let mut joints = problem.robot.joints().clone();
        for (j, limit_deg) in [(4, 75.0_f64), (5, 120.0)] {
            (joints[j].min, joints[j].max) = (-limit_deg.to_radians(), limit_deg.to_radians());
        }
        problem.robot = Robot::new("KUKA KR270-2", joints).unwrap();
        problem.constraints.max_deflection = Some(4.5e-3);
        problem
    })
}

/// The result.
pub fn outcome() -> &'static Outcome {
    static OUTCOME: OnceLock<Outcome> = OnceLock::new();
    OUTCOME.get_or_init(|| {
        let best = Grid::new(Placement { x: 2.2e-3, y: -1.6435, z: -0.5564, yaw: yaw_from_q4(0.9258) });
        let worst = Grid::new(Placement { x: -0.18, y: -2.0, z: -0.25, yaw: 0.6 });
        let cases = Cases {
            best: best.case(Sense::Min, Sense::Min),
            best_worst_plan: best.case(Sense::Min, Sense::Max),
            worst: Some(BySense::from_fn(|sense| worst.case(Sense::Max, sense))),
        };
        let [low, high] = [0, 1].map(|k| cases.optima()[k].plan.mean);
        let mut convergence = Vec::new();
        for (sense, end) in [(Sense::Min, low), (Sense::Max, high)] {
            convergence.extend((0..=51).map(|k| generation(sense, end, k)));
        }
        let refinements =
            Sense::BOTH.into_iter().zip(cases.optima()).map(|(sense, case)| refinement(sense, case)).collect();
        Outcome {
            cases,
            tried_setups: Vec::new(),
            lookup_summary: None,
            path_levels: None,
            convergence,
            refinements,
            maps: Some(vec![best.map(), worst.map()]),
            lean_map: None,
            sheet: None,
            evaluations: 12480,
            states: 157_248_000,
            interrupted: false,
            sensitivity: None,
            sets: Vec::new(),
            set_basins: Vec::new(),
            notes: Vec::new(),
            warnings: Vec::new(),
        }
    })
}

/// What goes with the result.
pub fn context() -> Context {
    let input = |role: &'static str, name: &str| InputFile { role, name: name.to_owned(), sha256: "0".repeat(64) };
    Context {
        notes: Vec::new(),
        warnings: Vec::new(),
        stated: serde_json::json!({ "robot": "kuka-kr270-2.toml" }),
        inputs: vec![input("config", "paper.toml"), input("robot", "kuka-kr270-2.toml")],
        search: SearchSettings::default(),
        transfer: TransferSettings::default(),
        reference: Some(Published {
            source: "Caro et al. 2013, Table III".to_owned(),
            figures: [0.083, 0.35, 0.82, 1.2],
        }),
        stability: None,
        removal: None,
        study_case: None,
        page: true,
    }
}

fn generation(sense: Sense, end: f64, k: usize) -> Generation {
    let left = libm::exp(-(k as f64) / 9.0);
    let ripple = 1.0 + 0.08 * libm::sin(2.1 * k as f64);
    let toward = if sense == Sense::Min { 1.0 } else { -0.25 };
    let best = (k > 0).then_some(end * (1.0 + toward * (0.01 + 2.0 * left)));
    let average = (k > 0).then_some(end * (1.05 + toward * (0.8 * ripple + 2.3 * left)));
    Generation { sense, generation: k, best, average, feasible: 2 * k, population: 120, evaluations: 120 * (k + 1) }
}

fn refinement(sense: Sense, case: &Case) -> Refinement {
    Refinement {
        sense,
        start: Placement { x: case.placement.x + 1e-3, ..case.placement },
        start_mean: case.plan.mean * 1.01,
        end: case.placement,
        end_mean: case.plan.mean,
        rounds: 2,
        iterations: 17,
        kkt_residual: Some(3.2e-10),
        statuses: vec![RefinementStatus::NoMoreGain, RefinementStatus::NoFirstOrderGain],
    }
}

/// A state in each posture, or why it is not allowed.
type Postures = [Result<State<f64>, ConstraintKind>; 8];

/// All states of a placement: for point, beta and posture the state, or why it is not allowed.
struct Grid {
    placement: Placement,
    states: Vec<Vec<Postures>>,
}

impl Grid {
    fn new(placement: Placement) -> Self {
        let betas = 0..problem().redundancy.beta_count;
        let at = |point: usize, k: usize| Posture::ALL.map(|posture| allowed(point, &placement, k, posture));
        let states = (0..problem().task.points().len()).map(|point| betas.clone().map(|k| at(point, k)).collect());
        Self { placement, states: states.collect() }
    }

    fn map(&self) -> DeflectionMap {
        let cell = |states: &Postures| {
            let allowed = states.iter().zip(Posture::ALL).filter_map(|(s, posture)| Some((s.as_ref().ok()?, posture)));
            let cells = allowed.map(|(state, posture)| MapCell { score: state.score(), posture });
            let nearest = states.iter().filter_map(|s| s.as_ref().err().copied()).max();
            let kind = nearest.unwrap_or(ConstraintKind::Reach);
            cells.min_by(|a, b| a.score.total_cmp(&b.score)).ok_or(MapReason { kind, pair: None })
        };
        let rows = self.states.iter().map(|row| row.iter().map(cell).collect()).collect();
        DeflectionMap { beta_count: problem().redundancy.beta_count, rows }
    }

    fn case(&self, placement_sense: Sense, plan_sense: Sense) -> Case {
        let sign = plan_sense.sign();
        let mut points = Vec::new();
        let mut postures = Vec::new();
        for range in problem().task.segments() {
            let plans = Posture::ALL.map(|posture| self.shortest(range.clone(), posture, sign));
            let best = plans.into_iter().zip(Posture::ALL).min_by(|a, b| a.0.0.total_cmp(&b.0.0));
            let ((cost, betas), posture) = best.unwrap();
            assert!(cost.is_finite(), "no {plan_sense:?} plan for the {placement_sense:?} placement");
            points.extend(range.clone().zip(betas).map(|(point, k)| self.plan_point(point, k, posture)));
            postures.push(posture);
        }
        let scores = || points.iter().map(|point: &PlanPoint| point.score);
        let (mean, max) = (scores().sum::<f64>() / points.len() as f64, scores().fold(0.0, f64::max));
        let plan = Plan {
            posture_words: postures.iter().map(|posture| problem().robot.posture_words(*posture)).collect(),
            postures,
            objective: mean,
            mean,
            max,
            travel: JointTravel::of(
                problem().task.path(),
                &points.iter().map(|point| point.joints).collect::<Vec<_>>(),
            ),
            percentiles: [0.8 * mean, max],
            deflection: DeflectionFigures::of(points.iter()),
            held: None,
            mean_deviation: None,
            by_origin: None,
            sag: None,
            clearance: None,
            axes: Vec::new(),
            points,
        };
        let transfer = |k: usize| {
            let duration =
                (placement_sense == Sense::Min || plan_sense == Sense::Min || k != 2).then_some(0.4 * k as f64);
            Transfer { after_segment: k, duration, travel: 0.3 * k as f64, way: None }
        };
        let limit = |k: usize| FeedLimit {
            feed: 0.08 - 0.005 * k as f64,
            kind: FeedLimitKind::Speed,
            joint: 6,
            segment: k + 1,
            point: 21 * k + 4,
        };
        let feed = CutFeed {
            programmed: problem().redundancy.feed,
            programmed_segments: vec![problem().redundancy.feed; 5],
            segments: (0..5).map(|k| (placement_sense == Sense::Min).then(|| limit(k))).collect(),
            external_axes: Vec::new(),
        };
        let cycle = Cycle { feed, cutting: 29.52, transfers: (1..5).map(transfer).collect(), unfollowed: Vec::new() };
        let (placement, setup, mean) = (self.placement, problem().setup.clone(), plan.mean);
        Case {
            placement_sense,
            plan_sense,
            placement,
            setup,
            orientation: None,
            plan,
            cycle,
            active_bounds: Some(Vec::new()),
            objective_by_stiffness: Some(
                (0..6).map(|joint| slope(joint, if joint == 0 { -mean } else { 0.0 })).collect(),
            ),
        }
    }

    /// Sum of the signed scores and the grid values of beta of the best plan through a segment in one posture.
    fn shortest(&self, range: std::ops::Range<usize>, posture: Posture, sign: f64) -> (f64, Vec<usize>) {
        let count = problem().redundancy.beta_count as i64;
        let cost = |point: usize, k: usize| {
            self.states[point][k][usize::from(posture.number()) - 1]
                .as_ref()
                .map_or(f64::INFINITY, |s| sign * s.score())
        };
        let mut sums: Vec<(f64, Vec<usize>)> = vec![(0.0, Vec::new()); count as usize];
        for point in range {
            sums = (0..count)
                .map(|k| {
                    let near = (-STEPS..=STEPS).map(|step| (k + step).rem_euclid(count) as usize);
                    let from = near.min_by(|a, b| sums[*a].0.total_cmp(&sums[*b].0)).unwrap();
                    let (sum, mut path) = sums[from].clone();
                    path.push(k as usize);
                    (sum + cost(point, k as usize), path)
                })
                .collect();
        }
        sums.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }

    fn plan_point(&self, point: usize, k: usize, posture: Posture) -> PlanPoint {
        let state = self.states[point][k][usize::from(posture.number()) - 1].as_ref().unwrap();
        let base_from_workpiece = self.placement.base_from_workpiece();
        let joints = problem().robot.joints();
        PlanPoint {
            point,
            segment: problem().task.path().segment_of(point) + 1,
            position: base_from_workpiece.point(&problem().task.points()[point].position),
            beta: stead_model::robot::angles::wrap(problem().redundancy.beta(k)),
            posture,
            posture_words: problem().robot.posture_words(posture),
            joints: std::array::from_fn(|j| Range::of(&joints[j]).nearest(state.joints[j]).0),
            inverse_condition: state.inverse_condition,
            force: base_from_workpiece.rotation * problem().task.loads()[point].wrench.force,
            deflection: state.deflection,
            feed_part: state.feed_part,
            normal_part: state.normal_part,
            axial_part: state.axial_part,
            surface_part: None,
            score: state.score(),
            deviation: state.own.deviation,
            by_origin: None,
            clearance: None,
            lean: None,
        }
    }
}

fn allowed(point: usize, placement: &Placement, k: usize, posture: Posture) -> Result<State<f64>, ConstraintKind> {
    let mut found = problem()
        .at(placement)
        .state(point, problem().redundancy.beta(k), posture)
        .map_err(|_| ConstraintKind::Reach)?;
    for (angle, joint) in found.joints.iter_mut().zip(problem().robot.joints()) {
        *angle = Range::of(joint).nearest(*angle).0;
    }
    let mut broken = on_joints(problem(), &found.joints).chain(on_state(problem(), &found));
    match broken.find(|measured| !measured.holds()) {
        Some(measured) => Err(measured.kind()),
        None => Ok(found),
    }
}

/// The force of a cutter on both sides of a slot that is open over half its width.
pub fn force_history() -> ForceHistory {
    let (helix, rake) = (20_f64.to_radians(), 5_f64.to_radians());
    let face = RakeFace { entering_angle: std::f64::consts::FRAC_PI_2, rake, friction: 0.4, normal_pressure: 750e6 };
    let cutter = Cutter::even(3, 0.005, helix, Rotation::Clockwise, face.coefficients(helix)).unwrap();
    let force = CuttingForce { cutter: &cutter, axial_depth: 5e-3, feed_per_tooth: 8e-5 };
    ForceHistory::new(&force, &Engagement::open_slot(0.005, 0.01).unwrap())
}

fn slope(joint: usize, slope: f64) -> SpringSlope {
    SpringSlope { springs: vec![Spring { joint, about: About::Z }], slope }
}
