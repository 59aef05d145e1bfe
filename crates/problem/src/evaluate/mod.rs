//! Evaluation of states of the arm: [`mod@reference`] one state at a time, in any number type; [`batch`] all grid
//! values of beta at a path point at once, tested against it.

pub mod batch;
pub mod placed_task;
pub mod point_evaluator;
pub mod reference;
