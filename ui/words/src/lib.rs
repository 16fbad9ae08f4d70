//! The languages, and all texts that a person reads: of the window ([`text`]) and for the values that the libraries report
//! ([`report_text`]).
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

pub mod language;
pub mod report_text;
pub mod text;
