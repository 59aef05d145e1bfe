//! What is possible but looks like a wrong unit or sign, in sentences: said beside a result, never refused.

use crate::robot::{Frames, NormalSprings, Robot, Spindle, SpringModel};
use crate::stiffness::Displacement;
use crate::stiffness::whole::{ByOrigin, WholeArm};
use crate::task::{Task, ToolPath};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use stead_numerics::digits::figures;
use stead_numerics::message::Note;

/// The softest and the stiffest joint of any published arm: joints 4 to 6 of small ones, joint 2 of the largest. N
/// m/rad
const KNOWN_STIFFNESSES: [f64; 2] = [2.9e4, 9.1e6];
/// So many times beyond these a stiffness looks wrong.
const BEYOND: f64 = 100.0;
/// A tool centre point nearer to the flange looks wrong. m
const SHORTEST_SPINDLE: f64 = 1e-3;
/// A path that is no wider in any direction looks wrong. m
const SMALLEST_PATH: f64 = 5e-3;
/// A faster feed looks wrong. m/s
const FASTEST_FEED: f64 = 1.0;
/// Of forces none of which is larger the unit looks wrong. N
const SMALLEST_FORCE: f64 = 1.0;
/// A shorter characteristic length looks wrong. m
const SHORTEST_CHARACTERISTIC_LENGTH: f64 = 10e-3;
/// Ranges of joints beyond these look wrong: radians for degrees, or degrees for radians. deg
const RANGES_DEG: [f64; 2] = [7.0, 1000.0];
/// Tool axes that point down by more than this, the sine of the angle below the horizontal, come from below.
const FROM_BELOW: f64 = 0.1;
/// A larger force looks wrong. N
const LARGEST_FORCE: f64 = 1e5;
/// A larger deflection looks wrong. m
const LARGEST_DEFLECTION: f64 = 10e-3;

/// What is to be said of an arm: joints of an odd stiffness, or of that of another arm, numbers that nobody has
/// verified.
pub fn arm(robot: &Robot) -> Vec<Note> {
    let borrowed = robot.stiffness_like().map(|other| {
        let text = format!(
            "{}: the joint stiffness is borrowed from {other}, not measured on this arm: it compares placements of such an arm, and tells \
             neither millimetres nor how stiff this arm is",
            robot.name()
        );
        Note::rests_on(format!("stiffness of {other} (ranks only)"), text)
    });
    let unverified = robot.unverified().iter().map(|what| {
        let text = format!("{}: not verified: {what}", robot.name());
        Note::rests_on("unverified numbers of the arm", text)
    });
    odd_stiffness(robot)
        .into_iter()
        .chain(joint_ranges(robot))
        .chain(bearings(robot))
        .map(Note::may_be_wrong)
        .chain(borrowed)
        .chain(axial_part(robot))
        .chain(unverified)
        .collect()
}

/// What is to be said of an arm by which placements are scored, beside [`arm`]: springs of its file that scores leave
/// out, and compliances of which nobody knows what they stand for.
pub fn scored_arm(robot: &Robot) -> Option<Note> {
    let left_out = || springs_left_out(robot).map(|text| Note::rests_on("springs about the joint axes alone", text));
    left_out().or_else(|| model_not_stated(robot))
}

/// What is to be said of what the compliances of a further stiffness set stand for.
pub fn stiffness_set(robot: &Robot) -> Option<Note> {
    axial_part(robot).or_else(|| scored_arm(robot))
}

/// That an arm has but the part about the axes of a full set.
fn axial_part(robot: &Robot) -> Option<Note> {
    (robot.spring_model() == Some(SpringModel::AxialPart)).then(|| {
        let text = format!(
            "{}: its stiffness is the part about the axes of a full identification (stiffness_model = \"axial_part\"): the springs \
             normal to the axes are missing, so that deflections are too small, and plans balance what is not all",
            robot.name()
        );
        Note::rests_on("the axial part of a full stiffness (deflections too small)", text)
    })
}

/// That scores leave out springs which the file of an arm states.
pub fn springs_left_out(robot: &Robot) -> Option<String> {
    let is_left_out = robot.stated_normal_springs().is_some() && robot.normal_springs().is_none();
    is_left_out.then(|| {
        format!(
            "{}: its file states springs normal to the axes, but not that they are of one set with the others (stiffness_model = \
             \"full\"): scores leave them out",
            robot.name()
        )
    })
}

/// That nobody knows what the compliances of an arm stand for, where its file states no springs normal to the axes
/// ([`springs_left_out`] is for those).
fn model_not_stated(robot: &Robot) -> Option<Note> {
    let is_open = robot.spring_model().is_none() && robot.stated_normal_springs().is_none();
    is_open.then(|| {
        let text = format!(
            "{}: the robot file does not state what its stiffness stands for (stiffness_model): it is taken for a fit of springs \
             about the axes alone (\"axes\"), which absorb what links and bearings do; if it is the part about the axes of springs about \
             three directions (\"axial_part\"), a third to a half of the deflection is missing",
            robot.name()
        );
        Note::rests_on("stiffness of no stated kind (stiffness_model)", text)
    })
}

