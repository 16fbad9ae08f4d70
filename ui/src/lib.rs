//! The faces of NIMA Console: the command line and the window.
// A closed stderr or stdout makes these macros panic: see `telling` and `command::output`.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

pub mod command;
pub mod console;
pub mod leaving;
pub mod telling;
mod words;
