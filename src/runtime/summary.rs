//! What a run tells at its end.

use serde::Serialize;

use super::Scheduling;
use crate::{
    device::{Health, Side},
    impedance::Mode,
    statistics::{Bar, Percentiles, Quantiles},
    teleop::{Loop, Pair},
};

/// Error of one mode over a run, against the force at the follower at the same instant.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ModeError {
    /// Of which arm pair.
    pub side: Side,
    /// The mode.
    pub mode: Mode,
    /// Mean 3-D error, N.
    pub mae_n: f64,
    /// Standard deviation of the 3-D error, N.
    pub sd_n: f64,
    /// Largest 3-D error, N.
    pub max_n: f64,
    /// Ticks in which the mode had nothing valid.
    pub invalid: u64,
}

/// Processor time per wall time, in shares of one core.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct CpuShare {
    /// The real-time thread.
    pub realtime: f64,
    /// The whole process.
    pub process: f64,
}

/// How one device was at the end of a run.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceFigures {
    /// Its name in the rig.
    pub name: String,
    /// All that was counted since it was opened.
    #[serde(flatten)]
    pub health: Health,
}

/// Counts of durations; each bar holds those up to its end and above the end of the bar before.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Histograms {
    /// Lateness of wake-ups.
    pub wake: Vec<Bar>,
    /// Work of one tick.
    pub work: Vec<Bar>,
    /// Exchange with the rig.
    pub rig: Vec<Bar>,
    /// From measurement to force.
    pub sample_to_force: Vec<Bar>,
}

/// Timing and error figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// `real` or `virtual`.
    pub clock: &'static str,
    /// Ticks executed.
    pub ticks: u64,
    /// Periods missed and skipped.
    pub missed: u64,
    /// Ticks that did not fit into the screen's queue.
    pub dropped: u64,
    /// Loop time at the end, s.
    pub seconds: f64,
    /// Wall time per loop time: above 1 is faster than real time.
    pub speed: f64,
    /// Lateness of wake-ups, us (zero on the virtual clock).
    pub wake_us: Quantiles,
    /// Work of one tick of the loop, without rig and queues, us.
    pub work_us: Quantiles,
    /// Exchange with the rig (devices or simulation), us.
    pub rig_us: Quantiles,
    /// Time from the arrival of the oldest measurement to when the force made from it was given to the device, us; in a simulation
    /// the loop's own time alone.
    pub sample_to_force_us: Quantiles,
    /// The same four as histograms.
    pub histograms: Histograms,
    /// Processor time; zero on the virtual clock.
    pub cpu: CpuShare,
    /// What the operating system granted.
    pub scheduling: Scheduling,
    /// The devices, where there are some.
    pub devices: Vec<DeviceFigures>,
    /// Errors per arm pair and mode, the right one's first, before the gates.
    pub error: Vec<ModeError>,
}

/// Meters of a run, filled by both clocks.
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
    ) -> Summary {
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
        let error = of.pairs().flat_map(|pair| Mode::ALL.map(|mode| of_mode(pair, mode)));
        Summary {
            clock,
            ticks: self.ticks,
            missed: of.pairs().map(Pair::missed).max().unwrap_or_default(),
            dropped: self.dropped,
            seconds,
            speed: seconds / wall_s.max(1e-9),
            wake_us: self.wake.quantiles(),
            work_us: self.work.quantiles(),
            rig_us: self.rig.quantiles(),
            sample_to_force_us: self.sample_to_force.quantiles(),
            histograms: Histograms {
                wake: self.wake.histogram(),
                work: self.work.histogram(),
                rig: self.rig.histogram(),
                sample_to_force: self.sample_to_force.histogram(),
            },
            cpu: CpuShare::default(),
            devices: Vec::new(),
            scheduling,
            error: error.collect(),
        }
    }
}