/// That motion and stability leave out what a spindle states of static compliance.
pub fn static_alone(spindle: &Spindle) -> Option<String> {
    flange_matrices(spindle).map(|keys| {
        format!(
            "{keys} is of static deflection alone: motion and stability leave out what mount, holder and tool yield"
        )
    })
}

/// That a benchmark of the joints leaves out what a spindle states of its compliance.
pub fn joints_alone(spindle: &Spindle) -> Option<String> {
    flange_matrices(spindle).map(|keys| {
        format!("{keys} is left out: the joints are assessed, without base, mount, holder and tool, as published comparisons do")
    })
}

/// The keys of the matrices that a spindle states, where it states one.
fn flange_matrices(spindle: &Spindle) -> Option<&'static str> {
    match (spindle.mount, spindle.tip) {
        (None, None) => None,
        (Some(_), None) => Some("spindle.mount_matrix"),
        (None, Some(_)) => Some("spindle.tip_um_per_n"),
        (Some(_), Some(_)) => Some("spindle.mount_matrix, with spindle.tip_um_per_n,"),
    }
}

/// Softer than this (m/N; rad/N, rad/(N m)) a matrix looks wrong.
const SOFTEST_MATRIX: [f64; 2] = [100e-6, 1000e-6];

/// A matrix of this key with an entry that hardly anything has; of displacement per force in rows and columns below
/// three, else of turns.
fn soft_matrix(key: &str, count: usize, entry: impl Fn(usize, usize) -> f64) -> Option<String> {
    let size = |row: usize, column: usize| entry(row, column).abs();
    let places = || (0..count).flat_map(|row| (0..count).map(move |column| (row, column)));
    let is_shift = |(row, column): &(usize, usize)| *row < 3 && *column < 3;
    let largest = |wanted: bool| {
        let sizes = places().filter(|place| is_shift(place) == wanted).map(|(row, column)| size(row, column));
        sizes.fold(0.0, f64::max)
    };
    let [shift, turn] = [largest(true), largest(false)];
    let what = match (shift > SOFTEST_MATRIX[0], turn > SOFTEST_MATRIX[1]) {
        (true, _) => format!("{} um/N", figures(shift * 1e6)),
        (false, true) => format!("{} urad/N or urad/(N m)", figures(turn * 1e6)),
        (false, false) => return None,
    };
    Some(format!("{key} goes up to {what}: is it in um/N, urad/N and urad/(N m)?"))
}

/// Matrices of robot, spindle and part that hardly anything has.
pub fn matrices(robot: &Robot, spindle: &Spindle, task: &Task) -> Vec<String> {
    let base = robot.base_compliance().and_then(|base| {
        let matrix = base.matrix();
        soft_matrix("base_compliance.matrix", 6, |row, column| matrix[(row, column)])
    });
    let mount = spindle.mount.and_then(|m| soft_matrix("spindle.mount_matrix", 6, |row, column| m[(row, column)]));
    let tip = spindle.tip.and_then(|m| soft_matrix("spindle.tip_um_per_n", 3, |row, column| m[(row, column)]));
    let mut of_points = (0..task.points().len()).filter_map(|point| task.part_compliance(point));
    let part = of_points.find_map(|m| soft_matrix("the compliance of the part", 3, |row, column| m[(row, column)]));
    [base, mount, tip, part].into_iter().flatten().collect()
}

/// Joints a hundred times stiffer or softer than any known one, taken in the middle of their range without a
/// compensator.
fn odd_stiffness(robot: &Robot) -> Option<String> {
    let [softest, stiffest] = [KNOWN_STIFFNESSES[0] / BEYOND, KNOWN_STIFFNESSES[1] * BEYOND];
    let stiffness = |joint: usize| 1.0 / robot.compliances_at(&robot.mid_range())[joint];
    let odd: Vec<String> = (0..6)
        .filter(|joint| !(softest..=stiffest).contains(&stiffness(*joint)))
        .map(|joint| format!("joint {} with {} MN m/rad", joint + 1, figures(stiffness(joint) / 1e6)))
        .collect();
    (!odd.is_empty()).then(|| {
        format!(
            "{}: {} a hundred times stiffer or softer than any known joint (0.029 to 9.1 MN m/rad): are stiffnesses in MN m/rad, \
             compliances in urad/(N m)?",
            robot.name(),
            match &odd[..] {
                [one] => format!("{one} is"),
                several => format!("{} are", several.join(", ")),
            }
        )
    })
}

