//! The cell around a robot: shapes that stand in it, or move with the arm, the workpiece or an external axis; how far
//! they are from each other; and motions of the arm that keep them apart.
//!
//! A [`Surroundings`] says what there is and how much clearance is requested. A [`Scene`] joins it with the arm and
//! answers for a configuration ([`Scene::first_hit`], [`Scene::clearance`]) or for a whole joint motion
//! ([`Scene::motion`]); along a path of configurations each is answered by what is known from the one before
//! ([`Scene::next_hit`]).
//!
//! Every answer has two stages: covers of spheres and boxes that contain the shapes decide most pairs; what only the
//! covers refuse is decided by the exact shapes ([`collider`]). So nothing is called free that is not, and nothing is
//! refused for the sake of a cover.
//!
//! ```
//! use nalgebra::{Vector3, vector};
//! use stead_cell::{Attachment, PairKind, Scene, Shape, Solid, Surroundings};
//! use stead_model::robot::{Pose, testing};
//! // A spindle on the flange, and a pillar where the flange is.
//! let (robot, joints) = (testing::kr270(), [0.0, 1.2, -2.0, 0.0, 1.0, 0.0]);
//! let flange = robot.forward(&joints).translation;
//! let at = |x, y, z| Pose { translation: Vector3::new(x, y, z), ..Pose::identity() };
//! let shape = |name: &str, attached, radius, length, pose| {
//!     Shape { name: name.to_owned(), attached, solid: Solid::Cylinder { radius, length }, pose }
//! };
//! let shapes = vec![
//!     shape("spindle", Attachment::Flange, 0.09, 0.4, at(0.0, 0.0, 0.3)),
//!     shape("pillar", Attachment::Base, 0.15, 6.0, at(flange.x, flange.y, 0.0)),
//! ];
//! let around = Surroundings::new(shapes, Vec::new(), 0.02, Vec::new())?;
//! let scene = Scene::new(&robot, &testing::spindle().flange_from_tool, around)?;
//! let hit = |joints: &[f64; 6]| scene.first_hit(&scene.poses(joints, &Pose::identity()), &PairKind::ALL);
//! assert_eq!(hit(&joints), Some(0));
//! assert_eq!(hit(&[1.0, 1.2, -2.0, 0.0, 1.0, 0.0]), None);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod collider;
pub mod cover;
pub mod scene;
pub mod shape;
pub mod solid;
pub mod surroundings;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
pub mod tool_scene;

pub use scene::{Clearance, MotionHit, Near, Pair, PairKind, Poses, Proximity, Scene, SceneError};
pub use shape::{Attachment, KeepOut, Shape, TrackedPoint, Zone};
pub use solid::{MeshError, Solid, TriangleMesh};
pub use surroundings::{Surroundings, SurroundingsError, Visual};
