//! The faces of NIMA Console: the command line and the window.

pub mod command;
pub mod console;
