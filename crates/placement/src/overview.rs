//! What a run states, in figures to compare with what was meant: before any search.

use nalgebra::Vector3;
use serde::Serialize;
use std::f64::consts::TAU;
use stead_cell::scene::FAR;
use stead_cell::{Attachment, Shape};
use stead_model::plausibility;
use stead_model::robot::angles::ANGLE_ROUNDING;
use stead_model::robot::turns::Range;
use stead_model::robot::{Frames, Robot};
use stead_model::stiffness::elastic::ElasticArm;
use stead_model::stiffness::whole::{WholeArm, of_part};
use stead_numerics::digits::figures;
use stead_numerics::mean_max::MeanAndMax;
use stead_numerics::message::Note;
use stead_problem::problem::{Interval, Placement, Problem};
use stead_problem::symmetry::is_axis_1_vertical;

/// What a run states of its spindle, tool path, forces and cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overview {
    /// Angle between the tool axis and the axis of the flange. rad
    pub tool_tilt: f64,
    /// Smallest and largest x, y and z of the path in the workpiece frame. m
    pub extents: [[f64; 2]; 3],
    /// Length of each segment. m
    pub segment_lengths: Vec<f64>,
    /// Smallest and largest angle between the tool axis and z of the workpiece. rad
    pub tilts: [f64; 2],
    /// Smallest and largest feed of the task, where it states its own. m/s
    pub feeds: Option<[f64; 2]>,
    /// Size of the forces. N
    pub force: MeanAndMax,
    /// Size of the moments about the tool centre point. N m
    pub moment: MeanAndMax,
    /// The farthest that the wrist centre gets from axis 1. m
    pub reach: f64,
    /// Smallest and largest distance of places of the cell from axis 1. m
    pub cell_distances: [f64; 2],
    /// The workpiece in the middle of its cell.
    pub middle: Stance,
    /// What yields of the deflection there, where not the springs about the axes alone do.
    pub yields: Option<Yields>,
    /// How far the weight of links and spindle moves the tool there, where the mass on the flange is known. m
    pub sag: Option<f64>,
    /// The shapes with the arm and the workpiece there.
    pub shapes: Vec<Stand>,
    /// Pairs of shapes that are nearer to each other there than they may be.
    pub hits: Vec<Hit>,
}

/// Shares of the deflection of the tool against the part, each along the whole of it: 1 in all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Yields {
    /// Of springs about the joint axes.
    pub axes: f64,
    /// Of springs normal to them.
    pub normal: f64,
    /// Of what carries the robot.
    pub base: f64,
    /// Of the mount of the spindle.
    pub mount: f64,
    /// Of holder and tool.
    pub tip: f64,
    /// Of the part.
    pub part: f64,
}

impl Yields {
    /// At a path point with the arm in a configuration (rad); none where springs about the axes alone yield, or nothing
    /// does.
    fn of(problem: &Problem, placement: &Placement, point: usize, joints: [f64; 6]) -> Option<Self> {
        let (robot, spindle) = (&problem.robot, &problem.spindle);
        let frames = Frames::new(robot, &joints);
        let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
        let placed = problem.placed(point, placement);
        let arm = WholeArm::new(robot, spindle, &frames, robot.compliances_at(&joints), tip);
        let by = arm.by_origin(&placed.force, &placed.moment).map(|moved| moved.linear);
        let rotation = problem.base_from_workpiece(point, placement).rotation;
        let part = problem.task.part_compliance(point).map(|matrix| of_part(matrix, &rotation, &placed.force));
        let part = part.unwrap_or_default();
        let total = by.axes + by.normal + by.base + by.mount + by.tip + part;
        let share = |moved: Vector3<f64>| moved.dot(&total) / total.norm_squared();
        let of = Self {
            axes: share(by.axes),
            normal: share(by.normal),
            base: share(by.base),
            mount: share(by.mount),
            tip: share(by.tip),
            part: share(part),
        };
        let others = [by.normal, by.base, by.mount, by.tip, part].iter().any(|moved| moved.norm() > 0.0);
        (others && of.axes.is_finite()).then_some(of)
    }
}

/// Where a shape is in one pose of the arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stand {
    /// Its name.
    pub name: String,
    /// What it moves with.
    pub attached: String,
    /// Smallest and largest x, y and z of it in the frame of the cell. m
    pub extents: [[f64; 2]; 3],
}

