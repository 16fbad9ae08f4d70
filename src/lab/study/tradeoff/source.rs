//! Sources of motion and force: recordings and simulated scenes.

use nima_core::impedance::{AXES, Sample};
use nima_machine::{
    rig::{Outputs, SensedForce},
    runtime::{ClockProfile, VirtualClock},
};
use nima_recording::csv::CsvRecording;
use nima_simulation::{World, scene::Scene};

/// Motion and force over time, with a name.
#[derive(Clone, Debug)]
pub struct TradeoffSource {
    pub name: String,
    pub unit: String,
    pub recording: CsvRecording,
}

impl TradeoffSource {
    /// Records `scene` open-loop on the perfect virtual clock: the follower follows the hand, the hand feels nothing,
    /// so that every choice of parameters gets identical motion and force. The scene must have been validated.
    pub fn from_scene(scene: &Scene, rate_hz: f64, seconds: f64) -> Self {
        Self::on_clock(VirtualClock::PERFECT, scene, rate_hz, seconds)
    }

    /// Creates the same with the samples at the times of the ticks of another clock.
    pub fn on_clock(clock: VirtualClock, scene: &Scene, rate_hz: f64, seconds: f64) -> Self {
        let mut world = World::new(scene, rate_hz);
        let mut outputs = Outputs::SAFE;
        let ticks = (seconds * rate_hz).round().max(0.0);
        let mut samples = Vec::with_capacity(ticks as usize);
        let mut times = clock.tick_times(rate_hz);
        let mut t_s = times.advance().now_s;
        while t_s < (ticks - 0.5) / rate_hz {
            if let Some(inputs) = world.exchange(t_s, &outputs) {
                outputs.tip_command_m = Some(inputs.hand.position_m);
                // This study compares identification, not the force path, so for a scene with a wrist sensor, use the
                // true tip force.
                let force_n = match inputs.sensed {
                    SensedForce::AtTip(force_n) => force_n,
                    SensedForce::AtWrist(_) | SensedForce::FarEnd(_) => world.true_tip_n(),
                };
                samples.push(Sample { t_s, position_m: inputs.tip_m, force_n });
            }
            t_s = times.advance().now_s;
        }
        let recording = CsvRecording {
            path: scene.name.clone().into(),
            axes: (0..AXES).collect(),
            rate_hz,
            samples,
            leader_m: None,
        };
        let name = match clock.profile {
            ClockProfile::Perfect => scene.name.clone(),
            profile => format!("{} ({profile} clock)", scene.name),
        };
        Self { name, unit: "N".to_owned(), recording }
    }

    /// Creates a recording, named after its file.
    pub fn from_recording(recording: CsvRecording, unit: &str) -> Self {
        let name = recording.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Self { name, unit: unit.to_owned(), recording }
    }

    /// Returns the duration, s.
    pub fn seconds(&self) -> f64 {
        match &*self.recording.samples {
            [first, .., last] => last.t_s - first.t_s,
            _ => 0.0,
        }
    }

    /// Returns every `every`-th sample, as read by a slower device (without a filter).
    pub(super) fn slower(&self, every: usize) -> CsvRecording {
        let every = every.max(1);
        CsvRecording {
            path: self.recording.path.clone(),
            axes: self.recording.axes.clone(),
            rate_hz: self.recording.rate_hz / every as f64,
            samples: self.recording.samples.iter().step_by(every).copied().collect(),
            leader_m: self.recording.leader_m.as_ref().map(|all| all.iter().step_by(every).copied().collect()),
        }
    }
}
