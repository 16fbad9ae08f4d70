//! What is kept in files: recordings of motion and force, data sets, trained networks, calibrations.
//!
//! Takes and gives the types of `nima-core`; bytes on one side, checked values on the other. Every reader refuses what it does not
//! understand with its place; every writer writes a temporary file first and renames it.
#![warn(missing_docs)]

pub mod csv;
pub mod store;
pub mod tip_force;
