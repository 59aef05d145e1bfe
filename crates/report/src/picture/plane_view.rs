//! How a plane of the cell is shown: what its axes are called, and what of the robot lies in it.

use crate::units::fixed;
use nalgebra::Vector3;
use stead_assessment::benchmark::Plane;
use stead_model::robot::Robot;

/// Names of the axes of the base frame.
const BASE_AXES: [&str; 3] = ["x", "y", "z"];
/// Labels of coordinates of the base frame.
const BASE_LABELS: [&str; 3] = ["x (mm)", "y (mm)", "z (mm)"];
/// Labels of coordinates of the plane.
const PLANE_LABELS: [&str; 2] = ["along the plane's first axis (mm)", "along the plane's second axis (mm)"];
/// Unit vectors that differ by less are the same; so are places of the plane's size, in m.
const SAME: f64 = 1e-9;

/// A view straight onto a plane. Coordinates shown are those of the base frame where an axis of the plane is one of the
/// base frame, else those of the plane.
pub(crate) struct PlaneView {
    plane: Plane,
    /// Coordinates shown of the origin of the plane. m
    offset: [f64; 2],
    /// Labels of both axes, with their unit.
    pub labels: [&'static str; 2],
}

/// What of an arm lies in a plane, in coordinates shown. mm
pub(crate) struct ArmInPlane {
    /// Axis 2 of the arm as it reaches to the side in view.
    pub shoulder: [f64; 2],
    /// The point of axis 1 nearest to it.
    pub foot: [f64; 2],
    /// Direction of axis 1, of unit length.
    pub along: [f64; 2],
}

impl PlaneView {
    /// The view onto a plane.
    pub fn new(plane: &Plane) -> Self {
        let base = [&plane.x, &plane.y].map(base_axis);
        let offset = base.map(|axis| axis.map_or(0.0, |axis| plane.origin[axis]));
        let labels = [0, 1].map(|k| base[k].map_or(PLANE_LABELS[k], |axis| BASE_LABELS[axis]));
        Self { plane: *plane, offset, labels }
    }

    /// Coordinates shown of a place of the plane. m to mm
    pub fn shown(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (place[k] + self.offset[k]) * 1e3)
    }

    /// Which plane it is, for people.
    pub fn words(&self) -> String {
        let (normal, origin) = (self.plane.normal(), &self.plane.origin);
        if let Some(axis) = base_axis(&normal).or_else(|| base_axis(&-normal)) {
            return format!("plane {} = {} mm", BASE_AXES[axis], fixed(origin[axis] * 1e3, 0));
        }
        let triple = |v: &Vector3<f64>, factor: f64, decimals| {
            [v.x, v.y, v.z].map(|part| fixed(part * factor, decimals)).join(", ")
        };
        format!("plane through ({}) mm, normal ({})", triple(origin, 1e3, 0), triple(&normal, 1.0, 3))
    }

    /// What lies in the plane of an arm that reaches towards a place of the plane (m): `None` where axis 1 is not in
    /// the plane.
    pub fn arm(&self, robot: &Robot, towards: [f64; 2]) -> Option<ArmInPlane> {
        let geometry = robot.geometry();
        let axis = geometry.base_from_root.column(2).into_owned();
        let normal = self.plane.normal();
        let root = geometry.root_in_base - self.plane.origin;
        if axis.dot(&normal).abs() > SAME || root.dot(&normal).abs() > SAME {
            return None;
        }
        let aside = normal.cross(&axis);
        let reaching = (self.plane.x * towards[0] + self.plane.y * towards[1] - root).dot(&aside);
        let foot = root + axis * geometry.shoulder_height;
        let shoulder = foot + aside * geometry.shoulder_radius * if reaching < 0.0 { -1.0 } else { 1.0 };
        let in_plane = |point: &Vector3<f64>| [point.dot(&self.plane.x), point.dot(&self.plane.y)];
        Some(ArmInPlane {
            shoulder: self.shown(in_plane(&shoulder)),
            foot: self.shown(in_plane(&foot)),
            along: in_plane(&axis),
        })
    }
}

/// Which axis of the base frame a direction is.
fn base_axis(direction: &Vector3<f64>) -> Option<usize> {
    (0..3).find(|axis| (direction - Vector3::ith(*axis, 1.0)).norm() < SAME)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::robot::testing::kr270;

    #[test]
    fn the_vertical_plane_shows_base_coordinates_and_the_arm() {
        let plane = Plane { origin: Vector3::new(0.1, 0.0, -0.2), ..Plane::XOZ };
        let view = PlaneView::new(&plane);
        assert_eq!(view.labels, ["x (mm)", "z (mm)"]);
        assert_eq!(view.shown([0.4, 0.2]).map(f64::round), [500.0, 0.0]);
        assert_eq!(view.words(), "plane y = 0 mm");
        let robot = kr270();
        let geometry = robot.geometry();
        // The axis of the file points down: the height of the shoulder counts along it.
        let height = (geometry.base_from_root[(2, 2)] * geometry.shoulder_height + geometry.root_in_base.z) * 1e3;
        for (towards, sign) in [([1.0, 0.5], 1.0), ([-1.0, 0.5], -1.0)] {
            let arm = view.arm(&robot, towards).unwrap();
            let [x, z] = arm.shoulder;
            assert!((x - sign * geometry.shoulder_radius * 1e3).abs() < 1e-9 && (z - height).abs() < 1e-9);
            assert!(arm.foot[0].abs() < 1e-9 && arm.along[0].abs() < 1e-12 && arm.along[1].abs() == 1.0);
        }
    }

    #[test]
    fn other_planes_show_their_own_coordinates_and_no_arm() {
        let slanted = Vector3::new(1.0, 1.0, 0.0).normalize();
        let plane = Plane { origin: Vector3::new(0.5, 0.0, 1.0), x: slanted, y: Vector3::z() };
        let view = PlaneView::new(&plane);
        assert_eq!(view.labels, ["along the plane's first axis (mm)", "z (mm)"]);
        assert_eq!(view.words(), "plane through (500, 0, 1000) mm, normal (0.707, -0.707, 0.000)");
        assert!(view.arm(&kr270(), [1.0, 0.0]).is_none());
        let lying = Plane { origin: Vector3::new(0.0, 0.0, 0.8), x: Vector3::x(), y: -Vector3::y() };
        let view = PlaneView::new(&lying);
        assert_eq!(view.labels, ["x (mm)", "along the plane's second axis (mm)"]);
        assert_eq!(view.words(), "plane z = 800 mm");
        assert!(view.arm(&kr270(), [1.0, 0.0]).is_none());
    }
}
