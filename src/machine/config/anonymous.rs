//! A rig without what tells who has it and where.

use super::RigConfig;

/// Stands for the name of a rig or a scene.
pub const ANONYMOUS: &str = "anonymous";

impl RigConfig {
    /// The same without its devices and without names: a simulated rig with the same loop.
    #[must_use]
    pub fn anonymous(mut self) -> Self {
        // Without `..`: a field that is added does not compile until somebody decides whether it may tell who or where.
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
