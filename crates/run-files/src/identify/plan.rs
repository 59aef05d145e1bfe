//! The table `[plan]` of an identification file.

use super::directions::{Directions, NamedDirections};
use super::file::{IdentificationFile, PlanTable, TestTable, VolumeTable};
use super::{FitModel, Shared};
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::path::Path;
use stead_calibration::identification::design::{LoadDirections, Request, TestCases, Volume};
use stead_calibration::identification::law::Law;
use stead_calibration::identification::sheet::LoadCase;
use stead_disk::input::InputError;
use stead_format::place::{Place, required};
use stead_format::quantity::{Expects, Quantity};
use stead_format::scalars::Whole;
use stead_format::shapes::{Array, Interval, List};
use stead_format::toml_file::TomlFile;
use stead_format::units::Deg;
use stead_model::plausibility;
use stead_model::robot::Robot;
use stead_numerics::message::Note;
use stead_runs::PlanRun;

/// Configurations where the file does not say. With 20 the springs normal to the axes would be known to 1.2 to 24 % (a
/// KUKA KR 210-2 with springs in the wrist centre, random poses, 2.7 kN, 0.03 mm); with 60 to 0.7 to 13 %.
fn usual(model: FitModel) -> usize {
    match model {
        FitModel::Axes => 20,
        FitModel::Full => 60,
    }
}

/// A note on a plan of all springs: why it has so many configurations, or that it has too few.
fn asked_for(model: FitModel, size: Option<usize>) -> Option<String> {
    let usual = (model == FitModel::Full).then_some(usual(model))?;
    match size {
        None => Some(format!(
            "plan.configurations is not given: {usual} are planned and not {few}, since springs normal to the axes move the \
             reference points little, and with {few} their standard deviations are 1.7 times as large or more",
            few = self::usual(FitModel::Axes)
        )),
        Some(size) if size < usual => Some(format!(
            "plan.configurations = {size} is few for springs about three directions of every joint: {usual} are advised, since \
             springs normal to the axes move the reference points little"
        )),
        Some(_) => None,
    }
}

/// Candidates where the file does not say.
const CANDIDATES: usize = 2000;
/// Test poses where the file gives none and does not say how many to draw.
const TESTS: usize = 200;
/// Starts of the search where the file does not say.
const STARTS: usize = 8;
/// Random sets where the file does not say.
const RANDOM_SETS: usize = 1000;
/// Per cent of a compliance above which its standard deviation is large, where the file does not say; as in the report
/// of fit.
const HARDLY_PERCENT: f64 = 20.0;
/// Largest deflection where the file does not say. mm
const MAX_DEFLECTION_MM: f64 = 10.0;
/// Levels where the file does not say.
const LEVELS: usize = 5;

/// Reads an identification file for a plan: what [`read_identification`](super::read_identification) reads but the
/// sheet, which is not there yet, with `noise_mm`, and the table `[plan]`. `seed` given here takes the place of the
/// file's.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range.
pub fn read_plan(file: &Path, seed: Option<u64>) -> Result<PlanRun, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let at = document.root();
    let contents: IdentificationFile = document.read()?;
    let shared = Shared::new(&contents, &at)?;
    let noise = required!(at, contents.noise_mm)?.si();
    let plan_at = at.key("plan");
    let plan = contents.plan.as_ref().ok_or_else(|| plan_at.missing("a table [plan]"))?;
    let inputs = vec![source.as_config(), shared.robot_input.clone()];
    let odd = plausibility::arm(&shared.robot).into_iter();
    let odd = odd.chain(plausibility::force(plan.load_n.si()).map(Note::may_be_wrong));
    let size = plan.configurations.map(|count| count.count());
    let notes = shared.notes.iter().cloned().chain(asked_for(shared.model, size).map(Note::from)).chain(odd).collect();
    let mut request = plan.request(shared, noise, &plan_at)?;
    request.seed = seed.unwrap_or(request.seed);
    Ok(PlanRun {
        request,
        file: file.to_owned(),
        configurations_line: plan_at.key("configurations").line(),
        table_line: plan_at.line(),
        inputs,
        notes,
    })
}

