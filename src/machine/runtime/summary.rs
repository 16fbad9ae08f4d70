//! Results that a run reports when it ends.

use nima_core::{
    impedance::Mode,
    statistics::{Bar, Percentiles, Quantiles},
};
use nima_devices::{ConnectionState, Health};
use serde::Serialize;

use super::VirtualClock;
use crate::{
    messages::{Fault, LoopState, Scheduling, attention},
    rig::{Roster, Side},
    teleop::{Loop, Pair},
};

/// Error of one mode over a run: rendered force minus the force at the follower at the same instant.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ModeError {
    pub side: Side,
    pub mode: Mode,
    pub mae_n: f64,
    pub sd_n: f64,
    pub max_n: f64,
    /// Ticks in which the mode had no valid force.
    pub invalid: u64,
}

/// Processor time per wall time, as fractions of one core.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct CpuFraction {
    pub realtime: f64,
    pub process: f64,
}

/// State of one device at the end of a run.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceFigures {
    pub name: String,
    /// Counters since the device was opened.
    #[serde(flatten)]
    pub health: Health,
    /// Reason why the device is not connected, if known.
    pub trouble: Option<CauseAndCure>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CauseAndCure {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    pub cause: String,
    pub cure: String,
}

/// State of one arm pair at the end of a run.
#[derive(Clone, Debug, Serialize)]
pub struct ArmEnd {
    pub side: Side,
    /// State in the last tick, before the outputs were set to safe values.
    #[serde(serialize_with = "by_key")]
    pub final_state: LoopState,
    /// Fault, if any; filled in by [`RuntimeSummary::explain`].
    pub fault: Option<CauseAndCure>,
    /// The device concerned by the fault.
    #[serde(skip)]
    device: Option<String>,
}

impl ArmEnd {
    fn of(pair: &Pair) -> Self {
        Self { side: pair.side(), final_state: pair.state(), fault: None, device: None }
    }
}

/// Writes the state as one word, for scripts.
fn by_key<S: serde::Serializer>(state: &LoopState, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(match state {
        LoopState::Disconnected => "disconnected",
        LoopState::Idle => "idle",
        LoopState::Ready => "ready",
        LoopState::Engaged => "engaged",
        LoopState::Clutched => "clutched",
        LoopState::Stopped => "stopped",
        LoopState::Faulted(_) => "fault",
    })
}

/// Histograms of durations; each bar counts the durations above the upper limit of the previous bar and up to its own.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Histograms {
    pub wake: Vec<Bar>,
    pub work: Vec<Bar>,
    pub rig: Vec<Bar>,
    pub sample_to_force: Vec<Bar>,
}

#[derive(Clone, Debug, Serialize)]
pub struct RuntimeSummary {
    /// `real` or `virtual`.
    pub clock: &'static str,
    /// Profile and seed of a virtual clock with late ticks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateness: Option<VirtualClock>,
    pub ticks: u64,
    /// Number of periods missed and skipped.
    pub missed: u64,
    /// Ticks dropped because the queue to the screen was full.
    pub dropped: u64,
    pub seconds: f64,
    /// Loop time per wall time: above 1 is faster than real time.
    pub speed: f64,
    /// Lateness of wake-ups, us (zero on the perfect virtual clock).
    pub wake_us: Quantiles,
    /// Work of one tick of the loop, without rig and queues, us.
    pub work_us: Quantiles,
    /// Time spent reading from and writing to the rig (devices or simulation), us.
    pub rig_us: Quantiles,
    /// Time from the arrival of the oldest measurement until the force computed from it was sent to the device, us. In
    /// a simulation only the loop's own part; `None` on the virtual clock.
    pub sample_to_force_us: Option<Quantiles>,
    /// The four durations above as histograms.
    pub histograms: Histograms,
    /// Processor time; `None` on the virtual clock.
    pub cpu: Option<CpuFraction>,
    /// Real-time privileges that the operating system granted.
    pub scheduling: Scheduling,
    /// State at the end; with two arm pairs the state with the higher priority.
    #[serde(serialize_with = "by_key")]
    pub final_state: LoopState,
    /// The fault of the same arm pair.
    pub fault: Option<CauseAndCure>,
    /// State of each arm pair at the end, the right one first.
    pub arms: Vec<ArmEnd>,
    /// The devices; empty if everything is simulated.
    pub devices: Vec<DeviceFigures>,
    /// Errors of each mode's force before the gates, per arm pair and mode, the right pair first.
    pub error: Vec<ModeError>,
}

