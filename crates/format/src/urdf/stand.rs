//! Where the robot of a URDF stands: the fixed joints between the root link and the base link of the arm.

use super::forward::base_at;
use super::read::Urdf;
use super::rows::Rows;
use super::tree::Chain;
use stead_model::robot::Pose;

/// Where the robot stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stand {
    /// The base frame of the rows in the root link, as `[mount]` has it; nothing where base link and root link are one
    /// frame, or where a joint that moves is between.
    pub mount: Option<Pose<f64>>,
    /// The link whose shapes, with all that is fixed to it, stand with the base: the root where fixed joints alone lead
    /// from there to the base link.
    pub link: usize,
    /// That link in the base frame of the rows.
    pub base_from_link: Pose<f64>,
}

/// Poses nearer to none than this are none: of a length (m) and of the entries of a rotation.
const NOWHERE: f64 = 1e-9;

impl Stand {
    pub(super) fn of(urdf: &Urdf, chain: &Chain, rows: &Rows) -> Self {
        let Some(root_from_link) = base_at(urdf, chain) else {
            return Self { mount: None, link: chain.base, base_from_link: rows.link_from_base.inverse() };
        };
        let turned = root_from_link.rotation - Pose::<f64>::identity().rotation;
        let is_moved = root_from_link.translation.amax() > NOWHERE || turned.amax() > NOWHERE;
        let root_from_base = root_from_link.then(&rows.link_from_base);
        Self { mount: is_moved.then_some(root_from_base), link: chain.root, base_from_link: root_from_base.inverse() }
    }

    /// The link in the frame that shapes on the base are stated in: that of the cell where the robot is mounted, the
    /// base of the rows where not.
    pub(super) fn cell_from_link(&self) -> Pose<f64> {
        self.mount.map_or(self.base_from_link, |mount| mount.then(&self.base_from_link))
    }
}
