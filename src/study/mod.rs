//! Experiments that print figures.

pub mod picture;
pub mod reference;
pub mod replay;
pub mod solvers;
pub mod stability;
pub mod tradeoff;
pub mod validation;
