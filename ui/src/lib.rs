//! The user interfaces of NIMA Console: command line and window.
// These macros panic if stderr or stdout is closed: use `telling` and `command::output`.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

mod by_itself;
pub mod command;
pub mod console;
mod emulators;
pub mod language;
pub mod leaving;
mod lens;
mod line;
mod objects;
mod pictures;
mod recording;
mod report;
mod scoring;
mod study_report;
pub mod telling;
mod user_study;
mod watching;
mod words;