/// Two shapes that are nearer to each other than they may be.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hit {
    /// Their names.
    pub pair: [String; 2],
    /// Their distance; zero or less where they touch. m
    pub distance: f64,
    /// The distance that they have to keep. m
    pub required: f64,
}

/// What the arm reaches of the path at one placement, each point by itself: within the joint limits, at some free angle
/// and in some allowed posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stance {
    /// The placement.
    pub placement: Placement,
    /// How many points were tried.
    pub tried: usize,
    /// How many of them are reached.
    pub reached: usize,
    /// The first point that is reached, and the joint angles there. rad
    pub first: Option<(usize, [f64; 6])>,
}

impl Stance {
    /// The path point and the joint angles (rad) that represent it: the first that is reached, or the middle of the
    /// joint ranges.
    pub fn shown(&self, robot: &Robot) -> (usize, [f64; 6]) {
        self.first.unwrap_or_else(|| (0, robot.mid_range()))
    }
}

/// Most points of a path that are tried.
const TRIED: usize = 200;
/// Free angles that are tried at each.
const ANGLES: usize = 36;

impl Overview {
    /// That of a problem.
    pub fn of(problem: &Problem) -> Self {
        let points = problem.task.points();
        let extents = std::array::from_fn(|axis| range(points.iter().map(|point| point.position[axis])));
        let path = problem.task.path();
        let sizes = |of: fn(&stead_model::task::Wrench) -> f64| MeanAndMax::of(problem.task.wrenches().map(of));
        let tool = &problem.spindle.flange_from_tool.rotation;
        let moves = || path.segments().iter().flat_map(|segment| segment.clone().skip(1));
        let has_feeds = moves().next().is_some_and(|point| path.feed(point).is_some());
        let middle = stance(problem, middle(problem));
        let (shapes, hits) = shapes(problem, &middle);
        let (point, joints) = middle.shown(&problem.robot);
        let arm = ElasticArm::new(&problem.robot, &problem.spindle).in_gravity(problem.free_fall(point));
        let sag = problem.spindle.carried_mass().map(|_| arm.sag(&joints).linear.norm());
        Self {
            tool_tilt: libm::acos(tool.m33.clamp(-1.0, 1.0)),
            extents,
            segment_lengths: (0..path.segments().len()).map(|segment| path.segment_length(segment)).collect(),
            tilts: range(points.iter().map(|point| libm::acos(point.axis.z.clamp(-1.0, 1.0)))),
            feeds: has_feeds.then(|| range(moves().filter_map(|point| path.feed(point)))),
            force: sizes(|wrench| wrench.force.norm()),
            moment: sizes(|wrench| wrench.moment.norm()),
            reach: problem.robot.geometry().reach(),
            cell_distances: cell_distances(problem),
            yields: Yields::of(problem, &middle.placement, point, joints),
            sag,
            middle,
            shapes,
            hits,
        }
    }

    /// What looks wrong beyond [`Problem::notes`], in sentences.
    pub fn notes(&self) -> Vec<Note> {
        let Stance { tried, reached, .. } = self.middle;
        let unreached = (reached < tried).then(|| {
            format!(
                "with the workpiece in the middle of its cell the arm reaches {reached} of {tried} path points within its joint \
                 limits, at any angle about the tool: `stead explain` says why at a placement"
            )
        });
        let hit = |hit: &Hit| {
            let [a, b] = &hit.pair;
            match hit.distance > 0.0 {
                true => {
                    let [distance, required] = [hit.distance, hit.required].map(|length| figures(length * 1e3));
                    format!("{a} and {b} ({distance} mm apart, {required} mm required)")
                }
                false => format!("{a} and {b} (touching)"),
            }
        };
        let more = self.hits.len().saturating_sub(NAMED);
        let hits = (!self.hits.is_empty()).then(|| {
            let named: Vec<String> = self.hits.iter().take(NAMED).map(hit).collect();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let at = self.middle.first.map_or_else(
                || "with the arm in the middle of its joint ranges".to_owned(),
                |(point, _)| format!("with the arm at point {point}"),
            );
            format!(
                "{at} and the workpiece in the middle of its cell, shapes hit: {}{more}; pairs that always touch can \
                 be left out with \
                 collision.ignore",
                named.join(", ")
            )
        });
        let sags = self.sag.and_then(plausibility::sag);
        unreached.into_iter().chain(hits).chain(sags).map(Note::may_be_wrong).collect()
    }
}

