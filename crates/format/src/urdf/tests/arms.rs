//! Arms given by rows, written as URDFs: with joint frames anywhere on the axes and in any orientation, with signs,
//! offsets and base as asked.

use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::fmt::Write;
use stead_model::robot::Pose;

/// An arm by its rows, with the angle of each row at joint value zero and the sense of each joint.
#[derive(Debug, Clone)]
pub struct Arm {
    /// alpha in deg, a and d in m
    pub rows: [(f64, f64, f64); 6],
    pub offsets: [f64; 6],
    pub signs: [f64; 6],
    /// Base frame of the rows in the base link.
    pub base: Pose<f64>,
    /// Base link in the root.
    pub mounted: Pose<f64>,
}

pub fn pose(rotation: Matrix3<f64>, xyz: [f64; 3]) -> Pose<f64> {
    Pose { rotation, translation: xyz.into() }
}

fn about_x(angle: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

pub fn about_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// A rotation away from the singularity of roll, pitch and yaw.
pub fn any_rotation(random: &mut ChaCha8Rng) -> Matrix3<f64> {
    let mut angle = || random.random_range(-1.2..1.2_f64);
    let (s, c) = libm::sincos(angle());
    let about_y = Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
    about_z(angle()) * about_y * about_x(angle())
}

impl Arm {
    /// The frames of the rows in the base link, for joint values in rad: the sixth is the flange.
    pub fn frames(&self, values: &[f64; 6]) -> [Pose<f64>; 6] {
        let mut frame = self.base;
        std::array::from_fn(|k| {
            let (alpha, a, d) = self.rows[k];
            let theta = self.signs[k] * values[k] + self.offsets[k];
            let twist = pose(about_x(alpha.to_radians()), [a, 0.0, 0.0]);
            frame = frame.then(&twist).then(&pose(about_z(theta), [0.0, 0.0, d]));
            frame
        })
    }

    /// The arm as a URDF whose numbers have so many decimals.
    pub fn urdf(&self, random: &mut ChaCha8Rng, decimals: usize) -> String {
        let frames = self.frames(&[0.0; 6]);
        let mut text =
            "<robot name='made'>\n<link name='world'/><link name='base_link'/><link name='tool0'/>\n".to_owned();
        joint(&mut text, ("stand", "fixed", "world", "base_link"), &self.mounted, "", decimals);
        let (mut before, mut parent) = (Pose::identity(), "base_link".to_owned());
        for k in 0..6 {
            // Anywhere on the axis, turned anyhow.
            let moved = pose(any_rotation(random), [0.0, 0.0, random.random_range(-0.3..0.3)]);
            let here = frames[k].then(&moved);
            let axis = here.rotation.transpose() * frames[k].rotation.column(2) * self.signs[k];
            let [x, y, z] = [axis.x, axis.y, axis.z];
            let more = format!(
                "<axis xyz='{x:.decimals$} {y:.decimals$} {z:.decimals$}'/><limit lower='-2' upper='2.5' velocity='3' effort='0'/>"
            );
            let (name, link) = (format!("j{}", k + 1), format!("l{}", k + 1));
            let _ = writeln!(text, "<link name='{link}'/>");
            joint(&mut text, (&name, "revolute", &parent, &link), &before.inverse().then(&here), &more, decimals);
            (before, parent) = (here, link);
        }
        joint(&mut text, ("tool", "fixed", &parent, "tool0"), &before.inverse().then(&frames[5]), "", decimals);
        text + "</robot>\n"
    }
}

fn joint(text: &mut String, names: (&str, &str, &str, &str), origin: &Pose<f64>, more: &str, decimals: usize) {
    let (name, kind, parent, child) = names;
    let r = &origin.rotation;
    let roll = libm::atan2(r[(2, 1)], r[(2, 2)]);
    let pitch = -libm::asin(r[(2, 0)].clamp(-1.0, 1.0));
    let yaw = libm::atan2(r[(1, 0)], r[(0, 0)]);
    let numbers = |v: Vector3<f64>| format!("{:.decimals$} {:.decimals$} {:.decimals$}", v.x, v.y, v.z);
    let (xyz, rpy) = (numbers(origin.translation), numbers(Vector3::new(roll, pitch, yaw)));
    let _ = writeln!(
        text,
        "<joint name='{name}' type='{kind}'><origin xyz='{xyz}' rpy='{rpy}'/><parent link='{parent}'/><child link='{child}'/>{more}</joint>"
    );
}
