//! What documents are made of: results as data, and from that tables, charts and the folder that they are written into.
//!
//! - [`records!`](crate::records), [`figure`]: results as data, each number with its unit and decimals in its type;
//!   [`units`], [`columns`]: numbers and lines of text.
//! - [`csv_file`], [`output`]: tables, and the folder of results, written whole or not at all.
//! - [`cards`]: tables and charts of a page as data; [`picture`]: the same as SVG; [`packed`], [`gltf_buffer`]: numbers
//!   for scripts and scenes.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

mod record;

pub mod cards;
pub mod columns;
pub mod csv_file;
pub mod figure;
pub mod gltf_buffer;
pub mod output;
pub mod packed;
pub mod picture;
pub mod units;

#[cfg(any(test, feature = "testing"))]
pub mod testing;
