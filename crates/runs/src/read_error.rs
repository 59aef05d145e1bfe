//! Why a file that asks for work when it is read has given nothing.

use std::path::Path;
use stead_disk::input::InputError;
use stead_numerics::monitor::Stop;

/// Why there is no run: a table `[stock]` asks for forces, which take long and may be stopped.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// Something in a file is wrong.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The caller stopped the computation.
    #[error(transparent)]
    Stopped(#[from] Stop),
}

impl ReadError {
    /// As what is wrong with a file, for a reader that nobody stops.
    pub fn input(self, file: &Path) -> InputError {
        match self {
            Self::Input(error) => error,
            Self::Stopped(stop) => InputError::new(file, stop.to_string()),
        }
    }

    /// The same with what put the value there that is wrong.
    pub(crate) fn set_by(self, origin: String) -> Self {
        match self {
            Self::Input(error) => Self::Input(error.set_by(origin)),
            stopped @ Self::Stopped(_) => stopped,
        }
    }
}
