//! What the screen reads off the ticks: gates as shares of the last moments, figures that can be read, changes of state.

use nima::{device::SIDES, runtime::Tick, safety::Why, statistics::Quantiles, teleop::LoopState};

use super::rolling::Fading;

/// Gates in the order of the chain, as shares of recent ticks in which each acted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gates {
    /// Not engaged.
    pub not_permitted: Fading,
    /// Nobody holds the handle.
    pub released: Fading,
    /// Nothing valid to render.
    pub invalid: Fading,
    /// Data too old.
    pub stale: Fading,
    /// Hand too slow.
    pub dead_band: Fading,
    /// Force withheld by the dead band, N.
    pub withheld_n: Fading,
    /// Change too fast.
    pub slew: Fading,
    /// More energy than the hand gave.
    pub energy: Fading,
    /// Force too large.
    pub ceiling: Fading,
}

/// How an arm pair came into its present state.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// When, s on the loop's clock.
    pub t_s: f64,
    /// From which state.
    pub from: LoopState,
    /// Why.
    pub why: Why,
}

/// Numbers as shown: steady enough to be read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Mean size of the measured force of each side, N, indexed by [`Side::index`].
    pub measured_n: [f64; SIDES],
    /// Mean size of the rendered force of each side, N.
    pub rendered_n: [f64; SIDES],
    /// Error of each mode at the horizon, N, mean over the last seconds.
    pub horizon_n: [f64; 4],
    /// Lateness of wake-ups, us.
    pub wake_us: Quantiles,
    /// Work of a tick, us.
    pub work_us: Quantiles,
    /// From measurement to force, us.
    pub sample_to_force_us: Quantiles,
    /// Ticks that came per second.
    pub rate_hz: f64,
    /// Time from one frame of the console to the next, ms: the median and the 99th percentile.
    pub frame_ms: [f64; 2],
    /// Processor time of one frame, ms.
    pub frame_work_ms: f64,
}

impl Gates {
    pub(super) fn push(&mut self, tick: &Tick, dt_s: f64) {
        let gates = &tick.gates;
        for (share, acted) in [
            (&mut self.not_permitted, gates.not_permitted),
            (&mut self.released, gates.released),
            (&mut self.invalid, gates.invalid),
            (&mut self.stale, gates.stale),
            (&mut self.dead_band, gates.dead_band),
            (&mut self.slew, gates.slew),
            (&mut self.energy, gates.energy),
            (&mut self.ceiling, gates.ceiling),
        ] {
            share.push(f64::from(u8::from(acted)), dt_s, 0.15);
        }
        self.withheld_n.push(gates.withheld_n, dt_s, 0.15);
    }
}
