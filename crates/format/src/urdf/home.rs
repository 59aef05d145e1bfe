//! The controller's angles, found from one pose that the user has read at it.

use super::bodies::about_z;
use nalgebra::Vector3;
use std::path::Path;
use stead_disk::input::InputError;
use stead_model::robot::{Controller, ControllerKind, Pose, Robot};
use stead_numerics::digits::figures;
use stead_numerics::rotation::{rotation_from_quaternion, rotation_from_zyx, rotation_vector, zyx_from_rotation};

/// A flange pose read at a controller, with no tool and no base frame set, and its joint angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HomePose {
    /// Whose controller it is.
    pub kind: ControllerKind,
    /// The joint angles that it shows. deg
    pub angles_deg: [f64; 6],
    /// The flange in its robot root: X, Y, Z in mm, and A, B, C in deg of Rz(A) Ry(B) Rx(C).
    pub flange: [f64; 6],
}

impl HomePose {
    /// A pose from what the controller shows of the flange: X, Y, Z (mm) and A, B, C (deg), or for an ABB X, Y, Z and
    /// its quaternion.
    ///
    /// # Errors
    /// [`InputError`]: neither six numbers nor seven, a quaternion of another controller, or one whose length is not 1.
    pub fn new(kind: ControllerKind, angles_deg: [f64; 6], shown: &[f64]) -> Result<Self, InputError> {
        let flange = match *shown {
            [x, y, z, a, b, c] => [x, y, z, a, b, c],
            [x, y, z, w, i, j, k] if kind == ControllerKind::Abb => {
                let length = (w * w + i * i + j * j + k * k).sqrt();
                let is_one = (length - 1.0).abs() <= QUATERNION_ROUNDING;
                let Some(rotation) = rotation_from_quaternion([w, i, j, k]).filter(|_| is_one) else {
                    return Err(refused(format!("has a quaternion of length {}, which is not 1", figures(length))));
                };
                let [a, b, c] = zyx_from_rotation(&rotation).map(f64::to_degrees);
                [x, y, z, a, b, c]
            }
            [_, _, _, _, _, _, _] => {
                return Err(refused(format!("has a quaternion, and {} shows angles", kind.word())));
            }
            _ => return Err(refused(format!("has {} numbers for the flange", shown.len()))),
        };
        Ok(Self { kind, angles_deg, flange })
    }
}

/// How far a quaternion may be from length 1: four digits as printed.
const QUATERNION_ROUNDING: f64 = 1e-3;

/// How far a pose may be off: angles are shown to 0.01 deg, which at 3 m is half a millimetre for each joint. m
const POSITION: f64 = 1.5e-3;
/// Likewise its directions. rad
const DIRECTION: f64 = 2e-3;
/// Where axis 5 is nearer to straight than this, axes 4 and 6 cannot be distinguished. deg
const STRAIGHT_DEG: f64 = 20.0;
/// The offsets that are tried. deg
const OFFSETS_DEG: [f64; 4] = [0.0, 90.0, 180.0, -90.0];

const OPTION: &str = "--home-deg";
/// What a pose has to be.
const WANTED: &str = "A1,..,A6=X,Y,Z,A,B,C in deg and mm as the controller shows them for the flange in its robot \
                      root, no tool, no base; ABB also \
     X,Y,Z,QW,QX,QY,QZ; |A5| at least 20 deg, no angle at a multiple of 45 deg";

fn refused(problem: String) -> InputError {
    InputError::new(Path::new(OPTION), problem).allowed(WANTED)
}

/// How the controller counts: as the URDF where that agrees with the pose, else in the one way that does, by signs,
/// offsets of quarter turns, and a root at the base link or at the height of axis 2. `own` is the URDF's. Second,
/// whether it is the URDF's.
///
/// # Errors
/// [`InputError`]: a pose that leaves a sign open, or that no way of counting agrees with.
pub(super) fn controller_at(
    robot: &Robot,
    own: &Controller,
    home: &HomePose,
) -> Result<(Controller, bool), InputError> {
    refuse_open(home)?;
    // Both ways of counting axis 3, the maker's own first, each with a root at the base link and at axis 2.
    let is_fanuc = home.kind == ControllerKind::Fanuc;
    let above = Vector3::z() * robot.rows()[0].translation.z;
    let roots = own.root_from_base.map(|root| [root, Pose { translation: root.translation - above, ..root }]);
    let starts = [is_fanuc, !is_fanuc].into_iter().flat_map(|is_level| {
        let with = Controller { kind: home.kind, is_j3_level: Some(is_level), ..*own };
        roots.into_iter().flatten().map(move |root| Controller { root_from_base: Some(root), ..with })
    });
    let mut ways =
        Ways { robot, angles: home.angles_deg.map(f64::to_radians), wanted: flange(home), found: Vec::new() };
    let mut nearest = f64::INFINITY;
    for with in starts.clone() {
        let (position, direction) = off(robot, &with, &ways.angles, &ways.wanted);
        if position < POSITION && direction < DIRECTION {
            return Ok((with, true));
        }
        nearest = nearest.min(position);
    }
    for start in starts {
        let pose = start.root_from_base.unwrap_or_else(Pose::identity);
        let counting = Controller { sign: [1.0; 6], offset: [0.0; 6], ..start };
        ways.search(counting, &pose, 0);
    }
    let mut found = ways.found;
    // With the sign of axis 5 the other way and half a turn more at axes 4 and 6 the flange is always where it was: of
    // two such ways the one that is nearer to the URDF is taken.
    let changes = |way: &Controller| {
        let is_other = |joint: &usize| way.sign[*joint] != own.sign[*joint] || way.offset[*joint] != own.offset[*joint];
        (3..6).filter(is_other).count()
    };
    found.sort_by_key(changes);
    found.dedup_by(|other, kept| is_wrist_flip(kept, other));
    match found[..] {
        [one] => Ok((one, false)),
        [] => Err(refused(format!(
            "agrees with no way of counting: with signs and zero of the URDF the flange is {:.1} mm off",
            nearest * 1e3
        ))),
        _ => Err(refused(format!("agrees with {} ways of counting: another pose tells which", found.len()))),
    }
}

