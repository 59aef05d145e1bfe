//! Milling in a restricted space: how far a tool gets along lines inside a half-closed box.
//!
//! `cargo run --release -p stead-experiments --bin restricted-space` prints what a leaning tool reaches in the box of
//! `configs/restricted-space.toml` (module `table`); from the root of the repository, some minutes. With a file behind
//! `--` it is about the mesh of a published benchmark (module `mesh`).

#![allow(clippy::print_stdout, reason = "an experiment prints")]

mod mesh;
mod table;

use std::env;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    match env::args().nth(1) {
        Some(mesh) => mesh::study_mesh(&mesh),
        None => table::print_table(),
    }
}
