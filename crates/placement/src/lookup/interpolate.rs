//! Looking into a table: the scores of one path point at one placement, over a grid of beta, in one posture class.
//!
//! Cubic interpolation in all three directions. Heights first, and kept for as long as the height stays, since most paths are
//! level; then radii and fields together into one row over the heading, since a score is linear in the fields; then the heading.

use super::shape::cubic;
use super::{BetaGrid, LookupTable, sample::field};
use crate::problem::{Problem, base_from_workpiece};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};
use stead_model::robot::turns::Range;

/// A path point as a look needs it, in the workpiece frame.
#[derive(Debug, Clone)]
pub(super) struct WorkpiecePoint {
    position: Vector3<f64>,
    /// Across the tool axis.
    feed: Vector3<f64>,
    normal: Vector3<f64>,
    force: Vector3<f64>,
    /// What the score counts of |K^-1 n|. N
    uncertainty: f64,
}

/// The path points of a problem.
pub(super) fn points(problem: &Problem) -> Vec<WorkpiecePoint> {
    let points = problem.task.points().iter().zip(problem.task.wrenches());
    points
        .map(|(point, wrench)| {
            let axes = point.workpiece_from_point();
            WorkpiecePoint {
                position: point.position,
                feed: axes.column(0).into_owned(),
                normal: axes.column(1).into_owned(),
                force: wrench.force,
                uncertainty: problem.criterion.force_uncertainty * wrench.force.norm(),
            }
        })
        .collect()
}

/// A placement, ready for its points.
pub(super) struct PlacedPath {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

/// A path point at a placement.
pub(super) struct PolarPoint {
    radius: (usize, [f32; 4]),
    height: f64,
    azimuth: f64,
    /// Heading at beta zero against the azimuth, in the sense of beta. rad
    heading: f64,
    /// Radius, and its square times the compliance of joint 1.
    first: f64,
    /// Wall normal and force: radial, tangential, up.
    normal: Vector3<f64>,
    force: Vector3<f64>,
    uncertainty: f64,
}

/// Rows of one thread.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    /// Rows at one height: radius, class, all fields.
    slab: Vec<f32>,
    known: Vec<Known>,
    height: f64,
    /// Over the heading, cyclic: normal part, room, then K^-1 n (3), then sine and cosine of joint 1.
    rows: [Vec<f32>; 7],
    unrolled: Vec<f32>,
    /// The same over beta.
    looked: [Vec<f32>; 7],
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    No,
    Empty,
    Filled,
}

impl Rows {
    pub fn new(table: &LookupTable<'_>, grid: &BetaGrid) -> Self {
        let shape = &table.shape;
        let rows = shape.radius.count * 4;
        Self {
            slab: vec![0.0; rows * shape.block()],
            known: vec![Known::No; rows],
            height: f64::NAN,
            rows: std::array::from_fn(|_| vec![0.0; shape.headings]),
            unrolled: vec![0.0; 2 * shape.headings + 4],
            looked: std::array::from_fn(|_| vec![0.0; grid.count]),
        }
    }
}

