use super::*;
use crate::redundancy::Planner;
use stead_cell::testing::{kr270_shapes, scene_of, shape};
use stead_cell::tool_scene::{Cylinder, SegmentMoves, ToolBody};
use stead_cell::{Attachment, Solid};
use stead_model::task::{Task, ToolPath, Wrench};
use stead_problem::sense::Sense;
use stead_problem::testing::five_segments;

fn plans(problem: &Problem, placement: &Placement) -> Vec<SegmentPlan> {
    let free = problem.clone().with(|parts| parts.scene = None);
    let planner = Planner::new(&free);
    planner.plan(placement, Sense::Min, None, &mut planner.workspace()).unwrap()
}

#[test]
fn a_way_around_a_wall_between_two_segments_is_found_and_free() {
    let placement = Placement::from([0.1, -1.9, -0.4, 1.0]);
    let mut problem = five_segments();
    let free = plans(&problem, &placement);
    // A plate upright between the ends of the tool, wherever these are.
    let [a, b] = [&free[0], &free[2]].map(|plan| problem.placed(plan.points.start, &placement).tip);
    let middle = (a + b) / 2.0;
    let mut plate = shape("plate", Attachment::Base, Solid::Box(Vector3::new(0.01, 0.5, 0.5)), middle.into());
    let across = (b - a).cross(&Vector3::z()).normalize();
    let along = (b - a).normalize();
    plate.pose.rotation = nalgebra::Matrix3::from_columns(&[along, across, along.cross(&across)]);
    let shapes = kr270_shapes().into_iter().filter(|s| s.name == "spindle").chain([plate]).collect();
    problem.scene = Some(Arc::new(scene_of(shapes, 0.005)));
    let found = transfer_path(&problem, &placement, [&free[0], &free[2]], 1).unwrap();
    let scene = problem.scene.as_deref().unwrap();
    let workpiece = placement.base_from_workpiece();
    if found.blocked_by.is_none() {
        assert!(found.joints.len() > 2);
        for pair in found.joints.windows(2).skip(1).take(found.joints.len() - 3) {
            let [a, b] = [0, 1].map(|end| scene.poses(&pair[end], &workpiece));
            assert!(scene.motion((&pair[0], &a), (&pair[1], &b)).is_none());
            for share in [0.25, 0.5, 0.75] {
                let joints: [f64; 6] = std::array::from_fn(|j| pair[0][j] + share * (pair[1][j] - pair[0][j]));
                let near = scene.clearance(&scene.poses(&joints, &workpiece), &PairKind::ALL);
                assert!(near.is_none_or(|near| near.distance > 0.0));
            }
        }
    }
    assert_eq!(found.blocked_by, None);
    assert_eq!(transfer_path(&problem, &placement, [&free[0], &free[2]], 1), Some(found));
}

#[test]
fn external_axes_move_before_the_joints_on_a_way_and_with_them_on_the_direct_move() {
    let [end, a, via, b, start] = [0.0, 1.0, 2.0, 3.0, 4.0].map(|angle| [angle; 6]);
    let (out, into, over) = ([end, a], [start, b], [a, via, b]);
    let found = |over: &[[f64; 6]], are_moved| {
        let way = joined(&out, over, &into, are_moved);
        (way.joints.clone(), way.axes_from, [1, 2, way.joints.len() - 1].map(|place| way.is_along_axis(place)))
    };
    let along = [true, false, true];
    assert_eq!(found(&[], true), (vec![end, a, b, start], 2, along));
    assert_eq!(found(&[], false), (vec![end, a, b, start], 2, along));
    assert_eq!(found(&over, true), (vec![end, a, a, via, b, start], 2, along));
    assert_eq!(found(&over, false), (vec![end, a, via, b, start], 2, along));
    // Nothing moves but the axes, or nothing at all.
    assert_eq!(joined(&[end], &[], &[end], true).joints, [end, end]);
    assert_eq!(joined(&[end], &[], &[end], false).joints, [end, end]);
}

#[test]
fn without_obstacles_the_move_is_retraction_joint_move_approach() {
    let placement = Placement::from([0.1, -1.9, -0.4, 1.0]);
    let mut problem = five_segments();
    let free = plans(&problem, &placement);
    assert_eq!(transfer_path(&problem, &placement, [&free[0], &free[1]], 1), None);
    let spindle = kr270_shapes().into_iter().filter(|s| s.name == "spindle").collect();
    problem.scene = Some(Arc::new(scene_of(spindle, 0.005)));
    let found = transfer_path(&problem, &placement, [&free[0], &free[1]], 1).unwrap();
    assert_eq!((found.joints.len(), found.along_axis, found.blocked_by), (4, [true; 2], None));
    let tip = |joints: &[f64; 6]| problem.robot.forward(joints).point(&problem.spindle.flange_from_tool.translation);
    let end = problem.placed(free[0].points.end - 1, &placement);
    assert!((tip(&found.joints[1]) - end.tip - end.axes.column(2) * problem.segment_moves.retract).norm() < 1e-9);
}