/// Refuses a pose that leaves axes or a sign open.
fn refuse_open(home: &HomePose) -> Result<(), InputError> {
    if home.angles_deg[4].abs() < STRAIGHT_DEG {
        return Err(refused(format!("leaves axes 4 and 6 open: A5 is {} deg", home.angles_deg[4])));
    }
    // Half a quarter turn off zero with one sign is half a quarter turn off another zero with the other.
    let is_open = |angle: &f64| (angle / 45.0 - (angle / 45.0).round()).abs() * 45.0 < 0.5;
    match home.angles_deg.iter().zip(1..).find(|(angle, _)| is_open(angle)) {
        Some((angle, joint)) => Err(refused(format!("leaves the sign of axis {joint} open: A{joint} is {angle} deg"))),
        None => Ok(()),
    }
}

/// Whether two ways of counting differ only in what a flip of the wrist takes back: whatever the angles, the flange is
/// the same.
fn is_wrist_flip(a: &Controller, b: &Controller) -> bool {
    let half_turn = |joint: usize| (libm::cos(a.offset[joint] - b.offset[joint]) + 1.0).abs() < 1e-9;
    let is_same = |joint: usize| a.sign[joint] == b.sign[joint];
    let is_same_arm = (0..3).all(|joint| is_same(joint) && a.offset[joint] == b.offset[joint]);
    let is_opposite = a.sign[4] == -b.sign[4] && (a.offset[4] + b.offset[4]).abs() < 1e-9;
    let is_same_frame = a.is_j3_level == b.is_j3_level && a.root_from_base == b.root_from_base;
    is_same_frame && is_same_arm && is_same(3) && is_same(5) && half_turn(3) && half_turn(5) && is_opposite
}

/// The flange of a pose in the robot root.
fn flange(home: &HomePose) -> Pose<f64> {
    let [x, y, z, a, b, c] = home.flange;
    let rotation = rotation_from_zyx([a, b, c].map(f64::to_radians));
    Pose { rotation, translation: Vector3::new(x, y, z) / 1e3 }
}

/// How far a way of counting is from a pose: position in m, direction in rad.
fn off(robot: &Robot, controller: &Controller, angles: &[f64; 6], wanted: &Pose<f64>) -> (f64, f64) {
    let root = controller.root_from_base.unwrap_or_else(Pose::identity);
    distance(&root.then(&robot.forward(&controller.joints(robot, angles))), wanted)
}

fn distance(pose: &Pose<f64>, wanted: &Pose<f64>) -> (f64, f64) {
    let turn = rotation_vector(&(pose.rotation * wanted.rotation.transpose()));
    // The logarithm of half a turn is not defined; its trace tells.
    let is_small = (pose.rotation * wanted.rotation.transpose()).trace() > 2.9;
    ((pose.translation - wanted.translation).norm(), if is_small { turn.norm() } else { std::f64::consts::PI })
}

/// The ways of counting by which angles bring the flange to a pose.
struct Ways<'a> {
    robot: &'a Robot,
    angles: [f64; 6],
    wanted: Pose<f64>,
    found: Vec<Controller>,
}

