//! Interpolating the table: the scores of one path point at one placement, over a grid of beta, in one posture class.
//!
//! Cubic interpolation in all three directions. Heights first, and kept for as long as the height stays, since most
//! paths are level; then radii and fields together into one row over the heading, since a score is linear in the
//! fields; then the heading.

use super::polar::PolarPoint;
use super::{BetaGrid, LookupTable};
use std::f64::consts::{PI, TAU};
use stead_model::robot::turns::Range;
use stead_problem::table_shape::{Shape, cubic, field};

/// What scores are made of, over the headings of the table or over a grid of beta.
#[derive(Debug, Clone)]
struct Rows {
    /// n . K^-1 f. m
    normal_part: Vec<f32>,
    /// Room left to the nearest limit, below zero where it is passed.
    room: Vec<f32>,
    /// K^-1 n where scores cover force errors: radial, tangential, up. m/N
    response: [Vec<f32>; 3],
    /// Sine and cosine of joint 1 against the azimuth, where its limits matter.
    first_joint: [Vec<f32>; 2],
}

impl Rows {
    fn new(count: usize) -> Self {
        let row = || vec![0.0; count];
        let (response, first_joint) = (std::array::from_fn(|_| row()), std::array::from_fn(|_| row()));
        Self { normal_part: row(), room: row(), response, first_joint }
    }
}

/// Scratch space of one thread.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    /// The height that `slab` is for. m
    height: f64,
    /// All fields at that height, for each radius and class.
    slab: Vec<f32>,
    filled: Vec<Filled>,
    /// Cyclic.
    over_heading: Rows,
    unrolled: Vec<f32>,
    over_beta: Rows,
}

/// Whether a radius and class of the slab is there, and has an allowed state.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Filled {
    NotYet,
    Infeasible,
    Feasible,
}

impl Scratch {
    pub fn new(shape: &Shape, grid: &BetaGrid) -> Self {
        let rows = shape.radius.count * 4;
        Self {
            height: f64::NAN,
            slab: vec![0.0; rows * shape.block()],
            filled: vec![Filled::NotYet; rows],
            over_heading: Rows::new(shape.headings),
            unrolled: vec![0.0; 2 * shape.headings + 4],
            over_beta: Rows::new(grid.count),
        }
    }
}

/// The fields at the four radii around a point, in one class, and the weights of these radii.
struct Radii<'a> {
    blocks: [&'a [f32]; 4],
    weights: [f32; 4],
}

/// A constant and factors of the fields: m, d1, d2, and c_rz, c_tz where there is a vertical part, and g where a moment
/// acts.
struct Combination {
    constant: f64,
    in_plane: [f64; 3],
    vertical: [f64; 2],
    moment: Option<[f64; field::MOMENT]>,
}

