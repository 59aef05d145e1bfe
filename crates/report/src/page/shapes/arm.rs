//! The links of an arm from its rows.

use super::illustration::{Paint, illustration};
use super::loft::{Section, Solid};
use super::maker::body_color;
use super::{BodyFrame, BodyMesh};
use nalgebra::Vector3;
use stead_model::robot::{Robot, Spindle};

/// The length that the widths of an arm are in proportion to: the mean of upper arm and forearm, nearly the longest
/// row. m
pub fn scale(robot: &Robot) -> f64 {
    let geometry = robot.geometry();
    (geometry.upper_arm + geometry.forearm) / 2.0 * 1.06
}

/// Distance of the flange's face from the origin of frame 6, along its z axis: where the rows put the frame on the face
/// nothing, and a hand's length where they put it in the wrist centre. m
pub(super) fn flange_face(robot: &Robot, spindle: &Spindle) -> f64 {
    let (size, flange) = (scale(robot), robot.geometry().flange);
    if flange.abs() > 0.05 * size {
        return 0.0;
    }
    0.14 * size * spindle.flange_from_tool.translation.z.signum()
}

/// The bodies of base and links, base first.
pub fn arm_bodies(robot: &Robot, spindle: &Spindle) -> Vec<BodyMesh> {
    let arm = Arm { robot, size: scale(robot) };
    let mut bodies = arm.base().to_vec();
    bodies.extend(arm.carousel());
    bodies.extend(arm.upper_arm());
    bodies.extend(arm.forearm());
    bodies.extend(arm.wrist(flange_face(robot, spindle)));
    bodies
}

struct Arm<'a> {
    robot: &'a Robot,
    /// The length that widths are in proportion to. m
    size: f64,
}

