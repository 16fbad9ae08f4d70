//! Cost of each effect of a scene, and the change of force without it.
//!
//! The motion is the same with and without an effect: the commands of the simulated hand in the whole scene, in free
//! running (no closed loop; therefore the handle, which only the hand feels, is not among the effects). The cost is the
//! simulated world's alone, per tick; the force is the one that the rig would measure.

use std::{fmt::Write as _, hint::black_box, time::Instant};

use nalgebra::Vector3;
use nima_machine::{
    config::ConfigError,
    rig::{Inputs, Outputs, Rig as _, SIDES, SensedForce, Side},
};
use nima_simulation::{World, Worlds, scene::Scene};
use serde::Serialize;

use crate::{Experiment, Findings};

const RATE_HZ: f64 = 1000.0;
/// Number of runs for the median cost.
const RUNS: usize = 5;

#[derive(Clone, Debug)]
pub struct Effects {
    /// Scenes by name or file; empty for all built-in scenes.
    pub scenes: Vec<String>,
    /// Duration of the motion, s.
    pub seconds: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct OfScene {
    pub scene: String,
    /// Cost of a tick of one arm with all effects, us.
    pub cost_us: f64,
    /// Mean magnitude of the measured force, N.
    pub force_n: f64,
    /// The removable effects.
    pub effects: Vec<SceneEffect>,
}

/// One effect of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneEffect {
    /// Name of the removed effect.
    pub effect: &'static str,
    /// Cost in a tick, us; near zero within the noise of the clock.
    pub cost_us: f64,
    /// Root mean square of the change of the measured force without the effect, N.
    pub change_n: f64,
    /// Maximum change, N.
    pub change_max_n: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct EffectReport {
    /// Duration of the motion, s.
    pub seconds: f64,
    pub scenes: Vec<OfScene>,
}

/// An effect: its name, whether a scene has it, and the scene without it.
type EffectPart = (&'static str, fn(&Scene) -> bool, fn(&mut Scene));

const PARTS: [EffectPart; 15] = [
    ("tissue", |scene| scene.tissue.is_some(), without_tissue),
    (
        "friction of the tissue",
        |scene| scene.tissue.is_some_and(|tissue| tissue.friction > 0.0),
        |scene| {
            if let Some(tissue) = &mut scene.tissue {
                tissue.friction = 0.0;
            }
        },
    ),
    (
        "damping of the tissue",
        |scene| scene.tissue.is_some_and(|tissue| tissue.damping_s_m > 0.0),
        |scene| {
            if let Some(tissue) = &mut scene.tissue {
                tissue.damping_s_m = 0.0;
            }
        },
    ),
    ("layers", |scene| !scene.layers.is_empty(), |scene| scene.layers.clear()),
    ("lumps", |scene| scene.lumps.is_some(), |scene| scene.lumps = None),
    ("relaxation", |scene| scene.relaxation.is_some(), |scene| scene.relaxation = None),
    ("membrane", |scene| scene.membrane.is_some(), |scene| scene.membrane = None),
    ("rings, pegs and jaws", |scene| scene.objects.is_some(), |scene| scene.objects = None),
    ("wire and loop", |scene| scene.wire.is_some(), |scene| scene.wire = None),
    ("walls", |scene| !scene.walls.is_empty(), |scene| scene.walls.clear()),
    ("lag of the arm", |scene| scene.follower.is_some(), |scene| scene.follower = None),
    ("noise of the sensor", |scene| scene.sensor.is_some(), |scene| scene.sensor = None),
    ("friction in the trocar", |scene| scene.trocar.is_some(), |scene| scene.trocar = None),
    (
        "wrist sensor and tool",
        |scene| scene.wrist.is_some() && scene.person.is_none(),
        |scene| {
            scene.wrist = None;
            scene.trocar = None;
            scene.tissue_sensor = None;
        },
    ),
    ("sensor under the tissue", |scene| scene.tissue_sensor.is_some(), |scene| scene.tissue_sensor = None),
];

fn without_tissue(scene: &mut Scene) {
    scene.tissue = None;
    scene.lumps = None;
    scene.relaxation = None;
    scene.membrane = None;
    scene.layers.clear();
}

fn force_n(sensed: &SensedForce) -> Vector3<f64> {
    match sensed {
        SensedForce::AtTip(force_n) => *force_n,
        sensed => sensed.wrist().map_or_else(Vector3::zeros, |sample| sample.raw.force_n),
    }
}

/// The simulation of one hand: returns the measurements for the outputs at a time.
type HandSimulation = Box<dyn FnMut(f64, &Outputs) -> Option<Inputs>>;

/// Simulates this scene, with the objects that all instruments share, if there are any.
fn simulated(scene: &Scene) -> HandSimulation {
    if !scene.is_played() {
        let mut world = World::new(scene, RATE_HZ);
        return Box::new(move |now_s, outputs| world.exchange(now_s, outputs));
    }
    let mut worlds = Worlds::new(scene, RATE_HZ);
    let right = Side::Right.index();
    Box::new(move |now_s, outputs| {
        let mut both = [Outputs::SAFE; SIDES];
        both[right] = *outputs;
        worlds.write(now_s, &both);
        worlds.read(now_s)[right]
    })
}

/// Returns the commands of this scene's hand, tick by tick.
fn commands(scene: &Scene, ticks: usize) -> Vec<Vector3<f64>> {
    let mut world = simulated(scene);
    let mut outputs = Outputs::SAFE;
    let mut commands = Vec::with_capacity(ticks);
    for tick in 0..ticks {
        let Some(inputs) = world(tick as f64 / RATE_HZ, &outputs) else { continue };
        outputs.tip_command_m = Some(inputs.hand.position_m);
        commands.push(inputs.hand.position_m);
    }
    commands
}

/// Returns the measured forces of this scene along these commands.
fn forces(scene: &Scene, commands: &[Vector3<f64>], mut each: impl FnMut(Vector3<f64>)) {
    let mut world = simulated(scene);
    for (tick, command_m) in commands.iter().enumerate() {
        let outputs = Outputs { tip_command_m: Some(*command_m), ..Outputs::SAFE };
        if let Some(inputs) = world(tick as f64 / RATE_HZ, &outputs) {
            each(force_n(&inputs.sensed));
        }
    }
}

/// Returns the median cost of a tick, us, of scenes that are run in turn, so that all meet the same load.
fn costs_us(scenes: &[Scene], commands: &[Vector3<f64>]) -> Vec<f64> {
    let mut costs = vec![Vec::with_capacity(RUNS); scenes.len()];
    for _ in 0..RUNS {
        for (scene, costs) in scenes.iter().zip(&mut costs) {
            let began = Instant::now();
            forces(scene, commands, |force_n| {
                black_box(force_n);
            });
            costs.push(began.elapsed().as_secs_f64() * 1e6 / commands.len().max(1) as f64);
        }
    }
    let median = |mut costs: Vec<f64>| {
        costs.sort_by(f64::total_cmp);
        costs[costs.len() / 2]
    };
    costs.into_iter().map(median).collect()
}

impl Effects {
    fn of_scene(&self, name: &str) -> Result<OfScene, ConfigError> {
        let scene = Scene::load(name)?;
        let whole = scene.of_side(Side::Right).unwrap_or(scene);
        let ticks = (self.seconds * RATE_HZ) as usize;
        let commands = commands(&whole, ticks);
        let left_out = PARTS.iter().filter(|(_, has, _)| has(&whole)).filter_map(|(name, _, leave)| {
            let mut without = whole.clone();
            leave(&mut without);
            without.validate().is_ok().then_some((*name, without))
        });
        let left_out: Vec<(&'static str, Scene)> = left_out.collect();
        let scenes: Vec<Scene> =
            std::iter::once(&whole).chain(left_out.iter().map(|(_, scene)| scene)).cloned().collect();
        let costs = costs_us(&scenes, &commands);
        let mut measured = Vec::with_capacity(ticks);
        forces(&whole, &commands, |force_n| measured.push(force_n));
        let effect = |((name, scene), cost_us): (&(&'static str, Scene), &f64)| {
            let mut at = 0;
            let mut squares = 0.0;
            let mut max_n = 0.0_f64;
            forces(scene, &commands, |force_n| {
                let change_n = (force_n - measured[at]).norm();
                at += 1;
                squares += change_n * change_n;
                max_n = max_n.max(change_n);
            });
            let change_n = (squares / at.max(1) as f64).sqrt();
            SceneEffect { effect: name, cost_us: costs[0] - cost_us, change_n, change_max_n: max_n }
        };
        let effects = left_out.iter().zip(&costs[1..]).map(effect).collect();
        let force_n = measured.iter().map(Vector3::norm).sum::<f64>() / measured.len().max(1) as f64;
        Ok(OfScene { scene: name.to_owned(), cost_us: costs[0], force_n, effects })
    }
}

impl Experiment for Effects {
    const NAME: &'static str = "effects";
    type Findings = EffectReport;
    type Error = ConfigError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<EffectReport, ConfigError> {
        let built_in = || Scene::names().map(str::to_owned).collect();
        let names: Vec<String> = if self.scenes.is_empty() { built_in() } else { self.scenes.clone() };
        let of = |(done, name): (usize, &String)| {
            progress(done, names.len(), name);
            self.of_scene(name)
        };
        let scenes = names.iter().enumerate().map(of).collect::<Result<_, _>>()?;
        Ok(EffectReport { seconds: self.seconds, scenes })
    }
}

impl Findings for EffectReport {
    fn text(&self) -> String {
        let mut text = format!(
            "What each effect of a scene costs in a tick of one arm, and how the measured force changes without it ({} s of the hand's motion)\n\n\
             | scene | left out | cost (us) | change, rms (N) | largest (N) |\n|---|---|---|---|---|\n",
            self.seconds
        );
        for OfScene { scene, cost_us, force_n, effects } in &self.scenes {
            writeln!(text, "| {scene} | nothing; mean force {force_n:.2} N | {cost_us:.2} | - | - |").ok();
            for SceneEffect { effect, cost_us, change_n, change_max_n } in effects {
                // Avoids a negative zero.
                let cost_us = (cost_us * 100.0).round() / 100.0 + 0.0;
                writeln!(text, "| | {effect} | {cost_us:.2} | {change_n:.3} | {change_max_n:.2} |").ok();
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_every_scene_can_be_left_out_and_what_acts_changes_the_force() {
        let report = Effects { scenes: Vec::new(), seconds: 3.0 }.run(&mut |_, _, _| ()).unwrap();
        assert_eq!(report.scenes.len(), Scene::names().count());
        let of = |name: &str| report.scenes.iter().find(|scene| scene.scene == name).unwrap();
        let effect = |scene: &str, name: &str| {
            of(scene).effects.iter().find(|effect| effect.effect == name).map(|effect| effect.change_n)
        };
        assert!(effect("peg_transfer", "tissue").unwrap() > 0.3);
        assert!(effect("palpation", "friction in the trocar").unwrap() > 0.1);
        assert!(effect("lumps", "lumps").unwrap() > 0.01 && effect("lumps", "relaxation").unwrap() > 0.01);
        assert_eq!(effect("peg_transfer", "lumps"), None, "what a scene does not have is not listed");
        assert_eq!(effect("free_motion", "tissue"), None);
        assert!(report.text().contains("| lumps |"));
    }

    #[test]
    fn a_wire_and_hidden_lumps_can_be_left_out_too() {
        for (scene, left_out) in [("wire", "wire and loop"), ("find_lumps", "lumps")] {
            let report = Effects { scenes: vec![scene.to_owned()], seconds: 20.0 }.run(&mut |_, _, _| ()).unwrap();
            let effects = &report.scenes[0].effects;
            let change_n = effects.iter().find(|effect| effect.effect == left_out).unwrap().change_n;
            assert!(change_n > 0.02, "{scene}: {change_n} N");
        }
    }
}
