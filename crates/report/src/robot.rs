//! Arms: the poses of given joint angles, and the list of shipped arms.

use crate::columns::{line, table};
use crate::document::Document;
use crate::figure::{AngleDeg, ControllerMm, each};
use crate::units::{Unit, fixed};
use serde_json::Value;
use stead_disk::input::InputFile;
use stead_model::robot::{Controller, Pose, Posture, Robot, ShippedArm, Spindle, turns::Range};
use stead_numerics::message::Note;
use stead_numerics::rotation::{quaternion_from_rotation, zyx_from_rotation};

/// An arm at given joint angles.
#[derive(Debug, Clone)]
pub struct ArmPose {
    /// The arm.
    pub robot: Robot,
    /// The joint angles of the rows. rad
    pub joints: [f64; 6],
    /// The spindle on the flange, where one is given.
    pub spindle: Option<Spindle>,
    /// The files that were read.
    pub inputs: Vec<InputFile>,
}

/// Joint angles of one posture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reached {
    /// Inside the limits where they can be. rad
    angles: [f64; 6],
    /// Whether they are.
    is_within: bool,
}

/// A frame with its name: `flange in base`.
type NamedFrame = (&'static str, &'static str, Pose<f64>);

impl ArmPose {
    /// Joint angles as the controller shows them, where that is known.
    fn by_controller(&self, joints: &[f64; 6]) -> Option<[AngleDeg; 6]> {
        self.robot.controller().map(|controller| each(controller.angles(&self.robot, joints)))
    }

    /// Flange and tool in the base frame of the rows, and in the controller's root frame where that is known.
    fn frames(&self) -> Vec<NamedFrame> {
        let flange = self.robot.forward(&self.joints);
        let of_base = [("flange", Some(flange)), ("tool", self.spindle.map(|on| flange.then(&on.flange_from_tool)))];
        let of_base = of_base.into_iter().filter_map(|(name, pose)| Some((name, pose?)));
        let root = self.robot.controller().and_then(|controller| controller.root_from_base);
        let in_root = |(name, pose): (&'static str, Pose<f64>)| root.map(|root| (name, "root", root.then(&pose)));
        let base: Vec<NamedFrame> = of_base.map(|(name, pose)| (name, "base", pose)).collect();
        let roots: Vec<NamedFrame> = base.iter().filter_map(|(name, _, pose)| in_root((name, *pose))).collect();
        base.into_iter().chain(roots).collect()
    }

    /// The joint angles of every posture that has the flange here; none where the posture does not reach the pose.
    fn postures(&self) -> Vec<(Posture, Option<Reached>)> {
        let flange = self.robot.forward(&self.joints);
        let of = |posture: Posture| {
            let wrapped = self.robot.inverse(&flange, posture).ok()?;
            let nearest = |joint: usize| Range::of(&self.robot.joints()[joint]).nearest(wrapped[joint]);
            let angles = std::array::from_fn(|joint| nearest(joint).0);
            let is_within = (0..6).all(|joint| nearest(joint).1 == 0.0) && self.robot.beyond_sum(&angles) <= 1e-9;
            Some(Reached { angles, is_within })
        };
        Posture::ALL.into_iter().map(|posture| (posture, of(posture))).collect()
    }

    /// That given angles are beyond a limit, a sentence for each.
    pub fn notes(&self) -> Vec<Note> {
        let beyond = |(joint, angle): (usize, f64)| {
            let row = &self.robot.joints()[joint];
            (angle < row.min - 1e-9 || angle > row.max + 1e-9).then(|| {
                let [angle, min, max] = [angle, row.min, row.max].map(f64::to_degrees);
                format!("joint {} at {angle:.3} deg is beyond its limits, {min:.3} to {max:.3} deg", joint + 1)
            })
        };
        let sum = self.robot.sum_range().filter(|_| self.robot.beyond_sum(&self.joints) > 1e-9).map(|range| {
            let [sum, min, max] = [self.robot.sum_of(&self.joints), range.min, range.max].map(f64::to_degrees);
            format!("the sum of joints 2 and 3 at {sum:.3} deg is beyond its limits, {min:.3} to {max:.3} deg")
        });
        self.joints.into_iter().enumerate().filter_map(beyond).chain(sum).map(Note::may_be_wrong).collect()
    }
}

/// A position as controllers show it.
const PLACE_MM: Unit = Unit { factor: 1e3, decimals: 3 };
/// An angle as controllers show it, with a digit more.
const ANGLE_DEG: Unit = Unit { factor: 180.0 / std::f64::consts::PI, decimals: 4 };

/// What `stead pose` prints.
pub fn pose_text(pose: &ArmPose) -> String {
    let mut text = String::new();
    let named = pose.robot.named_posture(Posture::of(&pose.robot, &pose.joints));
    line(&mut text, &format!("{}, posture {}", pose.robot.name(), named));
    text.push('\n');
    let controller = pose.robot.controller();
    let names: Vec<String> = (1..=6).map(|joint| format!("joint {joint}")).collect();
    let row = |name: &str, angles: [f64; 6]| {
        std::iter::once(name.to_owned()).chain(angles.map(|angle| ANGLE_DEG.text(angle))).collect::<Vec<_>>()
    };
    let mut rows = vec![row("theta deg", pose.joints)];
    rows.extend(controller.map(|controller| row("controller deg", controller.angles(&pose.robot, &pose.joints))));
    text.push_str(&table(std::iter::once(String::new()).chain(names.clone()), rows, &[0]));
    text.push('\n');
    text.push_str(&frames_text(&pose.frames()));
    text.push_str(&format!("\nAll postures of this flange pose, in {}\n\n", angles_of(controller)));
    let header = std::iter::once("posture".to_owned()).chain(names).chain(["within limits", ""].map(str::to_owned));
    let rows = pose.postures().into_iter().map(|(posture, found)| {
        let angles = found
            .map(|found| controller.map_or(found.angles, |controller| controller.angles(&pose.robot, &found.angles)));
        let cells = angles.map_or_else(|| vec!["-".to_owned(); 6], |of| of.map(|angle| ANGLE_DEG.text(angle)).into());
        let verdict = match found {
            Some(Reached { is_within: true, .. }) => "yes",
            Some(Reached { is_within: false, .. }) => "no",
            None => "out of reach",
        };
        let said = [verdict.to_owned(), pose.robot.posture_words(posture).to_string()];
        std::iter::once(posture.to_string()).chain(cells).chain(said).collect()
    });
    text.push_str(&table(header, rows, &[7, 8]));
    text
}

/// What the angles of the table of postures are.
fn angles_of(controller: Option<&Controller>) -> &'static str {
    if controller.is_some() { "controller angles, deg" } else { "angles of the rows, deg" }
}

