//! What the loop asks of hardware, real or simulated.
//!
//! Positions in m, forces in N, both in the workspace frame (z up). A rig that cannot deliver a sample says so with
//! `None`; it never repeats an old one as new.

use nalgebra::Vector3;

/// One exchange's worth of measurements of an arm pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Position of the leader's handle, mapped into the workspace, m.
    pub leader_m: Vector3<f64>,
    /// Position of the instrument's tip, m.
    pub tip_m: Vector3<f64>,
    /// Force of the tissue on the tip, N.
    pub force_n: Vector3<f64>,
}

impl Inputs {
    /// Every number in it is finite.
    pub fn is_finite(&self) -> bool {
        [&self.leader_m, &self.tip_m, &self.force_n].into_iter().all(|v| v.iter().all(|x| x.is_finite()))
    }
}

/// What the loop commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// Where the tip shall go, m; `None` holds the follower where it is.
    pub tip_command_m: Option<Vector3<f64>>,
    /// Force on the hand, N. Has passed every gate.
    pub hand_force_n: Vector3<f64>,
}

impl Outputs {
    /// The safe outputs: no force, a resting follower.
    pub const SAFE: Self = Self { tip_command_m: None, hand_force_n: Vector3::new(0.0, 0.0, 0.0) };
}

/// A leader, a follower and a force sensor that belong together. Owned by the real-time thread.
pub trait Rig: Send {
    /// Applies `outputs` and gives the newest measurements at loop time `now_s`; `None` when there are none.
    ///
    /// Must not block and must not allocate.
    fn exchange(&mut self, now_s: f64, outputs: &Outputs) -> Option<Inputs>;
}
