//! Why there are no forces of a path.

use nalgebra::Vector3;
use stead_model::task::TaskError;
use stead_numerics::digits::figures;
use stead_numerics::monitor::Stop;

/// Coordinates of stock are nanometres in 32 bits. m
pub const LARGEST: f64 = 4.2;

/// Why there are no forces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForcesError {
    /// The stock is a form that it cannot be.
    #[error("the stock and the finished part are boxes, cylinders or closed meshes")]
    Form,
    /// Stock from a path on which nothing is scored.
    #[error("no scored move of the path has a wall")]
    NoWall,
    /// The stock is too long: its longest side. m
    #[error("the stock is {0} m long: at most {most} m", most = LARGEST)]
    Large(f64),
    /// The surface of the stock is not closed, or crosses itself.
    #[error("the surface of the stock is no closed one: {share:.1e} of the lines through it do not go in and out in turn, as at {}", place(.at))]
    Open {
        /// Share of such lines.
        share: f64,
        /// Where one of them begins. m
        at: Vector3<f64>,
    },
    /// A path without feeds.
    #[error("the path of {0} has no feeds")]
    NoFeeds(String),
    /// Nothing is cut.
    #[error("the path never touches the stock")]
    Untouched,
    /// The lines do not fit into the memory.
    #[error("cells of {} mm take {} GB, more than the {} GB allowed: {}", figures(.cell * 1e3), figures(.needed / 1e9), figures(.allowed / 1e9), fitting(*.fits))]
    Memory {
        /// The distance of lines. m
        cell: f64,
        /// What they take. bytes
        needed: f64,
        /// What they may take. bytes
        allowed: f64,
        /// The smallest distance that fits, where one does with which forces mean something. m
        fits: Option<f64>,
    },
    /// Points that were added make no path.
    #[error(transparent)]
    Path(#[from] TaskError),
    /// Stopped before it was done.
    #[error(transparent)]
    Stopped(#[from] Stop),
}

/// Which cells fit, for messages.
fn fitting(fits: Option<f64>) -> String {
    fits.map_or("no cells fit".to_owned(), |fits| format!("{} mm fits", figures(fits * 1e3)))
}

/// A place for a message.
pub fn place(at: &Vector3<f64>) -> String {
    let [x, y, z] = [at.x, at.y, at.z].map(|value| (value * 1e6).round() / 1e3);
    format!("({x}, {y}, {z}) mm")
}
