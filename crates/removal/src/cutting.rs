//! The cutter as the removal needs it: pieces, teeth, the force on a bit of removed volume.

use crate::load::Sums;
use crate::moves::Move;
use crate::operation::EndMill;
use crate::piece::{EdgePoint, Piece, Surface};
use crate::profile::Profile;
use nalgebra::Vector3;
use std::f64::consts::TAU;
use stead_model::cutting::{Coefficients, Cutter};
use stead_model::task::Wrench;

/// A cutter, ready to remove.
#[derive(Debug, Clone)]
pub struct Tool {
    /// Pieces along flutes and shank, from below; together they are convex.
    pub pieces: Vec<Piece>,
    /// Shank and holder, each by itself.
    pub holder: Vec<Piece>,
    /// Teeth, helix, sense of rotation and coefficients.
    pub cutter: Cutter,
    /// Length of the flutes. m
    pub flute_length: f64,
    /// Radius about the axis in which the bottom does not cut. m
    pub dead_centre: f64,
    /// Length of the edge from the axis to the top of the flutes. m
    pub edge: f64,
    /// Where each piece begins along the edge. m
    starts: Vec<f64>,
    /// +1 where it turns clockwise, seen from the spindle, else -1.
    clockwise: f64,
    is_cylinder: bool,
}

/// How far from the axis 1 / r is taken as it is at the mean over a cell, in cells: of a cutter that moves along its
/// axis, whose lines stay at their radius, and of one that moves across it, whose lines pass at every radius.
const TIP: [f64; 2] = [0.28, 0.08];

/// What a bit of removed volume adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bit {
    /// When in the move it is cut; below zero before it begins.
    pub when: f64,
    /// What it adds to those of its node.
    pub sums: Sums,
    /// Height above the tool centre point. m
    pub height: f64,
    /// Distance from the axis. m
    pub radius: f64,
    /// The same for means over a cell of 1 / r. m
    pub mean_radius: f64,
    /// Place along the edge of the cutter, from the axis. m
    pub along_edge: f64,
    /// Displacement of the surface along its normal per length of path: the chip over the feed per tooth.
    pub speed: f64,
    /// From the axis out to it.
    pub outward: Vector3<f64>,
    /// Whether a surface that faces down cuts it.
    pub is_below: bool,
}

impl Tool {
    /// A cutter whose shank goes on above its flutes to a height. m
    pub fn new(mill: &EndMill, height: f64) -> Self {
        Self::of_profile(&mill.profile(), mill, height)
    }

    /// The same of another outer shape.
    pub fn of_profile(profile: &Profile, mill: &EndMill, height: f64) -> Self {
        let mut pieces = profile.pieces();
        let (mut starts, mut edge) = (Vec::new(), profile.radius - profile.corner);
        if profile.corner >= profile.radius - 1e-9 {
            edge = 0.0;
        }
        for piece in &pieces {
            starts.push(edge);
            edge += piece.edge();
        }
        let top = pieces.last().map_or(profile.radius, |piece| piece.radius);
        if height > mill.flute_length {
            pieces.push(Piece::cone([mill.flute_length, height], [top, top]));
            starts.push(edge);
        }
        let holder =
            mill.holder.iter().map(|part| Piece::cone([part.from, part.to], [part.radius, part.radius])).collect();
        Self {
            is_cylinder: profile.corner <= 0.0 && profile.taper == 0.0,
            pieces,
            holder,
            cutter: mill.cutter.clone(),
            flute_length: mill.flute_length,
            dead_centre: mill.dead_centre(),
            edge,
            starts,
            clockwise: -mill.cutter.rotation().sign(),
        }
    }

    /// The edge at a length from the axis. m
    pub fn edge_at(&self, along: f64) -> EdgePoint {
        let number = self.starts.partition_point(|start| *start <= along);
        match number.checked_sub(1).map(|number| (&self.pieces[number], along - self.starts[number])) {
            None => EdgePoint { height: 0.0, normal: [0.0, -1.0] },
            Some((piece, along)) => piece.edge_at(along),
        }
    }

    /// Whether all that a move removes is cut by surfaces along an axis, so that lines along it count nothing.
    pub fn cuts_along(&self, one: &Move, axis: usize) -> bool {
        self.is_cylinder
            && one.turn == Vector3::zeros()
            && one.axis[axis].abs() > 1.0 - 1e-12
            && one.by.dot(&one.axis).abs() <= 1e-12 * one.by.norm()
    }
}

