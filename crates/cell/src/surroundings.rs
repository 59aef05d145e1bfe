//! All shapes and zones of a cell, and the clearance that is requested.

use crate::shape::{Attachment, KeepOut, Shape};
use crate::solid::TriangleMesh;
use std::sync::Arc;
use stead_model::robot::Pose;

/// What there is in a cell beside the arm's own kinematics, checked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surroundings {
    shapes: Vec<Shape>,
    zones: Vec<KeepOut>,
    clearance: f64,
    ignored: Vec<[String; 2]>,
    visuals: Vec<Visual>,
}

/// What a part of the arm looks like: drawn, and held against nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Visual {
    /// Its name.
    pub name: String,
    /// What it moves with: the base of the robot, a link, or the flange.
    pub attached: Attachment,
    /// Its surface.
    pub mesh: Arc<TriangleMesh>,
    /// The frame of the surface in the frame that it moves with.
    pub pose: Pose<f64>,
    /// Red, green and blue, sRGB from 0 to 1, where they are known.
    pub color: Option<[f64; 3]>,
}

/// Why shapes do not make surroundings.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SurroundingsError {
    /// Two shapes or zones have one name.
    #[error("{0:?} is the name of two shapes")]
    SameName(String),
    /// A pair to be ignored names what is neither a shape nor something that shapes are attached to.
    #[error("{0:?} is no shape, and nothing is attached to it")]
    UnknownName(String),
    /// A pair to be ignored names one thing twice.
    #[error("{0:?} is told to ignore itself")]
    IgnoresItself(String),
    /// The clearance is negative or not finite.
    #[error("the clearance must not be negative")]
    Clearance,
}

impl Surroundings {
    /// Joins shapes and zones with the clearance between shapes (m) and the pairs that may touch: each two names of
    /// shapes, or of attachments (`link_2`) for all shapes attached there.
    ///
    /// # Errors
    /// [`SurroundingsError`].
    pub fn new(
        shapes: Vec<Shape>,
        zones: Vec<KeepOut>,
        clearance: f64,
        ignored: Vec<[String; 2]>,
    ) -> Result<Self, SurroundingsError> {
        if !(clearance.is_finite() && clearance >= 0.0) {
            return Err(SurroundingsError::Clearance);
        }
        let mut names: Vec<&str> =
            shapes.iter().map(|s| s.name.as_str()).chain(zones.iter().map(|z| z.name.as_str())).collect();
        names.sort_unstable();
        if let Some(same) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(SurroundingsError::SameName(same[0].to_owned()));
        }
        let is_known =
            |name: &String| shapes.iter().any(|shape| shape.name == *name || shape.attached.to_string() == *name);
        if let Some(unknown) = ignored.iter().flatten().find(|name| !is_known(name)) {
            return Err(SurroundingsError::UnknownName(unknown.clone()));
        }
        if let Some([name, _]) = ignored.iter().find(|[first, second]| first == second) {
            return Err(SurroundingsError::IgnoresItself(name.clone()));
        }
        Ok(Self { shapes, zones, clearance, ignored, visuals: Vec::new() })
    }

    /// The same with what the arm looks like.
    #[must_use]
    pub fn with_visuals(self, visuals: Vec<Visual>) -> Self {
        Self { visuals, ..self }
    }

    /// What the arm looks like, as far as that is known.
    pub fn visuals(&self) -> &[Visual] {
        &self.visuals
    }

    /// The shapes.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The zones that points of the arm are kept out of.
    pub fn zones(&self) -> &[KeepOut] {
        &self.zones
    }

    /// The smallest distance between two shapes that is allowed. m
    pub fn clearance(&self) -> f64 {
        self.clearance
    }

    /// Pairs of names that may touch.
    pub fn ignored(&self) -> &[[String; 2]] {
        &self.ignored
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty() && self.zones.is_empty()
    }

    /// Whether two shapes may touch because a pair of names says so.
    pub fn is_ignored(&self, a: &Shape, b: &Shape) -> bool {
        let is = |shape: &Shape, name: &str| shape.name == name || shape.attached.to_string() == name;
        self.ignored.iter().any(|[first, second]| (is(a, first) && is(b, second)) || (is(a, second) && is(b, first)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Attachment;
    use crate::solid::Solid;
    use nalgebra::Vector3;
    use stead_model::robot::Pose;

    fn cube(name: &str, attached: Attachment) -> Shape {
        Shape {
            name: name.to_owned(),
            attached,
            solid: Solid::Box(Vector3::new(1.0, 1.0, 1.0)),
            pose: Pose::identity(),
        }
    }

    #[test]
    fn names_and_clearance_are_checked() {
        let shapes = vec![cube("a", Attachment::Base), cube("b", Attachment::Link(2))];
        let pair = |a: &str, b: &str| vec![[a.to_owned(), b.to_owned()]];
        let found = Surroundings::new(shapes.clone(), Vec::new(), 0.01, pair("link_2", "a")).unwrap();
        assert!(found.is_ignored(&shapes[0], &shapes[1]) && found.is_ignored(&shapes[1], &shapes[0]));
        assert!(!found.is_ignored(&shapes[0], &shapes[0]));
        let itself = vec![["a".to_owned(), "a".to_owned()]];
        let refused = Surroundings::new(shapes.clone(), Vec::new(), 0.0, itself);
        assert_eq!(refused.unwrap_err(), SurroundingsError::IgnoresItself("a".to_owned()));
        let error = |shapes, clearance, ignored| Surroundings::new(shapes, Vec::new(), clearance, ignored).unwrap_err();
        assert_eq!(error(shapes.clone(), -1.0, Vec::new()), SurroundingsError::Clearance);
        assert_eq!(
            error(shapes.clone(), 0.0, pair("a", "link_4")),
            SurroundingsError::UnknownName("link_4".to_owned())
        );
        let twice = vec![shapes[0].clone(), cube("a", Attachment::Flange)];
        assert_eq!(error(twice, 0.0, Vec::new()), SurroundingsError::SameName("a".to_owned()));
    }
}
