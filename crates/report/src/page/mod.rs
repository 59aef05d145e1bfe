//! The page: a run in one HTML file that needs no network, with the cell in three dimensions.
//!
//! `page-data.json` (`data`) holds what the tables of a run do not: robot, task, the joint angles of the maps, the
//! bodies. The page is made of that and of the other files of the run, by `page`, so that its numbers are theirs and
//! `stead page` makes the same page of a folder (`folder`). Its script is plain JavaScript in `script/`: modules,
//! joined by `script`.
//!
//! It uses no library. Three ways were built and measured with the published case, on two cores and software rendering:
//! the crate `plotly` (5.0 MB a page, first view after 3.7 to 4.0 s, 39 crates), three.js with uPlot (0.96 MB, 6.2 to
//! 7.8 s, needs Node to build), and own WebGL 2 and canvas (0.34 MB, 0.6 to 1.3 s, nothing added). The last looks as
//! good, builds offline, and leaves no third-party text in what users pass on.

mod body;
pub mod cards;
mod clearance;
pub(crate) mod content;
pub(crate) mod data;
mod folder;
pub mod gltf;
mod html;
pub mod live;
mod made;
mod map_data;
mod moves;
mod pose;
mod removal;
mod script;
pub mod setup;
mod shapes;
mod surroundings;
mod table;
#[cfg(test)]
mod tests;
mod thinned;

pub use folder::{RewriteError, rewrite};
pub use made::put_page;
pub use shapes::{BodyFrame, BodyMesh, bodies};

use crate::output::ReportError;
use stead_document::packed;

/// `report.html`.
pub(crate) const PAGE: &str = "report.html";
/// `page-data.json`.
pub(crate) const DATA: &str = content::DATA;

/// Why files make no page.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {problem}")]
pub(crate) struct PageError {
    file: String,
    problem: String,
}

impl PageError {
    fn file(file: &str, problem: impl Into<String>) -> Self {
        Self { file: file.to_owned(), problem: problem.into() }
    }

    /// An entry of `page-data.json`.
    fn data(key: &str, problem: &str) -> Self {
        Self::file(DATA, format!("{key} {problem}"))
    }
}

impl From<PageError> for ReportError {
    fn from(error: PageError) -> Self {
        Self::Format { what: PAGE, cause: error.to_string() }
    }
}
