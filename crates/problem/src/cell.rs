//! Where the workpiece may stand.

use super::placement::Placement;
use std::f64::consts::TAU;
use stead_model::robot::angles::wrap;
use stead_numerics::digits::figures;

/// A closed interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
}

impl Interval {
    /// The nearest value inside.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.min).min(self.max)
    }

    /// Whether the value is inside, ends included.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.min && value <= self.max
    }

    /// Upper end less lower end.
    pub fn width(&self) -> f64 {
        self.max - self.min
    }
}

/// Where the workpiece origin may stand, in the robot base frame (Caro 2013, eq. 6 and 23-25).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Bounds of x, y and z. m
    pub position: [Interval; 3],
    /// Bounds of the yaw. rad
    pub yaw: Interval,
}

/// A cell that is smaller than this in every direction, and leaves room all the same, looks wrong. m
const SMALLEST_CELL: f64 = 5e-3;

impl Cell {
    /// That the cell is so small that its ends look like another unit. A cell that leaves no room is one place, as
    /// requested.
    pub(crate) fn note(&self) -> Option<String> {
        let widest = self.position.iter().map(Interval::width).fold(0.0, f64::max);
        (widest > 0.0 && widest < SMALLEST_CELL).then(|| {
            format!("the cell is no wider than {} mm in any direction: are its ends in mm?", figures(widest * 1e3))
        })
    }

    /// Whether every yaw is allowed, so that the yaw has no ends.
    pub fn is_yaw_free(&self) -> bool {
        self.yaw.width() >= TAU - 1e-9
    }

    /// A cell that leaves one placement.
    pub fn at(placement: &Placement) -> Self {
        let only = |value: f64| Interval { min: value, max: value };
        let Placement { x, y, z, yaw } = *placement;
        Self { position: [only(x), only(y), only(z)], yaw: only(yaw) }
    }

    /// The only placement in the cell, where its bounds leave no other.
    pub fn pinned(&self) -> Option<Placement> {
        let [x, y, z] = self.position;
        let is_pinned = [x, y, z, self.yaw].iter().all(|bounds| bounds.width() == 0.0);
        is_pinned.then_some(Placement { x: x.min, y: y.min, z: z.min, yaw: self.yaw.min })
    }

    /// The nearest placement inside the cell.
    pub fn clamp(&self, placement: &Placement) -> Placement {
        let [x, y, z] = self.position;
        let yaw = wrap(placement.yaw);
        let yaw = if self.is_yaw_free() { yaw } else { self.yaw.clamp(self.turned_to(yaw)) };
        Placement { x: x.clamp(placement.x), y: y.clamp(placement.y), z: z.clamp(placement.z), yaw }
    }

    /// The placement at a share of the way from one placement to another, the yaw turned the short way, inside the
    /// cell.
    pub fn between(&self, from: &Placement, to: &Placement, share: f64) -> Placement {
        let along = |k: usize| from[k] + share * (to[k] - from[k]);
        let yaw = from.yaw + share * wrap(to.yaw - from.yaw);
        self.clamp(&Placement { x: along(0), y: along(1), z: along(2), yaw })
    }

    /// The bounds of x, y, z and yaw with where a placement is in them; a yaw that is free is at an end.
    fn coordinates(&self, placement: &Placement) -> [(Interval, f64); 4] {
        let [x, y, z] = self.position;
        let yaw = if self.is_yaw_free() { self.yaw.min } else { self.turned_to(wrap(placement.yaw)) };
        [(x, placement.x), (y, placement.y), (z, placement.z), (self.yaw, yaw)]
    }

    /// Whether a placement is inside the cell.
    pub fn contains(&self, placement: &Placement) -> bool {
        self.coordinates(placement).iter().all(|(bounds, value)| bounds.contains(*value))
    }

    /// By how much a placement is outside the cell and in which coordinates, in words; nothing for one inside.
    pub fn excess(&self, placement: &Placement) -> Option<String> {
        let units = [("x", "mm", 1e3), ("y", "mm", 1e3), ("z", "mm", 1e3), ("yaw", "deg", 1f64.to_degrees())];
        let outside = |((bounds, value), (name, unit, per_si)): ((Interval, f64), (&str, &str, f64))| {
            let end = bounds.clamp(value);
            let by = (value - end).abs();
            (by > 0.0).then(|| format!("{name} by {} {unit} beyond {}", figures(by * per_si), figures(end * per_si)))
        };
        let words: Vec<String> = self.coordinates(placement).into_iter().zip(units).filter_map(outside).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }

    /// The same yaw, within half a turn of the middle of the bounds.
    fn turned_to(&self, yaw: f64) -> f64 {
        let middle = (self.yaw.min + self.yaw.max) / 2.0;
        middle + wrap(yaw - middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn yaw_bounds_are_read_modulo_a_turn() {
        let wide = Interval { min: -1.0, max: 1.0 };
        let cell = Cell { position: [wide; 3], yaw: Interval { min: 2.0, max: 4.0 } };
        let at = |yaw: f64| Placement { x: 0.0, y: 0.0, z: 0.0, yaw };
        assert!(cell.contains(&at(3.9 - TAU)) && !cell.contains(&at(0.0)));
        assert_eq!(cell.excess(&at(3.9 - TAU)), None);
        let far = Placement { x: -1.0302, y: 1.5, z: 0.0, yaw: 1.9 };
        let words = "x by 30.2 mm beyond -1000, y by 500 mm beyond 1000, yaw by 5.73 deg beyond 115";
        assert_eq!(cell.excess(&far).as_deref(), Some(words));
        assert!((cell.clamp(&at(-2.0)).yaw - 4.0).abs() < 1e-12);
        let free = Cell { yaw: Interval { min: -PI, max: PI }, ..cell };
        assert!(free.is_yaw_free() && free.contains(&at(9.0)));
        assert_eq!(free.clamp(&at(0.5)), at(0.5));
    }
}