impl RuntimeSummary {
    /// Adds data of the threads that open the devices: names for faults, and the reason why a device is not connected.
    pub(super) fn report_devices(&mut self, roster: &Roster) {
        for (device, entry) in self.devices.iter_mut().zip(roster) {
            if device.health.standing != ConnectionState::Connected {
                let trouble = entry.view.report().trouble;
                device.trouble = trouble.map(|trouble| CauseAndCure {
                    device: None,
                    cause: trouble.to_string(),
                    cure: trouble.cure(),
                });
            }
        }
        let name = |state| match state {
            LoopState::Faulted(Fault::DeviceLost { device, .. }) => {
                roster.get(usize::from(device)).map(|entry| entry.name().to_owned())
            }
            _ => None,
        };
        for arm in &mut self.arms {
            arm.device = name(arm.final_state);
        }
    }

    /// Fills in the texts of the faults. `words` returns cause and remedy of a fault; the texts belong to the user
    /// interface, not to this crate.
    pub fn explain(&mut self, words: impl Fn(Fault) -> [&'static str; 2]) {
        for arm in &mut self.arms {
            if let LoopState::Faulted(fault) = arm.final_state {
                let [cause, cure] = words(fault).map(str::to_owned);
                arm.fault = Some(CauseAndCure { device: arm.device.clone(), cause, cure });
            }
        }
        let of_all = self.arms.iter().find(|arm| arm.final_state == self.final_state);
        self.fault = of_all.and_then(|arm| arm.fault.clone());
    }
}

/// Statistics collected during a run, by both clocks.
#[derive(Clone, Debug, Default)]
pub(super) struct Meters {
    pub(super) wake: Percentiles,
    pub(super) work: Percentiles,
    pub(super) rig: Percentiles,
    pub(super) sample_to_force: Percentiles,
    pub(super) ticks: u64,
    pub(super) dropped: u64,
}

impl Meters {
    pub(super) fn summary(
        &self,
        clock: &'static str,
        of: &Loop,
        seconds: f64,
        wall_s: f64,
        scheduling: Scheduling,
    ) -> RuntimeSummary {
        let of_mode = |pair: &Pair, mode| {
            let stats = pair.accuracy().of(mode);
            ModeError {
                side: pair.side(),
                mode,
                mae_n: stats.mae_n,
                sd_n: stats.sd_n(),
                max_n: stats.max_n,
                invalid: pair.accuracy().invalid(mode),
            }
        };
        let arms: Vec<ArmEnd> = of.pairs().map(ArmEnd::of).collect();
        // The state that needs more attention, because a script reads only this one.
        let worst = arms.iter().max_by_key(|arm| attention(arm.final_state));
        let computed = |pair: &Pair, mode: &Mode| pair.accuracy().of(*mode).count > 0;
        let modes = |pair: &Pair| Mode::ALL.into_iter().chain(pair.baseline().map(Mode::Baseline));
        let error = of.pairs().flat_map(|pair| {
            let computed = modes(pair).filter(|mode| computed(pair, mode));
            computed.map(|mode| of_mode(pair, mode)).collect::<Vec<_>>()
        });
        RuntimeSummary {
            clock,
            lateness: None,
            ticks: self.ticks,
            missed: of.pairs().map(Pair::missed).max().unwrap_or_default(),
            dropped: self.dropped,
            seconds,
            // A run that ends at once must not divide by zero: JSON has no infinity.
            speed: seconds / wall_s.max(1e-9),
            wake_us: self.wake.quantiles(),
            work_us: self.work.quantiles(),
            rig_us: self.rig.quantiles(),
            sample_to_force_us: self.sample_to_force.known_quantiles(),
            histograms: Histograms {
                wake: self.wake.histogram(),
                work: self.work.histogram(),
                rig: self.rig.histogram(),
                sample_to_force: self.sample_to_force.histogram(),
            },
            cpu: None,
            final_state: worst.map_or(LoopState::Idle, |arm| arm.final_state),
            fault: worst.and_then(|arm| arm.fault.clone()),
            arms,
            devices: Vec::new(),
            scheduling,
            error: error.collect(),
        }
    }
}