/// A cutter on a move, with what all bits have in common.
#[derive(Debug, Clone)]
pub struct Moving<'m> {
    tool: &'m Tool,
    /// The move.
    pub one: &'m Move,
    coefficients: Coefficients,
    /// One over the length of path. 1/m
    per_length: f64,
    /// Square of the distance from the axis that 1 / r is smoothed over. m2
    tip: f64,
    /// Directions normal to the axis: of the feed, and left of it.
    pub across: [Vector3<f64>; 2],
    teeth: f64,
}

impl<'m> Moving<'m> {
    /// A cutter on a move, for lines at a distance (m).
    pub fn new(tool: &'m Tool, one: &'m Move, cell: f64) -> Self {
        let length = one.by.norm().max(1e-12);
        let along = one.by.dot(&one.axis).abs() / length;
        let tip = TIP[1].max(TIP[0] * along) * cell;
        Self {
            tool,
            one,
            coefficients: tool.cutter.coefficients(),
            per_length: 1.0 / length,
            tip: tip * tip,
            across: across(one),
            teeth: tool.cutter.teeth().len() as f64,
        }
    }

    /// What a bit of removed volume (m3) on a line along an axis adds; none where no piece meets it or it counts
    /// nothing.
    pub fn bit(&self, point: &Vector3<f64>, axis: usize, volume: f64) -> Option<Bit> {
        let Self { tool, one, .. } = self;
        let u = one.displacement(point);
        let start = point - one.middle + u / 2.0;
        // The first piece that gets to the point, and when.
        let mut met: Option<(f64, usize, Surface)> = None;
        for (number, piece) in tool.pieces.iter().enumerate().rev() {
            let until = met.map_or(f64::INFINITY, |(when, ..)| when);
            if let Some((when, surface)) = piece.entry(&one.axis, &start, &-u, until) {
                met = Some((when, number, surface));
            }
        }
        let (when, number, surface) = met?;
        let y = start - u * when;
        let n = match surface {
            Surface::Side => tool.pieces[number].normal(&y, &one.axis).normalize(),
            Surface::Bottom => -one.axis,
            Surface::Top => one.axis,
        };
        let volume = volume * n[axis] * n[axis];
        if volume == 0.0 {
            return None;
        }
        let height = y.dot(&one.axis);
        let across = y - one.axis * height;
        let square = across.norm_squared();
        let radius = square.sqrt();
        let mean_radius = (square + self.tip).sqrt();
        let outward = if radius > 1e-12 { across / radius } else { Vector3::zeros() };
        let t = outward.cross(&one.axis) * tool.clockwise;
        let s = t.cross(&n) * tool.clockwise;
        let k = &self.coefficients;
        let per = volume / (TAU * mean_radius);
        let speed = n.dot(&u) * self.per_length;
        let of = |force: Vector3<f64>| Wrench { force, moment: y.cross(&force) };
        let chip = of((n * -k.radial - t * k.tangential + s * k.axial) * (per * one.feed_per_turn));
        let edge = of((n * -k.radial_edge - t * k.tangential_edge) * (per * self.teeth / speed.max(1e-6)));
        let thickest = one.feed_per_turn / self.teeth * speed;
        let along_edge = match surface {
            Surface::Side => tool.starts[number] + tool.pieces[number].along(height, radius),
            Surface::Bottom | Surface::Top => radius,
        };
        Some(Bit {
            when,
            sums: Sums { volume, chip, edge, heights: [height; 2], thickest },
            height,
            radius,
            mean_radius,
            along_edge,
            speed,
            outward,
            is_below: n.dot(&one.axis) < -0.5,
        })
    }
}

/// Directions normal to the axis: of the feed, and left of it.
fn across(one: &Move) -> [Vector3<f64>; 2] {
    let ahead = one.by - one.axis * one.by.dot(&one.axis);
    let any = || {
        let mut direction = Vector3::zeros();
        direction[one.axis.iamin()] = 1.0;
        (direction - one.axis * direction.dot(&one.axis)).normalize()
    };
    let is_across = ahead.norm() > 1e-6 * one.by.norm();
    let ahead = if is_across { ahead.normalize() } else { any() };
    [ahead, one.axis.cross(&ahead)]
}
