//! The simulated rig: a world for each arm pair.
//!
//! The tissue of two worlds is the same: contact is local to a tip, so two tips can share it as long as they do not
//! touch each other. Objects that move are shared by both instruments, and then these touch each other too.

use nima_machine::rig::{Inputs, Outputs, Rig, SIDES, Side};

use super::{World, carrying};
use crate::{
    playing::Playing,
    scene::Scene,
    watched::{self, Watched},
};

/// The worlds of a scene.
#[derive(Clone, Debug)]
pub struct Worlds {
    arms: [Option<World>; SIDES],
    playing: Option<Playing>,
    period_s: f64,
    /// Applied until the next write.
    outputs: [Outputs; SIDES],
}

impl Worlds {
    /// The worlds of a scene with `rate_hz` steps a second. The scene must have been validated.
    pub fn new(scene: &Scene, rate_hz: f64) -> Self {
        Self::watched(scene, rate_hz).0
    }

    /// The same, and where it tells of the objects of the scene, if there are any.
    pub fn watched(scene: &Scene, rate_hz: f64) -> (Self, Option<Watched>) {
        let Some(setting) = &scene.objects else {
            let world = |side| scene.of_side(side).map(|scene| World::new(&scene, rate_hz));
            return (
                Self {
                    arms: Side::ALL.map(world),
                    playing: None,
                    period_s: 1.0 / rate_hz,
                    outputs: [Outputs::SAFE; SIDES],
                },
                None,
            );
        };
        let mut tasks = carrying::ways(setting, scene.left.is_some());
        let arms = Side::ALL.map(|side| {
            let task = std::mem::take(&mut tasks[side.index()]);
            scene.of_side(side).map(|scene| World::carrying(&scene, rate_hz, task))
        });
        let (teller, watched) = watched::ends();
        let playing = Some(Playing::new(setting, 1.0 / rate_hz, teller));
        (Self { arms, playing, period_s: 1.0 / rate_hz, outputs: [Outputs::SAFE; SIDES] }, Some(watched))
    }

    /// Both instruments among the same objects, period by period.
    fn play(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let Self { arms, playing: Some(playing), period_s, outputs } = self else { return [None; SIDES] };
        let mut due = [0; SIDES];
        for ((world, outputs), due) in arms.iter_mut().zip(outputs).zip(&mut due) {
            if let Some(world) = world {
                world.wait(outputs.tip_command_m.is_none());
                *due = world.accept(now_s, outputs);
            }
        }
        let steps = due.into_iter().max().unwrap_or(0);
        for step in 0..steps {
            for (world, due) in arms.iter_mut().zip(due) {
                world.iter_mut().filter(|_| step < due).for_each(World::step);
            }
            let t_s = now_s - f64::from(steps - 1 - step) * *period_s;
            let loads = playing.step(t_s, &arms.each_ref().map(|world| world.as_ref().map(World::instrument)));
            for (world, loads) in arms.iter_mut().zip(loads) {
                if let Some(world) = world {
                    world.feel(&loads);
                }
            }
        }
        arms.each_mut().map(|world| world.as_mut().map(World::measure))
    }
}

impl Rig for Worlds {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        if self.playing.is_some() {
            return self.play(now_s);
        }
        let mut inputs = [None; SIDES];
        for ((input, world), output) in inputs.iter_mut().zip(&mut self.arms).zip(&self.outputs) {
            *input = world.as_mut().and_then(|world| world.exchange(now_s, output));
        }
        inputs
    }

    fn write(&mut self, _: f64, outputs: &[Outputs; SIDES]) {
        self.outputs = *outputs;
    }
}