/// A cut on the floor of each of two pockets beside each other, 90 mm deep with a wall from x = -30 to 30 mm, and
/// one on top.
fn two_pockets() -> Problem {
    let mut problem = five_segments();
    let row = |x: f64, z: f64, step: usize| PathPoint {
        position: Vector3::new(x, 0.01 * step as f64, z),
        feed: Vector3::y(),
        axis: Vector3::z(),
    };
    let starts = [(1, -0.08, -0.09), (2, 0.08, -0.09), (3, 0.08, 0.0)];
    let points = starts.into_iter().flat_map(|(segment, x, z)| (0..5).map(move |k| (segment, row(x, z, k))));
    let wrenches = vec![Wrench { force: Vector3::new(10.0, 50.0, 20.0), moment: Vector3::zeros() }; 15];
    problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
    problem
}

/// The wall and the floor of the pockets.
fn pocketed_part() -> [stead_cell::Shape; 2] {
    let part = |name: &str, edges: [f64; 3], z: f64| {
        shape(name, Attachment::Workpiece, Solid::Box(edges.into()), [0.0, 0.0, z])
    };
    [part("wall", [0.06, 0.3, 0.09], -0.045), part("floor plate", [0.4, 0.3, 0.02], -0.101)]
}

/// With its spindle above a cutter of 20 mm by 40 mm, and a shank.
fn with_tool(mut problem: Problem, part: &[stead_cell::Shape], tool: ToolBody) -> Problem {
    let spindle = shape("spindle", Attachment::Flange, Solid::Cylinder { radius: 0.06, length: 0.3 }, [0.0, 0.0, 0.2]);
    problem.scene = Some(Arc::new(scene_of([&[spindle], part].concat(), 0.002)));
    let flange_from_tool = problem.spindle.flange_from_tool;
    let scene = problem.scene.as_deref().unwrap();
    let tool = ToolScene::new(&problem.robot, &flange_from_tool, scene, problem.task.path(), tool).unwrap();
    problem.segment_moves.tool = Some(Arc::new(tool));
    problem
}

fn end_mill() -> ToolBody {
    let [cutter, shank] =
        [(0.01, 0.0, 0.04), (0.008, 0.04, 0.15)].map(|(radius, from, to)| Cylinder { radius, from, to });
    ToolBody { cutter: Some(cutter), holder: vec![shank], ..ToolBody::default() }
}

/// The least height of the tool centre point above the top of the part, in the workpiece frame, while it is over
/// the wall. m
fn least_height_over_the_wall(problem: &Problem, placement: &Placement, joints: &[[f64; 6]]) -> f64 {
    let workpiece = placement.base_from_workpiece().inverse();
    let tool = problem.spindle.flange_from_tool.translation;
    let heights = joints.windows(2).flat_map(|pair| {
        (0..=400).filter_map(|step| {
            let share = f64::from(step) / 400.0;
            let at: [f64; 6] = std::array::from_fn(|j| pair[0][j] + share * (pair[1][j] - pair[0][j]));
            let tip = workpiece.point(&problem.robot.forward(&at).point(&tool));
            (tip.x.abs() < 0.03).then_some(tip.z)
        })
    });
    heights.fold(f64::INFINITY, f64::min)
}

#[test]
fn between_deep_pockets_the_tool_goes_over_the_wall() {
    let placement = Placement::from([0.0, -1.9, -0.4, 0.3]);
    let bare = two_pockets();
    let made = plans(&bare, &placement);
    let tools = [ToolBody::default(), end_mill()];
    for part in [&pocketed_part()[..], &[]] {
        for tool in &tools {
            let problem = with_tool(two_pockets(), part, tool.clone());
            let found = transfer_path(&problem, &placement, [&made[0], &made[1]], 0).unwrap();
            assert_eq!(found.blocked_by, None);
            assert_eq!(found.short_lines, [None, None]);
            let height = least_height_over_the_wall(&problem, &placement, &found.joints);
            assert!(height > 0.0015, "{} mm, {} shapes, {tool:?}", height * 1e3, part.len());
            assert_eq!(
                problem.segment_moves.tool.as_deref().unwrap().notes().len(),
                usize::from(part.is_empty()) + usize::from(tool.cutter.is_none())
            );
        }
    }
    // Without the part that is a move through the wall.
    let problem = with_tool(two_pockets(), &[], ToolBody::default());
    let unaware = problem.with(|parts| parts.segment_moves = SegmentMoves::default());
    let found = transfer_path(&unaware, &placement, [&made[0], &made[1]], 0).unwrap();
    assert!(least_height_over_the_wall(&unaware, &placement, &found.joints) < -0.02);
}