/// A tool centre point at the flange, or a tool that points from there back to the flange.
pub fn spindle(spindle: &Spindle) -> Option<String> {
    let tool = &spindle.flange_from_tool;
    let distance = tool.translation.norm();
    if distance < SHORTEST_SPINDLE {
        let mm = figures(distance * 1e3);
        return Some(format!("the tool centre point is {mm} mm from the flange: is spindle.xyz_mm in mm?"));
    }
    (tool.rotation.column(2).dot(&tool.translation) < 0.0).then(|| {
        "the tool points from its centre point back to the flange: the z axis of the tool frame, the third column of \
         spindle.rotation, points out of the spindle to the work"
            .to_owned()
    })
}

/// Joints that hardly turn, or turn many times about.
pub fn joint_ranges(robot: &Robot) -> Option<String> {
    let [least, most] = RANGES_DEG;
    let range = |joint: &crate::robot::Joint| (joint.max - joint.min).to_degrees();
    let odd: Vec<String> = (robot.joints().iter().enumerate())
        .filter(|(_, joint)| !(least..=most).contains(&range(joint)))
        .map(|(number, joint)| format!("joint {} by {} deg", number + 1, figures(range(joint))))
        .collect();
    (!odd.is_empty()).then(|| {
        format!("{}: can turn {}: are the limits of its joints in the right unit?", robot.name(), odd.join(", "))
    })
}