impl Ways<'_> {
    /// Tries all signs and offsets of a joint and of those behind it; `pose` is where the frame of the row before is.
    fn search(&mut self, counting: Controller, pose: &Pose<f64>, joint: usize) {
        if joint == 6 {
            let (position, direction) = distance(pose, &self.wanted);
            if position < POSITION && direction < DIRECTION {
                self.found.push(counting);
            }
            return;
        }
        let before = pose.then(&self.robot.rows()[joint]);
        for sign in [1.0, -1.0] {
            for offset in OFFSETS_DEG.map(f64::to_radians) {
                let mut next = counting;
                (next.sign[joint], next.offset[joint]) = (sign, offset);
                let turn = next.joints(self.robot, &self.angles)[joint];
                self.search(next, &before.then(&about_z(turn)), joint + 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::read_geometry;
    use stead_numerics::rotation::quaternion_from_rotation;

    const ANGLES: [f64; 6] = [-31.2, -71.4, 63.7, 17.9, 52.6, -117.3];

    /// The pose that a shipped arm shows, rounded as controllers do.
    fn shown(name: &str) -> (Robot, Controller, HomePose) {
        let robot = read_geometry(Path::new(name)).unwrap();
        let controller = *robot.controller().unwrap();
        let flange = robot.forward(&controller.joints(&robot, &ANGLES.map(f64::to_radians)));
        let flange = controller.root_from_base.unwrap().then(&flange);
        let [x, y, z] = [0, 1, 2].map(|axis| (flange.translation[axis] * 1e5).round() / 1e2);
        let [a, b, c] = zyx_from_rotation(&flange.rotation).map(|angle| (angle.to_degrees() * 1e2).round() / 1e2);
        (robot, controller, HomePose { kind: controller.kind, angles_deg: ANGLES, flange: [x, y, z, a, b, c] })
    }

    /// Whatever zero and signs the URDF has, those of the controller are found.
    #[test]
    fn the_way_of_counting_of_every_maker_is_found() {
        for name in ["kuka-kr210-r2700", "abb-irb6640-235", "abb-irb4400-60", "fanuc-m20ia", "staubli-rx160l"] {
            let (robot, mut expected, home) = shown(&format!("name:{name}"));
            expected.is_j3_level = Some(expected.is_level());
            let (kept, is_own) = controller_at(&robot, &expected, &home).unwrap();
            assert!(is_own && kept == expected, "{name}");
            // A URDF with other zeros and signs of axes 1 to 3 and 6, and its root on the floor.
            let base = Pose { rotation: nalgebra::Matrix3::identity(), translation: Vector3::zeros() };
            let (mut sign, mut offset) = (expected.sign, expected.offset);
            sign[..3].fill(1.0);
            offset[..3].fill(0.0);
            (sign[5], offset[5]) = (-sign[5], offset[5] + std::f64::consts::FRAC_PI_2);
            let other = Controller { sign, offset, root_from_base: Some(base), ..expected };
            let (found, is_own) = controller_at(&robot, &other, &home).unwrap();
            assert!(!is_own);
            // Half a turn may be written with either sign.
            let joints = |controller: &Controller| controller.joints(&robot, &[0.3, 0.1, -0.4, 1.0, 0.7, 2.0]);
            for (a, b) in joints(&found).into_iter().zip(joints(&expected)) {
                assert!(libm::sin((a - b) / 2.0).abs() < 1e-12, "{name}: {found:?}");
            }
            assert_eq!(found.root_from_base, expected.root_from_base, "{name}");
        }
    }

    #[test]
    fn the_quaternion_of_an_abb_is_its_pose() {
        let (robot, own, home) = shown("name:abb-irb6640-235");
        let [x, y, z, ..] = home.flange;
        let shown = quaternion_from_rotation(&flange(&home).rotation).map(|part| (part * 1e5).round() / 1e5);
        let numbers = [&[x, y, z][..], &shown].concat();
        let read = HomePose::new(ControllerKind::Abb, ANGLES, &numbers).unwrap();
        assert!(read.flange.iter().zip(home.flange).all(|(a, b)| (a - b).abs() < 2e-3), "{:?}", read.flange);
        assert!(controller_at(&robot, &own, &read).unwrap().1);
        let message = |kind, numbers: &[f64]| HomePose::new(kind, ANGLES, numbers).unwrap_err().to_string();
        let kuka = message(ControllerKind::Kuka, &numbers);
        assert!(kuka.contains("has a quaternion, and kuka shows angles") && kuka.contains("QW,QX,QY,QZ"), "{kuka}");
        let long = message(ControllerKind::Abb, &[x, y, z, 1.0, 0.1, 0.0, 0.0]);
        assert!(long.contains("a quaternion of length 1.00") && long.contains("which is not 1"), "{long}");
        assert!(message(ControllerKind::Abb, &[x, y]).contains("has 2 numbers"));
    }

    #[test]
    fn poses_that_leave_something_open_or_belong_to_another_arm_are_refused() {
        let (robot, own, home) = shown("name:kuka-kr210-r2700");
        let refused = |change: &dyn Fn(&mut HomePose)| {
            let mut home = home;
            change(&mut home);
            controller_at(&robot, &own, &home).unwrap_err().to_string()
        };
        assert!(
            refused(&|home| home.angles_deg[4] = -19.0).contains("--home-deg: leaves axes 4 and 6 open: A5 is -19 deg")
        );
        assert!(refused(&|home| home.angles_deg[3] = 0.0).contains("leaves the sign of axis 4 open: A4 is 0 deg"));
        assert!(refused(&|home| home.angles_deg[1] = -45.1).contains("leaves the sign of axis 2 open"));
        let other = refused(&|home| home.flange[0] += 37.0);
        assert!(other.contains("agrees with no way of counting") && other.contains("is 37.0 mm off"), "{other}");
    }
}
