//! Experiments that print figures.

pub mod faults;
pub mod gates;
mod pair;
pub mod picture;
pub mod reference;
pub mod release;
pub mod replay;
pub mod solvers;
pub mod stability;
pub mod stability_map;
pub mod tradeoff;
pub mod validation;