/// Pairs that are named in a note at the most.
const NAMED: usize = 8;

/// Where the shapes of a run are with the arm and the workpiece as they are shown, and which are too near to each
/// other.
fn shapes(problem: &Problem, middle: &Stance) -> (Vec<Stand>, Vec<Hit>) {
    let Some(scene) = problem.scene.as_deref() else { return (Vec::new(), Vec::new()) };
    let (point, joints) = middle.shown(&problem.robot);
    let poses = problem.poses(scene, point, &middle.placement, &joints);
    let cell_from_base = poses.of(Attachment::Base).inverse();
    let stand = |shape: &Shape| {
        let [low, high] = shape.solid.extent_at(&cell_from_base.then(poses.of(shape.attached)).then(&shape.pose));
        let attached = match shape.attached {
            Attachment::Axis(number) => problem.external_axes.get(usize::from(number)).map(|axis| axis.name.clone()),
            _ => None,
        };
        Stand {
            name: shape.name.clone(),
            attached: attached.unwrap_or_else(|| shape.attached.to_string()),
            extents: std::array::from_fn(|axis| [low[axis], high[axis]]),
        }
    };
    let hits = scene.pairs().iter().enumerate().filter(|(number, _)| !scene.keeps_apart(*number, &poses));
    let hits = hits.map(|(number, pair)| Hit {
        pair: (*pair.names).clone(),
        distance: scene.distance(number, &poses, FAR),
        required: pair.required,
    });
    (scene.surroundings().shapes().iter().map(stand).collect(), hits.collect())
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// The middle of the cell.
fn middle(problem: &Problem) -> Placement {
    let [x, y, z] = problem.cell.position.map(|bounds| (bounds.min + bounds.max) / 2.0);
    let yaw = problem.cell.yaw;
    Placement { x, y, z, yaw: (yaw.min + yaw.max) / 2.0 }
}

/// Projections between cell and axis 1 until the nearest place is found.
const PROJECTIONS: usize = 500;

/// From the nearest to the farthest place of the cell, from axis 1.
fn cell_distances(problem: &Problem) -> [f64; 2] {
    let root = problem.robot.geometry().root_in_base;
    let [x, y, z] = problem.cell.position;
    if !is_axis_1_vertical(problem) {
        // The nearest place of a box to a line, by projections onto one and the other; the farthest is a corner.
        let axis = problem.robot.geometry().base_from_root.column(2).into_owned();
        let inside = |p: &Vector3<f64>| Vector3::new(x.clamp(p.x), y.clamp(p.y), z.clamp(p.z));
        let on_axis = |p: &Vector3<f64>| root + axis * axis.dot(&(p - root));
        let nearest = (0..PROJECTIONS).fold(inside(&root), |place, _| inside(&on_axis(&place)));
        let corners = (0..8).map(|corner: u32| {
            let end = |bounds: Interval, bit: u32| if corner >> bit & 1 == 1 { bounds.max } else { bounds.min };
            problem.base_distance(&Vector3::new(end(x, 0), end(y, 1), end(z, 2)))
        });
        return [problem.base_distance(&nearest), corners.fold(0.0, f64::max)];
    }
    let nearest = [x.clamp(root.x) - root.x, y.clamp(root.y) - root.y];
    let farthest = [(x, root.x), (y, root.y)].map(|(bounds, at)| (bounds.min - at).abs().max((bounds.max - at).abs()));
    [nearest, farthest].map(|[x, y]| libm::hypot(x, y))
}

fn stance(problem: &Problem, placement: Placement) -> Stance {
    let count = problem.task.points().len();
    let tried = count.min(TRIED);
    let points = (0..tried).map(|k| k * count / tried);
    let found = points.map(|point| reached(problem, &placement, point).map(|joints| (point, joints)));
    let mut stance = Stance { placement, tried, reached: 0, first: None };
    for found in found.flatten() {
        stance.reached += 1;
        stance.first = stance.first.or(Some(found));
    }
    stance
}

/// The joint angles within the limits that reach a point, those of the largest distance from a limit.
fn reached(problem: &Problem, placement: &Placement, point: usize) -> Option<[f64; 6]> {
    let betas = (0..ANGLES).map(|k| TAU * k as f64 / ANGLES as f64);
    let flanges = betas.map(|beta| problem.at(placement).base_from_flange(point, beta));
    let allowed = || problem.postures.allowed();
    flanges
        .flat_map(|flange| allowed().filter_map(move |posture| problem.robot.inverse(&flange, posture).ok()))
        .filter_map(|wrapped| within(&problem.robot, &wrapped))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(joints, _)| joints)
}

