//! Values derived from the ticks for display: recent activity of the gates, smoothed figures, changes of state.

use nima_core::{
    impedance::SLOTS,
    safety::{GATES, Gate, TransitionCause},
    statistics::Quantiles,
};
use nima_machine::{
    messages::{LoopState, Tick},
    rig::SIDES,
};

use crate::rolling::FadingMean;

#[derive(Clone, Copy, Debug, Default)]
pub struct GateActivity {
    /// Fraction of recent ticks in which each gate acted, indexed by [`GateView::index`].
    acting: [FadingMean; GATES],
    /// Force withheld by the dead band, N.
    pub withheld_n: FadingMean,
    /// Recent fraction of the force that the governor withholds.
    pub governed: FadingMean,
}

/// How an arm pair entered its current state.
#[derive(Clone, Copy, Debug)]
pub struct StateEntry {
    /// Time, s on the loop's clock.
    pub t_s: f64,
    pub from: LoopState,
    pub why: TransitionCause,
}

/// Figures for display, smoothed so that they can be read.
#[derive(Clone, Copy, Debug, Default)]
pub struct DisplayFigures {
    /// Mean magnitude of the measured force of each side, N, indexed by `Side::index`; `None` while it is unknown.
    pub measured_n: [Option<f64>; SIDES],
    /// Mean magnitude of the rendered force of each side, N.
    pub rendered_n: [f64; SIDES],
    /// Torque about the shaft of each side, Nm.
    pub twist: [ShaftTwist; SIDES],
    /// Prediction error of each mode, N, mean over the last seconds; `None` while the tip force is unknown.
    pub horizon_n: [Option<f64>; SLOTS],
    /// Lateness of wake-ups, us.
    pub wake_us: Quantiles,
    /// Work of a tick, us.
    pub work_us: Quantiles,
    /// Time from measurement to force, us.
    pub sample_to_force_us: Quantiles,
    /// Ticks received per second.
    pub rate_hz: f64,
    /// Time from one frame of the console to the next, ms: the median and the 99th percentile.
    pub frame_ms: [f64; 2],
    /// Processor time of one frame, ms.
    pub frame_work_ms: f64,
}

/// Torque about the shaft, Nm, positive counter-clockwise as seen from the trocar; `None` if unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaftTwist {
    /// Torque of the object that the jaws hold or touch.
    pub jaws_nm: Option<f64>,
    /// Torque on the wrist sensor, as read.
    pub wrist_nm: Option<f64>,
}

impl GateActivity {
    pub fn push(&mut self, tick: &Tick, dt_s: f64) {
        for (fraction, gate) in self.acting.iter_mut().zip(Gate::ALL) {
            fraction.push(f64::from(u8::from(tick.gates.acted(gate))), dt_s, 0.15);
        }
        self.withheld_n.push(tick.gates.withheld_n, dt_s, 0.15);
        self.governed.push(tick.gates.governed, dt_s, 0.15);
    }

    /// Returns the fraction of recent ticks in which this gate acted.
    pub fn fraction(&self, gate: Gate) -> f64 {
        self.acting[gate.index()].get()
    }

    /// Returns whether it acted in most recent ticks.
    pub fn closed(&self, gate: Gate) -> bool {
        self.fraction(gate) > 0.5
    }
}