impl LookupTable<'_> {
    /// The scores (m; infinite where not allowed) of a point in one posture class over a grid of beta. False when none
    /// is allowed for certain; true says nothing.
    pub(super) fn interpolate(
        &self,
        point: &PolarPoint,
        class: usize,
        grid: &BetaGrid,
        scratch: &mut Scratch,
        scores: &mut [f32],
    ) -> bool {
        if !self.fill_slab(point, class, scratch) {
            return false;
        }
        let is_robust = point.uncertainty > 0.0;
        self.along_heading(point, class, scratch);
        let Scratch { over_heading: from, unrolled, over_beta: to, .. } = scratch;
        let mut along = |from: &[f32], to: &mut [f32]| self.along_beta(point, grid, from, unrolled, to);
        along(&from.normal_part, &mut to.normal_part);
        along(&from.room, &mut to.room);
        if is_robust {
            (0..3).for_each(|k| along(&from.response[k], &mut to.response[k]));
        }
        if self.shape.parts.first_joint {
            (0..2).for_each(|k| along(&from.first_joint[k], &mut to.first_joint[k]));
        }
        let count = scores.len();
        let (part, room) = (&to.normal_part[..count], &to.room[..count]);
        for k in 0..count {
            scores[k] = if room[k] >= 0.0 { part[k].abs() } else { f32::INFINITY };
        }
        if is_robust {
            let uncertainty = point.uncertainty as f32;
            let [radial, tangential, up] = to.response.each_ref().map(|row| &row[..count]);
            for k in 0..count {
                let squares = radial[k] * radial[k] + tangential[k] * tangential[k] + up[k] * up[k];
                scores[k] += squares.sqrt() * uncertainty;
            }
        }
        if self.shape.parts.first_joint {
            self.exclude_first_joint(point, &to.first_joint, scores);
        }
        if let Some(limit) = self.problem.constraints.max_deflection {
            let limit = limit as f32;
            scores.iter_mut().filter(|score| **score > limit).for_each(|score| *score = f32::INFINITY);
        }
        true
    }

    /// Makes scores infinite where joint 1 is outside its limits.
    fn exclude_first_joint(&self, point: &PolarPoint, first_joint: &[Vec<f32>; 2], scores: &mut [f32]) {
        let [sine, cosine] = first_joint;
        let range = Range::of(&self.problem.robot.joints()[0]);
        for (k, score) in scores.iter_mut().enumerate().filter(|(_, score)| score.is_finite()) {
            let angle = point.azimuth + libm::atan2(f64::from(sine[k]), f64::from(cosine[k]));
            if range.nearest(angle).1 > 0.0 {
                *score = f32::INFINITY;
            }
        }
    }

    /// Makes sure that the slab has the four radii around a point, at its height; false when none has an allowed state.
    fn fill_slab(&self, point: &PolarPoint, class: usize, scratch: &mut Scratch) -> bool {
        let Some(height) = self.shape.height.stencil(point.height) else { return false };
        if scratch.height.to_bits() != point.height.to_bits() {
            scratch.filled.fill(Filled::NotYet);
            scratch.height = point.height;
        }
        let mut any = false;
        for radius in point.radius.0..point.radius.0 + 4 {
            if scratch.filled[radius * 4 + class] == Filled::NotYet {
                self.fill(radius, class, height.0, height.1, scratch);
            }
            any |= scratch.filled[radius * 4 + class] == Filled::Feasible;
        }
        any
    }

    /// The fields of one radius and class at a height, into the slab.
    fn fill(&self, radius: usize, class: usize, first: usize, weights: [f32; 4], scratch: &mut Scratch) {
        let (radii, block) = (self.shape.radius.count, self.shape.block());
        let index = |height: usize| (height * radii + radius) * 4 + class;
        let slot = radius * 4 + class;
        let is_feasible = (first..first + 4).any(|height| self.alive[index(height)]);
        scratch.filled[slot] = if is_feasible { Filled::Feasible } else { Filled::Infeasible };
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| &self.data[index(first + k) * block..][..block]);
        let out = &mut scratch.slab[slot * block..][..block];
        for k in 0..block {
            out[k] = a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2] + d[k] * weights[3];
        }
    }

    /// The rows of a point over the heading.
    fn along_heading(&self, point: &PolarPoint, class: usize, scratch: &mut Scratch) {
        let (shape, block) = (&self.shape, self.shape.block());
        let Scratch { slab, over_heading: rows, .. } = scratch;
        let (first, weights) = point.radius;
        let radii =
            Radii { blocks: [0, 1, 2, 3].map(|k| &slab[((first + k) * 4 + class) * block..][..block]), weights };
        let (n, f, joint1) = (&point.normal, &point.force, point.first_compliance);
        let t = &point.moment;
        let moment = shape.parts.moment.then(|| [n.x * t.x, n.x * t.y, n.x * t.z, n.y * t.x, n.y * t.y, n.y * t.z]);
        let deflection = Combination {
            constant: joint1 * n.y * f.y + point.first_moment_compliance * n.y * t.z + point.beside,
            in_plane: [n.x * f.x + n.y * f.y, n.x * f.x - n.y * f.y, n.x * f.y + n.y * f.x],
            vertical: [f.z * n.x, f.z * n.y],
            moment,
        };
        self.combine(&radii, &deflection, &mut rows.normal_part);
        self.field(&radii, field::ROOM, &mut rows.room);
        if point.uncertainty > 0.0 {
            let beside = &point.beside_response;
            let response = [
                Combination { constant: beside.x, in_plane: [n.x, n.x, n.y], vertical: [0.0; 2], moment: None },
                Combination {
                    constant: joint1 * n.y + beside.y,
                    in_plane: [n.y, -n.y, n.x],
                    vertical: [0.0; 2],
                    moment: None,
                },
                Combination { constant: beside.z, in_plane: [0.0; 3], vertical: [n.x, n.y], moment: None },
            ];
            response
                .iter()
                .zip(&mut rows.response)
                .for_each(|(combination, row)| self.combine(&radii, combination, row));
        }
        if shape.parts.first_joint {
            (0..2).for_each(|k| self.field(&radii, shape.first_joint() + k, &mut rows.first_joint[k]));
        }
    }

    /// A linear combination of the fields into a row over the heading.
    fn combine(&self, radii: &Radii<'_>, combination: &Combination, row: &mut [f32]) {
        let headings = self.shape.headings;
        let out = &mut row[..headings];
        out.fill(combination.constant as f32);
        for (values, weight) in radii.blocks.into_iter().zip(radii.weights) {
            let [a, b, c] = combination.in_plane.map(|factor| factor as f32 * weight);
            let (m, fields) = values[..3 * headings].split_at(headings);
            let (d1, d2) = fields.split_at(headings);
            for k in 0..headings {
                out[k] += m[k] * a + d1[k] * b + d2[k] * c;
            }
            if self.shape.parts.vertical {
                let [a, b] = combination.vertical.map(|factor| factor as f32 * weight);
                let (rz, tz) = values[field::VERTICAL * headings..][..2 * headings].split_at(headings);
                for k in 0..headings {
                    out[k] += rz[k] * a + tz[k] * b;
                }
            }
            if let Some(moment) = combination.moment {
                let [a, b, c, d, e, f] = moment.map(|factor| factor as f32 * weight);
                let fields = &values[self.shape.moment() * headings..][..field::MOMENT * headings];
                let [rr, rt, rz, tr, tt, tz] = std::array::from_fn(|k| &fields[k * headings..][..headings]);
                for k in 0..headings {
                    out[k] += rr[k] * a + rt[k] * b + rz[k] * c + tr[k] * d + tt[k] * e + tz[k] * f;
                }
            }
        }
    }

    /// One field into a row over the heading.
    fn field(&self, radii: &Radii<'_>, field: usize, row: &mut [f32]) {
        let headings = self.shape.headings;
        let out = &mut row[..headings];
        let [a, b, c, d] = radii.blocks.map(|block| &block[field * headings..][..headings]);
        let w = radii.weights;
        for k in 0..headings {
            out[k] = a[k] * w[0] + b[k] * w[1] + c[k] * w[2] + d[k] * w[3];
        }
    }

    /// A row over the heading, interpolated to a grid of beta.
    fn along_beta(&self, point: &PolarPoint, grid: &BetaGrid, row: &[f32], unrolled: &mut [f32], out: &mut [f32]) {
        let headings = self.shape.headings;
        let common = gcd(headings, grid.count);
        // Every `phases` values of beta the place between two headings is the same again, `stride` headings farther.
        let (phases, stride) = (grid.count / common, headings / common);
        let start = (point.heading - PI).rem_euclid(TAU) / self.shape.heading_step();
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
