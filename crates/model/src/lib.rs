//! What things are: the arm, the tool path, how the arm yields, and what pushes along the path.

pub mod cutting;
pub mod published;
pub mod robot;
pub mod stiffness;
pub mod task;
