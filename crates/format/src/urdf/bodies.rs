//! The masses of a URDF in the frames of the rows.

use super::arm::Arm;
use super::forward::link_at;
use super::read::{Kind, Urdf};
use super::xml::quoted;
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::{Inertial, Pose};

/// The body behind each joint of the chain, with the links that are fixed to it, in the frame of the row.
///
/// # Errors
/// Why the URDF does not state all six: a sentence without its full stop.
pub(super) fn bodies(arm: &Arm<'_>) -> Result<[Inertial; 6], String> {
    let mut bodies = Vec::with_capacity(6);
    for (link, row_from_link) in row_from_links(arm) {
        let body =
            rigid(arm.urdf, link)?.ok_or_else(|| format!("link {} has no mass", quoted(&arm.urdf.links[link].name)))?;
        let body = body.placed(&row_from_link);
        let checked = Inertial::new(body.mass(), *body.centre(), *body.inertia());
        bodies.push(checked.map_err(|error| format!("link {}: {error}", quoted(&arm.urdf.links[link].name)))?);
    }
    <[Inertial; 6]>::try_from(bodies).map_err(|_| "not six bodies".to_owned())
}

/// The links behind the six moving joints, each with its pose in the frame of its row.
pub(super) fn row_from_links(arm: &Arm<'_>) -> [(usize, Pose<f64>); 6] {
    let Arm { urdf, chain, rows, robot, .. } = arm;
    let mut base_from_row = rows.link_from_base;
    std::array::from_fn(|k| {
        let joint = chain.moving[k];
        let theta = rows.rows[k].offset_deg.to_radians();
        base_from_row = base_from_row.then(&robot.rows()[k]).then(&about_z(theta));
        let last = chain.path.iter().position(|other| *other == joint).unwrap_or_default();
        let row_from_link = base_from_row.inverse().then(&link_at(urdf, chain, &[0.0; 6], last));
        (urdf.joints[joint].child, row_from_link)
    })
}

/// A link and all that is fixed to it, each with its pose in the frame of the link.
pub(super) fn attached_to(urdf: &Urdf, link: usize) -> Vec<(usize, Pose<f64>)> {
    let mut attached = vec![(link, Pose::identity())];
    let mut next = 0;
    while let Some((link, pose)) = attached.get(next).copied() {
        let fixed = urdf.joints.iter().filter(|joint| joint.parent == link && joint.kind == Kind::Fixed);
        attached.extend(fixed.map(|joint| (joint.child, pose.then(&joint.origin))));
        next += 1;
    }
    attached
}

/// A link and all that is fixed to it, in its frame.
fn rigid(urdf: &Urdf, link: usize) -> Result<Option<Inertial>, String> {
    let mut whole: Option<Inertial> = None;
    for (link, pose) in attached_to(urdf, link) {
        if let Some(inertial) = &urdf.links[link].inertial {
            let body =
                inertial.map_err(|error| format!("link {}: {error}", quoted(&urdf.links[link].name)))?.placed(&pose);
            whole = Some(whole.map_or(body, |whole| whole.joined(&body)));
        }
    }
    Ok(whole)
}

/// A turn about z. rad
pub(super) fn about_z(angle: f64) -> Pose<f64> {
    let (sine, cosine) = libm::sincos(angle);
    Pose { rotation: Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0), translation: Vector3::zeros() }
}
