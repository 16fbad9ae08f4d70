//! The user interfaces of NIMA Console: command line and window.
// These macros panic if stderr or stdout is closed: use `telling` and `command::output` instead.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

mod by_itself;
pub mod command;
pub mod console;
mod emulators;
mod extras;
pub mod language;
pub mod leaving;
mod link;
mod logging;
mod objects;
mod pictures;
mod recording;
mod report;
mod scoring;
pub mod telling;
mod truth;
mod watching;
mod words;