/// A path of hardly any extent.
pub fn path(path: &ToolPath) -> Option<String> {
    let points = path.points();
    let along = |k: usize| {
        let values = || points.iter().map(|point| point.position[k]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let extent = (0..3).map(along).fold(0.0, f64::max);
    (points.len() > 1 && extent < SMALLEST_PATH).then(|| {
        format!("the tool path is no wider than {} mm in any direction: are its places in mm?", figures(extent * 1e3))
    })
}

/// A feed (m/s) that hardly any cut has.
pub fn feed(highest: f64) -> Option<String> {
    (highest > FASTEST_FEED && highest.is_finite())
        .then(|| format!("feeds go up to {} mm/s: are they in mm/s, not mm/min?", figures(highest * 1e3)))
}

/// A force (N) that hardly any tool bears, or that hardly deflects anything.
pub fn force(largest: f64) -> Option<String> {
    if largest == 0.0 {
        return Some("all forces are zero: nothing deflects, and every placement is as good as any other".to_owned());
    }
    (!(SMALLEST_FORCE..=LARGEST_FORCE).contains(&largest))
        .then(|| format!("forces go up to {} N: are they in N?", figures(largest)))
}

/// A characteristic length (m) that hardly any arm has.
pub fn characteristic_length(length: f64) -> Option<String> {
    (length < SHORTEST_CHARACTERISTIC_LENGTH)
        .then(|| format!("constraints.characteristic_length_mm is {}: is it in mm?", figures(length * 1e3)))
}

/// Tool axes most of which point downwards, in a frame whose z axis is up: the spindle would be below the part.
pub fn tool_axes<'a>(axes: impl Iterator<Item = &'a Vector3<f64>>, frame: &str) -> Option<String> {
    let (mut count, mut below) = (0, 0);
    for axis in axes {
        count += 1;
        below += usize::from(axis.z < -FROM_BELOW);
    }
    (2 * below > count).then(|| {
        format!(
            "{below} of {count} tool axes point downwards {frame}, so that the spindle would be below the part: tool axes point from the \
             workpiece to the spindle; is their sign right?"
        )
    })
}

/// A deflection (m) that no part survives.
pub fn deflection(largest: f64) -> Option<String> {
    (largest > LARGEST_DEFLECTION).then(|| {
        format!(
            "the tool deflects by up to {} mm: are forces in N and stiffnesses in MN m/rad?",
            figures(largest * 1e3)
        )
    })
}

/// What is usual of a number: between two numbers, or so many diameters of the cutter.
struct Usual {
    key: &'static str,
    unit: &'static str,
    range: [f64; 2],
    is_of_diameter: bool,
    question: &'static str,
}

const fn usual(key: &'static str, unit: &'static str, range: [f64; 2], question: &'static str) -> Usual {
    Usual { key, unit, range, is_of_diameter: false, question }
}

const fn of_diameter(key: &'static str, most: f64, question: &'static str) -> Usual {
    Usual { key, unit: "mm", range: [0.0, most], is_of_diameter: true, question }
}

/// Keys of the table that are used here.
const CENTRE: &str = "spindle.centre_of_mass_mm";
const SAG: &str = "the sag of the tool by the weight of links and spindle";
const BEARING: &str = "bearing_mm";

/// What is usual of a run and of its cut.
const USUAL: &[Usual] = &[
    usual("tool.cutter_diameter_mm", "mm", [0.5, 500.0], "is it in mm?"),
    usual("tool.kt_mpa", "MPa", [0.0, 1e4], "is it in MPa, which are N/mm2?"),
    usual("tool.kr", "times kt_mpa", [0.0, 5.0], "is it the ratio of K_r to K_t, and no coefficient in MPa?"),
    usual("tool.kr_mpa", "MPa", [-1e4, 1e4], "is it in MPa, which are N/mm2?"),
    usual("tool.ka_mpa", "MPa", [-1e4, 1e4], "is it in MPa, which are N/mm2?"),
    usual("tool.kte_n_per_mm", "N/mm", [0.0, 500.0], "is it in N for each mm of edge?"),
    usual("tool.kre_n_per_mm", "N/mm", [0.0, 500.0], "is it in N for each mm of edge?"),
    usual("cut.spindle_rpm", "1/min", [100.0, 2e5], "is it in turns per minute?"),
    of_diameter("feed per tooth", 1.0 / 20.0, "are feed, speed and teeth in their units?"),
    of_diameter("cut.axial_depth_mm", 2.0, "is it the axial depth of one cut?"),
    of_diameter("stock.cell_mm", 1.0 / 6.0, "a cut is a few lines wide"),
    of_diameter("stock.depth_mm", 2.0, "is it the axial depth of one cut?"),
    of_diameter("stock.layer_mm", 1.0 / 4.0, "is it what the operation before left?"),
    usual("spindle.mass_kg", "kg", [0.0, 2000.0], "is it in kg?"),
    usual(CENTRE, "mm from the flange", [5.0, 5000.0], "is it in mm?"),
    usual(SAG, "mm", [0.0, 5.0], "is spindle.mass_kg in kg, and the stiffness in its unit?"),
    usual(BEARING, "mm from the origin of its row", [5.0, 2000.0], "is it in mm?"),
    usual(
        "redundancy.max_beta_rate_deg_per_mm",
        "deg/mm",
        [0.01, f64::INFINITY],
        "is it in degrees for each mm of the path? The spindle can hardly turn",
    ),
    usual(
        "redundancy.max_spindle_turn_deg_per_mm",
        "deg/mm",
        [0.01, f64::INFINITY],
        "is it in degrees for each mm of the path? The spindle can hardly turn",
    ),
    usual(
        "redundancy.max_spindle_turn_deg_per_s",
        "deg/s",
        [0.1, f64::INFINITY],
        "is it in degrees per second? The spindle can hardly turn",
    ),
];

/// A number by its key in the table, by whatever name it is said: beyond what is usual of it in its unit, of a cutter
/// of a diameter (mm) where that counts.
fn beyond(key: &str, name: &str, value: f64, diameter: f64) -> Option<String> {
    let Usual { unit, range, is_of_diameter, question, .. } = USUAL.iter().find(|usual| usual.key == key)?;
    let scale = if *is_of_diameter { diameter } else { 1.0 };
    let [low, high] = range.map(|end| end * scale);
    if (low..=high).contains(&value) {
        return None;
    }
    let of = if *is_of_diameter { format!(" for a cutter of {} mm", figures(diameter)) } else { String::new() };
    let usual = if high.is_finite() {
        format!("{} to {} {unit} are usual", figures(low), figures(high))
    } else {
        format!("at least {} {unit} is usual", figures(low))
    };
    Some(format!("{name} is {} {unit}, where {usual}{of}: {question}", figures(value)))
}

/// Numbers of a cut, by their keys in the units of these, that hardly any cut by a cutter of this diameter (mm) has.
pub fn cut(diameter: f64, numbers: &[(&str, f64)]) -> Vec<String> {
    numbers.iter().filter_map(|(key, value)| beyond(key, key, *value, diameter)).collect()
}

/// Numbers of a run, by their keys in the units of these, that hardly any run has.
pub fn run(numbers: &[(&str, f64)]) -> Vec<String> {
    cut(f64::INFINITY, numbers)
}

/// So heavy a body has its centre of mass away from the flange. kg
const HEAVY: f64 = 10.0;

/// What the flange carries, where its mass or the place of its centre looks like one of another unit.
pub fn carried(spindle: &Spindle) -> Vec<String> {
    let Some(body) = spindle.carried_mass() else { return Vec::new() };
    let centre = (body.mass >= HEAVY).then(|| (CENTRE, body.centre.norm() * 1e3));
    run(&[Some(("spindle.mass_kg", body.mass)), centre].into_iter().flatten().collect::<Vec<_>>())
}

/// How far the weight moves the tool (m), where hardly any arm lets it.
pub fn sag(largest: f64) -> Option<String> {
    beyond(SAG, SAG, largest * 1e3, f64::INFINITY)
}

/// Places on the joint axes in which they yield normal to them, where no joint is built so.
fn bearings(robot: &Robot) -> Vec<String> {
    let stated = robot.stated_normal_springs().into_iter().flatten().zip(1..);
    let odd = |(springs, number): (&NormalSprings, usize)| {
        let name = format!("{}: joints[{number}].{BEARING}", robot.name());
        // 0 is the origin of the row itself, also where nothing is stated.
        let is_away = springs.bearing != 0.0;
        let note = is_away.then(|| beyond(BEARING, &name, springs.bearing.abs() * 1e3, f64::INFINITY));
        note.flatten()
    };
    stated.filter_map(odd).collect()
}

/// So many times softer than the arm what stands beside it looks wrong.
const SOFTER: f64 = 10.0;

/// What carries the robot, the mount of the spindle, holder and tool, or the part, where it is ten times as soft as the
/// arm in the middle of its joint ranges.
pub fn softer_than_the_arm(robot: &Robot, spindle: &Spindle, task: &Task) -> Vec<String> {
    let middle = robot.mid_range();
    let frames = Frames::new(robot, &middle);
    let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
    let arm = WholeArm::new(robot, spindle, &frames, robot.compliances_at(&middle), tip);
    let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|force| arm.by_origin(&force, &Vector3::zeros()));
    let largest = |matrix: &Matrix3<f64>| matrix.symmetric_eigenvalues().max();
    let of = |moved: &dyn Fn(&ByOrigin<Displacement<f64>>) -> Vector3<f64>| {
        largest(&Matrix3::from_columns(&columns.map(|column| moved(&column))))
    };
    let own = of(&|by| by.axes.linear + by.normal.linear);
    let part = (0..task.points().len()).filter_map(|point| task.part_compliance(point)).map(largest);
    let others = [
        ("what carries the robot", "base_compliance.matrix", of(&|by| by.base.linear)),
        ("the mount of the spindle", "spindle.mount_matrix", of(&|by| by.mount.linear)),
        ("holder and tool", "spindle.tip_um_per_n", of(&|by| by.tip.linear)),
        ("the part", "its matrix", part.fold(0.0, f64::max)),
    ];
    let um_per_n = |compliance: f64| figures(compliance * 1e6);
    let softer = others.into_iter().filter(|(_, _, other)| *other > SOFTER * own);
    softer
        .map(|(what, key, other)| {
            format!(
                "{what} yields by {} um/N at the tool, more than ten times the {} um/N of the arm in the middle of its joint \
                 ranges: is {key} in um/N, urad/N and urad/(N m)?",
                um_per_n(other),
                um_per_n(own)
            )
        })
        .collect()
}