impl Arm<'_> {
    /// The axis of joint `number` in the frame before it.
    fn axis(&self, number: usize) -> Vector3<f64> {
        self.robot.rows()[number - 1].rotation.column(2).into_owned()
    }

    /// The origin of frame `number` in the frame before it. m
    fn origin(&self, number: usize) -> Vector3<f64> {
        self.robot.rows()[number - 1].translation
    }

    /// Where the axis of joint `number` is nearest to that before it, in the frame before it. m
    fn foot(&self, number: usize) -> Vector3<f64> {
        Vector3::new(self.robot.joints()[number - 1].a, 0.0, 0.0)
    }

    fn part(&self, name: &str, frame: u8, paint: Paint, build: impl FnOnce(&mut Solid)) -> BodyMesh {
        let mut solid = Solid::default();
        build(&mut solid);
        let frame = if frame == 0 { BodyFrame::Base } else { BodyFrame::Link(frame) };
        let mut body = illustration(name, frame, paint, solid);
        if paint == Paint::Body {
            body.color = body_color(self.robot);
        }
        body
    }

    /// Height of the axis of joint 2 above the foot of the robot, with its sign along axis 1: the first row, or where
    /// the rows begin at axis 2 what such arms have. m
    fn height(&self) -> f64 {
        let height = self.robot.geometry().shoulder_height;
        if height.abs() > 0.2 * self.size { height } else { 0.6 * self.size }
    }

    /// The length that the parts below the shoulder are in proportion to: less than that of the arm in a low robot. m
    fn base_size(&self) -> f64 {
        self.size.min(self.height().abs() / 0.5)
    }

    /// What stands still: plate, column, and the ring that the arm turns on. It ends 0.3 base sizes below axis 2.
    fn base(&self) -> [BodyMesh; 3] {
        let (wide, low) = (self.size.min(1.4 * self.base_size()), self.base_size());
        let up = self.axis(1) * self.height().signum();
        let shoulder = self.origin(1);
        let at = |below: f64| shoulder - up * below;
        let foot = self.height().abs();
        let round = Section::round();
        [
            self.part("base plate", 0, Paint::Dark, |solid| {
                let ends = [at(foot), at(foot - 0.035 * low)];
                solid.bar(ends, [0.34 * wide; 2], [0.0; 2], 0.007 * low, Section::squarish(9.0));
            }),
            self.part("base column", 0, Paint::Body, |solid| {
                let ends = [at(foot - 0.035 * low), at(0.3 * low)];
                solid.bar(ends, [0.27 * wide, 0.22 * wide], [0.0; 2], 0.03 * low, Section::squarish(2.6));
            }),
            self.part("base ring", 0, Paint::Dark, |solid| {
                solid.bar([at(0.3 * low), at(0.27 * low)], [0.235 * wide; 2], [0.0; 2], 0.005 * low, round);
            }),
        ]
    }

    /// What turns with joint 1: drum, shoulder and the motor of axis 1.
    fn carousel(&self) -> [BodyMesh; 2] {
        let (wide, low) = (self.size.min(1.4 * self.base_size()), self.base_size());
        let up = Vector3::z() * self.height().signum();
        let shoulder = self.foot(2);
        let outward = if shoulder.x < 0.0 { -1.0 } else { 1.0 };
        let round = Section::round();
        [
            self.part("carousel", 1, Paint::Body, |solid| {
                let drum = [up * (-0.27 * low), up * (-0.11 * low)];
                solid.bar(drum, [0.25 * wide, 0.23 * wide], [0.0; 2], 0.016 * wide, round);
                let section = Section::squarish(4.0).flattened(0.8, self.axis(2));
                let from = Vector3::x() * (-0.05 * wide * outward) - up * (0.16 * low);
                let radii = [0.2 * wide, 0.15 * self.size];
                solid.bar([from, shoulder], radii, [0.02 * wide, 0.02 * self.size], 0.02 * self.size, section);
            }),
            self.part("motor 1", 1, Paint::Dark, |solid| {
                let foot = Vector3::new(-0.13 * outward, 0.11, 0.0) * wide - up * (0.16 * low);
                let ends = [foot, foot + up * (0.26 * wide)];
                solid.bar(ends, [0.062 * wide, 0.055 * wide], [0.0; 2], 0.007 * wide, round);
            }),
        ]
    }

    /// What turns with joint 2: the hub on axis 2, as long as the offsets along it ask for, and the upper arm.
    fn upper_arm(&self) -> [BodyMesh; 2] {
        let size = self.size;
        let elbow = self.origin(3);
        // The carousel's plane, and that of the upper arm, along axis 2.
        let planes = [-self.robot.joints()[1].d, elbow.z];
        let (low, high) = (planes[0].min(planes[1]), planes[0].max(planes[1]));
        let z = Vector3::z();
        [
            self.part("hub 2", 2, Paint::Dark, |solid| {
                let ends = [z * (low - 0.19 * size), z * (high + 0.19 * size)];
                solid.bar(ends, [0.135 * size; 2], [0.0; 2], 0.01 * size, Section::round());
            }),
            self.part("upper arm", 2, Paint::Body, |solid| {
                let section = Section::squarish(3.4).flattened(0.72, Vector3::y());
                let radii = [0.135 * size, 0.1 * size];
                solid.bar([z * elbow.z, elbow], radii, [0.13 * size, 0.1 * size], 0.018 * size, section);
            }),
        ]
    }

    /// What turns with joint 3: hub, housing, the forearm up to the wrist, and the three motors of the wrist behind.
    fn forearm(&self) -> [BodyMesh; 3] {
        let size = self.size;
        let (z, foot) = (Vector3::z(), self.foot(4));
        let length = self.robot.joints()[3].d;
        let forward = self.axis(4) * if length < 0.0 { -1.0 } else { 1.0 };
        let along = |distance: f64| foot + forward * (distance * size);
        let wrist = length.abs() / size;
        [
            self.part("hub 3", 3, Paint::Dark, |solid| {
                let ends = [z * (-0.155 * size), z * (0.155 * size)];
                solid.bar(ends, [0.112 * size; 2], [0.0; 2], 0.009 * size, Section::round());
            }),
            self.part("forearm", 3, Paint::Body, |solid| {
                let section = Section::squarish(4.0).flattened(0.95, z);
                if foot.norm() > 0.08 * size {
                    let bridge = section.flattened(0.8, z);
                    solid.bar([Vector3::zeros(), foot], [0.11 * size; 2], [0.04 * size, 0.0], 0.015 * size, bridge);
                }
                let housing = 0.22_f64.min(wrist - 0.02).max(0.05);
                let radii = [0.135 * size, 0.12 * size];
                solid.bar([along(-0.17), along(housing)], radii, [0.0; 2], 0.016 * size, section);
                if wrist - 0.15 > housing {
                    let ends = [along(housing - 0.02), along(wrist - 0.15)];
                    solid.bar(ends, [0.105 * size, 0.07 * size], [0.0; 2], 0.008 * size, Section::squarish(2.6));
                }
            }),
            self.part("wrist motors", 3, Paint::Dark, |solid| {
                for (across, off) in [(-0.06, 0.04), (0.06, 0.04), (0.0, -0.06)] {
                    let side = Vector3::new(off, 0.0, across) * size;
                    let ends = [along(-0.3) + side, along(-0.16) + side];
                    solid.bar(ends, [0.045 * size; 2], [0.0; 2], 0.006 * size, Section::round());
                }
            }),
        ]
    }

    /// What turns with joints 4, 5 and 6, the face of the flange at a distance from the origin of frame 6.
    fn wrist(&self, face: f64) -> [BodyMesh; 5] {
        let size = self.size;
        let z = Vector3::z();
        let back = if self.robot.joints()[3].d < 0.0 { z * size } else { z * -size };
        let toward = (self.robot.geometry().flange + face).signum();
        let flange = self.axis(6) * (self.robot.geometry().flange + face);
        [
            self.part("wrist ring", 4, Paint::Dark, |solid| {
                solid.bar([back * 0.155, back * 0.13], [0.076 * size; 2], [0.0; 2], 0.003 * size, Section::round());
            }),
            self.part("wrist", 4, Paint::Body, |solid| {
                let (ends, radii) = ([back * 0.13, Vector3::zeros()], [0.068 * size, 0.06 * size]);
                solid.bar(ends, radii, [0.0, 0.03 * size], 0.008 * size, Section::squarish(3.0));
            }),
            self.part("hub 5", 5, Paint::Dark, |solid| {
                let ends = [z * (-0.075 * size), z * (0.075 * size)];
                solid.bar(ends, [0.056 * size; 2], [0.0; 2], 0.006 * size, Section::round());
            }),
            self.part("hand", 5, Paint::Body, |solid| {
                let ends = [Vector3::zeros(), flange - self.axis(6) * (0.03 * size * toward)];
                solid.bar(ends, [0.053 * size, 0.05 * size], [0.0; 2], 0.005 * size, Section::squarish(3.0));
            }),
            self.part("flange", 6, Paint::Steel, |solid| {
                let ends = [z * (face - 0.03 * size * toward), z * face];
                solid.bar(ends, [0.06 * size; 2], [0.0; 2], 0.003 * size, Section::round());
            }),
        ]
    }
}
