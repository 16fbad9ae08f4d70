//! Experiments that print figures.

pub mod replay;
