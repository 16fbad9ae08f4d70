//! The simulated rig: a world for each arm pair.
//!
//! The tissue of two worlds is the same: contact is local to a tip, so two tips can share it as long as they do not
//! touch each other.

use nima_machine::rig::{Inputs, Outputs, Rig, SIDES, Side};

use super::World;
use crate::scene::Scene;

/// The worlds of a scene.
#[derive(Clone, Debug)]
pub struct Worlds {
    worlds: [Option<World>; SIDES],
    /// Applied until the next write.
    outputs: [Outputs; SIDES],
}

impl Worlds {
    /// The worlds of a scene with `rate_hz` steps a second. The scene must have been validated.
    pub fn new(scene: &Scene, rate_hz: f64) -> Self {
        let world = |side| scene.of_side(side).map(|scene| World::new(&scene, rate_hz));
        Self { worlds: Side::ALL.map(world), outputs: [Outputs::SAFE; SIDES] }
    }
}

impl Rig for Worlds {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = [None; SIDES];
        for ((input, world), output) in inputs.iter_mut().zip(&mut self.worlds).zip(&self.outputs) {
            *input = world.as_mut().and_then(|world| world.exchange(now_s, output));
        }
        inputs
    }

    fn write(&mut self, _: f64, outputs: &[Outputs; SIDES]) {
        self.outputs = *outputs;
    }
}
