//! Identification part of a rig file.

use nima_core::impedance::{MAX_DEGREE, OwnMotion, Recipe, Scales};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Identification {
    /// Length of the rolling window, s (the paper's 0.3 s).
    pub window_s: f64,
    /// Highest degree identified, 1 to 5.
    pub max_degree: usize,
    /// Computes every mode in addition to the rendered one, for comparison; otherwise only the rendered mode is
    /// computed.
    pub compare: bool,
    /// The identification rests while the force is within this, N, because there is no contact. Choose five times the
    /// noise of the force. 0: it never rests.
    pub rest_n: f64,
    /// The motion from which the leader computes the force.
    pub own_motion: OwnMotion,
    /// Learns the full matrix `M` with cross-talk between the axes; this doubles the cost.
    pub cross_talk: bool,
    /// Fixed scales of the regressor's columns, from the rig's workspace.
    pub scales: Scales,
    /// Interpretation of the paper in the modes literal and linear.
    pub literal: Recipe,
    /// Computes the forces of sessions with an earlier journal; the replay sets it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub earlier_forces: bool,
}

impl Default for Identification {
    fn default() -> Self {
        Self {
            window_s: 0.3,
            max_degree: MAX_DEGREE,
            compare: false,
            rest_n: 0.1,
            own_motion: OwnMotion::Follower,
            cross_talk: false,
            scales: Scales::default(),
            literal: Recipe::default(),
            earlier_forces: false,
        }
    }
}
