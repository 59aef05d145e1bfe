//! The springs of an arm as columns of equations, and which of them are sought.
//!
//! A column is a spring: first the six about the joint axes (z of the frames of the rows), base first; then, where
//! springs normal to the axes are sought too, those about x and y of joint 1, x and y of joint 2, and so on. So the
//! equations of a fit about the axes alone are the first six columns of those of a full one. Code is generic over the
//! number of columns, [`AXES`] or [`FULL`].

use nalgebra::SVector;
use serde::Serialize;
use stead_model::robot::{About, Robot, Spring};

/// Columns of a fit of the springs about the joint axes alone.
pub const AXES: usize = 6;
/// Columns of a fit of the springs about three directions of every joint.
pub const FULL: usize = 18;

stead_numerics::worded! {
    /// About which axes the joints of an arm have springs.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum FitModel {
        /// About the joint axes alone: these springs absorb what links and bearings do, as far as they can.
        #[default]
        Axes = "axes",
        /// About z, x and y of the frame of every row.
        Full = "full",
    }
}

impl FitModel {
    /// How many springs the arm has.
    pub fn columns(self) -> usize {
        match self {
            Self::Axes => AXES,
            Self::Full => FULL,
        }
    }

    /// The name of a compliance in messages, and, where its joint has several, at an angle (rad): `k_3` among springs
    /// about the axes alone, `joint 3 about z` among all.
    pub fn name(self, spring: Spring, angle: Option<f64>) -> String {
        let name = match self {
            Self::Axes => format!("k_{}", spring.joint + 1),
            Self::Full => spring.to_string(),
        };
        match angle {
            Some(angle) => format!("{name} at {:.2} deg", angle.to_degrees()),
            None => name,
        }
    }
}

/// A spring as identification files name it: `joints[3].x`.
pub fn key_name(spring: Spring) -> String {
    format!("joints[{}].{}", spring.joint + 1, spring.about.word())
}

/// The spring of a column.
pub fn spring(column: usize) -> Spring {
    match column.checked_sub(AXES) {
        None => Spring { joint: column, about: About::Z },
        Some(normal) => Spring { joint: normal / 2, about: if normal % 2 == 0 { About::X } else { About::Y } },
    }
}

/// The column of a spring.
pub fn column(spring: Spring) -> usize {
    match spring.about {
        About::Z => spring.joint,
        About::X => AXES + 2 * spring.joint,
        About::Y => AXES + 2 * spring.joint + 1,
    }
}

/// The compliances of an arm at joint angles (rad), those normal to the axes as its file states them, zero where it
/// states none. rad/(N m)
pub fn compliances_of<const N: usize>(robot: &Robot, theta: &[f64; 6]) -> SVector<f64, N> {
    let axial = robot.compliances_at(theta);
    SVector::from_fn(|column, _| match spring(column) {
        Spring { joint, about: About::Z } => axial[joint],
        normal => stated_normal(robot, normal),
    })
}

/// The compliance of a spring normal to an axis as the robot file states it, zero where it states none. rad/(N m)
pub fn stated_normal(robot: &Robot, spring: Spring) -> f64 {
    let place = usize::from(spring.about == About::Y);
    robot.stated_normal_springs().map_or(0.0, |springs| springs[spring.joint].compliance[place])
}

/// Which columns are held, for springs about the axes and those about x and y of each joint.
pub fn held<const N: usize>(about_axes: &[bool; 6], normal: &[[bool; 2]; 6]) -> [bool; N] {
    std::array::from_fn(|column| match spring(column) {
        Spring { joint, about: About::Z } => about_axes[joint],
        Spring { joint, about } => normal[joint][usize::from(about == About::Y)],
    })
}

/// Where the springs normal to the axis of each joint sit: coordinate on the axis. m
pub fn bearings(robot: &Robot) -> [f64; 6] {
    robot.stated_normal_springs().map_or([0.0; 6], |springs| springs.each_ref().map(|springs| springs.bearing))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_and_springs_are_told_from_each_other() {
        for number in 0..FULL {
            assert_eq!(column(spring(number)), number);
        }
        let names: Vec<String> = (0..FULL).map(|number| FitModel::Full.name(spring(number), None)).collect();
        assert_eq!(names[2], "joint 3 about z");
        assert_eq!(names[6..9], ["joint 1 about x", "joint 1 about y", "joint 2 about x"]);
        assert_eq!(FitModel::Axes.name(spring(4), Some(0.5)), "k_5 at 28.65 deg");
    }
}