fn frames_text(frames: &[NamedFrame]) -> String {
    let header = ["frame", "x mm", "y mm", "z mm", "A deg", "B deg", "C deg", "qw", "qx", "qy", "qz"];
    let rows = frames.iter().map(|(name, of, pose)| {
        let place = pose.translation.iter().map(|v| PLACE_MM.text(*v));
        let angles = zyx_from_rotation(&pose.rotation).map(|angle| ANGLE_DEG.text(angle));
        let quaternion = quaternion_from_rotation(&pose.rotation).map(|v| fixed(v, 6));
        std::iter::once(format!("{name} in {of}")).chain(place).chain(angles).chain(quaternion).collect()
    });
    let mut text = table(header, rows, &[0]);
    text.push_str(
        "\nRotation = Rz(A) Ry(B) Rx(C): KUKA's A, B, C; Fanuc's R, P, W; yaw, pitch, roll. As matrices, by rows:\n",
    );
    for (name, of, pose) in frames {
        let row = |k: usize| pose.rotation.row(k).iter().map(|v| fixed(*v, 6)).collect::<Vec<_>>().join(", ");
        text.push_str(&format!("{name} in {of}: [[{}], [{}], [{}]]\n", row(0), row(1), row(2)));
    }
    text
}

records! {
    /// An arm at given joint angles.
    pub struct PoseFigures of (pose: &ArmPose) {
        let frame = |(frame, within, pose): NamedFrame| FrameFigures::of(frame, within, &pose);
        let posture = |(posture, found): (Posture, Option<Reached>)| PostureFigures::of(pose, posture, found);
    } with {
        /// Name of the robot.
        robot: String = pose.robot.name().to_owned(),
        /// The posture, 1 to 8.
        #[schemars(with = "u8")] posture: Posture = Posture::of(&pose.robot, &pose.joints),
        /// The same in words.
        posture_words: String = pose.robot.posture_words(Posture::of(&pose.robot, &pose.joints)).to_string(),
        /// Joint angles of the rows.
        joints_deg: [AngleDeg; 6] = each(pose.joints),
        /// Joint angles of the controller; null where none is known.
        controller_deg: Option<[AngleDeg; 6]> = pose.by_controller(&pose.joints),
        /// Flange and tool in the base frame of the rows, and in the controller's root frame where that is known.
        frames: Vec<FrameFigures> = pose.frames().into_iter().map(frame).collect(),
        /// Every posture that has the flange here.
        postures: Vec<PostureFigures> = pose.postures().into_iter().map(posture).collect(),
    }

    /// A frame.
    pub struct FrameFigures of (frame: &'static str, within: &'static str, pose: &Pose<f64>) {
        /// `flange` or `tool`.
        frame: &'static str = frame,
        /// The frame that it is in.
        #[serde(rename = "in")] within: &'static str = within,
        /// Its origin.
        xyz_mm: [ControllerMm; 3] = each(pose.translation.into()),
        /// Angles about z, y and x.
        abc_deg: [AngleDeg; 3] = each(zyx_from_rotation(&pose.rotation)),
        /// Its rotation as a quaternion.
        quaternion_wxyz: [f64; 4] = quaternion_from_rotation(&pose.rotation),
        /// Its rotation as a matrix, by rows.
        rotation: Vec<Vec<f64>> = pose.rotation.row_iter().map(|row| row.iter().copied().collect()).collect(),
    }

    /// Joint angles of a posture; null where it does not reach the pose.
    pub struct PostureFigures of (pose: &ArmPose, posture: Posture, found: Option<Reached>) {
        /// The posture, 1 to 8.
        #[schemars(with = "u8")] posture: Posture = posture,
        /// The same in words.
        posture_words: String = pose.robot.posture_words(posture).to_string(),
        /// Joint angles of the rows.
        joints_deg: Option<[AngleDeg; 6]> = found.map(|found| each(found.angles)),
        /// Joint angles of the controller.
        controller_deg: Option<[AngleDeg; 6]> = found.and_then(|found| pose.by_controller(&found.angles)),
        /// Whether they are within the limits.
        within_limits: bool = found.is_some_and(|found| found.is_within),
    }
}

