//! A rig without data that identify its owner or place.

use super::RigConfig;

/// Replaces the name of a rig or a scene.
pub const ANONYMOUS: &str = "anonymous";

impl RigConfig {
    /// Returns the rig without its devices and names: a simulated rig with the same loop.
    #[must_use]
    pub fn anonymous(mut self) -> Self {
        // Without `..`, a new field does not compile until its author decides whether it may identify a person or a
        // place.
        let Self {
            name,
            rate_hz: _,
            mode: _,
            delay_s: _,
            follower_speed_max_m_s: _,
            identification: _,
            gates: _,
            tip_force: _,
            scheduling: _,
            ready_check: _,
            teleoperation: _,
            desk,
            simulated,
            endoscope,
            devices,
        } = &mut self;
        ANONYMOUS.clone_into(name);
        *desk = None;
        *simulated = None;
        *endoscope = None;
        *devices = None;
        self
    }
}
