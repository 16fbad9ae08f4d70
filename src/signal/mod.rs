//! Signals at a fixed rate: derivatives of a sampled position and an exact delay line.
//!
//! Takes: one position per tick (m, up to three axes, in [`Lanes`]) at a rate fixed at construction.
//! Gives: position, velocity (m/s) and acceleration (m/s²) of the same instant ([`Motion`]), causal: only the present and
//! past samples are used. [`DelayLine`] hands back what went in exactly `n` ticks ago.
//! Everything is allocated at construction. Bad input: callers hand in finite numbers only (the identifier fills gaps with
//! a prediction before they get here); a non-finite sample would otherwise live in a filter until it leaves the window.

mod bank;
mod delay;
mod differentiator;
mod foaw;
mod kalman;
mod lanes;
mod savitzky_golay;

pub use bank::{BANK, LowPassBank};
pub use delay::DelayLine;
pub use differentiator::{Differentiator, DifferentiatorKind};
pub use lanes::{LANES, Lanes, NOTHING, settled};

/// Position, velocity and acceleration of one instant, one lane per axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Position (m).
    pub x: Lanes,
    /// Velocity (m/s).
    pub v: Lanes,
    /// Acceleration (m/s²).
    pub a: Lanes,
}
