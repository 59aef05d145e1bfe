//! Robots to be assessed and compared.

use stead_assessment::comparison::Comparison;
use stead_assessment::published::PublishedTables;
use stead_disk::input::InputFile;
use stead_model::cutting::ForceHistory;
use stead_model::published::Published;
use stead_numerics::message::Note;

/// An assessment file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct AssessRun {
    /// What is to be assessed.
    pub comparison: Comparison,
    /// Where a range of compliance was replaced by one value of it: how far from its smaller to its larger end.
    pub range_share: Option<f64>,
    /// The cutting forces behind the load, where the file computes them.
    pub force_history: Option<ForceHistory>,
    /// Published tables to set beside ours.
    pub published: Option<Published<PublishedTables>>,
    /// The files that were read: config, robots, reference.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<Note>,
}