impl LookupTable<'_> {
    pub(super) fn place(&self, pose: &[f64; 4]) -> PlacedPath {
        let base_from_workpiece = base_from_workpiece(pose);
        let root = self.problem.robot.geometry().root_in_base;
        PlacedPath {
            rotation: self.root_from_base * base_from_workpiece.rotation,
            translation: self.root_from_base * (base_from_workpiece.translation - root),
        }
    }

    /// Where a path point is at a placement; `None` beyond the table, where the arm does not get.
    pub(super) fn polar_point(&self, placed: &PlacedPath, point: usize) -> Option<PolarPoint> {
        let known = &self.points[point];
        let tip = placed.rotation * known.position + placed.translation;
        let radius = libm::hypot(tip.x, tip.y);
        let (cosine, sine) = if radius > 0.0 { (tip.x / radius, tip.y / radius) } else { (1.0, 0.0) };
        let components = |v: &Vector3<f64>| {
            let v = placed.rotation * v;
            Vector3::new(v.x * cosine + v.y * sine, v.y * cosine - v.x * sine, v.z)
        };
        let feed = components(&known.feed);
        Some(PolarPoint {
            radius: self.shape.radius.stencil(radius)?,
            height: tip.z,
            azimuth: if self.shape.has_first_joint { libm::atan2(sine, cosine) } else { 0.0 },
            heading: self.sense * libm::atan2(feed.y, feed.x),
            first: radius * radius * self.first_compliance,
            normal: components(&known.normal),
            force: components(&known.force),
            uncertainty: known.uncertainty,
        })
    }

    /// The scores (m; infinite where not allowed) of a polar in one posture class over a grid of beta. False when none is
    /// allowed for certain; true says nothing.
    pub(super) fn interpolate(
        &self,
        polar: &PolarPoint,
        class: usize,
        grid: &BetaGrid,
        rows: &mut Rows,
        scores: &mut [f32],
    ) -> bool {
        if !self.blend(polar, class, rows) {
            return false;
        }
        let robust = polar.uncertainty > 0.0;
        let joint = self.shape.has_first_joint;
        for (k, wanted) in [true, true, robust, robust, robust, joint, joint].into_iter().enumerate() {
            if wanted {
                self.along_beta(polar, grid, &rows.rows[k], &mut rows.unrolled, &mut rows.looked[k]);
            }
        }
        let count = scores.len();
        let [part, room, radial, tangential, vertical, sine, cosine] = rows.looked.each_ref().map(|row| &row[..count]);
        for k in 0..count {
            scores[k] = if room[k] >= 0.0 { part[k].abs() } else { f32::INFINITY };
        }
        if robust {
            let uncertainty = polar.uncertainty as f32;
            for k in 0..count {
                let squares = radial[k] * radial[k] + tangential[k] * tangential[k] + vertical[k] * vertical[k];
                scores[k] += squares.sqrt() * uncertainty;
            }
        }
        if joint {
            let range = Range::of(&self.problem.robot.joints()[0]);
            for (k, score) in scores.iter_mut().enumerate().filter(|(_, score)| score.is_finite()) {
                let angle = polar.azimuth + libm::atan2(f64::from(sine[k]), f64::from(cosine[k]));
                if range.nearest(angle).1 > 0.0 {
                    *score = f32::INFINITY;
                }
            }
        }
        if let Some(limit) = self.problem.constraints.max_deflection {
            let limit = limit as f32;
            scores.iter_mut().filter(|score| **score > limit).for_each(|score| *score = f32::INFINITY);
        }
        true
    }

    /// The rows of a polar over the heading, from the rows of its four radii; false when all of them are dead.
    fn blend(&self, polar: &PolarPoint, class: usize, rows: &mut Rows) -> bool {
        let shape = &self.shape;
        let Some(height) = shape.height.stencil(polar.height) else { return false };
        if rows.height.to_bits() != polar.height.to_bits() {
            rows.known.fill(Known::No);
            rows.height = polar.height;
        }
        let mut any = false;
        for radius in polar.radius.0..polar.radius.0 + 4 {
            if rows.known[radius * 4 + class] == Known::No {
                self.level(radius, class, height, rows);
            }
            any |= rows.known[radius * 4 + class] == Known::Filled;
        }
        if !any {
            return false;
        }
        let (n, f) = (&polar.normal, &polar.force);
        let in_plane = [n.x * f.x + n.y * f.y, n.x * f.x - n.y * f.y, n.x * f.y + n.y * f.x];
        self.combine(polar, class, rows, 0, polar.first * n.y * f.y, in_plane, [f.z * n.x, f.z * n.y]);
        self.single(polar, class, rows, 1, field::ROOM);
        if polar.uncertainty > 0.0 {
            self.combine(polar, class, rows, 2, 0.0, [n.x, n.x, n.y], [0.0; 2]);
            self.combine(polar, class, rows, 3, polar.first * n.y, [n.y, -n.y, n.x], [0.0; 2]);
            self.combine(polar, class, rows, 4, 0.0, [0.0; 3], [n.x, n.y]);
        }
        if shape.has_first_joint {
            self.single(polar, class, rows, 5, shape.first_joint());
            self.single(polar, class, rows, 6, shape.first_joint() + 1);
        }
        true
    }

    /// The rows of one radius and class at a height.
    fn level(&self, radius: usize, class: usize, (first, weights): (usize, [f32; 4]), rows: &mut Rows) {
        let (radii, block) = (self.shape.radius.count, self.shape.block());
        let index = |height: usize| (height * radii + radius) * 4 + class;
        let slot = radius * 4 + class;
        rows.known[slot] =
            if (first..first + 4).any(|height| self.alive[index(height)]) { Known::Filled } else { Known::Empty };
        let taps = [0, 1, 2, 3].map(|k| &self.data[index(first + k) * block..][..block]);
        let out = &mut rows.slab[slot * block..][..block];
        let [a, b, c, d] = taps;
        for k in 0..block {
            out[k] = a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2] + d[k] * weights[3];
        }
    }

    /// `constant` and a linear combination of the in-plane fields, and the vertical ones where there are any, into a row.
    #[expect(clippy::too_many_arguments, reason = "one step of the caller above, with all it has")]
    fn combine(
        &self,
        polar: &PolarPoint,
        class: usize,
        rows: &mut Rows,
        row: usize,
        constant: f64,
        in_plane: [f64; 3],
        vertical: [f64; 2],
    ) {
        let (block, headings) = (self.shape.block(), self.shape.headings);
        let out = &mut rows.rows[row][..headings];
        out.fill(constant as f32);
        for (k, weight) in polar.radius.1.into_iter().enumerate() {
            let values = &rows.slab[((polar.radius.0 + k) * 4 + class) * block..][..block];
            let [a, b, c] = in_plane.map(|factor| factor as f32 * weight);
            let fields = &values[..3 * headings];
            let (m, fields) = fields.split_at(headings);
            let (d1, d2) = fields.split_at(headings);
            for k in 0..headings {
                out[k] += m[k] * a + d1[k] * b + d2[k] * c;
            }
            if self.shape.has_vertical {
                let [a, b] = vertical.map(|factor| factor as f32 * weight);
                let fields = &values[field::VERTICAL * headings..][..2 * headings];
                let (rz, tz) = fields.split_at(headings);
                for k in 0..headings {
                    out[k] += rz[k] * a + tz[k] * b;
                }
            }
        }
    }

    /// One field into a row.
    fn single(&self, polar: &PolarPoint, class: usize, rows: &mut Rows, row: usize, field: usize) {
        let (block, headings) = (self.shape.block(), self.shape.headings);
        let out = &mut rows.rows[row][..headings];
        let taps = [0, 1, 2, 3]
            .map(|k| &rows.slab[((polar.radius.0 + k) * 4 + class) * block + field * headings..][..headings]);
        let [a, b, c, d] = taps;
        let w = polar.radius.1;
        for k in 0..headings {
            out[k] = a[k] * w[0] + b[k] * w[1] + c[k] * w[2] + d[k] * w[3];
        }
    }

    /// A row over the heading, interpolated to a grid of beta.
    fn along_beta(&self, polar: &PolarPoint, grid: &BetaGrid, row: &[f32], unrolled: &mut [f32], out: &mut [f32]) {
        let headings = self.shape.headings;
        let common = gcd(headings, grid.count);
        // Every `phases` values of beta the place between two headings is the same again, `stride` headings farther.
        let (phases, stride) = (grid.count / common, headings / common);
        let start = (polar.heading - PI).rem_euclid(TAU) / self.shape.heading_step();
        for phase in 0..phases {
            let place = start + (phase * headings) as f64 / grid.count as f64;
            let first = place as usize;
            let [a, b, c, d] = cubic(place - first as f64);
            // From the node before the place on, once around and three more.
            let first = (first + headings - 1) % headings;
            let (head, tail) = unrolled[..headings + 3].split_at_mut(headings - first);
            head.copy_from_slice(&row[first..]);
            tail[..first].copy_from_slice(&row[..first]);
            let ends: [f32; 3] = [0, 1, 2].map(|k| row[(first + k) % headings]);
            tail[first..].copy_from_slice(&ends);
            let values = &unrolled[..headings + 3];
            if phases == 1 && stride == 1 {
                let out = &mut out[..headings];
                for k in 0..headings {
                    out[k] = values[k] * a + values[k + 1] * b + values[k + 2] * c + values[k + 3] * d;
                }
            } else {
                for k in 0..common {
                    let at = k * stride;
                    out[phase + k * phases] =
                        values[at] * a + values[at + 1] * b + values[at + 2] * c + values[at + 3] * d;
                }
            }
        }
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
