//! Shared by the tests of every crate: tests in real time, reports of tests that could not judge, seeds for random
//! loops, and one set of features for the libraries that several crates use (see `Cargo.toml` in this folder).

pub mod fuzz;
pub mod real_time;
pub mod unjudged;
