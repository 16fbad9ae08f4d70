//! A rig without what tells who has it and where.

use super::RigConfig;

/// Stands for the name of a rig or a scene.
pub const ANONYMOUS: &str = "anonymous";

impl RigConfig {
    /// The same without its devices and without names: a simulated rig with the same loop.
    #[must_use]
    pub fn anonymous(self) -> Self {
        // Without `..`: a field that is added does not compile until somebody decides whether it may tell who or where.
        let Self {
            name: _,
            rate_hz,
            mode,
            delay_s,
            follower_speed_max_m_s,
            identification,
            gates,
            tip_force,
            scheduling,
            ready_check,
            teleoperation,
            desk: _,
            simulated: _,
            devices: _,
        } = self;
        Self {
            name: ANONYMOUS.to_owned(),
            rate_hz,
            mode,
            delay_s,
            follower_speed_max_m_s,
            identification,
            gates,
            tip_force,
            scheduling,
            ready_check,
            teleoperation,
            desk: None,
            simulated: None,
            devices: None,
        }
    }
}