impl PlanTable {
    fn request(&self, shared: Shared, noise: f64, at: &Place<'_>) -> Result<Request, InputError> {
        let size = self.configurations.map_or(usual(shared.model), |count| count.count());
        let candidates = self.candidates.map_or(CANDIDATES.max(size), |count| count.count());
        if candidates < size {
            let allowed = format!("at least as many as configurations = {size}");
            return Err(at.key("candidates").error("is less than there are to choose", allowed));
        }
        let robot = shared.robot;
        let tests = self.test_cases(&robot, at)?;
        let limits = limits_from(self.limits_deg, &robot, &at.key("limits_deg"))?;
        let level_joint = shared.varying.map_or(1, |(joint, _)| joint);
        let needed = shared.varying.map_or(0, |(_, law)| if matches!(law, Law::Spring(_)) { 3 } else { 1 });
        let spread =
            Spread { joint: level_joint, needed, limits: limits[level_joint], tolerance: shared.angle_tolerance };
        let loads = match &self.load_directions {
            Some(directions) => loads_from(directions, &at.key("load_directions"))?,
            None => LoadDirections::Any,
        };
        Ok(Request {
            load_point: shared.load_point,
            points: self.reference_points_mm.0.iter().map(|point| point.vector()).collect(),
            noise,
            varying: shared.varying,
            model: shared.model,
            hold: shared.hold.0,
            hold_normal: shared.hold.1,
            angle_tolerance: shared.angle_tolerance,
            level_joint,
            levels: spread.levels_from(self.levels_deg.as_ref(), &at.key("levels_deg"))?,
            limits,
            loads,
            load: self.load_n.si(),
            volume: self.volume.map_or(Volume::OPEN, |table| table.volume()),
            max_deflection: self.max_deflection_mm.map_or(MAX_DEFLECTION_MM / 1e3, Quantity::si),
            tip: self.tip_mm.map_or(shared.load_point, |tip| tip.vector()),
            tests,
            configurations: size,
            candidates,
            seed: self.seed.map_or(1, Whole::get),
            starts: self.starts.map_or(STARTS, Whole::count),
            random_sets: self.random_sets.map_or(RANDOM_SETS, Whole::count),
            max_relative_deviation: self.hardly_seen_percent.map_or(HARDLY_PERCENT / 100.0, Quantity::si),
            robot,
        })
    }

    fn test_cases(&self, robot: &Robot, at: &Place<'_>) -> Result<TestCases, InputError> {
        match (self.tests, &self.test) {
            (Some(_), Some(_)) => {
                let problem = "is the number of tests to draw, but there are tests [[plan.test]]";
                Err(at.key("tests").error(problem, "one of the two"))
            }
            (count, None) => Ok(TestCases::Drawn(count.map_or(TESTS, Whole::count))),
            (None, Some(tests)) => {
                let rows = at.key("test");
                let cases = tests.iter().zip(1..).map(|(test, number)| test.load_case(robot, &rows.element(number)));
                Ok(TestCases::Given(cases.collect::<Result<_, _>>()?))
            }
        }
    }
}

/// Limits of the measurements: those of the robot, to half a turn to either side, or narrower ones.
fn limits_from(
    given: Option<Array<Interval<Deg>, 6>>,
    robot: &Robot,
    at: &Place<'_>,
) -> Result<[[f64; 2]; 6], InputError> {
    let own: [[f64; 2]; 6] = std::array::from_fn(|j| [robot.joints()[j].min, robot.joints()[j].max]);
    let Some(Array(rows)) = given else {
        return Ok(own.map(|[min, max]| {
            let (low, high) = (min.max(-PI), max.min(PI));
            if low < high { [low, high] } else { [min, max] }
        }));
    };
    let limits = rows.map(Interval::si);
    for ((ends, number), [min, max]) in limits.iter().zip(1..).zip(own) {
        if ends[0] < min - 1e-9 || ends[1] > max + 1e-9 {
            let allowed =
                format!("two angles from {:.4} to {:.4}, the limits of the joint", min.to_degrees(), max.to_degrees());
            return Err(at.element(number).error("is outside the limits of the joint", allowed));
        }
    }
    let sums = robot.sums_within([limits[1], limits[2]]);
    if let Some(range) = robot.sum_range().filter(|range| sums[0] > range.max || sums[1] < range.min) {
        let (min, max) = (range.min.to_degrees(), range.max.to_degrees());
        let allowed = format!("angles of joints 2 and 3 whose sum can be from {min:.4} to {max:.4}");
        return Err(at.error("leaves no angles with the sum of joints 2 and 3 within its limits", allowed));
    }
    Ok(limits)
}

