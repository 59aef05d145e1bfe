//! External axes as nodes of the scene: what they carry moves with them.

use super::buffer::Buffer;
use super::document::{Node, Writer, single};
use super::motion::turn_about;
use stead_model::external_axis::{AxisKind, Carried, ExternalAxis};

/// The nodes of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct AxisNodes {
    /// The node that is animated.
    pub moving: usize,
    /// What moves with the axis, in the frame of the cell where all axes are at zero.
    pub frame: usize,
}

/// The frame of the last axis that carries something.
pub(super) fn last_of(axes: &[ExternalAxis], nodes: &[AxisNodes], what: Carried) -> Option<usize> {
    axes.iter().zip(nodes).rev().find(|(axis, _)| axis.carries == what).map(|(_, nodes)| nodes.frame)
}

/// Values of the track of an axis at its positions (m or rad), and what of its node they are.
pub(super) fn track(
    buffer: &mut Buffer,
    axis: &ExternalAxis,
    positions: impl Iterator<Item = f64>,
) -> (usize, &'static str) {
    match axis.kind {
        AxisKind::Rail => {
            let places: Vec<[f32; 3]> = positions.map(|at| single(&(axis.direction * at))).collect();
            (buffer.translations(&places), "translation")
        }
        AxisKind::Turntable => {
            let turns: Vec<[f32; 4]> = positions.map(|at| turn_about(&axis.direction, at)).collect();
            (buffer.rotations(&turns), "rotation")
        }
    }
}

impl Writer {
    /// The nodes of external axes: those that carry the same thing stand on each other, the first one in the cell.
    pub(super) fn add_axes(&mut self, axes: &[ExternalAxis], root: usize) -> Vec<AxisNodes> {
        let mut nodes: Vec<AxisNodes> = Vec::new();
        for axis in axes {
            let parent = last_of(axes, &nodes, axis.carries).unwrap_or(root);
            // A turntable turns about its point.
            let place = match axis.kind {
                AxisKind::Rail => None,
                AxisKind::Turntable => Some(axis.point),
            };
            // Animated nodes state what is animated, else viewers show what a node is at rest differently.
            let moving = self.add_child(
                Node {
                    name: format!("external axis {}", axis.name),
                    translation: Some(place.map_or([0.0; 3], |place| single(&place))),
                    rotation: Some([0.0, 0.0, 0.0, 1.0]),
                    ..Node::default()
                },
                parent,
            );
            let frame = place.map_or(moving, |place| {
                let back =
                    Node { name: format!("on {}", axis.name), translation: Some(single(&-place)), ..Node::default() };
                self.add_child(back, moving)
            });
            nodes.push(AxisNodes { moving, frame });
        }
        nodes
    }
}