/// Angles that people write in radians, in them, and as they are called.
const RADIANS: [(f64, &str); 4] =
    [(FRAC_PI_4, "pi/4"), (FRAC_PI_2, "pi/2"), (std::f64::consts::PI, "pi"), (std::f64::consts::TAU, "2 pi")];
/// By how much 3.14 misses it. Relative
const AS_WRITTEN: f64 = 6e-4;

/// An angle in degrees, by its key, that looks like one in radians.
pub fn angle(key: &str, degrees: f64) -> Option<String> {
    let is_near = |(radians, _): &&(f64, &str)| (degrees.abs() / radians - 1.0).abs() <= AS_WRITTEN;
    let (_, name) = RADIANS.iter().find(is_near)?;
    let sign = if degrees < 0.0 { "-" } else { "" };
    Some(format!("{key} is {degrees}, which is {sign}{name}: is it in degrees?"))
}

/// A force so many times the median of the points, or so small a share of it, looks wrong.
const FORCE_BEYOND: f64 = 10.0;
const FORCE_BELOW: f64 = 0.01;

/// Points whose force is another than that of the others by more than a factor (N, of all points in their order, by
/// segment): more than ten times the median, or below a hundredth of it between two points of its segment of which
/// neither is below a tenth. Points without force cut nothing, and are left out.
pub fn forces(segments: &[Vec<(usize, f64)>]) -> Option<String> {
    let mut sizes: Vec<f64> = segments.iter().flatten().map(|(_, size)| *size).filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let median = *sizes.get(sizes.len() / 2)?;
    let large = segments.iter().flatten().filter(|(_, size)| *size > FORCE_BEYOND * median);
    let between = segments.iter().flat_map(|segment| segment.windows(3));
    let is_slip = |near: &&[(usize, f64)]| {
        let [before, here, after] = [0, 1, 2].map(|k| near.get(k).map_or(0.0, |(_, size)| *size));
        here > 0.0 && here < FORCE_BELOW * median && before.min(after) >= median / FORCE_BEYOND
    };
    let small = between.filter(is_slip).filter_map(|near| near.get(1));
    let mut odd: Vec<&(usize, f64)> = large.chain(small).collect();
    odd.sort_by_key(|(point, _)| *point);
    let (point, size) = odd.first()?;
    let more = match odd.len() - 1 {
        0 => String::new(),
        more => format!(", and {more} more such"),
    };
    Some(format!(
        "the force at point {point} is {} N, where half of the points have no more than {} N{more}: is it a slip of the pen, or of \
         its unit?",
        figures(*size),
        figures(median)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::testing::{kr270, spindle as mounted};
    use crate::robot::{BaseCompliance, PointMass};
    use crate::task::PathPoint;
    use crate::task::testing::five_segments;
    use nalgebra::{Matrix6, vector};

    #[test]
    fn what_is_usual_is_not_noted() {
        let task = five_segments();
        assert_eq!((arm(&kr270()), spindle(&mounted())), (Vec::new(), None));
        assert_eq!((path(task.path()), force(2700.0), deflection(2.8e-3)), (None, None, None));
    }

    #[test]
    fn numbers_of_a_cut_are_held_against_what_is_usual() {
        let usual = [
            ("tool.cutter_diameter_mm", 16.0),
            ("tool.kt_mpa", 3333.0),
            ("tool.kr", 0.7),
            ("tool.kr_mpa", 2289.0),
            ("tool.ka_mpa", -300.0),
            ("tool.kte_n_per_mm", 30.0),
            ("tool.kre_n_per_mm", 0.0),
            ("cut.spindle_rpm", 9000.0),
            ("feed per tooth", 0.15),
            ("cut.axial_depth_mm", 31.0),
            ("stock.cell_mm", 0.7),
            ("stock.depth_mm", 30.0),
            ("stock.layer_mm", 0.5),
            ("spindle.mass_kg", 180.0),
            (CENTRE, 158.0),
            (SAG, 1.2),
            (BEARING, 621.0),
            ("redundancy.max_beta_rate_deg_per_mm", 0.9),
            ("redundancy.max_spindle_turn_deg_per_mm", 0.9),
            ("redundancy.max_spindle_turn_deg_per_s", 40.0),
        ];
        assert_eq!(usual.len(), USUAL.len());
        assert_eq!(cut(16.0, &usual), Vec::<String>::new());
        for (key, value, said) in [
            ("tool.cutter_diameter_mm", 0.016, "is 0.0160 mm, where 0.500 to 500 mm are usual"),
            ("tool.kt_mpa", 8e8, "MPa"),
            ("tool.kr", 320.0, "is 320 times kt_mpa, where 0 to 5.00 times kt_mpa are usual: is it the ratio"),
            ("tool.kr_mpa", 3.2e4, "MPa"),
            ("tool.ka_mpa", -3.2e4, "MPa"),
            ("cut.axial_depth_mm", 33.0, "the axial depth of one cut?"),
            (
                "redundancy.max_spindle_turn_deg_per_mm",
                0.009,
                "is 0.00900 deg/mm, where at least 0.0100 deg/mm is usual",
            ),
            ("redundancy.max_beta_rate_deg_per_mm", 0.009, "can hardly turn"),
            ("redundancy.max_spindle_turn_deg_per_s", 0.09, "can hardly turn"),
            ("tool.kte_n_per_mm", 20_000.0, "N for each mm of edge?"),
            ("tool.kre_n_per_mm", 501.0, "N for each mm of edge?"),
            ("cut.spindle_rpm", 15.0, "is it in turns per minute?"),
            ("feed per tooth", 0.9, "where 0 to 0.800 mm are usual for a cutter of 16.0 mm"),
            ("stock.cell_mm", 2.7, "a cut is a few lines wide"),
            ("stock.depth_mm", 33.0, "the axial depth of one cut?"),
            ("stock.layer_mm", 4.1, "what the operation before left?"),
        ] {
            let notes = cut(16.0, &[(key, value)]);
            assert!(notes.len() == 1 && notes[0].starts_with(key) && notes[0].contains(said), "{notes:?}");
        }
    }

    #[test]
    fn what_the_flange_carries_is_held_against_what_is_usual() {
        let with = |mass: f64, centre: Vector3<f64>| {
            let mut spindle = mounted();
            spindle.point_mass = Some(PointMass { mass, centre });
            carried(&spindle)
        };
        let away = vector![0.0, 0.0, 0.158];
        assert_eq!((with(44.4, away), with(9.9, away / 1e3)), (Vec::new(), Vec::new()));
        let heavy = with(44400.0, away);
        assert!(
            heavy.len() == 1 && heavy[0].starts_with("spindle.mass_kg is 44400 kg, where 0 to 2000 kg"),
            "{heavy:?}"
        );
        let metres = with(44.4, away / 1e3);
        let start = "spindle.centre_of_mass_mm is 0.158 mm from the flange, where 5.00 to 5000 mm";
        assert!(metres.len() == 1 && metres[0].starts_with(start), "{metres:?}");
        assert_eq!(sag(4.9e-3), None);
        assert!(sag(5.1e-3).unwrap().contains("is 5.10 mm, where 0 to 5.00 mm are usual"));
    }

    #[test]
    fn bearings_of_another_unit_are_noted_with_their_joint() {
        let with = |bearing: f64| {
            let mut springs = [NormalSprings { compliance: [1e-7; 2], bearing: 0.0 }; 6];
            springs[3].bearing = bearing;
            let robot = kr270().with_normal_springs(Some(springs)).unwrap();
            arm(&robot).into_iter().find(|note| note.contains("bearing_mm"))
        };
        assert_eq!((with(0.0), with(-0.621), with(2.0)), (None, None, None));
        let note = with(-0.621e-3).unwrap();
        assert!(note.starts_with("test: joints[4].bearing_mm is 0.621 mm from the origin of its row"), "{note}");
        assert!(with(621.0).is_some());
    }

    #[test]
    fn what_is_ten_times_softer_than_the_arm_is_noted_with_both_figures() {
        let (robot, task) = (kr270(), five_segments());
        let noted = |um_per_n: f64| {
            let spindle = mounted().with_tip(Matrix3::from_diagonal_element(um_per_n * 1e-6)).unwrap();
            softer_than_the_arm(&robot, &spindle, &task)
        };
        assert_eq!((noted(0.0), noted(1.0)), (Vec::new(), Vec::new()));
        let notes = noted(400.0);
        assert!(
            notes.len() == 1 && notes[0].starts_with("holder and tool yields by 400 um/N at the tool"),
            "{notes:?}"
        );
        assert!(
            notes[0].contains(" um/N of the arm") && notes[0].contains("is spindle.tip_um_per_n in um/N"),
            "{notes:?}"
        );
        let part = task
            .clone()
            .with_part_compliances(vec![Matrix3::from_diagonal_element(400e-6); task.points().len()])
            .unwrap();
        assert!(softer_than_the_arm(&robot, &mounted(), &part)[0].starts_with("the part yields by 400 um/N"));
        let base = BaseCompliance::new(Vector3::zeros(), Matrix6::from_diagonal_element(400e-6)).unwrap();
        let notes = softer_than_the_arm(&robot.clone().with_base_compliance(Some(base)), &mounted(), &five_segments());
        assert!(notes.len() == 1 && notes[0].starts_with("what carries the robot yields by "), "{notes:?}");
        let spindle = mounted().with_mount(Matrix6::from_diagonal_element(400e-6)).unwrap();
        assert!(softer_than_the_arm(&robot, &spindle, &five_segments())[0].starts_with("the mount of the spindle"));
    }

    #[test]
    #[expect(clippy::approx_constant, reason = "angles in radians as people type them")]
    fn angles_that_are_written_in_radians_are_noted() {
        for degrees in [3.14, -3.1416, 1.57, 1.5708, 6.283185, 0.7854, 0.785] {
            assert!(angle("spindle.abc_deg[2]", degrees).is_some(), "{degrees}");
        }
        for degrees in [0.0, 3.0, 3.1, 3.15, 1.5, 1.6, 6.3, 0.78, 90.0, 180.0, -45.0] {
            assert_eq!(angle("spindle.abc_deg[2]", degrees), None, "{degrees}");
        }
        let said = "cell.yaw_deg[1] is -3.1416, which is -pi: is it in degrees?";
        assert_eq!(angle("cell.yaw_deg[1]", -3.1416).unwrap(), said);
    }

    #[test]
    fn forces_of_single_points_that_are_far_from_the_others_are_noted() {
        let noted = |sizes: &[f64]| forces(&[sizes.iter().copied().enumerate().collect()]);
        assert_eq!(noted(&[]), None);
        assert_eq!(noted(&[100.0, 110.0, 990.0, 60.0, 100.0]), None);
        let slip = noted(&[100.0, 110.0, 1120.0, 60.0, 100.0]).unwrap();
        assert!(
            slip.starts_with("the force at point 2 is 1120 N, where half of the points have no more than 100 N:"),
            "{slip}"
        );
        let slip = noted(&[100.0, 110.0, 0.9, 60.0, 100.0, 2000.0]).unwrap();
        assert!(slip.contains("at point 2 is 0.900 N") && slip.contains("and 1 more such"), "{slip}");
        // A cutter that comes into the cut, or has none.
        assert_eq!(noted(&[0.0, 0.5, 60.0, 100.0, 100.0, 0.0, 100.0]), None);
    }

    #[test]
    fn joints_of_another_unit_are_named() {
        let mut compliances = kr270().constant_compliances().unwrap();
        // N m/rad written as MN m/rad.
        compliances[0] *= 1e-6;
        let said = |compliances: [f64; 6]| {
            arm(&kr270().with_compliances(compliances).unwrap()).iter().map(Note::to_string).collect::<String>()
        };
        let note = said(compliances);
        assert!(note.contains("joint 1 with 237000 MN m/rad is a hundred times"), "{note}");
        compliances[4] = 1.0;
        let note = said(compliances);
        assert!(note.contains("joint 1 with 237000 MN m/rad, joint 5 with 1.00e-6 MN m/rad are"), "{note}");
        for (stiffness, is_noted) in [(9.09e8, false), (9.2e8, true), (291.0, false), (289.0, true)] {
            compliances = kr270().constant_compliances().unwrap();
            compliances[2] = 1.0 / stiffness;
            assert_eq!(arm(&kr270().with_compliances(compliances).unwrap()).len() == 1, is_noted, "{stiffness}");
        }
    }

    #[test]
    fn borrowed_stiffness_is_said_and_stands_in_the_name() {
        let robot = kr270().with_stiffness_like("another arm");
        assert!(robot.name().ends_with(" (stiffness of another arm)"));
        assert_eq!(robot.stiffness_like(), Some("another arm"));
        let notes = arm(&robot);
        assert!(notes.len() == 1 && notes[0].contains("is borrowed from another arm"), "{notes:?}");
        // A share of a range is still that of the other arm; compliances that are put in their place are not.
        assert_eq!(robot.with_range_share(0.5).unwrap().name(), robot.name());
        assert_eq!(robot.with_compliances([1e-6; 6]).unwrap().name(), kr270().name());
    }

    #[test]
    fn unverified_numbers_are_named() {
        let robot = kr270().with_unverified(vec!["joint limits: from memory".to_owned()]);
        let notes = arm(&robot);
        assert_eq!(
            notes.iter().map(|note| &**note).collect::<Vec<_>>(),
            ["test: not verified: joint limits: from memory"]
        );
    }

    #[test]
    fn spindles_of_no_length_and_those_that_point_back_are_noted() {
        let with = |change: &dyn Fn(&mut Vector3<f64>)| {
            let mut mounted = mounted();
            change(&mut mounted.flange_from_tool.translation);
            spindle(&mounted)
        };
        let metres = with(&|place| *place /= 1e3).unwrap();
        assert!(metres.starts_with("the tool centre point is 0.684 mm from the flange"), "{metres}");
        assert!(with(&|place| *place = vector![0.0, 0.0, 0.0]).unwrap().starts_with("the tool centre point is 0 mm"));
        assert!(with(&|place| *place *= -1.0).unwrap().starts_with("the tool points from its centre point back"));
    }

    #[test]
    fn joints_that_hardly_turn_or_turn_many_times_are_named() {
        let with = |range: f64| {
            let mut joints = kr270().joints().clone();
            joints[3].min = 0.1;
            joints[3].max = 0.1 + range.to_radians();
            joint_ranges(&Robot::new("arm", joints).unwrap())
        };
        assert_eq!((with(7.1), with(999.0)), (None, None));
        assert_eq!(
            with(6.3).unwrap(),
            "arm: can turn joint 4 by 6.30 deg: are the limits of its joints in the right unit?"
        );
        assert!(with(1001.0).unwrap().contains("joint 4 by 1001 deg"));
    }

    #[test]
    fn tool_axes_from_below_are_noted() {
        let [up, level, down] = [vector![0.0, 0.0, 1.0], vector![1.0, 0.0, 0.0], vector![0.0, 0.6, -0.8]];
        let note = |axes: &[Vector3<f64>]| tool_axes(axes.iter(), "in the cell");
        assert_eq!((note(&[up, down]), note(&[level; 3]), note(&[])), (None, None, None));
        let said = note(&[up, down, down]).unwrap();
        assert!(said.starts_with("2 of 3 tool axes point downwards in the cell, so that the spindle"), "{said}");
    }

    #[test]
    fn short_paths_large_forces_and_large_deflections_are_noted() {
        let [place, axis, feed] = [Vector3::zeros(), Vector3::z(), Vector3::x()];
        let point = |x: f64| (1, PathPoint { position: place + feed * x, axis, feed });
        let along = |xs: &[f64]| path(&ToolPath::new(xs.iter().map(|x| point(*x))).unwrap());
        assert_eq!(along(&[0.0, 5.1e-3]), None);
        let short = "the tool path is no wider than 0.400 mm in any direction: are its places in mm?";
        assert_eq!(along(&[0.0, 4e-4]).unwrap(), short);
        // There and back many times is no wider.
        let there_and_back: Vec<f64> = (0..40).map(|k| f64::from(k % 2) * 4e-4).collect();
        assert_eq!(along(&there_and_back).unwrap(), short);
        assert!(force(2e5).unwrap().starts_with("forces go up to 200000 N"));
        assert_eq!(force(0.9).unwrap(), "forces go up to 0.900 N: are they in N?");
        assert!(force(0.0).unwrap().starts_with("all forces are zero"));
        assert_eq!((force(1.1), super::feed(0.99), super::feed(f64::INFINITY)), (None, None, None));
        assert_eq!(super::feed(20.0).unwrap(), "feeds go up to 20000 mm/s: are they in mm/s, not mm/min?");
        assert_eq!(characteristic_length(0.0101), None);
        assert!(characteristic_length(0.000682).unwrap().contains("characteristic_length_mm is 0.682"));
        assert!(deflection(0.037).unwrap().starts_with("the tool deflects by up to 37.0 mm"));
        assert_eq!(deflection(f64::NAN), None);
    }
}
