//! The simulated rig: a world for each arm pair.
//!
//! The pads of two worlds are one pad: contact is local to a tip, so two tips share it as long as they do not touch each other.

use super::World;
use crate::{
    config::Scene,
    device::{Inputs, Outputs, Rig, SIDES, Side},
};

/// The worlds of a scene.
#[derive(Clone, Debug)]
pub struct Worlds {
    worlds: [Option<World>; SIDES],
}

impl Worlds {
    /// Of a scene, stepping `rate_hz` times a second. The scene must have been validated.
    pub fn new(scene: &Scene, rate_hz: f64) -> Self {
        let world = |side| scene.of_side(side).map(|scene| World::new(&scene, rate_hz));
        Self { worlds: Side::ALL.map(world) }
    }
}

impl Rig for Worlds {
    fn exchange(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) -> [Option<Inputs>; SIDES] {
        let mut inputs = [None; SIDES];
        for ((input, world), output) in inputs.iter_mut().zip(&mut self.worlds).zip(outputs) {
            *input = world.as_mut().and_then(|world| world.exchange(now_s, output));
        }
        inputs
    }
}
