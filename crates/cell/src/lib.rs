//! The cell around a robot: shapes that stand in it, or move with the arm, the workpiece or an external axis; how far they are from
//! each other; and motions of the arm that keep them apart.
//!
//! A [`Surroundings`] says what there is and how much clearance is asked for. A [`Scene`] joins it with the arm and answers for a
//! configuration ([`Scene::first_hit`], [`Scene::clearance`]) or for a whole joint motion ([`Scene::motion`]); along a path
//! of configurations each is answered by what is known from the one before ([`Scene::next_hit`]).
//!
//! Every answer has two stages: covers of spheres and boxes that contain the shapes decide most pairs; what only the covers refuse is
//! decided by the exact shapes ([`collider`]). So nothing is called free that is not, and nothing is refused for the sake of a cover.

pub mod collider;
pub mod cover;
pub mod scene;
pub mod shape;
pub mod solid;
pub mod surroundings;
#[cfg(any(test, feature = "testing"))]
pub mod testing;

pub use scene::{Clearance, MotionHit, Near, Pair, PairKind, Poses, Proximity, Scene, SceneError};
pub use shape::{Attachment, KeepOut, Shape, TrackedPoint, Zone};
pub use solid::{MeshError, Solid, TriangleMesh};
pub use surroundings::{Surroundings, SurroundingsError};
