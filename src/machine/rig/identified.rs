//! The force at the tip as the follower's machine tells it over a network.

use nalgebra::Vector3;
use nima_core::impedance::{ModeSet, Packed, SLOTS};

use crate::messages::{FarStop, ForceSource};

/// What was identified at the other machine from one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identified {
    /// When the command was given, on this machine's loop clock, that was in force at the sample, s. So no clock is compared with
    /// another: all ages are differences on one.
    pub t_s: f64,
    /// From a command to the answer to it: both ways with their play-out, s.
    pub delay_s: f64,
    /// Force at the tip, N, world frame.
    pub force_n: Vector3<f64>,
    /// Where it comes from.
    pub source: ForceSource,
    /// The sample was good.
    pub fresh: bool,
    /// The identification rested.
    pub resting: bool,
    /// The modes that are computed there.
    pub modes: ModeSet,
    /// Parameters of one of them.
    pub packed: Packed,
    /// Running mean of each mode's error at the horizon, N, where it is told.
    pub errors_n: Option<[f32; SLOTS]>,
    /// Why the other machine is stopped.
    pub stop: Option<FarStop>,
}

impl Identified {
    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.t_s.is_finite() && self.delay_s.is_finite() && self.force_n.iter().all(|x| x.is_finite())
    }
}
