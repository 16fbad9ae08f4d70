//! The force at the tip that the follower's machine sends over a network.

use nalgebra::Vector3;
use nima_core::impedance::{ModeSet, ParameterPack, SLOTS};

use crate::messages::{FarStop, ForceSource};

/// Result that the other machine identified from one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemoteIdentification {
    /// Time at which the command was given that was active at the sample, s on this machine's loop clock. All ages are
    /// therefore differences on one clock.
    pub t_s: f64,
    /// Time from a command to its answer: both directions including their playout, s.
    pub delay_s: f64,
    /// Force at the tip, N, world frame.
    pub force_n: Vector3<f64>,
    pub source: ForceSource,
    pub fresh: bool,
    pub resting: bool,
    pub modes: ModeSet,
    /// Parameters of one of these modes.
    pub packed: ParameterPack,
    /// Running mean of each mode's error at the prediction horizon, N, if the message contains it.
    pub errors_n: Option<[f32; SLOTS]>,
    pub stop: Option<FarStop>,
}

impl RemoteIdentification {
    pub fn is_finite(&self) -> bool {
        self.t_s.is_finite() && self.delay_s.is_finite() && self.force_n.iter().all(|x| x.is_finite())
    }
}
