//! The user interfaces of NIMA Console: command line and window.
// These macros panic if stderr or stdout is closed, so use `stderr` and `command::output` instead.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

mod by_itself;
pub mod command;
pub mod console;
mod emulators;
pub mod extras;
mod ground_truth;
mod logging;
mod scoring;
pub mod shutdown;
pub mod watching;
