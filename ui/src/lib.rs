//! The faces of NIMA Console: the operator's window.

pub mod console;
