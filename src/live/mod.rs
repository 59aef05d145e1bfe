//! A placement moved by hand in the browser: `stead live`.
//!
//! [`Session`] holds a run and a folder and answers what the page asks: what a placement comes to (`evaluation`), the
//! long jobs (`jobs`), the placements that are kept (`pins`) and the rest for the next session (`kept`), other values
//! of the run file (`edits`). It knows nothing of HTTP (`http`); `requests` reads what it is asked, [`Server`] lets the
//! page of one browser ask it.
//!
//! Whatever is computed is what the commands compute: a placement at rest has the figures of `stead score`, a kept one
//! is a folder as `stead score --out` writes it.

mod edits;
mod evaluation;
mod http;
mod jobs;
mod kept;
mod newest;
mod pins;
mod place;
mod reading;
mod requests;
mod routes;
mod running;
mod server;
mod session;
#[cfg(test)]
mod tests;

pub use requests::RequestError;
pub use server::{Server, StartError};
pub use session::{LiveOptions, Session};