#[test]
fn a_line_out_counts_only_what_is_deeper_than_at_the_path_point() {
    let problem = two_pockets();
    let point = problem.task.points()[0];
    let hit = |part: &[stead_cell::Shape], tool: ToolBody, length: f64| {
        let problem = with_tool(problem.clone(), part, tool);
        let names = problem.segment_moves.tool.as_deref().unwrap().line_hit(&point, length)?;
        Some(names[1].clone())
    };
    let cutter =
        |radius: f64, to: f64| ToolBody { cutter: Some(Cylinder { radius, from: 0.0, to }), ..ToolBody::default() };
    let block =
        |name: &str, edges: [f64; 3], at: [f64; 3]| shape(name, Attachment::Workpiece, Solid::Box(edges.into()), at);
    // Against a wall, 0.3 mm inside of it, and 0.1 mm inside of the floor.
    let wall = block("wall", [0.06, 0.3, 0.2], [-0.08 + 0.0097 + 0.03, 0.0, 0.0]);
    let floor = block("base plate", [0.4, 0.3, 0.02], [0.0, 0.0, -0.0999]);
    assert_eq!(hit(&[wall.clone(), floor.clone()], cutter(0.01, 0.04), 0.2), None);
    // A ledge above the cutter, as over a slot that it cuts below.
    let ledge = block("ledge", [0.06, 0.3, 0.01], [-0.08 + 0.009 + 0.03, 0.0, -0.02]);
    assert_eq!(hit(&[floor.clone(), ledge.clone()], cutter(0.01, 0.04), 0.2).as_deref(), Some("ledge"));
    assert_eq!(hit(&[floor, ledge], cutter(0.01, 0.04), 0.02), None);
    // Stock that the whole cutter is in.
    assert_eq!(hit(&[block("stock", [0.4, 0.3, 0.2], [0.0, 0.0, -0.1])], cutter(0.01, 0.04), 0.2), None);
}

#[test]
fn a_short_line_is_told_with_what_ends_it() {
    let placement = Placement::from([0.0, -1.9, -0.4, 0.3]);
    let bare = two_pockets();
    let made = plans(&bare, &placement);
    // A lid above the spindle at the first pocket.
    let tip = bare.placed(4, &placement).tip;
    let lid = shape("lid", Attachment::Base, Solid::Box(Vector3::new(0.1, 0.1, 0.01)), [tip.x, tip.y, tip.z + 1.0]);
    let flange = made[0].joints.last().map(|joints| bare.robot.forward(joints).translation).unwrap();
    let lid =
        stead_cell::Shape { pose: Pose { translation: flange + Vector3::new(0.0, 0.0, 0.12), ..lid.pose }, ..lid };
    let ball = shape("ball", Attachment::Flange, Solid::Capsule { radius: 0.08, length: 0.0 }, [0.0; 3]);
    let problem = with_tool(bare.clone(), &[lid, ball], end_mill());
    let found = transfer_path(&problem, &placement, [&made[0], &made[1]], 0).unwrap();
    let [Some(out), None] = &found.short_lines else { panic!("{:?}", found.short_lines) };
    assert!((0.02..0.05).contains(&out.length) && out.wanted == 0.05, "{out:?}");
    assert_eq!(out.end.to_string(), "ball and lid come too near");
    // The lid is above all of the first pocket.
    assert_eq!(whole_lines(&problem, &placement, &made[0]), [false, false]);
    assert_eq!(whole_lines(&problem, &placement, &made[1]), [true, true]);
}

/// Without shapes too: where a line out of the cut ends at a limit of the arm, another end is taken if there is one.
#[test]
fn lines_are_planned_without_shapes() {
    let (mut mended, mut kept, mut left) = (0, 0, 0);
    let places = [-1.7, -1.9, -2.1].into_iter().flat_map(|y| [0.8, 1.1, 1.4].map(|retract| (y, retract)));
    for (y, retract) in places {
        let placement = Placement::from([0.1, y, -0.3, 0.3]);
        let with = |retract: f64| {
            let mut problem = five_segments();
            problem.redundancy.beta_count = 60;
            problem.segment_moves.retract = retract;
            problem
        };
        let (problem, bare) = (with(retract), with(0.0));
        let [made, without] = [&problem, &bare].map(|problem| {
            let planner = Planner::finer(problem);
            planner.plan_fine(&placement, Sense::Min, None, &mut planner.workspace())
        });
        let (Ok(made), Ok(without)) = (made, without) else { continue };
        for (made, without) in made.iter().zip(&without) {
            let [lines, before] = [made, without].map(|plan| whole_lines(&problem, &placement, plan));
            if before == [true; 2] {
                assert_eq!(made, without);
                kept += 1;
            } else {
                assert!(made.cost >= without.cost * (1.0 - 1e-9));
                mended += usize::from(lines == [true; 2]);
                left += usize::from(lines != [true; 2]);
            }
        }
    }
    assert!(mended > 0 && kept > 0, "{mended} {kept} {left}");
}
