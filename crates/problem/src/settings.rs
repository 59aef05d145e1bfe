//! How hard to search, how sharp a certificate is to be, and how joints move between segments: what is stated beside a
//! problem, with its checks.

mod certificate;
mod search;
mod transfer;

pub use certificate::CertificateSettings;
pub use search::{LookupUse, PostureSearch, SearchSettings, Unfit};
pub use transfer::TransferSettings;

use crate::problem::Problem;

/// Memory for a point of the path while it is planned and reported, as measured with 50 000 points. Bytes
const MEMORY_PER_POINT: u64 = 12_000;

/// About how much memory the job takes for a path. Bytes
pub fn planning_memory(problem: &Problem) -> u64 {
    MEMORY_PER_POINT * problem.task.points().len() as u64
}
