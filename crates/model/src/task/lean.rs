//! A tool that leans about what it touches.
//!
//! Lead L turns the tool axis of the path in the direction of travel, tilt T across it. With the axis a, the feed f
//! made normal to it and `b = a x f`, the left of the feed:
//!
//! ```text
//! A = cos T (cos L a + sin L f) + sin T b        cos(lean) = cos L cos T
//! ```
//!
//! Lead above 0 has the spindle ahead of the tip, tilt above 0 to the left of the feed. Both count from the axis that
//! the path states, whatever the surface. Lead is applied first, then tilt about the leaned feed; others turn by tilt
//! about the feed as it was, which is the same to first order only.
//!
//! With R the radius of the cutter, r that of its corner, n the normal of the surface, pointing out of the part, and
//! `e(n, A) = unit(n - (n . A) A)`, a tool with its tip in P touches the surface in
//! `C = P + r A - (R - r) e(n, A) - r n`. What stays where it is when the tool leans is a [`ContactRule`].

use super::PathPoint;
use nalgebra::Vector3;
use serde::Serialize;

/// Nearer to the normal of the surface than this the contact of a flat or bull cutter is a disc and no point. rad
const NEAREST_TO_NORMAL: f64 = 1.0 / 180.0 * std::f64::consts::PI;
/// Farther from the normal than this the side of the cutter touches. rad
const FARTHEST_FROM_NORMAL: f64 = 89.0 / 180.0 * std::f64::consts::PI;
/// Radii that differ by less are one. m
const SAME_RADIUS: f64 = 1e-9;

/// How far the tool leans from the axis that the path states.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Lean {
    /// In the direction of travel, above 0 with the spindle ahead of the tip. rad
    pub lead: f64,
    /// Across it, above 0 with the spindle to the left of the feed. rad
    pub tilt: f64,
}

impl Lean {
    /// None.
    pub const NONE: Self = Self { lead: 0.0, tilt: 0.0 };

    /// The tool axis that leans so at a point.
    pub fn axis(&self, point: &PathPoint) -> Vector3<f64> {
        let frame = point.workpiece_from_point();
        let (lead, tilt) = (libm::sincos(self.lead), libm::sincos(self.tilt));
        let ahead = frame.column(2) * lead.1 + frame.column(0) * lead.0;
        (ahead * tilt.1 + frame.column(1) * tilt.0).normalize()
    }

    /// Angle between the axis that leans and that of the path. rad
    pub fn angle(&self) -> f64 {
        let (lead, tilt) = (libm::sin(self.lead / 2.0), libm::sin(self.tilt / 2.0));
        // 1 - cos L cos T = 2 sin^2(L/2) + cos L 2 sin^2(T/2), exact for small angles too.
        let versine = 2.0 * (lead * lead + libm::cos(self.lead) * tilt * tilt);
        2.0 * libm::asin((versine / 2.0).max(0.0).sqrt().min(1.0))
    }
}

/// The cutting end of a milling cutter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CutterEnd {
    /// Radius of the cutter. m
    pub radius: f64,
    /// Radius of its corner: that of the cutter for a ball, 0 for a flat end. m
    pub corner: f64,
}

impl CutterEnd {
    /// Whether it is a ball.
    pub fn is_ball(&self) -> bool {
        self.radius - self.corner <= SAME_RADIUS
    }

    /// Whether it is flat.
    pub fn is_flat(&self) -> bool {
        self.corner <= SAME_RADIUS
    }

    /// Radius of the circle of the corner's centres. m
    fn inner(&self) -> f64 {
        if self.is_ball() { 0.0 } else { self.radius - self.corner }
    }

    /// Where the end with its tip at a point and this axis touches a surface with this normal; none where it touches
    /// with a disc. m
    pub fn contact(&self, tip: &Vector3<f64>, axis: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
        let centre = tip + axis * self.corner - normal * self.corner;
        if self.is_ball() {
            return Some(centre);
        }
        Some(centre - across(normal, axis)? * self.inner())
    }

    /// How far the tip is above the lowest point of the end, its axis at an angle to the normal of a plane (rad). m
    fn height(&self, angle: f64) -> f64 {
        let (sine, cosine) = libm::sincos(angle);
        self.inner() * sine + self.corner * (1.0 - cosine)
    }

