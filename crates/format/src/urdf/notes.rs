//! What the user should know of an import.

use super::arm::Arm;
use super::deviation::Deviation;
use super::read::{Joint, Kind, Urdf};
use super::rows::{Rows, rounded, written};
use super::stiffness::Borrowed;
use super::tree::Chain;
use super::xml::quoted;
use nalgebra::Matrix3;
use stead_numerics::rotation::zyx_from_rotation;

/// Where the robot stands, as far as the URDF says it.
pub(super) fn stand(arm: &Arm<'_>, is_written: bool) -> Option<String> {
    let Arm { urdf, chain, stand, .. } = arm;
    let [base, root] = [chain.base, chain.root].map(|link| quoted(&urdf.links[link].name));
    if let Some(joint) = chain.carrier(urdf) {
        let joint = quoted(&urdf.joints[joint].name);
        return Some(format!(
            "link {base} is carried by joint {joint}, which moves: where the robot stands in link {root} is not taken; \
             [mount] and [[external_axis]] of a run say it"
        ));
    }
    let mount = stand.mount?;
    let xyz = <[f64; 3]>::from(mount.translation).map(|length| written(length * 1e3));
    let [yaw, pitch, roll] = zyx_from_rotation(&mount.rotation).map(|angle| rounded(angle.to_degrees()));
    let table = match is_written {
        true => "[mount] of the surroundings",
        false => "for [mount] of a run",
    };
    Some(format!(
        "the robot stands in link {root} at xyz_mm = {xyz:?}, rpy_deg = {:?}: {table}, whose z axis points up",
        [roll, pitch, yaw]
    ))
}

/// Rows farther from their URDF than this are noted. mm
const NOTED_MM: f64 = 0.1;

/// A sentence for each thing that a URDF does not say or that is not as usual.
pub(super) fn notes(arm: &Arm<'_>, deviation: Deviation, borrowed: Option<&Borrowed>, is_linkage: bool) -> Vec<String> {
    let Arm { urdf, chain, rows, .. } = arm;
    let mut notes = vec![match borrowed {
        Some(borrowed) => format!(
            "joint stiffness is that of another arm, {}: it ranks placements of arms of that class, and does not predict millimetres",
            borrowed.arm
        ),
        None => "joint stiffness is not in a URDF: measure it (stead identify plan), or take that of a shipped arm \
                 (--stiffness-like kuka-kr270-2)"
            .to_owned(),
    }];
    let Deviation { position_mm, angle_deg } = deviation;
    if position_mm > NOTED_MM {
        notes.push(format!(
            "the numbers of the URDF are rounded: the rows are up to {position_mm:.3} mm and {angle_deg:.4} deg from it"
        ));
    }
    let lateral = rows.rows[1].d_mm + libm::cos(rows.rows[2].alpha_deg.to_radians()) * rows.rows[2].d_mm;
    if lateral.abs() > 0.01 {
        notes.push(format!("lateral offset: the wrist is {:.3} mm beside the plane of axes 1 and 2", lateral.abs()));
    }
    notes.extend(side_joints(urdf, chain, is_linkage));
    notes.extend(chain.moving.iter().flat_map(|joint| limits(&urdf.joints[*joint])));
    notes.extend(tip(&quoted(&urdf.links[chain.tip].name), rows));
    notes
}

/// The joints beside the chain: those of a parallelogram that is taken for one, and those that are left out.
fn side_joints(urdf: &Urdf, chain: &Chain, is_linkage: bool) -> Vec<String> {
    let linkage = if is_linkage { chain.linkage(urdf) } else { Vec::new() };
    let names = |joints: &[usize]| {
        let names = joints.iter().take(12).map(|joint| quoted(&urdf.joints[*joint].name));
        names.collect::<Vec<String>>().join(", ")
    };
    let mut notes = Vec::new();
    if !linkage.is_empty() {
        notes.push(format!(
            "joints {} follow joint {}: a parallelogram drives axis 3, and linkage = true is written; how far the sum of joints 2 and 3 \
             goes is not in a URDF: sum_min_deg and sum_max_deg are what their ranges allow, put in those of the data sheet",
            names(&linkage),
            quoted(&urdf.joints[chain.moving[2]].name)
        ));
    }
    let side: Vec<usize> = chain.side(urdf).into_iter().filter(|joint| !linkage.contains(joint)).collect();
    if !side.is_empty() {
        notes.push(format!(
            "joints that are not in the chain are left out: {}; where they are a parallelogram or a spring beside the arm, limits and \
             stiffness of joints 2 and 3 depend on each other, which [axes_2_3] of the robot file says",
            names(&side)
        ));
    }
    notes
}

/// A joint without limits, and one without a speed.
fn limits(joint: &Joint) -> Vec<String> {
    let name = quoted(&joint.name);
    let has_no_speed = joint.limit.and_then(|limit| limit.velocity).is_none_or(|velocity| velocity == 0.0);
    let endless = || format!("joint {name} turns without end; its limits are written as a turn to either side");
    let speed = || format!("joint {name} has no speed in the URDF");
    (joint.kind == Kind::Continuous).then(endless).into_iter().chain(has_no_speed.then(speed)).collect()
}

/// A tip link that is not on axis 6, or turned against it.
fn tip(link: &str, rows: &Rows) -> Vec<String> {
    let tip = rows.flange_from_tip;
    let beside = libm::hypot(tip.translation.x, tip.translation.y) * 1e3;
    let is_turned = (tip.rotation - Matrix3::identity()).norm() > 1e-6;
    let off = || format!("link {link} is {beside:.3} mm beside axis 6");
    let turned = || {
        format!(
            "link {link} is turned against the frame of the last row, whose z axis is axis 6: the robot file says how"
        )
    };
    (written(beside) > 1e-6).then(off).into_iter().chain(is_turned.then(turned)).collect()
}
