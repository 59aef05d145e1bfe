//! The outer shape of a cutter, as convex pieces about its axis.

use crate::piece::Piece;

/// An end mill by its outer shape: flat, bull nose, ball or tapered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Radius: of a tapered cutter that of the ends of its corner at the tip, as of a ball its own. m
    pub radius: f64,
    /// Radius of the corner: 0 of a flat cutter, the radius itself of a ball. m
    pub corner: f64,
    /// Half the angle of the taper. rad
    pub taper: f64,
    /// Length of the flutes. m
    pub length: f64,
}

/// Cones that stand for the corner of a cutter that is cut off.
const CORNER_CONES: usize = 12;

impl Profile {
    /// This cutter, smaller by a layer (m) all over.
    pub fn smaller(&self, layer: f64) -> Self {
        Self { radius: self.radius - layer, corner: (self.corner - layer).max(0.0), ..*self }
    }

    /// Its pieces up to a height (m), the corner as cones between points of it.
    pub fn below(&self, height: f64) -> Vec<Piece> {
        let Self { radius, corner, taper, .. } = *self;
        let (sine, cosine) = libm::sincos(taper);
        let centre = radius - corner;
        let side = [corner * (1.0 - sine), centre + corner * cosine];
        let top = height.min(side[0]);
        let at = |share: f64| {
            let up = top * share * share;
            [up, centre + (corner * corner - (corner - up) * (corner - up)).max(0.0).sqrt()]
        };
        let ends: Vec<[f64; 2]> = (0..=CORNER_CONES).map(|k| at(k as f64 / CORNER_CONES as f64)).collect();
        let cones = ends.windows(2).filter(|pair| pair[1][0] > pair[0][0] + 1e-12);
        let mut pieces: Vec<Piece> =
            cones.map(|pair| Piece::cone([pair[0][0], pair[1][0]], [pair[0][1], pair[1][1]])).collect();
        if height > side[0] + 1e-12 {
            pieces.push(Piece::cone([side[0], height], [side[1], side[1] + (height - side[0]) * sine / cosine]));
        }
        pieces
    }

    /// Its pieces, from below; together they are convex.
    pub fn pieces(&self) -> Vec<Piece> {
        let Self { radius, corner, taper, length } = *self;
        let (sine, cosine) = libm::sincos(taper);
        // The centre of the corner is at this radius and the height of the corner.
        let centre = radius - corner;
        let [side_height, side_radius] = [corner * (1.0 - sine), centre + corner * cosine];
        let mut pieces = Vec::new();
        if corner > 0.0 {
            pieces.push(Piece::corner(if centre <= 1e-9 { 0.0 } else { centre }, corner, taper));
        }
        let top = side_radius + (length - side_height) * sine / cosine;
        pieces.push(Piece::cone([side_height, length], [side_radius, top]));
        pieces
    }
}