/// What `stead pose --json` prints.
pub fn pose_json(pose: &ArmPose) -> Value {
    Document::new(&pose.inputs).notes(pose.notes()).with(PoseFigures::of(pose))
}

/// What `stead robots` prints.
pub fn robots_text(arms: &[ShippedArm]) -> String {
    let header =
        ["name", "arm", "payload kg", "wrist reach mm", "stiffness", "masses", "linkage", "controller", "not verified"];
    let yes = |is: bool| if is { "yes" } else { "-" }.to_owned();
    let rows = arms.iter().map(|arm| {
        let unverified = arm.robot.unverified();
        vec![
            arm.name.to_owned(),
            arm.robot.name().to_owned(),
            arm.robot.data_sheet().payload.map_or_else(String::new, |kg| fixed(kg, 0)),
            fixed(arm.robot.geometry().reach() * 1e3, 0),
            yes(arm.has_stiffness),
            yes(arm.has_dynamics),
            yes(arm.robot.has_linkage()),
            arm.robot.controller().map_or_else(|| "-".to_owned(), |controller| controller.kind.word().to_owned()),
            if unverified.is_empty() { "-".to_owned() } else { unverified.join("; ") },
        ]
    });
    table(header, rows, &[0, 1, 4, 5, 6, 7, 8])
}

records! {
    /// The shipped arms.
    pub struct ArmList of (arms: &[ShippedArm]) {
        /// The arms, by their names.
        robots: Vec<ArmFigures> = arms.iter().map(ArmFigures::of).collect(),
    }

    /// A shipped arm.
    pub struct ArmFigures of (arm: &ShippedArm) {
        /// The name to ask for it by.
        name: &'static str = arm.name,
        /// Its full name.
        robot: String = arm.robot.name().to_owned(),
        /// Payload. kg
        payload_kg: Option<f64> = arm.robot.data_sheet().payload,
        /// How far its wrist centre gets from axis 1.
        wrist_reach_mm: ControllerMm = arm.robot.geometry().reach().into(),
        /// Whether the stiffness of every joint is known.
        has_stiffness: bool = arm.has_stiffness,
        /// Whether masses and damping are known.
        has_masses: bool = arm.has_dynamics,
        /// Whether a parallelogram drives axis 3.
        has_linkage: bool = arm.robot.has_linkage(),
        /// Its controller.
        controller: Option<&'static str> = arm.robot.controller().map(|controller| controller.kind.word()),
        /// Figures that nobody has verified.
        unverified: Vec<String> = arm.robot.unverified().to_vec(),
        /// Where its figures come from.
        source: String = arm.source.clone(),
    }
}

/// What `stead robots --json` prints.
pub fn robots_json(arms: &[ShippedArm]) -> Value {
    Document::new(&[]).with(ArmList::of(arms))
}