/// The real angles of wrapped ones, and their smallest distance from a limit; none beyond the limits. rad
fn within(robot: &Robot, wrapped: &[f64; 6]) -> Option<([f64; 6], f64)> {
    let (mut joints, mut margin) = (*wrapped, f64::INFINITY);
    for (angle, joint) in joints.iter_mut().zip(robot.joints()) {
        let middle = (joint.min + joint.max) / 2.0;
        let off = |real: &f64| (real - middle).abs();
        *angle = Range::of(joint).real_angles(*angle).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        margin = margin.min((*angle - joint.min).min(joint.max - *angle));
    }
    if let Some(range) = robot.sum_range() {
        let sum = robot.sum_of(&joints);
        margin = margin.min((sum - range.min).min(range.max - sum));
    }
    (margin >= -ANGLE_ROUNDING).then_some((joints, margin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::robot::PointMass;
    use stead_problem::testing::{Beside, five_segments, with_beside};

    #[test]
    fn the_published_run_is_understood() {
        let problem = five_segments();
        let overview = Overview::of(&problem);
        assert!((overview.tool_tilt.to_degrees() - 45.0).abs() < 1e-4);
        assert_eq!(overview.segment_lengths.len(), 5);
        assert_eq!(overview.tilts, [0.0, 0.0]);
        assert!((overview.force.max - problem.task.loads()[0].wrench.force.norm()).abs() < 1e3);
        assert!(overview.reach > 2.6 && overview.cell_distances[0] < overview.cell_distances[1]);
        assert_eq!(overview.middle.tried, 105);
        // What is said to be reached is: the flange is where the first point wants it.
        let (point, joints) = overview.middle.first.unwrap();
        assert_eq!((point, overview.feeds, overview.shapes.len()), (0, None, 0));
        let tool = problem.robot.forward(&joints).then(&problem.spindle.flange_from_tool);
        let place = overview.middle.placement.base_from_workpiece().point(&problem.task.points()[0].position);
        assert!((tool.translation - place).norm() < 1e-9);
    }

    #[test]
    fn what_yields_and_how_far_the_weight_moves_the_tool_is_said() {
        assert_eq!(Overview::of(&five_segments()).yields, None);
        let problem = with_beside(five_segments(), Beside::Everything);
        let Yields { axes, normal, base, mount, tip, part } = Overview::of(&problem).yields.unwrap();
        let all = [axes, normal, base, mount, tip, part];
        assert!((all.iter().sum::<f64>() - 1.0).abs() < 1e-12 && all.iter().all(|share| *share != 0.0), "{all:?}");
        let carrying = |mass: f64| {
            let mut problem = five_segments();
            problem.spindle.point_mass = Some(PointMass { mass, centre: Vector3::new(0.0, 0.0, 0.2) });
            Overview::of(&problem)
        };
        let [light, heavy] = [60.0, 6e5].map(carrying);
        let ratio = heavy.sag.unwrap() / light.sag.unwrap();
        assert!((ratio / 1e4 - 1.0).abs() < 0.1, "{ratio}");
        assert!(!light.notes().iter().any(|note| note.contains("sag")));
        assert!(
            heavy.notes().iter().any(|note| note.starts_with("the sag of the tool by the weight")),
            "{:?}",
            heavy.notes()
        );
    }

    #[test]
    fn a_cell_out_of_reach_is_noted() {
        let mut problem = five_segments();
        problem.cell.position[0] = stead_problem::problem::Interval { min: 9.0, max: 9.5 };
        let overview = Overview::of(&problem);
        assert_eq!((overview.middle.reached, overview.middle.first), (0, None));
        assert!(overview.notes()[0].contains("reaches 0 of 105 path points"));
    }
}
