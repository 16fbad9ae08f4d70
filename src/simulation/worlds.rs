//! The simulated rig: a world for each arm pair.
//!
//! The tissue of both worlds is the same: contact is local to a tip, so two tips can share it as long as they do not
//! touch each other. Moving objects are shared by both instruments, which then also touch each other.

use nalgebra::Vector3;
use nima_machine::rig::{Inputs, Outputs, Rig, SIDES, Side};

use super::{World, ring_task, wire_task};
use crate::{
    object_feed::{self, ObjectFeed},
    palpation_task::PalpationTask,
    scene::Scene,
    training_task::TrainingTask,
    world::{HandActivity, ROUNDING_PERIODS},
};

#[derive(Clone, Debug)]
pub struct Worlds {
    arms: [Option<World>; SIDES],
    playing: Option<TrainingTask>,
    period_s: f64,
    /// Time by which the hands are ahead of the objects, s.
    ahead_s: f64,
    /// Applied until the next write.
    outputs: [Outputs; SIDES],
}

/// Returns the activity of each hand in a scene with objects; `None` in other scenes.
fn doing(scene: &Scene) -> [Option<HandActivity>; SIDES] {
    if let Some(setting) = &scene.objects {
        return ring_task::ways(setting, scene.left.is_some()).map(|task| Some(HandActivity::Carrying(task)));
    }
    let of_side = |side: Side| {
        let scene = scene.of_side(side)?;
        let of_wire = |setting| HandActivity::Threading(wire_task::way(setting, &scene.hand, scene.seed));
        let of_lumps = || scene.is_searched().then(|| HandActivity::Searching(PalpationTask::of(&scene)));
        scene.wire.as_ref().map(of_wire).or_else(of_lumps)
    };
    Side::ALL.map(of_side)
}

impl Worlds {
    /// Creates the worlds of a scene with `rate_hz` steps per second. The scene must have been validated.
    pub fn new(scene: &Scene, rate_hz: f64) -> Self {
        Self::watched(scene, rate_hz).0
    }

    /// Like [`new`](Self::new), with access to the objects of the scene, if there are any.
    pub fn watched(scene: &Scene, rate_hz: f64) -> (Self, Option<ObjectFeed>) {
        let period_s = 1.0 / rate_hz;
        let (publisher, watched) = object_feed::ends();
        let playing = TrainingTask::of(scene, period_s, publisher);
        let watched = playing.is_some().then_some(watched);
        let mut doing = doing(scene);
        let arms = Side::ALL.map(|side| {
            let scene = scene.of_side(side)?;
            Some(match doing[side.index()].take() {
                Some(doing) => World::playing(&scene, rate_hz, doing),
                None => World::new(&scene, rate_hz),
            })
        });
        (Self { arms, playing, period_s, ahead_s: 0.0, outputs: [Outputs::SAFE; SIDES] }, watched)
    }

    /// Returns the positions of the tips, m; `None` for a side that the scene does not have.
    pub fn tips_m(&self) -> [Option<Vector3<f64>>; SIDES] {
        self.arms.each_ref().map(|world| world.as_ref().map(World::tip_m))
    }

    /// Simulates both instruments with their shared objects, period by period.
    fn play(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let Self { arms, playing: Some(playing), period_s, ahead_s, outputs } = self else { return [None; SIDES] };
        let mut left_s = 0.0_f64;
        for (world, outputs) in arms.iter_mut().zip(&*outputs) {
            if let Some(world) = world {
                world.wait(outputs.tip_command_m.is_none());
                // The worlds share one clock.
                left_s = left_s.max(world.accept(now_s, outputs));
            }
        }
        while left_s > ROUNDING_PERIODS * *period_s {
            let pace = arms.iter().flatten().map(|world| world.hand().felt_pace()).fold(1.0, f64::min);
            arms.iter_mut().flatten().for_each(|world| world.fraction_pace(pace));
            let step_s = left_s.min(*period_s - *ahead_s);
            arms.iter_mut().flatten().for_each(|world| world.step(step_s));
            left_s -= step_s;
            // Objects move in whole periods: after a late tick they wait until a whole period is due.
            *ahead_s += step_s;
            if *ahead_s < *period_s * (1.0 - ROUNDING_PERIODS) {
                continue;
            }
            *ahead_s = 0.0;
            let t_s = now_s - left_s;
            let instruments = arms.each_ref().map(|world| world.as_ref().map(World::instrument));
            let mut acts = outputs.each_ref().map(|outputs| outputs.acts);
            for (acts, world) in acts.iter_mut().zip(&*arms) {
                *acts = world.as_ref().map_or(*acts, |world| acts.and(world.hand().acts()));
            }
            let loads = playing.step(t_s, &instruments, acts);
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