    /// Radius of the groove that the end leaves across the feed on a plane, leaning from its normal; infinite where it
    /// stands on its bottom. m
    pub fn effective_radius(&self, lean: &Lean) -> f64 {
        if self.is_ball() {
            return self.radius;
        }
        let sine = libm::sin(lean.angle());
        if sine == 0.0 {
            return f64::INFINITY;
        }
        // Seen along the normal the axis points (sin L cos T, sin T) ahead and to the left.
        let (ahead, left) = (libm::sin(lean.lead) * libm::cos(lean.tilt), libm::sin(lean.tilt));
        let square = ahead * ahead / (ahead * ahead + left * left);
        self.corner + self.inner() * square / sine
    }

    /// How high the ridge is that is left between two passes a step apart on a plane (m), leaning from its normal; of a
    /// flat end up to its rim where no step is given. m
    pub fn scallop(&self, lean: &Lean, step_over: Option<f64>) -> Option<f64> {
        if self.is_flat() {
            let half = step_over.map_or(1.0, |step| (step / 2.0 / self.radius).min(1.0));
            let rim = self.radius * libm::sin(lean.lead.abs());
            return Some(rim * half * half / (1.0 + (1.0 - half * half).sqrt()));
        }
        step_over.map(|step| step * step / (8.0 * self.effective_radius(lean)))
    }

    /// How deep the hollow is that the end leaves in the floor of a slot as wide as the cutter, leaning from the normal
    /// of that floor. m
    pub fn hollow(&self, lean: &Lean) -> f64 {
        if self.is_ball() { 0.0 } else { self.height(lean.angle()) }
    }

    /// By how much the contact may leave the line that the path draws while tip and axis go evenly from one point to
    /// the next, the axis turning by `turn` and at least `angle` from the normal of the surface (rad). m
    ///
    /// From the contact to the axis the direction is `e(n, A)`: along a turn of A its second derivative by the angle is
    /// at most `1.27 / sin(angle)^2`, of which an eighth is what a straight line misses; a sixth covers higher orders
    /// too, up to turns of 1 deg.
    pub fn path_error(&self, turn: f64, angle: f64) -> f64 {
        let by_disc = if self.is_ball() { 0.0 } else { turn / libm::sin(angle.max(NEAREST_TO_NORMAL)) };
        (self.corner * turn * turn + self.inner() * by_disc * by_disc) / 6.0
    }
}

/// `unit(n - (n . a) a)`; none where both are one direction.
fn across(normal: &Vector3<f64>, axis: &Vector3<f64>) -> Option<Vector3<f64>> {
    let across = normal - axis * normal.dot(axis);
    (across.norm() > 1e-9).then(|| across.normalize())
}

/// The angle between two directions. rad
pub fn between(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

/// The smallest angle to a direction while an axis turns from one to another the short way. rad
fn nearest(from: &Vector3<f64>, to: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
    let ends = between(from, direction).min(between(to, direction));
    let Some(normal) = from.cross(to).try_normalize(1e-12) else { return ends };
    let foot = direction - normal * normal.dot(direction);
    let is_between = from.cross(&foot).dot(&normal) >= 0.0 && foot.cross(to).dot(&normal) >= 0.0;
    if is_between { libm::asin(normal.dot(direction).abs().min(1.0)) } else { ends }
}

stead_numerics::worded! {
    /// What stays where it is when the tool leans.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "lowercase")]
    pub enum ContactRule {
        /// The centre of a ball, and so its contact with whatever surface.
        Centre = "centre",
        /// The point in which the cutter touches a surface of known normal.
        Contact = "contact",
        /// The plane that the cutter touches, normal to the surface's normal or, where that is not known, to the tool
        /// axis of the path: the contact moves by up to the radius of the cutter towards the side to which it leans.
        Plane = "plane",
    }
}

stead_numerics::worded! {
    /// What the forces of the path do when the tool leans.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
    #[serde(rename_all = "lowercase")]
    pub enum LeanForce {
        /// They stay in the directions of feed and wall.
        #[default]
        Feed = "feed",
        /// They turn with the tool.
        Tool = "tool",
    }
}

/// How a tool leans about its contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeanRule {
    /// The end of the cutter.
    pub end: CutterEnd,
    /// What stays where it is.
    pub contact: ContactRule,
    /// What forces do.
    pub force: LeanForce,
}

