//! Implements [`Leader`] for the handle.

use nalgebra::Vector3;

use super::{ForceDimensionDriver, HandleEvent};
use crate::{Leader, Lever};

impl Leader for ForceDimensionDriver {
    fn switch_force(&mut self, on: bool) {
        if on { self.enable_force() } else { self.disable_force() }
    }

    fn set_force(&mut self, force_n: Vector3<f64>, gripper_n: f64) {
        // The counters show a force that was limited or refused; the next tick sets it again.
        Self::set_force(self, force_n, gripper_n);
    }

    fn force_change(&mut self) -> Option<bool> {
        std::iter::from_fn(|| self.take_event()).last().map(|event| event == HandleEvent::ForceOn)
    }

    fn attach(&self, lever: &Lever) {
        lever.attach(self.lever());
    }
}
