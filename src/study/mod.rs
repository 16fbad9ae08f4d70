//! Experiments that print figures.

pub mod replay;
pub mod solvers;
pub mod tradeoff;