/// How the angles of the joint with few of them are to lie.
struct Spread {
    joint: usize,
    needed: usize,
    limits: [f64; 2],
    tolerance: f64,
}

impl Spread {
    fn levels_from(&self, given: Option<&List<Deg>>, at: &Place<'_>) -> Result<Vec<f64>, InputError> {
        let [min, max] = self.limits;
        let Some(given) = given else {
            // Whole degrees, a twentieth of the range away from its ends.
            let level = |k: usize| {
                let part = 0.05 + 0.9 * k as f64 / (LEVELS - 1) as f64;
                (min + (max - min) * part).to_degrees().round().to_radians().clamp(min, max)
            };
            return Ok(if self.needed > 0 { (0..LEVELS).map(level).collect() } else { vec![] });
        };
        let rule = format!(
            "angles of joint {} in ascending order from {:.4} to {:.4}",
            self.joint + 1,
            min.to_degrees(),
            max.to_degrees()
        );
        let levels = given.si();
        if levels.iter().any(|level| !(min - 1e-9..=max + 1e-9).contains(level)) {
            return Err(at.error("is not within the limits of the joint", rule));
        }
        if levels.windows(2).any(|pair| pair[1] - pair[0] <= self.tolerance.max(1e-9)) {
            let problem = "has angles that are not in ascending order, or no further apart than angle_tolerance_deg";
            return Err(at.error(problem, rule));
        }
        if levels.len() < self.needed {
            let problem = format!("has {} angles, from which a compensator cannot be told", levels.len());
            return Err(at.error(problem, format!("three or more {rule}")));
        }
        Ok(levels)
    }
}

fn loads_from(directions: &Directions, at: &Place<'_>) -> Result<LoadDirections, InputError> {
    match directions {
        Directions::Named(word) => Ok(match word.0 {
            NamedDirections::Any => LoadDirections::Any,
            NamedDirections::Horizontal => LoadDirections::Horizontal,
            NamedDirections::Vertical => LoadDirections::Vertical,
        }),
        Directions::Listed(list) => {
            let vectors: Vec<Vector3<f64>> = list.0.iter().map(|direction| direction.vector()).collect();
            match vectors.iter().position(|vector| vector.norm() < 1e-9) {
                Some(index) => {
                    Err(at.element(index + 1).error("is no direction: its length is zero", Directions::expected()))
                }
                None => Ok(LoadDirections::Listed(vectors.iter().map(|vector| vector.normalize()).collect())),
            }
        }
    }
}

impl VolumeTable {
    fn volume(&self) -> Volume {
        let mut volume = Volume::OPEN;
        for (ends, given) in volume.ranges.iter_mut().zip([self.x_mm, self.y_mm, self.z_mm]) {
            *ends = given.map_or(*ends, Interval::si);
        }
        Volume { min_radius: self.min_radius_mm.map_or(0.0, Quantity::si), ..volume }
    }
}

impl TestTable {
    fn load_case(&self, robot: &Robot, at: &Place<'_>) -> Result<LoadCase, InputError> {
        let theta = self.joints_deg.si();
        for (index, joint) in robot.joints().iter().enumerate() {
            if !(joint.min - 1e-9..=joint.max + 1e-9).contains(&theta[index]) {
                let (min, max) = (joint.min.to_degrees(), joint.max.to_degrees());
                let problem = format!("puts joint {} outside its limits", index + 1);
                let allowed = format!("{min:.4} to {max:.4} for joint {}", index + 1);
                return Err(at.key("joints_deg").error(problem, allowed));
            }
        }
        if let Some(range) = robot.sum_range().filter(|_| robot.beyond_sum(&theta) > 1e-9) {
            let (min, max) = (range.min.to_degrees(), range.max.to_degrees());
            let allowed = format!("{min:.4} to {max:.4} for the sum of joints 2 and 3");
            return Err(at.key("joints_deg").error("puts the sum of joints 2 and 3 outside its limits", allowed));
        }
        let force = self.force_n.vector();
        let moment = self.moment_nm.map_or_else(Vector3::zeros, |moment| moment.vector());
        if force.norm() == 0.0 && moment.norm() == 0.0 {
            return Err(at.key("force_n").error("is a load of zero", "a force, or a moment_nm, that is not zero"));
        }
        Ok(LoadCase { theta, force, moment })
    }
}
