//! Support for the tests of all crates: judging in real time, reports of tests that could not judge, seeds for random
//! loops, contrast of colours, and one set of features of the libraries that several crates use (see `Cargo.toml`
//! next to this file).

pub mod contrast;
pub mod fuzz;
pub mod real_time;
pub mod unjudged;
