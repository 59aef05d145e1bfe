//! prototype
#![allow(missing_docs, dead_code)]
pub mod arm; pub mod number; pub mod table; pub mod region; pub mod cost; pub mod bound; pub mod reduced; pub mod search;
