//! What the tests of every crate stand on: judging in real time, seeds for random loops, and one set of features of the libraries that
//! several crates share (see `Cargo.toml` beside this file).

pub mod fuzz;
pub mod real_time;
