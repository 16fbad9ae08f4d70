//! Implements [`Follower`] for the arm.

use super::KinovaDriver;
use crate::{ARM_JOINTS, Follower, Lever};

impl Follower for KinovaDriver {
    fn enter_servoing(&mut self) {
        // After a refusal the readings show that the arm is not servoing.
        self.enter_low_level().ok();
    }

    fn leave_servoing(&mut self) {
        self.leave_low_level();
    }

    fn command_rad(&self) -> [f64; ARM_JOINTS] {
        *Self::command_rad(self)
    }

    fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) -> bool {
        Self::aim(self, target_rad).is_ok()
    }

    fn attach(&self, lever: &Lever) {
        if let Ok(pull) = self.lever() {
            lever.attach(pull);
        }
    }
}
