//! The `stead` command: see [`stead::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    stead::cli::main()
}