/// Why a tool cannot lean so at a point.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LeanError {
    /// The centre of an end that is no ball.
    #[error("the centre stays for a ball alone, a bull or flat cutter keeps rule = \"contact\" or \"plane\"")]
    NoCentre,
    /// A flat end that leans across the feed.
    #[error("a flat end mill leans in lead only")]
    FlatTilt,
    /// The contact of an end on a surface of which the normal is not known.
    #[error("the contact of a {} cutter needs normal_x to normal_z or rule = \"plane\"", if *flat { "flat" } else { "bull" })]
    NoNormal {
        /// Whether its end is flat.
        flat: bool,
    },
    /// The axis leans through the normal of the surface, where the contact is a disc.
    #[error("the contact jumps by up to {} mm where the axis passes the normal", (jump * 1e6).round() / 1e3)]
    ThroughNormal {
        /// By how much. m
        jump: f64,
    },
    /// The side of the cutter touches.
    #[error("the contact is on the flank (axis within 1 deg of normal to the surface normal)")]
    Flank,
    /// The surface points into the tool.
    #[error("the surface normal points away from the tool: it must point out of the part")]
    NormalIntoPart,
    /// The feed is too near to the axis.
    #[error(
        "the feed is {angle_deg:.2} deg from the tool axis that leans, less than {} deg",
        super::MIN_FEED_TO_AXIS_DEG
    )]
    FeedAlongAxis {
        /// How near. deg
        angle_deg: f64,
    },
}

impl LeanRule {
    /// Whether the tool may lean so at a point of a surface with this normal, where that is known.
    ///
    /// # Errors
    /// [`LeanError`]: why not.
    pub fn check(&self, point: &PathPoint, normal: Option<&Vector3<f64>>, lean: &Lean) -> Result<(), LeanError> {
        let end = &self.end;
        let axis = lean.axis(point);
        let angle_deg = libm::asin(axis.cross(&point.feed).norm().min(1.0)).to_degrees();
        if angle_deg < super::MIN_FEED_TO_AXIS_DEG {
            return Err(LeanError::FeedAlongAxis { angle_deg });
        }
        if end.is_ball() {
            return Ok(());
        }
        let normal = match (normal, self.contact) {
            (_, ContactRule::Centre) => return Err(LeanError::NoCentre),
            (Some(normal), _) => normal,
            (None, ContactRule::Plane) => &point.axis,
            (None, ContactRule::Contact) => return Err(LeanError::NoNormal { flat: end.is_flat() }),
        };
        if normal.dot(&point.axis) < 0.0 {
            return Err(LeanError::NormalIntoPart);
        }
        if between(&axis, normal).max(between(&point.axis, normal)) > FARTHEST_FROM_NORMAL {
            return Err(LeanError::Flank);
        }
        if end.is_flat() && lean.tilt != 0.0 {
            return Err(LeanError::FlatTilt);
        }
        if self.contact == ContactRule::Contact && nearest(&point.axis, &axis, normal) < NEAREST_TO_NORMAL {
            return Err(LeanError::ThroughNormal { jump: 2.0 * end.inner() });
        }
        Ok(())
    }

    /// The point of the path with the tool leaning about what it touches ([`LeanRule::check`]): tip and axis are new,
    /// the feed is that of the path made normal to its axis.
    pub fn leaned(&self, point: &PathPoint, normal: Option<&Vector3<f64>>, lean: &Lean) -> PathPoint {
        if *lean == Lean::NONE {
            return *point;
        }
        let (end, axis) = (&self.end, lean.axis(point));
        let normal = normal.unwrap_or(&point.axis);
        let shift = if end.is_ball() {
            (point.axis - axis) * end.radius
        } else if self.contact == ContactRule::Plane {
            normal * (end.height(between(&axis, normal)) - end.height(between(&point.axis, normal)))
        } else {
            let arm = |axis: &Vector3<f64>| axis * end.corner - across(normal, axis).unwrap_or_default() * end.inner();
            arm(&point.axis) - arm(&axis)
        };
        PathPoint { position: point.position + shift, feed: point.workpiece_from_point().column(0).into_owned(), axis }
    }

    /// How far the contact leaves its line, on a surface with this normal, while tip and axis go evenly from one point
    /// to the next and the axis turns from one direction to another. m
    pub fn error_between(&self, normal: &Vector3<f64>, axes: [&Vector3<f64>; 2]) -> f64 {
        let nearest = nearest(axes[0], axes[1], normal);
        if self.contact != ContactRule::Plane || self.end.is_ball() {
            return self.end.path_error(between(axes[0], axes[1]), nearest);
        }
        // The plane stays: what counts is how high the tip is over it, half way and where it is lowest.
        let [from, to] = axes.map(|axis| between(axis, normal));
        let [start, end] = [from, to].map(|angle| self.end.height(angle));
        let middle = between(&(axes[0] + axes[1]), normal);
        let half_way = (self.end.height(middle) - (start + end) / 2.0).abs();
        half_way.max(start.min(end) - self.end.height(nearest))
    }
}

#[cfg(test)]
mod tests;
