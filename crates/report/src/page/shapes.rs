//! The bodies of robot and spindle as meshes, made from the robot's rows.

use stead_placement::problem::Problem;

/// The frame that a body moves with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyFrame {
    /// The robot base frame.
    Base,
    /// The frame behind joint 1 to 6 of the modified Denavit-Hartenberg rows.
    Link(u8),
    /// The tool frame.
    Tool,
    /// The workpiece frame.
    Workpiece,
}

/// A body as triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMesh {
    /// What it is.
    pub name: String,
    /// What it moves with.
    pub frame: BodyFrame,
    /// Red, green, blue, from 0 to 1.
    pub color: [f32; 3],
    /// Corners in that frame. m
    pub positions: Vec<[f32; 3]>,
    /// Three corners each, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Whether it only illustrates: made from the rows and not from a drawing of the real part.
    pub is_illustration: bool,
}

/// The bodies of the arm and its spindle.
pub fn bodies(problem: &Problem) -> Vec<BodyMesh> {
    let joints = problem.robot.joints();
    let longest = joints.iter().flat_map(|joint| [joint.a.abs(), joint.d.abs()]).fold(0.1, f64::max);
    let mut bodies = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        let radius = longest * [0.22, 0.17, 0.13, 0.09, 0.06, 0.05][index];
        let next = joints.get(index + 1);
        let (sine, cosine) = next.map_or((0.0, 1.0), |next| (libm::sin(next.alpha), libm::cos(next.alpha)));
        let to = next.map_or([0.0, 0.0, 0.08 * longest], |next| [next.a, -sine * next.d, cosine * next.d]);
        let frame = BodyFrame::Link(index as u8 + 1);
        bodies.push(rod(&format!("axis {}", index + 1), frame, [0.23, 0.25, 0.29], [0.0; 3], [0.0, 0.0, 0.01], radius));
        bodies.push(rod(&format!("link {}", index + 1), frame, [0.91, 0.44, 0.15], [0.0; 3], to, 0.7 * radius));
        if index == 0 {
            let foot = [0.0, 0.0, joint.d - 0.6 * longest];
            let dark = [0.23, 0.25, 0.29];
            bodies.push(rod("base", BodyFrame::Base, dark, foot, [0.0, 0.0, joint.d - 0.1 * longest], 0.25 * longest));
        }
    }
    let tool = &problem.spindle.flange_from_tool;
    let back = tool.rotation.transpose() * -tool.translation;
    let blue = [0.17, 0.36, 0.54];
    let up = [0.0, 0.0, back.z];
    bodies.push(rod("spindle", BodyFrame::Tool, blue, [0.0, 0.0, 0.25 * back.z], up, 0.08));
    bodies.push(rod("bracket", BodyFrame::Tool, [0.23, 0.25, 0.29], up, [back.x, back.y, back.z], 0.06));
    bodies.push(rod("cutter", BodyFrame::Tool, [0.84, 0.7, 0.28], [0.0; 3], [0.0, 0.0, 0.26 * back.z], 0.01));
    bodies
}

/// A round rod between two points.
fn rod(name: &str, frame: BodyFrame, color: [f32; 3], from: [f64; 3], to: [f64; 3], radius: f64) -> BodyMesh {
    const CORNERS: u32 = 20;
    let [from, to] = [from, to].map(nalgebra::Vector3::from);
    let along = (to - from).try_normalize(1e-9).unwrap_or(nalgebra::Vector3::z());
    let side = if along.x.abs() < 0.7 { nalgebra::Vector3::x() } else { nalgebra::Vector3::y() };
    let u = along.cross(&side).normalize();
    let v = along.cross(&u);
    let mut positions: Vec<[f32; 3]> = Vec::new();
    for end in [from, to] {
        for k in 0..CORNERS {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(CORNERS);
            let corner = end + (u * libm::cos(angle) + v * libm::sin(angle)) * radius;
            positions.push([corner.x as f32, corner.y as f32, corner.z as f32]);
        }
    }
    let mut triangles = Vec::new();
    for k in 0..CORNERS {
        let next = (k + 1) % CORNERS;
        triangles.extend([[k, next, CORNERS + k], [next, CORNERS + next, CORNERS + k]]);
        if k > 0 && k + 1 < CORNERS {
            triangles.extend([[0, k + 1, k], [CORNERS, CORNERS + k, CORNERS + k + 1]]);
        }
    }
    BodyMesh { name: name.to_owned(), frame, color, positions, triangles, is_illustration: true }
}
