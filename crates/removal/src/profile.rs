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

/// Cones that the corner of a bull nose is made of.
const CORNER_CONES: usize = 8;

impl Profile {
    /// Its pieces, from below; together they are convex.
    pub fn pieces(&self) -> Vec<Piece> {
        let Self { radius, corner, taper, length } = *self;
        let (sine, cosine) = libm::sincos(taper);
        // The centre of the corner is at this radius and the height of the corner.
        let centre = radius - corner;
        let [side_height, side_radius] = [corner * (1.0 - sine), centre + corner * cosine];
        let mut pieces = Vec::new();
        if corner > 0.0 && centre <= 1e-9 {
            pieces.push(Piece::ball(corner, corner));
        } else if corner > 0.0 {
            // Chords of an arc as long as the arc in area: their corners lie a little outside.
            let step = (std::f64::consts::FRAC_PI_2 - taper) / CORNER_CONES as f64;
            let outer = corner / (1.0 - step * step / 12.0);
            let at = |k: usize| {
                let (s, c) = libm::sincos(step * k as f64);
                let r = if k == 0 || k == CORNER_CONES { corner } else { outer };
                [corner - r * c, centre + r * s]
            };
            for k in 0..CORNER_CONES {
                let [[h0, r0], [h1, r1]] = [at(k), at(k + 1)];
                if h1 > h0 + 1e-12 {
                    pieces.push(Piece::cone([h0, h1], [r0, r1]));
                }
            }
        }
        let top = side_radius + (length - side_height) * sine / cosine;
        pieces.push(Piece::cone([side_height, length], [side_radius, top]));
        pieces
    }
}
